// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Tensions by least squares over all equations of equilibrium, on membranes whose tensions are
// known in closed form.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <vector>

#include "fingerpad/force/least_squares.hpp"
#include "fingerpad/force/wrench.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using detail::membrane::Compartments;
using detail::membrane::LineSteps;
using detail::membrane::Segments;
using detail::membrane::Tensions;

namespace {

constexpr double rim_mm = 18.735;
constexpr double pressure_mpa = 0.01;

/// A sphere through the rim without contact.
template <class S>
struct Cap {
  S radius_mm = S(25);

  S foot() const { return S(std::sqrt(radius_mm * radius_mm - S(rim_mm * rim_mm))); }
  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
    const S z = std::sqrt(radius_mm * radius_mm - x * x - y * y);
    return {S(z - foot()), S(-x / z), S(-y / z)};
  }
  bool in_contact(const S&, const S&) const { return false; }
};

/// A pressed flat disc of radius 8 mm, with an arc from its edge to the rim.
template <class S>
struct FlatPress {
  static constexpr double disc_mm = 8;
  static constexpr double height_mm = 9;
  static constexpr double bend_mm =
      ((rim_mm - disc_mm) * (rim_mm - disc_mm) + height_mm * height_mm) / (2 * height_mm);

  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
    const S r = std::sqrt(x * x + y * y);
    const S out = r - S(disc_mm);
    if (out <= S(0)) {
      return {S(height_mm), S(0), S(0)};
    }
    const S z = std::sqrt(S(bend_mm * bend_mm) - out * out);
    return {S(S(height_mm - bend_mm) + z), S(-out / z * x / r), S(-out / z * y / r)};
  }
  bool in_contact(const S& x, const S& y) const { return x * x + y * y < S(disc_mm * disc_mm); }

  /// f_v / p at a distance from the axis, from the vertical balance of the part between disc and r.
  static double tension(double r) {
    return (r * r - disc_mm * disc_mm) / (2 * r) * bend_mm / (r - disc_mm);
  }
};

/// A free membrane that is higher on one side, in two directions.
template <class S>
struct Leaning {
  S turn = S(0);

  detail::membrane::HeightAndSlope<S> operator()(const S& x, const S& y) const {
    const S c = std::cos(turn), s = std::sin(turn);
    const S u = c * x + s * y, v = c * y - s * x;
    const S a = S(rim_mm * rim_mm);
    const S arch = S(1) - (u * u + v * v) / a;
    const S level = S(9) + S(0.1) * u + S(0.005) * v * v;
    const S along_u = S(0.1) * arch - S(2) * u / a * level;
    const S along_v = S(0.01) * v * arch - S(2) * v / a * level;
    return {S(arch * level), S(c * along_u - s * along_v), S(s * along_u + c * along_v)};
  }
  bool in_contact(const S&, const S&) const { return false; }
};

/// A membrane cut into segments, with its pull at the rim.
template <class S>
struct Membrane {
  template <class Shape>
  Membrane(const Shape& shape, Index columns, Index rows)
      : nodes(columns, rows, S(rim_mm), LineSteps<S>{S(0.02), S(0.2), S(4)}),
        segments(columns, rows),
        tensions(columns, rows),
        pull(static_cast<std::size_t>(columns)) {
    nodes.template lay<StraightLines>(shape, Point3<S>{S(0), S(0), S(0)});
    segments.measure(nodes);
    for (Index i = 0; i < columns; ++i) {
      const double angle = 2 * std::numbers::pi * (double(i) + 0.5) / double(columns);
      const auto slope = shape(S(rim_mm * std::cos(angle)), S(rim_mm * std::sin(angle)));
      const Point3<S> out{S(-slope.along_x), S(-slope.along_y), S(1)};
      rim_normal.push_back(normalized(cross(out, segments.around(i, 0).along)));
    }
    lean(0);
  }

  /// Sets a pull in the plane of the membrane at the rim that leans along the rim by `shear`
  /// sin(angle), rotated by `turn` columns.
  void lean(double shear, Index turn = 0) {
    for (Index i = 0; i < segments.columns(); ++i) {
      const auto& border = segments.around(i, 0);
      const double angle = 2 * std::numbers::pi * (double(i - turn) + 0.5) / double(pull.size());
      const S length = std::sqrt(squared_norm(border.along));
      pull[std::size_t(i)] =
          length * rim_normal[std::size_t(i)] + S(shear * std::sin(angle)) * border.along;
    }
  }

  template <bool Magnitudes = false>
  bool solve(const LeastSquares& solver = {}, double p = pressure_mpa) {
    LeastSquares::Work<S> work(solver, segments.columns(), segments.rows());
    return solver.template solve<Magnitudes>(segments, nodes, pull, S(p), work, tensions);
  }

