// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/wrench.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/published/wrench.hpp"
#include "support/by_modulus.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pressed_pad.hpp"
#include "support/refusal.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using test::ArcSide;
using test::CapSide;
using test::Digits50;
using test::FilmSide;
using test::pressed_mpa;
using test::RimLoad;
using test::RimOfDots;
using test::RoundPad;

namespace {

constexpr double pi = std::numbers::pi;
using Vector = Point3<double>;

template <class To, class From>
Point3<To> as(const Point3<From>& p) {
  return {To(p.x), To(p.y), To(p.z)};
}

template <class S>
S distance(const Point3<S>& a, const Point3<S>& b) {
  using std::sqrt;
  return S(sqrt(squared_norm(a - b)));
}
double size(const Vector& a) {
  return std::sqrt(squared_norm(a));
}

/// d and e of a rim, stretched by 1 % to 60 % and sheared as much.
struct AnyRim {
  Vector along, tangent;
  explicit AnyRim(test::Random& random) {
    const double at = random.uniform(0, 2 * pi), lean = random.uniform(-0.6, 1.4);
    const double stretch = random.uniform(1.01, 1.6), shear = random.uniform(-0.6, 0.6);
    tangent = {-std::sin(at), std::cos(at), 0};
    const Vector up = {-std::cos(at) * std::cos(lean), -std::sin(at) * std::cos(lean),
                       std::sin(lean)};
    along = stretch * up + shear * tangent;
  }
};

Vector any_step(test::Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

/// Stored energy over mu t / 2 and per stress-free area, F = [d, e]: (1 - m) (I_1 - 3) +
/// m (I_2 - 3), I_1 = |F|^2 + J^-2, I_2 = |F|^2 J^-2 + J^2.
template <class S>
S energy(const Point3<S>& along, const Point3<S>& other, const S& mooney_share) {
  const S trace = squared_norm(along) + squared_norm(other);
  const S area_sq = squared_norm(cross(along, other));
  const S first = trace + S(1) / area_sq - S(3);
  const S second = trace / area_sq + area_sq - S(3);
  return S((S(1) - mooney_share) * first + mooney_share * second);
}

}  // namespace

TEST_CASE("clamped rim: the pull is the derivative of the membrane's energy", "[wrench]") {
  test::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const AnyRim rim(random);
    const auto along = as<Digits50>(rim.along), tangent = normalized(as<Digits50>(rim.tangent));
    const Digits50 share = Digits50(k % 2) * Digits50(random.uniform(0, 1));
    const auto pull = clamped_rim_pull(along, tangent, share);
    const auto way = as<Digits50>(any_step(random));
    const Digits50 slope = test::slope_by_difference(
        [&](const Digits50& t) {
          return Digits50(energy(along + t * way, tangent, share) / Digits50(2));
        },
        Digits50(0), Digits50(1e-16));
    CHECK(abs(Digits50(slope - dot(pull, way))) < Digits50(1e-27));
  }
}

TEST_CASE("rubber: the pull across any direction is the derivative of the membrane's energy",
          "[wrench]") {
  test::Random random(3);
  for (int k = 0; k < 50; ++k) {
    const AnyRim rim(random);
    const auto along = as<Digits50>(rim.along);
    const auto other = Digits50(random.uniform(0.7, 1.5)) * as<Digits50>(rim.tangent) +
                       Digits50(0.2) * as<Digits50>(any_step(random));
    const Digits50 share = Digits50(random.uniform(0, 1));
    const auto pull = detail::membrane::rubber_pull(along, other, share);
    const auto way = as<Digits50>(any_step(random));
    const Digits50 slope = test::slope_by_difference(
        [&](const Digits50& t) {
          return Digits50(energy(along + t * way, other, share) / Digits50(2));
        },
        Digits50(0), Digits50(1e-16));
    CHECK(abs(Digits50(slope - dot(pull, way))) < Digits50(1e-27));
  }
}

TEST_CASE("clamped rim: its change is the derivative of the pull", "[wrench]") {
  using D = test::Dual<Digits50>;
  test::Random random(2);
  for (int k = 0; k < 100; ++k) {
    const AnyRim rim(random);
    const auto way = as<Digits50>(any_step(random));
    const Point3<D> along = {D(rim.along.x, way.x), D(rim.along.y, way.y), D(rim.along.z, way.z)};
    const auto unit_tangent = normalized(as<Digits50>(rim.tangent));
    const auto tangent = as<D>(unit_tangent);
    for (const bool by_kernel : {true, false}) {
      const ClampedRim law{.mooney_share = k % 2 * random.uniform(0, 1)};
      const auto pull = by_kernel ? clamped_rim_pull(along, tangent, D(law.mooney_share))
                                  : law.pull(along, tangent).pull;
      const auto change = law.change_of_pull(as<Digits50>(rim.along), unit_tangent, way);
      CHECK(distance(change, Point3<Digits50>{pull.x.d, pull.y.d, pull.z.d}) < Digits50(1e-45));
    }
    const auto published = published::Direction().pull(along, tangent).pull;
    const auto change =
        published::Direction().change_of_pull(rim.along, rim.tangent, any_step(random));
    CHECK(published.x.d == way.x);
    CHECK(is_finite(change.x));
  }
}

TEMPLATE_TEST_CASE("clamped rim: every number type follows 50 digits",
                   "[wrench]",
                   float,
                   double,
                   long double,
                   test::Digits50) {
  test::Random random(3);
  const double allowed = 8 * static_cast<double>(epsilon<TestType>());
  for (int k = 0; k < 200; ++k) {
    const AnyRim rim(random);
    // both get the numbers that the type can hold
    const auto along = as<TestType>(rim.along), tangent = as<TestType>(rim.tangent);
    const auto pull = clamped_rim_pull(along, tangent);
    const auto exact = clamped_rim_pull(as<Digits50>(along), as<Digits50>(tangent));
    CHECK(static_cast<double>(distance(as<Digits50>(pull), exact)) <= allowed * size(rim.along));
    const auto by_law = ClampedRim().pull(along, tangent);
    CHECK(by_law.status == detail::membrane::RimPullStatus::ok);
    CHECK(distance(as<Digits50>(by_law.pull), as<Digits50>(pull)) == Digits50(0));
  }
}

TEST_CASE("clamped rim: it leans further sideways than the dots, by l^4 / (l^4 - 1)", "[wrench]") {
  const Vector e = {0, 1, 0};
  for (const auto& [stretch, factor] : {std::pair{1.107, 3.0}, {1.19, 2.0}, {1.085, 3.59}}) {
    const Vector along = {-0.6 * stretch, 0.1, 0.8 * stretch};
    const Vector pull = clamped_rim_pull(along, e);
    const double leaning = pull.y / std::hypot(pull.x, pull.z);
    const double published = along.y / std::hypot(along.x, along.z);
    const double fourth = std::pow(stretch, 4);
    CHECK(leaning / published == Approx(fourth / (fourth - 1)).epsilon(1e-12));
    CHECK(leaning / published == Approx(factor).epsilon(0.01));
  }
  // a hardly stretched rim has no clear direction
  CHECK(ClampedRim().pull(Vector{-1.004, 0.2, 0}, e).status ==
        detail::membrane::RimPullStatus::unstretched);
  CHECK(ClampedRim().pull(Vector{-1.006, 0.2, 0}, e).status == detail::membrane::RimPullStatus::ok);
  CHECK(ClampedRim().pull(Vector{-0.99, 0.9, 0}, e).status ==
        detail::membrane::RimPullStatus::slack);
  CHECK(ClampedRim{.min_stretch = 1.1}.pull(Vector{-1.09, 0, 0}, e).status ==
        detail::membrane::RimPullStatus::unstretched);
}

