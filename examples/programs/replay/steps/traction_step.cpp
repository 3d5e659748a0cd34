// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/traction_step.hpp"

#include <memory>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/force/traction.hpp"

namespace replay {
TractionStep make_traction_step(const Recording& recording) {
  if (!recording.stress_free_dots) {
    return {};
  }
  fingerpad::TractionOptions<> options;
  if (recording.sensor.rim) {
    options.mooney_share = recording.sensor.rim->mooney_share;
  }
  // Shared, so that copies of the std::function do not copy the maps.
  const auto field =
      std::make_shared<fingerpad::TractionField<>>(*recording.stress_free_dots, options);
  return [field](const FrameDots& dots, double pressure_mpa) {
    TractionFrame frame;
    frame.result = (*field)(dots.dots_mm, dots.in_contact, pressure_mpa);
    if (frame.result.status != fingerpad::TractionStatus::refused) {
      frame.pressure_mpa.create(dots.dots_px.size());
      frame.shear_mpa.create(dots.dots_px.size());
      for (int i = 0; i < dots.dots_px.rows; ++i) {
        for (int j = 0; j < dots.dots_px.cols; ++j) {
          const auto& shear = field->shear_mpa()(i, j);
          frame.pressure_mpa(i, j) = field->pressure_mpa()(i, j);
          frame.shear_mpa(i, j) = {shear.x, shear.y, shear.z};
        }
      }
    }
    return frame;
  };
}

}  // namespace replay
