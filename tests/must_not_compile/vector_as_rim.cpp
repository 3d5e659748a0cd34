// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A vector of the rim's border points is not a grid: the first error says what to pass.
// first error: a vector has no rows and columns: pass fingerpad::grid_of\(vector, rows, cols\)
#include <vector>

#include "fingerpad/force/wrench.hpp"

const std::vector<fingerpad::Point3<double>> border(72);

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  const fingerpad::Wrench<> wrench(border);
  (void)wrench;
}
#else
static void good_or_bad() {
  const fingerpad::Wrench<> wrench(fingerpad::grid_of(border, 1, 72));
  (void)wrench;
}
#endif
int main() {
  good_or_bad();
}
