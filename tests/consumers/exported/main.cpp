// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A program that uses a library that uses fingerpad.
#include "touch.hpp"

int main() {
  const float cells[] = {1, 2, 3, 4, 5, 6};
  return sum_over(fingerpad::StridedView<const float>(cells, 2, 3, 3)) == 21.0f ? 0 : 1;
}
