// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every pad, every load and every method.
#include "fingerpad/force/wrench.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "fingerpad/published/wrench.hpp"
#include "support/by_modulus.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pressed_pad.hpp"

using namespace fingerpad;
using test::FilmSide;
using test::Image;
using test::RimLoad;
using test::RimOfDots;
using test::RoundPad;

namespace {

constexpr double pi = std::numbers::pi;
using Vector = Point3<double>;

/// Mirrored at the plane y = 0, then rotated about z, and scaled.
struct Placed {
  double turn_rad = 0;
  bool mirrored = false;
  double scale = 1;

  Vector operator()(const Vector& p) const {
    const double c = scale * std::cos(turn_rad), s = scale * std::sin(turn_rad);
    const double y = mirrored ? -p.y : p.y;
    return {c * p.x - s * y, s * p.x + c * y, scale * p.z};
  }
  /// A moment is an axial vector.
  Vector moment(const Vector& m) const {
    const Vector rotated = (*this)(m);
    return mirrored ? Vector{-rotated.x, -rotated.y, -rotated.z} : rotated;
  }
  Vector back(const Vector& p) const {
    const double c = std::cos(turn_rad) / scale, s = std::sin(turn_rad) / scale;
    const double x = c * p.x + s * p.y, y = c * p.y - s * p.x;
    return {x, mirrored ? -y : y, p.z / scale};
  }
};

/// A film pad without symmetry: the radius of its flat contact differs by direction.
struct Lopsided {
  double contact_mm = 8, oval = 0, triangle = 0;
  Placed placed;

  RoundPad<FilmSide> along(double at) const {
    return {{.contact_mm =
                 contact_mm * (1 + oval * std::cos(2 * at) + triangle * std::cos(3 * at + 1))}};
  }
  detail::membrane::HeightAndSlope<double> operator()(double x, double y) const {
    const Vector p = placed.back({x, y, 0});
    const auto h = along(std::atan2(p.y, p.x))(p.x, p.y);
    // the slope around the axis is small and left out, equally in every placement
    const Vector slope = placed({h.along_x, h.along_y, 0});
    return {placed.scale * h.height_mm, slope.x / placed.scale, slope.y / placed.scale};
  }
  bool in_contact(double x, double y) const {
    const Vector p = placed.back({x, y, 0});
    return along(std::atan2(p.y, p.x)).in_contact(p.x, p.y);
  }
};

Lopsided any_shape() {
  return {test::uniform(5, 11), test::uniform(-0.1, 0.1), test::uniform(-0.05, 0.05), {}};
}

/// Any load under which the membrane is stretched everywhere.
struct AnyLoad {
  double normal = test::uniform(0.08, 0.2);
  double first = test::uniform(0, 0.3), second = test::uniform(0, 0.2);
  double first_at = test::uniform(0, 6), second_at = test::uniform(0, 6);
  double shear = test::uniform(-0.1, 0.1), turning = test::uniform(-0.1, 0.1);

  RimLoad operator()(double at) const {
    return {normal * (1 + first * std::cos(at - first_at) + second * std::cos(2 * at - second_at)),
            turning + shear * std::sin(at - first_at)};
  }
};

constexpr Index columns = 24, rows = 8;

WrenchOptions<double> options(double scale = 1) {
  WrenchOptions<double> o;
  o.columns = columns;
  o.rows = rows;
  o.base_radius_mm *= scale;
  o.side_dot_length_mm *= scale;
  o.line_step_mm *= scale;
  o.blur_mm = 0.3 * scale;
  o.reach_mm *= scale;
  return o;
}

Image<Vector> moved(Image<Vector> points, const Placed& placed) {
  for (Vector& p : points.cells) {
    p = placed(p);
  }
  return points;
}

RimOfDots rim_of_48() {
  RimOfDots rim;
  rim.count = 48;
  rim.rise = 2;
  return rim;
}

template <class W>
WrenchResult<double> measure(const Lopsided& shape,
                             const Image<Vector>& border,
                             const Image<Vector>& dots,
                             double pressure_mpa = 0.01,
                             double scale = 1) {
  const W wrench(border, options(scale));
  auto workspace = wrench.workspace();
  return wrench(shape, dots, pressure_mpa, workspace, {0.005 * scale, 0.1 * scale, 1e-5});
}

double far(const Vector& a, const Vector& b) {
  return std::sqrt(squared_norm(a - b));
}
double size(const Vector& a) {
  return std::sqrt(squared_norm(a));
}
/// Scale of the errors: a force of that kind that cannot be 0.
double force_scale(const WrenchResult<double>& r) {
  return size(r.force_n) + 1;
}
double moment_scale(const WrenchResult<double>& r) {
  return size(r.moment_n_mm) + 10;
}

template <class S, class L = ClampedRim, class Lines = StraightLines>
struct Way {
  using W = test::WrenchBy<S, OneRow, L, Lines>;
  static constexpr bool needs_balance = !std::is_same_v<S, test::KnownModulus>;
};

}  // namespace

