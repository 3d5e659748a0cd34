// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dot states are output: a read-only grid cannot receive them.
// first error: this grid of states is written to: its cells must be assignable
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/foreign_image.hpp"

using namespace fingerpad;
static test::ForeignImage<Point2<float>> dots(9, 9);
static test::ForeignImage<unsigned char> contact(9, 9);
static test::ForeignImage<DotState> states(9, 9);

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  const auto& read_only = states;
  const StickRatio ratio(9, 9);
  auto state = ratio.start();
  (void)ratio(dots, contact, read_only, state);
}
#else
static void good_or_bad() {
  const StickRatio ratio(9, 9);
  auto state = ratio.start();
  (void)ratio(dots, contact, states, state);
}
#endif
int main() {
  good_or_bad();
}
