// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Inputs that no intact pad gives.
#include "fingerpad/force/wrench.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "fingerpad/published/segment_equilibrium.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pressed_pad.hpp"

using namespace fingerpad;
using test::as;
using test::FilmSide;
using test::Image;
using test::pressed_mpa;
using test::RimLoad;
using test::RimOfDots;
using test::RoundPad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Any shape, in double.
struct Shape {
  std::function<MembranePoint<double>(double, double)> height;
  std::function<bool(double, double)> touches;

  template <class S>
  MembranePoint<S> operator()(const S& x, const S& y) const {
    const auto h = height(static_cast<double>(x), static_cast<double>(y));
    return {S(h.height_mm), S(h.along_x), S(h.along_y)};
  }
  template <class S>
  bool in_contact(const S& x, const S& y) const {
    return touches(static_cast<double>(x), static_cast<double>(y));
  }
};

const RoundPad<FilmSide> film;

Shape pressed() {
  return {[](double x, double y) { return film(x, y); },
          [](double x, double y) { return film.in_contact(x, y); }};
}
/// A pressed pad that is invisible where `lost(x, y)`.
Shape with_hole(const std::function<bool(double, double)>& lost) {
  return {[lost](double x, double y) {
            return lost(x, y) ? MembranePoint<double>{test::nan, test::nan, test::nan} : film(x, y);
          },
          [lost](double x, double y) { return !lost(x, y) && film.in_contact(x, y); }};
}
/// A contact flag that does not fit the shape.
Shape touching(const std::function<bool(double, double)>& touches) {
  return {[](double x, double y) { return film(x, y); }, touches};
}

RimLoad even_load(double) {
  return {film.tension(film.radius_mm, pressed_mpa), 0.02};
}

Image<Point3<double>> good_dots() {
  return rim_of(film).dots(even_load);
}

bool missing(const auto& p) {
  return p.x != p.x && p.y != p.y && p.z != p.z;
}

/// Whether a result is consistent, for any input.
template <class Result>
bool consistent(const Result& r) {
  return r.ok() || is_finite(r.force_n) ? is_finite(r.force_n) && is_finite(r.moment_n_mm)
                                        : missing(r.force_n) && missing(r.moment_n_mm);
}

WrenchResult<double> measure(const Shape& shape,
                             const Image<Point3<double>>& dots = good_dots(),
                             double pressure_mpa = pressed_mpa) {
  Wrench<> wrench(rim_of(film).borders());
  const auto r = wrench(shape, dots, pressure_mpa);
  CHECK(r.status != WrenchStatus::refused);
  CHECK(consistent(r));
  for (Index k = 0; k < wrench.side_dots(); ++k) {
    CHECK(is_finite(wrench.rim_tension(k)) == (r.status == WrenchStatus::ok));
  }
  return r;
}
published::SegmentResult<double> printed(const Shape& shape,
                                         const Image<Point3<double>>& dots = good_dots(),
                                         double pressure_mpa = pressed_mpa) {
  published::SegmentEquilibrium<> wrench(rim_of(film).borders());
  const auto r = wrench(shape, dots, pressure_mpa);
  CHECK(r.status != published::SegmentStatus::refused);
  CHECK(consistent(r));
  return r;
}

}  // namespace

TEST_CASE("wrench: pressures that are none", "[wrench]") {
  Wrench<> by_modulus(rim_of(film).borders(), {.modulus_n_per_mm = 0.5});
  for (const double p : {0.0, -0.0, -0.01, test::nan, infinity, -infinity, 1e12, 1e300}) {
    CAPTURE(p);
    CHECK(measure(pressed(), good_dots(), p).status == WrenchStatus::bad_pressure);
    CHECK(by_modulus.by_modulus(good_dots(), p).status == WrenchStatus::bad_pressure);
    (void)printed(pressed(), good_dots(), p);
  }
  for (const double p : {1e-300, 1e-12}) {
    CAPTURE(p);
    (void)measure(pressed(), good_dots(), p);
    (void)printed(pressed(), good_dots(), p);
  }
}

