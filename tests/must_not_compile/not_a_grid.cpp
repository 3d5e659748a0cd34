// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The first error for a type without cells names the missing members.
// first error: this type is not a grid: give it rows\(\), cols\(\) and a const operator
#include "fingerpad/core/grid.hpp"
#include "support/foreign_image.hpp"

struct Sizes {
  int rows() const { return 2; }
  int cols() const { return 2; }
};

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)fingerpad::rows(Sizes{});
#else
  (void)fingerpad::rows(test::ForeignImage<int>(2, 2));
#endif
}
