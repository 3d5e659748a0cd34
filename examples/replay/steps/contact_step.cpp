// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/contact_step.hpp"

#include <memory>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/contact.hpp"

namespace replay {
namespace {

fingerpad::FreePadCurvature free_pad_curvature(Recording& recording, const DepthStep& depth_step) {
  const cv::Size size = recording.reference.size();
  fingerpad::FreePadCalibration<> calibration(recording.sensor.camera, size.height, size.width);
  if (recording.free_frames.size() == 0) {
    calibration.add(recording.reference_depth);
  }
  cv::Mat_<float> depth_mm(size);
  recording.free_frames.seek(0);
  for (int frame = 0; frame < recording.free_frames.size(); ++frame) {
    depth_step(next_frame(recording.free_frames, size), depth_mm);
    calibration.add(depth_mm);
  }
  return calibration.fit();
}

struct Chain {
  fingerpad::ContactRegion<> region;
  fingerpad::ContactRegion<>::Workspace workspace = region.workspace();
};

}  // namespace

ContactStep make_contact_step(Recording& recording, const DepthStep& depth_step) {
  fingerpad::ContactTest test;
  test.threshold_per_mm = free_pad_curvature(recording, depth_step).threshold_per_mm;
  test.free_apex_mm = recording.sensor.pad.apex_height_mm;
  const cv::Size size = recording.reference.size();
  // Shared, because a std::function is copied and a workspace should not be.
  const auto chain = std::make_shared<Chain>(
      Chain{fingerpad::ContactRegion<>(recording.sensor.camera, size.height, size.width, test)});
  return [chain](const cv::Mat_<float>& depth_mm, cv::Mat_<uchar>& mask) {
    return chain->region(depth_mm, mask, chain->workspace);
  };
}

}  // namespace replay
