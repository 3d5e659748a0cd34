// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The six-axis force as printed: its lines and contours, its tensions, and what it loses.
#include "fingerpad/published/segment_equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "support/catch.hpp"
#include "support/pressed_pad.hpp"
#include "support/refusal.hpp"
#include "support/wrench_frames.hpp"

using namespace fingerpad;
using published::SegmentEquilibrium;
using published::SegmentEquilibriumOptions;
using test::ArcSide;
using test::FilmSide;
using test::MembranePoint;
using test::pressed_mpa;
using test::RimLoad;
using test::RoundPad;

namespace {

using Options = SegmentEquilibriumOptions<double>;

/// A mound that is level at the rim, with its summit 2.8 mm off the middle.
struct Mound {
  template <class S>
  MembranePoint<S> operator()(const S& x, const S& y) const {
    constexpr double r = 18.735;
    const double u = value(x) / r, v = value(y) / r, lean = 1 + 0.3 * u, cap = 1 - u * u - v * v;
    return {S(9 * cap * lean), S(9 * (-2 * u * lean + 0.3 * cap) / r), S(9 * -2 * v * lean / r)};
  }
  template <class S>
  bool in_contact(const S& x, const S& y) const {
    return (*this)(x, y).height_mm > 8.5;
  }
};

/// A dome on a plate of 6 mm that is tilted by ten degrees along x.
struct TiltedTop {
  template <class S>
  MembranePoint<S> operator()(const S& x, const S& y) const {
    constexpr double sq = 18.735 * 18.735;
    const double u = value(x), v = value(y);
    return in_contact(x, y) ? MembranePoint<S>{S(8.3 - 0.176 * u), S(-0.176), S(0)}
                            : MembranePoint<S>{S(9 * (1 - (u * u + v * v) / sq)), S(-18 * u / sq),
                                               S(-18 * v / sq)};
  }
  template <class S>
  bool in_contact(const S& x, const S& y) const {
    return value(x * x + y * y) < 36;
  }
};

/// Sine of the angle between a step from a to b and the gradient of the heights between them.
double off_gradient(const Mound& mound, const Point3<double>& a, const Point3<double>& b) {
  const auto at = mound((a.x + b.x) / 2, (a.y + b.y) / 2);
  const double dx = b.x - a.x, dy = b.y - a.y;
  return std::abs(dx * at.along_y - dy * at.along_x) /
         (std::hypot(dx, dy) * std::hypot(at.along_x, at.along_y));
}

}  // namespace

TEST_CASE("published six-axis force: a press, and what the direction of the side dots loses",
          "[published]") {
  const RoundPad<FilmSide> pad;
  const auto rim = rim_of(pad);
  const double normal = pad.tension(pad.radius_mm, pressed_mpa);
  SegmentEquilibrium<> wrench(rim.borders());
  CHECK(wrench.lines() == 72);
  const auto press = wrench(pad, rim.dots([&](double) { return RimLoad{normal, 0}; }), pressed_mpa);
  REQUIRE(press.ok());
  const double area = 3.14159265 * pad.contact_mm * pad.contact_mm;
  CHECK(press.force_n.z == Approx(-pressed_mpa * area).epsilon(0.03));
  CHECK(std::hypot(press.force_n.x, press.force_n.y) < 1e-9);
  CHECK(norm(press.moment_n_mm) < 1e-6);
  // shear carries 1 / lambda^4 more than the direction of the dots says
  const auto load = [&](double) { return RimLoad{normal, 0.1 * normal}; };
  const auto twist = wrench(pad, rim.dots(load), pressed_mpa);
  const double share = 1 - std::pow(rim.stretch(normal), -4);
  CHECK((share > 0.1 && share < 0.7));
  CHECK(twist.moment_n_mm.z / wrench_of(rim, load, pressed_mpa).moment_n_mm.z ==
        Approx(share).epsilon(0.03));
}

