// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What it costs that six axes and traction suppose a neo-Hookean rubber, as the finite-element
// membranes are made of. The places of their dots are kept and taken for those of an Ogden rubber
// of one term,
//   W = 2 mu t / alpha^2 (l1^alpha + l2^alpha + (l1 l2)^-alpha - 3)
// with the stretches l1 and l2; alpha = 2 is neo-Hookean, 1.3 the exponent of the main term of
// Ogden's natural rubber (1972), and 4 and 8 are of rubber that stiffens earlier. Its modulus is
// the one that balances the pressure of the free pad, or of the free part, as the methods learn
// theirs. That is a perturbation: the shape is not in equilibrium under the other law.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "rim.hpp"
#include "support/traction_scenes.hpp"
#include "support/wrench_frames.hpp"
#include "table.hpp"

namespace bench::papers {

using Vector = fingerpad::Point3<double>;

/// W / (mu t) from I = l1^2 + l2^2 and J^2 = l1^2 l2^2.
inline double ogden(double sum_sq, double area_sq, double alpha) {
  const double root = std::sqrt((std::max)(sum_sq * sum_sq - 4 * area_sq, 0.0));
  const double big = (sum_sq + root) / 2, small = area_sq / big;
  return 2 / (alpha * alpha) *
         (std::pow(big, alpha / 2) + std::pow(small, alpha / 2) + std::pow(area_sq, -alpha / 2) -
          3);
}

/// Gradient of f(x) by central differences.
template <class F>
Vector gradient(const Vector& x, const F& f) {
  const double h = 1e-5;
  const auto along = [&](const Vector& e) { return (f(x + h * e) - f(x - h * e)) / (2 * h); };
  return {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
}

/// Force along the base, F_z and M_z.
struct Parts {
  Vector force = {0, 0, 0};
  double moment_z = 0;
};

/// Pull of the whole rim for mu t = 1 N/mm, from the side dots.
inline Parts rim_pull(const test::WrenchFrame& frame, double alpha) {
  constexpr double arc_mm = 0.79995;
  const auto rim = test::rim_border();
  const double share_mm = 2 * std::numbers::pi * test::base_radius_mm / test::side_dots;
  Parts sum;
  for (fingerpad::Index k = 0; k < test::side_dots; ++k) {
    const Vector x = rim(0, k), around = Vector{-x.y, x.x, 0} / norm(x);
    const Vector along = (frame.dots(0, k) - x) / arc_mm;
    const Vector pull = share_mm * gradient(along, [&](const Vector& a) {
                          return ogden(squared_norm(a) + 1, squared_norm(cross(a, around)), alpha);
                        });
    sum.force += pull;
    sum.moment_z += cross(x, pull).z;
  }
  return sum;
}

/// Share of the truth that a method finds: slope of the results over the truth.
struct Shares {
  double found = 0, true_sq = 0;
  void add(double result, double truth) {
    found += result * truth;
    true_sq += truth * truth;
  }
  std::string error() const { return percent(found / true_sq - 1); }
};

struct RubberErrors {
  Shares along, normal, moment, friction;
};

/// Six axes; `scene` is one of wrench_frames().
inline RubberErrors rim_errors(const std::string& scene, double alpha) {
  constexpr double modulus = 0.5, free_pressure_mpa = 0.016;  // tests/data/README.md
  double free_stretch = 0;
  for (const RimStretch& r : rim_stretches()) {
    free_stretch = r.pressure_mpa == free_pressure_mpa ? r.stretch : free_stretch;
  }
  const auto tension = [&](double exponent) {
    return gradient({free_stretch, 0, 0},
                    [&](const Vector& a) { return ogden(a.x * a.x + 1, a.x * a.x, exponent); })
        .x;
  };
  const double other_modulus = modulus * tension(2) / tension(alpha);
  RubberErrors e;
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    if (f.scene != scene) {
      continue;
    }
    const Parts ours = rim_pull(f, 2), other = rim_pull(f, alpha);
    const Vector truth = f.force_n + other_modulus * other.force - modulus * ours.force;
    const double moment =
        f.moment_n_mm.z + other_modulus * other.moment_z - modulus * ours.moment_z;
    e.along.add(f.force_n.x, truth.x);
    e.along.add(f.force_n.y, truth.y);
    e.normal.add(f.force_n.z, truth.z);
    e.moment.add(f.moment_n_mm.z, moment);
    e.friction.add(std::hypot(f.force_n.x, f.force_n.y) / f.force_n.z,
                   std::hypot(truth.x, truth.y) / truth.z);
  }
  return e;
}

/// Force and moment of the loads on the dots in contact and one ring around it, with the modulus
/// that balances the pressure of the dots further out.
inline Parts loads_of_dots(const test::TractionScene& s, double alpha) {
  const test::Dots rest = test::stress_free_dots();
  const auto rows = rest.rows(), cols = rest.cols();
  std::vector<Vector> pulls(rest.cells.size(), {0, 0, 0}), areas = pulls;
  std::vector<int> cells(rest.cells.size(), 0);
  const auto at = [&](fingerpad::Index i, fingerpad::Index j) {
    return static_cast<std::size_t>(i * cols + j);
  };
  for (fingerpad::Index i = 0; i + 1 < rows; ++i) {
    for (fingerpad::Index j = 0; j + 1 < cols; ++j) {
      const std::array<std::size_t, 4> cell = {at(i, j), at(i, j + 1), at(i + 1, j + 1),
                                               at(i + 1, j)};
      bool known = true;
      for (const std::size_t k : cell) {
        known = known && is_finite(rest.cells[k]) && is_finite(s.dots.cells[k]);
      }
      for (std::size_t c = 0; c < 4 && known; ++c) {
        ++cells[cell[c]];
        const std::array<std::size_t, 3> corner = {cell[(c + 3) % 4], cell[c], cell[(c + 1) % 4]};
        const auto triangle = [&](const auto& dots) {
          return std::array{dots[corner[0]], dots[corner[1]], dots[corner[2]]};
        };
        const auto r = triangle(rest.cells);
        auto x = triangle(s.dots.cells);
        const Vector rest_area = cross(r[1] - r[0], r[2] - r[1]);
        const double rest_mm2 = norm(rest_area) / 2;
        const auto energy = [&] {
          double sum_sq = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const Vector next = r[(k + 2) % 3] - r[(k + 1) % 3], last = r[k] - r[(k + 2) % 3];
            sum_sq -=
                dot(next, last) / squared_norm(rest_area) * squared_norm(x[(k + 1) % 3] - x[k]);
          }
          const Vector area = cross(x[1] - x[0], x[2] - x[1]);
          return rest_mm2 * ogden(sum_sq, squared_norm(area) / squared_norm(rest_area), alpha);
        };
        const Vector area = cross(x[1] - x[0], x[2] - x[1]) / (rest_area.z < 0 ? -2.0 : 2.0);
        for (std::size_t k = 0; k < 3; ++k) {
          const Vector here = x[k];
          const Vector slope = gradient(here, [&](const Vector& p) {
            x[k] = p;
            return energy();
          });
          x[k] = here;
          pulls[corner[k]] += -0.5 * slope;  // each cell is the mean of both of its diagonals
          areas[corner[k]] += area / 6;
        }
      }
    }
  }
  const auto near = [&](fingerpad::Index i, fingerpad::Index j) {
    for (fingerpad::Index r = i - 1; r <= i + 1; ++r) {
      for (fingerpad::Index c = j - 1; c <= j + 1; ++c) {
        if (r >= 0 && c >= 0 && r < rows && c < cols && s.contact(r, c) != 0) {
          return true;
        }
      }
    }
    return false;
  };
  double free = 0, outward = 0;
  for (fingerpad::Index i = 0; i < rows; ++i) {
    for (fingerpad::Index j = 0; j < cols; ++j) {
      const std::size_t k = at(i, j);
      if (cells[k] == 4 && !near(i, j)) {
        free += 1;
        outward += dot(pulls[k], areas[k]) / squared_norm(areas[k]);
      }
    }
  }
  const double modulus = -s.pressure_mpa * free / outward;
  Parts sum;
  for (fingerpad::Index i = 0; i < rows; ++i) {
    for (fingerpad::Index j = 0; j < cols; ++j) {
      const std::size_t k = at(i, j);
      if (near(i, j) && cells[k] == 4) {
        const Vector load = -modulus * pulls[k] - s.pressure_mpa * areas[k];
        sum.force += load;
        sum.moment_z += cross(s.dots.cells[k], load).z;
      }
    }
  }
  return sum;
}