TEMPLATE_TEST_CASE("wrench: what is rotated, mirrored or scaled",
                   "[wrench][law]",
                   Way<BalancedRim>,
                   Way<published::ClosedForm>,
                   Way<test::KnownModulus>,
                   Way<published::Iteration>,
                   (Way<published::Iteration, published::Direction>),
                   (Way<LeastSquares>)) {
  using W = typename TestType::W;
  rc::prop("force and moment turn with the pad, by whole columns", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const auto still = measure<W>(shape, rim.borders(), dots);
    Lopsided rotated = shape;
    rotated.placed.turn_rad =
        2 * pi * static_cast<double>(test::whole(1, columns - 1)) / static_cast<double>(columns);
    const auto r =
        measure<W>(rotated, moved(rim.borders(), rotated.placed), moved(dots, rotated.placed));
    RC_ASSERT(r.status == still.status);
    if (still.status == WrenchStatus::ok) {
      // except for the mesh that searches the middle of the contact
      const double allowed = TestType::needs_balance ? 0.03 : 1e-9;
      RC_ASSERT(far(r.force_n, rotated.placed(still.force_n)) <= allowed * force_scale(still));
      RC_ASSERT(far(r.moment_n_mm, rotated.placed(still.moment_n_mm)) <=
                allowed * moment_scale(still));
    }
  });
  rc::prop("to the last digits by a right angle, and as a mirror image", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const auto still = measure<W>(shape, rim.borders(), dots);
    Lopsided other = shape;
    other.placed.turn_rad = pi / 2 * static_cast<double>(test::whole(0, 3));
    other.placed.mirrored = test::whole(0, 1) == 1;
    const auto r = measure<W>(other, moved(rim.borders(), other.placed), moved(dots, other.placed));
    RC_ASSERT(r.status == still.status);
    if (still.status == WrenchStatus::ok) {
      const double allowed = 1e-4;  // small steps across the edge of the contact
      RC_ASSERT(far(r.force_n, other.placed(still.force_n)) <= allowed * force_scale(still));
      RC_ASSERT(far(r.moment_n_mm, other.placed.moment(still.moment_n_mm)) <=
                allowed * moment_scale(still));
      RC_ASSERT(std::abs(r.summit_area_mm2 - still.summit_area_mm2) <= 1e-4 * 300 ||
                !TestType::needs_balance);
    }
  });
  rc::prop("force goes with the square of lengths, moment with the cube", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const auto still = measure<W>(shape, rim.borders(), dots);
    Lopsided large = shape;
    large.placed.scale = test::log_uniform(0.1, 10);
    const double k = large.placed.scale;
    const auto r =
        measure<W>(large, moved(rim.borders(), large.placed), moved(dots, large.placed), 0.01, k);
    RC_ASSERT(r.status == still.status);
    if (still.status == WrenchStatus::ok && TestType::needs_balance) {
      RC_ASSERT(far(r.force_n, k * k * still.force_n) <= 1e-4 * k * k * force_scale(still));
      RC_ASSERT(far(r.moment_n_mm, k * k * k * still.moment_n_mm) <=
                1e-4 * k * k * k * moment_scale(still));
    }
  });
  rc::prop("with the same shape all forces go with the pressure", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    auto any_pressure = options();
    any_pressure.max_pressure_mpa = 10;
    const W wrench(rim.borders(), any_pressure);
    auto work = wrench.workspace(), other_work = wrench.workspace();
    const double k = test::log_uniform(0.01, 100);
    const auto one = wrench(shape, dots, 0.01, work);
    const auto other = wrench(shape, dots, 0.01 * k, other_work);
    RC_ASSERT(one.status == other.status);
    if (one.status == WrenchStatus::ok && TestType::needs_balance) {
      RC_ASSERT(far(other.force_n, k * one.force_n) <= 1e-9 * k * force_scale(one));
      RC_ASSERT(far(other.moment_n_mm, k * one.moment_n_mm) <= 1e-9 * k * moment_scale(one));
      for (Index p = 0; p < work.rim_points(); ++p) {
        RC_ASSERT(far(other_work.rim_tension(p), k * work.rim_tension(p)) <=
                  1e-9 * k * size(work.rim_tension(p)));
      }
      const bool both = one.modulus_n_per_mm == one.modulus_n_per_mm;
      RC_ASSERT(!both || std::abs(other.modulus_n_per_mm / one.modulus_n_per_mm / k - 1) < 1e-9);
    } else if (one.status == WrenchStatus::ok) {
      // of the material alone: pressure only adds its push on the base
      const double base = pi * square(options().base_radius_mm);
      RC_ASSERT(std::abs(other.force_n.z - one.force_n.z + 0.01 * (k - 1) * base) <
                1e-9 * (1 + k) * force_scale(one));
    }
  });
}

