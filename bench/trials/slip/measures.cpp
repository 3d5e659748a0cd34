// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/core.hpp>

#include "common/failure.hpp"
#include "common/median.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/dots/dots.hpp"
#include "replay/steps/stick_step.hpp"

namespace slip_trials {
namespace {

using replay::DotGrid;

constexpr double far_px = 2;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int quiet_frames = 5;      // at the beginning, for the noise
constexpr double false_slip = 0.01;  // probability that noise alone makes a dot slip

/// Displacement of each dot present in both frames, minus the median displacement.
std::vector<cv::Vec2d> moves_off_median(const DotGrid& from, const DotGrid& to) {
  std::vector<cv::Vec2d> moves;
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < from.rows; ++i) {
    for (int j = 0; j < from.cols; ++j) {
      const cv::Vec2d move = to(i, j) - from(i, j);
      if (replay::is_present(move)) {
        moves.push_back(move);
        x.push_back(move[0]);
        y.push_back(move[1]);
      }
    }
  }
  const cv::Vec2d common(replay::median_of(x), replay::median_of(y));
  for (cv::Vec2d& move : moves) {
    move -= common;
  }
  return moves;
}

double share_far_off(const DotGrid& first, const DotGrid& now) {
  const auto moves = moves_off_median(first, now);
  const auto far = std::count_if(moves.begin(), moves.end(),
                                 [](const cv::Vec2d& move) { return cv::norm(move) > far_px; });
  return moves.empty() ? none : static_cast<double>(far) / static_cast<double>(moves.size());
}

/// Standard deviation of a dot's coordinate, from the differences of successive first frames. Uses
/// the median, because some dots may already move.
double noise_px(const std::vector<DotGrid>& frames) {
  std::vector<double> sizes;
  const std::size_t last = (std::min)(frames.size(), std::size_t{quiet_frames});
  for (std::size_t k = 1; k < last; ++k) {
    for (const cv::Vec2d& move : moves_off_median(frames[k - 1], frames[k])) {
      sizes.push_back(std::abs(move[0]));
      sizes.push_back(std::abs(move[1]));
    }
  }
  constexpr double sd_of_median = 1.4826;
  return sizes.empty() ? 0.0 : sd_of_median * replay::median_of(sizes) / std::sqrt(2.0);
}

std::vector<double> ratios(const std::vector<DotGrid>& frames,
                           const fingerpad::StickOptions& options) {
  replay::StickStep step(frames.front().size(), options);
  std::vector<double> ratio;
  for (const DotGrid& dots : frames) {
    fingerpad::FingertipResult touch;
    (void)step(dots, none, touch);
    const auto& result = touch.stick;
    ratio.push_back(result.updated() ? result.stick_ratio : none);
  }
  return ratio;
}

struct Followed {
  std::vector<cv::Mat> images;
  std::vector<DotGrid> dots;
  double dot_px = 0;
};

Followed follow(const std::filesystem::path& file) {
  replay::Recording recording;
  recording.sensor.dots_only = true;
  recording.frames = std::filesystem::is_directory(file) ? replay::FrameSource::of_folder(file)
                                                         : replay::FrameSource::of_video(file);
  recording.frames.seek(0);
  recording.reference = recording.frames.next();
  replay::DotSource dots = replay::DotSource::of_dots_only(file, recording);
  Followed followed;
  followed.dot_px = dots.diameter_px();
  recording.frames.seek(0);
  for (int frame = 0; frame < recording.frames.size(); ++frame) {
    followed.images.push_back(next_frame(recording.frames, recording.reference.size()));
    followed.dots.push_back(dots.of(frame, followed.images.back()));
  }
  return followed;
}

/// Mean, minimum and number of the finite values in [first, last).
struct Mean {
  double mean = none;
  double lowest = none;
  std::size_t count = 0;
};
Mean mean_of(const std::vector<double>& values, std::size_t first, std::size_t last) {
  Mean result;
  double sum = 0;
  for (std::size_t k = first; k < (std::min)(last, values.size()); ++k) {
    if (std::isfinite(values[k])) {
      sum += values[k];
      ++result.count;
      result.lowest = std::fmin(result.lowest, values[k]);
    }
  }
  if (result.count > 0) {
    result.mean = sum / static_cast<double>(result.count);
  }
  return result;
}

double or_else(double value, double otherwise) {
  return std::isfinite(value) ? value : otherwise;
}

}  // namespace

View look_at(const std::filesystem::path& file, const std::vector<cv::Mat>& free_frames) {
  View view;
  try {
    const Followed followed = follow(file);
    const std::vector<DotGrid>& frames = followed.dots;
    // the contact is unknown, so every dot counts as in contact
    view.ratio = ratios(frames, {.covers_pattern = true});
    view.ratio_by_noise = ratios(frames, {.noise = noise_px(frames), .covers_pattern = true});
    for (const DotGrid& dots : frames) {
      view.moved_share.push_back(share_far_off(frames.front(), dots));
    }
    if (!free_frames.empty()) {
      view.slide = slide_in(followed.images, frames, followed.dot_px, free_frames);
    }
  } catch (const replay::Failure& failure) {
    view = {};
    view.fault = failure.what();
  }
  return view;
}

Measures mean_over(const std::vector<View>& views, int frames) {
  Measures all;
  const auto count = static_cast<double>(views.size());
  for (const View& view : views) {
    const auto last = static_cast<std::size_t>(frames);
    const Mean ratio = mean_of(view.ratio, 0, last);
    all.answers += ratio.count;
    all.ratio += or_else(ratio.mean, 1) / count;
    all.lowest += or_else(ratio.lowest, 1) / count;
    all.ratio_by_noise += or_else(mean_of(view.ratio_by_noise, 0, last).mean, 1) / count;
    all.moved_share += or_else(mean_of(view.moved_share, 0, last).mean, 0) / count;
  }
  return all;
}

std::vector<std::string> tenths_of(const std::vector<View>& views) {
  constexpr std::size_t parts = 10;
  std::vector<std::string> tenths;
  for (std::size_t part = 0; part < parts; ++part) {
    double sum = 0;
    std::size_t count = 0;
    for (const View& view : views) {
      const std::size_t size = view.ratio.size();
      const Mean ratio = mean_of(view.ratio, part * size / parts, (part + 1) * size / parts);
      sum += ratio.count > 0 ? ratio.mean * static_cast<double>(ratio.count) : 0.0;
      count += ratio.count;
    }
    char text[16] = "   -";
    if (count > 0) {
      std::snprintf(text, sizeof text, "%.2f", sum / static_cast<double>(count));
    }
    tenths.emplace_back(text);
  }
  return tenths;
}

}  // namespace slip_trials
