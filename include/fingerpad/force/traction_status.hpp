// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What became of a frame of the traction field.
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

enum class TractionStatus : std::uint8_t {
  ok,
  no_contact,    ///< no dot is in contact: force and moment are 0; the maps are there
  incomplete,    ///< force and moment miss the share of some dots in contact or beside them, which
                 ///< have no load: they lie on the edge of the grid, or dots were not found
  bad_pressure,  ///< <= 0, above 10^6 MPa or NaN: nothing is known
  too_few_dots,  ///< no dot was found with all its neighbours: nothing is known
  no_balance,    ///< BalancedModulus: the free part is too small, or does not hold the pressure
};

/// "ok", "no contact", ...
constexpr const char* name_of(TractionStatus status) {
  switch (status) {
    case TractionStatus::ok:
      return "ok";
    case TractionStatus::no_contact:
      return "no contact";
    case TractionStatus::incomplete:
      return "incomplete";
    case TractionStatus::bad_pressure:
      return "bad pressure";
    case TractionStatus::too_few_dots:
      return "too few dots";
    case TractionStatus::no_balance:
      return "no balance";
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