inline RubberErrors traction_errors(const std::string& scene, double alpha) {
  const test::TractionScene s = test::traction_scene(scene);
  const Parts ours = loads_of_dots(s, 2), other = loads_of_dots(s, alpha);
  RubberErrors e;
  e.along.add(ours.force.x, other.force.x);
  e.along.add(ours.force.y, other.force.y);
  e.normal.add(ours.force.z, other.force.z);
  e.moment.add(ours.moment_z, other.moment_z);
  e.friction.add(std::hypot(ours.force.x, ours.force.y) / ours.force.z,
                 std::hypot(other.force.x, other.force.y) / other.force.z);
  return e;
}

inline void print_other_rubber(std::ostream& out) {
  out << "### Another rubber: the error if it is Ogden's and not neo-Hookean\n\n| Exponent | Six "
         "axes: F_z, pressed | along the plate, dragged | M_z, turned | friction found at the slip "
         "| Traction: F_z, pressed | along the plate, dragged | M_z, turned "
         "|\n|--:|--:|--:|--:|--:|--:|--:|--:|\n";
  for (const double alpha : {1.3, 4.0, 8.0}) {
    const auto cells = [&](const auto& errors) {
      return " | " + errors("press", alpha).normal.error() + " | " +
             errors("drag", alpha).along.error() + " | " + errors("twist", alpha).moment.error();
    };
    out << "| " << number(alpha) << cells(rim_errors) << " | "
        << rim_errors("drag", alpha).friction.error() << cells(traction_errors) << " |\n";
  }
  out << '\n';
}

}  // namespace bench::papers
