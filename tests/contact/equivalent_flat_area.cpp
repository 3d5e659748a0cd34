// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/equivalent_flat_area.hpp"


#include <cmath>

#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double area_mm2 = 78.5;
constexpr CurvatureSamples samples{.span_px = 5, .step_px = 1};

/// A dome of radius free_mm, touched within 5 mm of the axis by z = 10 + height(x, y).
template <class S = double>
struct Touched {
  OrthographicCamera<S> camera{S(59.5), S(59.5), S(0.2)};
  Image<S> height{120, 120, S(0)};
  Image<Touch> mask{120, 120, Touch::none};

  template <class Object>
  Touched(double free_mm, const Object& object) {
    for (Index i = 0; i < 120; ++i) {
      for (Index j = 0; j < 120; ++j) {
        const auto p = point_at(camera, S(double(i)), S(double(j)), S(0));
        const double x = double(p.x), y = double(p.y), rho_sq = x * x + y * y;
        mask(i, j) = rho_sq < 25 ? Touch::contact : Touch::none;
        height(i, j) = S(10 + (rho_sq < 25 ? object(x, y) : std::sqrt(free_mm * free_mm - rho_sq)));
      }
    }
  }
  EquivalentFlatArea<S> operator()() const {
    return equivalent_flat_area(camera, mask, height, S(area_mm2), samples);
  }
};

auto ball(double radius_mm) {
  return [=](double x, double y) { return -std::sqrt(radius_mm * radius_mm - x * x - y * y); };
}
auto rod(double radius_mm) {
  return [=](double x, double) { return -std::sqrt(radius_mm * radius_mm - x * x); };
}
auto plate(double slope) {
  return [=](double x, double y) { return slope * (0.6 * x + 0.8 * y); };
}

double share(const EquivalentFlatArea<double>& found) {
  REQUIRE(found.ok());
  return found.area_mm2 / area_mm2;
}

}  // namespace

TEST_CASE("equivalent flat area: balls, rods and plates on a dome", "[contact]") {
  rc::prop("1 - k_contact / k_free", [] {
    const double free_mm = 0.01 * *rc::gen::inRange(1900, 5000);
    const double object_mm = 0.01 * *rc::gen::inRange(1000, 5000);
    const double slope = 0.01 * *rc::gen::inRange(0, 40);
    // a ball's principal curvatures are both 1/r, a rod's is one; differences over 1 mm see them to
    // 1.3 % at the edge of the smallest ball, where it is steepest
    RC_ASSERT(share(Touched<>(free_mm, ball(object_mm))()) ==
              Approx(1 + free_mm / object_mm).epsilon(0.03));
    RC_ASSERT(share(Touched<>(free_mm, rod(object_mm))()) ==
              Approx(1 + free_mm / (2 * object_mm)).epsilon(0.03));
    RC_ASSERT(share(Touched<>(free_mm, plate(slope))()) == Approx(1).epsilon(1e-9));
    // a hollow object presses less; one that fits the dome, not at all
    const auto hollow = [&](double x, double y) { return -ball(2 * free_mm)(x, y); };
    RC_ASSERT(share(Touched<>(free_mm, hollow)()) == Approx(0.5).epsilon(0.03));
  });
}

TEST_CASE("equivalent flat area: the same in float and through any mask", "[contact]") {
  const Touched<> touched(20, ball(18));
  const auto in_float = Touched<float>(20, ball(18))();
  CHECK(double(in_float.area_mm2) == Approx(touched().area_mm2).epsilon(1e-3));
  Image<std::uint8_t> mask(120, 120);
  Image<double> turned(120, 120);
  for (Index i = 0; i < 120; ++i) {
    for (Index j = 0; j < 120; ++j) {
      mask(i, j) = touched.mask(j, i) == Touch::contact;
      turned(i, j) = touched.height(j, 119 - i);
    }
  }
  const auto again = equivalent_flat_area(touched.camera, mask, turned, area_mm2, samples);
  CHECK(again.area_mm2 == Approx(touched().area_mm2).epsilon(1e-12));
}

TEST_CASE("equivalent flat area: noise averages, what is missing does not count", "[contact]") {
  const double exact = share(Touched<>(20, ball(18))());
  Touched<> noisy(20, ball(18));
  test::Random random(5);
  for (double& h : noisy.height.cells) {
    h += 0.01 * random.normal();
  }
  CHECK(share(noisy()) == Approx(exact).epsilon(0.02));
  Touched<> with_holes(20, ball(18));
  for (Index k = 0; k < 40; ++k) {
    with_holes.height.cells[static_cast<std::size_t>(120 * 120 * random.uniform())] = test::nan;
    const auto unknown = static_cast<std::size_t>(120 * 120 * random.uniform());
    with_holes.mask.cells[unknown] = Touch::unknown;
    with_holes.height.cells[unknown] = 1000;  // behind an unknown, anything
  }
  CHECK(share(with_holes()) == Approx(exact).epsilon(0.01));
}

TEST_CASE("equivalent flat area: no answer where there is none", "[contact]") {
  Touched<> touched(20, ball(18));
  const auto find = [&](const CurvatureSamples& s) {
    return equivalent_flat_area(touched.camera, touched.mask, touched.height, area_mm2, s);
  };
  CHECK(find(samples).ok());
  CHECK_FALSE(find({.span_px = 30}).ok());   // wider than the contact
  CHECK_FALSE(find({.span_px = 200}).ok());  // than the image
  const Image<double> other(120, 119, 0.0);
  CHECK_FALSE(equivalent_flat_area(touched.camera, touched.mask, other, area_mm2).ok());
  const auto hollow_pad = [](double x, double y) { return 0.01 * (x * x + y * y); };
  for (double& h : touched.height.cells) {
    h = 20 - h;  // bulges inward where it is free: no membrane under pressure
  }
  CHECK_FALSE(find(samples).ok());
  touched = Touched<>(20, hollow_pad);
  std::fill(touched.mask.cells.begin(), touched.mask.cells.end(), Touch::contact);
  CHECK_FALSE(find(samples).ok());  // nowhere free
  std::fill(touched.mask.cells.begin(), touched.mask.cells.end(), Touch::none);
  CHECK_FALSE(find(samples).ok());  // nowhere touched
  CHECK_THROWS_AS(find({.span_px = 0}), parameter_error);
  CHECK_THROWS_AS(find({.step_px = 0}), parameter_error);
  CHECK_THROWS_AS(find({.max_slope = test::nan}), parameter_error);
  CHECK_THROWS_AS(find({.min_samples = 0}), parameter_error);
}