TEST_CASE("side dots: one row and the inclination give the derivative at the rim to second order",
          "[wrench]") {
  // An inflated membrane of revolution, integrated from the rim along its stress-free length s:
  //   (r T1)' = T2 r',  T1 kappa1 + T2 sin(theta) / r = p / (mu t),
  // T1 and T2 per current length, theta the inclination, mapped from a cone.
  const double a = 15, free_inclination = 1.1, load_per_mm = 0.09;
  for (const double m : {0.0, 0.15, 0.4}) {
    const auto tension = [&](double along, double across) {
      return (along / across - std::pow(along * across, -3)) * (1 - m + m * across * across);
    };
    // the side dot at s, if the membrane leaves the rim with this stretch and inclination
    const auto dot_at = [&](double s_end, double stretch, double inclination) {
      using State = std::array<double, 4>;  // r, z, theta, T1
      double along = stretch;
      const auto slope = [&](double s, const State& x) {
        const double across = x[0] / (a - s * std::cos(free_inclination));
        for (int k = 0; k < 50; ++k) {  // the stretch of this T1
          const double step = 1e-6;
          const double rise = (tension(along + step, across) - tension(along - step, across)) / 2;
          along -= (tension(along, across) - x[3]) * step / rise;
        }
        const double hoop = tension(across, along);
        return State{-along * std::cos(x[2]), along * std::sin(x[2]),
                     -along * (load_per_mm - hoop * std::sin(x[2]) / x[0]) / x[3],
                     along * (x[3] - hoop) * std::cos(x[2]) / x[0]};
      };
      State x = {a, 0, inclination, tension(stretch, 1)};
      const int steps = 20;
      const double h = s_end / steps;
      for (int k = 0; k < steps; ++k) {  // midpoint rule
        const State begin = slope(k * h, x);
        State middle = x;
        for (std::size_t i = 0; i < 4; ++i) {
          middle[i] += h / 2 * begin[i];
        }
        const State half = slope((k + 0.5) * h, middle);
        for (std::size_t i = 0; i < 4; ++i) {
          x[i] += h * half[i];
        }
      }
      return Vector{x[0], 0, x[1]};
    };
    const double stretch = 1.4, inclination = 1.2;
    const Vector truth = {-stretch * std::cos(inclination), 0, stretch * std::sin(inclination)};
    const auto error = [&](double length) {
      const Vector dots[1] = {dot_at(length, stretch, inclination)};
      const detail::membrane::RimPoint<double> rim = {{a, 0, 0}, {0, 1, 0}, length, a};
      return distance(OneRow{free_inclination}.along(rim, dots, load_per_mm, m), truth);
    };
    CAPTURE(m, error(0.2), error(0.1));
    CHECK(error(0.1) < 1e-3);
    CHECK(error(0.2) / error(0.1) == Approx(4).epsilon(0.15));
  }
}

TEST_CASE("side dots: two rows give the derivative at the rim of any parabola", "[wrench]") {
  test::Random random(4);
  for (int k = 0; k < 50; ++k) {
    const Vector x0 = any_step(random), d = any_step(random), c = any_step(random);
    const double length = random.uniform(0.3, 2);
    const auto at = [&](double s) { return x0 + s * d + s * s * c; };
    const Vector dots[2] = {at(length), at(2 * length)};
    const detail::membrane::RimPoint<double> rim = {x0, {0, 1, 0}, length, 18.735};
    CHECK(distance(TwoRows().along(rim, dots, 0.0), d) < 1e-13);
    // one row gives the mean of d from the rim to the dot
    CHECK(distance(OneRow().along(rim, dots, 0.0), d + length * c) < 1e-13);
    CHECK(distance(OneRow{1.1}.along(rim, dots, 0.0), d + length * c) < 1e-13);
  }
  CHECK(TwoRows::noise_gain == Approx(std::sqrt(17.0) / 2).epsilon(1e-15));
}

namespace {

/// Load of a lateral force, a torque about z and a flat press on the rim of a round pad, whose
/// contact is flat at height H. Pressure has no moment about Q, and the lateral force has the
/// moment of its height, M = H z x F. This gives
///   T = T_0 + a cos(at) up the membrane and tau sin(at) along the rim, with
///   -a (R sin(phi) - H cos(phi)) = H tau.
struct TrueLoad {
  double normal = 0, lean = 0, shear = 0, turning = 0;
  double heading = 0;  ///< of the force

  template <class Pad>
  TrueLoad(const Pad& pad, double lateral, double twist, double heading_rad = 0)
      : heading(heading_rad) {
    const double sine = pad.sine(pad.radius_mm), cosine = std::sqrt(1 - sine * sine);
    const double high = pad.height(0);
    normal = pad.tension(pad.radius_mm, pressed_mpa);
    shear = lateral * normal;
    turning = twist * normal;
    lean = -high * shear / (pad.radius_mm * sine - high * cosine);
  }
  RimLoad operator()(double at) const {
    return {normal + lean * std::cos(at - heading), turning - shear * std::sin(at - heading)};
  }
};

/// Result of an estimator for a pad and a load.
struct Found {
  WrenchResult<double> result;
  test::Wrench6 truth;
  Vector force_error, moment_error;
  double tension_error = 0;  ///< largest error of the tensions at the dots, relative to the mean

  double lateral() const { return std::hypot(truth.force_n.x, truth.force_n.y); }
};

template <class W, class Pad, class Load>
Found find(
    const W& wrench, const Pad& pad, const RimOfDots& rim, const Load& load, Index rows = 1) {
  auto workspace = wrench.workspace();
  Found f;
  f.result = wrench(pad, rim.dots(load, rows), pressed_mpa, workspace);
  f.truth = wrench_of(rim, load, pressed_mpa);
  f.force_error = f.result.force_n - f.truth.force_n;
  f.moment_error = f.result.moment_n_mm - f.truth.moment_n_mm;
  double mean = 0;
  for (Index k = 0; k < rim.count; ++k) {
    const Vector pull = rim.pull(k, load(rim.angle(k)));
    f.tension_error = (std::max)(f.tension_error, distance(workspace.rim_tension(k), pull));
    mean += size(pull) / static_cast<double>(rim.count);
  }
  f.tension_error /= mean;
  return f;
}

template <class Solver, class Pad, class Load>
Found find(const Pad& pad, const Load& load, Index columns = 72, Index rows = 65) {
  const RimOfDots rim = rim_of(pad);
  const test::WrenchBy<Solver> wrench(rim.borders(), test::exact_options(columns, rows));
  return find(wrench, pad, rim, load);
}

}  // namespace

