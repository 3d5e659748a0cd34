// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/median.hpp"

namespace replay {
namespace {

/// Empty for a dots-only recording, which does not need it.
std::unique_ptr<FingertipStep> fingertip_step_of(Recording& recording,
                                                 const Options& options,
                                                 const DotGrid& initial_px) {
  if (recording.sensor.dots_only) {
    return nullptr;
  }
  const int by_default = recording.sensor.smoothing_px.value_or(1);
  try {
    return make_fingertip_step(recording, options.smoothing_px.value_or(by_default), initial_px);
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

TractionStep traction_step_of(const Recording& recording, const Options& options) {
  try {
    return make_traction_step(recording);
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording / "stress_free_dots.csv", error.what());
  }
}

DotSource dots_of(Recording& recording, const Options& options) {
  if (recording.sensor.dots_only) {
    return DotSource::of_dots_only(options.recording, recording);
  }
  return DotSource(options.recording, recording.sensor, recording.reference,
                   recording.reference_depth, recording.frames.size());
}

/// NaN where there is no text.
double seconds(const std::string& text) {
  return text.empty() ? std::numeric_limits<double>::quiet_NaN()
                      : std::strtod(text.c_str(), nullptr);
}

/// Sets the summary values of the depth map in `scene`.
void describe_depth(Scene& scene) {
  double sum = 0;
  double top = -std::numeric_limits<double>::infinity();
  for (const float depth : scene.depth_mm) {
    if (std::isfinite(depth)) {
      sum += static_cast<double>(depth);
      top = (std::max)(top, static_cast<double>(depth));
    }
  }
  const fingerpad::DepthResult& depth = scene.touch.depth;
  const auto valid = static_cast<double>(depth.valid_pixels());
  scene.valid_share =
      valid / static_cast<double>((std::max)(depth.pad_pixels, fingerpad::Index{1}));
  scene.depth_mean_mm = valid > 0 ? sum / valid : not_known;
  scene.depth_max_mm = valid > 0 ? top : not_known;
}

}  // namespace

Chain::Chain(Recording& recording, const Options& options)
    : recording_(recording),
      dots_(dots_of(recording, options)),
      fingertip_(fingertip_step_of(recording, options, dots_.initial())),
      stick_(dots_.initial().size(), recording.sensor.stick),
      traction_(traction_step_of(recording, options)) {
  if (fingertip_) {
    pad_ = recording.reference_depth > 0;
    reference_step_ = std::max(1.0, step_between_blocks(recording.reference, pad_));
  }
}

void Chain::look(const DotGrid& dots_px, Scene& scene) {
  FingertipFrame seen =
      (*fingertip_)(scene.frame, scene.image, dots_px, dots_.side(), seconds(scene.time_s));
  scene.depth_mm = seen.depth_mm;
  scene.contact_mask = seen.contact_mask;
  scene.dots = std::move(seen.dots);
  scene.touch = seen.touch;
  scene.has_depth = true;
  const double step = std::max(1.0, step_between_blocks(scene.image, pad_));
  scene.picture_fault = saturated_share(scene.image, pad_) > most_saturated ? "saturated"
                        : step > worst_compressed_step ||
                                step > compressed_step * reference_step_ ||
                                reference_step_ > compressed_step * step
                            ? "compressed"
                            : nullptr;
  scene.has_rim = seen.has_rim;
  scene.has_curves = recording_.sensor.force.has_value();
  describe_depth(scene);
  frame_ms_.push_back(seen.frame_ms);
}

Scene Chain::operator()(int frame, const cv::Mat& image) {
  Scene scene;
  scene.frame = frame;
  scene.time_s = recording_.signals.time_s(frame);
  scene.pressure_mpa = recording_.signals.pressure_mpa(frame);
  if (const auto truth = recording_.true_forces.find(frame);
      truth != recording_.true_forces.end()) {
    scene.truth = truth->second;
  }
  scene.image = image;
  scene.has_dots = dots_.present();
  const DotGrid dots_px = dots_.of(frame, image);
  if (fingertip_) {
    look(dots_px, scene);
  } else if (dots_.present()) {
    scene.dots = stick_(dots_px, seconds(scene.time_s), scene.touch);
  }
  if (traction_ && dots_.present()) {
    scene.traction = traction_(scene.dots, scene.pressure_mpa);
  }
  return scene;
}

double Chain::frame_ms() const {
  return median_of(frame_ms_);
}

}  // namespace replay
