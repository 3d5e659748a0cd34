// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A program that uses the library without any adapter.
#include "fingerpad/fingerpad.hpp"

int main() {
  const float cells[] = {1, 2, 3, 4, 5, 6};
  const fingerpad::StridedView<const float> image(cells, 2, 3, 3);
  const auto rotated = fingerpad::transpose(image);
  return fingerpad::rows(rotated) == 3 && rotated(2, 1) == 6.0f ? 0 : 1;
}
