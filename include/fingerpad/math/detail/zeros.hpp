// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Arrays of zeros for every scalar: empty braces leave the derivatives of a dual number undefined.
#include <array>
#include <cstddef>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <scalar S, std::size_t N>
constexpr std::array<S, N> zeros() {
  std::array<S, N> all;
  all.fill(S(0));
  return all;
}

template <scalar S, std::size_t N>
constexpr std::array<std::array<S, N>, N> zero_matrix() {
  std::array<std::array<S, N>, N> all;
  all.fill(zeros<S, N>());
  return all;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
