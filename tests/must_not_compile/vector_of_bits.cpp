// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A vector<bool> keeps bits, of which no view can be made: the first error says what to take.
// first error: a std::vector<bool> has no cells in memory: take a std::vector<unsigned char>
#include <vector>

#include "fingerpad/core/grid.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
std::vector<bool> mask(81);
#else
std::vector<unsigned char> mask(81);
#endif
int main() {
  return static_cast<int>(fingerpad::rows(fingerpad::grid_of(mask, 9, 9)));
}
