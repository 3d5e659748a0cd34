// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/gel/slide_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/median.hpp"
#include "fingerpad/adapt/opencv.hpp"

namespace replay {
namespace {

constexpr double usual_dot_share = 14.0 / 640;  // of the frame's width

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

fingerpad::GelOptions gel_options_of(int width_px, double dot_px, bool bright_dots) {
  fingerpad::GelOptions options = gel_options_for(dot_px > 0 ? dot_px : usual_dot_share * width_px);
  options.bright_dots = bright_dots;
  return options;
}

SlideStep::SlideStep(const std::vector<cv::Mat>& free_frames,
                     const DotGrid& free_dots,
                     double dot_px,
                     bool bright_dots)
    : options_(gel_options_of(
          free_frames.empty() ? 640 : free_frames.front().cols, dot_px, bright_dots)),
      contact_(free_frames, options_),
      slide_(contact_.mask().rows,
             contact_.mask().cols,
             free_dots,
             {.cell_px = static_cast<double>(options_.cell_px)}) {}

GelFrame SlideStep::operator()(const cv::Mat& image, const DotGrid& dots, cv::Mat_<uchar>& mask) {
  GelFrame seen;
  const auto start = std::chrono::steady_clock::now();
  seen.contact = contact_(image);
  if (seen.contact.ok()) {
    last_ = slide_(contact_.imprint(), contact_.mask(), dots);
  } else {  // what it shows is no contact: the slide stays
    last_.status = fingerpad::SlideStatus::no_edge;
  }
  seen.slide = last_;
  const auto end = std::chrono::steady_clock::now();
  ms_.push_back(std::chrono::duration<double, std::milli>(end - start).count());
  mask.create(image.size());
  mask = 0;
  const cv::Rect whole({0, 0}, contact_.mask().size() * options_.cell_px);
  cv::resize(contact_.mask(), mask(whole), whole.size(), 0, 0, cv::INTER_NEAREST);
  return seen;
}

double SlideStep::median_ms() const {
  return median_of(ms_);
}

}  // namespace replay
