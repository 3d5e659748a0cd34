// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The Young-Laplace contact test as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile
// information by vision-based tactile sensor for dexterous handling of robot hands", III.B, eqs.
// 8-12. A pixel is in contact if twice the mean of 36 section curvatures over 10 px is below
// 0.00015 per mm; the mask is not cleaned. With noise the test misses half of a flat contact:
// docs/errata.md, E018.
#include <cmath>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Curvature of a section from the center of the circle through three points, as published: eqs. 10
/// and 11 in the plane of the section, repaired by E012-E014. NaN on a level section, and few
/// correct digits on a nearly flat one.
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

/// Eq. 12: the sum over 36 directions, divided by 18. This is twice the mean (E015).
template <int Directions = 36>
struct TwiceMean {
  static constexpr int directions = Directions;
  static constexpr int means = 2;
  static constexpr bool clamped = false;
};

/// f of the slides: the mean over 18 directions. It is low in contact, but also on a free saddle
/// (E017).
template <int Directions = 18>
using SectionMean = detail::PlainMean<Directions>;

/// The published test. Its threshold is two orders of magnitude below the paper's own rule (E018).
constexpr ContactTest contact_test() {
  ContactTest test{0.00015, 13, {10}};
  test.min_region_px = 1;
  return test;
}

/// The slides' rule for the threshold: the minimum of E - 2 sigma over the pixels.
constexpr ThresholdRule threshold_rule() {
  return {1, 2, 0, false};
}

template <scalar S = float>
using ContactRegion = fingerpad::ContactRegion<TwiceMean<>, AtThreshold, Camera<double>, S>;

/// For depth maps of rows x cols pixels. Refuses bad parameters (parameter_error).
template <scalar S = float>
ContactRegion<S> contact_region(const Camera<double>& camera, Index rows, Index cols) {
  return ContactRegion<S>(camera, rows, cols, contact_test());
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
