// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "measures.hpp"

#include <limits>
#include <opencv2/core.hpp>

#include "common/failure.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/dots/dots.hpp"
#include "replay/steps/stick_step.hpp"

namespace slip_trials {
namespace {

using replay::DotGrid;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

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
  DotGrid free_dots;
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
  followed.free_dots = dots.initial();
  followed.dot_px = dots.diameter_px();
  recording.frames.seek(0);
  for (int frame = 0; frame < recording.frames.size(); ++frame) {
    followed.images.push_back(next_frame(recording.frames, recording.reference.size()));
    followed.dots.push_back(dots.of(frame, followed.images.back()));
  }
  return followed;
}

}  // namespace

View look_at(const std::filesystem::path& file, const std::vector<cv::Mat>& free_frames) {
  View view;
  try {
    const Followed followed = follow(file);
    const std::vector<DotGrid>& frames = followed.dots;
    // the contact is unknown, so every dot counts as in contact
    view.ratio = ratios(frames, {.covers_pattern = true});
    if (!free_frames.empty()) {
      view.slide =
          slide_in(followed.images, frames, followed.free_dots, followed.dot_px, free_frames);
    }
  } catch (const replay::Failure& failure) {
    view = {};
    view.fault = failure.what();
  }
  return view;
}

}  // namespace slip_trials
