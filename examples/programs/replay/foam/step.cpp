// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/failure.hpp"
#include "common/median.hpp"
#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/core/check.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

using fingerpad::PreslipRule;
using fingerpad::PreslipStatus;
using fingerpad::TaxelStatus;

constexpr double thousandth = 1e-3;

/// Largest reading below saturation, at least 0.
double largest_reading(const FoamRecording& recording) {
  double largest = 0;
  for (const double reading : recording.table.readings) {
    if (reading < recording.sensor.taxels.saturated_at) {
      largest = (std::max)(largest, reading);
    }
  }
  return largest;
}

std::vector<fingerpad::TaxelFeatures<>> fingers_of(const FoamRecording& recording,
                                                   const std::vector<FoamNoise>& noise) {
  std::vector<fingerpad::TaxelFeatures<>> fingers;
  fingerpad::TaxelOptions options = recording.sensor.taxels;
  options.saturated_at = 1e9;  // readings_of() leaves out the saturated ones
  for (std::size_t f = 0; f < noise.size(); ++f) {
    const auto size = recording.finger(0, static_cast<int>(f));
    std::vector<double> noise_n;
    std::vector<fingerpad::Point2<double>> places_mm;
    for (const double deviation : noise[f].deviations) {
      const auto k = static_cast<fingerpad::Index>(noise_n.size());
      const std::size_t taxel = recording.taxel_of(static_cast<int>(f), k);
      noise_n.push_back(deviation * recording.newtons_of(taxel));
      if (!recording.sensor.places_mm.empty()) {
        places_mm.push_back(recording.sensor.places_mm[taxel]);
      }
    }
    fingers.emplace_back(size.rows(), size.cols(), options, noise_n, places_mm);
  }
  return fingers;
}

/// The readings of a finger, in N where newton_per_unit is known; NaN where saturated.
auto readings_of(const FoamRecording& recording, int sample, int finger) {
  const auto counts = recording.finger(sample, finger);
  return fingerpad::LazyView(counts.rows(), counts.cols(),
                             [&recording, counts, finger](fingerpad::Index i, fingerpad::Index j) {
                               const std::size_t taxel =
                                   recording.taxel_of(finger, i * counts.cols() + j);
                               const double reading = counts(i, j);
                               return reading < recording.sensor.taxels.saturated_at
                                          ? reading * recording.newtons_of(taxel)
                                          : std::nan("");
                             });
}

fingerpad::PreslipOptions with(PreslipRule rule, fingerpad::PreslipOptions options) {
  options.rule = rule;
  return options;
}

}  // namespace

std::string FoamAlarm::names() const {
  std::string names = grasp_optimise ? name_of(PreslipRule::grasp_optimise) : "";
  if (grasp_lift) {
    names += grasp_optimise ? "+" : "";
    names += name_of(PreslipRule::grasp_lift);
  }
  return names;
}

bool FoamRow::was_taken() const {
  return fingers.front().status != TaxelStatus::refused;
}

FoamNoise noise_of(const FoamRecording& recording, int finger) {
  const auto first = recording.finger(0, finger);
  const auto taxels = static_cast<std::size_t>(first.rows() * first.cols());
  const FoamSensor& sensor = recording.sensor;
  if (sensor.noise) {
    return {std::vector<double>(taxels, *sensor.noise), "from sensor.json"};
  }
  const auto first_windows = static_cast<int>(4 * sensor.taxels.window);
  const auto is_quiet = [&](int sample) {
    const double time_s = recording.table.times_s[static_cast<std::size_t>(sample)];
    return sensor.quiet_until_s ? !(time_s > recording.seconds_in(*sensor.quiet_until_s))
                                : sample < first_windows;
  };
  // What the taxels have in common is no noise where it would count as a vibration by the rest.
  const double factor = sensor.taxels.noise_factor;
  const double most_shared = factor > 1 ? 1 - 1 / (factor * factor) : 1;
  const auto measured = [&](const auto& is_used) {
    fingerpad::TaxelNoiseCalibration calibration(first.rows(), first.cols(), sensor.taxels);
    for (int sample = 0; sample < recording.table.samples() && is_used(sample); ++sample) {
      calibration.add(recording.finger(sample, finger),
                      recording.table.times_s[static_cast<std::size_t>(sample)]);
    }
    return calibration.fit();
  };
  bool shakes = false;
  std::string why;
  try {
    const auto fit = measured(is_quiet);
    shakes = fit.shared > most_shared;
    why = shakes ? fit.cause : "";
    if (!shakes) {
      return {fit.deviations, sensor.quiet_until_s
                                  ? format("measured until %.4g s", *sensor.quiet_until_s)
                                  : format("measured in the first %.0f samples",
                                           static_cast<double>(first_windows)) +
                                        ", which are assumed to be quiet"};
    }
  } catch (const fingerpad::parameter_error& error) {  // the part is too short or has no noise
    why = error.what();
  }
  if (sensor.quiet_until_s) {
    fail("sensor.json",
         "foam.quiet_until_s = " + format("%.4g", *sensor.quiet_until_s) + ": " + why);
  }
  const std::string because = shakes ? ", because the array shakes in the first samples"
                                     : ", because the first samples have no usable noise";
  try {
    const auto fit = measured([](int) { return true; });
    if (!(fit.shared > most_shared)) {
      return {fit.deviations, "measured in the whole recording" + because, shakes};
    }
  } catch (const fingerpad::parameter_error&) {
  }
  const double noise = thousandth * largest_reading(recording);
  return {std::vector<double>(taxels, noise), "set to 1/1000 of the largest reading" + because,
          shakes};
}

FoamStep::FoamStep(const FoamRecording& recording, const std::vector<FoamNoise>& noise)
    : recording_(recording),
      hand_(fingers_of(recording, noise), with(PreslipRule::grasp_lift, recording.sensor.rules)),
      optimise_(recording.fingers(), with(PreslipRule::grasp_optimise, recording.sensor.rules)) {}

FoamRow FoamStep::operator()(int sample) {
  const auto k = static_cast<std::size_t>(sample);
  FoamRow row{sample, recording_.table.frames[k], recording_.table.times[k], {}, {}};
  std::vector<decltype(readings_of(recording_, sample, 0))> readings;
  for (int f = 0; f < recording_.fingers(); ++f) {
    readings.push_back(readings_of(recording_, sample, f));
  }
  const auto start = std::chrono::steady_clock::now();
  const PreslipStatus lift = hand_(readings, recording_.table.times_s[k]);
  const PreslipStatus optimise = optimise_(hand_.fingers());
  const std::chrono::duration<double, std::micro> passed = std::chrono::steady_clock::now() - start;
  us_.push_back(passed.count());
  row.fingers.assign(hand_.fingers().begin(), hand_.fingers().end());
  row.alarm = {recording_.sensor.grasp_lift && lift == PreslipStatus::preslip,
               recording_.sensor.grasp_optimise && optimise == PreslipStatus::preslip};
  return row;
}

double FoamStep::median_us() const {
  return us_.empty() ? 0 : median_of(us_);
}

}  // namespace replay
