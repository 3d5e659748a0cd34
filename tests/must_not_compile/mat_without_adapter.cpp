// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The same before the adapter is included.
// first error: include fingerpad/adapt/opencv.hpp and pass cv::Mat_<T>\(image\)
#include <opencv2/core/mat.hpp>

#include "fingerpad/core/grid.hpp"

cv::Mat depth_mm(480, 640, CV_32F);

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)fingerpad::rows(depth_mm);
#else
  (void)depth_mm.rows;
#endif
}
