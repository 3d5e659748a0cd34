// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/depth_step.hpp"

#include <cstdint>
#include <memory>
#include <optional>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/published/depth.hpp"

namespace replay {
namespace {

using fingerpad::channel;

constexpr int green = 1;  // OpenCV stores blue, green, red
constexpr int red = 2;

auto reference_of(const Recording& recording) {
  const auto& camera = recording.sensor.camera;
  const auto& absorption = recording.sensor.absorption;
  const cv::Mat& frame = recording.reference;
  const cv::Mat_<float>& depth = recording.reference_depth;
  if (frame.depth() == CV_16U) {
    return fingerpad::fit_reference(camera, absorption, channel<std::uint16_t>(frame, red),
                                    channel<std::uint16_t>(frame, green), depth);
  }
  return fingerpad::fit_reference(camera, absorption, channel<std::uint8_t>(frame, red),
                                  channel<std::uint8_t>(frame, green), depth);
}

/// Light from the neighbouring membrane, taken off where the recording says how much it is.
class NeighbourLightStep {
 public:
  /// `free_depth_mm` is the depth of the free pad as the frames' depth will be: estimated alike.
  NeighbourLightStep(const Sensor& sensor, const cv::Mat_<float>& free_depth_mm) {
    const auto& given = *sensor.neighbour_light;
    const fingerpad::NeighbourLight<float> light{given.radius_px,
                                                 static_cast<float>(given.m0_mm_per_rad),
                                                 static_cast<float>(given.n_per_mm)};
    compensation_.emplace(light, pitch_on_membrane_mm(sensor.camera, free_depth_mm), free_depth_mm);
    workspace_.emplace(compensation_->workspace());
  }

  void operator()(cv::Mat_<float>& depth_mm) {
    (void)(*compensation_)(depth_mm, depth_mm, *workspace_);
  }

 private:
  using Compensation = fingerpad::NeighbourLightCompensation<>;

  /// Distance between the points that neighbouring pixels see at the pad's mean depth.
  static float pitch_on_membrane_mm(const fingerpad::Camera<double>& camera,
                                    const cv::Mat_<float>& free_depth_mm) {
    const cv::Mat known = free_depth_mm == free_depth_mm;  // NaN equals nothing
    const double mean_mm = cv::mean(free_depth_mm, known)[0];
    const auto x = [&](double col) {
      return fingerpad::point_at(camera, camera.center_y_px, col, mean_mm).x;
    };
    return static_cast<float>(x(camera.center_x_px + 1) - x(camera.center_x_px));
  }

  std::optional<Compensation> compensation_;
  std::optional<Compensation::Workspace> workspace_;
};

/// Everything that lives as long as the frames come.
template <class Estimator>
struct Chain {
  Estimator estimate;
  typename Estimator::template Workspace<std::uint8_t> for_8_bit;
  typename Estimator::template Workspace<std::uint16_t> for_16_bit;
  std::optional<NeighbourLightStep> neighbour_light;

  Chain(const Estimator& estimator, const Recording& recording)
      : estimate(estimator),
        for_8_bit(estimator.template workspace<std::uint8_t>()),
        for_16_bit(estimator.template workspace<std::uint16_t>()) {
    if (recording.sensor.neighbour_light) {
      cv::Mat_<float> free_depth_mm(recording.reference.size());
      (*this)(recording.reference, free_depth_mm);
      neighbour_light.emplace(recording.sensor, free_depth_mm);
    }
  }

  FrameDepth operator()(const cv::Mat& frame, cv::Mat_<float>& depth_mm) {
    const fingerpad::DepthResult result =
        frame.depth() == CV_16U
            ? estimate(channel<std::uint16_t>(frame, red), channel<std::uint16_t>(frame, green),
                       depth_mm, for_16_bit)
            : estimate(channel<std::uint8_t>(frame, red), channel<std::uint8_t>(frame, green),
                       depth_mm, for_8_bit);
    if (neighbour_light) {
      (*neighbour_light)(depth_mm);
    }
    return {result.valid_pixels(), result.pad_pixels,
            result.status == fingerpad::DepthStatus::pad_has_changed};
  }
};

template <class Policy>
DepthStep make_chain(const Recording& recording, Policy smoothing) {
  const fingerpad::DepthEstimator estimate(recording.sensor.camera, recording.sensor.absorption,
                                           reference_of(recording), smoothing);
  using Estimator = std::remove_const_t<decltype(estimate)>;
  // Shared, because a std::function is copied and a workspace should not be.
  const auto chain = std::make_shared<Chain<Estimator>>(estimate, recording);
  return [chain](const cv::Mat& frame, cv::Mat_<float>& depth_mm) {
    return (*chain)(frame, depth_mm);
  };
}

}  // namespace

DepthStep make_depth_step(const Recording& recording, Smoothing smoothing, int window_px) {
  switch (smoothing) {
    case Smoothing::none:
      return make_chain(recording, fingerpad::NoSmoothing{});
    case Smoothing::box:
      return make_chain(recording, fingerpad::published::BoxMean{window_px});
    case Smoothing::anchored:
      break;
  }
  return make_chain(recording, fingerpad::BiasFreeMean{window_px});
}

}  // namespace replay