TEST_CASE("wrench: side dots that are missing", "[wrench]") {
  const auto all = measure(pressed());
  REQUIRE(all.status == WrenchStatus::ok);
  for (const double bad : {test::nan, infinity, -infinity, 1e308}) {
    for (const int lost : {1, 12, 24, 25, 40, 72}) {
      auto dots = good_dots();
      for (Index k = 0; k < lost; ++k) {
        auto& p = dots(0, 29 * k % 72);  // scattered
        (k % 3 == 0 ? p.x : k % 3 == 1 ? p.y : p.z) = bad;
      }
      const auto r = measure(pressed(), dots);
      CAPTURE(bad, lost);
      CHECK(r.faults.missing == lost);
      CHECK(r.status == (lost <= 24 ? WrenchStatus::ok : WrenchStatus::bad_side_dots));
      if (lost <= 24) {
        CHECK(r.force_n.z == Approx(all.force_n.z).epsilon(1e-3));
        CHECK(r.moment_n_mm.z == Approx(all.moment_n_mm.z).epsilon(1e-3));
      }
    }
  }
  // a contiguous third
  auto dots = good_dots();
  for (Index k = 10; k < 34; ++k) {
    dots(0, k).z = test::nan;
  }
  const auto r = measure(pressed(), dots);
  CHECK(r.status == WrenchStatus::ok);
  CHECK(r.force_n.z == Approx(all.force_n.z).epsilon(1e-3));
}

TEST_CASE("wrench: a slack membrane, one that is not stretched, one that bulges", "[wrench]") {
  const auto stretched_to = [](double stretch, Index from, Index to, double lean = 0) {
    const RimOfDots rim = rim_of(film);
    auto dots = good_dots();
    for (Index k = from; k < to; ++k) {
      const auto m = rim.upward(k), b = rim.border(k);
      const double out = 2 * lean;
      dots(0, k) = {b.x + 0.8 * stretch * (m.x - out * m.x),
                    b.y + 0.8 * stretch * (m.y - out * m.y), b.z + 0.8 * stretch * m.z};
    }
    return dots;
  };
  const auto slack = measure(pressed(), stretched_to(0.9, 0, 10));
  CHECK(slack.status == WrenchStatus::ok);
  CHECK(slack.faults.unstretched == 10);
  CHECK(slack.faults.missing == 0);
  const auto all_slack = measure(pressed(), stretched_to(0.9, 0, 72));
  CHECK(all_slack.status == WrenchStatus::bad_side_dots);
  CHECK(all_slack.faults.unstretched == 72);
  const auto barely = measure(pressed(), stretched_to(1.002, 0, 30));
  CHECK(barely.status == WrenchStatus::bad_side_dots);
  CHECK(barely.faults.unstretched == 30);
  // pulls that lean outward: overhang, which the camera does not see
  const auto bulging = measure(pressed(), stretched_to(1.1, 20, 25, 1));
  CHECK(bulging.status == WrenchStatus::ok);
  // all pulls downward
  auto downward = good_dots();
  for (auto& p : downward.cells) {
    p.z = -p.z;
  }
  const auto down = measure(pressed(), downward);
  CHECK(down.status == WrenchStatus::bad_side_dots);
  CHECK(down.faults.misplaced == 72);
  CHECK(printed(pressed(), downward).status == published::SegmentStatus::bad_input);
}

TEST_CASE("wrench: shapes with holes", "[wrench]") {
  const auto whole = measure(pressed());
  // specks on single lines are bridged
  const auto near = [](double x, double y, double r) { return std::hypot(x - 14, y) < r; };
  const auto speck = measure(with_hole([&](double x, double y) { return near(x, y, 1); }));
  CHECK(speck.status == WrenchStatus::ok);
  CHECK(speck.force_n.z == Approx(whole.force_n.z).epsilon(0.02));
  const auto large = measure(with_hole([](double x, double) { return x > 0; }));
  CHECK(large.status == WrenchStatus::no_shape);
  const auto nothing = measure(with_hole([](double, double) { return true; }));
  CHECK(nothing.status == WrenchStatus::no_shape);
  // the rim is invisible, as on half of all pads
  const auto no_rim =
      measure(with_hole([](double x, double y) { return std::hypot(x, y) > 18.3; }));
  CHECK(no_rim.status == WrenchStatus::ok);
  CHECK(no_rim.force_n.z == Approx(whole.force_n.z).epsilon(0.02));
  const auto all_but_top =
      measure(with_hole([](double x, double y) { return std::hypot(x, y) > 9; }));
  CHECK(all_but_top.status == WrenchStatus::no_shape);
}

