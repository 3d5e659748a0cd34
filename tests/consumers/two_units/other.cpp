// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/fingerpad.hpp"

int cols_of_other(fingerpad::StridedView<const double> image);
int cols_of_other(fingerpad::StridedView<const double> image) {
  return static_cast<int>(fingerpad::cols(image));
}