TEMPLATE_TEST_CASE("wrench of a flat press in closed form",
                   "[wrench][figures]",
                   BalancedRim,
                   published::ClosedForm,
                   published::Iteration,
                   LeastSquares) {
  const auto check = [](const auto& pad) {
    const TrueLoad load(pad, 0, 0);
    const double area = pi * pad.contact_mm * pad.contact_mm;
    const Found f = find<TestType>(pad, load);
    REQUIRE(f.result.status == WrenchStatus::ok);
    CHECK(f.truth.force_n.z == Approx(-pressed_mpa * area).epsilon(1e-9));
    CHECK(std::abs(f.force_error.z) <= 1e-3 * pressed_mpa * area);
    CHECK(std::abs(f.result.force_n.x) + std::abs(f.result.force_n.y) <= 1e-9);
    CHECK(size(f.result.moment_n_mm) <= 1e-8);
    CHECK(f.result.summit_area_mm2 == Approx(area).epsilon(1e-3));
    CHECK(f.result.modulus_n_per_mm == Approx(0.5).epsilon(1e-3));
    CHECK(f.tension_error <= 1e-3);
    CHECK(f.result.level_lines == 72);
    CHECK(f.result.broken_lines + f.result.missing + f.result.unstretched + f.result.outward == 0);
    if (std::is_same_v<TestType, LeastSquares>) {
      CHECK(f.result.residual <= 2e-3);
    } else if (std::is_same_v<TestType, published::Iteration>) {
      // the lowest row is pulled in the direction of the rim, half a row lower than its own
      CHECK(f.result.residual <= 0.15);
    } else {
      CHECK(f.result.residual != f.result.residual);
    }
    // the solution does not depend on the fineness of the mesh
    for (const auto& [columns, rows] : {std::pair{18, 16}, {36, 30}}) {
      const Found coarse = find<TestType>(pad, load, columns, rows);
      INFO(columns << " x " << rows << ": F_z wrong by " << coarse.force_error.z);
      CHECK(std::abs(coarse.force_error.z) <= 1e-3 * pressed_mpa * area);
    }
  };
  check(RoundPad<ArcSide>{});
  check(RoundPad<ArcSide>{{.contact_mm = 11, .height_mm = 7}});
  check(RoundPad<FilmSide>{});
  check(RoundPad<FilmSide>{{.contact_mm = 12, .rim_sine = 0.7}});
}

TEMPLATE_TEST_CASE("wrench of lateral loads and torques",
                   "[wrench]",
                   BalancedRim,
                   test::KnownModulus) {
  // exact in the tensions at the rim, therefore in force and moment
  const RoundPad<FilmSide> pad;
  for (const double heading : {0.0, 0.7}) {
    for (const double twist : {0.0, 0.2}) {
      const TrueLoad load(pad, 0.1, twist, heading);
      const Found f = find<TestType>(pad, load);
      REQUIRE(f.result.status == WrenchStatus::ok);
      CHECK(size(f.force_error) <= 1e-3 * f.lateral());
      // the moment of straight pieces between 72 dots is smaller than that of a circle
      CHECK(size(f.moment_error) <= 1.5e-3 * size(f.truth.moment_n_mm));
      CHECK(f.tension_error <= 1e-3);
      // the force acts at the height of the object
      CHECK(f.truth.moment_n_mm.y == Approx(pad.height(0) * f.truth.force_n.x).epsilon(1e-9));
      CHECK(f.truth.moment_n_mm.z ==
            Approx(2 * pi * pad.radius_mm * pad.radius_mm * load.turning).margin(1e-9));
    }
  }
}

TEST_CASE("wrench of lateral loads and torques, each column by itself", "[wrench][figures]") {
  const RoundPad<FilmSide> pad;
  const TrueLoad drag(pad, 0.1, 0), twist(pad, 0, 0.2);
  const auto error = [](const Found& f) { return std::abs(f.force_error.x) / f.lateral(); };
  // the closed form neglects the shear between columns: their vertical pull is that of a press, so
  // there is no moment about x and y
  const Found closed = find<published::ClosedForm>(pad, drag);
  CHECK(size(closed.result.moment_n_mm) <= 1e-8);
  CHECK(std::abs(closed.force_error.z) <= 1e-3 * std::abs(closed.truth.force_n.z));
  const Found march = find<published::Iteration>(pad, drag);
  const Found squares = find<LeastSquares>(pad, drag);
  INFO("F_x off by: closed form " << error(closed) << ", published iteration " << error(march)
                                  << ", least squares " << error(squares) << "; M_y by "
                                  << closed.moment_error.y << ", " << march.moment_error.y << ", "
                                  << squares.moment_error.y << " of " << march.truth.moment_n_mm.y
                                  << "; residual " << march.result.residual << ", "
                                  << squares.result.residual);
  CHECK(error(closed) > 0.1);
  CHECK((error(march) > 0.02 && error(march) < 0.08));
  CHECK(error(squares) < 0.002);
  CHECK(std::abs(march.moment_error.y) < 0.35 * march.truth.moment_n_mm.y);
  CHECK(std::abs(squares.moment_error.y) < 0.002 * squares.truth.moment_n_mm.y);
  CHECK(march.result.residual > 0.01);
  CHECK(squares.result.residual < 2e-3);
  for (const Found& f : {find<published::ClosedForm>(pad, twist),
                         find<published::Iteration>(pad, twist), find<LeastSquares>(pad, twist)}) {
    CHECK(std::abs(f.moment_error.z) <= 2e-3 * f.truth.moment_n_mm.z);
  }
}

namespace {

/// Largest error of f_v inside, relative to its largest value, and of the residual.
struct InnerError {
  double tension = 0;
  double residual = 0;

  template <class Solver>
  InnerError(const Solver& solver, Index columns, Index rows) {
    using namespace detail::membrane;
    const RoundPad<ArcSide> pad;
    const RimOfDots rim_dots = rim_of(pad);
    const double t0 = pad.tension(pad.radius_mm, pressed_mpa);
    const Rim<double> rim(
        rim_dots.borders(), [](Index) { return 0.8; }, pad.radius_mm, columns);
    auto pulls = rim.pulls();
    rim.measure(rim_dots.dots([&](double) {
      return RimLoad{t0, 0};
    }),
                OneRow(), ClampedRim(), 0.0, pulls);
    rim.integrate(pulls);
    Compartments<double> nodes(columns, rows, pad.radius_mm, {0.1, 0, 1});
    nodes.template lay<StraightLines>(pad, {0, 0, 0});
    Segments<double> segments(columns, rows);
    segments.measure(nodes);
    Tensions<double> tensions(columns, rows);
    typename Solver::template Work<double> work(solver, columns, rows);
    const double p = pressed_mpa;
    REQUIRE(solver.template solve<true>(segments, nodes, pulls.segments, p, work, tensions));
    residual = detail::membrane::residual(segments, tensions, p);
    for (Index j = 0; j + 2 < rows; ++j) {  // at the top it is 0 / 0
      const Vector& at = nodes.node(0, j);
      const double truth = pad.tension(std::hypot(at.x, at.y), p);
      const double found = tensions.around_normal[static_cast<std::size_t>(j * columns)];
      tension = (std::max)(tension, std::abs(found - truth) / t0);
    }
  }
};

}  // namespace

TEST_CASE("tensions within a flat press: the mesh converges", "[wrench][figures]") {
  const auto check = [](const auto& solver, const char* name, double max_residual) {
    const InnerError coarse(solver, 18, 16), middle(solver, 36, 32), fine(solver, 72, 64);
    INFO(name << ", f_v off by at most " << coarse.tension << " at 18 x 16, " << middle.tension
              << " at 36 x 32, " << fine.tension << " at 72 x 64; residual " << coarse.residual
              << ", " << middle.residual << ", " << fine.residual);
    CHECK(fine.tension <= 0.01);
    CHECK(middle.tension < coarse.tension);
    CHECK(fine.tension < middle.tension);
    CHECK(fine.residual <= max_residual);
  };
  check(published::Iteration(), "published iteration", 0.15);
  check(LeastSquares(), "least squares", 1e-4);
}

