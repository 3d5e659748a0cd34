// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tensions of the membrane by least squares: they satisfy all equations of equilibrium, (6) and
// (7), as well as possible together, and fit what is known of the membrane's pull at the rim.
// Source of the equations: Ito, Kim, Obinata 2011, III.D; solved there by symmetry, row by row.
//
// There are two equations fewer per line than unknowns, and marching upward from the rim alone
// multiplies the error of the k-th harmonic by about 3^k. So all equations are solved at once, with
// a little smoothness for what they leave open. The unknowns are the tensions divided by the
// pressure, in mm. Weights, all without dimension:
//   1                 (6) of a segment, divided by the root of its area; (7), divided by its area
//   smoothness        differences of the tensions on opposite borders of a segment
//   rim_weight        the part of the pull at the rim that is perpendicular to the known direction
//   magnitude_weight  pull at the rim minus the known one times a common factor, also unknown
// Smoothness couples only borders of one segment, as the equations do. This keeps the solution
// fast.
//
// A membrane pulls in its own plane. So where the pull at the rim is known, the plane of the
// membrane is known there, too, and more accurately than from a smoothed shape that ends at the
// rim. Therefore the lowest borders take the inclination of the pull.
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/compartments.hpp"
#include "fingerpad/force/detail/segments.hpp"
#include "fingerpad/force/detail/sparse_cholesky.hpp"
#include "fingerpad/force/detail/tensions.hpp"
#include "fingerpad/force/rim_balance.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::membrane {

// The equilibrium of one segment as rows of a least-squares problem. Source: Ito, Kim, Obinata
// 2011, III.D, eqs. 6 and 7.

/// The equations of one segment as rows, for tensions divided by the pressure.
template <class R>
class SegmentRows {
 public:
  /// `low` is the lower border.
  template <scalar S>
  SegmentRows(const Segments<S>& segments,
              const Compartments<S>& nodes,
              const Border<S>& low,
              Index i,
              Index j) {
    using std::sqrt;
    const Index next = segments.next(i);
    const Point3<R> a = as<R>(nodes.node(i, j));
    const Point3<R> b = as<R>(nodes.node(next, j));
    const Point3<R> c = as<R>(nodes.node(next, j + 1));
    const Point3<R> d = as<R>(nodes.node(i, j + 1));
    const R quarter = R(1) / R(4);
    const Point3<R> upward = quarter * (c + d - (a + b));
    const Point3<R> onward = quarter * (b + c - (a + d));
    const Point3<R> area = as<R>(segments.area(i, j));
    const R size = sqrt(squared_norm(area));
    has_area_ = value(size) > 0;
    if (!has_area_) {
      return;
    }
    root_ = sqrt(size);
    out_ = R(R(1) / size) * area;
    set(0, low, R(-1), R(-1) * upward);
    set(1, segments.around(i, j + 1), R(1), upward);
    set(2, segments.upward(i, j), R(-1), R(-1) * onward);
    set(3, segments.upward(next, j), R(1), onward);
  }

  /// Adds (6) and (7) to the normal equations.
  void add_to(SegmentEquations<R>& equations) const {
    if (!has_area_) {
      return;
    }
    for (std::size_t r = 0; r < 8; ++r) {
      for (std::size_t c = 0; c <= r; ++c) {
        equations.entries[r][c] =
            equations.entries[r][c] + dot(force_[r], force_[c]) + torque_[r] * torque_[c];
      }
      R& right = equations.entries[SegmentEquations<R>::right_row][r];
      right = right - root_ * dot(force_[r], out_);
    }
  }

 private:
  template <class To, scalar S>
  static Point3<To> as(const Point3<S>& p) {
    return {To(p.x), To(p.y), To(p.z)};
  }

  template <scalar S>
  void set(std::size_t border, const Border<S>& of, const R& sign, const Point3<R>& arm) {
    const R over_root = sign / root_;
    force_[2 * border] = over_root * as<R>(of.normal);
    force_[2 * border + 1] = over_root * as<R>(of.along);
    const Point3<R> turning = R(R(1) / root_) * cross(out_, arm);  // out . (arm x f)
    torque_[2 * border] = dot(turning, force_[2 * border]);
    torque_[2 * border + 1] = dot(turning, force_[2 * border + 1]);
  }

  bool has_area_ = false;
  R root_ = R(0);  // square root of the area, mm
  Point3<R> out_{R(0), R(0), R(0)};
  std::array<Point3<R>, 8> force_;
  std::array<R, 8> torque_;
};

}  // namespace detail::membrane

