// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Finding, naming and tracking of dots in noisy 8-bit frames of 640 x 480 pixels with three
// channels. A drawn print shifts back and forth by a fifth of a pitch. The error is the distance of
// each dot from its drawn position; a dot with another dot's name counts as lost.
#include "fingerpad/dots/dot_finder.hpp"

#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_follower.hpp"
#include "support/printed_dots.hpp"

using namespace fingerpad;
using test::DotPlaces;

namespace {

/// Frames of one print and the true positions of its dots.
struct Frames {
  explicit Frames(const test::Print& of) : print(of) {
    for (int k = 0; k < 8; ++k) {
      const double shift = 0.2 * print.pitch_px * std::sin(0.8 * k);
      truth.push_back(test::moved(test::places_of(print), {shift, 0.5 * shift}));
      frames.push_back(test::picture_of(print, truth.back(), {}, static_cast<unsigned>(k + 1)));
    }
  }
  std::size_t pixels() const { return frames[0].total(); }

  test::Print print;
  std::vector<DotPlaces> truth;
  std::vector<cv::Mat> frames;
};

/// Distances of the dots of one frame from their drawn positions; NaN for a lost dot.
void add_errors(const DotPlaces& found,
                const DotPlaces& truth,
                double pitch_px,
                std::vector<double>& errors) {
  for (int i = 0; i < truth.rows; ++i) {
    for (int j = 0; j < truth.cols; ++j) {
      const double off = cv::norm(found(i, j) - truth(i, j));
      errors.push_back(off < pitch_px / 2 ? off : std::nan(""));
    }
  }
}

/// `find(frame, dots)` finds the dots of a frame.
template <class Find>
void add(const std::string& name, const Frames& frames, long bytes, Find find) {
  const auto next = std::make_shared<std::size_t>(0);
  const auto dots = std::make_shared<DotPlaces>(frames.print.rows, frames.print.cols);
  bench::add(
      name, frames.pixels(), bytes,
      [=, &frames]() mutable { find(frames.frames[(*next)++ % frames.frames.size()], *dots); },
      [=, &frames](auto& counters) mutable {
        std::vector<double> errors;
        for (std::size_t k = 0; k < frames.frames.size(); ++k) {
          find(frames.frames[k], *dots);
          add_errors(*dots, frames.truth[k], frames.print.pitch_px, errors);
        }
        bench::note_errors(counters, "place", "px", errors);
      });
}

void add_finder(const std::string& name, const Frames& frames, const DotFinderOptions& options) {
  const DotFinder found(frames.frames[0], options);
  const bench::Memory memory;
  const auto finder = std::make_shared<DotFinder>(found);
  add(name, frames, memory.bytes(), [=](const cv::Mat& frame, DotPlaces& dots) {
    benchmark::DoNotOptimize((*finder)(frame, dots));
  });
}

void add_follower(const std::string& group, const Frames& frames) {
  const bench::Memory memory;
  const auto follower = std::make_shared<DotFollower>(
      channel<const unsigned char>(frames.frames[0], 1), frames.truth[0],
      DotFollowerOptions{.radius_px = frames.print.radius_px});
  add(group + "/DotFollower", frames, memory.bytes(), [=](const cv::Mat& frame, DotPlaces& dots) {
    benchmark::DoNotOptimize((*follower)(channel<const unsigned char>(frame, 1), dots));
  });
}

/// OpenCV's detector of circle grids: it has no memory and needs every dot to be visible.
void add_circles_grid(const std::string& group, const Frames& frames) {
  add(group + "/cv::findCirclesGrid", frames, 0, [&](const cv::Mat& frame, DotPlaces& dots) {
    std::vector<cv::Point2f> centers;
    const cv::Size size(frames.print.cols, frames.print.rows);
    dots = cv::Vec2d::all(std::nan(""));
    if (cv::findCirclesGrid(frame, size, centers)) {
      const bool backward = centers.front().y > centers.back().y;
      for (int k = 0; k < size.area(); ++k) {
        const cv::Point2f& at =
            centers[static_cast<std::size_t>(backward ? size.area() - 1 - k : k)];
        dots(k / size.width, k % size.width) = {static_cast<double>(at.x),
                                                static_cast<double>(at.y)};
      }
    }
  });
}

/// Dark components and their centroids. The truth names them, because nothing else does.
void add_components(const std::string& group, const Frames& frames) {
  add(group + "/cv::connectedComponentsWithStats, no names", frames, 0,
      [&frames, k = std::size_t{0}](const cv::Mat& frame, DotPlaces& dots) mutable {
        cv::Mat grey, dark, labels, stats, centers;
        cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
        const int side = 2 * static_cast<int>(frames.print.pitch_px / 2) + 1;
        cv::adaptiveThreshold(grey, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV,
                              side, 10);
        const int count = cv::connectedComponentsWithStats(dark, labels, stats, centers, 4);
        const auto same = [&](const cv::Mat& other) { return other.data == frame.data; };
        k = static_cast<std::size_t>(
            std::find_if(frames.frames.begin(), frames.frames.end(), same) - frames.frames.begin());
        const cv::Vec2d first = frames.truth[k](0, 0);
        dots = cv::Vec2d::all(std::nan(""));
        for (int c = 1; c < count; ++c) {
          const cv::Vec2d at(centers.at<double>(c, 0), centers.at<double>(c, 1));
          const int row = cvRound((at[1] - first[1]) / frames.print.pitch_px);
          const int col = cvRound((at[0] - first[0]) / frames.print.pitch_px);
          const bool is_dot = stats.at<int>(c, cv::CC_STAT_AREA) > frames.print.radius_px;
          if (is_dot && row >= 0 && row < dots.rows && col >= 0 && col < dots.cols) {
            dots(row, col) = at;
          }
        }
      });
}

void add_all(const std::string& group, const Frames& frames) {
  DotFinderOptions options;
  options.pattern.rows = frames.print.rows;
  options.pattern.cols = frames.print.cols;
  add_finder(group + "/DotFinder, the default", frames, options);
  options.color_weights = {0, 1, 1};
  add_finder(group + "/DotFinder, two channels", frames, options);
  add_follower(group, frames);
  add_components(group, frames);
  add_circles_grid(group, frames);
  bench::add_streaming(group);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  test::Print fluid;  // 21 x 21 dots of 0.7 mm every 1.5 mm
  fluid.frame = {640, 480};
  fluid.rows = fluid.cols = 21;
  fluid.pitch_px = 18.75;
  fluid.radius_px = 4.375;
  fluid.noise = 1;
  const Frames many(fluid);
  add_all("21x21 dots, radius 4.4 px", many);
  return bench::run(argc, argv);
}
