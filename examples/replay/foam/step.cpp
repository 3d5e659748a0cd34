// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/step.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "fingerpad/calibrate/taxels.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "replay/io/failure.hpp"
#include "replay/median.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

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

/// Evaluates both rules; sensor.json selects which of them are reported.
struct Methods : fingerpad::FoamHandMethods {
  static constexpr bool has_grasp_optimise = true;
};

}  // namespace

std::string FoamAlarm::names() const {
  const std::string lift = fingerpad::GraspLift::name;
  const std::string optimise = fingerpad::GraspOptimise::name;
  return any() ? grasp_lift && grasp_optimise ? optimise + "+" + lift
                 : grasp_lift                 ? lift
                                              : optimise
               : "";
}

bool FoamRow::was_taken() const {
  return fingers.front().status != TaxelStatus::time_not_later;
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
    return sensor.quiet_until_s ? !(time_s > *sensor.quiet_until_s) : sample < first_windows;
  };
  try {
    fingerpad::TaxelNoiseCalibration calibration(first.rows(), first.cols(), sensor.taxels);
    for (int sample = 0; sample < recording.table.samples() && is_quiet(sample); ++sample) {
      calibration.add(recording.finger(sample, finger),
                      recording.table.times_s[static_cast<std::size_t>(sample)]);
    }
    const std::string until =
        sensor.quiet_until_s
            ? format("measured until %.4g s", *sensor.quiet_until_s)
            : format("measured in the first %.0f samples", static_cast<double>(first_windows)) +
                  ", which are assumed to be quiet";
    return {calibration.fit().deviations, until};
  } catch (const fingerpad::parameter_error& error) {  // the part is too short or has no noise
    if (sensor.quiet_until_s) {
      fail("sensor.json",
           "foam.quiet_until_s = " + format("%.4g", *sensor.quiet_until_s) + ": " + error.what());
    }
    const double noise = thousandth * largest_reading(recording);
    return {std::vector<double>(taxels, noise),
            "set to 1/1000 of the largest reading, because the first samples have no usable noise"};
  }
}

template <std::size_t Fingers>
FoamStep::Hand FoamStep::hand_of(const FoamRecording& recording,
                                 const std::vector<FoamNoise>& noise) {
  fingerpad::FoamHandOptions<Fingers> options;
  options.taxels = recording.sensor.taxels;
  options.rules = recording.sensor.rules;
  for (std::size_t f = 0; f < Fingers; ++f) {
    const auto size = recording.finger(0, static_cast<int>(f));
    options.arrays[f] = {size.rows(),
                         size.cols(),
                         {noise[f].deviations.data(), size.rows(), size.cols(), size.cols()}};
  }
  return [&recording, hand = fingerpad::FoamHand<Fingers, Methods>(options)](int sample,
                                                                             FoamRow& row) mutable {
    std::array<fingerpad::StridedView<const double>, Fingers> readings;
    for (std::size_t f = 0; f < Fingers; ++f) {
      readings[f] = recording.finger(sample, static_cast<int>(f));
    }
    const auto felt = hand(readings, recording.table.times_s[static_cast<std::size_t>(sample)]);
    row.fingers.assign(felt.fingers.begin(), felt.fingers.end());
    row.alarm = {recording.sensor.grasp_lift && felt.grasp_lift.is_fresh,
                 recording.sensor.grasp_optimise && felt.grasp_optimise.is_fresh};
  };
}

FoamStep::Hand FoamStep::make_hand(const FoamRecording& recording,
                                   const std::vector<FoamNoise>& noise) {
  static_assert(max_fingers == 5);
  switch (recording.fingers()) {
    case 1:
      return hand_of<1>(recording, noise);
    case 2:
      return hand_of<2>(recording, noise);
    case 3:
      return hand_of<3>(recording, noise);
    case 4:
      return hand_of<4>(recording, noise);
    default:
      return hand_of<5>(recording, noise);
  }
}

FoamStep::FoamStep(const FoamRecording& recording, const std::vector<FoamNoise>& noise)
    : recording_(recording), hand_(make_hand(recording, noise)) {}

FoamRow FoamStep::operator()(int sample) {
  const auto k = static_cast<std::size_t>(sample);
  FoamRow row{sample, recording_.table.frames[k], recording_.table.times[k], {}, {}};
  row.fingers.reserve(static_cast<std::size_t>(recording_.fingers()));
  const auto start = std::chrono::steady_clock::now();
  hand_(sample, row);
  const std::chrono::duration<double, std::micro> passed = std::chrono::steady_clock::now() - start;
  us_.push_back(passed.count());
  return row;
}

double FoamStep::median_us() const {
  return us_.empty() ? 0 : median_of(us_);
}

}  // namespace replay
