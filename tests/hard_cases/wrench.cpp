// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Inputs that no intact pad gives.
#include "fingerpad/force/wrench.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "fingerpad/published/wrench.hpp"
#include "support/by_modulus.hpp"
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
  std::function<detail::membrane::HeightAndSlope<double>(double, double)> height;
  std::function<bool(double, double)> touches;

  template <class S>
  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
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
            return lost(x, y)
                       ? detail::membrane::HeightAndSlope<double>{test::nan, test::nan, test::nan}
                       : film(x, y);
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

/// Whether a result is consistent, for any input.
template <class S>
bool consistent(const WrenchResult<S>& r) {
  const auto finite = [](const Point3<S>& p) { return is_finite(p); };
  const auto missing = [](const Point3<S>& p) { return p.x != p.x && p.y != p.y && p.z != p.z; };
  if (r.status == WrenchStatus::refused) {
    return missing(r.force_n) && missing(r.moment_n_mm);
  }
  for (const auto& row : r.covariance) {
    for (const S& x : row) {
      if (!is_finite(x)) {
        return false;
      }
    }
  }
  if (!r.ok()) {
    return missing(r.force_n) && missing(r.moment_n_mm) && r.residual != r.residual;
  }
  return finite(r.force_n) && finite(r.moment_n_mm);
}

/// With the inclination of the stress-free membrane.
struct CarriedRow : OneRow {
  CarriedRow() : OneRow{1.06} {}
};

template <class Solver, class Row = OneRow, class Law = ClampedRim, class Lines = StraightLines>
struct Way {
  template <class S>
  using Of = test::WrenchBy<Solver, Row, Law, Lines, S>;
  static constexpr Index rows = Row::rows;
  static Row row() { return {}; }
};

template <class S = double>
WrenchOptions<S> small() {
  WrenchOptions<S> options;
  options.columns = 24;
  options.rows = 10;
  return options;
}

template <class W>
WrenchResult<double> measure(const Shape& shape,
                             const Image<Point3<double>>& dots = good_dots(),
                             double pressure_mpa = pressed_mpa) {
  const W wrench(rim_of(film).borders(), small());
  auto workspace = wrench.workspace();
  const auto r = wrench(shape, dots, pressure_mpa, workspace, {0.005, 0.1, 1e-5});
  CHECK(r.status != WrenchStatus::refused);
  CHECK(consistent(r));
  for (Index k = 0; k < workspace.rim_points(); ++k) {
    const bool known = is_finite(workspace.rim_tension(k));
    CHECK(known == (r.status == WrenchStatus::ok));
  }
  return r;
}

using Balanced = Wrench<BalancedRim>;

}  // namespace

TEST_CASE("wrench: pressures that are none", "[wrench]") {
  for (const double p : {0.0, -0.0, -0.01, test::nan, infinity, -infinity}) {
    CAPTURE(p);
    CHECK(measure<Balanced>(pressed(), good_dots(), p).status == WrenchStatus::bad_pressure);
    CHECK(measure<test::ByModulus<>>(pressed(), good_dots(), p).status ==
          WrenchStatus::bad_pressure);
  }
  for (const double p : {1e-300, 1e-12, 1e12, 1e300}) {
    CAPTURE(p);
    (void)measure<Balanced>(pressed(), good_dots(), p);
    (void)measure<Wrench<LeastSquares>>(pressed(), good_dots(), p);
    (void)measure<Wrench<published::Iteration>>(pressed(), good_dots(), p);
  }
}