TEST_CASE("published six-axis force: f_h of a flat press, in closed form", "[published]") {
  // f_v K_1 + f_h K_2 = p, with the arc's curvature along the meridian and sin(phi) / r around
  const RoundPad<ArcSide> pad;
  auto rim = rim_of(pad);
  rim.count = 36;
  const double p = pressed_mpa, normal = pad.tension(pad.radius_mm, p);
  SegmentEquilibrium<> wrench(rim.borders(), {.delta_z_mm = 0.28, .contours = 32});
  const auto r = wrench(pad, rim.dots([&](double) { return RimLoad{normal, 0}; }), p);
  REQUIRE(r.ok());
  double worst = 0, largest = 0;
  for (Index j = 5; j < 27; ++j) {
    const auto &low = wrench.node(3, j), &up = wrench.node(3, j + 1);
    const double at = (std::hypot(low.x, low.y) + std::hypot(up.x, up.y)) / 2;
    const double truth = (p - pad.tension(at, p) / pad.bend_mm()) * at / pad.sine(at);
    worst = (std::max)(worst, std::abs(wrench.f_h(3, j) - truth));
    largest = (std::max)(largest, std::abs(truth));
  }
  CHECK(worst < 0.07 * largest);
}

TEST_CASE("published six-axis force: contour lines every 0.2 mm, of each line its own number",
          "[published]") {
  const Mound mound;
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  SegmentEquilibrium<> wrench(rim.borders());
  (void)wrench(mound, rim.dots([&](double) { return RimLoad{0.1, 0}; }), pressed_mpa);
  int cut = 0;
  for (Index i = 0; i < 72; ++i) {
    const double end = wrench.node(i, 70).z;
    CHECK(end == Approx(8.5).margin(0.1));  // where it touches
    Index own = 0;
    for (Index j = 0; j <= 70; ++j) {
      const double contour = 0.2 * static_cast<double>(j);
      CHECK(wrench.node(i, j).z == Approx((std::min)(contour, end)).margin(2e-3));
      own += contour < end ? 1 : 0;
    }
    CHECK(own == static_cast<Index>(std::ceil(end / 0.2)));
    cut += own < 70 ? 1 : 0;
  }
  CHECK(cut == 72);
  // along the gradient, not straight toward the summit
  for (const Index i : {9, 18, 27, 45, 54, 63}) {
    for (Index j = 5; j < 30; ++j) {
      CAPTURE(i, j);
      CHECK(off_gradient(mound, wrench.node(i, j), wrench.node(i, j + 1)) < 0.06);
    }
  }
}

TEST_CASE("the printed iteration keeps the symmetry of a press and of a mirror", "[published]") {
  const RoundPad<FilmSide> pad;
  const auto rim = rim_of(pad);
  const double normal = pad.tension(pad.radius_mm, pressed_mpa);
  SegmentEquilibrium<> wrench(rim.borders());
  REQUIRE(wrench(pad, rim.dots([&](double) { return RimLoad{normal, 0}; }), pressed_mpa).ok());
  for (Index i = 1; i < 72; ++i) {  // the normal of a border is between those of both sides
    CHECK(wrench.f_h(i, 15) == Approx(wrench.f_h(0, 15)).epsilon(1e-6));
  }
  const auto load = [&](double at) {
    return RimLoad{normal * (1 + 0.2 * std::cos(at - 0.4)), normal * (0.05 + 0.1 * std::sin(at))};
  };
  const auto mirrored = [&](double at) {
    const RimLoad there = load(-at);
    return RimLoad{there.normal, -there.shear};
  };
  const auto a = wrench(pad, rim.dots(load), pressed_mpa);
  const auto b = wrench(pad, rim.dots(mirrored), pressed_mpa);
  REQUIRE((a.ok() && b.ok()));
  CHECK(norm(b.force_n - Point3<double>{a.force_n.x, -a.force_n.y, a.force_n.z}) < 1e-9);
  CHECK(norm(b.moment_n_mm - Point3<double>{-a.moment_n_mm.x, a.moment_n_mm.y, -a.moment_n_mm.z}) <
        1e-8);
  CHECK(norm(a.moment_n_mm) > 1);
}

TEST_CASE("the printed iteration begins at the first line that ends level", "[published]") {
  // on a plate tilted by ten degrees along x the lines from 55 degrees on are level: which of those
  // before has the number 0 does not matter, in the first pass either
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  const auto renumbered = [&](const auto& cells, Index first) {
    auto moved = cells;
    for (Index i = 0; i < 72; ++i) {
      moved(0, i) = cells(0, (first + i) % 72);
    }
    return moved;
  };
  const auto dots = rim.dots([&](double at) { return RimLoad{0.1 + 0.01 * std::cos(at), 0}; });
  const auto wrench_from = [&](Index first) {
    SegmentEquilibrium<> wrench(renumbered(rim.borders(), first), {.contours = 20, .passes = 1});
    return wrench(TiltedTop(), renumbered(dots, first), pressed_mpa);
  };
  const auto as_given = wrench_from(0), later = wrench_from(5);
  REQUIRE(as_given.ok());
  REQUIRE(later.ok());
  CHECK(norm(as_given.force_n - later.force_n) < 1e-9);
  CHECK(norm(as_given.moment_n_mm - later.moment_n_mm) < 1e-8);
}

