// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What is made of the curvatures in all directions: policies. All give 1/mm.
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {

// The ring of pixels on which curvature is measured: sections through the center pixel in evenly
// spaced directions, each with one pixel at either end. An end is the pixel nearest to the circle,
// and its true distance is what counts as the radius: no interpolation, which would bias the second
// difference by up to curvature px^2 / 4 per sample.

/// Default: the slides' radius, 1.92 mm on the published pad.
struct CurvatureRing {
  Index radius_px = 25;              ///< in [1, 1000]
  double min_direction_share = 0.5;  ///< sections that must be complete, in (0, 1]
};

/// The ring of paper 002.
constexpr CurvatureRing published_ring() {
  return {10};
}

inline void expects_valid(const CurvatureRing& ring) {
  expects(ring.radius_px >= 1 && ring.radius_px <= 1000, "CurvatureRing", "radius_px",
          static_cast<long long>(ring.radius_px), "in [1, 1000]");
  expects(ring.min_direction_share > 0 && ring.min_direction_share <= 1, "CurvatureRing",
          "min_direction_share", ring.min_direction_share, "in (0, 1]");
}

/// One end of a section, counted from the center; the other end is opposite.
struct RingOffset {
  Index row;
  Index col;

  constexpr Index radius_sq() const { return row * row + col * col; }
  friend constexpr bool operator==(const RingOffset&, const RingOffset&) = default;
};

namespace detail {

/// The pixel nearest to radius (cos, sin) of pi step / (2 directions), an angle of the first
/// octant; ties go to the center, whatever the rounding of the cosine.
inline RingOffset ring_offset_in_octant(Index radius_px, int step, int directions) {
  const double angle = 1.5707963267948966 * step / directions;
  const auto nearest = [&](double unit) {
    return static_cast<Index>(std::ceil(static_cast<double>(radius_px) * unit - 0.5 - 1e-9));
  };
  return {nearest(std::sin(angle)), nearest(std::cos(angle))};
}

}  // namespace detail

/// One end of each section in the directions pi k / directions, from the shortest to the longest.
/// The set is its own mirror image in both axes and, for an even number of directions, under
/// exchange of rows and columns.
inline std::vector<RingOffset> ring_offsets(Index radius_px, int directions) {
  std::vector<RingOffset> offsets;
  for (int k = 0; k < directions; ++k) {
    const bool beyond_vertical = 2 * k > directions;
    const int quarter = 2 * (beyond_vertical ? directions - k : k);  // of pi / (2 directions)
    const bool steep = 2 * quarter > directions;
    const RingOffset end = detail::ring_offset_in_octant(
        radius_px, steep ? directions - quarter : quarter, directions);
    const RingOffset unfolded = steep ? RingOffset{end.col, end.row} : end;
    offsets.push_back({unfolded.row, beyond_vertical ? -unfolded.col : unfolded.col});
  }
  std::stable_sort(offsets.begin(), offsets.end(), [](const RingOffset& a, const RingOffset& b) {
    return a.radius_sq() < b.radius_sq();
  });
  return offsets;
}

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
