// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/step.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "fingerpad/calibrate/taxels.hpp"
#include "fingerpad/core/expects.hpp"

namespace replay {
namespace {

using fingerpad::FingerSample;
using fingerpad::TaxelStatus;

constexpr double thousandth = 1e-3;

/// Of all taxels; 0: there is none.
double largest_reading(const FoamRecording& recording) {
  double largest = 0;
  for (const double reading : recording.table.readings) {
    if (reading < recording.sensor.taxels.saturated_at) {
      largest = (std::max)(largest, reading);
    }
  }
  return largest;
}

template <class Rule, std::size_t Fingers>
class OneRule {
 public:
  explicit OneRule(const FoamSensor& sensor) : rule_(sensor.rules), state_(rule_.start()) {}

  bool operator()(const std::array<FingerSample<double>, Fingers>& newest) {
    return rule_(newest, state_).is_fresh;
  }

 private:
  using Preslip = fingerpad::Preslip<Rule, Fingers>;
  Preslip rule_;
  typename Preslip::State state_;
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
  if (const auto& noise = recording.sensor.noise) {
    return {std::vector<double>(taxels, *noise)};
  }
  try {
    fingerpad::TaxelNoiseCalibration calibration(first.rows(), first.cols(),
                                                   recording.sensor.taxels);
    for (int sample = 0; sample < recording.table.samples(); ++sample) {
      calibration.add(recording.finger(sample, finger),
                      recording.table.times_s[static_cast<std::size_t>(sample)]);
    }
    return {calibration.fit().deviations};
  } catch (const fingerpad::parameter_error&) {  // too short, or without any noise
    const double noise = thousandth * largest_reading(recording);
    return {std::vector<double>(taxels, noise), false};
  }
}

template <std::size_t Fingers>
FoamStep::Rules FoamStep::rules_of(const FoamSensor& sensor) {
  using namespace fingerpad;
  return [lift = OneRule<GraspLift, Fingers>(sensor),
          optimise = OneRule<GraspOptimise, Fingers>(sensor), with_lift = sensor.grasp_lift,
          with_optimise =
              sensor.grasp_optimise](const std::vector<FingerSample<double>>& fingers) mutable {
    std::array<FingerSample<double>, Fingers> newest;
    std::copy_n(fingers.begin(), Fingers, newest.begin());
    return FoamAlarm{with_lift && lift(newest), with_optimise && optimise(newest)};
  };
}

FoamStep::Rules FoamStep::make_rules(const FoamSensor& sensor) {
  static_assert(max_fingers == 5);
  switch (sensor.fingers.size()) {
    case 1:
      return rules_of<1>(sensor);
    case 2:
      return rules_of<2>(sensor);
    case 3:
      return rules_of<3>(sensor);
    case 4:
      return rules_of<4>(sensor);
    default:
      return rules_of<5>(sensor);
  }
}

FoamStep::FoamStep(const FoamRecording& recording, const std::vector<FoamNoise>& noise)
    : recording_(recording), rules_(make_rules(recording.sensor)) {
  for (int k = 0; k < recording.fingers(); ++k) {
    const auto size = recording.finger(0, k);
    const fingerpad::StridedView<const double> deviations(
        noise[static_cast<std::size_t>(k)].deviations.data(), size.rows(), size.cols(),
        size.cols());
    features_.emplace_back(deviations, recording.sensor.taxels);
    states_.push_back(features_.back().start());
  }
}

FoamRow FoamStep::operator()(int sample) {
  const auto k = static_cast<std::size_t>(sample);
  FoamRow row{sample, recording_.table.frames[k], recording_.table.times[k], {}, {}};
  row.fingers.resize(features_.size());
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t f = 0; f < features_.size(); ++f) {
    row.fingers[f] = features_[f](recording_.finger(sample, static_cast<int>(f)),
                                  recording_.table.times_s[k], states_[f]);
  }
  if (row.was_taken()) {  // all fingers have the same time
    row.alarm = rules_(row.fingers);
  }
  const std::chrono::duration<double, std::micro> passed = std::chrono::steady_clock::now() - start;
  us_.push_back(passed.count());
  return row;
}

double FoamStep::median_us() const {
  std::vector<double> sorted = us_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return middle == sorted.end() ? 0 : *middle;
}

}  // namespace replay
