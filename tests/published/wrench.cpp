// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Parts of the published six-axis force that results of a symmetric load do not show: f_h, which is
// solved for but not used, and the course of the lines.
#include "fingerpad/published/wrench.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/published/printed_iteration.hpp"
#include "support/catch.hpp"
#include "support/pressed_pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::ArcSide;
using test::pressed_mpa;
using test::RimLoad;
using test::RoundPad;

namespace {

/// A pad whose contact is inclined along x.
struct Inclined : RoundPad<ArcSide> {
  template <class S>
  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
    const auto flat = RoundPad<ArcSide>::operator()(x, y);
    const double u = value(x), v = value(y), sq = this->radius_mm * this->radius_mm;
    const double cap = 1 - (u * u + v * v) / sq;
    return {S(flat.height_mm + 0.5 * u * cap), S(flat.along_x + 0.5 * (cap - 2 * u * u / sq)),
            S(flat.along_y - u * v / sq)};
  }
};

/// Solves a pad without shear at the rim: use(nodes, segments, tensions). Returns
/// whether the solver converges.
template <class Pad, class Solver, class Use>
bool solve_pressed(const Solver& iteration, Index columns, Index rows, const Use& use) {
  using namespace detail::membrane;
  const Pad pad;
  const auto dots_at_rim = rim_of(pad);
  const double t0 = pad.tension(pad.radius_mm, pressed_mpa);
  const Rim<double> rim(
      dots_at_rim.borders(), [](Index) { return 0.8; }, pad.radius_mm, columns);
  auto pulls = rim.pulls();
  rim.measure(dots_at_rim.dots([&](double) {
    return RimLoad{t0, 0};
  }),
              OneRow(), ClampedRim(), 0.0, pulls);
  rim.integrate(pulls);
  Compartments<double> nodes(columns, rows, pad.radius_mm, {0.1, 0, 1});
  nodes.lay<published::SteepestLines>(pad, {0, 0, 0});
  Segments<double> segments(columns, rows);
  segments.measure(nodes);
  Tensions<double> tensions(columns, rows);
  typename Solver::template Work<double> work(iteration, columns, rows);
  const bool solved =
      iteration.template solve<true>(segments, nodes, pulls.segments, pressed_mpa, work, tensions);
  use(nodes, segments, tensions);
  return solved;
}

/// Largest error of f_h on a pad pressed flat, relative to the largest f_h, without `skipped` rows
/// at either end: at the rim the membrane's edge counts twice, at the summit f_v is 0 / 0. Truth:
/// f_v K_1 + f_h K_2 = p, with the arc's curvature along the meridian and sin(phi) / r around.
template <class Solver>
double around_error(Index columns, Index rows, Index skipped) {
  const RoundPad<ArcSide> pad;
  const double p = pressed_mpa;
  double worst = 0, largest = 0;
  const bool solved = solve_pressed<RoundPad<ArcSide>>(
      Solver(), columns, rows, [&](const auto& nodes, const auto&, const auto& tensions) {
        for (Index j = skipped; j + skipped < rows; ++j) {
          const auto &low = nodes.node(3, j), &up = nodes.node(3, j + 1);
          const double r = (std::hypot(low.x, low.y) + std::hypot(up.x, up.y)) / 2;
          const double truth = (p - pad.tension(r, p) / pad.bend_mm()) * r / pad.sine(r);
          const double found = tensions.upward_normal[static_cast<std::size_t>(j * columns + 3)];
          worst = (std::max)(worst, std::abs(found - truth));
          largest = (std::max)(largest, std::abs(truth));
        }
      });
  REQUIRE(solved);
  return worst / largest;
}

/// A mound that is level at the rim, with its summit 2.8 mm off the middle.
struct Mound {
  template <class S>
  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
    constexpr double r = 18.735;
    const double u = value(x) / r, v = value(y) / r, lean = 1 + 0.3 * u, cap = 1 - u * u - v * v;
    return {S(9 * cap * lean), S(9 * (-2 * u * lean + 0.3 * cap) / r), S(9 * -2 * v * lean / r)};
  }
  template <class S>
  bool in_contact(const S& x, const S& y) const {
    return (*this)(x, y).height_mm > 8.5;
  }
};