TEST_CASE("the printed iteration is linear in the pressure", "[published]") {
  // the same shape under twice the pressure has twice the tensions, also where lines end tilted
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  const auto dots = rim.dots([&](double at) { return RimLoad{0.1 + 0.01 * std::cos(at), 0.01}; });
  SegmentEquilibrium<> wrench(rim.borders(), {.contours = 20, .passes = 2});
  const auto once = wrench(TiltedTop(), dots, pressed_mpa);
  const auto twice = wrench(TiltedTop(), dots, 2 * pressed_mpa);
  REQUIRE(once.ok());
  REQUIRE(twice.ok());
  CHECK(norm(twice.force_n - 2.0 * once.force_n) < 1e-9 * norm(once.force_n));
  CHECK(norm(twice.moment_n_mm - 2.0 * once.moment_n_mm) < 1e-9 * norm(once.moment_n_mm));
}

TEST_CASE("the printed iteration, word for word, on finite-element membranes", "[published]") {
  SegmentEquilibrium<> wrench(test::rim_border());
  double along = 0, along_sq = 0, turn = 0, turn_sq = 0;
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    const auto r = wrench(test::exact_heights(f.heights), test::rows_of(f.dots, 1), f.pressure_mpa);
    CAPTURE(f.name);
    // over a tilted plate, dragged or not, f_h dominates through eq. 9, and the iteration
    // diverges
    CHECK(r.ok() == (f.scene != "tilt"));
    if (f.scene == "drag") {
      along += r.force_n.x * f.force_n.x + r.force_n.y * f.force_n.y;
      along_sq += square(f.force_n.x) + square(f.force_n.y);
    } else if (f.scene == "twist") {
      turn += r.moment_n_mm.z * f.moment_n_mm.z;
      turn_sq += square(f.moment_n_mm.z);
    }
  }
  // the direction of the side dots loses a part of what shear carries, 1 / lambda^4
  CHECK(along / along_sq == Approx(0.75).margin(0.03));
  CHECK(turn / turn_sq == Approx(0.31).margin(0.03));
}

TEST_CASE("published six-axis force: what it refuses", "[published]") {
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  const auto dots = rim.dots([](double) { return RimLoad{0.1, 0}; });
  SegmentEquilibrium<> wrench(rim.borders());
  const test::Image<Point3<double>> few(1, 71, {0, 0, 0});
  CHECK(!wrench(pad, few, pressed_mpa).ok());
  CHECK(!wrench(pad, dots, -1.0).ok());
  CHECK(wrench(pad, dots, pressed_mpa).ok());
  auto without_one = dots;
  without_one(0, 3).y = test::nan;
  CHECK(!wrench(pad, without_one, pressed_mpa).ok());
  auto flat = dots;
  for (auto& dot : flat.cells) {
    dot.z = 0;
  }
  const auto r = wrench(pad, flat, pressed_mpa);
  CHECK(!r.ok());
  CHECK(r.force_n.x != r.force_n.x);
  const auto said = [&](const Options& options) {
    return test::refusal([&] { const SegmentEquilibrium<> refused(rim.borders(), options); });
  };
  const std::string owner = "published::SegmentEquilibriumOptions: ";
  CHECK(said({}) == "accepted");
  CHECK(said({.passes = 1}) == "accepted");
  CHECK(said({.passes = 100}) == "accepted");
  CHECK(test::begins_with(said({.passes = 0}), owner + "passes = 0"));
  CHECK(test::begins_with(said({.passes = 101}), owner + "passes = 101"));
  CHECK(test::begins_with(said({.base_radius_mm = 0}), owner + "base_radius_mm = 0"));
  CHECK(test::begins_with(said({.delta_z_mm = 0}), owner + "delta_z_mm = 0"));
  CHECK(test::begins_with(said({.contours = 1}), owner + "contours = 1"));
  CHECK(test::begins_with(said({.step_mm = 1e-30}), owner + "step_mm = 1e-30"));
  CHECK(test::begins_with(said({.step_mm = 0}), owner + "step_mm = 0"));
  CHECK(test::begins_with(said({.inside_mm = -1}), owner + "inside_mm = -1"));
}
