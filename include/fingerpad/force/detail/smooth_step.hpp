// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How one formula passes into another without a step: a weight that rises smoothly from 0 to 1.
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// 3 x^2 - 2 x^3 for x held below 1: from 0 at 0 to 1 from 1 on, with slope 0 at both ends.
template <scalar S>
S smooth_step(const S& share) {
  const S x = value(share) < 1 ? share : S(1);
  return S(square(x) * S(S(3) - S(S(2) * x)));
}

/// Its slope.
template <scalar S>
S smooth_step_slope(const S& share) {
  const S x = value(share) < 1 ? share : S(1);
  return S(S(S(6) * x) * S(S(1) - x));
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