TEST_CASE("an inflated cap that touches nothing", "[wrench]") {
  const RoundPad<CapSide> cap{{.contact_mm = 0}};
  const RimOfDots rim = rim_of(cap);
  const double tension = pressed_mpa * cap.sphere_mm / 2;
  const auto load = [&](double) { return RimLoad{tension, 0}; };
  const auto dots = rim.dots(load);
  const auto check = [&](const auto& wrench) {
    auto workspace = wrench.workspace();
    const auto r = wrench(cap, dots, pressed_mpa, workspace, {0.01, 0.1, 1e-4});
    CHECK(r.status != WrenchStatus::refused);
    CHECK(r.status == WrenchStatus::no_contact);
    CHECK(r.ok());
    CHECK(size(r.force_n) == 0);
    CHECK(size(r.moment_n_mm) == 0);
    CHECK(r.summit_area_mm2 == 0);
    CHECK(r.modulus_n_per_mm != r.modulus_n_per_mm);
    CHECK(workspace.rim_tension(3).z != workspace.rim_tension(3).z);
  };
  check(Wrench<BalancedRim>(rim.borders()));
  check(Wrench<published::ClosedForm>(rim.borders()));
  check(Wrench<published::Iteration>(rim.borders()));
  check(Wrench<LeastSquares>(rim.borders()));
  check(Wrench<published::Iteration, OneRow, published::Direction, published::SteepestLines>(
      rim.borders()));

  // by_modulus() needs no contact: the tension, p R / 2, carries the pressure on the base
  const test::ByModulus<> given(rim.borders());
  const Found f = find(given, cap, rim, load);
  CHECK(f.result.status == WrenchStatus::ok);
  CHECK(size(f.truth.force_n) < 1e-9);
  CHECK(size(f.force_error) < 1e-9);
  CHECK(size(f.moment_error) < 1e-9);
  CHECK(f.tension_error < 1e-9);
  CHECK(f.result.summit_area_mm2 != f.result.summit_area_mm2);
}

TEST_CASE("an inflated cap marked as touching, but not pressed", "[wrench]") {
  // Its tension p R / 2 also pulls the part above A_g upward, as much as the pressure pushes there.
  const RoundPad<CapSide> cap{{.contact_mm = 1.5}};
  const auto load = [&](double) { return RimLoad{pressed_mpa * cap.sphere_mm / 2, 0}; };
  const double marked = pressed_mpa * pi * 1.5 * 1.5;
  const Found balanced = find<BalancedRim>(cap, load);
  REQUIRE(balanced.result.status == WrenchStatus::ok);
  CHECK(std::abs(balanced.result.force_n.z) < 0.2 * marked);
  CHECK(balanced.tension_error < 1e-3);
  CHECK(balanced.result.modulus_n_per_mm == Approx(0.5).epsilon(1e-3));
  // a membrane without a level line does not show how much it pulls
  const RoundPad<CapSide> steep{{.contact_mm = 9}};
  CHECK(find<BalancedRim>(steep, load).result.status == WrenchStatus::no_level_line);
  CHECK(find<test::KnownModulus>(steep, load).result.status == WrenchStatus::ok);
}

TEMPLATE_TEST_CASE("wrench: where the shape does not tell, the modulus does, if so chosen",
                   "[wrench]",
                   BalancedRim,
                   LeastSquares) {
  const RoundPad<CapSide> steep{{.contact_mm = 9}}, level{{.contact_mm = 1.5}};
  const RimOfDots rim = rim_of(steep);
  const auto load = [&](double) { return RimLoad{pressed_mpa * steep.sphere_mm / 2, 0}; };
  const auto dots = rim.dots(load);
  auto options = test::exact_options();
  options.calibrated_modulus_n_per_mm = 0.5;
  const Wrench<TestType> asks_shape(rim.borders(), options);
  options.falls_back_on_modulus = true;
  const Wrench<TestType> falls_back(rim.borders(), options);
  auto work = falls_back.workspace(), other = asks_shape.workspace();
  const WrenchNoise<double> noise{0.005, 0.1, 1e-5};

  CHECK(asks_shape(steep, dots, pressed_mpa, other, noise).status == WrenchStatus::no_level_line);
  const auto r = falls_back(steep, dots, pressed_mpa, work, noise);
  const auto given = asks_shape.by_modulus(dots, pressed_mpa, other, noise);
  CHECK(r.status == WrenchStatus::ok);
  CHECK(r.by_modulus);
  CHECK(given.by_modulus);
  CHECK(r.force_n.z == given.force_n.z);
  CHECK(r.covariance[2][2] == given.covariance[2][2]);
  CHECK(work.rim_tension(3).z == other.rim_tension(3).z);
  // the values from the shape are kept
  CHECK(r.summit_area_mm2 != r.summit_area_mm2);
  CHECK(r.level_lines == 0);
  // where the shape suffices it is used, and bad side dots are still refused
  const auto told = falls_back(level, dots, pressed_mpa, work, noise);
  CHECK(told.status == WrenchStatus::ok);
  CHECK(!told.by_modulus);
  CHECK(told.force_n.z == asks_shape(level, dots, pressed_mpa, other, noise).force_n.z);
  auto lost = dots;
  for (Index k = 0; k < 30; ++k) {
    lost(0, k).x = test::nan;
  }
  CHECK(falls_back(steep, lost, pressed_mpa, work).status == WrenchStatus::too_few_side_dots);
  CHECK(falls_back(steep, dots, -1, work).status == WrenchStatus::bad_pressure);
  // without a modulus there is no answer
  const Wrench<TestType> without(rim.borders(), test::exact_options());
  CHECK(without.by_modulus(dots, pressed_mpa, other).status == WrenchStatus::refused);
}

TEST_CASE("wrench by two rows of side dots", "[wrench]") {
  RimOfDots rim = rim_of(RoundPad<FilmSide>{});
  rim.bend_per_mm = 0.03;
  const RoundPad<FilmSide> pad;
  const TrueLoad load(pad, 0.1, 0.1);
  const auto options = test::exact_options();
  const Found one = find(test::ByModulus<>(rim.borders(), options), pad, rim, load);
  const Found two = find(test::ByModulus<TwoRows>(rim.borders(), options), pad, rim, load, 2);
  CHECK(size(one.force_error) > 0.05 * one.lateral());
  CHECK(size(two.force_error) < 1e-9);
  CHECK(size(two.moment_error) < 1.5e-3 * size(two.truth.moment_n_mm));
}

TEST_CASE("the published direction: too little lateral force and torque, by 1 - l^-4", "[wrench]") {
  const RoundPad<FilmSide> pad;
  const RimOfDots rim = rim_of(pad);
  const double share = 1 - std::pow(rim.stretch(pad.tension(pad.radius_mm, pressed_mpa)), -4);
  CHECK((share > 0.1 && share < 0.7));
  const auto options = test::exact_options();
  const TrueLoad twist(pad, 0, 0.1);
  // a lateral force without a moment: columns pull upward as much as they are pressed down
  const auto slide = [&](double at) {
    return RimLoad{twist.normal, -0.1 * twist.normal * std::sin(at)};
  };
  const auto gain = [&](const auto& wrench) {
    const Found force = find(wrench, pad, rim, slide), torque = find(wrench, pad, rim, twist);
    REQUIRE(force.result.status == WrenchStatus::ok);
    CHECK(std::abs(force.force_error.z) < 1e-3 * std::abs(force.truth.force_n.z));
    CHECK(force.result.modulus_n_per_mm != force.result.modulus_n_per_mm);
    return std::array{force.result.force_n.x / force.truth.force_n.x,
                      torque.result.moment_n_mm.z / torque.truth.moment_n_mm.z};
  };
  const auto closed =
      gain(Wrench<published::ClosedForm, OneRow, published::Direction>(rim.borders(), options));
  CHECK(closed[0] == Approx(share).epsilon(1e-3));
  CHECK(closed[1] == Approx(share).epsilon(2e-3));
  const auto published =
      gain(Wrench<published::Iteration, OneRow, published::Direction, published::SteepestLines>(
          rim.borders(), options));
  CHECK(published[1] == Approx(share).epsilon(2e-3));
}

