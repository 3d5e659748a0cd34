// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The exact disc of the slides' "compensation for approximation error": Ito, Kim, Obinata, "Shape
// sensing by vision-based tactile sensor". Its time grows with the radius.
#include "fingerpad/depth/neighbour_light.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Every pixel whose center lies within the radius.
struct ExactDisc {
  static detail::DiscShape shape(Index radius_px) { return detail::exact_disc(radius_px); }
};

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
