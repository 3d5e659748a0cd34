// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A program that views the same cells through OpenCV and through xtensor, and searches for dots and
// a contact in an image without any.
#include <vector>

#include "fingerpad/adapt/mdspan.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#if __has_include(<xtensor/containers/xarray.hpp>)
#include <xtensor/containers/xarray.hpp>
#else
#include <xtensor/xarray.hpp>
#endif

int main() {
  const cv::Mat_<float> image = (cv::Mat_<float>(2, 3) << 1, 2, 3, 4, 5, 6);
  const xt::xarray<float> array = {{1, 2, 3}, {4, 5, 6}};
  const auto a = fingerpad::as_view(image);
  const auto b = fingerpad::as_view(array);
  const cv::Mat frame(60, 80, CV_8UC3, cv::Scalar::all(50));
  const fingerpad::DotFinder dots(frame);
  fingerpad::GelContact gel(std::vector{frame});
  const bool nothing = !dots.ok() && gel(frame).ok() && !gel(frame).in_contact();
  return fingerpad::same_size(a, b) && a(1, 2) == b(1, 2) && nothing ? 0 : 1;
}
