// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The message names the type that was passed and what its cells must be.
// message: ForeignImage<float>.*does not satisfy|(planar_point<|Dots =).*ForeignImage<float>
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/foreign_image.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
using Cell = float;
#else
using Cell = fingerpad::Point2<float>;
#endif
static void good_or_bad(fingerpad::StickRatio<>& stick) {
  const test::ForeignImage<Cell> dots_px(9, 9);
  const test::ForeignImage<unsigned char> contact(9, 9);
  (void)stick(dots_px, contact);
}
int main() {
  (void)&good_or_bad;
}
