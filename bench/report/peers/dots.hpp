// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Printed dots followed by what users of OpenCV write, and by fingerpad, in the same frames.
// Methods that find spots without a name take that of the nearest dot of the frame before; in the
// first frame the truth names them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/dots/dot_follower.hpp"
#include "support/gel_frames.hpp"
#include "support/printed_dots.hpp"

namespace bench::peers {

using test::DotPlaces;
using Spots = std::vector<cv::Point2f>;

struct DotFrames {
  double pitch_px = 0, radius_px = 0;
  std::vector<cv::Mat> frames;  // the first shows the free pad
  std::vector<DotPlaces> truth;
};

/// What the camera does: noise in grey levels, a lamp that flickers by this share from frame to
/// frame, and only every so many frames.
struct Filming {
  std::string name;
  double noise = 1, flicker = 0;
  int every = 1;
};

inline DotPlaces places_of(const test::GelDots& dots) {
  DotPlaces places(static_cast<int>(dots.rows()), static_cast<int>(dots.cols()));
  for (int i = 0; i < places.rows; ++i) {
    for (int j = 0; j < places.cols; ++j) {
      places(i, j) = {dots(i, j).x, dots(i, j).y};
    }
  }
  return places;
}

/// A ball of 10 mm is pressed into a gel by 1.2 N in the first two frames and then dragged by 0.09
/// mm (2.2 px) a frame: dots of 20 px, 60 px apart, which stay round.
inline DotFrames gel_dots(const Filming& filming, int frames) {
  test::GelCamera camera{.rows = 480, .cols = 640, .mm_per_px = 0.04, .noise = filming.noise};
  test::Random random(7);
  test::BallOnGel<> ball(test::GelPad{});
  DotFrames all{camera.pitch_px(), 10, {}, {}};
  for (int k = 0; k < frames; ++k) {
    const int at = k * filming.every;
    ball.drag(std::min(0.6 * at, 1.2), {0.08 * std::max(at - 2, 0), 0.04 * std::max(at - 2, 0)});
    camera.exposure = 1 + filming.flicker * (k % 2 == 0 ? 1 : -1);
    all.truth.push_back(places_of(camera.true_dots(ball)));
    all.frames.push_back(test::mat_of(camera.frame(ball, random)));
  }
  return all;
}

/// A print of 21 x 21 dots of 8.8 px, 19 px apart, which a press spreads and a drag carries along,
/// most in the middle, by 0.6 px a frame.
inline DotFrames membrane_dots(const Filming& filming, int frames) {
  test::Print print{.frame = {640, 480}, .rows = 21, .cols = 21, .pitch_px = 19};
  print.radius_px = 4.4;
  print.noise = filming.noise;
  const double ink = print.ink, ground = print.ground;
  DotFrames all{print.pitch_px, print.radius_px, {}, {}};
  const DotPlaces free = test::places_of(print);
  for (int k = 0; k < frames; ++k) {
    DotPlaces now = free.clone();
    for (cv::Vec2d& dot : now) {
      const cv::Vec2d arm = dot - cv::Vec2d(320, 240);
      const double share = std::exp(-arm.dot(arm) / (120.0 * 120.0)) * k * filming.every;
      dot += share * (cv::Vec2d(0.6, 0.3) + 0.002 * arm);
    }
    const double light = 1 + filming.flicker * (k % 2 == 0 ? 1 : -1);
    print.ink = light * ink;
    print.ground = light * ground;
    all.truth.push_back(now);
    all.frames.push_back(test::picture_of(print, now, {}, static_cast<unsigned>(k + 1)));
  }
  return all;
}

/// Finds the dots of a frame in place of those of the frame before.
using Follow = std::function<void(const cv::Mat& frame, DotPlaces& dots)>;

inline cv::Mat grey_of(const cv::Mat& frame) {
  cv::Mat grey;
  cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

/// Each dot goes to the nearest spot within half a pitch, or is lost and stays where it was.
inline void take_nearest(const Spots& spots, double pitch_px, DotPlaces& dots) {
  for (cv::Vec2d& dot : dots) {
    cv::Vec2d best = dot;
    double least = pitch_px / 2;
    for (const cv::Point2f& spot : spots) {
      const cv::Vec2d at(static_cast<double>(spot.x), static_cast<double>(spot.y));
      if (cv::norm(at - dot) < least) {
        least = cv::norm(at - dot);
        best = at;
      }
    }
    dot = best;
  }
}

inline Follow simple_blobs(const DotFrames& of) {
  cv::SimpleBlobDetector::Params params;
  const float area = static_cast<float>(CV_PI * of.radius_px * of.radius_px);
  params.minArea = area / 4;
  params.maxArea = 4 * area;
  params.minDistBetweenBlobs = static_cast<float>(of.pitch_px) / 3;
  params.filterByCircularity = params.filterByInertia = params.filterByConvexity = false;
  return [detector = cv::SimpleBlobDetector::create(params), pitch = of.pitch_px](
             const cv::Mat& frame, DotPlaces& dots) {
    std::vector<cv::KeyPoint> found;
    detector->detect(grey_of(frame), found);
    Spots spots;
    cv::KeyPoint::convert(found, spots);
    take_nearest(spots, pitch, dots);
  };
}

/// Where a narrow mean is darker than a wide one; the centroid of each piece.
inline Follow mask_and_centroid(const DotFrames& of) {
  return [r = of.radius_px, pitch = of.pitch_px](const cv::Mat& frame, DotPlaces& dots) {
    cv::Mat narrow, wide, mask, labels, stats, centers;
    const cv::Mat grey = grey_of(frame);
    cv::GaussianBlur(grey, narrow, {}, r / 3);
    cv::GaussianBlur(grey, wide, {}, 1.5 * r);
    cv::compare(narrow, wide - 10, mask, cv::CMP_LT);
    cv::connectedComponentsWithStats(mask, labels, stats, centers, 4);
    Spots spots;
    for (int c = 1; c < centers.rows; ++c) {
      if (stats.at<int>(c, cv::CC_STAT_AREA) > r * r) {
        spots.emplace_back(static_cast<float>(centers.at<double>(c, 0)),
                           static_cast<float>(centers.at<double>(c, 1)));
      }
    }
    take_nearest(spots, pitch, dots);
  };
}

/// Lucas and Kanade's flow from the frame before, or always from the first. More than one level of
/// the pyramid would confuse neighbours of a dense print.
inline Follow optical_flow(const DotFrames& of, bool from_first) {
  struct State {
    cv::Mat before;
    Spots places, now;
  };
  const auto state = std::make_shared<State>();
  const int side = 2 * cvRound(1.5 * of.radius_px) + 1;
  return [=](const cv::Mat& frame, DotPlaces& dots) {
    const cv::Mat grey = grey_of(frame);
    if (state->before.empty()) {
      state->before = grey;
      for (const cv::Vec2d& dot : dots) {
        state->places.emplace_back(static_cast<float>(dot[0]), static_cast<float>(dot[1]));
      }
      state->now = state->places;
      return;
    }
    std::vector<unsigned char> found;
    cv::calcOpticalFlowPyrLK(state->before, grey, state->places, state->now, found, cv::noArray(),
                             {side, side}, 1,
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01},
                             from_first ? cv::OPTFLOW_USE_INITIAL_FLOW : 0);
    std::size_t k = 0;
    for (cv::Vec2d& dot : dots) {
      dot = {static_cast<double>(state->now[k].x), static_cast<double>(state->now[k].y)};
      ++k;
    }
    if (!from_first) {
      state->before = grey;
      state->places = state->now;
    }
  };
}

inline Follow circles_grid(const DotFrames& of) {
  return [size = of.truth[0].size()](const cv::Mat& frame, DotPlaces& dots) {
    Spots centers;
    if (!cv::findCirclesGrid(frame, size, centers)) {
      dots = cv::Vec2d::all(std::nan(""));
      return;
    }
    const bool backward = centers.front().y > centers.back().y;
    for (int k = 0; k < size.area(); ++k) {
      const auto& at = centers[static_cast<std::size_t>(backward ? size.area() - 1 - k : k)];
      dots(k / size.width, k % size.width) = {static_cast<double>(at.x), static_cast<double>(at.y)};
    }
  };
}

inline fingerpad::DotFinder finder_for(const DotFrames& of, double max_off) {
  fingerpad::DotFinderOptions options;
  options.pattern.rows = of.truth[0].rows;
  options.pattern.cols = of.truth[0].cols;
  options.max_off = max_off;
  return fingerpad::DotFinder(of.frames[0], options);
}

inline Follow dot_finder(const DotFrames& of, double max_off) {
  return [finder = std::make_shared<fingerpad::DotFinder>(finder_for(of, max_off))](
             const cv::Mat& frame, DotPlaces& dots) { (void)(*finder)(frame, dots); };
}

/// Begins again from the finder where it has lost the print.
inline Follow dot_follower(const DotFrames& of, double max_off) {
  using fingerpad::channel;
  const auto finder = std::make_shared<fingerpad::DotFinder>(finder_for(of, max_off));
  const auto follower = std::make_shared<fingerpad::DotFollower>(
      channel<const unsigned char>(of.frames[0], 1), finder->free_px(),
      fingerpad::DotFollowerOptions{.radius_px = finder->pattern().radius_px});
  return [=](const cv::Mat& frame, DotPlaces& dots) {
    const auto green = channel<const unsigned char>(frame, 1);
    if (!(*follower)(green, dots).ok() && (*finder)(frame, dots).ok()) {
      (void)follower->restart(green, dots);
    }
  };
}

}  // namespace bench::peers
