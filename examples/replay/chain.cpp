// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/chain.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include "fingerpad/adapt/opencv.hpp"
#include "replay/io/failure.hpp"

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

ForceStep force_step_of(const Recording& recording,
                        const DotGrid& initial_px,
                        const Options& options) {
  if (recording.sensor.dots_only) {
    return {};
  }
  try {
    return make_force_step(recording, initial_px);
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

WrenchStep wrench_step_of(const Recording& recording, const Options& options) {
  try {
    return make_wrench_step(recording);
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
  scene.pad_has_changed = result.pad_has_changed;
  scene.depth_mean_mm = valid > 0 ? sum / valid : none;
  scene.depth_max_mm = valid > 0 ? top : none;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Thresholds that sensor.json gives in px, as the noise that has them; without them the default.
fingerpad::SpatialStickTest spatial_test_of(const Sensor& sensor) {
  const fingerpad::StickTest by_default, &given = sensor.stick;
  fingerpad::SpatialStickTest test;
  if (given.slip_px != by_default.slip_px || given.reference_px != by_default.reference_px) {
    // slip_px = 2 gain sigma sqrt(ln(1 / false_slip)), gain 0.416 by averaging over neighbours
    const double sigmas = 2 * 0.416 * std::sqrt(std::log(1 / test.false_slip));
    test.lateral_mm = given.slip_px * sensor.camera.pitch_mm / sigmas;
    test.slip_share = (std::min)(given.slip_px / given.reference_px, 0.5);
  }
  return test;
}

/// What the contact carries: by the six-axis force, without it by look-up.
fingerpad::ContactLoad<double> load_of(const Scene& scene) {
  if (scene.wrench.present && scene.wrench.result.ok()) {
    return contact_load(scene.wrench.result.force_n, scene.wrench.result.moment_n_mm,
                        scene.dots.dots_mm, scene.dots.in_contact);
  }
  const double arm_mm = 2.0 / 3 * std::sqrt(scene.contact.area_mm2 / std::numbers::pi);
  return {scene.force.normal_n, norm(scene.force.tangential_n), scene.force.moment_n_mm, arm_mm};
}

}  // namespace

Chain::Chain(Recording& recording, const Options& options)
    : recording_(recording),
      depth_(recording.sensor.dots_only ? DepthStep() : depth_step_of(recording, options)),
      contact_(recording.sensor.dots_only ? ContactStep()
                                          : contact_step_of(recording, depth_, options)),
      dots_(dots_of(recording, options)),
      stick_(dots_.initial().size(), recording.sensor.stick),
      spatial_stick_(recording.sensor.dots_only ? cv::Size() : dots_.initial().size(),
                     spatial_test_of(recording.sensor)),
      force_(force_step_of(recording, dots_.initial(), options)),
      wrench_(wrench_step_of(recording, options)),
      traction_(traction_step_of(recording, options)) {
  if (!recording.sensor.dots_only) {
    motion_.emplace(recording.sensor, dots_.initial(), recording.reference_depth);
  }
}

void Chain::measure_depth(Scene& scene) {
  scene.depth_mm.create(scene.image.size());
  scene.contact_mask.create(scene.image.size());
  const auto start = std::chrono::steady_clock::now();
  const FrameDepth depth = depth_(scene.image, scene.depth_mm);
  const auto between = std::chrono::steady_clock::now();
  scene.contact = contact_(scene.depth_mm, scene.contact_mask);
  const auto end = std::chrono::steady_clock::now();
  depth_ms_.push_back(Milliseconds(between - start).count());
  contact_ms_.push_back(Milliseconds(end - between).count());
  describe_depth(depth, scene);
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
  if (depth_) {
    measure_depth(scene);
  }
  if (dots_.present()) {
    const DotGrid dots_px = dots_.of(frame, image);
    const double time_s = seconds(scene.time_s);
    if (motion_) {
      scene.dots = motion_->place(dots_px, scene.depth_mm, scene.contact_mask);
      scene.dots.stick = spatial_stick_(scene.dots.dots_mm, scene.dots.in_contact, time_s);
    } else {
      scene.dots = dots_alone(dots_px);
      scene.dots.stick = stick_(dots_px, scene.dots.in_contact, time_s);
    }
  }
  if (force_) {
    scene.force = force_(scene.contact, scene.dots);
  }
  if (wrench_) {
    const auto start = std::chrono::steady_clock::now();
    scene.wrench = wrench_(frame, scene.depth_mm, scene.contact_mask);
    wrench_ms_.push_back(Milliseconds(std::chrono::steady_clock::now() - start).count());
  }
  if (motion_ && dots_.present()) {
    spatial_stick_.fuse(load_of(scene), scene.dots.stick);
    motion_->follow(scene.dots);
  }
  if (traction_ && dots_.present()) {
    scene.traction = traction_(scene.dots, scene.pressure_mpa);
  }
  return scene;
}

double Chain::depth_ms() const {
  return median(depth_ms_);
}
double Chain::contact_ms() const {
  return median(contact_ms_);
}
double Chain::wrench_ms() const {
  return median(wrench_ms_);
}

}  // namespace replay
