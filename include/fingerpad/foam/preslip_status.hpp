// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Slip state of the fingers at one sample: the answer of the pre-slip rules (preslip.hpp), and the
// input of the searches for the holding force (holding_force.hpp).
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

enum class PreslipStatus : std::uint8_t {
  steady,      ///< all fingers can be judged, and nothing slips
  preslip,     ///< part of the contact begins to slip
  slipped,     ///< the whole object slips or is gone; set by callers, never by a rule
  cannot_tell  ///< a finger cannot be judged, and no other shows pre-slip
};

/// "steady", "preslip", ...
constexpr const char* name_of(PreslipStatus status) {
  switch (status) {
    case PreslipStatus::steady:
      return "steady";
    case PreslipStatus::preslip:
      return "preslip";
    case PreslipStatus::slipped:
      return "slipped";
    case PreslipStatus::cannot_tell:
      return "cannot tell";
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