TEST_CASE("wrench: side dots that are missing", "[wrench]") {
  const auto all = measure<Balanced>(pressed());
  REQUIRE(all.status == WrenchStatus::ok);
  for (const double bad : {test::nan, infinity, -infinity, 1e308}) {
    for (const int lost : {1, 12, 24, 25, 40, 72}) {
      auto dots = good_dots();
      for (Index k = 0; k < lost; ++k) {
        auto& p = dots(0, 29 * k % 72);  // scattered
        (k % 3 == 0 ? p.x : k % 3 == 1 ? p.y : p.z) = bad;
      }
      const auto r = measure<Balanced>(pressed(), dots);
      CAPTURE(bad, lost);
      CHECK(r.missing == lost);
      CHECK(r.status == (lost <= 24 ? WrenchStatus::ok : WrenchStatus::too_few_side_dots));
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
  const auto r = measure<Balanced>(pressed(), dots);
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
  const auto slack = measure<Balanced>(pressed(), stretched_to(0.9, 0, 10));
  CHECK(slack.status == WrenchStatus::ok);
  CHECK(slack.slack == 10);
  CHECK(slack.unstretched == 10);
  CHECK(slack.missing == 0);
  const auto all_slack = measure<Balanced>(pressed(), stretched_to(0.9, 0, 72));
  CHECK(all_slack.status == WrenchStatus::unstretched);
  CHECK(all_slack.slack == 72);
  const auto barely = measure<Balanced>(pressed(), stretched_to(1.002, 0, 30));
  CHECK(barely.status == WrenchStatus::unstretched);
  CHECK(barely.slack == 0);
  CHECK(barely.unstretched == 30);
  // pulls that lean outward: overhang, which the camera does not see
  const auto bulging = measure<Balanced>(pressed(), stretched_to(1.1, 20, 25, 1));
  CHECK(bulging.status == WrenchStatus::ok);
  CHECK(bulging.outward == 5);
  CHECK(measure<Balanced>(pressed()).outward == 0);
  // all pulls downward
  auto downward = good_dots();
  for (auto& p : downward.cells) {
    p.z = -p.z;
  }
  for (const auto& r : {measure<Balanced>(pressed(), downward),
                        measure<Wrench<published::ClosedForm>>(pressed(), downward),
                        measure<Wrench<published::Iteration>>(pressed(), downward)}) {
    CHECK(r.status == WrenchStatus::side_dots_below_base);
  }
}

TEST_CASE("wrench: shapes with holes", "[wrench]") {
  const auto whole = measure<Balanced>(pressed());
  // specks on single lines are bridged
  const auto near = [](double x, double y, double r) { return std::hypot(x - 14, y) < r; };
  const auto speck =
      measure<Balanced>(with_hole([&](double x, double y) { return near(x, y, 1); }));
  CHECK(speck.status == WrenchStatus::ok);
  CHECK(speck.broken_lines >= 1);
  CHECK(speck.force_n.z == Approx(whole.force_n.z).epsilon(0.02));
  const auto large = measure<Balanced>(with_hole([](double x, double) { return x > 0; }));
  CHECK(large.status == WrenchStatus::no_shape);
  CHECK(large.broken_lines >= 8);
  const auto nothing = measure<Balanced>(with_hole([](double, double) { return true; }));
  CHECK(nothing.status == WrenchStatus::no_shape);
  // the rim is invisible, as on half of all pads
  const auto no_rim =
      measure<Balanced>(with_hole([](double x, double y) { return std::hypot(x, y) > 18.3; }));
  CHECK(no_rim.status == WrenchStatus::ok);
  CHECK(no_rim.force_n.z == Approx(whole.force_n.z).epsilon(0.02));
  const auto all_but_top =
      measure<Balanced>(with_hole([](double x, double y) { return std::hypot(x, y) > 9; }));
  CHECK(all_but_top.status == WrenchStatus::no_shape);
}

TEST_CASE("wrench: on a round pad a line through a hole is that of its neighbours, rotated",
          "[wrench]") {
  detail::membrane::Compartments<double> whole(16, 6, film.radius_mm, {0.4, 0.5, 2});
  auto holed = whole;
  whole.lay<StraightLines>(pressed(), {0, 0, 0});
  REQUIRE(whole.broken() == 0);
  // one line, two adjacent lines, and the first and last of all
  const auto is_lost = [](int line) {
    return line == 0 || line == 4 || line == 9 || line == 10 || line == 15;
  };
  const auto lost = [&](double x, double y) {
    const double line = 16 * std::atan2(y, x) / (2 * std::numbers::pi);
    const double at = std::hypot(x, y);
    return at > 13 && at < 14 && is_lost((static_cast<int>(std::lround(line)) + 16) % 16);
  };
  holed.lay<StraightLines>(with_hole(lost), {0, 0, 0});
  CHECK(holed.broken() == 5);
  for (Index line = 0; line < 16; ++line) {
    CAPTURE(line);
    for (Index row = 0; row <= 6; ++row) {
      CHECK(std::sqrt(squared_norm(holed.node(line, row) - whole.node(line, row))) < 1e-9);
    }
  }
}

TEST_CASE("wrench: a line whose rim point is the center of the contact has no direction",
          "[wrench]") {
  detail::membrane::Meridian<double> line(100);
  const Point3<double> rim = {-film.radius_mm, 0, 0};
  line.trace<true>(touching([](double, double) { return false; }), rim, rim, {0.4, 0.5, 2});
  CHECK(line.end() == detail::membrane::LineEnd::hole);
  for (const Point3<double>& p : line.points()) {
    CHECK((p.x == rim.x && p.y == rim.y));
  }
}

TEST_CASE("wrench: odd contacts", "[wrench]") {
  // contact that reaches the rim all around, and on one side
  (void)measure<Balanced>(touching([](double, double) { return true; }));
  (void)measure<Balanced>(touching([](double x, double) { return x > 5; }));
  (void)measure<Wrench<LeastSquares>>(touching([](double x, double) { return x > 5; }));
  (void)measure<Wrench<published::Iteration>>(touching([](double x, double) { return x > 5; }));
  // a single position of the search, and one that it does not see
  const double one = 18.735 / 64;
  CHECK(measure<Balanced>(touching([&](double x, double y) {
          return std::hypot(x - one, y - one) < 0.05;
        })).ok());
  CHECK(measure<Balanced>(touching([](double x, double y) {
          return x == 0.123 && y == 0.456;
        })).status == WrenchStatus::no_contact);
  // two contacts, a ring, a checkerboard
  (void)measure<Balanced>(
      touching([](double x, double y) { return std::abs(x) > 3 && std::abs(y) < 6; }));
  (void)measure<Balanced>(touching([](double x, double y) {
    const double r = std::hypot(x, y);
    return r > 4 && r < 8;
  }));
  (void)measure<Balanced>(touching([](double x, double y) {
    return (static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) % 2 == 0;
  }));
  // off center
  const auto aside =
      measure<Balanced>(touching([](double x, double y) { return std::hypot(x - 3, y + 2) < 4; }));
  CHECK(aside.status != WrenchStatus::refused);
}

TEST_CASE("wrench: shapes that no membrane has", "[wrench]") {
  const auto each = [](const Shape& shape) {
    (void)measure<Balanced>(shape);
    (void)measure<Wrench<published::ClosedForm>>(shape);
    (void)measure<Wrench<published::Iteration>>(shape);
    (void)measure<Wrench<LeastSquares>>(shape);
    (void)measure<
        Wrench<published::Iteration, OneRow, published::Direction, published::SteepestLines>>(
        shape);
  };
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 8; };
  const auto flat = [](double h, double x, double y) {
    return detail::membrane::HeightAndSlope<double>{h, x, y};
  };
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
detail::membrane::HeightMap<S> any_map() {
  detail::membrane::HeightMap<S> map(S(19.5), S(1.5));
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

template <class Way, class S>
void fuzz() {
  rc::prop("garbage", [] {
    using W = typename Way::template Of<S>;
    const RimOfDots rim = rim_of(film);
    WrenchOptions<S> options = small<S>();
    options.columns = test::whole(8, 30);
    options.rows = test::whole(2, 12);
    options.line_step_mm = S(test::log_uniform(0.02, 1.8));
    options.blur_mm = S(test::uniform(0, 4));
    options.reach_mm = S(4.01) * options.line_step_mm * S(test::log_uniform(1, 20));
    const W wrench(as<S>(rim.borders()), options, {}, Way::row());
    auto workspace = wrench.workspace();
    const detail::membrane::HeightMap<S> map = any_map<S>();
    auto dots = rim.dots(even_load, Way::rows);
    const double shake = test::whole(0, 1) == 0 ? 0 : test::log_uniform(1e-3, 3);
    for (auto& p : dots.cells) {
      p = {any_number(p.x + test::uniform(-shake, shake)),
           any_number(p.y + test::uniform(-shake, shake)),
           any_number(p.z + test::uniform(-shake, shake))};
    }
    const auto r = wrench(map, as<S>(dots), S(any_number(pressed_mpa)), workspace,
                          {S(0.005), S(0.1), S(1e-5)});
    RC_ASSERT(r.status != WrenchStatus::refused);
    RC_ASSERT(consistent(r));
    RC_ASSERT(r.missing >= 0);
    RC_ASSERT(r.missing + r.unstretched <= 72);
    RC_ASSERT(r.slack <= r.unstretched);
    RC_ASSERT(r.broken_lines <= options.columns);
    RC_ASSERT(r.level_lines <= options.columns);
    // a later good frame is not affected
    const auto good = rim.dots(even_load, Way::rows);
    const auto again = wrench(film, as<S>(good), S(pressed_mpa), workspace);
    auto fresh_workspace = wrench.workspace();
    const auto fresh = wrench(film, as<S>(good), S(pressed_mpa), fresh_workspace);
    RC_ASSERT(again.status == fresh.status);
    RC_ASSERT(test::same_bits(again.force_n.z, fresh.force_n.z));
    RC_ASSERT(test::same_bits(again.moment_n_mm.y, fresh.moment_n_mm.y));
  });
}

}  // namespace

TEMPLATE_TEST_CASE(
    "wrench: whatever is given, it answers and says how well",
    "[wrench]",
    Way<BalancedRim>,
    (Way<BalancedRim, TwoRows, ClampedRim, published::SteepestLines>),
    (Way<BalancedRim, CarriedRow>),
    Way<published::ClosedForm>,
    Way<test::KnownModulus>,
    Way<published::Iteration>,
    (Way<published::Iteration, OneRow, published::Direction, published::SteepestLines>),
    Way<LeastSquares>,
    (Way<LeastSquares, OneRow, published::Direction, published::SteepestLines>)) {
  fuzz<TestType, double>();
  fuzz<TestType, float>();
}