  Point3<double> rim_force() const {
    Point3<double> sum{0, 0, 0};
    for (const auto& f : tensions.rim) {
      sum = {sum.x + double(f.x), sum.y + double(f.y), sum.z + double(f.z)};
    }
    return sum;
  }

  /// Area in plan of the polygon of row j.
  double plan_area(Index j) const {
    double twice = 0;
    for (Index i = 0; i < nodes.columns(); ++i) {
      const auto& a = nodes.node(i, j);
      const auto& b = nodes.node(segments.next(i), j);
      twice += double(a.x) * double(b.y) - double(a.y) * double(b.x);
    }
    return twice / 2;
  }

  /// Largest relative error of f_v in the lowest `rows` rows; `truth(r)` is f_v / p.
  template <class Truth>
  double tension_error(Index rows, const Truth& truth) const {
    double worst = 0;
    for (Index j = 0; j < rows; ++j) {
      for (Index i = 0; i < segments.columns(); ++i) {
        const auto& a = nodes.node(i, j);
        const double wanted = pressure_mpa * truth(std::hypot(double(a.x), double(a.y)));
        const auto k = std::size_t(j * segments.columns() + i);
        worst = std::max(worst, std::abs(double(tensions.around_normal[k]) / wanted - 1));
      }
    }
    return worst;
  }

  /// Left side of (7) for M(i, j), N mm.
  S torque(Index i, Index j) const {
    using detail::membrane::border_force;
    const Index next = segments.next(i);
    const auto low = std::size_t(j * segments.columns() + i);
    const auto up = std::size_t((j + 1) * segments.columns() + i);
    const auto right = std::size_t(j * segments.columns() + next);
    // half the diagonals: the arms of opposite borders about the mean of the nodes
    const Point3<S> first = nodes.node(next, j + 1) - nodes.node(i, j);
    const Point3<S> second = nodes.node(i, j + 1) - nodes.node(next, j);
    const Point3<S> f_low = j == 0
                                ? tensions.rim[low]
                                : border_force(segments.around(i, j), tensions.around_normal[low],
                                               tensions.around_shear[low]);
    const Point3<S> f_up = border_force(segments.around(i, j + 1), tensions.around_normal[up],
                                        tensions.around_shear[up]);
    const Point3<S> f_left = border_force(segments.upward(i, j), tensions.upward_normal[low],
                                          tensions.upward_shear[low]);
    const Point3<S> f_right = border_force(segments.upward(next, j), tensions.upward_normal[right],
                                           tensions.upward_shear[right]);
    const Point3<S> about = cross(S(0.25) * (first + second), f_up + f_low) +
                            cross(S(0.25) * (first - second), f_right + f_left);
    const Point3<S>& area = segments.area(i, j);
    return S(0) < squared_norm(area) ? dot(about, normalized(area)) : S(0);
  }

  Compartments<S> nodes;
  Segments<S> segments;
  Tensions<S> tensions;
  std::vector<Point3<S>> rim_normal;
  std::vector<Point3<S>> pull;
};

/// Sets one tension everywhere without shear, as in a soap film.
template <class S>
void fill_evenly(Membrane<S>& m, double tension_n_per_mm, double around_n_per_mm) {
  Tensions<S>& t = m.tensions;
  std::fill(t.around_normal.begin(), t.around_normal.end(), S(tension_n_per_mm));
  std::fill(t.upward_normal.begin(), t.upward_normal.end(), S(around_n_per_mm));
  std::fill(t.around_shear.begin(), t.around_shear.end(), S(0));
  std::fill(t.upward_shear.begin(), t.upward_shear.end(), S(0));
  for (std::size_t i = 0; i < t.rim.size(); ++i) {
    t.rim[i] = S(tension_n_per_mm) * m.pull[i];
  }
}

template <class S>
double imbalance(const Membrane<S>& m) {
  return double(detail::membrane::residual(m.segments, m.tensions, S(pressure_mpa)));
}

/// Deviation from (7), the balance of torques about a segment's own normal: the rms, by area, of
/// torque / (p |S|^1.5). Forces act at the middles of the borders.
template <class S>
double twist(const Membrane<S>& m) {
  double sum = 0, total = 0;
  for (Index j = 0; j < m.segments.rows(); ++j) {
    for (Index i = 0; i < m.segments.columns(); ++i) {
      const double area = std::sqrt(double(squared_norm(m.segments.area(i, j))));
      const double torque = double(m.torque(i, j));
      sum += area > 0 ? torque * torque / (area * area) : 0;
      total += area;
    }
  }
  return std::sqrt(sum / total) / pressure_mpa;
}

double of_cap(double) {
  return Cap<double>{}.radius_mm / 2;
}

}  // namespace