/// Solves all equations of equilibrium of all segments at once. The defaults were chosen on a flat
/// press whose tensions are known in closed form, with noise on its nodes. With a smoothness of
/// 1e-3 the vertical force has an error of 1e-7 and scatters least. With a magnitude weight above
/// 0.03, known magnitudes that are 3 % off spoil it.
struct LeastSquares {
  static constexpr auto magnitude = detail::membrane::Magnitude::of_all;
  static constexpr bool finds_tensions = true;

  double smoothness = 1e-3;        ///< in [1e-6, 1]
  double rim_weight = 10;          ///< in [1e-3, 1e3]
  double magnitude_weight = 0.03;  ///< in [1e-6, 1e3]

  /// The type of the computation. Normal equations of floats use double, because in float they
  /// would lose all digits.
  template <scalar S>
  using Real = std::conditional_t<std::is_same_v<S, float>, double, S>;

  /// Memory for a solution, and the order of elimination.
  template <scalar S>
  class Work {
   public:
    Work(const LeastSquares&, Index columns, Index rows)
        : cholesky(columns, rows), pulls(static_cast<std::size_t>(columns)), rim(pulls.size()) {}

   private:
    friend struct LeastSquares;
    /// Known pull at a rim segment, as components normal to its border and along it; 0 if unknown.
    struct Pull {
      Real<S> normal;
      Real<S> along;
    };
    detail::membrane::FrontalCholesky<Real<S>> cholesky;
    std::vector<Pull> pulls;
    std::vector<detail::membrane::Border<S>> rim;  // the lowest borders, inclined like the pull
  };

  /// Fills `tensions`; false if there is no solution. `pull[i]` is the known pull of the membrane
  /// at rim segment i, toward the membrane. Its direction is used, and with `Magnitudes` also its
  /// magnitude, up to one factor for all. A pull that is 0 or not finite counts as unknown.
  template <bool Magnitudes, scalar S>
  bool solve(const detail::membrane::Segments<S>& segments,
             const detail::membrane::Compartments<S>& nodes,
             const std::vector<Point3<S>>& pull,
             const S& pressure_mpa,
             Work<S>& work,
             detail::membrane::Tensions<S>& tensions) const {
    using R = Real<S>;
    if (!(value(pressure_mpa) > 0) || !is_finite(pressure_mpa)) {
      return false;
    }
    const R sizes = take_pulls<Magnitudes>(segments, pull, work);
    const bool definite = work.cholesky.factorise(
        [&](std::size_t i, std::size_t j, detail::membrane::SegmentEquations<R>& equations) {
          const auto column = static_cast<Index>(i);
          const auto row = static_cast<Index>(j);
          add_smoothness(equations);
          detail::membrane::SegmentRows<R>(
              segments, nodes, j == 0 ? work.rim[i] : segments.around(column, row), column, row)
              .add_to(equations);
          if (j == 0) {
            add_rim<Magnitudes, S>(work.pulls[i], equations);
          }
        });
    if (!definite) {
      return false;
    }
    R factor = R(0);
    if (Magnitudes && value(sizes) > 0) {
      const R left = sizes - work.cholesky.shared_shared();
      factor = -work.cholesky.shared_right() / left;
    }
    work.cholesky.solve(factor);
    return spread(R(pressure_mpa), work, tensions);
  }

 private:
  /// The border with the inclination of `pull`; unchanged if the pull does not determine one, or
  /// points outward.
  template <scalar S>
  static detail::membrane::Border<S> leaning(const detail::membrane::Border<S>& border,
                                             const Point3<S>& pull) {
    using std::sqrt;
    const S length_squared = squared_norm(border.along);
    const S along = dot(pull, border.along) / length_squared;
    const Point3<S> normal = pull + S(-along) * border.along;
    const S stretch = sqrt(S(length_squared / squared_norm(normal)));
    const bool known = is_finite(stretch) && value(S(dot(normal, border.normal))) > 0;
    return {border.along, known ? (stretch * normal) : border.normal};
  }

