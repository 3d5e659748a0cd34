// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/gel/slide_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "replay/median.hpp"

namespace replay {
namespace {

using Colours = cv::Mat_<cv::Vec3b>;
constexpr int first_frames = 3;                 // at most this many may show the free pad
constexpr double usual_dot_share = 14.0 / 640;  // of the frame's width

/// Converts to 8-bit BGR.
Colours colours_of(const cv::Mat& image) {
  cv::Mat levels = image;
  if (image.depth() == CV_16U) {
    image.convertTo(levels, CV_8U, 1.0 / 256);
  }
  Colours colours;
  if (levels.channels() == 4) {
    cv::cvtColor(levels, colours, cv::COLOR_BGRA2BGR);
  } else {
    colours = levels;
  }
  return colours;
}

std::vector<Colours> colours_of(const std::vector<cv::Mat>& images) {
  std::vector<Colours> all;
  for (const cv::Mat& image : images) {
    all.push_back(colours_of(image));
  }
  return all;
}

fingerpad::DifferenceTest test_of(const std::vector<cv::Mat>& free_frames, double dot_px) {
  const double usual = free_frames.empty() ? 14.0 : usual_dot_share * free_frames.front().cols;
  return difference_test_for(dot_px > 0 ? dot_px : usual);
}

fingerpad::SlideTest slide_test_for(const DotGrid& dots, const fingerpad::DifferenceTest& test) {
  fingerpad::SlideTest slide;
  slide.pitch_px = pitch_px(dots);
  slide.cell_px = static_cast<double>(test.cell_px);
  return slide;
}

/// The first frames, up to the first that shows a contact relative to frame 0.
std::vector<cv::Mat> free_first_frames(Recording& recording) {
  recording.frames.seek(0);
  std::vector<cv::Mat> frames = {next_frame(recording.frames, recording.reference.size())};
  const fingerpad::ContactByDifference<3> contact(colours_of(frames));
  auto workspace = contact.workspace();
  cv::Mat_<uchar> mask(recording.reference.size());
  const int last = (std::min)(first_frames, recording.frames.size());
  for (int k = 1; k < last; ++k) {
    const cv::Mat frame = next_frame(recording.frames, recording.reference.size());
    if (contact(colours_of(frame), mask, workspace).in_contact()) {
      break;
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace

double pitch_px(const DotGrid& dots) {
  std::vector<double> distances;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      for (const cv::Point beside : {cv::Point(j + 1, i), cv::Point(j, i + 1)}) {
        if (beside.x < dots.cols && beside.y < dots.rows) {
          const double distance = cv::norm(dots(i, j) - dots(beside));
          if (std::isfinite(distance)) {
            distances.push_back(distance);
          }
        }
      }
    }
  }
  return median_of(distances);
}

fingerpad::DifferenceTest difference_test_for(double dot_px) {
  fingerpad::DifferenceTest test;
  const double larger = dot_px / test.dot_px;  // than the default dots
  const auto cell = std::lround(larger * static_cast<double>(test.cell_px));
  test.cell_px =
      (std::clamp)(static_cast<fingerpad::Index>(cell), fingerpad::Index{1}, fingerpad::Index{16});
  test.dot_px = dot_px;
  test.smoothing_px *= larger;
  test.max_gap_px *= larger;
  test.min_region_px = std::lround(larger * larger * static_cast<double>(test.min_region_px));
  test.mm_per_px = 1;
  return test;
}

FreePad free_pad_of(Recording& recording) {
  if (recording.free_frames.size() > 0) {
    FreePad pad{{}, "free/"};
    recording.free_frames.seek(0);
    for (int k = 0; k < recording.free_frames.size(); ++k) {
      pad.frames.push_back(next_frame(recording.free_frames, recording.reference.size()));
    }
    return pad;
  }
  if (!recording.sensor.reference_frame.empty()) {
    return {{recording.reference}, "the reference in sensor.json"};
  }
  return {free_first_frames(recording),
          "the start of the recording, where nothing may touch the pad"};
}

SlideStep::SlideStep(const std::vector<cv::Mat>& free_frames,
                     const DotGrid& free_dots,
                     double dot_px)
    : contact_(colours_of(free_frames), test_of(free_frames, dot_px)),
      workspace_(contact_.workspace()),
      slide_(workspace_.difference().rows(),
             workspace_.difference().cols(),
             free_dots.rows,
             free_dots.cols,
             slide_test_for(free_dots, test_of(free_frames, dot_px))),
      slide_state_(slide_.start()),
      recoil_(free_dots, {.pitch_px = pitch_px(free_dots)}),
      recoil_state_(recoil_.start()),
      limit_state_(limit_.start()) {}

GelFrame SlideStep::operator()(const cv::Mat& image, const DotGrid& dots, cv::Mat_<uchar>& mask) {
  const Colours frame = colours_of(image);
  GelFrame seen;
  const auto start = std::chrono::steady_clock::now();
  seen.contact = contact_(frame, mask, workspace_);
  seen.slide = slide_(workspace_.imprint(), workspace_.contact(), dots, slide_state_);
  const auto end = std::chrono::steady_clock::now();
  ms_.push_back(std::chrono::duration<double, std::milli>(end - start).count());
  seen.recoil = recoil_(dots, recoil_state_);
  seen.slip = limit_(fingerpad::ContactLoad<double>{}, seen.slide, limit_state_);
  return seen;
}

double SlideStep::median_ms() const {
  return median_of(ms_);
}

}  // namespace replay