TEMPLATE_TEST_CASE("least squares: an inflated cap is a soap film", "[membrane]", double, float) {
  // The tension is p R / 2 on every border up to the summit, where the uppermost borders have no
  // length.
  const Index columns = 36;
  double error = 0;
  for (const Index rows : {15, 30}) {
    Membrane<TestType> cap(Cap<TestType>{}, columns, rows);
    REQUIRE(cap.solve());
    error = cap.tension_error(rows, of_cap);
    CHECK(error < 9e-3);
    CHECK(std::abs(cap.rim_force().z / (pressure_mpa * cap.plan_area(0)) - 1) < 1e-6);
    CHECK(imbalance(cap) < 1e-5);
    REQUIRE(cap.template solve<true>());
    CHECK(std::abs(cap.tension_error(rows, of_cap) - error) < 1e-3);
    CHECK(std::abs(cap.rim_force().z / (pressure_mpa * cap.plan_area(0)) - 1) < 1e-6);
  }
}

TEST_CASE("least squares: errors fall with the square of the mesh", "[membrane][figures]") {
  double coarse = 0;
  for (const Index columns : {18, 36, 72}) {
    Membrane<double> cap(Cap<double>{}, columns, columns * 5 / 6);
    REQUIRE(cap.solve());
    const double fine = cap.tension_error(columns * 5 / 6, of_cap);
    CAPTURE(columns, fine);
    CHECK((columns == 18 ? fine < 0.031 : fine < coarse / 3.5));
    coarse = fine;
  }
}

TEMPLATE_TEST_CASE("least squares: a flat disc pressed on", "[membrane]", double, float) {
  const Index columns = 36, rows = 30;
  Membrane<TestType> press(FlatPress<TestType>{}, columns, rows);
  REQUIRE(press.solve());
  // the load on A_g is the load on the base minus the force of the rim
  const double contact_n = pressure_mpa * press.plan_area(0) - press.rim_force().z;
  CHECK(std::abs(contact_n / (pressure_mpa * press.plan_area(rows)) - 1) < 1e-6);
  CHECK(std::abs(contact_n / (pressure_mpa * std::numbers::pi * 64) - 1) < 0.01);
  CHECK(press.tension_error(rows / 2, FlatPress<TestType>::tension) < 0.01);
  CHECK(imbalance(press) < 1e-5);
  CHECK(twist(press) < 1e-5);
}

TEMPLATE_TEST_CASE("least squares: a flat disc pulled sideways", "[membrane]", double, float) {
  // The pull leans along the rim by 0.01 sin(angle). To first order in it the tensions follow from
  // two ordinary differential equations. Integrated up to the edge of the disc, where the solution
  // must remain finite, they give 0.050044 N.
  Membrane<TestType> press(FlatPress<TestType>{}, 36, 30);
  press.lean(0.01);
  REQUIRE(press.solve());
  CHECK(std::abs(press.rim_force().x / -0.050044 - 1) < 0.01);
  CHECK(std::abs(press.rim_force().y) < 1e-5);
  // rotating the lean by some columns rotates the force
  const Point3<double> before = press.rim_force();
  press.lean(0.01, 9);
  REQUIRE(press.solve());
  CHECK(std::abs(press.rim_force().y - before.x) < 1e-5);
  CHECK(std::abs(press.rim_force().x) < 1e-5);
}

TEST_CASE("least squares: a rotated membrane has the same tensions", "[membrane]") {
  for (const Index columns : {24, 25}) {
    const Index rows = 17;
    Membrane<double> here(Leaning<double>{}, columns, rows);
    Membrane<double> rotated(Leaning<double>{2 * std::numbers::pi / double(columns)}, columns,
                             rows);
    here.lean(0.1);
    rotated.lean(0.1, 1);
    REQUIRE(here.solve());
    REQUIRE(rotated.solve());
    double worst = 0;
    for (Index j = 0; j < rows; ++j) {
      for (Index i = 0; i < columns; ++i) {
        const auto a = std::size_t(j * columns + i);
        const auto b = std::size_t(j * columns + here.segments.next(i));
        const Tensions<double>&t = here.tensions, &u = rotated.tensions;
        worst = std::max({worst, std::abs(t.around_normal[a] - u.around_normal[b]),
                          std::abs(t.around_shear[a] - u.around_shear[b]),
                          std::abs(t.upward_normal[a] - u.upward_normal[b]),
                          std::abs(t.upward_shear[a] - u.upward_shear[b])});
      }
    }
    CHECK(worst < 1e-8);
    CHECK(imbalance(here) < 2e-3);
  }
}

TEST_CASE("least squares: tensions grow with the pressure", "[membrane]") {
  Membrane<double> leaning(Leaning<double>{}, 24, 17);
  leaning.lean(0.1);
  REQUIRE(leaning.solve());
  const std::vector<double> once = leaning.tensions.around_shear;
  REQUIRE(leaning.solve({}, 3 * pressure_mpa));
  for (std::size_t k = 0; k < once.size(); ++k) {
    CHECK(std::abs(leaning.tensions.around_shear[k] - 3 * once[k]) < 1e-14);
  }
}

