// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>

#include "replay/check/parts.hpp"

namespace replay {
namespace {

/// Changes of a taxel from sample to sample, over the whole recording.
struct TaxelChange {
  double sum = 0;
  double swapped_sum = 0;  ///< the sum with the two bytes of each reading exchanged
  double usual = 0;        ///< median of the changes
  std::size_t still_from = 0, still_to = 0;  ///< the samples of the longest run of equal readings
  bool whole = true;                         ///< all readings are 16-bit integers
};

double swapped(double reading) {
  const auto word = static_cast<unsigned>(reading);
  return static_cast<double>(((word & 0xFFU) << 8U) | (word >> 8U));
}

TaxelChange change_of(const TaxelTable& table, std::size_t taxel) {
  TaxelChange change;
  std::vector<double> steps;
  double before = std::numeric_limits<double>::quiet_NaN();
  std::size_t since = 0;
  for (std::size_t k = taxel; k < table.readings.size(); k += table.taxels()) {
    const double now = table.readings[k];
    const std::size_t sample = k / table.taxels();
    since = now < before || now > before || !std::isfinite(now) ? sample : since;
    if (sample + 1 - since > change.still_to - change.still_from) {
      change.still_from = since;
      change.still_to = sample + 1;
    }
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

/// Largest reading less the smallest of a taxel in some samples.
double range_of(const TaxelTable& table, std::size_t taxel, std::size_t from, std::size_t to) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t sample = from; sample < to; ++sample) {
    const double reading = table.readings[sample * table.taxels() + taxel];
    least = std::fmin(least, reading);
    most = std::fmax(most, reading);
  }
  return most > least ? most - least : 0;
}

/// Whether all taxels beside one are pressed or let go in these samples, so that it should
/// change, too.
bool should_change(
    const TaxelTable& table, std::size_t taxel, std::size_t from, std::size_t to, double pressed) {
  const int row = static_cast<int>(taxel) / table.cols, col = static_cast<int>(taxel) % table.cols;
  bool all = true;
  for (const auto& [i, j] :
       {std::pair(row - 1, col), {row + 1, col}, {row, col - 1}, {row, col + 1}}) {
    if (i >= 0 && j >= 0 && i < table.rows && j < table.cols) {
      const auto beside = static_cast<std::size_t>(i * table.cols + j);
      all = all && range_of(table, beside, from, to) > pressed;
    }
  }
  return all;
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
  std::size_t still = 0, first_still = 0;
  double most_pressed = 0, largest = 0;
  for (std::size_t taxel = 0; taxel < table.taxels(); ++taxel) {
    most_pressed = std::fmax(most_pressed, range_of(table, taxel, 0, table.frames.size()));
  }
  for (const double reading : table.readings) {
    largest = std::fmax(largest, reading);
  }
  bool whole = true;
  double sum = 0, swapped_sum = 0;
  std::vector<double> usual;
  for (std::size_t taxel = 0; taxel < table.taxels(); ++taxel) {
    const TaxelChange change = change_of(table, taxel);
    constexpr std::size_t shortest = 60;  // samples, in which a taxel that is held still may rest
    const std::size_t from = change.still_from, to = change.still_to;
    const bool never = !(change.sum > 0);
    if (!(most_pressed > 0) || ((never || to - from >= shortest) &&
                                should_change(table, taxel, from, to, 0.05 * largest))) {
      first_still = still == 0 ? taxel : first_still;
      ++still;
    }
    whole = whole && change.whole;
    sum += change.sum;
    swapped_sum += change.swapped_sum;
    usual.push_back(change.usual);
  }
  if (still > 0) {
    findings.push_back(
        {"taxels.csv, " + taxel_name(table, first_still),
         std::to_string(still) + " of " + std::to_string(table.taxels()) +
             (most_pressed > 0 ? " taxels do not change while those beside them do"
                               : " taxels never change"),
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
}

}  // namespace replay