namespace {

/// Covariance of force and moment over random draws.
class Draws {
 public:
  void add(const WrenchResult<double>& r) {
    const std::array<double, 6> v = {r.force_n.x,     r.force_n.y,     r.force_n.z,
                                     r.moment_n_mm.x, r.moment_n_mm.y, r.moment_n_mm.z};
    for (std::size_t i = 0; i < 6; ++i) {
      mean_[i] += v[i];
      for (std::size_t j = 0; j < 6; ++j) {
        sums_[i][j] += v[i] * v[j];
      }
    }
    ++count_;
  }
  double operator()(std::size_t i, std::size_t j) const {
    return sums_[i][j] / count_ - mean_[i] / count_ * mean_[j] / count_;
  }
  double count() const { return count_; }

 private:
  std::array<double, 6> mean_{};
  std::array<std::array<double, 6>, 6> sums_{};
  double count_ = 0;
};

/// Checks that both covariances agree, relative to the reported standard deviations, within the
/// scatter of the draws. `floor`: smaller standard deviations do not count.
void check_covariance(const std::array<std::array<double, 6>, 6>& told,
                      const Draws& draws,
                      double floor = 1e-4,
                      double model = 0.05) {
  const double allowed = 5 * std::sqrt(2 / draws.count()) + model;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      CAPTURE(i, j, told[i][j], draws(i, j), told[i][i], told[j][j]);
      CHECK(told[i][j] == told[j][i]);
      const double scale = (std::sqrt(told[i][i]) + floor) * (std::sqrt(told[j][j]) + floor);
      CHECK(std::abs(told[i][j] - draws(i, j)) / scale <= allowed);
    }
  }
}

template <class S, class L, class R>
struct Way {
  using Solver = S;
  using Law = L;
  using Row = R;
};

}  // namespace

TEMPLATE_TEST_CASE("covariance of force and moment, by draws of noisy side dots",
                   "[wrench][figures]",
                   (Way<BalancedRim, ClampedRim, OneRow>),
                   (Way<BalancedRim, ClampedRim, TwoRows>),
                   (Way<published::ClosedForm, ClampedRim, OneRow>),
                   (Way<published::ClosedForm, ClampedRim, TwoRows>),
                   (Way<published::ClosedForm, published::Direction, OneRow>),
                   (Way<test::KnownModulus, ClampedRim, OneRow>),
                   (Way<test::KnownModulus, ClampedRim, TwoRows>)) {
  using Row = typename TestType::Row;
  const RoundPad<FilmSide> pad;
  const RimOfDots rim = rim_of(pad);
  const TrueLoad load(pad, 0.15, 0.15, 0.4);
  auto options = test::exact_options(36, 4);
  options.line_step_mm = 0.2;
  const test::WrenchBy<typename TestType::Solver, Row, typename TestType::Law> wrench(rim.borders(),
                                                                                      options);
  auto workspace = wrench.workspace();
  const WrenchNoise<double> noise{.side_dot_mm = 0.003, .pressure_mpa = 5e-5};
  const auto exact = rim.dots(load, Row::rows);
  const auto told = wrench(pad, exact, pressed_mpa, workspace, noise).covariance;
  test::Gauss gauss(5);
  Draws draws;
  for (int k = 0; k < 600; ++k) {
    auto dots = exact;
    for (auto& p : dots.cells) {
      p = {p.x + noise.side_dot_mm * gauss(), p.y + noise.side_dot_mm * gauss(),
           p.z + noise.side_dot_mm * gauss()};
    }
    const auto r = wrench(pad, dots, pressed_mpa + noise.pressure_mpa * gauss(), workspace);
    REQUIRE(r.status == WrenchStatus::ok);
    draws.add(r);
  }
  check_covariance(told, draws);
  CHECK(told[0][0] > 0);
  // the variances of single sources add up
  const auto dots_alone = wrench(pad, exact, pressed_mpa, workspace, {.side_dot_mm = 0.003});
  const auto p_alone = wrench(pad, exact, pressed_mpa, workspace, {.pressure_mpa = 5e-5});
  CHECK(dots_alone.covariance[2][2] + p_alone.covariance[2][2] ==
        Approx(told[2][2]).epsilon(1e-12));
  CHECK(wrench(pad, exact, pressed_mpa, workspace).covariance[2][2] == 0);
}

namespace {

/// A film whose contact ends at a different radius on each line.
struct UnevenFilm {
  std::vector<RoundPad<FilmSide>> of_line;

  const RoundPad<FilmSide>& at(double x, double y) const {
    const double n = static_cast<double>(of_line.size());
    const double turn = std::atan2(y, x) / (2 * pi);
    const double line = std::floor((turn < 0 ? turn + 1 : turn) * n + 0.5);
    return of_line[static_cast<std::size_t>(line) % of_line.size()];
  }
  detail::membrane::HeightAndSlope<double> operator()(double x, double y) const {
    return at(x, y)(x, y);
  }
  bool in_contact(double x, double y) const { return at(x, y).in_contact(x, y); }
};

template <class Solver>
void check_edge_covariance() {
  const RoundPad<FilmSide> pad;
  const RimOfDots rim = rim_of(pad);
  const TrueLoad load(pad, 0.15, 0.15, 0.4);
  const auto exact = rim.dots(load);
  auto options = test::exact_options(36, 4);
  const Wrench<Solver> wrench(rim.borders(), options);
  auto workspace = wrench.workspace();
  const WrenchNoise<double> noise{.edge_mm = 0.05};
  const auto told = wrench(pad, exact, pressed_mpa, workspace, noise).covariance;
  test::Gauss gauss(6);
  Draws draws;
  for (int k = 0; k < 300; ++k) {
    UnevenFilm film;
    for (int line = 0; line < 36; ++line) {
      film.of_line.push_back({{.contact_mm = 8 + noise.edge_mm * gauss()}});
    }
    const auto r = wrench(film, exact, pressed_mpa, workspace);
    REQUIRE(r.status == WrenchStatus::ok);
    draws.add(r);
  }
  // the tolerance includes the share of the force that acts on the edge
  check_covariance(told, draws, 0.02 * std::sqrt(told[2][2]), 0.15);
}

}  // namespace

TEST_CASE("covariance of force and moment, by draws of the edge of the contact",
          "[wrench][figures]") {
  check_edge_covariance<BalancedRim>();
}

TEST_CASE("what the workspace keeps of a frame", "[wrench]") {
  const RoundPad<FilmSide> pad;
  RimOfDots rim = rim_of(pad);
  rim.count = 24;
  const TrueLoad load(pad, 0.1, 0);
  auto dots = rim.dots(load);
  dots(0, 5).x = test::nan;
  const auto b = rim.border(9), m = rim.upward(9);
  dots(0, 9) = {b.x + 0.8 * 0.99 * m.x, b.y + 0.8 * 0.99 * m.y, b.z + 0.8 * 0.99 * m.z};
  dots(0, 11) = {b.x, b.y, 1e6};
  const Wrench<BalancedRim> wrench(rim.borders(), test::exact_options(36, 30));
  CHECK(wrench.side_dots() == 24);
  CHECK(wrench.options().rows == 30);
  auto workspace = wrench.workspace();
  CHECK(workspace.rim_points() == 24);
  const auto r = wrench(pad, dots, pressed_mpa, workspace);
  REQUIRE(r.status == WrenchStatus::ok);
  CHECK(r.missing == 2);
  CHECK(r.slack == 1);
  CHECK(r.unstretched == 1);
  for (Index k = 0; k < 24; ++k) {
    const Vector truth = rim.pull(k, load(rim.angle(k)));
    CHECK(distance(workspace.rim_tension(k), truth) < 0.02 * size(truth));
  }
  for (Index i = 0; i < 36; ++i) {
    const Vector& low = workspace.node(i, 0);
    const Vector& top = workspace.node(i, 30);
    CHECK(std::hypot(low.x, low.y) == Approx(rim.radius_mm).epsilon(1e-12));
    CHECK(std::hypot(top.x, top.y) == Approx(8).epsilon(1e-3));
    CHECK(top.z == Approx(pad.height(0)).epsilon(1e-3));
  }
}