TEMPLATE_TEST_CASE("wrench: side dots as they come",
                   "[wrench][law]",
                   Way<BalancedRim>,
                   Way<published::ClosedForm>,
                   Way<test::KnownModulus>,
                   Way<published::Iteration>,
                   (Way<LeastSquares>)) {
  using W = typename TestType::W;
  rc::prop("in any order", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto border = rim.borders();
    const auto dots = rim.dots(AnyLoad());
    auto mixed_border = border, mixed_dots = dots;
    for (Index k = rim.count; k-- > 1;) {
      const Index other = test::whole(0, k);
      std::swap(mixed_border(0, k), mixed_border(0, other));
      std::swap(mixed_dots(0, k), mixed_dots(0, other));
    }
    const auto a = measure<W>(shape, border, dots);
    const auto b = measure<W>(shape, mixed_border, mixed_dots);
    RC_ASSERT(a.status == b.status);
    RC_ASSERT(a.status != WrenchStatus::ok ||
              (a.force_n.x == b.force_n.x && a.force_n.z == b.force_n.z &&
               a.moment_n_mm.z == b.moment_n_mm.z && a.covariance[3][3] == b.covariance[3][3]));
  });
  rc::prop("up to a third may be missing, more are refused", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const AnyLoad load;
    const auto dots = rim.dots(load);
    const auto all = measure<W>(shape, rim.borders(), dots);
    auto some = dots;
    std::vector<Index> order;
    for (Index k = 0; k < rim.count; ++k) {
      order.push_back(k);
    }
    for (std::size_t k = order.size(); k-- > 1;) {
      std::swap(order[k], order[static_cast<std::size_t>(test::whole(0, static_cast<Index>(k)))]);
    }
    const Index lost = test::whole(0, rim.count);
    for (Index k = 0; k < lost; ++k) {
      some(0, order[static_cast<std::size_t>(k)]).y = test::nan;
    }
    const auto r = measure<W>(shape, rim.borders(), some);
    if (3 * lost > rim.count) {
      RC_ASSERT(r.status == (all.status == WrenchStatus::no_level_line
                                 ? all.status
                                 : WrenchStatus::too_few_side_dots));
      RC_ASSERT(r.force_n.x != r.force_n.x);
    } else {
      RC_ASSERT(r.status == all.status);
      RC_ASSERT(r.missing == lost);
      // between dots the pull is linear: the error grows with the square of the widest gap
      double gap = 1, run = 1;
      for (Index k = 0; k < 2 * rim.count; ++k) {
        run = std::isnan(some(0, k % rim.count).y) ? run + 1 : 1;
        gap = (std::max)(gap, run);
      }
      const double off = lost > 0 ? square(gap) : 0;
      RC_ASSERT(r.status != WrenchStatus::ok ||
                (far(r.force_n, all.force_n) <= 0.0015 * off * force_scale(all) &&
                 far(r.moment_n_mm, all.moment_n_mm) <= 0.003 * off * moment_scale(all)));
    }
  });
  rc::prop("errors grow with the noise that is told", [] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const W wrench(rim.borders(), options());
    auto work = wrench.workspace();
    const double k = test::log_uniform(0.1, 10);
    const auto one = wrench(shape, dots, 0.01, work, {0.002, 0.1, 1e-5});
    const auto other = wrench(shape, dots, 0.01, work, {0.002 * k, 0.1 * k, 1e-5 * k});
    for (std::size_t i = 0; i < 6; ++i) {
      RC_ASSERT(one.covariance[i][i] >= 0);
      for (std::size_t j = 0; j < 6; ++j) {
        RC_ASSERT(std::abs(other.covariance[i][j] - k * k * one.covariance[i][j]) <=
                  1e-9 * k * k * (one.covariance[i][i] + one.covariance[j][j]));
        RC_ASSERT(square(one.covariance[i][j]) <=
                  one.covariance[i][i] * one.covariance[j][j] * (1 + 1e-9) + 1e-300);
      }
    }
  });
}
