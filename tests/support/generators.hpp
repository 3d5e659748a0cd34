// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Random inputs for properties. RapidCheck shrinks a failing case toward the low end of each range.
#include <cmath>
#include <cstddef>

#include "support/catch.hpp"

namespace test {

/// Any integer in [low, high], whatever RapidCheck's current size.
inline std::ptrdiff_t whole(std::ptrdiff_t low, std::ptrdiff_t high) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange<std::ptrdiff_t>(low, high + 1));
}

/// Uniform in [low, high).
inline double uniform(double low, double high) {
  const double unit = std::ldexp(static_cast<double>(whole(0, (std::ptrdiff_t(1) << 40) - 1)), -40);
  return low + (high - low) * unit;
}

/// Uniform in the logarithm, for quantities that span decades.
inline double log_uniform(double low, double high) {
  return low * std::pow(high / low, uniform(0, 1));
}

}  // namespace test