/// An asymmetric mound, or its mirror image with y reversed.
struct Leaning {
  double side = 1;
  template <class S>
  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
    constexpr double c = 0.8, s = 0.6;
    const auto along = Mound()(S(c * x + s * side * y), S(c * side * y - s * x));
    return {along.height_mm, S(c * along.along_x - s * along.along_y),
            S(side * (s * along.along_x + c * along.along_y))};
  }
  template <class S>
  bool in_contact(const S& x, const S& y) const {
    return (*this)(x, y).height_mm > 8.5;
  }
};

/// f_h by row, over a leaning mound whose rim is twisted unevenly.
std::vector<double> around_leaning(double side, Index columns, Index rows) {
  using namespace detail::membrane;
  const RoundPad<ArcSide> pad;
  const auto dots_at_rim = rim_of(pad);
  const double t0 = pad.tension(pad.radius_mm, pressed_mpa);
  const Rim<double> rim(
      dots_at_rim.borders(), [](Index) { return 0.8; }, pad.radius_mm, columns);
  auto pulls = rim.pulls();
  rim.measure(dots_at_rim.dots([&](double angle) {
    return RimLoad{t0, side * 0.2 * t0 * std::sin(side * angle + 0.7)};
  }),
              OneRow(), ClampedRim(), 0.0, pulls);
  rim.integrate(pulls);
  Compartments<double> nodes(columns, rows, pad.radius_mm, {0.1, 0, 1});
  nodes.lay<published::SteepestLines>(Leaning{side}, {2.24, side * 1.68, 8.5});
  Segments<double> segments(columns, rows);
  segments.measure(nodes);
  Tensions<double> tensions(columns, rows);
  const published::Iteration iteration;
  published::Iteration::Work<double> work(iteration, columns, rows);
  REQUIRE(iteration.solve<true>(segments, nodes, pulls.segments, pressed_mpa, work, tensions));
  return tensions.upward_normal;
}

/// Sine of the angle between a step from a to b and the gradient of the heights between them.
double off_gradient(const Mound& mound, const Point3<double>& a, const Point3<double>& b) {
  const auto at = mound((a.x + b.x) / 2, (a.y + b.y) / 2);
  const double dx = b.x - a.x, dy = b.y - a.y;
  return std::abs(dx * at.along_y - dy * at.along_x) /
         (std::hypot(dx, dy) * std::hypot(at.along_x, at.along_y));
}

}  // namespace

TEST_CASE("published iteration: f_h of a flat press, in closed form", "[published]") {
  CHECK(around_error<published::Iteration>(36, 32, 5) < 0.05);
  CHECK(around_error<published::PrintedIteration>(36, 32, 5) < 0.05);
}

TEST_CASE("published iteration: f_h is carried on where a line does not end level", "[published]") {
  // Along the level direction across both f_v of a segment, f_h on its two sides carries the
  // pressure (eq. 6 with eq. 10).
  constexpr Index columns = 36, rows = 24;
  double off = 0, largest = 0;
  Index carried = 0;
  const auto measure = [&](const auto&, const auto& segments, const auto& tensions) {
    const auto f_h = [&](Index i, Index j) {
      const Point3<double> n = segments.upward(i, j).normal;
      return tensions.upward_normal[static_cast<std::size_t>(j * columns + i)] *
             Point3<double>{n.x, n.y, 0};
    };
    const auto ends_level = [&](Index i) {
      const Point3<double> up = segments.around(i, rows).normal;
      return 100 * up.z * up.z < squared_norm(up);
    };
    for (Index i = 0; i < columns; ++i) {
      const Index next = segments.next(i);
      if (ends_level(i) || ends_level(next)) {
        continue;  // where a line ends level, f_h on both its sides is found anew
      }
      ++carried;
      for (Index j = 0; j < rows; ++j) {
        const auto axis =
            normalized(cross(segments.around(i, j + 1).normal, segments.around(i, j).normal));
        const double pressure = pressed_mpa * dot(segments.area(i, j), axis);
        const double rest = dot(f_h(next, j) - f_h(i, j), axis) + pressure;
        largest = (std::max)(largest, std::abs(dot(f_h(i, j), axis)));
        off = (std::max)(off, std::abs(rest));
      }
    }
  };
  // one pass: shear, which is 0 at first, follows from f_h
  (void)solve_pressed<Inclined>(published::PrintedIteration{.passes = 1}, columns, rows, measure);
  CHECK(carried >= 4);
  CHECK(largest > 0.01);
  CHECK(off < 1e-9 * largest);
}

