// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Displacement and rotation of a contact as printed: Ito, Kim and Obinata, "Acquisition of Contact
// Force and Slippage ...", figure 5: the displacement of the central dot, and the rotation angle of
// the contact surface.
#include "fingerpad/motion/contact_shift.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Takes the displacement of one dot: the middle one of the grid, as published, or any other. The
/// angle is that of all dots in contact.
struct OneDot {
  DotIndex dot = {};
};
inline OneDot central_dot(Index rows, Index cols) {
  return {{rows / 2, cols / 2}};
}

/// `reference` are the dots of the free pad. Refuses bad parameters (parameter_error).
template <dot_grid Grid>
ContactShift<OneDot> contact_shift(const Grid& reference) {
  return ContactShift<OneDot>(reference, central_dot(rows(reference), cols(reference)));
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
