// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What is made of the curvatures in all directions: policies. All give 1/mm.
#include <type_traits>

namespace fingerpad {
inline namespace v0 {

/// Paper 002, eq. 12: over 36 directions, divided by half as many, so twice the mean (E015).
template <int Directions = 36>
struct PublishedTwiceMean {
  static constexpr int directions = Directions;
};

/// The slides' f, the mean over 18 directions. Low in contact, but low on a free saddle too (E017).
template <int Directions = 18>
struct SectionMean {
  static constexpr int directions = Directions;
};

/// The slides' mean with negative curvatures as 0: below p / (2 sigma) only in contact, and 0
/// wherever the object is convex or flat.
template <int Directions = 18>
struct ClampedMean {
  static constexpr int directions = Directions;
};

/// What is made of the two normal curvatures of a fitted surface.
enum class FittedValue { mean, clamped_mean, larger, smaller };

/// A quadratic surface fitted to the ring by least squares through the center pixel: the normal
/// curvatures of the membrane, without the factor of vertical sections (E016). `mean` is H;
/// `clamped_mean` is the mean of max(0, K) over all directions.
template <int Directions = 18, FittedValue Value = FittedValue::mean>
struct HessianFit {
  static_assert(Directions >= 3, "three directions at least determine a quadratic surface");
  static constexpr int directions = Directions;
};
template <int Directions = 18>
using ClampedHessian = HessianFit<Directions, FittedValue::clamped_mean>;

/// Center minus ring, linear in depth: for small slopes only. At a slope s it overstates normal
/// curvature by the factor (1 + s^2)^(3/2) along the slope and (1 + s^2)^(1/2) across it.
template <int Directions = 18>
struct RingStencil {
  static constexpr int directions = Directions;
};

}  // namespace v0
}  // namespace fingerpad
