// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/equivalent_flat_area.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

/// An object of revolution and the membrane around it.
struct Press {
  double flat_mm = 5;     ///< radius of the plate with the same force
  double touched_mm = 5;  ///< of the contact
  double tension = 8;     ///< T / p at the contact, mm
  double steeper = 0;     ///< relative growth of the tension per mm of flux
  double bump_mm = 0;     ///< in the middle of the object

  /// tan(alpha) by the balance of each disc, r^2 - s^2 = 2 r sin(alpha) T / p with the tension
  /// T = T_0 (1 + steeper 2 pi r sin(alpha)).
  double slope(double r) const {
    const double balance = (r * r - flat_mm * flat_mm) / (2 * r * tension);
    const double g = 2 * std::numbers::pi * r * steeper;
    const double sine = 2 * balance / (1 + std::sqrt(1 + 4 * g * balance));
    return sine / std::sqrt(1 - sine * sine);
  }
  /// Height of object and membrane, which are tangent at the edge of the contact.
  double height_mm(double rho) const {
    if (rho <= touched_mm) {
      const double share = 1 - rho * rho / (touched_mm * touched_mm);
      return 12 + slope(touched_mm) * touched_mm / 2 * share + bump_mm * share * share;
    }
    constexpr int steps = 200;
    const double step = (rho - touched_mm) / steps;
    double height = 12;
    for (int k = 0; k < steps; ++k) {
      height -= slope(touched_mm + (k + 0.5) * step) * step;
    }
    return height;
  }
};

template <class S = double>
struct Seen {
  OrthographicCamera<S> camera{S(59.5), S(59.5), S(0.25)};
  Image<S> height{120, 120, not_a_number<S>()};
  Image<std::uint8_t> mask{120, 120, 0};
  double true_mm2;

  explicit Seen(const Press& press, double mask_beyond_mm = 0, double aspect = 1)
      : true_mm2(std::numbers::pi * press.flat_mm * press.flat_mm) {
    camera.pixel_aspect = S(aspect);
    std::vector<double> profile;
    for (int k = 0; k <= 260; ++k) {
      profile.push_back(press.height_mm(0.05 * k));
    }
    for (Index i = 0; i < 120; ++i) {
      for (Index j = 0; j < 120; ++j) {
        const auto p = point_at(camera, S(double(i)), S(double(j)), S(0));
        const double rho = std::hypot(double(p.x), double(p.y));
        mask(i, j) = rho < press.touched_mm + mask_beyond_mm ? 255 : 0;
        const auto k = static_cast<std::size_t>(rho / 0.05);
        if (k + 1 < profile.size()) {
          const double part = rho / 0.05 - double(k);
          height(i, j) = S(profile[k] + part * (profile[k + 1] - profile[k]));
        }
      }
    }
  }
  FlatAreaResult<S> operator()() const {
    EquivalentFlatArea<S> area(camera, 120, 120);
    return area(mask, height);
  }
  double error() const {
    const auto found = (*this)();
    REQUIRE(found.ok());
    return double(found.area_mm2) / true_mm2 - 1;
  }
};

}  // namespace

TEST_CASE("equivalent flat area: the balance of the membrane around any contact", "[contact]") {
  rc::prop("what is inside, and where its edge is, does not count", [] {
    Press press;
    press.tension = 0.01 * *rc::gen::inRange(700, 1200);
    press.touched_mm = 0.01 * *rc::gen::inRange(300, 600);
    press.flat_mm = press.touched_mm + 0.01 * *rc::gen::inRange(-50, 150);
    press.bump_mm = 0.01 * *rc::gen::inRange(-50, 50);
    const double beyond_mm = 0.01 * *rc::gen::inRange(-50, 50);
    const Seen<> seen(press, beyond_mm);
    // points 0.5 mm apart resolve a circle's area, and the slope at its rim, to 2 %
    RC_ASSERT(std::abs(seen.error()) < 0.03);
  });
}

TEST_CASE("equivalent flat area: pixels need not be square", "[contact]") {
  for (const double aspect : {0.8, 1.083, 1.25}) {
    CAPTURE(aspect);
    Seen<> seen({5.5, 5, 9, 0, 0.3}, 0, aspect);
    CHECK(std::abs(seen.error()) < 0.03);
  }
}

TEST_CASE("equivalent flat area: a tension that grows with the distance", "[contact]") {
  const Press press{5, 5, 8, 0.001, 0};  // by 20 % from the edge of the contact to that of the pad
  CHECK(std::abs(Seen<>(press).error()) < 0.015);
  CHECK(std::abs(Seen<>({6, 4, 8, 0.001, 0.4}).error()) < 0.015);
}

