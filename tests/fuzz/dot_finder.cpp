// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dot finder from any picture and any spots: a dot is finite and in its place, or NaN;
// what is counted is what is there; a copied finder gives the same bits.
// with: -lopencv_core -lopencv_imgproc
#include "fingerpad/dots/dot_finder.hpp"

#include <cstdint>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;
using Places = Grid<Point2<double>>;

namespace {

Index present(const Places& dots) {
  Index count = 0;
  const auto view = dots.view();
  for (Index i = 0; i < view.rows(); ++i) {
    for (Index j = 0; j < view.cols(); ++j) {
      count += is_finite(view(i, j)) ? 1 : 0;
    }
  }
  return count;
}

/// A print with odd places in it.
cv::Mat picture(Input& in, int rows, int cols, double pitch, double radius, double shift) {
  cv::Mat image(rows, cols, CV_8UC1, cv::Scalar(180));
  for (double y = pitch; y < rows - pitch / 2; y += pitch) {
    for (double x = pitch; x < cols - pitch / 2; x += pitch) {
      const double half = radius + 1;
      for (int i = static_cast<int>(y - half); i <= y + half; ++i) {
        for (int j = static_cast<int>(x + shift - half); j <= x + shift + half; ++j) {
          if (i >= 0 && j >= 0 && i < rows && j < cols &&
              std::hypot(i - y, j - x - shift) < radius) {
            image.at<std::uint8_t>(i, j) = 60;
          }
        }
      }
    }
  }
  for (Index k = in.whole(0, 20); k > 0; --k) {
    const auto row = static_cast<int>(in.whole(0, rows - 1)),
               col = static_cast<int>(in.whole(0, cols - 1));
    const auto size = static_cast<int>(in.whole(1, 6));
    image(cv::Rect(col, row, (std::min)(size, cols - col), (std::min)(size, rows - row))) =
        cv::Scalar(in.byte());
  }
  return image;
}

void try_finder(Input& in) {
  const int rows = static_cast<int>(in.side(20, 90)), cols = static_cast<int>(in.side(20, 90));
  const double pitch = in.number(8, 20), radius = in.number(1, 4);
  expects(pitch >= 4 && pitch < 100 && radius > 0 && radius < 100, "fuzz", "pitch", pitch,
          "in [4, 100)");
  DotFinderOptions options;
  if (in.flag()) {
    options.pattern.radius_px = radius;
    options.pattern.pitch_px = pitch;
  }
  DotFinder finder(picture(in, rows, cols, pitch, radius, 0), options);
  if (!finder.ok()) {
    return;
  }
  Places dots(finder.rows(), finder.cols()), again(finder.rows(), finder.cols());
  for (int frame = 0; frame < 3; ++frame) {
    const cv::Mat now = picture(in, rows, cols, pitch, radius, static_cast<double>(in.whole(0, 8)));
    DotFinder copy = finder;
    auto to = dots.view(), second = again.view();
    const DotResult r = finder(now, to), same = copy(now, second);
    require(r.status != DotStatus::refused, "a frame of the right size is accepted");
    require(dots == again && r.found == same.found, "a copied finder gives the same bits");
    require(present(dots) == r.found && r.found <= finder.rows() * finder.cols(),
            "the number of dots found is that in the result");
  }
}

void try_labels(Input& in) {
  const double pitch = 8 + in.byte() / 21.0;
  DotFinder finder(picture(in, 90, 90, pitch, pitch / 4, 0));
  const Index rows = finder.rows(), cols = finder.cols();
  Places free(rows, cols), dots(rows, cols), again(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      free.view()(i, j) = finder.free_px()(i, j);
    }
  }
  for (int frame = 0; frame < 3 && finder.ok(); ++frame) {
    const Places moved = fuzz::moved_dots(in, free);
    std::vector<Point2<double>> spots;
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        spots.push_back(moved.view()(i, j));
      }
    }
    for (Index k = in.whole(0, 10); k > 0; --k) {
      spots.push_back({in.number(-50, 200), in.number(-50, 200)});
    }
    DotFinder copy = finder;
    auto to = dots.view(), second = again.view();
    const DotResult r = finder.label(spots, to), same = copy.label(spots, second);
    require(r.status != DotStatus::refused, "a grid of the right size is accepted");
    require(dots == again && r.found == same.found, "a copied finder gives the same bits");
    require(present(dots) == r.found, "the number of dots found is that in the result");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size,
                   [](Input& in) { return in.flag() ? try_finder(in) : try_labels(in); });
}