TEMPLATE_TEST_CASE("least squares: float loses no more than 1e-3", "[membrane]", double, float) {
  // forces of the solution in double
  Membrane<double> exact(Leaning<double>{}, 36, 30);
  exact.lean(0.1);
  REQUIRE(exact.solve());
  Membrane<TestType> given(Leaning<TestType>{}, 36, 30);
  given.lean(0.1);
  REQUIRE(given.solve());
  const Point3<double> a = exact.rim_force(), b = given.rim_force();
  CHECK(std::sqrt(squared_norm(a - b) / squared_norm(a)) < 1e-4);
}

TEST_CASE("least squares: the true pull up to a factor changes nothing", "[membrane]") {
  Membrane<double> leaning(Leaning<double>{}, 24, 17);
  leaning.lean(0.1);
  REQUIRE(leaning.solve());
  const std::vector<Point3<double>> truth = leaning.tensions.rim;
  const auto difference_of = [&](double factor, double uneven) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      leaning.pull[i] = (i % 12 < 6 ? factor : factor * (1 + uneven)) * truth[i];
    }
    LeastSquares solver;
    solver.magnitude_weight = 10;
    REQUIRE(leaning.solve<true>(solver));
    double worst = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      worst = std::max(worst, std::sqrt(squared_norm(leaning.tensions.rim[i] - truth[i])));
    }
    return worst;
  };
  const double pull_n = std::sqrt(squared_norm(truth[0]));
  CHECK(difference_of(1, 0) < 1e-4 * pull_n);
  CHECK(difference_of(7, 0) < 1e-4 * pull_n);
  CHECK(difference_of(1, 0.2) > 1e-2 * pull_n);
}

TEST_CASE("least squares: pulls that nobody knows, and shapes with no solution", "[membrane]") {
  Membrane<double> press(FlatPress<double>{}, 36, 30);
  press.lean(0.01);
  REQUIRE(press.solve());
  const Point3<double> all = press.rim_force();
  press.pull[3] = detail::missing_point<double>();
  press.pull[20] = {0, 0, 0};
  REQUIRE(press.solve());
  CHECK(std::sqrt(squared_norm(press.rim_force() - all)) < 0.02 * 2);
  REQUIRE(press.solve<true>());
  std::fill(press.pull.begin(), press.pull.end(), detail::missing_point<double>());
  CHECK(press.solve<true>());
  CHECK_FALSE(press.solve({}, 0));
  CHECK_FALSE(press.solve({}, not_a_number<double>()));
}

TEMPLATE_TEST_CASE("membrane residual: nothing for a true field, much for a wrong one",
                   "[membrane]",
                   double,
                   float) {
  const double tension = pressure_mpa * of_cap(0);
  double coarse = 0;
  for (const Index columns : {18, 36, 72}) {
    Membrane<TestType> cap(Cap<TestType>{}, columns, columns * 5 / 6);
    fill_evenly(cap, tension, tension);
    const double fine = imbalance(cap);
    CHECK((columns == 18 ? fine < 0.03 : fine < coarse / 2.5));
    CHECK(twist(cap) < 1e-5);
    coarse = fine;
    // a tenth more in one direction is a twentieth of the pressure, and more near the summit
    fill_evenly(cap, 1.1 * tension, tension);
    CHECK(imbalance(cap) > 0.05);
    // a shear that differs between the two sides of a corner twists the segment
    fill_evenly(cap, tension, tension);
    std::fill(cap.tensions.upward_shear.begin(), cap.tensions.upward_shear.end(),
              TestType(tension / 10));
    CHECK(twist(cap) > 1e-3);
  }
}

TEST_CASE("least squares: bad parameters are refused", "[membrane]") {
  const auto refusal = [](LeastSquares bad) { return test::refusal([&] { expects_valid(bad); }); };
  CHECK(refusal({}) == "accepted");
  LeastSquares bad;
  bad.smoothness = 0;
  CHECK(refusal(bad) == "LeastSquares: smoothness = 0, must be in [1e-6, 1]");
  bad = {};
  bad.rim_weight = not_a_number<double>();
  CHECK(test::begins_with(refusal(bad), "LeastSquares: rim_weight = "));
  for (const double end : {1e-3, 1e3}) {
    bad = {};
    bad.rim_weight = end;
    CHECK(refusal(bad) == "accepted");
  }
  bad = {};
  bad.magnitude_weight = -1;
  CHECK(refusal(bad) == "LeastSquares: magnitude_weight = -1, must be in [1e-6, 1e3]");
}
