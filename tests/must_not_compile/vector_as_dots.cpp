// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A vector of points is not a dot grid: the first error says what to pass.
// first error: a vector has no rows and columns: pass fingerpad::grid_of\(vector, rows, cols\)
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"

fingerpad::StickRatio<> stick(9, 9);
std::vector<fingerpad::Point2<double>> dots_px(81);
std::vector<unsigned char> contact(81);

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)stick(dots_px, contact);
#else
  using fingerpad::grid_of;
  (void)stick(grid_of(dots_px, 9, 9), grid_of(contact, 9, 9));
#endif
}
