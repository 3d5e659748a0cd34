// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature of the membrane from few depths. Depth grows away from the plate, and curvature is
// positive where the membrane bulges outward (a dome), as the sign rule of the papers has it.
// Source: Ito et al. 2011, eqs. 10-12 (misprints: E012-E015), and the slides, contact region.
//
// Both papers find the center of the circle through three points, which is 0/0 on a level membrane:
// the very case that they are looking for. With a = l(0) - l(-r) and b = l(r) - l(0) Menger's form
// of the same circle has no division that can fail:
//
//   K = 2 r (a - b) / sqrt((r^2 + a^2) (r^2 + b^2) (4 r^2 + (a + b)^2))                     (K1)
//
// K is the curvature of the vertical section, not the normal curvature (E016): on a sphere of
// radius R at slope tan(alpha) it is 1/R along the gradient and 1/(R cos(alpha)) across it, and its
// mean over all directions is (2 / pi) K_ell(sin(alpha)) / R, K_ell the complete elliptic integral:
// 1.03, 1.14 and 1.37 times 1/R at 20, 40 and 60 degrees. Its sign is that of the normal curvature.
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A whole number as a number, or in every lane of a vector.
template <class V>
[[gnu::always_inline]] inline V whole(int n) {
  if constexpr (scalar<V>) {
    return V(n);
  } else {
    return V{} + static_cast<std::remove_cvref_t<decltype(V{}[0])>>(n);
  }
}

/// (K1) in two factors, for numbers and for vectors of them: K = 2 r bend inverse_root.
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
  return {V(a - b), rough_inverse_sqrt<V>(q)};
}

}  // namespace detail

/// Curvature in 1/mm of the section through depths at -radius, 0 and +radius; radius_mm > 0.
template <scalar S>
S section_curvature(const S& radius_mm, const S& before_mm, const S& center_mm, const S& after_mm) {
  const S radius_sq = radius_mm * radius_mm;
  const detail::Section<S> k = detail::section<S>(radius_sq, before_mm, center_mm, after_mm);
  return S(S(2) * radius_mm * k.bend * k.inverse_root);
}

/// The same by the center of the circle, as published (eqs. 10 and 11 in the plane of the section,
/// repaired by E012-E014), for comparison: NaN on a level section, and few digits on a flat one.
template <scalar S>
S circle_center_curvature(const S& radius_mm,
                          const S& before_mm,
                          const S& center_mm,
                          const S& after_mm) {
  using std::sqrt;
  const S r_sq = radius_mm * radius_mm;
  const S before_sq = before_mm * before_mm;
  const S center_sq = center_mm * center_mm;
  const S after_sq = after_mm * after_mm;
  const S z = (S(2) * r_sq + before_sq + after_sq - S(2) * center_sq) /
              (S(2) * (before_mm + after_mm - S(2) * center_mm));
  const S u =
      (r_sq + after_sq - center_sq - S(2) * (after_mm - center_mm) * z) / (S(2) * radius_mm);
  const S height = center_mm - z;
  const S radius_of_circle = sqrt(S(u * u + height * height));
  const S curvature = S(1) / radius_of_circle;
  return value(height) < 0 ? S(-curvature) : curvature;
}

/// First and second derivatives of depth over the plane of the plate.
template <class S = double>
struct SurfacePatch {
  S slope_x;
  S slope_y;
  S bend_xx_per_mm;
  S bend_xy_per_mm;
  S bend_yy_per_mm;
};

template <class S = double>
struct PrincipalCurvatures {
  S larger_per_mm;
  S smaller_per_mm;
};

