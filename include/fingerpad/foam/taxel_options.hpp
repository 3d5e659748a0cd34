// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options of a foam array, and of the window in which its vibrations are detected.
#include <limits>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// The array and its window. Readings are in the sensor's own unit (counts, V, N). The paper prints
/// no values; the defaults suit arrays of 12-bit counts read 30 times a second.
template <scalar S = double>
struct TaxelOptions {
  S pitch_mm = S(34) / S(10);        ///< distance of neighbouring taxels, > 0
  Index window = 16;                 ///< samples in which vibration is detected, in [4, 4096]
  S sample_period_s = S(1) / S(30);  ///< nominal, > 0
  /// A gap counts as at most two periods. A gap longer than this, or a clock that is set back,
  /// begins a new window. > 0.
  S longest_gap_s = S(2);
  S noise = S(6);                ///< standard deviation of a taxel at rest, >= 0
  S noise_factor = S(5) / S(2);  ///< vibration exceeds this many standard deviations, >= 0
  S min_sum = S(0);              ///< with a smaller sum of readings there is no centroid, >= 0
  /// This reading and larger ones do not count, > 0.
  S saturated_at = S((std::numeric_limits<scalar_real_t<S>>::infinity)());
  /// A reading that was the same in this many samples is frozen and, unless it is 0, does not
  /// count. >= 0; 0: not checked.
  Index stuck_after = 30;
};

namespace detail {
/// Whether the magnitude of a reading is below a billion, as that of every converter is; false for
/// NaN.
template <scalar S>
constexpr bool is_reading(const S& reading) {
  return -1000000000 < value(reading) && value(reading) < 1000000000;
}
}  // namespace detail

/// Refuses bad parameters (parameter_error).
template <scalar S>
void expects_valid(const TaxelOptions<S>& o) {
  const auto expect_positive = [](const S& x, const char* name) {
    expects(is_finite(x) && value(x) > 0, "TaxelOptions", name, x, "finite and > 0");
  };
  const auto expect_not_negative = [](const S& x, const char* name) {
    expects(is_finite(x) && value(x) >= 0, "TaxelOptions", name, x, "finite and >= 0");
  };
  expect_positive(o.pitch_mm, "pitch_mm");
  expects(o.window >= 4 && o.window <= 4096, "TaxelOptions", "window",
          static_cast<long long>(o.window), "in [4, 4096]");
  expect_positive(o.sample_period_s, "sample_period_s");
  expect_positive(o.longest_gap_s, "longest_gap_s");
  expect_not_negative(o.noise, "noise");
  expect_not_negative(o.noise_factor, "noise_factor");
  expect_not_negative(o.min_sum, "min_sum");
  expects(value(o.saturated_at) > 0, "TaxelOptions", "saturated_at", o.saturated_at, "> 0");
  expects(o.stuck_after >= 0, "TaxelOptions", "stuck_after", static_cast<long long>(o.stuck_after),
          ">= 0");
}

}  // namespace v0
}  // namespace fingerpad
