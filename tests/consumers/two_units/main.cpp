// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Two translation units that include everything are linked: nothing may be defined twice.
#include "fingerpad/fingerpad.hpp"

int cols_of_other(fingerpad::StridedView<const double> image);

int main() {
  const double cell = 1;
  return cols_of_other({&cell, 1, 1, 1}) == 1 ? 0 : 1;
}
