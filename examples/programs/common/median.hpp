// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace replay {

/// The upper one of the middle two for an even number of values. NaN, or 0 for whole numbers, for
/// no values.
template <class T>
T median_of(std::vector<T> values) {
  if (values.empty()) {
    return std::numeric_limits<T>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace replay
