// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The Young-Laplace contact test as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile
// information by vision-based tactile sensor for dexterous handling of robot hands", III.B, eqs.
// 8-12: twice the mean of 36 section curvatures over 10 px below 0.00015 per mm, nothing cleaned.
// It misses half of a flat contact in noise: docs/errata.md, E018.
#include "fingerpad/contact/contact_region.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = float>
using ContactRegion =
    fingerpad::ContactRegion<PublishedTwiceMean<>, AtThreshold, NoCleaning, Camera<double>, S>;

/// For depth maps of rows x cols pixels. Refuses bad parameters (parameter_error).
template <scalar S = float>
ContactRegion<S> contact_region(const Camera<double>& camera, Index rows, Index cols) {
  return ContactRegion<S>(camera, rows, cols, published_contact_test());
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
