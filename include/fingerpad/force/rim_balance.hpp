// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces of the membrane on the rim, from the balance of all columns together. No tension inside
// the membrane needs to be found.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/compartments.hpp"
#include "fingerpad/force/detail/segments.hpp"
#include "fingerpad/force/detail/tensions.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Vertical pull of column i that the pressure on it requires: eq. 12 without the shear between
/// columns.
template <scalar S>
S column_load(const Segments<S>& segments, Index i, const S& pressure_mpa) {
  S sum = S(0);
  for (Index j = segments.rows(); j-- > 0;) {
    sum = sum + segments.area(i, j).z;
  }
  return S(pressure_mpa * sum);
}

/// The force along `pull` with the vertical component `load`; false if the pull does not point
/// upward.
template <scalar S>
bool force_along(const Point3<S>& pull, const S& load, Point3<S>& force) {
  const bool upward = value(pull.z) > 0;
  force = upward ? (S(load / pull.z) * pull) : Point3<S>{S(0), S(0), S(0)};
  return upward;
}

/// Vertical pull at the top of column i, if the tension there equals that at the rim.
template <scalar S>
S lift_at_top(const Segments<S>& segments, Index i, const Point3<S>& pull) {
  using std::sqrt;
  const S per_mm = S(sqrt(S(squared_norm(pull) / squared_norm(segments.around(i, 0).along))));
  return S(per_mm * segments.around(i, segments.rows()).normal.z);
}

/// Force per pull (mu t) at which the rim carries the pressure on the membrane below A_g. Not above
/// 0 if the rim cannot carry it.
template <scalar S>
S balanced_modulus(const Segments<S>& segments,
                   const std::vector<Point3<S>>& pulls,
                   const S& pressure_mpa) {
  S load = S(0);
  S lift = S(0);
  for (Index i = 0; i < segments.columns(); ++i) {
    const Point3<S>& pull = pulls[static_cast<std::size_t>(i)];
    load = load + column_load(segments, i, pressure_mpa);
    // where A_g is not level, the membrane above pulls up or down with about the tension of the rim
    lift = lift + pull.z - lift_at_top(segments, i, pull);
  }
  return value(lift) > 0 ? S(load / lift) : S(0);
}

/// Scales the forces on the rim so that together they carry the pressure on the membrane below A_g.
/// On an uneven mesh the single equations are not satisfied exactly, but their sum is more
/// accurate. False if the forces cannot carry it.
template <scalar S>
bool carry_load(const Segments<S>& segments, const S& pressure_mpa, std::vector<Point3<S>>& rim) {
  const S scale = balanced_modulus(segments, rim, pressure_mpa);
  for (Point3<S>& force : rim) {
    force = scale * force;
  }
  return is_finite(scale) && value(scale) > 0;
}

/// Force and moment about Q of the membrane on the base, from the forces on equal pieces of the rim
/// (eqs. 4 and 5).
template <scalar S>
struct RimSum {
  Point3<S> force_n;
  Point3<S> moment_n_mm;
};

template <scalar S>
RimSum<S> sum_of_rim(const std::vector<Point3<S>>& forces, const S& radius_mm) {
  using std::cos;
  using std::sin;
  const S half = S(std::numbers::pi) / S(static_cast<double>(forces.size()));
  // on a piece of the rim, which is an arc, the mean of its points lies slightly inside the circle;
  // and the vector sum of the forces along the arc, which turn about the axis, is slightly shorter
  // than the sum of their lengths
  const S arm = radius_mm * S(sin(half)) / half;
  const S arm_along = radius_mm * half / S(sin(half));
  RimSum<S> sums = {{S(0), S(0), S(0)}, {S(0), S(0), S(0)}};
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const Point3<S>& f = forces[k];
    const S at = half * S(static_cast<double>(2 * k + 1));
    const S c = cos(at);
    const S s = sin(at);
    const Point3<S>& m = sums.moment_n_mm;
    sums.force_n += f;
    sums.moment_n_mm = {S(m.x + arm * s * f.z), S(m.y - arm * c * f.z),
                        S(m.z + arm_along * (c * f.y - s * f.x))};
  }
  return sums;
}

/// Force per pull (mu t), from the root mean squares of both.
template <scalar S>
S mean_factor(const std::vector<Point3<S>>& forces, const std::vector<Point3<S>>& pulls) {
  using std::sqrt;
  S force_sq = S(0), pull_sq = S(0);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    force_sq = force_sq + squared_norm(forces[k]);
    pull_sq = pull_sq + squared_norm(pulls[k]);
  }
  return S(sqrt(S(force_sq / pull_sq)));
}

/// What determines the magnitude of a pull, and so how its noise propagates.
enum class Magnitude : std::uint8_t {
  of_all,     ///< the balance of all columns together
  of_column,  ///< the balance of its own column
  given,      ///< the calibrated mu t
};

}  // namespace detail::membrane

/// Balances all columns together. The pulls are known up to one factor, mu t, and together they
/// carry the pressure on the whole membrane below A_g, which gives the factor. Needs no material
/// constant, and of the shape only A_g.
struct BalancedRim {
  static constexpr auto magnitude = detail::membrane::Magnitude::of_all;
  static constexpr bool finds_tensions = false;
  template <scalar S>
  struct Work {
    Work(const BalancedRim&, Index, Index) {}
  };

  template <bool Magnitudes, scalar S>
  bool solve(const detail::membrane::Segments<S>& segments,
             const detail::membrane::Compartments<S>&,
             const std::vector<Point3<S>>& pulls,
             const S& pressure_mpa,
             Work<S>&,
             detail::membrane::Tensions<S>& tensions) const {
    static_assert(Magnitudes, "a direction alone cannot be balanced: use ClampedRim");
    const S modulus = detail::membrane::balanced_modulus(segments, pulls, pressure_mpa);
    if (!(value(modulus) > 0)) {
      return false;
    }
    for (std::size_t k = 0; k < pulls.size(); ++k) {
      tensions.rim[k] = modulus * pulls[k];
    }
    return true;
  }
};

inline void expects_valid(const BalancedRim&) {}

}  // namespace v0
}  // namespace fingerpad
