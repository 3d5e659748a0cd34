// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/faults.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/failure.hpp"
#include "common/median.hpp"

namespace replay {
namespace {

using Values = std::vector<double>;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Adds one line for all taxels for which something was `counted`.
void tell(FoamRecording& recording,
          const std::vector<int>& counted,
          const std::string& what,
          const std::string& remedy) {
  const auto first = std::find_if(counted.begin(), counted.end(), [](int n) { return n > 0; });
  if (first != counted.end()) {
    const auto taxels = std::count_if(first, counted.end(), [](int n) { return n > 0; });
    recording.told.push_back(
        {"taxels.csv, " +
             taxel_name(recording.table, static_cast<std::size_t>(first - counted.begin())),
         std::to_string(std::accumulate(first, counted.end(), 0)) + " readings of " +
             std::to_string(taxels) + (taxels == 1 ? " taxel " : " taxels ") + what,
         remedy});
  }
}

/// Takes the largest number of a counter of 8 to 16 bit, if it is read often, for the full scale.
void find_full_scale(FoamRecording& recording) {
  TaxelTable& table = recording.table;
  double& full = recording.sensor.taxels.saturated_at;
  double most = 0;
  bool whole = true;
  for (const double reading : table.readings) {
    most = std::fmax(most, reading);
    whole = whole && !(std::isfinite(reading) && reading != std::floor(reading));
  }
  const double bits = std::log2(most + 1);
  constexpr int often = 4;
  if (full >= 1e9 && whole && bits >= 8 && bits <= 16 && bits == std::floor(bits) &&
      std::count(table.readings.begin(), table.readings.end(), most) >= often) {
    full = most;
  }
  std::vector<int> counted(table.taxels(), 0);
  for (std::size_t k = 0; k < table.readings.size(); ++k) {
    counted[k % table.taxels()] += table.readings[k] >= full ? 1 : 0;
  }
  tell(recording, counted, "are at full scale, " + number(full) + ", and are left out",
       "Press less, or lower the gain of the array.");
}

double largest_reading(const TaxelTable& table) {
  return std::accumulate(table.readings.begin(), table.readings.end(), 0.0,
                         [](double a, double b) { return std::fmax(a, b); });
}

/// Leaves out single readings far from those before and after, which agree.
void leave_out_spikes(FoamRecording& recording) {
  TaxelTable& table = recording.table;
  const std::size_t n = table.taxels(), samples = table.frames.size();
  const Values& all = table.readings;
  std::vector<int> counted(n, 0);
  Values usual;
  for (std::size_t k = 0; k < all.size(); k += n) {
    const auto row = all.begin() + static_cast<std::ptrdiff_t>(k);
    usual.push_back(std::accumulate(row, row + static_cast<std::ptrdiff_t>(n), 0.0,
                                    [](double a, double b) { return std::fmax(a, b); }));
  }
  const double far = median_of(usual) / 2;  // of the largest reading of a sample
  for (std::size_t taxel = 0; taxel < n; ++taxel) {
    Values steps;
    for (std::size_t k = taxel + n; k < all.size(); k += n) {
      if (std::isfinite(all[k] - all[k - n])) {
        steps.push_back(std::abs(all[k] - all[k - n]));
      }
    }
    const double least = std::fmax(far, steps.empty() ? 0 : 20 * median_of(steps));
    for (std::size_t sample = 2; sample + 2 < samples && least > 0; ++sample) {
      const std::size_t at = sample * n + taxel;
      const auto [low, high] =
          std::minmax({all[at - 2 * n], all[at - n], all[at + n], all[at + 2 * n]});
      if (high - low < least / 4 && (all[at] > high + least || all[at] < low - least)) {
        table.readings[at] = std::numeric_limits<double>::quiet_NaN();
        ++counted[taxel];
      }
    }
  }
  tell(recording, counted, "are spikes of one sample, and are left out",
       "Check for loose contacts and for noise on the cable.");
}

/// Means of each taxel over samples; 0 for a taxel without a reading.
Values means_of(const TaxelTable& table, const std::vector<std::size_t>& samples) {
  Values sums(table.taxels(), 0), counts(table.taxels(), 0);
  for (const std::size_t sample : samples) {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const double reading = table.readings[sample * sums.size() + k];
      sums[k] += std::isfinite(reading) ? reading : 0;
      counts[k] += std::isfinite(reading) ? 1 : 0;
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k) {
    sums[k] /= std::fmax(counts[k], 1);
  }
  return sums;
}

/// The line y = offset + slope x.
struct Line {
  double offset = 0, offset_sd = 0, correlation = 0;
};

Line line_through(const Values& x, const Values& y) {
  const auto n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mx) * (x[k] - mx);
    xy += (x[k] - mx) * (y[k] - my);
    yy += (y[k] - my) * (y[k] - my);
  }
  if (!(xx > 0 && yy > 0 && n > 3)) {
    return {};
  }
  const double residual = std::fmax(yy - xy * xy / xx, 0) / (n - 2);
  return {my - xy / xx * mx, std::sqrt(residual * (1 / n + mx * mx / xx)), xy / std::sqrt(xx * yy)};
}

