// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A vector of points is not a dot grid: the first error says what to pass.
// first error: a vector has no rows and columns: pass fingerpad::grid_of\(vector, rows, cols\)
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"

const fingerpad::StickRatio<> stick_ratio(9, 9);
auto state = stick_ratio.start();
std::vector<fingerpad::Point2<double>> dots_px(81);
std::vector<unsigned char> contact(81);
std::vector<fingerpad::DotState> states(81);

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  (void)stick_ratio(dots_px, contact, states, state);
}
#else
static void good_or_bad() {
  using fingerpad::grid_of;
  (void)stick_ratio(grid_of(dots_px, 9, 9), grid_of(contact, 9, 9), grid_of(states, 9, 9), state);
}
#endif
int main() {
  good_or_bad();
}
