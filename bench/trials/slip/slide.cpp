// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "slide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/median.hpp"
#include "common/recording.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "replay/gel/slide_step.hpp"

namespace slip_trials {
namespace {

using replay::DotGrid;

constexpr std::size_t free_count = 3;  // number of candidates that agree best
constexpr double gone = 0.1;  // share of the largest area so far, below which contact is lost

cv::Mat last_frame(const std::filesystem::path& folder) {
  auto frames = std::filesystem::is_directory(folder) ? replay::FrameSource::of_folder(folder)
                                                      : replay::FrameSource::of_video(folder);
  frames.seek(frames.size() - 1);
  return frames.next();
}

/// RMS difference of `other` from `free` over the frame.
double difference(const cv::Mat& free, const cv::Mat& other) {
  fingerpad::GelContact contact(std::vector{free});
  if (contact(other).status == fingerpad::FrameStatus::refused) {
    return std::numeric_limits<double>::infinity();
  }
  const cv::Mat known = contact.difference() == contact.difference();  // not NaN
  return cv::norm(contact.difference(), cv::NORM_L2, known) / std::sqrt(cv::countNonZero(known));
}

std::vector<cv::Mat> last_frames(const Trial& trial, const std::vector<Trial>& trials) {
  const auto is_other = [&](const Trial& other) { return other.object != trial.object; };
  const bool other_objects = std::any_of(trials.begin(), trials.end(), [&](const Trial& other) {
    return other.slips && is_other(other);
  });
  std::vector<cv::Mat> frames;
  for (const Trial& other : trials) {
    if (other.slips && (other_objects ? is_other(other) : other.name != trial.name)) {
      frames.push_back(last_frame(other.views.front()));
    }
  }
  return frames;
}

/// The frames nearest to the most typical frame. A trial may end before the pad is free, so some
/// frames are outliers.
std::vector<cv::Mat> agreeing(const std::vector<cv::Mat>& frames) {
  double best = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t a = 0; a < frames.size(); ++a) {
    std::vector<double> all;
    std::vector<std::pair<double, std::size_t>> from;
    for (std::size_t b = 0; b < frames.size(); ++b) {
      all.push_back(a == b ? 0.0 : difference(frames[a], frames[b]));
      from.emplace_back(all.back(), b);
    }
    const double typical = replay::median_of(all);
    if (typical < best) {
      best = typical;
      order = from;
    }
  }
  std::sort(order.begin(), order.end());
  std::vector<cv::Mat> chosen;
  for (std::size_t k = 0; k < (std::min)(free_count, order.size()); ++k) {
    chosen.push_back(frames[order[k].second]);
  }
  return chosen;
}

}  // namespace

std::vector<cv::Mat> free_frames_for(const Trial& trial, const std::vector<Trial>& trials) {
  if (trial.free.empty()) {
    return agreeing(last_frames(trial, trials));
  }
  auto source = replay::FrameSource::of_folder(trial.free);
  source.seek(0);
  std::vector<cv::Mat> frames;
  while (static_cast<int>(frames.size()) < source.size()) {
    frames.push_back(source.next());
  }
  return frames;
}

SlideSeries slide_in(const std::vector<cv::Mat>& frames,
                     const std::vector<DotGrid>& dots,
                     const DotGrid& free_dots,
                     double dot_px,
                     const std::vector<cv::Mat>& free_frames) {
  replay::SlideStep step(free_frames, free_dots, dot_px);
  cv::Mat_<std::uint8_t> mask(frames.front().size());
  SlideSeries series;
  series.end = frames.size();
  int largest = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto seen = step(frames[k], dots[k], mask);
    series.slide.push_back(seen.slide.slide);
    series.lost.push_back(seen.slide.lost);
    series.evidence.push_back(seen.slide.evidence);
    largest = (std::max)(largest, seen.contact.contact_px);
    if (static_cast<double>(seen.contact.contact_px) < gone * static_cast<double>(largest)) {
      series.end = (std::min)(series.end, k);
    }
  }
  return series;
}

}  // namespace slip_trials
