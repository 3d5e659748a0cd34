// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sample of one foam finger at one time: what the paper stores at each location T_i of its stack.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

enum class TaxelStatus : std::uint8_t {
  vibrating,    ///< a taxel moves by more than its noise: location and waves are known
  quiet,        ///< none does, and all can be judged
  filling,      ///< too few samples since the start or a new clock to tell
  no_taxels,    ///< all are dead, saturated, stuck, flickering or missing
  frozen,       ///< no reading has changed for long, or ever: a dead array, or nothing touches it
  too_weak,     ///< all readings are below what counts as vibration: nothing presses, or the noise
                ///< is given in another unit
  clock_jumps,  ///< windows do not fill, or most steps of the clock are gaps: time in seconds?
  other_size,   ///< the array or the state is not of the size of the features: nothing was done
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

  /// The taxels that vibrate with one number of waves.
  struct Vibration {
    Index waves = 0;
    Index location = no_location;  ///< of one of them
    bool is_several = false;       ///< there is another one
  };

  TaxelStatus status = TaxelStatus::filling;
  S center_x_mm = not_a_number<S>();  ///< centroid of force, from the middle of the first taxel
  S center_y_mm = not_a_number<S>();  ///< NaN: nothing presses
  S sum = S(0);                       ///< of the readings, in their unit
  Index location = no_location;       ///< row * cols + col of the vibrating element
  Index waves = 0;                    ///< vibration waves in the window, 0 where none is seen
  S frequency_hz = S(0);              ///< the same by the clock
  S deviation = S(0);                 ///< rms of the vibrating element, in the unit of the readings
  Index left_out = 0;                 ///< taxels that do not count now
  Index frozen = 0;        ///< taxels whose reading has not changed for long, 0 or another
  Index gaps = 0;          ///< steps of the clock in the window that are longer than two periods
  bool has_rested = true;  ///< a window was quiet since the start: what vibrates now has begun to

  std::array<Vibration, max_vibrations> vibrations = {};  ///< of all that vibrate, by their waves;
                                                          ///< that of `location` first
  Index vibration_count = 0;

  /// One more taxel that vibrates. Numbers of waves beyond `max_vibrations` are left out.
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

  /// Whether slip can be judged: what vibrates where nothing ever rested may be noise or swapped
  /// bytes.
  bool can_tell() const {
    return has_rested && (status == TaxelStatus::vibrating || status == TaxelStatus::quiet);
  }

  bool is_pressed() const { return is_finite(center_x_mm) && is_finite(center_y_mm); }
  bool is_vibrating() const { return location != no_location && waves > 0; }
};

}  // namespace v0
}  // namespace fingerpad
