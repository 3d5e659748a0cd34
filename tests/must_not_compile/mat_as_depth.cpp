// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A cv::Mat has no static pixel type: the first error says what to pass.
// first error: the type of the pixels of a cv::Mat is not known: pass cv::Mat_<T>\(image\)
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/contact/contact_region.hpp"

fingerpad::ContactRegion<> contact_region(fingerpad::Camera<>(), 480, 640);
cv::Mat depth_map(480, 640, CV_32F), mask(480, 640, CV_8U);

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)contact_region(depth_map, mask);
#else
  cv::Mat_<unsigned char> to(mask);
  (void)contact_region(cv::Mat_<float>(depth_map), to);
#endif
}