TEST_CASE("lines straight or steepest: the same on a round pad", "[wrench]") {
  const RoundPad<ArcSide> pad;
  const RimOfDots rim = rim_of(pad);
  const TrueLoad load(pad, 0, 0.1);
  const auto options = test::exact_options();
  const Found straight =
      find(Wrench<published::ClosedForm>(rim.borders(), options), pad, rim, load);
  const Found steepest =
      find(Wrench<published::ClosedForm, OneRow, ClampedRim, published::SteepestLines>(
               rim.borders(), options),
           pad, rim, load);
  CHECK(straight.result.force_n.z == Approx(steepest.result.force_n.z).epsilon(1e-4));
  CHECK(straight.result.moment_n_mm.z == Approx(steepest.result.moment_n_mm.z).epsilon(1e-4));
  // the published rows are equally spaced in height
  const Wrench<published::ClosedForm, OneRow, ClampedRim, published::SteepestLines> published(
      rim.borders(), options);
  auto workspace = published.workspace();
  (void)published(pad, rim.dots(load), pressed_mpa, workspace);
  for (Index j = 0; j <= 65; ++j) {
    CHECK(workspace.node(7, j).z == Approx(9.0 * static_cast<double>(j) / 65).margin(2e-3));
  }
}

TEST_CASE("side dots of different stress-free lengths", "[wrench]") {
  const RoundPad<FilmSide> pad;
  RimOfDots rim = rim_of(pad);
  const TrueLoad load(pad, 0.1, 0.1);
  auto dots = rim.dots(load);
  const auto length = [](Index k) { return 0.8 + 0.01 * static_cast<double>(k % 7); };
  for (Index k = 0; k < rim.count; ++k) {
    dots(0, k) = rim.border(k) + length(k) * rim.along(k, load(rim.angle(k)));
  }
  auto options = test::exact_options();
  options.calibrated_modulus_n_per_mm = 0.5;
  const Wrench<BalancedRim> wrench(rim.borders(), length, options);
  auto workspace = wrench.workspace();
  const auto r = wrench.by_modulus(dots, pressed_mpa, workspace);
  const auto truth = wrench_of(rim, load, pressed_mpa);
  CHECK(distance(r.force_n, truth.force_n) < 1e-9);
  CHECK(distance(r.moment_n_mm, truth.moment_n_mm) < 1.5e-3 * size(truth.moment_n_mm));
}

namespace {
/// A tilted bowl over the plate as the camera sees it.
struct Bowl {
  Camera<double> camera{
      .center_x_px = test::uniform(75, 85), .center_y_px = test::uniform(55, 65), .pitch_mm = 0.3};
  double top_mm = test::uniform(5, 10), radius_mm = test::uniform(18, 40);
  double along_x = test::uniform(-0.1, 0.1), along_y = test::uniform(-0.1, 0.1);

  double height(double x, double y) const {
    return top_mm + along_x * x + along_y * y - (x * x + y * y) / (2 * radius_mm);
  }
  /// A ray is steep, so the height at its end hardly depends on where it ends.
  double depth(Index i, Index j) const {
    double mm = top_mm;
    for (int k = 0; k < 20; ++k) {
      const auto p = point_at(camera, static_cast<double>(i), static_cast<double>(j), mm);
      mm = height(p.x, p.y);
    }
    return mm > 0 ? mm : test::nan;
  }
};
}  // namespace

TEST_CASE("heights in plan are those that a camera has seen along its rays", "[wrench]") {
  rc::prop("and neither lost pixels nor wild ones change what is seen beside them", [] {
    const Bowl bowl;
    test::Image<double> depth(120, 160);
    const test::Image<std::uint8_t> mask(120, 160, 255);
    for (Index i = 0; i < depth.rows(); ++i) {
      for (Index j = 0; j < depth.cols(); ++j) {
        depth(i, j) = bowl.depth(i, j);
      }
    }
    const PadHeights<Camera<double>> heights(120, 160, bowl.camera, 15.0);
    auto whole = heights.map(), torn = heights.map();
    RC_ASSERT(heights(depth, mask, whole));
    const Index row = test::whole(40, 80), col = test::whole(60, 100);
    const double seen_mm = depth(row, col);
    const auto hole =
        point_at(bowl.camera, static_cast<double>(row), static_cast<double>(col), seen_mm);
    const double wild = test::whole(0, 3) == 0 ? test::nan : test::uniform(-1000, 1000);
    for (Index i = row - 3; i <= row + 3; ++i) {
      for (Index j = col - 3; j <= col + 3; ++j) {
        depth(i, j) = wild;
      }
    }
    RC_ASSERT(heights(depth, mask, torn));
    for (Index i = 0; i < whole.side(); ++i) {
      for (Index j = 0; j < whole.side(); ++j) {
        const double x = whole.position_mm(j), y = whole.position_mm(i);
        const double truth = bowl.height(x, y);
        const double found = whole.node(i, j).height_mm;
        if (truth > 0.5) {
          RC_ASSERT(std::abs(found - truth) < 0.003);
          RC_ASSERT((truth < 1.5 || std::hypot(x, y) > 14 || whole.in_contact(x, y)));
          if (std::hypot(x - hole.x, y - hole.y) > 3) {
            RC_ASSERT(std::abs(torn.node(i, j).height_mm - found) < 0.001);
          }
        }
      }
    }
  });
}

TEST_CASE("a position is in contact if two of the four pixels around it are", "[wrench]") {
  const OrthographicCamera<double> camera{
      .center_x_px = 30.5, .center_y_px = 20.5, .pitch_mm = 0.25};
  const PadHeights heights(42, 62, camera, 4.0);
  const test::Image<double> depth(42, 62, 2.0);
  auto map = heights.map();
  for (int marked = 0; marked < 16; ++marked) {
    test::Image<std::uint8_t> mask(42, 62, 0);
    int count = 0;
    for (Index k = 0; k < 4; ++k) {
      const bool touches = (marked >> k & 1) != 0;
      mask(16 + k / 2, 36 + k % 2) = touches;
      count += touches ? 1 : 0;
    }
    REQUIRE(heights(depth, mask, map));
    CAPTURE(marked);
    CHECK(map.in_contact(1.5, -1.0) == (count >= 2));
    CHECK_FALSE(map.in_contact(-1.0, 1.5));
  }
}

TEST_CASE("heights on a mesh: every node has its height, and all but the border a slope",
          "[wrench]") {
  PadHeights<>::Map map(1.0, 0.5);
  REQUIRE(map.side() == 7);
  const auto plane = [&](Index i, Index j) {
    return 3 + 2 * map.position_mm(j) - 5 * map.position_mm(i);
  };
  map.fill(plane, [](const auto&...) { return 0.0; });
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 7; ++j) {
      CAPTURE(i, j);
      const auto& node = map.node(i, j);
      const bool inside = i > 0 && i < 6 && j > 0 && j < 6;
      CHECK(node.height_mm == plane(i, j));
      CHECK(is_finite(node.along_x) == inside);
      CHECK(is_finite(node.along_y) == inside);
      CHECK((!inside || (node.along_x == 2 && node.along_y == -5)));
    }
  }
}

