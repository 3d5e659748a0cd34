// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A type without cells is refused by the concept's name.
// message: (satisfaction of|does not satisfy) 'grid
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "support/foreign_image.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  (void)fingerpad::rows(std::vector<int>(4));
}
#else
static void good_or_bad() {
  (void)fingerpad::rows(test::ForeignImage<int>(2, 2));
}
#endif
int main() {
  good_or_bad();
}
