// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "chain.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "failure.hpp"

namespace replay {
namespace {

constexpr int published_window_px = 29;

using Milliseconds = std::chrono::duration<double, std::milli>;

DepthStep depth_step_of(const Recording& recording, const Options& options) {
  const auto window = recording.sensor.smoothing_px;
  const Smoothing by_default = window ? Smoothing::anchored : Smoothing::none;
  try {
    return make_depth_step(recording, options.smoothing.value_or(by_default),
                           window.value_or(published_window_px));
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

ContactStep contact_step_of(Recording& recording,
                            const DepthStep& depth_step,
                            const Options& options) {
  try {
    return make_contact_step(recording, depth_step);
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

/// What the pixels of a depth map say together.
void describe_depth(const FrameDepth& result, Scene& scene) {
  double sum = 0;
  double top = -std::numeric_limits<double>::infinity();
  for (const float depth : scene.depth_mm) {
    if (std::isfinite(depth)) {
      sum += static_cast<double>(depth);
      top = (std::max)(top, static_cast<double>(depth));
    }
  }
  const auto valid = static_cast<double>(result.valid_pixels);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  scene.valid_share =
      valid / static_cast<double>((std::max)(result.pad_pixels, fingerpad::Index{1}));
  scene.depth_mean_mm = valid > 0 ? sum / valid : none;
  scene.depth_max_mm = valid > 0 ? top : none;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Chain::Chain(Recording& recording, const Options& options)
    : recording_(recording),
      depth_(depth_step_of(recording, options)),
      contact_(contact_step_of(recording, depth_, options)),
      dots_(options.recording,
            recording.sensor,
            recording.reference,
            recording.reference_depth,
            recording.frames.size()),
      motion_(recording.sensor, dots_.initial(), recording.reference_depth) {}

Scene Chain::operator()(int frame, const cv::Mat& image) {
  Scene scene;
  scene.frame = frame;
  const auto time = recording_.times_s.find(frame);
  scene.time_s = time == recording_.times_s.end() ? "" : time->second;
  scene.image = image;
  scene.depth_mm.create(image.size());
  scene.contact_mask.create(image.size());
  const auto start = std::chrono::steady_clock::now();
  const FrameDepth depth = depth_(image, scene.depth_mm);
  const auto between = std::chrono::steady_clock::now();
  scene.contact = contact_(scene.depth_mm, scene.contact_mask);
  const auto end = std::chrono::steady_clock::now();
  depth_ms_.push_back(Milliseconds(between - start).count());
  contact_ms_.push_back(Milliseconds(end - between).count());
  if (dots_.present()) {
    scene.dots = motion_(dots_.of(frame, image), scene.depth_mm, scene.contact_mask);
  }
  describe_depth(depth, scene);
  return scene;
}

double Chain::depth_ms() const {
  return median(depth_ms_);
}
double Chain::contact_ms() const {
  return median(contact_ms_);
}

}  // namespace replay