namespace {
/// Slopes of a membrane around a level contact of radius r_g, with
/// r^2 - r_g^2 = level r sin(inclination) (1 + growth (r - r_g)). The map shows the edge too far
/// out.
struct LevelContact {
  double edge_mm = 6, level_mm = 30, growth_per_mm = 0;

  struct Slopes {
    double height_mm, along_x, along_y;
  };
  Slopes operator()(double x, double y) const {
    const double r = std::hypot(x, y);
    if (!(r > edge_mm)) {
      return {5, 0, 0};
    }
    const double sine =
        (r * r - edge_mm * edge_mm) / (level_mm * r * (1 + growth_per_mm * (r - edge_mm)));
    const double fall = sine / std::sqrt(1 - sine * sine);
    return {5, -fall * x / r, -fall * y / r};
  }
  bool in_contact(double x, double y) const { return std::hypot(x, y) < edge_mm + 0.3; }
};
}  // namespace

TEST_CASE("heights on a mesh end before its last nodes", "[wrench]") {
  PadHeights<>::Map map(2, 0.5);
  map.fill([](Index, Index) { return 1.0; }, [](Index, Index, double) { return 1.0; });
  const double last = 0.5 * static_cast<double>(map.side() / 2);
  CHECK(map(last - 1e-9, 0.0).height_mm == 1);
  CHECK(map(0.0, last - 1e-9).height_mm == 1);
  CHECK(std::isnan(map(last, 0.0).height_mm));
  CHECK(std::isnan(map(0.0, last).height_mm));
}

TEST_CASE("the edge of a contact is where the balance of the membrane beside it ends", "[wrench]") {
  // a line is cut between points 0.1 mm apart, linearly in r^2
  const double cut_mm = 0.1 * 0.1 / (8 * 6);
  for (const double growth : {0.0, 0.02, -0.02}) {
    detail::membrane::Compartments<double> nodes(8, 5, 15.0, {0.1, 0.5, 3.0});
    nodes.lay<StraightLines>(LevelContact{.growth_per_mm = growth}, {0, 0, 0});
    for (Index i = 0; i < 8; ++i) {
      const auto& end = nodes.node(i, 5);
      CAPTURE(growth, i);
      CHECK(nodes.end(i) == detail::membrane::LineEnd::edge);
      CHECK(std::hypot(end.x, end.y) == Approx(6).margin(cut_mm).epsilon(0));
    }
  }
}

TEST_CASE("heights on a mesh stand for the shape", "[wrench]") {
  const RoundPad<FilmSide> pad;
  PadHeights<>::Map map(19.5, 0.25);
  CHECK(map.side() == 2 * 79 + 1);
  CHECK(map.position_mm(79) == 0);
  map.fill([&](Index i,
               Index j) { return pad.height(std::hypot(map.position_mm(i), map.position_mm(j))); },
           [&](Index i, Index j, const auto&...) {
             return pad.in_contact(map.position_mm(j), map.position_mm(i)) ? 1.0 : 0.0;
           });
  test::Random random(8);
  for (int k = 0; k < 300; ++k) {
    const double r = random.uniform(0, 17), at = random.uniform(0, 2 * pi);
    const double x = r * std::cos(at), y = r * std::sin(at);
    const auto found = map(x, y);
    const auto truth = pad(x, y);
    const double kink = std::abs(r - 8) < 0.5 ? 1 : 0.1;
    CHECK(std::abs(found.height_mm - truth.height_mm) < 0.02);
    CHECK(std::abs(found.along_x - truth.along_x) < 0.2 * kink);
    CHECK(std::abs(found.along_y - truth.along_y) < 0.2 * kink);
    CHECK((std::abs(r - 8) < 0.3 || map.in_contact(x, y) == (r < 8)));
  }
  CHECK(map(19.8, 0).height_mm != map(19.8, 0).height_mm);
  CHECK(map(test::nan, 0).height_mm != map(test::nan, 0).height_mm);
  CHECK_FALSE(map.in_contact(1e300, 0));
  const RimOfDots rim = rim_of(pad);
  const TrueLoad load(pad, 0.1, 0.1);
  auto options = test::exact_options();
  options.blur_mm = 0.6;
  options.reach_mm = 4;
  options.line_step_mm = 0.25;
  const Wrench<BalancedRim> wrench(rim.borders(), options);
  auto workspace = wrench.workspace();
  const auto r = wrench(map, rim.dots(load), pressed_mpa, workspace);
  const auto truth = wrench_of(rim, load, pressed_mpa);
  REQUIRE(r.status == WrenchStatus::ok);
  CHECK(distance(r.force_n, truth.force_n) < 0.01 * size(truth.force_n));
}

TEMPLATE_TEST_CASE("wrench in other number types", "[wrench]", float, long double, Digits50) {
  using S = TestType;
  const RoundPad<FilmSide> pad;
  RimOfDots rim = rim_of(pad);
  rim.count = 24;
  const TrueLoad load(pad, 0.1, 0.1, 0.3);
  const auto convert = [](const auto& from) {
    test::Image<Point3<S>> to(from.rows(), from.cols(), {S(0), S(0), S(0)});
    for (std::size_t k = 0; k < from.cells.size(); ++k) {
      to.cells[k] = as<S>(from.cells[k]);
    }
    return to;
  };
  const auto run = [&](auto solver) {
    using Solver = decltype(solver);
    const test::WrenchBy<Solver> exact(rim.borders(), test::exact_options(24, 20));
    auto exact_work = exact.workspace();
    const WrenchNoise<double> noise{0.005, 0.1, 1e-5};
    const auto truth = exact(pad, rim.dots(load), pressed_mpa, exact_work, noise);
    const test::WrenchBy<Solver, OneRow, ClampedRim, StraightLines, S> wrench(
        convert(rim.borders()), test::exact_options<S>(24, 20));
    auto work = wrench.workspace();
    const auto found = wrench(pad, convert(rim.dots(load)), S(pressed_mpa), work,
                              WrenchNoise<S>{S(0.005), S(0.1), S(1e-5)});
    REQUIRE(found.status == WrenchStatus::ok);
    // the goal is 1e-3; shapes are known in double
    const double allowed = std::is_same_v<S, float> ? 1e-3 : 1e-9;
    CHECK(distance(as<double>(found.force_n), truth.force_n) <= allowed * size(truth.force_n));
    CHECK(distance(as<double>(found.moment_n_mm), truth.moment_n_mm) <=
          allowed * size(truth.moment_n_mm));
    for (std::size_t k = 0; k < 6; ++k) {
      CHECK(static_cast<double>(found.covariance[k][k]) ==
            Approx(truth.covariance[k][k]).epsilon(10 * allowed).margin(1e-12));
    }
  };
  run(BalancedRim());
  run(test::KnownModulus());
  run(published::ClosedForm());
  run(published::Iteration());
  run(LeastSquares());
}

