// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>

#include "replay/check/parts.hpp"
#include "replay/foam/step.hpp"

namespace replay {
namespace {

/// Changes of a taxel from sample to sample, over the whole recording.
struct TaxelChange {
  double sum = 0;
  double swapped_sum = 0;  ///< the sum with the two bytes of each reading exchanged
  double usual = 0;        ///< median of the changes
  bool whole = true;       ///< all readings are 16-bit integers
};

double swapped(double reading) {
  const auto word = static_cast<unsigned>(reading);
  return static_cast<double>(((word & 0xFFU) << 8U) | (word >> 8U));
}

TaxelChange change_of(const TaxelTable& table, std::size_t taxel) {
  TaxelChange change;
  std::vector<double> steps;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = taxel; k < table.readings.size(); k += table.taxels()) {
    const double now = table.readings[k];
    if (!std::isfinite(now)) {
      continue;
    }
    change.whole = change.whole && now == std::floor(now) && now >= 0 && now < 65536;
    if (std::isfinite(before)) {
      steps.push_back(std::abs(now - before));
      change.sum += steps.back();
      change.swapped_sum += change.whole ? std::abs(swapped(now) - swapped(before)) : 0;
    }
    before = now;
  }
  change.usual = steps.empty() ? 0 : median_of(steps);
  return change;
}

}  // namespace

void check_foam(const FoamRecording& recording, Findings& findings) {
  const TaxelTable& table = recording.table;
  check_clock("taxels.csv, time_s", "sample", table.times_s, findings);
  findings.insert(findings.end(), recording.told.begin(), recording.told.end());
  const fingerpad::TaxelOptions& taxels = recording.sensor.taxels;
  const double window_s = taxels.sample_period_s * static_cast<double>(taxels.window);
  if (window_s > 2) {
    findings.push_back({"taxels.csv, time_s",
                        "a window of " + std::to_string(taxels.window) + " samples takes " +
                            short_number(window_s) +
                            " s, and no rule warns before a whole one was quiet",
                        "Sample faster, or set foam.window to fewer samples, at least 4."});
  }
  bool whole = true;
  double sum = 0, swapped_sum = 0;
  std::vector<double> usual;
  for (std::size_t taxel = 0; taxel < table.taxels(); ++taxel) {
    const TaxelChange change = change_of(table, taxel);
    whole = whole && change.whole;
    sum += change.sum;
    swapped_sum += change.swapped_sum;
    usual.push_back(change.usual);
  }
  if (!(sum > 0)) {
    findings.push_back(
        {"taxels.csv, " + taxel_name(table, 0),
         std::to_string(table.taxels()) + " of " + std::to_string(table.taxels()) +
             " taxels never change",
         "Check whether they are dead, saturated or disconnected, or leave out their fingers."});
  }
  if (whole && swapped_sum < 0.1 * sum) {
    findings.push_back({"taxels.csv", "the readings jump, but not if their two bytes are swapped",
                        "Swap the two bytes of each reading."});
  } else {
    const double typical = median_of(usual);
    const auto worst = std::max_element(usual.begin(), usual.end());
    if (*worst > 30 * (std::max)(typical, 1.0)) {
      findings.push_back(
          {"taxels.csv, " + taxel_name(table, static_cast<std::size_t>(worst - usual.begin())),
           "the reading changes by " + short_number(*worst) +
               " from sample to sample, that of other taxels by " + short_number(typical),
           "Check for a loose contact, or leave out the finger of this taxel."});
    }
  }
  const double most =
      *std::max_element(table.readings.begin(), table.readings.end(),
                        [](double a, double b) { return a < b || (a != a && b == b); });
  if (recording.sensor.noise && most < *recording.sensor.noise) {
    findings.push_back({"sensor.json, foam.noise",
                        "the noise is " + short_number(*recording.sensor.noise) +
                            ", but no reading exceeds " + short_number(most),
                        "Give the noise in the unit of the readings."});
  }
  if (table.missing > 0) {
    findings.push_back({"taxels.csv",
                        std::to_string(table.missing) + " of " +
                            std::to_string(table.readings.size()) +
                            " readings are missing, and are left out",
                        "Check the cable, and whether the table was written completely."});
  }
  bool shakes = false;
  for (int finger = 0; finger < recording.fingers(); ++finger) {
    shakes = noise_of(recording, finger).shakes || shakes;  // throws Failure, as replay does
  }
  if (shakes) {
    findings.push_back({"taxels.csv",
                        "the array shakes in the first samples, where its noise is measured",
                        "Set foam.quiet_until_s in sensor.json to the end of a part in which "
                        "nothing shakes, or foam.noise."});
  }
}

}  // namespace replay
