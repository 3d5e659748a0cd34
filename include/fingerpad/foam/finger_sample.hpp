// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What one foam finger says at one time: what the paper stores at each location T_i of its stack.
#include <cstdint>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

enum class TaxelStatus : std::uint8_t {
  vibrating,      ///< a taxel moves by more than its noise: location and waves are known
  quiet,          ///< none does
  filling,        ///< too few samples since the start or the last jump of the clock to tell
  no_taxels,      ///< all are dead, saturated, stuck or missing
  other_size,     ///< the array or the state is not of the size of the features: nothing was done
  time_not_later  ///< the time is missing or not later than the last one: nothing was done
};

/// "vibrating", "quiet", ...
constexpr const char* name_of(TaxelStatus status) {
  switch (status) {
    case TaxelStatus::vibrating:
      return "vibrating";
    case TaxelStatus::quiet:
      return "quiet";
    case TaxelStatus::filling:
      return "filling";
    case TaxelStatus::no_taxels:
      return "no taxels";
    case TaxelStatus::other_size:
      return "other size";
    case TaxelStatus::time_not_later:
      return "time not later";
  }
  return "unknown";
}

template <scalar S = double>
struct FingerSample {
  static constexpr Index no_location = -1;

  TaxelStatus status = TaxelStatus::filling;
  S center_x_mm = not_a_number<S>();  ///< centroid of force, from the middle of the first taxel
  S center_y_mm = not_a_number<S>();  ///< NaN: nothing presses
  S sum = S(0);                       ///< of the readings, in their unit
  Index location = no_location;       ///< row * cols + col of the vibrating element
  Index waves = 0;                    ///< vibration waves in the window, 0 where none is seen
  S frequency_hz = S(0);              ///< the same by the clock
  S deviation = S(0);                 ///< rms of the vibrating element, in the unit of the readings
  Index left_out = 0;                 ///< taxels that do not count now

  bool is_pressed() const { return is_finite(center_x_mm) && is_finite(center_y_mm); }
  bool is_vibrating() const { return location != no_location && waves > 0; }
};

}  // namespace v0
}  // namespace fingerpad