TEST_CASE("wrench: bad parameters are refused by name, value and range", "[wrench]") {
  const RimOfDots rim;
  const auto with = [&](auto change) {
    WrenchOptions<double> options;
    change(options);
    return test::refusal([&] { Wrench<BalancedRim>(rim.borders(), options); });
  };
  const auto says = [](const std::string& text, const std::string& begin) {
    INFO(text);
    CHECK(test::begins_with(text, begin));
    CHECK(text.find("must be") != std::string::npos);
  };
  CHECK(with([](auto&) {}) == "accepted");
  says(with([](auto& o) { o.base_radius_mm = -1; }), "WrenchOptions: base_radius_mm = -1");
  says(with([](auto& o) { o.base_radius_mm = test::nan; }), "WrenchOptions: base_radius_mm = ");
  says(with([](auto& o) { o.side_dot_length_mm = 0; }), "WrenchOptions: side_dot_length_mm = 0");
  says(with([](auto& o) { o.reach_mm = 0; }), "WrenchOptions: reach_mm = 0");
  says(with([](auto& o) { o.columns = 7; }), "WrenchOptions: columns = 7");
  says(with([](auto& o) { o.columns = 721; }), "WrenchOptions: columns = 721");
  says(with([](auto& o) { o.rows = 1; }), "WrenchOptions: rows = 1");
  says(with([](auto& o) { o.rows = 1001; }), "WrenchOptions: rows = 1001");
  says(with([](auto& o) { o.line_step_mm = 2; }), "WrenchOptions: line_step_mm = 2");
  says(with([](auto& o) { o.line_step_mm = 0; }), "WrenchOptions: line_step_mm = 0");
  says(with([](auto& o) { o.line_step_mm = -0.4; }), "WrenchOptions: line_step_mm = -0.4");
  says(with([](auto& o) { o.blur_mm = -1; }), "WrenchOptions: blur_mm = -1");
  says(with([](auto& o) { o.blur_mm = HUGE_VAL; }), "WrenchOptions: blur_mm = inf");

  const auto borders = [](auto change) {
    RimOfDots ring;
    auto points = ring.borders();
    change(points);
    return test::refusal([&] { Wrench<BalancedRim>{points}; });
  };
  CHECK(borders([](auto&) {}) == "accepted");
  says(borders([](auto& b) { b(0, 3).x = test::nan; }), "Wrench: border point = 3");
  says(borders([](auto& b) { b(0, 3).x *= 2; }), "Wrench: distance of a border point");
  says(borders([](auto& b) { b(0, 3) = b(0, 4); }), "Wrench: angle between border points = 0");
  says(borders([](auto& b) {
         b = test::Image<Vector>(1, 5, {1, 1, 1});
       }),
       "Wrench: border columns = 5");
  says(borders([](auto& b) { b = test::Image<Vector>(2, 72, {1, 1, 1}); }), "Wrench: border");
  const auto lengths = [&](double length) {
    return test::refusal([&] {
      Wrench<BalancedRim>(rim.borders(), [&](Index k) { return k == 7 ? length : 0.8; });
    });
  };
  says(lengths(0), "Wrench: side_dot_length_mm = 0");
  says(lengths(test::nan), "Wrench: side_dot_length_mm = ");

  says(with([](auto& o) { o.calibrated_modulus_n_per_mm = -0.5; }),
       "WrenchOptions: calibrated_modulus_n_per_mm = -0.5");
  says(with([](auto& o) { o.falls_back_on_modulus = true; }),
       "WrenchOptions: falls_back_on_modulus = 1");
  says(test::refusal([&] { Wrench<published::Iteration>(rim.borders(), {}, {.passes = 0}); }),
       "published::Iteration: passes = 0");
  says(test::refusal([&] { Wrench<BalancedRim>(rim.borders(), {}, {}, {}, {.min_stretch = 1}); }),
       "ClampedRim: min_stretch = 1");
  says(test::refusal(
           [&] { Wrench<BalancedRim>(rim.borders(), {}, {}, {}, {.mooney_share = -0.1}); }),
       "ClampedRim: mooney_share = -0.1");
  says(test::refusal(
           [&] { Wrench<BalancedRim>(rim.borders(), {}, {}, OneRow{not_a_number<double>()}); }),
       "OneRow: stress_free_inclination_rad = ");
  says(test::refusal([&] { Wrench<LeastSquares>(rim.borders(), {}, {.smoothness = 0}); }),
       "LeastSquares: smoothness = 0");
  says(test::refusal([&] { Wrench<LeastSquares>(rim.borders(), {}, {.rim_weight = test::nan}); }),
       "LeastSquares: rim_weight = ");
  says(test::refusal([] { PadHeights<>::Map(19.0, 0.0); }), "HeightMap: spacing_mm = 0");
  says(test::refusal([] { PadHeights<>::Map(0.1, 0.5); }), "HeightMap: half_width_mm = 0.1");
}

TEST_CASE("rim: what border points and side dots it takes for its own", "[wrench]") {
  const auto ring = [](double distance_mm) {
    test::Image<Vector> points(1, 12);
    for (Index k = 0; k < 12; ++k) {
      const double at = 2 * pi * static_cast<double>(k) / 12;
      points(0, k) = {20 * std::cos(at), 20 * std::sin(at), 0};
    }
    points(0, 0) = {distance_mm, 0, 0};
    return detail::membrane::Rim<double>(
        points, [](Index) { return 0.8; }, 20.0, 12);
  };
  // 5 % are too much on both sides
  const auto refused = [&](double distance_mm) {
    return test::refusal([&] { (void)ring(distance_mm); });
  };
  CHECK(refused(19.01) == "accepted");
  CHECK(refused(20.99) == "accepted");
  CHECK(refused(19) != "accepted");
  CHECK(refused(21) != "accepted");

  // at most a third of the dots misplaced
  const auto rim = ring(20);
  auto pulls = rim.pulls();
  pulls.misplaced = 4;
  CHECK(rim.in_order(pulls));
  pulls.misplaced = 5;
  CHECK_FALSE(rim.in_order(pulls));
}

TEST_CASE("wrench: frames of another size are not looked at", "[wrench]") {
  const RoundPad<FilmSide> pad;
  const RimOfDots rim = rim_of(pad);
  const TrueLoad load(pad, 0, 0);
  const Wrench<BalancedRim> wrench(rim.borders(), test::exact_options(36, 30));
  const Wrench<BalancedRim> other(rim.borders(), test::exact_options(36, 31));
  auto workspace = wrench.workspace();
  auto foreign = other.workspace();
  CHECK(wrench(pad, rim.dots(load, 2), pressed_mpa, workspace).status == WrenchStatus::refused);
  CHECK(wrench(pad, test::Image<Vector>(1, 71, {0, 0, 0}), pressed_mpa, workspace).status ==
        WrenchStatus::refused);
  CHECK(wrench(pad, rim.dots(load), pressed_mpa, foreign).status == WrenchStatus::refused);
  const auto r = wrench(pad, rim.dots(load, 2), pressed_mpa, workspace);
  CHECK(r.force_n.z != r.force_n.z);
  CHECK(wrench(pad, rim.dots(load), pressed_mpa, workspace).status != WrenchStatus::refused);
}

TEST_CASE("wrench: names of what can happen", "[wrench]") {
  CHECK(std::string(name_of(WrenchStatus::ok)) == "ok");
  CHECK(std::string(name_of(WrenchStatus::no_contact)) == "no contact");
  CHECK(std::string(name_of(WrenchStatus::bad_pressure)) == "bad pressure");
  CHECK(std::string(name_of(WrenchStatus::too_few_side_dots)) == "too few side dots");
  CHECK(std::string(name_of(WrenchStatus::unstretched)) == "unstretched");
  CHECK(std::string(name_of(WrenchStatus::no_shape)) == "no shape");
  CHECK(std::string(name_of(WrenchStatus::no_level_line)) == "no level line");
  CHECK(std::string(name_of(WrenchStatus::not_solved)) == "not solved");
}
