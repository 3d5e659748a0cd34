// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/fingertip_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/pipeline/fingertip.hpp"
#include "replay/steps/fingertip_options.hpp"

namespace replay {
namespace {

using fingerpad::FingertipResult;

using fingerpad::FingertipOptions;

template <class View>
auto copy_of(const View& from) {
  cv::Mat_<fingerpad::cell_t<View>> to(static_cast<int>(from.rows()),
                                       static_cast<int>(from.cols()));
  for (int i = 0; i < to.rows; ++i) {
    for (int j = 0; j < to.cols; ++j) {
      to(i, j) = from(i, j);
    }
  }
  return to;
}

cv::Mat_<float> free_depth_of(FingertipOptions options, const cv::Mat& image) {
  options.depth_alone = true;
  RecordedFingertip fingertip(options);
  (void)fingertip(image);
  return copy_of(fingertip.last().depth_mm());
}

double contact_threshold_of(Recording& recording, const FingertipOptions& options) {
  const cv::Size size = recording.reference.size();
  std::vector<cv::Mat> frames;
  recording.free_frames.seek(0);
  DamagedFrames damaged;
  for (int k = 0; k < recording.free_frames.size(); ++k) {
    frames.push_back(next_whole_frame(recording.free_frames, size, damaged));
  }
  const std::vector<bool> usual = usually_exposed(frames);
  std::vector<cv::Mat_<float>> depths_mm;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (usual[k]) {
      depths_mm.push_back(free_depth_of(options, frames[k]));
    }
  }
  return fit_contact_threshold(recording.sensor.camera, depths_mm).threshold_per_mm;
}

class Step : public FingertipStep {
 public:
  Step(const Recording& recording, const FingertipOptions& options)
      : recording_(recording),
        with_dots_(options.free_dots_mm.rows() > 0),
        with_wrench_(options.wrench.has_value()),
        fingertip_(options) {}

  FingertipFrame operator()(int frame,
                            const cv::Mat& image,
                            const DotGrid& dots_px,
                            std::span<const fingerpad::Mark> side_dots,
                            double time_s) override {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const FingertipResult touch =
        fingertip_(image, dots_px, recording_.signals.pressure_mpa(frame), time_s, side_dots);
    FingertipFrame out;
    out.frame_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    out.depth_mm = copy_of(fingertip_.last().depth_mm());
    out.contact_mask = copy_of(fingertip_.last().contact_mask());
    if (with_dots_) {
      out.dots = dots_of(dots_px, touch);
    }
    out.has_rim = with_wrench_;
    out.touch = touch;
    return out;
  }

 private:
  FrameDots dots_of(const DotGrid& dots_px, const FingertipResult& touch) const {
    FrameDots dots;
    dots.dots_px = dots_px;
    dots.dots_mm.create(dots_px.size());
    dots.in_contact = copy_of(fingertip_.last().dots_in_contact());
    dots.states.create(dots_px.size());
    if (touch.stick.updated()) {
      dots.slips_mm.create(dots_px.size());
    }
    for (int i = 0; i < dots_px.rows; ++i) {
      for (int j = 0; j < dots_px.cols; ++j) {
        const auto& p = fingertip_.last().dots_mm()(i, j);
        dots.dots_mm(i, j) = {p.x, p.y, p.z};
        dots.states(i, j) = static_cast<uchar>(fingertip_.last().dot_states()(i, j));
        if (!dots.slips_mm.empty()) {
          const auto& slip = fingertip_.last().dot_slips()(i, j);
          dots.slips_mm(i, j) = {slip.x, slip.y};
        }
      }
    }
    return dots;
  }

  const Recording& recording_;
  bool with_dots_, with_wrench_;
  RecordedFingertip fingertip_;
};

}  // namespace

std::unique_ptr<FingertipStep> make_fingertip_step(Recording& recording,
                                                   int smoothing_px,
                                                   const DotGrid& initial_px) {
  const Sensor& sensor = recording.sensor;
  FingertipSettings settings = fingertip_settings(recording, initial_px);
  FingertipOptions& options = settings.options;
  options.sampling = 1;  // depth is written at every pixel
  options.smoothing_px = smoothing_px;
  cv::Mat_<float> free_depth_mm;
  if (const auto light = std::exchange(options.neighbour_light, std::nullopt)) {
    free_depth_mm = free_depth_of(options, recording.reference);
    options.neighbour_light = light;
    options.free_depth_mm = fingerpad::as_view(std::as_const(free_depth_mm));
  }
  if (!sensor.contact && recording.free_frames.size() > 0) {
    options.contact.threshold_per_mm = contact_threshold_of(recording, options);
  }
  options.flat_area = true;  // written without a curve too, so that one can be fitted
  return std::make_unique<Step>(recording, options);
}

}  // namespace replay
