// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sample of one foam finger at one time, as the paper stores it at each location T_i of its stack.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

enum class TaxelStatus : std::uint8_t {
  vibrating,  ///< a taxel varies by more than its noise: location and waves are known
  quiet,      ///< none does, although some taxel that can be judged is pressed enough to
  filling,    ///< too few samples since the start or since a new clock
  no_taxels,  ///< all taxels are dead, saturated, stuck, flickering or missing
  frozen,     ///< no reading has changed for long, or ever: a dead array, or nothing touches it
  /// All readings are below what counts as vibration: nothing presses, or the noise is given in
  /// another unit.
  too_weak,
  /// Windows do not fill, or more than half of the clock's steps are gaps: time not in seconds?
  clock_jumps,
  other_size,  ///< the array or the state does not have the size of the features: nothing was done
  time_not_later,  ///< the time is missing or not later than the last one: nothing was done
};

/// "vibrating", "quiet", ...
constexpr const char* name_of(TaxelStatus status) {
  constexpr std::array<const char*, 9> names = {"vibrating",   "quiet",      "filling",
                                                "no taxels",   "frozen",     "too weak",
                                                "clock jumps", "other size", "time not later"};
  const auto k = static_cast<std::size_t>(status);
  return k < names.size() ? names[k] : "unknown";
}

template <scalar S = double>
struct FingerSample {
  static constexpr Index no_location = -1;
  static constexpr std::size_t max_vibrations = 16;

  /// The taxels that vibrate with the same number of waves.
  struct Vibration {
    Index waves = 0;
    Index location = no_location;  ///< of one of them
    bool is_several = false;       ///< there are others
  };

  TaxelStatus status = TaxelStatus::filling;
  /// Centroid of the force, x along columns, from the middle of the first taxel; NaN: nothing
  /// presses.
  S center_x_mm = not_a_number<S>();
  S center_y_mm = not_a_number<S>();
  S sum = S(0);                  ///< sum of the readings, in their unit
  Index location = no_location;  ///< row * cols + col of the taxel that vibrates most
  Index waves = 0;               ///< number of its waves in the window, 0 if nothing vibrates
  S frequency_hz = S(0);         ///< its waves per second, by the clock
  S deviation = S(0);            ///< its rms, in the unit of the readings
  Index left_out = 0;            ///< taxels that do not count in this sample
  Index frozen = 0;  ///< taxels whose reading has not changed for long, at 0 or another value
  Index gaps = 0;    ///< steps of the clock in the window that are longer than two periods
  /// Whether a window was quiet since the start, so that a present vibration has begun after it.
  bool has_rested = true;

  /// All vibrations, by their number of waves; that of `location` first.
  std::array<Vibration, max_vibrations> vibrations = {};
  Index vibration_count = 0;

  /// Adds a vibrating taxel. Numbers of waves beyond `max_vibrations` are left out.
  void add_vibration(const Vibration& one) {
    const auto end = vibrations.begin() + vibration_count;
    const auto same = std::find_if(vibrations.begin(), end,
                                   [&](const Vibration& v) { return v.waves == one.waves; });
    if (same != end) {
      same->is_several = same->is_several || one.is_several || same->location != one.location;
    } else if (end != vibrations.end()) {
      *end = one;
      ++vibration_count;
    }
  }

  /// Whether slip can be judged. A finger that has vibrated ever since the start may have noise or
  /// swapped bytes.
  bool can_tell() const {
    return has_rested && (status == TaxelStatus::vibrating || status == TaxelStatus::quiet);
  }

  bool is_pressed() const { return is_finite(center_x_mm) && is_finite(center_y_mm); }
  bool is_vibrating() const { return location != no_location && waves > 0; }
};

}  // namespace v0
}  // namespace fingerpad
