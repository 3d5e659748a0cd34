// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How far an imprint has travelled over a gel, by what users of OpenCV write, and by fingerpad, in
// the same frames with printed dots.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "support/gel_frames.hpp"

namespace bench::peers {

struct SlideFrames {
  cv::Mat free;
  std::vector<cv::Mat> frames;
  std::vector<test::GelDots> dots;
  std::vector<cv::Point2d> truth;  // travel of the ball since the first frame, px
};

/// A ball of 10 mm, pressed by 1.2 N, is dragged in a direction of its own by 0.2 mm (5 px) a frame
/// until it slides.
inline SlideFrames dragged_ball(unsigned seed, double noise, double flicker, int frames) {
  test::GelCamera camera{.rows = 480, .cols = 640, .mm_per_px = 0.04, .noise = noise};
  test::Random random(seed);
  test::BallOnGel<> ball(test::GelPad{});
  SlideFrames all;
  all.free = test::mat_of(camera.frame(ball, random));
  const double angle = random.uniform(0, 6.28);
  for (int k = 0; k < frames; ++k) {
    const fingerpad::Point2<double> way = {0.2 * k * std::cos(angle), 0.2 * k * std::sin(angle)};
    ball.drag(1.2, way);
    camera.exposure = 1 + flicker * (k % 2 == 0 ? 1 : -1);
    all.frames.push_back(test::mat_of(camera.frame(ball, random)));
    all.dots.push_back(camera.dots(ball, random));
    all.truth.emplace_back(way.x / camera.mm_per_px, way.y / camera.mm_per_px);
  }
  return all;
}

/// The travel of the imprint since the first frame, px.
using Travel = std::function<cv::Point2d(const cv::Mat& frame, const test::GelDots& dots)>;

/// The grey difference from the free pad, of which the dots are a part.
inline cv::Mat difference(const cv::Mat& frame, const cv::Mat& free) {
  cv::Mat now, before, difference;
  cv::cvtColor(frame, now, cv::COLOR_BGR2GRAY);
  cv::cvtColor(free, before, cv::COLOR_BGR2GRAY);
  cv::subtract(now, before, difference, cv::noArray(), CV_32F);
  return difference;
}

inline Travel phase_correlation(const SlideFrames& of) {
  const auto before = std::make_shared<std::pair<cv::Mat, cv::Point2d>>();
  return [=, free = of.free](const cv::Mat& frame, const test::GelDots&) {
    const cv::Mat now = difference(frame, free);
    if (!before->first.empty()) {
      before->second += cv::phaseCorrelate(before->first, now);
    }
    before->first = now;
    return before->second;
  };
}

/// Where the middle of the first frame's difference fits best, to a pixel and by a parabola.
inline Travel template_matching(const SlideFrames& of) {
  const auto imprint = std::make_shared<cv::Mat>();
  return [=, free = of.free](const cv::Mat& frame, const test::GelDots&) {
    const cv::Mat now = difference(frame, free);
    const cv::Rect middle(now.cols / 4, now.rows / 4, now.cols / 2, now.rows / 2);
    if (imprint->empty()) {
      *imprint = now(middle).clone();
    }
    cv::Mat fit;
    cv::matchTemplate(now, *imprint, fit, cv::TM_CCOEFF_NORMED);
    cv::Point at;
    cv::minMaxLoc(fit, nullptr, nullptr, nullptr, &at);
    const auto top = [](double a, double b, double c) {
      return a + c < 2 * b ? 0.5 * (a - c) / (a - 2 * b + c) : 0.0;
    };
    const auto value = [&](int i, int j) {
      return static_cast<double>(
          fit.at<float>(std::clamp(i, 0, fit.rows - 1), std::clamp(j, 0, fit.cols - 1)));
    };
    return cv::Point2d(
        at.x + top(value(at.y, at.x - 1), value(at.y, at.x), value(at.y, at.x + 1)) - middle.x,
        at.y + top(value(at.y - 1, at.x), value(at.y, at.x), value(at.y + 1, at.x)) - middle.y);
  };
}

/// The median motion of corners near the middle from frame to frame.
inline Travel corners() {
  struct State {
    cv::Mat before;
    cv::Point2d travel;
  };
  const auto state = std::make_shared<State>();
  return [=](const cv::Mat& frame, const test::GelDots&) {
    cv::Mat grey;
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
    if (!state->before.empty()) {
      std::vector<cv::Point2f> from, to;
      cv::Mat middle(grey.size(), CV_8U, cv::Scalar(0));
      cv::circle(
          middle,
          {grey.cols / 2 + cvRound(state->travel.x), grey.rows / 2 + cvRound(state->travel.y)},
          grey.rows / 4, 255, -1);
      cv::goodFeaturesToTrack(state->before, from, 100, 0.01, 8, middle);
      if (!from.empty()) {
        std::vector<unsigned char> found;
        cv::calcOpticalFlowPyrLK(state->before, grey, from, to, found, cv::noArray());
        std::vector<float> x, y;
        for (std::size_t k = 0; k < from.size(); ++k) {
          if (found[k] != 0) {
            x.push_back(to[k].x - from[k].x);
            y.push_back(to[k].y - from[k].y);
          }
        }
        const auto median = [](std::vector<float>& all) {
          const auto half = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
          std::nth_element(all.begin(), half, all.end());
          return all.empty() ? 0.0 : static_cast<double>(*half);
        };
        state->travel += {median(x), median(y)};
      }
    }
    state->before = grey;
    return state->travel;
  };
}

inline Travel gel_slide(const SlideFrames& of) {
  struct State {
    fingerpad::GelContact contact;
    fingerpad::GelSlide slide;
  };
  fingerpad::GelContact contact(std::vector{of.free}, {.dot_px = 20});
  const auto rows = contact.mask().rows, cols = contact.mask().cols;
  const auto state = std::make_shared<State>(State{std::move(contact), {rows, cols, of.dots[0]}});
  return [=](const cv::Mat& frame, const test::GelDots& dots) {
    (void)state->contact(frame);
    const auto seen = state->slide(state->contact.imprint(), state->contact.mask(), dots);
    return cv::Point2d(seen.imprint_px.x, seen.imprint_px.y);
  };
}

}  // namespace bench::peers