namespace detail {

/// Normal curvature in the direction theta from a principal one: mean + half_range cos(2 theta).
template <class V>
struct NormalCurvature {
  V mean;        ///< H, half of what Young and Laplace's equation weighs against the pressure
  V half_range;  ///< >= 0
};

/// sqrt(x) for x >= 0.
template <class V>
[[gnu::always_inline]] inline V root_of(const V& x) {
  if constexpr (scalar<V>) {
    using std::sqrt;
    return value(x) > 0 ? V(sqrt(x)) : V(x);
  } else {
    return x * inverse_sqrt(x);
  }
}

/// The second derivatives taken into the tangent plane by I^(-1/2) = 1 - c g g^T, where the metric
/// I is 1 + g g^T: no difference that cancels, for half_range either.
template <class V>
[[gnu::always_inline]] inline NormalCurvature<V> normal_curvature(const SurfacePatch<V>& p) {
  const V w_sq = p.slope_x * p.slope_x + p.slope_y * p.slope_y + whole<V>(1);
  const V inv_w = inverse_sqrt(w_sq);
  const V c = inv_w / (w_sq * inv_w + whole<V>(1));
  const V x = p.bend_xx_per_mm * p.slope_x + p.bend_xy_per_mm * p.slope_y;
  const V y = p.bend_xy_per_mm * p.slope_x + p.bend_yy_per_mm * p.slope_y;
  const V along = c * (x * p.slope_x + y * p.slope_y);
  const V to_x = c * (along * p.slope_x - x - x);
  const V to_y = c * (along * p.slope_y - y - y);
  const V xx = p.bend_xx_per_mm + to_x * p.slope_x;
  const V yy = p.bend_yy_per_mm + to_y * p.slope_y;
  const V cross = to_x * p.slope_y + to_y * p.slope_x;
  const V two_xy = p.bend_xy_per_mm + p.bend_xy_per_mm + cross;
  const V difference = xx - yy;
  const V range_sq = difference * difference + two_xy * two_xy;
  const V root = root_of<V>(range_sq);
  const V sum = xx + yy;
  const V scale = inv_w / whole<V>(2);
  return {V(-sum * scale), V(root * scale)};
}

/// x where it is positive, else 0; not_a_number() stays.
template <class V>
[[gnu::always_inline]] inline V not_negative(const V& x) {
  if constexpr (scalar<V>) {
    return value(x) < 0 ? V(0) : V(x);
#if defined(FINGERPAD_HAS_VECTORS)
  } else if constexpr (sizeof(V{}[0]) == 4) {
    // As integers floats of either sign order the same against 0, a positive NaN too; and of
    // integers compilers make one instruction.
    using Bits = lanes<std::int32_t, static_cast<int>(sizeof(V) / 4)>;
    const Bits bits = Bits(x);
    return V(bits > 0 ? bits : Bits{});
#endif
  } else {
    return V{} > x ? V{} : x;
  }
}

/// Mean over theta of max(0, mean + half_range cos(2 theta)).
template <class V>
[[gnu::always_inline]] inline V clamped_mean(const NormalCurvature<V>& k) {
  const V above = not_negative<V>(k.mean);
  if constexpr (scalar<V>) {
    using std::atan2;
    using std::sqrt;
    const V size = value(k.mean) < 0 ? V(-k.mean) : V(k.mean);
    if (!(value(size) < value(k.half_range))) {
      return above;
    }
    // what the other side adds, sqrt(d^2 - H^2) - |H| acos(|H| / d), over pi; the angle by atan2,
    // since acos loses half of the digits near 1
    const V product = (k.half_range - size) * (k.half_range + size);
    const V root = sqrt(product);
    const V angle = atan2(root, size);
    return V(above + (root - size * angle) / V(3.14159265358979323846));
  } else {
    const V size = k.mean < V{} ? -k.mean : k.mean;
    const V ratio = size < k.half_range ? size / k.half_range : V{} + 1;
    const V rest = 1 - ratio;
    // what the other side adds is d (1 - v)^(3/2) p(v), v = |H| / d, with p to 4e-7
    V p = V{} + 3.99186604e-4F;
    p = p * ratio - 1.89743204e-3F;
    p = p * ratio + 5.80879904e-3F;
    p = p * ratio - 2.25143274e-2F;
    p = p * ratio + 3.18309474e-1F;
    return above + k.half_range * (rest * root_of<V>(rest)) * p;
  }
}

}  // namespace detail

/// H = (k1 + k2) / 2 in 1/mm.
template <scalar S>
S mean_curvature(const SurfacePatch<S>& patch) {
  return detail::normal_curvature<S>(patch).mean;
}

template <scalar S>
PrincipalCurvatures<S> principal_curvatures(const SurfacePatch<S>& patch) {
  const detail::NormalCurvature<S> k = detail::normal_curvature<S>(patch);
  return {S(k.mean + k.half_range), S(k.mean - k.half_range)};
}

/// Mean over all directions of the normal curvature with its negative values as 0, in closed form.
template <scalar S>
S clamped_mean_curvature(const SurfacePatch<S>& patch) {
  return detail::clamped_mean<S>(detail::normal_curvature<S>(patch));
}

}  // namespace v0
}  // namespace fingerpad
