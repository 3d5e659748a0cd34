// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "touch.hpp"

#include <cstddef>

float sum_over(fingerpad::StridedView<const float> image) {
  float sum = 0;
  for (std::ptrdiff_t i = 0; i < fingerpad::rows(image); ++i) {
    for (std::ptrdiff_t j = 0; j < fingerpad::cols(image); ++j) sum += image(i, j);
  }
  return sum;
}