  /// Stores the known pulls and the inclined borders. Returns the sum of squares of the common
  /// factor's coefficients, 0 without `Magnitudes`.
  template <bool Magnitudes, scalar S>
  Real<S> take_pulls(const detail::membrane::Segments<S>& segments,
                     const std::vector<Point3<S>>& pull,
                     Work<S>& work) const {
    using R = Real<S>;
    using std::sqrt;
    R sum_sq = R(0);
    for (std::size_t i = 0; i < work.pulls.size(); ++i) {
      const detail::membrane::Border<S>& border = segments.around(static_cast<Index>(i), 0);
      work.rim[i] = leaning(border, pull[i]);
      const S length_squared = squared_norm(border.along);
      const S normal = dot(pull[i], work.rim[i].normal) / length_squared;
      const S along = dot(pull[i], border.along) / length_squared;
      const bool known = is_finite(normal) && is_finite(along);
      work.pulls[i].normal = known ? R(normal) : R(0);
      work.pulls[i].along = known ? R(along) : R(0);
      sum_sq = sum_sq + square(work.pulls[i].normal) + square(work.pulls[i].along);
    }
    if (!Magnitudes || !(value(sum_sq) > 0)) {
      return R(0);
    }
    // mean square 1: the factor is then the mean pull
    const R mean = sqrt(R(sum_sq / R(static_cast<double>(work.pulls.size()))));
    for (auto& p : work.pulls) {
      p.normal = p.normal / mean;
      p.along = p.along / mean;
    }
    return R(sum_sq / square(mean)) * square(R(magnitude_weight));
  }

  template <class R>
  void add_smoothness(detail::membrane::SegmentEquations<R>& equations) const {
    const R weight = square(R(smoothness));
    for (auto& row : equations.entries) {
      row.fill(R(0));
    }
    for (const std::size_t k : {0u, 1u, 4u, 5u}) {
      equations.entries[k][k] = weight;
      equations.entries[k + 2][k + 2] = weight;
      equations.entries[k + 2][k] = -weight;
    }
  }

  template <bool Magnitudes, scalar S, class Pull>
  void add_rim(const Pull& pull, detail::membrane::SegmentEquations<Real<S>>& equations) const {
    using R = Real<S>;
    auto& entries = equations.entries;
    const R size_sq = square(pull.normal) + square(pull.along);
    if (!(value(size_sq) > 0)) {
      return;
    }
    const R across = square(R(rim_weight)) / size_sq;
    entries[0][0] = entries[0][0] + across * square(pull.along);
    entries[1][1] = entries[1][1] + across * square(pull.normal);
    entries[1][0] = entries[1][0] - across * pull.along * pull.normal;
    if constexpr (Magnitudes) {
      const R weight = square(R(magnitude_weight));
      const R size = weight / size_sq;
      entries[0][0] = entries[0][0] + size * square(pull.normal);
      entries[1][1] = entries[1][1] + size * square(pull.along);
      entries[1][0] = entries[1][0] + size * pull.along * pull.normal;
      entries[detail::membrane::SegmentEquations<R>::shared_row][0] = -weight * pull.normal;
      entries[detail::membrane::SegmentEquations<R>::shared_row][1] = -weight * pull.along;
    }
  }

  template <scalar S>
  static bool spread(const Real<S>& pressure,
                     const Work<S>& work,
                     detail::membrane::Tensions<S>& tensions) {
    const auto& found = work.cholesky.unknowns();
    const std::size_t around = tensions.around_normal.size();
    bool finite = true;
    for (std::size_t k = 0; k < around; ++k) {
      tensions.around_normal[k] = S(pressure * found[2 * k]);
      tensions.around_shear[k] = S(pressure * found[2 * k + 1]);
      finite =
          finite && is_finite(tensions.around_normal[k]) && is_finite(tensions.around_shear[k]);
    }
    for (std::size_t k = 0; k < tensions.upward_normal.size(); ++k) {
      tensions.upward_normal[k] = S(pressure * found[2 * (around + k)]);
      tensions.upward_shear[k] = S(pressure * found[2 * (around + k) + 1]);
      finite =
          finite && is_finite(tensions.upward_normal[k]) && is_finite(tensions.upward_shear[k]);
    }
    for (std::size_t i = 0; i < work.rim.size(); ++i) {
      tensions.rim[i] = detail::membrane::border_force(work.rim[i], tensions.around_normal[i],
                                                       tensions.around_shear[i]);
    }
    return finite;
  }
};

/// Refuses values out of range (parameter_error).
inline void expects_valid(const LeastSquares& p) {
  expects(p.smoothness >= 1e-6 && p.smoothness <= 1, "LeastSquares", "smoothness", p.smoothness,
          "in [1e-6, 1]");
  expects(p.rim_weight >= 1e-3 && p.rim_weight <= 1e3, "LeastSquares", "rim_weight", p.rim_weight,
          "in [1e-3, 1e3]");
  expects(p.magnitude_weight >= 1e-6 && p.magnitude_weight <= 1e3, "LeastSquares",
          "magnitude_weight", p.magnitude_weight, "in [1e-6, 1e3]");
}

}  // namespace v0
}  // namespace fingerpad