TEST_CASE("published iteration: f_h of a pad seen in a mirror", "[published]") {
  // each f_h is found from the segments on both sides; with one side alone, left and right would
  // differ
  constexpr Index columns = 36, rows = 24;
  const auto plain = around_leaning(1, columns, rows), mirrored = around_leaning(-1, columns, rows);
  double largest = 0, off = 0, uneven = 0;
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < columns; ++i) {
      const auto here = static_cast<std::size_t>(j * columns + i);
      const auto there = static_cast<std::size_t>(j * columns + (columns - i) % columns);
      largest = (std::max)(largest, std::abs(plain[here]));
      off = (std::max)(off, std::abs(plain[here] - mirrored[there]));
      uneven = (std::max)(uneven, std::abs(plain[here] - plain[there]));
    }
  }
  CHECK(off < 1e-6 * largest);
  CHECK(uneven > 0.1 * largest);
}

TEST_CASE("published six-axis force: contour lines every 0.2 mm, of each line its own number",
          "[published]") {
  const Mound mound;
  const RoundPad<ArcSide> pad;
  detail::membrane::Compartments<double> nodes(24, 70, pad.radius_mm, {0.1, 0, 1});
  nodes.lay<published::ContourLines>(mound, {2.8, 0, 8.5});
  int cut = 0;
  for (Index i = 0; i < 24; ++i) {
    const double end = nodes.node(i, 70).z;
    Index own = 0;
    for (Index j = 0; j <= 70; ++j) {
      const double contour = 0.2 * static_cast<double>(j);
      CHECK(nodes.node(i, j).z == Approx((std::min)(contour, end)).margin(2e-3));
      own += contour < end ? 1 : 0;
    }
    CHECK(own == static_cast<Index>(std::ceil(end / 0.2)));
    cut += own < 70 ? 1 : 0;
  }
  CHECK(cut == 24);
  // along the gradient, not straight toward the summit
  for (const Index i : {3, 6, 9, 15, 18, 21}) {
    for (Index j = 5; j < 30; ++j) {
      CAPTURE(i, j);
      CHECK(off_gradient(mound, nodes.node(i, j), nodes.node(i, j + 1)) < 0.06);
    }
  }
}

TEST_CASE("published six-axis force: its lines are the steepest, cut at equal steps of height",
          "[published]") {
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  auto options = published::wrench_options();
  options.blur_mm = 0.1;
  const auto wrench = published::wrench(rim.borders(), options);
  auto workspace = wrench.workspace();
  (void)wrench(pad, rim.dots([&](double) {
    return RimLoad{pad.tension(pad.radius_mm, pressed_mpa), 0};
  }),
               pressed_mpa, workspace);
  double least = 1e9, most = 0;
  for (Index j = 0; j < 65; ++j) {
    const double step = workspace.node(7, j + 1).z - workspace.node(7, j).z;
    least = (std::min)(least, step);
    most = (std::max)(most, step);
  }
  CHECK(least == Approx(9.0 / 65).margin(4e-3));
  CHECK(most == Approx(9.0 / 65).margin(4e-3));
  // where the summit is off the middle, a line follows the gradient, not the direction to the
  // summit
  const Mound mound;
  (void)wrench(mound, rim.dots([&](double) {
    return RimLoad{pad.tension(pad.radius_mm, pressed_mpa), 0};
  }),
               pressed_mpa, workspace);
  for (const Index column : {9, 18, 27, 45, 54, 63}) {
    for (Index j = 5; j < 40; ++j) {
      const auto &a = workspace.node(column, j), &b = workspace.node(column, j + 1);
      CAPTURE(column, j);
      CHECK(off_gradient(mound, a, b) < 0.03);
    }
  }
}

