// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: masks of contact. A mask is a grid of anything that is true in contact (bytes,
// bools), or of Touch, which also knows where nothing can be said.
#include <cstdint>
#include <type_traits>

#include "fingerpad/grid.hpp"

namespace fingerpad {
inline namespace v0 {

/// What is known of a pixel. As a number: black, grey and white of an 8-bit image.
enum class Touch : std::uint8_t { none = 0, unknown = 127, contact = 255 };

/// Whether a cell of a mask says contact: anything but 0 and NaN, and of a Touch only contact.
template <class Cell>
constexpr bool says_contact(const Cell& cell) {
  if constexpr (std::is_same_v<Cell, Touch>) {
    return cell == Touch::contact;
  } else if constexpr (std::is_floating_point_v<Cell>) {
    return cell < 0 || cell > 0;
  } else {
    return static_cast<bool>(cell);
  }
}

/// A grid of such cells.
template <class G> concept contact_mask = grid<G> && requires(const cell_t<G>& cell) {
  static_cast<bool>(cell);
};

}  // namespace v0
}  // namespace fingerpad