TEST_CASE("equivalent flat area: the same in float, and what lacks counts for nothing",
          "[contact]") {
  const Press press{5.5, 5, 9, 0, 0.3};
  const Seen<> exact(press);
  CHECK(double(Seen<float>(press)().area_mm2) == Approx(exact().area_mm2).epsilon(1e-3));

  Seen<> noisy(press);
  test::Random random(5);
  for (double& h : noisy.height.cells) {
    h += 0.003 * random.normal();
  }
  CHECK(noisy.error() == Approx(exact.error()).margin(0.05));

  Seen<> with_holes(press);
  for (const auto& [row, col] : {std::pair<Index, Index>{60, 60}, {40, 66}, {70, 30}}) {
    with_holes.height(row, col) = test::nan;
  }
  CHECK(with_holes.error() == Approx(exact.error()).margin(0.02));  // 0.026 if holes were ignored
}

TEST_CASE("equivalent flat area: variance is that of the tension within the first curve",
          "[contact]") {
  const Seen<> seen({5, 5, 8, 0, 0});
  const auto found = seen();
  CHECK(found.variance_mm4 > 0);
  // within 0.8 mm, 1 point and the effect of the steps
  const double first_mm2 = seen.true_mm2 + std::sqrt(found.variance_mm4) / 0.2;
  CHECK(std::sqrt(first_mm2 / std::numbers::pi) == Approx(5 + 0.8).margin(0.4));
}

TEST_CASE("equivalent flat area: no answer where there is none", "[contact]") {
  const Press press{5, 5, 8, 0, 0};
  CHECK(Seen<>(press)().ok());
  CHECK_FALSE(Seen<>(press, 20)().ok());  // no free part
  CHECK_FALSE(Seen<>(press, -6)().ok());  // no contact
  Seen<> steep(press);
  for (double& h : steep.height.cells) {
    h *= 5;
  }
  CHECK_FALSE(steep().ok());
  Seen<> hollow(press);
  for (double& h : hollow.height.cells) {
    h = 20 - h;  // hollow where it is free: no membrane under pressure
  }
  CHECK_FALSE(hollow().ok());
  Seen<> far(press);
  std::fill(far.height.cells.begin(), far.height.cells.end(),
            (std::numeric_limits<double>::infinity)());
  CHECK_FALSE(far().ok());

  EquivalentFlatArea<> area(far.camera, 120, 120);
  CHECK_FALSE(area(Image<std::uint8_t>(120, 119), far.height).ok());
  CHECK_FALSE(area(Image<std::uint8_t>(60, 60), Image<double>(60, 60)).ok());
}

TEST_CASE("equivalent flat area: what has no meaning is refused", "[contact]") {
  CHECK_THROWS_AS(EquivalentFlatArea<>(test::Pad().camera, 0, 10), parameter_error);
}

TEST_CASE("equivalent flat area: the curvature of a surface does not depend on where x points",
          "[contact]") {
  // a camera's points on a slope are displaced along both axes
  test::Random random(8);
  for (int k = 0; k < 20; ++k) {
    Point3<double> at[9], turned_at[9];
    const double angle = random.uniform(0, 6.28);
    for (int p = 0; p < 9; ++p) {
      const double x = p % 3 + random.uniform(-0.2, 0.2);
      const double y = p / 3 + random.uniform(-0.2, 0.2);
      at[p] = {x, y, random.uniform(-0.5, 0.5)};
      turned_at[p] = {std::cos(angle) * x - std::sin(angle) * y,
                      std::sin(angle) * x + std::cos(angle) * y, at[p].z};
    }
    const detail::FlatAreaPoint<double> here(at + 4, 3), turned(turned_at + 4, 3);
    CHECK(turned.area_mm2 == Approx(here.area_mm2).epsilon(1e-12));
    CHECK(turned.flux_mm == Approx(here.flux_mm).epsilon(1e-10).margin(1e-12));
  }
}

TEST_CASE("equivalent flat area: the curvature of a steep sphere is 2 / R", "[contact]") {
  const double radius = 5, step = 0.01;
  for (const Point2<double> middle : {Point2<double>{0, 0}, {3, 0}, {0, -3}, {-2.5, 3}}) {
    Point3<double> at[9];
    for (int p = 0; p < 9; ++p) {
      const double x = middle.x + step * (p % 3 - 1), y = middle.y + step * (p / 3 - 1);
      at[p] = {x, y, std::sqrt(radius * radius - x * x - y * y)};
    }
    const detail::FlatAreaPoint<double> here(at + 4, 3);
    CHECK(here.is_steep == (squared_norm(middle) > square(at[4].z)));
    CHECK(here.area_mm2 == Approx(step * step));
    CHECK(here.flux_mm / here.area_mm2 == Approx(2 / radius).epsilon(1e-3));
  }
}