TEST_CASE("a side dot on its border point has no direction", "[wrench][published]") {
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  const auto at_rim = rim.borders();
  const double t0 = pad.tension(pad.radius_mm, pressed_mpa);
  auto dots = rim.dots([&](double) { return RimLoad{t0, 0}; });
  const Wrench<published::Iteration, OneRow, published::Direction> wrench(at_rim);
  auto work = wrench.workspace();
  const auto whole = wrench(pad, dots, pressed_mpa, work);
  REQUIRE(whole.status == WrenchStatus::ok);

  dots(0, 3) = at_rim(0, 3);
  const auto without_one = wrench(pad, dots, pressed_mpa, work);
  CHECK(without_one.status == WrenchStatus::ok);
  CHECK(without_one.unstretched == 1);
  CHECK(without_one.force_n.z == Approx(whole.force_n.z).epsilon(1e-6));
  for (Index k = 0; k < work.rim_points(); ++k) {
    CHECK(is_finite(work.rim_tension(k)));
  }

  for (Index k = 0; k < at_rim.cols(); ++k) {
    dots(0, k) = at_rim(0, k);
  }
  const auto none = wrench(pad, dots, pressed_mpa, work);
  CHECK(none.status == WrenchStatus::unstretched);
  CHECK_FALSE(none.has_force());
}

TEST_CASE("side dots level with the rim cannot carry the pressure", "[wrench][published]") {
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  const auto at_rim = rim.borders();
  const double t0 = pad.tension(pad.radius_mm, pressed_mpa);
  auto dots = rim.dots([&](double) { return RimLoad{t0, 0}; });
  const Wrench<published::Iteration, OneRow, published::Direction> wrench(at_rim);
  auto work = wrench.workspace();
  for (const double height_mm : {0.0, 1e-300, 1e-12}) {
    for (auto& dot : dots.cells) {
      dot.z = height_mm;
    }
    const auto found = wrench(pad, dots, pressed_mpa, work);
    CHECK(found.status == WrenchStatus::not_solved);
    CHECK(found.force_n.x != found.force_n.x);
  }
}

TEST_CASE("the printed iteration keeps the symmetry of a twisted pad", "[published]") {
  // The shear that a twist puts into every segment turns with the segment: pushes along the plate
  // cancel around the rim, and the pull does not depend on the sense of the twist.
  const RoundPad<ArcSide> pad;
  const auto rim = rim_of(pad);
  const double t0 = pad.tension(pad.radius_mm, pressed_mpa);
  const Wrench<published::PrintedIteration> wrench(rim.borders());
  auto work = wrench.workspace();
  const auto twisted = [&](double shear) {
    const auto found = wrench(pad, rim.dots([&](double) {
      return RimLoad{t0, shear * t0};
    }),
                              pressed_mpa, work);
    REQUIRE(found.status == WrenchStatus::ok);
    return found;
  };
  const auto left = twisted(0.2), right = twisted(-0.2);
  const double size = std::abs(left.force_n.z);
  CHECK(std::abs(left.force_n.x) < 1e-6 * size);
  CHECK(std::abs(left.force_n.y) < 1e-6 * size);
  CHECK(left.force_n.z == Approx(right.force_n.z).epsilon(1e-6));
  CHECK(left.moment_n_mm.z == Approx(-right.moment_n_mm.z).epsilon(1e-6));
  CHECK(std::abs(left.moment_n_mm.z) > 1);
}

TEST_CASE("passes of the published iterations are in [1, 100]", "[published]") {
  const auto said = [](int passes) {
    const auto by = [&](auto iteration) {
      iteration.passes = passes;
      return test::refusal([&] {
        expects_valid(iteration);
        return 0;
      });
    };
    return std::pair(by(published::Iteration()), by(published::PrintedIteration()));
  };
  CHECK(said(1) == std::pair<std::string, std::string>("accepted", "accepted"));
  CHECK(said(100) == std::pair<std::string, std::string>("accepted", "accepted"));
  for (const int passes : {0, 101}) {
    CHECK(test::begins_with(said(passes).first, "published::Iteration: passes"));
    CHECK(test::begins_with(said(passes).second, "published::PrintedIteration: passes"));
  }
}
