// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Curvature against 50 digits: the error of the arithmetic, with depths rounded to the type first.
#include "fingerpad/image/curvature.hpp"

#include <algorithm>
#include <cmath>

#include "fingerpad/published/contact_region.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Digits50;
using test::Image;

namespace {

template <class S>
constexpr double bound_per_mm = 5e-6;
template <>
constexpr double bound_per_mm<double> = 1e-14;

double any_curvature() {
  const double size[] = {0.0, 1.5e-4, 0.05};
  return (test::whole(0, 1) == 0 ? 1 : -1) * size[test::whole(0, 2)];
}

/// Error of a map at the center of a random patch of that curvature.
template <bool Clamped, class S, class CameraType>
double map_error(const CameraType& camera) {
  const Index radius = test::whole(0, 7) == 0 ? 25 : 10;  // 50 digits of the larger ring take long
  const Index size = 2 * radius + 1;
  const double middle = test::uniform(5, 13), slope = test::uniform(0, 1.5);
  const double turn = test::uniform(0, 7), bend_x = any_curvature();
  const double bend_y = any_curvature();
  Image<S> depth(size, size);
  Image<Digits50> exact(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const double x = static_cast<double>(j - radius) * camera.pitch_mm;
      const double y = static_cast<double>(i - radius) * camera.pitch_mm;
      const double rise = slope * (x * std::cos(turn) + y * std::sin(turn));
      depth(i, j) = static_cast<S>(middle + rise - (bend_x * x * x + bend_y * y * y) / 2);
      exact(i, j) = Digits50(depth(i, j));
    }
  }
  const CurvatureRing ring{static_cast<double>(radius)};
  CurvatureMap<S> map(camera, size, size, ring);
  CurvatureMap<Digits50> reference(camera, size, size, ring);
  Image<S> k(size, size);
  Image<Digits50> truth(size, size);
  (void)map(depth, k);
  (void)reference(exact, truth);
  if (!Clamped) {
    map.mean(0, size, 0, size, k);
    reference.mean(0, size, 0, size, truth);
  }
  const Digits50 error = Digits50(k(radius, radius)) - truth(radius, radius);
  return std::abs(static_cast<double>(error));
}

}  // namespace

TEMPLATE_TEST_CASE("a section's curvature follows 50 digits", "[curvature]", float, double) {
  using S = TestType;
  rc::prop("whatever depth, slope and curvature", [] {
    const S radius = static_cast<S>(test::whole(0, 1) == 0 ? 0.768 : 1.92);
    const double r = static_cast<double>(radius);
    const double center = test::uniform(5, 13), rise = r * test::uniform(-1.5, 1.5);
    const double bend = any_curvature() * r * r / 2;
    const S before = static_cast<S>(center - rise - bend);
    const S middle = static_cast<S>(center);
    const S after = static_cast<S>(center + rise - bend);
    const Digits50 exact =
        section_curvature(Digits50(radius), Digits50(before), Digits50(middle), Digits50(after));
    const Digits50 error = Digits50(section_curvature(radius, before, middle, after)) - exact;
    RC_ASSERT(std::abs(static_cast<double>(error)) <= bound_per_mm<S> / 100);
  });
}

TEMPLATE_TEST_CASE("maps of curvature follow 50 digits", "[curvature]", float, double) {
  using S = TestType;
  OrthographicCamera<double> plate;
  plate.pitch_mm = 0.0768;
  rc::prop("plain", [&] {
    const double error = map_error<false, S>(plate);
    RC_ASSERT(error <= bound_per_mm<S>);
  });
  rc::prop("clamped", [&] {
    const double error = map_error<true, S>(plate);
    RC_ASSERT(error <= bound_per_mm<S>);
  });
}

TEMPLATE_TEST_CASE("through a camera too, up to the rounding of zeta",
                   "[curvature]",
                   float,
                   double) {
  using S = TestType;
  Camera<double> camera;
  camera.pitch_mm = 0.0768;
  rc::prop("clamped", [&] {
    const double error = map_error<true, S>(camera);
    RC_ASSERT(error <= 4 * bound_per_mm<S>);
  });
}

TEST_CASE("fifty digits and dual numbers have curvature", "[curvature]") {
  using S = Digits50;
  const S radius(0.768), before(9), center(9.5), after(9.25);
  const S tiny("1e-16");
  const auto by_center = [&](const auto& l) {
    using T = std::decay_t<decltype(l)>;
    return section_curvature(T(radius), T(before), l, T(after));
  };
  const S exact = test::slope_by_dual(by_center, center);
  const S nearly = test::slope_by_difference(by_center, center, tiny);
  CHECK(test::relative_error(nearly, exact) < S("1e-28"));
  const S published = published::circle_center_curvature(radius, before, center, after);
  const S menger = section_curvature(radius, before, center, after);
  CHECK(test::relative_error(published, menger) < S("1e-47"));
}

TEST_CASE("the published circle loses digits where the membrane is nearly flat", "[curvature]") {
  double published = 0, menger = 0;
  int lost = 0;
  test::Random random(7);
  for (int k = 0; k < 20000; ++k) {
    const float r = 0.768F;
    const double center = random.uniform(5, 13), rise = 0.768 * random.uniform(-1.5, 1.5);
    const double bend = 1.5e-4 * 0.768 * 0.768 / 2;
    const float before = static_cast<float>(center - rise - bend);
    const float middle = static_cast<float>(center);
    const float after = static_cast<float>(center + rise - bend);
    const double exact = section_curvature(static_cast<double>(r), static_cast<double>(before),
                                           static_cast<double>(middle), static_cast<double>(after));
    const double circle =
        static_cast<double>(published::circle_center_curvature(r, before, middle, after));
    lost += std::isnan(circle) ? 1 : 0;
    published = std::isnan(circle) ? published : (std::max)(published, std::abs(circle - exact));
    const double ours = static_cast<double>(section_curvature(r, before, middle, after));
    menger = (std::max)(menger, std::abs(ours - exact));
  }
  CAPTURE(published, menger, lost);
  CHECK(menger < 1e-10);
  CHECK(published > 1e-7);
}
