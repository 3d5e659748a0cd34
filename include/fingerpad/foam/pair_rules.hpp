// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The two rules of pre-slip as predicates on a pair of samples, the older one at index 1 of the
// paper and the later one at index 2, and what the paper leaves open as named choices.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "fingerpad/foam/finger_sample.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// What a rule compares with. The paper prints no values.
template <scalar S = double>
struct PreslipOptions {
  Index history = 100;    ///< samples that are compared, in [2, 1000000]
  Index min_waves = 1;  ///< a later sample with fewer waves is silent, >= 0; 0 as published,
                          ///< where none and none are an equal frequency
  Index max_waves = 64;  ///< more count as this, in [1, 65536]
  S centroid_tolerance_mm = S(1) / S(10);  ///< what the noise of a centroid explains, >= 0
};

/// Refuses what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const PreslipOptions<S>& o) {
  expects(o.history >= 2 && o.history <= 1000000, "PreslipOptions", "history",
          static_cast<long long>(o.history), "in [2, 1000000]");
  expects(o.min_waves >= 0, "PreslipOptions", "min_waves",
          static_cast<long long>(o.min_waves), ">= 0");
  expects(o.max_waves >= 1 && o.max_waves <= 65536, "PreslipOptions", "max_waves",
          static_cast<long long>(o.max_waves), "in [1, 65536]");
  expects(is_finite(o.centroid_tolerance_mm) && value(o.centroid_tolerance_mm) >= 0,
          "PreslipOptions", "centroid_tolerance_mm", o.centroid_tolerance_mm, "finite and >= 0");
}

/// Centroids differ along an axis where they are more than the tolerance apart.
struct MovedBeyond {
  static constexpr bool is_rounded = false;
};
/// They differ where they are not the same after rounding to multiples of the tolerance, as in
/// integer arithmetic. The tolerance must be > 0.
struct MovedToOtherCell {
  static constexpr bool is_rounded = true;
};

/// "Unequal in x-bar and y-bar" says that the points differ.
struct AnyAxis {};
/// It says that they differ along both axes.
struct BothAxes {};

/// "Simultaneously true for both sides" says that the same two samples show it on all fingers.
struct SamePair {};
/// Each finger may show it on a pair of its own.
struct AnyPair {};

namespace detail {

/// A finger's sample as the rules see it.
struct PairSide {
  double x = 0;  // of the centroid, in mm; where it is rounded, in cells
  double y = 0;
  std::int32_t location = -1;
  std::int32_t waves = 0;
  bool is_pressed = false;
  bool is_vibrating = false;  // has a location, and waves enough
};

/// Beyond this a location counts as none; the arrays of TaxelFeatures have less.
inline constexpr Index max_location = (std::numeric_limits<std::int32_t>::max)();

/// The most cells from the first taxel, so that two of them fit one 64-bit number.
inline constexpr double max_cells = 1e9;

template <class Centroid, scalar S>
PairSide pair_side(const FingerSample<S>& s, const PreslipOptions<S>& o) {
  PairSide side;
  const bool has_location = s.location >= 0 && s.location <= max_location;
  side.location = static_cast<std::int32_t>(has_location ? s.location : Index(-1));
  side.waves = static_cast<std::int32_t>(std::clamp(s.waves, Index(0), o.max_waves));
  side.is_vibrating = side.location >= 0 && s.waves >= o.min_waves;
  side.is_pressed = s.is_pressed();
  side.x = static_cast<double>(value(s.center_x_mm));
  side.y = static_cast<double>(value(s.center_y_mm));
  if constexpr (Centroid::is_rounded) {
    const double size = static_cast<double>(value(o.centroid_tolerance_mm));
    side.x = std::floor(side.x / size + 0.5);
    side.y = std::floor(side.y / size + 0.5);
    side.is_pressed =
        side.is_pressed && std::fabs(side.x) <= max_cells && std::fabs(side.y) <= max_cells;
  }
  return side;
}

/// How far centroids are apart before they differ, in the unit of PairSide.
template <class Centroid, scalar S>
double apart_by(const PreslipOptions<S>& o) {
  return Centroid::is_rounded ? 0.0 : static_cast<double>(value(o.centroid_tolerance_mm));
}

template <class Axes>
bool centroids_differ(double apart_x, double apart_y, double tolerance) {
  const bool x = std::fabs(apart_x) > tolerance;
  const bool y = std::fabs(apart_y) > tolerance;
  return std::is_same_v<Axes, AnyAxis> ? x || y : x && y;
}

}  // namespace detail

/// First experiment: another taxel vibrates, with the same number of waves, on all fingers.
template <class Pairing_ = SamePair>
struct GraspOptimise {
  using Pairing = Pairing_;
  using Centroid = MovedBeyond;  // not looked at
  static constexpr const char* name = "grasp_optimise";

  static bool holds(const detail::PairSide& older, const detail::PairSide& later, double) {
    return older.is_vibrating && later.is_vibrating && older.location != later.location &&
           older.waves == later.waves;
  }
};

/// Second experiment: force has moved, another taxel vibrates, and with more waves, on any finger.
/// A sample in which nothing vibrates has no location, which differs from any.
template <class Centroid_ = MovedBeyond, class Axes_ = AnyAxis>
struct GraspLift {
  using Centroid = Centroid_;
  using Axes = Axes_;
  static constexpr const char* name = "grasp_lift";

  static bool holds(const detail::PairSide& older,
                    const detail::PairSide& later,
                    double tolerance) {
    return older.is_pressed && later.is_pressed && later.is_vibrating &&
           older.location != later.location && later.waves > older.waves &&
           detail::centroids_differ<Axes>(older.x - later.x, older.y - later.y, tolerance);
  }
};

}  // namespace v0
}  // namespace fingerpad
