// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/wrench_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/force/wrench.hpp"

namespace replay {
namespace {

constexpr double node_mm = 0.5;  // between the nodes of the height map

fingerpad::WrenchOptions<double> options_of(const Sensor& sensor) {
  fingerpad::WrenchOptions<double> options;
  options.base_radius_mm = sensor.pad.base_radius_mm;
  options.side_dot_length_mm = sensor.rim->side_dot_length_mm;
  return options;
}

fingerpad::OneRow row_of(const Sensor& sensor) {
  return {.stress_free_inclination_rad = sensor.rim->stress_free_inclination_rad};
}

/// Columns of the border in the order of their angle, in which Wrench tells the tensions.
std::vector<int> by_angle(const SpaceGrid& border_mm) {
  std::vector<std::pair<double, int>> columns;
  for (int k = 0; k < border_mm.cols; ++k) {
    const double angle = std::atan2(border_mm(0, k)[1], border_mm(0, k)[0]);
    columns.emplace_back(angle < 0 ? angle + 2 * CV_PI : angle, k);
  }
  std::sort(columns.begin(), columns.end());
  std::vector<int> order;
  for (const auto& [angle, column] : columns) {
    order.push_back(column);
  }
  return order;
}

/// An estimator and its memory.
template <class Estimator>
struct Chain {
  Estimator estimate;
  typename Estimator::Workspace workspace = estimate.workspace();

  template <class... Frame>
  fingerpad::WrenchResult<double> operator()(const Frame&... frame) {
    return estimate(frame..., workspace);
  }

  std::vector<RimTension> tension(const SpaceGrid& border_mm) const {
    std::vector<RimTension> all;
    fingerpad::Index k = 0;
    for (const int column : by_angle(border_mm)) {
      const cv::Vec3d& at = border_mm(0, column);
      all.push_back({{at[0], at[1], at[2]}, workspace.rim_tension(k++)});
    }
    return all;
  }
};

/// Everything that lives as long as the frames come.
class Forces {
 public:
  explicit Forces(const Recording& recording)
      : recording_(recording),
        no_dots_(recording.side_dots->border_mm.size(),
                 cv::Vec3d::all(std::numeric_limits<double>::quiet_NaN())),
        heights_(recording.reference.rows,
                 recording.reference.cols,
                 recording.sensor.camera,
                 recording.sensor.pad.base_radius_mm + 2 * node_mm,
                 node_mm),
        map_(heights_.map()),
        by_shape_{ByShape(recording.side_dots->border_mm,
                          options_of(recording.sensor),
                          {},
                          row_of(recording.sensor))} {
    const auto& modulus = recording.sensor.rim->membrane_modulus_n_per_mm;
    if (modulus) {
      fingerpad::KnownModulus given;
      given.modulus_n_per_mm = *modulus;
      by_modulus_.emplace(
          Chain<ByModulus>{ByModulus(recording.side_dots->border_mm, options_of(recording.sensor),
                                     given, row_of(recording.sensor))});
    }
  }

  WrenchFrame operator()(int frame,
                         const cv::Mat_<float>& depth_mm,
                         const cv::Mat_<uchar>& contact) {
    const SpaceGrid& border_mm = recording_.side_dots->border_mm;
    const auto found = recording_.side_dots->dots_mm.find(frame);
    const SpaceGrid& dots_mm =
        found == recording_.side_dots->dots_mm.end() ? no_dots_ : found->second;
    const double pressure_mpa = recording_.signals.pressure_mpa(frame);
    heights_(depth_mm, contact, map_);
    WrenchFrame out;
    out.present = true;
    out.result = by_shape_(map_, dots_mm, pressure_mpa);
    out.tension = by_shape_.tension(border_mm);
    if (by_modulus_ && (out.result.status == fingerpad::WrenchStatus::no_level_line ||
                        out.result.status == fingerpad::WrenchStatus::no_shape)) {
      out.result = (*by_modulus_)(map_, dots_mm, pressure_mpa);
      out.tension = by_modulus_->tension(border_mm);
      out.given_modulus = true;
    }
    return out;
  }

 private:
  using ByShape = fingerpad::Wrench<fingerpad::LeastSquares>;
  using ByModulus = fingerpad::Wrench<fingerpad::KnownModulus>;

  const Recording& recording_;
  SpaceGrid no_dots_;
  fingerpad::PadHeights<fingerpad::Camera<double>> heights_;
  fingerpad::PadHeights<>::Map map_;
  Chain<ByShape> by_shape_;
  std::optional<Chain<ByModulus>> by_modulus_;
};

}  // namespace

std::string lacking_for_wrench(const Recording& recording) {
  return recording.sensor.dots_only                ? "nothing is known but dots"
         : !recording.side_dots                    ? "there is no side_dots.csv"
         : recording.signals.pressures_mpa.empty() ? "signals.csv has no pressure"
         : !recording.sensor.rim                   ? "sensor.json has no rim"
                                                   : "";
}

WrenchStep make_wrench_step(const Recording& recording) {
  if (!lacking_for_wrench(recording).empty()) {
    return {};
  }
  // Shared, because a std::function is copied and a workspace should not be.
  const auto all = std::make_shared<Forces>(recording);
  return [all](int frame, const cv::Mat_<float>& depth_mm, const cv::Mat_<uchar>& contact) {
    return (*all)(frame, depth_mm, contact);
  };
}

}  // namespace replay
