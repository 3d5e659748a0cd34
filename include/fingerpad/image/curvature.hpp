// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature of the membrane along sections of three depths. Depth grows away from the plate, and
// curvature is positive where the membrane bulges outward (a dome), as in the papers.
// Source: Ito et al. 2011, eqs. 10-12 (misprints: E012-E015), and the slides, contact region.
//
// Both papers compute the center of the circle through three points. This is 0/0 on a level
// membrane, the very case that they look for. Menger's form of the same circle has no division that
// can fail. With a = l(0) - l(-r) and b = l(r) - l(0):
//
//   K = 2 r (a - b) / sqrt((r^2 + a^2) (r^2 + b^2) (4 r^2 + (a + b)^2))                     (K1)
//
// K is the curvature of the vertical section, not the normal curvature (E016): on a sphere of
// radius R at slope tan(alpha) it is 1/R along the gradient and 1/(R cos(alpha)) across it, and its
// mean over all directions is (2 / pi) K_ell(sin(alpha)) / R, where K_ell is the complete elliptic
// integral of the first kind: 1.03, 1.14 and 1.37 times 1/R at 20, 40 and 60 degrees. Its sign is
// that of the normal curvature.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/quick_math.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The integer n as a scalar, or in every lane of a vector.
template <class V>
[[gnu::always_inline]] inline V whole(int n) {
  if constexpr (scalar<V>) {
    return V(n);
  } else {
    return V{} + static_cast<std::remove_cvref_t<decltype(V{}[0])>>(n);
  }
}

/// (K1) in two factors, for scalars and vectors: K = 2 r bend inverse_root.
template <class V>
struct Section {
  V bend;  ///< has the sign of K
  V inverse_root;
};

template <class V>
[[gnu::always_inline]] inline Section<V> section(const V& radius_sq,
                                                 const V& before,
                                                 const V& center,
                                                 const V& after) {
  const V a = center - before;
  const V b = after - center;
  const V rise = after - before;
  const V ends = (radius_sq + a * a) * (radius_sq + b * b);
  const V twice = radius_sq + radius_sq;
  const V q = ends * (twice + twice + rise * rise);
  return {V(a - b), inverse_sqrt<V>(q)};
}

}  // namespace detail

/// Curvature in 1/mm of the section through depths at -radius, 0 and +radius; radius_mm > 0.
template <scalar S>
S section_curvature(const S& radius_mm, const S& before_mm, const S& center_mm, const S& after_mm) {
  const S radius_sq = radius_mm * radius_mm;
  const detail::Section<S> k = detail::section<S>(radius_sq, before_mm, center_mm, after_mm);
  return S(S(2) * radius_mm * k.bend * k.inverse_root);
}

/// The ring of pixels on which curvature is measured: sections through the center pixel in evenly
/// spaced directions, each with one pixel at either end. An end is the pixel nearest to the circle,
/// and its true distance is used as the radius, because interpolation would bias the second
/// difference by up to curvature px^2 / 4 per sample. Default: the slides' radius, 1.92 mm on the
/// published pad.
struct CurvatureRing {
  double radius_px = 25;             ///< in [1, 1000]
  double min_direction_share = 0.5;  ///< share of sections that must be complete, in (0, 1]
};

/// Refuses values out of range (parameter_error).
inline void expects_valid(const CurvatureRing& ring) {
  expects(ring.radius_px >= 1 && ring.radius_px <= 1000, "CurvatureRing", "radius_px",
          ring.radius_px, "in [1, 1000]");
  expects(ring.min_direction_share > 0 && ring.min_direction_share <= 1, "CurvatureRing",
          "min_direction_share", ring.min_direction_share, "in (0, 1]");
}

// Statistics of the curvatures in all directions, in 1/mm. A statistic states its number of
// directions, its factor on the mean (`means`) and whether negative curvatures count as 0
// (`clamped`).

/// The slides' mean, in which negative curvatures count as 0. It is below p / (2 sigma) (pressure
/// p, membrane tension sigma) only in contact, and 0 where the object is convex or flat. Take this
/// for any object and any pad.
template <int Directions = 18>
struct ClampedMean {
  static constexpr int directions = Directions;
  static constexpr int means = 1;
  static constexpr bool clamped = true;
};

/// Difference of center and ring, linear in depth; for small slopes only. At a slope s it
/// overstates normal curvature by the factor (1 + s^2)^(3/2) along the slope and (1 + s^2)^(1/2)
/// across it. Take this when time counts and contacts are flat.
template <int Directions = 18>
struct RingStencil {
  static constexpr int directions = Directions;
  static constexpr int means = 1;
  static constexpr bool linear = true;
};

namespace detail {

/// The plain mean, which locates the edge of contact.
template <int Directions = 18>
struct PlainMean {
  static constexpr int directions = Directions;
  static constexpr int means = 1;
  static constexpr bool clamped = false;
};

/// One end of a section as an offset from the center pixel; the other end is its negative.
struct RingOffset {
  Index row;
  Index col;

  constexpr Index radius_sq() const { return row * row + col * col; }
  friend constexpr bool operator==(const RingOffset&, const RingOffset&) = default;
};

/// The pixel nearest to radius (cos, sin) at the angle pi step / (2 directions) in the first
/// octant. Ties round toward the center, whatever the rounding of the cosine.
inline RingOffset ring_offset_in_octant(double radius_px, int step, int directions) {
  const double angle = 1.5707963267948966 * step / directions;
  const auto nearest = [&](double unit) {
    return static_cast<Index>(std::ceil(radius_px * unit - 0.5 - 1e-9));
  };
  return {nearest(std::sin(angle)), nearest(std::cos(angle))};
}

/// One end of each section in the directions pi k / directions, sorted from shortest to longest.
/// The set is its own mirror image in both axes and, for an even number of directions, under
/// exchange of rows and columns.
inline std::vector<RingOffset> ring_offsets(double radius_px, int directions) {
  std::vector<RingOffset> offsets;
  for (int k = 0; k < directions; ++k) {
    const bool beyond_vertical = 2 * k > directions;
    const int quarter = 2 * (beyond_vertical ? directions - k : k);  // of pi / (2 directions)
    const bool steep = 2 * quarter > directions;
    const RingOffset end =
        ring_offset_in_octant(radius_px, steep ? directions - quarter : quarter, directions);
    const RingOffset unfolded = steep ? RingOffset{end.col, end.row} : end;
    offsets.push_back({unfolded.row, beyond_vertical ? -unfolded.col : unfolded.col});
  }
  std::stable_sort(offsets.begin(), offsets.end(), [](const RingOffset& a, const RingOffset& b) {
    return a.radius_sq() < b.radius_sq();
  });
  return offsets;
}

/// x where it is positive, else 0; not_a_number() stays NaN.
template <class V>
[[gnu::always_inline]] inline V not_negative(const V& x) {
  if constexpr (scalar<V>) {
    return value(x) < 0 ? V(0) : V(x);
#if defined(FINGERPAD_HAS_VECTORS)
  } else if constexpr (sizeof(V{}[0]) == 4) {
    // Compared with 0 as integers, floats keep their sign and a positive NaN counts as positive.
    // Compilers emit one instruction for the integer form.
    using Bits = lanes<std::int32_t, static_cast<int>(sizeof(V) / 4)>;
    const Bits bits = Bits(x);
    return V(bits > 0 ? bits : Bits{});
#endif
  } else {
    return whole<V>(0) > x ? whole<V>(0) : x;
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
