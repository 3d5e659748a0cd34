// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sample of one foam finger at one time, as the paper stores it at each location T_i of its stack.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

enum class TaxelStatus : std::uint8_t {
  vibrating,  ///< a taxel varies by more than its noise: location and waves are known
  quiet,      ///< none does, although some taxel that can be judged is pressed enough to
  filling,    ///< too few samples since the start or since a new clock
  no_taxels,  ///< all taxels are dead, saturated, stuck, flickering or missing
  frozen,     ///< no reading has changed for long, or ever: a dead array, nothing touches it, or
              ///< an object is held still
  /// All readings are below what counts as vibration: nothing presses, or the noise is given in
  /// another unit.
  too_weak,
  /// Windows do not fill, or more than half of the clock's steps are gaps: time not in seconds?
  clock_jumps,
  /// The array has another size, or its time is missing or not later than the last one: nothing was
  /// done.
  refused,
};

/// "vibrating", "quiet", ...
constexpr const char* name_of(TaxelStatus status) {
  constexpr std::array<const char*, 8> names = {"vibrating", "quiet",    "filling",     "no taxels",
                                                "frozen",    "too weak", "clock jumps", "refused"};
  const auto k = static_cast<std::size_t>(status);
  return k < names.size() ? names[k] : "unknown";
}

template <scalar S = double>
struct FingerSample {
  static constexpr Index no_location = -1;

  /// The taxels that vibrate with the same number of waves.
  struct Vibration {
    Index waves = 0;
    Index location = no_location;  ///< of one of them
    bool is_several = false;       ///< there are others
  };

  TaxelStatus status = TaxelStatus::filling;
  /// Centroid of the force; x is along columns; NaN: nothing presses.
  S center_x_mm = not_a_number<S>();
  S center_y_mm = not_a_number<S>();
  S sum = S(0);                  ///< sum of the readings, in their unit
  Index location = no_location;  ///< row * cols + col of the taxel that vibrates most
  Index waves = 0;               ///< number of its waves in the window, 0 if nothing vibrates
  S frequency_hz = S(0);         ///< its waves per second, by the clock
  S deviation = S(0);            ///< its rms, in the unit of the readings
  Index left_out = 0;            ///< taxels that do not count in this sample
  /// Whether a window was quiet since the start, so that a present vibration has begun after it.
  bool has_rested = true;
  Index vibration_count = 0;
  /// All vibrations, by their number of waves.
  std::array<Vibration, 16> vibrations = {};

  /// Adds a vibrating taxel; the first is that of `location`. Numbers of waves beyond the size of
  /// `vibrations` are left out.
  void add_vibration(Index at, Index with_waves) {
    if (vibration_count == 0) {
      location = at;
      waves = with_waves;
    }
    for (Index k = 0; k < vibration_count; ++k) {
      Vibration& known = vibrations[static_cast<std::size_t>(k)];
      if (known.waves == with_waves) {
        known.is_several = known.is_several || known.location != at;
        return;
      }
    }
    if (vibration_count < static_cast<Index>(vibrations.size())) {
      vibrations[static_cast<std::size_t>(vibration_count++)] = {with_waves, at};
    }
  }

  /// Whether slip can be judged. A finger that has vibrated ever since the start may have noise or
  /// swapped bytes.
  bool can_tell() const {
    return has_rested && (status == TaxelStatus::vibrating || status == TaxelStatus::quiet);
  }
  /// The vibrations by which slip is judged; none if it cannot be.
  std::span<const Vibration> judged() const {
    return {vibrations.data(), can_tell() ? static_cast<std::size_t>(vibration_count) : 0};
  }
  bool is_pressed() const { return is_finite(center_x_mm) && is_finite(center_y_mm); }
  bool is_vibrating() const { return location != no_location && waves > 0; }
};

}  // namespace v1
}  // namespace fingerpad