double sum_of(const Values& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

void take_off(FoamRecording& recording, const Values& zero, const std::string& when) {
  TaxelTable& table = recording.table;
  for (std::size_t k = 0; k < table.readings.size(); ++k) {
    const bool is_full = table.readings[k] >= recording.sensor.taxels.saturated_at;
    table.readings[k] -= is_full ? 0 : zero[k % zero.size()];
  }
  const auto [least, most] = std::minmax_element(zero.begin(), zero.end());
  recording.told.push_back({"taxels.csv",
                            "the taxels read " + number(*least) + " to " + number(*most) + " " +
                                when + ", and this is taken off",
                            "Set foam.free_until_s in sensor.json if an object was held then.",
                            false});
}

/// Takes off, in proportion to time, what the zero moves from the first samples, which are free, to
/// as many at the end, if nothing touches the array there: the readings have changed little against
/// the `load`, and in another way.
void take_off_drift(FoamRecording& recording,
                    std::size_t free_ones,
                    const Values& load,
                    double noise) {
  TaxelTable& table = recording.table;
  const std::size_t n = table.taxels(), samples = table.frames.size();
  std::vector<std::size_t> first(free_ones), last(free_ones);
  std::iota(first.begin(), first.end(), std::size_t{0});
  std::iota(last.begin(), last.end(), samples - free_ones);
  const Values before = means_of(table, first);
  Values drift = means_of(table, last);
  double most = 0;
  for (std::size_t k = 0; k < n; ++k) {
    drift[k] -= before[k];
    most = std::fmax(most, std::abs(drift[k]));
  }
  const double largest = *std::max_element(load.begin(), load.end());
  if (!(most > std::fmax(3 * noise, 0.01 * largest) && most < 0.2 * largest &&
        std::abs(line_through(load, drift).correlation) < 0.5)) {
    return;
  }
  for (std::size_t k = 0; k < table.readings.size(); ++k) {
    const double middle = static_cast<double>(free_ones - 1) / 2;  // of the first ones
    const double since =
        (static_cast<double>(k / n) - middle) / static_cast<double>(samples - free_ones);
    table.readings[k] -=
        table.readings[k] >= recording.sensor.taxels.saturated_at ? 0 : since * drift[k % n];
  }
  recording.told.push_back({"taxels.csv",
                            "the zero of the taxels moves by up to " + number(most) +
                                " from the first samples to the last, and this is taken off",
                            "Let the array warm up, and record it free before and after.", false});
}

/// Takes off what the taxels read while nothing touched them: until free_until_s, else in the first
/// samples, if the load is later greater, never smaller, and spread in another way. Where the load
/// changes evenly, what does not change with it is no load.
void set_zero(const std::filesystem::path& folder, FoamRecording& recording) {
  const TaxelTable& table = recording.table;
  const FoamSensor& sensor = recording.sensor;
  const std::size_t samples = table.frames.size(), n = table.taxels();
  std::vector<std::size_t> order(samples);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (sensor.free_until_s) {
    std::erase_if(order, [&](std::size_t k) {
      return !(table.times_s[k] < recording.seconds_in(*sensor.free_until_s));
    });
    if (order.size() < 4) {
      fail(folder / "sensor.json", "foam.free_until_s = " + number(*sensor.free_until_s) +
                                       " leaves " + std::to_string(order.size()) +
                                       " samples, but must leave 4 or more");
    }
    take_off(recording, means_of(table, order), "until foam.free_until_s");
    return;
  }
  const std::size_t first_ones =
      (std::min)(4 * static_cast<std::size_t>(sensor.taxels.window), samples / 3);
  if (first_ones < 8) {
    return;
  }
  const Values first = means_of(table, {order.begin(), order.begin() + std::ptrdiff_t(first_ones)});
  Values sums, steps;
  for (std::size_t k = 0; k < samples; ++k) {
    double sum = 0;
    for (std::size_t taxel = 0; taxel < n; ++taxel) {
      const double reading = table.readings[k * n + taxel];
      sum += std::isfinite(reading) ? reading : first[taxel];
      if (k > 0 && std::isfinite(reading - table.readings[(k - 1) * n + taxel])) {
        steps.push_back(std::abs(reading - table.readings[(k - 1) * n + taxel]));
      }
    }
    sums.push_back(sum);
  }
  const double noise = steps.empty() ? 0 : median_of(steps);  // about one standard deviation
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sums[a] < sums[b]; });
  const auto tenth = static_cast<std::ptrdiff_t>((std::max)(samples / 10, std::size_t{4}));
  const Values low = means_of(table, {order.begin(), order.begin() + tenth});
  const Values high = means_of(table, {order.end() - tenth, order.end()});
  Values rise, change;
  for (std::size_t k = 0; k < n; ++k) {
    rise.push_back(high[k] - first[k]);
    change.push_back(high[k] - low[k]);
  }
  const double least = 3 * noise * std::sqrt(static_cast<double>(n));
  const double most = largest_reading(table);
  const Line started = line_through(rise, first), held = line_through(change, high);
  if (sum_of(rise) > 10 * least && sum_of(first) - sum_of(low) < least + 0.02 * sum_of(rise) &&
      std::abs(started.correlation) < 0.5) {
    if (*std::max_element(first.begin(), first.end()) > 3 * noise) {
      take_off(recording, first, "in the first samples, before anything touches them");
    }
    take_off_drift(recording, first_ones, rise, noise);
  } else if (sum_of(change) > 0.1 * sum_of(high) && held.correlation > 0.98 &&
             held.offset > 5 * held.offset_sd + 0.02 * most) {
    fail(folder / "taxels.csv",
         "the taxels read about " + number(held.offset) +
             " that does not change with the load, so the array was not set to zero, and the "
             "object is held from the first sample on; record a second before anything touches "
             "the array, and set foam.free_until_s in sensor.json to its end");
  }
}

}  // namespace

void repair_readings(const std::filesystem::path& folder, FoamRecording& recording) {
  find_full_scale(recording);
  leave_out_spikes(recording);
  set_zero(folder, recording);
  recording.table.missing =
      std::count_if(recording.table.readings.begin(), recording.table.readings.end(),
                    [](double reading) { return !std::isfinite(reading); });
}

}  // namespace replay