TEST_CASE("wrench: on a round pad a line through a hole is that of its neighbours, rotated",
          "[wrench]") {
  const auto whole = measure(pressed());
  // one line, two adjacent lines, and the first and last of all
  const auto is_lost = [](int line) {
    return line == 0 || line == 4 || line == 9 || line == 10 || line == 71;
  };
  const auto holed = measure(with_hole([&](double x, double y) {
    const double line = 72 * std::atan2(y, x) / (2 * std::numbers::pi), at = std::hypot(x, y);
    return at > 13 && at < 14 && is_lost((static_cast<int>(std::lround(line)) + 72) % 72);
  }));
  CHECK(holed.force_n.z == Approx(whole.force_n.z).epsilon(1e-9));
  CHECK(holed.summit_area_mm2 == Approx(whole.summit_area_mm2).epsilon(1e-9));
}

TEST_CASE("wrench: a line whose rim point is the center of the contact has no direction",
          "[wrench]") {
  const double step = film.radius_mm / 32;
  (void)measure(
      touching([&](double x, double y) { return std::hypot(x + film.radius_mm, y) < step; }));
}

TEST_CASE("wrench: an odd contact gets the same answer after any other frame", "[wrench]") {
  const auto ring = touching([](double x, double y) {
    const double r = std::hypot(x - 2, y);
    return r > 4 && r < 5;
  });
  const auto beyond = touching([](double x, double) { return x < -9; });
  const auto two = touching([](double x, double y) { return std::hypot(x, y) > 15; });
  for (const Shape& odd : {ring, beyond, two}) {
    Wrench<> fresh(rim_of(film).borders()), used = fresh;
    (void)used(pressed(), good_dots(), pressed_mpa);
    const auto first = fresh(odd, good_dots(), pressed_mpa);
    const auto later = used(odd, good_dots(), pressed_mpa);
    CHECK(first.status == later.status);
    CHECK(test::same_bits(first.force_n.z, later.force_n.z));
    CHECK(test::same_bits(first.moment_n_mm.x, later.moment_n_mm.x));
    CHECK(consistent(first));
  }
}

TEST_CASE("wrench: odd contacts", "[wrench]") {
  // contact that reaches the rim all around, and on one side
  (void)measure(touching([](double, double) { return true; }));
  (void)measure(touching([](double x, double) { return x > 5; }));
  (void)printed(touching([](double x, double) { return x > 5; }));
  // a single position of the search, and one that it does not see
  const double one = 18.735 / 64;
  CHECK(measure(touching([&](double x, double y) {
          return std::hypot(x - one, y - one) < 0.05;
        })).ok());
  CHECK(measure(touching([](double x, double y) { return x == 0.123 && y == 0.456; })).status ==
        WrenchStatus::no_contact);
  // two contacts, a ring, a checkerboard
  (void)measure(touching([](double x, double y) { return std::abs(x) > 3 && std::abs(y) < 6; }));
  (void)measure(touching([](double x, double y) {
    const double r = std::hypot(x, y);
    return r > 4 && r < 8;
  }));
  (void)measure(touching([](double x, double y) {
    return (static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) % 2 == 0;
  }));
  // off center
  const auto aside =
      measure(touching([](double x, double y) { return std::hypot(x - 3, y + 2) < 4; }));
  CHECK(aside.status != WrenchStatus::refused);
}

TEST_CASE("wrench: shapes that no membrane has", "[wrench]") {
  const auto each = [](const Shape& shape) {
    (void)measure(shape);
    (void)printed(shape);
  };
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 8; };
  const auto flat = [](double h, double x, double y) { return MembranePoint<double>{h, x, y}; };
  each({[&](double, double) { return flat(0, 0, 0); }, disc});
  each(
      {[&](double x, double y) { return flat(-film(x, y).height_mm, 0.5, 0.5); }, disc});  // a bowl
  each({[&](double x, double) { return flat(x, 1, 0); }, disc});  // a slope
  each({[&](double, double) { return flat(1e300, 1e300, -1e300); }, disc});
  each({[&](double x, double) { return flat(5, x > 0 ? infinity : test::nan, 0); }, disc});
  each({[&](double x, double y) {  // ripples
          return flat(film(x, y).height_mm + std::sin(5 * x),
                      film(x, y).along_x + 5 * std::cos(5 * x), film(x, y).along_y);
        },
        disc});
  each({[&](double x, double y) {  // a saddle
          return flat(9 + 0.02 * (x * x - y * y), 0.04 * x, -0.04 * y);
        },
        disc});
  each({[&](double x, double y) {  // slopes that contradict the heights: lines never end
          return flat(film(x, y).height_mm, -y, x);
        },
        [](double x, double y) { return std::hypot(x - 18, y) < 0.9; }});
  test::Random random(4);
  each({[&](double, double) {
          return flat(random.uniform(-5, 20), random.uniform(-3, 3), random.uniform(-3, 3));
        },
        [&](double, double) { return random.uniform() < 0.3; }});
}

