// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every pad and every load, by the shape and by the modulus alone.
#include "fingerpad/force/wrench.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

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
  MembranePoint<double> operator()(double x, double y) const {
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

WrenchOptions<double> options(double scale = 1) {
  WrenchOptions<double> o;
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

/// By the shape and the pressure, or by the modulus and the pressure.
enum class By { shape, modulus };

Wrench<> wrench_by(By by, const Image<Vector>& border, WrenchOptions<double> options) {
  if (by == By::modulus) {
    options.modulus_n_per_mm = 0.5;
  }
  return Wrench<>(border, options);
}
WrenchResult<double> seen(By by,
                          Wrench<>& wrench,
                          const Lopsided& shape,
                          const Image<Vector>& dots,
                          double pressure_mpa) {
  return by == By::shape ? wrench(shape, dots, pressure_mpa)
                         : wrench.by_modulus(dots, pressure_mpa);
}
WrenchResult<double> measure(By by,
                             const Lopsided& shape,
                             const Image<Vector>& border,
                             const Image<Vector>& dots,
                             double scale = 1) {
  Wrench<> wrench = wrench_by(by, border, options(scale));
  return seen(by, wrench, shape, dots, 0.01);
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

}  // namespace

TEST_CASE("wrench: what is rotated, mirrored or scaled", "[wrench][law]") {
  const By by = GENERATE(By::shape, By::modulus);
  const bool by_shape = by == By::shape;
  rc::prop("force and moment turn with the pad, by whole side dots", [=] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const auto still = measure(by, shape, rim.borders(), dots);
    Lopsided rotated = shape;
    rotated.placed.turn_rad = 2 * pi * static_cast<double>(test::whole(1, 47)) / 48;
    const auto r =
        measure(by, rotated, moved(rim.borders(), rotated.placed), moved(dots, rotated.placed));
    RC_ASSERT(r.status == still.status);
    if (still.status == WrenchStatus::ok) {
      // except for the mesh that searches the middle of the contact
      const double allowed = by_shape ? 0.03 : 1e-9;
      RC_ASSERT(far(r.force_n, rotated.placed(still.force_n)) <= allowed * force_scale(still));
      RC_ASSERT(far(r.moment_n_mm, rotated.placed(still.moment_n_mm)) <=
                allowed * moment_scale(still));
    }
  });
  rc::prop("to the last digits by a right angle, and as a mirror image", [=] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const auto still = measure(by, shape, rim.borders(), dots);
    Lopsided other = shape;
    other.placed.turn_rad = pi / 2 * static_cast<double>(test::whole(0, 3));
    other.placed.mirrored = test::whole(0, 1) == 1;
    const auto r =
        measure(by, other, moved(rim.borders(), other.placed), moved(dots, other.placed));
    RC_ASSERT(r.status == still.status);
    if (still.status == WrenchStatus::ok) {
      const double allowed = 1e-4;  // small steps across the edge of the contact
      RC_ASSERT(far(r.force_n, other.placed(still.force_n)) <= allowed * force_scale(still));
      RC_ASSERT(far(r.moment_n_mm, other.placed.moment(still.moment_n_mm)) <=
                allowed * moment_scale(still));
      RC_ASSERT(std::abs(r.summit_area_mm2 - still.summit_area_mm2) <= 1e-4 * 300 || !by_shape);
    }
  });
  rc::prop("force goes with the square of lengths, moment with the cube", [=] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    const auto still = measure(by, shape, rim.borders(), dots);
    Lopsided large = shape;
    large.placed.scale = test::log_uniform(0.1, 10);
    const double k = large.placed.scale;
    const auto r =
        measure(by, large, moved(rim.borders(), large.placed), moved(dots, large.placed), k);
    RC_ASSERT(r.status == still.status);
    if (still.status == WrenchStatus::ok && by_shape) {
      RC_ASSERT(far(r.force_n, k * k * still.force_n) <= 1e-4 * k * k * force_scale(still));
      RC_ASSERT(far(r.moment_n_mm, k * k * k * still.moment_n_mm) <=
                1e-4 * k * k * k * moment_scale(still));
    }
  });
  rc::prop("with the same shape all forces go with the pressure", [=] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const auto dots = rim.dots(AnyLoad());
    auto any_pressure = options();
    any_pressure.max_pressure_mpa = 10;
    Wrench<> wrench = wrench_by(by, rim.borders(), any_pressure), more = wrench;
    const double k = test::log_uniform(0.01, 100);
    const auto one = seen(by, wrench, shape, dots, 0.01);
    const auto other = seen(by, more, shape, dots, 0.01 * k);
    RC_ASSERT(one.status == other.status);
    if (one.status == WrenchStatus::ok && by_shape) {
      RC_ASSERT(far(other.force_n, k * one.force_n) <= 1e-9 * k * force_scale(one));
      RC_ASSERT(far(other.moment_n_mm, k * one.moment_n_mm) <= 1e-9 * k * moment_scale(one));
      for (Index p = 0; p < wrench.side_dots(); ++p) {
        RC_ASSERT(far(more.rim_tension(p), k * wrench.rim_tension(p)) <=
                  1e-9 * k * size(wrench.rim_tension(p)));
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

TEST_CASE("wrench: side dots as they come", "[wrench][law]") {
  const By by = GENERATE(By::shape, By::modulus);
  rc::prop("in any order", [=] {
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
    const auto a = measure(by, shape, border, dots);
    const auto b = measure(by, shape, mixed_border, mixed_dots);
    RC_ASSERT(a.status == b.status);
    RC_ASSERT(a.status != WrenchStatus::ok ||
              (a.force_n.x == b.force_n.x && a.force_n.z == b.force_n.z &&
               a.moment_n_mm.z == b.moment_n_mm.z));
  });
  rc::prop("up to a third may be missing, more are refused", [=] {
    const Lopsided shape = any_shape();
    const RimOfDots rim = rim_of_48();
    const AnyLoad load;
    const auto dots = rim.dots(load);
    const auto all = measure(by, shape, rim.borders(), dots);
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
    const auto r = measure(by, shape, rim.borders(), some);
    if (3 * lost > rim.count) {
      RC_ASSERT(
          r.status ==
          (all.status == WrenchStatus::no_level_line ? all.status : WrenchStatus::bad_side_dots));
      RC_ASSERT(r.force_n.x != r.force_n.x);
    } else {
      RC_ASSERT(r.status == all.status);
      RC_ASSERT(r.faults.missing == lost);
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
}
