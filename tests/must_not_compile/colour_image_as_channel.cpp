// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A colour image is not a channel: the first error says what to pass.
// first error: a colour image is not a channel: pass fingerpad::channel<T>\(image, c\) of it
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/depth.hpp"

using Estimator = fingerpad::DepthEstimator<>;

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  const auto depth = [](Estimator& estimator, const cv::Mat_<cv::Vec3b>& image) {
    cv::Mat_<float> depth_mm(image.size());
    return estimator(image, image, depth_mm);
  };
  (void)depth;
#else
  const auto depth = [](Estimator& estimator, const cv::Mat_<cv::Vec3b>& image) {
    cv::Mat_<float> depth_mm(image.size());
    const auto red = fingerpad::channel<unsigned char>(image, 2);
    const auto green = fingerpad::channel<unsigned char>(image, 1);
    return estimator(red, green, depth_mm);
  };
  (void)depth;
#endif
}
