// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Depth in mm written to whole numbers would lose its fraction, and NaN would become a number.
// first error: whole numbers would cut off fractions and NaN; give it cells of float or double
#include "fingerpad/depth/depth.hpp"
#include "support/foreign_image.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
using Cell = int;
#else
using Cell = float;
#endif
static void good_or_bad(fingerpad::DepthEstimator<>& estimator) {
  const test::ForeignImage<unsigned char> red(4, 4), green(4, 4);
  test::ForeignImage<Cell> depth_mm(4, 4);
  (void)estimator(red, green, depth_mm);
}
int main() {
  (void)&good_or_bad;
}