namespace {

/// A number that may be anything.
double any_number(double usual) {
  const double odd[] = {test::nan, infinity, -infinity, 0, 1e300, -1e300, 1e-300, -usual};
  const auto kind = test::whole(0, 39);
  return kind < 8 ? odd[kind] : usual;
}

/// A shape of lumps, holes and slopes that need not fit the heights.
template <class S>
HeightMap<S> any_map() {
  HeightMap<S> map(S(19.5), S(1.5));
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  const double noise = test::whole(0, 1) == 0 ? 0 : test::log_uniform(1e-3, 10);
  const double holes = test::whole(0, 1) == 0 ? 0 : test::uniform(0, 0.3);
  const double radius = test::uniform(0, 20), x0 = test::uniform(-9, 9), y0 = test::uniform(-9, 9);
  const double flip = test::whole(0, 7) == 0 ? -1 : 1;
  map.fill(
      [&](Index i, Index j) {
        const double x = static_cast<double>(map.position_mm(j)),
                     y = static_cast<double>(map.position_mm(i));
        const double z = flip * film.height(std::hypot(x, y)) + noise * random.normal();
        return random.uniform() < holes ? not_a_number<S>() : S(z);
      },
      [&](Index i, Index j, const auto&...) {
        const double x = static_cast<double>(map.position_mm(j)) - x0,
                     y = static_cast<double>(map.position_mm(i)) - y0;
        return S(std::hypot(x, y) < radius ? 1 : random.uniform(0, 0.6));
      });
  return map;
}

template <class S>
void fuzz() {
  rc::prop("garbage", [] {
    const RimOfDots rim = rim_of(film);
    WrenchOptions<S> options;
    options.line_step_mm = S(test::log_uniform(0.02, 1.8));
    options.blur_mm = S(test::uniform(0, 4));
    options.reach_mm = S(4.01) * options.line_step_mm * S(test::log_uniform(1, 20));
    if (test::whole(0, 1) == 1) {
      options.stress_free_inclination_rad = test::uniform(0, 1.5);
      options.mooney_share = S(test::uniform(0, 1));
    }
    if (test::whole(0, 1) == 1) {
      options.modulus_n_per_mm = S(test::log_uniform(0.05, 5));
    }
    Wrench<S> wrench(as<S>(rim.borders()), options);
    published::SegmentEquilibrium<S> segments(as<S>(rim.borders()));
    auto fresh = wrench;
    const HeightMap<S> map = any_map<S>();
    auto dots = rim.dots(even_load);
    const double shake = test::whole(0, 1) == 0 ? 0 : test::log_uniform(1e-3, 3);
    for (auto& p : dots.cells) {
      p = {any_number(p.x + test::uniform(-shake, shake)),
           any_number(p.y + test::uniform(-shake, shake)),
           any_number(p.z + test::uniform(-shake, shake))};
    }
    const S pressure = S(any_number(pressed_mpa));
    RC_ASSERT(consistent(segments(map, as<S>(dots), pressure)));
    const auto r = wrench(map, as<S>(dots), pressure);
    RC_ASSERT(r.status != WrenchStatus::refused);
    RC_ASSERT(consistent(r));
    RC_ASSERT(r.faults.missing >= 0);
    RC_ASSERT(r.faults.missing + r.faults.unstretched + r.faults.misplaced <= 72);
    // a later good frame is not affected
    const auto good = as<S>(rim.dots(even_load));
    const auto again = wrench(film, good, S(pressed_mpa));
    const auto first = fresh(film, good, S(pressed_mpa));
    RC_ASSERT(again.status == first.status);
    RC_ASSERT(test::same_bits(again.force_n.z, first.force_n.z));
    RC_ASSERT(test::same_bits(again.moment_n_mm.y, first.moment_n_mm.y));
  });
}

}  // namespace

TEMPLATE_TEST_CASE("wrench: whatever is given, it answers and says how well",
                   "[wrench]",
                   double,
                   float) {
  fuzz<TestType>();
}
