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

constexpr int first_frames = 3;                 // at most this many may show the free pad
constexpr double usual_dot_share = 14.0 / 640;  // of the frame's width

/// The image without a fourth channel.
cv::Mat colours_of(const cv::Mat& image) {
  cv::Mat colours = image;
  if (image.channels() == 4) {
    cv::cvtColor(image, colours, cv::COLOR_BGRA2BGR);
  }
  return colours;
}

std::vector<cv::Mat> colours_of(const std::vector<cv::Mat>& images) {
  std::vector<cv::Mat> all;
  for (const cv::Mat& image : images) {
    all.push_back(colours_of(image));
  }
  return all;
}

fingerpad::GelOptions options_of(const std::vector<cv::Mat>& free_frames, double dot_px) {
  const double usual = free_frames.empty() ? 14.0 : usual_dot_share * free_frames.front().cols;
  return gel_options_for(dot_px > 0 ? dot_px : usual);
}

/// The first frames, up to the first that shows a contact relative to frame 0.
std::vector<cv::Mat> free_first_frames(Recording& recording) {
  recording.frames.seek(0);
  std::vector<cv::Mat> frames = {next_frame(recording.frames, recording.reference.size())};
  fingerpad::GelContact contact(colours_of(frames));
  const int last = (std::min)(first_frames, recording.frames.size());
  for (int k = 1; k < last; ++k) {
    const cv::Mat frame = next_frame(recording.frames, recording.reference.size());
    if (contact(colours_of(frame)).in_contact()) {
      break;
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace

fingerpad::GelOptions gel_options_for(double dot_px) {
  fingerpad::GelOptions options;
  const double larger = dot_px / options.dot_px;  // than the default dots
  options.cell_px = (std::clamp)(cvRound(larger * options.cell_px), 1, 16);
  options.dot_px = dot_px;
  options.smoothing_px *= larger;
  options.max_gap_px *= larger;
  options.min_region_px = cvRound(larger * larger * options.min_region_px);
  return options;
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
    : options_(options_of(free_frames, dot_px)),
      contact_(colours_of(free_frames), options_),
      slide_(contact_.mask().rows,
             contact_.mask().cols,
             free_dots,
             {.cell_px = static_cast<double>(options_.cell_px)}) {}

GelFrame SlideStep::operator()(const cv::Mat& image, const DotGrid& dots, cv::Mat_<uchar>& mask) {
  const cv::Mat frame = colours_of(image);
  GelFrame seen;
  const auto start = std::chrono::steady_clock::now();
  seen.contact = contact_(frame);
  seen.slide = slide_(contact_.imprint(), contact_.mask(), dots);
  const auto end = std::chrono::steady_clock::now();
  ms_.push_back(std::chrono::duration<double, std::milli>(end - start).count());
  mask.create(frame.size());
  mask = 0;
  const cv::Rect whole({0, 0}, contact_.mask().size() * options_.cell_px);
  cv::resize(contact_.mask(), mask(whole), whole.size(), 0, 0, cv::INTER_NEAREST);
  seen.slip = limit_(fingerpad::ContactLoad<double>{}, seen.slide);
  return seen;
}

double SlideStep::median_ms() const {
  return median_of(ms_);
}

}  // namespace replay
