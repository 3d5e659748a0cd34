// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/fingertip_options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/membrane/free_pad.hpp"

namespace replay {
namespace {

using fingerpad::FingertipOptions;
using fingerpad::Point3;

fingerpad::DepthReference<float> reference_of(const Recording& recording) {
  return with_colors(recording.reference, [&](const auto& red, const auto& green) {
    return fingerpad::fit_reference(recording.sensor.camera, recording.sensor.absorption, red,
                                    green, recording.reference_depth,
                                    recording.sensor.light ? &*recording.sensor.light : nullptr);
  });
}

double threshold_of_shape(const Recording& recording) {
  const cv::Mat_<float>& shape_mm = recording.reference_depth;
  return fit_contact_threshold(recording.sensor.camera, std::vector{shape_mm}).threshold_per_mm;
}

/// A noise in px becomes one in mm. Without it, it is measured from frame to frame.
void set_stick(const Sensor& sensor, FingertipOptions& options) {
  options.stick.covers_pattern = sensor.stick.covers_pattern;
  options.stick.noise = sensor.stick.noise * sensor.camera.pitch_mm;
  options.friction.soft_object = sensor.soft_object;
}

void set_look_up(const ForceLookUp& given, FingertipOptions& options) {
  if (given.by_area) {
    options.force_of_area.emplace(*given.by_area);
  }
  if (given.by_depth) {
    options.force_of_depth.emplace(*given.by_depth);
  }
  if (given.shear) {
    options.shear.emplace(given.shear->map);
    options.shear_by_depth = given.shear->by == ContactMeasure::depth;
  }
}

/// Copies a grid into `cells` and returns a view of it.
fingerpad::StridedView<const Point3<double>> kept(const SpaceGrid& points,
                                                  std::vector<Point3<double>>& cells) {
  for (const cv::Vec3d& p : points) {
    cells.push_back({p[0], p[1], p[2]});
  }
  return {cells.data(), points.rows, points.cols, points.cols};
}

}  // namespace

FingertipSettings fingertip_settings(const Recording& recording, const DotGrid& free_dots_px) {
  const Sensor& sensor = recording.sensor;
  const cv::Mat_<float>& shape_mm = recording.reference_depth;
  FingertipSettings settings(
      FingertipOptions{sensor.camera, sensor.absorption, reference_of(recording)});
  FingertipOptions& options = settings.options;
  options.smoothing_px = sensor.smoothing_px.value_or(options.smoothing_px);
  if (sensor.contact) {
    options.contact.threshold_per_mm = sensor.contact->threshold_per_mm;
    options.contact.faint_per_mm = sensor.contact->faint_per_mm;
    options.contact.ring_px = sensor.contact->ring_px;
    // at least the default: the free pad does not show the error at the edge of a contact
    options.dot_depth_noise_mm =
        std::max(options.dot_depth_noise_mm, sensor.contact->depth_noise_mm.value_or(0));
  } else {
    options.contact.threshold_per_mm = threshold_of_shape(recording);
  }
  options.contact.free_apex_mm = sensor.pad.apex_height_mm;
  SpaceGrid dots_mm(free_dots_px.size());
  (void)fingerpad::spatial_dots(sensor.camera, free_dots_px, shape_mm, dots_mm);
  options.free_dots_mm = kept(dots_mm, settings.free_dots_mm);
  options.dot_radius_px = sensor.dots ? sensor.dots->diameter_mm / 2 / sensor.camera.pitch_mm : 0.0;
  set_stick(sensor, options);
  if (const auto& light = sensor.neighbour_light) {
    options.neighbour_light = {light->radius_px, static_cast<float>(light->m0_mm_per_rad),
                               static_cast<float>(light->n_per_mm)};
  }
  if (sensor.force) {
    set_look_up(*sensor.force, options);
  }
  for (const auto& row : sensor.rim ? sensor.rim->side_rows : std::vector<fingerpad::SideRow>()) {
    options.side_dots += row.count;
  }
  if (lacking_for_wrench(recording).empty() && (options.side_dots > 0 || !free_dots_px.empty())) {
    const double radius_mm = sensor.pad.base_radius_mm;
    options.wrench.emplace();
    options.wrench->cap = {radius_mm,
                           radius_mm * std::tan(*sensor.rim->stress_free_inclination_rad / 2),
                           sensor.rim->mooney_share};
    options.wrench->modulus_n_per_mm = *sensor.rim->membrane_modulus_n_per_mm;
    if (const auto sd = sensor.rim->membrane_modulus_sd_n_per_mm) {
      options.wrench->modulus_sd_share = (std::min)(*sd / options.wrench->modulus_n_per_mm, 1.0);
    }
    options.wrench->thickness_mm = sensor.rim->membrane_thickness_mm;
    options.wrench->full_scale_n = sensor.rim->full_scale_n;
  }
  return settings;
}

std::optional<double> free_pressure_mpa(const Recording& recording) {
  const auto& [radius_mm, height_mm] = recording.sensor.pad;
  const auto& rim = recording.sensor.rim;
  if (!rim || !rim->membrane_modulus_n_per_mm || !rim->stress_free_inclination_rad) {
    return std::nullopt;
  }
  const fingerpad::FreePad<double> pad(
      {radius_mm, radius_mm * std::tan(*rim->stress_free_inclination_rad / 2), rim->mooney_share});
  double low = 0, high = 1;  // per mm
  for (int step = 0; step < 40; ++step) {
    const double load = (low + high) / 2;
    const auto free = pad.rim(load);
    (free && free->apex_mm < height_mm ? low : high) = load;
  }
  return low * *rim->membrane_modulus_n_per_mm;
}

std::string fault_of_pressure(const Recording& recording) {
  const auto needed_mpa = free_pressure_mpa(recording);
  const auto& pressures = recording.signals.pressures_mpa;
  if (!needed_mpa || pressures.empty()) {
    return "";
  }
  double least_mpa = pressures.begin()->second;
  for (const auto& [frame, mpa] : pressures) {
    least_mpa = std::fmin(least_mpa, mpa);
  }
  constexpr double share = 0.08;   // what the height is known to allows so much
  constexpr double pressed = 0.5;  // more than a press adds
  const bool is_low = least_mpa < (1 - share) * *needed_mpa;
  if (!is_low && !(least_mpa > (1 + pressed) * *needed_mpa)) {
    return "";
  }
  char text[256];
  std::snprintf(text, sizeof text,
                "the lowest pressure is %.4f MPa, but the free pad needs %s %.4f MPa to be %.2f "
                "mm high (pad.apex_height_mm)",
                least_mpa, is_low ? "about" : "only", *needed_mpa,
                recording.sensor.pad.apex_height_mm);
  return text;
}

std::string lacking_for_wrench(const Recording& recording) {
  const auto& rim = recording.sensor.rim;
  return recording.sensor.dots_only          ? "the recording has dots only"
         : !rim                              ? "sensor.json has no section rim"
         : !rim->membrane_modulus_n_per_mm   ? "sensor.json has no rim.membrane_modulus_n_per_mm"
         : !rim->stress_free_inclination_rad ? "sensor.json has no rim.stress_free_inclination_rad"
         : recording.signals.pressures_mpa.empty() ? "signals.csv has no pressure"
                                                   : fault_of_pressure(recording);
}

}  // namespace replay
