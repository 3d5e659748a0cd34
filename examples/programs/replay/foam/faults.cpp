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

/// How many taxels read `value` in so many samples in a row that no noise explains it.
int held_at(const TaxelTable& table, double value) {
  constexpr int samples = 8;
  std::vector<int> now(table.taxels(), 0), longest = now;
  for (std::size_t k = 0; k < table.readings.size(); ++k) {
    int& run = now[k % now.size()];
    run = table.readings[k] >= value ? run + 1 : 0;
    longest[k % now.size()] = (std::max)(longest[k % now.size()], run);
  }
  return static_cast<int>(
      std::count_if(longest.begin(), longest.end(), [](int run) { return run >= samples; }));
}

/// Takes the largest reading for the full scale if it is the largest number of a counter of 8 to 16
/// bit and is read often, if several taxels stay at it, or if it is read often and no other reading
/// is half of it, as a number that stands for no reading.
void find_full_scale(FoamRecording& recording) {
  TaxelTable& table = recording.table;
  double& full = recording.sensor.taxels.saturated_at;
  double most = 0, second = 0;
  bool whole = true;
  for (const double reading : table.readings) {
    second = reading > most ? most : reading < most ? std::fmax(second, reading) : second;
    most = std::fmax(most, reading);
    whole = whole && !(std::isfinite(reading) && reading != std::floor(reading));
  }
  const double bits = std::log2(most + 1);
  constexpr int often = 4;
  const bool is_counter = whole && bits >= 8 && bits <= 16 && bits == std::floor(bits);
  const bool is_fine = !whole || bits >= 6;  // two taxels hardly hold the same number by chance
  if (full >= 1e9 && most > 0 &&
      (((is_counter || 2 * second < most) &&
        std::count(table.readings.begin(), table.readings.end(), most) >= often) ||
       (is_fine && held_at(table, most) > 1))) {
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
      if (all[at] < recording.sensor.taxels.saturated_at && high - low < least / 4 &&
          (all[at] > high + least || all[at] < low - least)) {
        table.readings[at] = std::numeric_limits<double>::quiet_NaN();
        ++counted[taxel];
      }
    }
  }
  tell(recording, counted, "are spikes of one sample, and are left out",
       "Check for loose contacts and for noise on the cable.");
}

/// Leaves out readings that were lost and written as a number: the least of all, 0 or below, that a
/// taxel reads for a moment in which nothing can let go and press again as before.
void leave_out_lost(FoamRecording& recording) {
  constexpr double moment_s = 0.1;
  TaxelTable& table = recording.table;
  Values& all = table.readings;
  const std::size_t n = table.taxels();
  const double least = std::accumulate(all.begin(), all.end(), 0.0,
                                       [](double a, double b) { return std::fmin(a, b); });
  const double longest = std::fmax(1, moment_s / recording.sensor.taxels.sample_period_s);
  Values steps;
  for (std::size_t k = n; k < all.size(); ++k) {
    if (all[k] > least && all[k - n] > least && all[k] != all[k - n]) {
      steps.push_back(std::abs(all[k] - all[k - n]));
    }
  }
  const double clear = steps.empty() ? largest_reading(table) : 8 * median_of(steps);
  std::vector<int> counted(n, 0);
  for (std::size_t taxel = 0; taxel < n; ++taxel) {
    for (std::size_t k = taxel + n, before = taxel; k < all.size(); k += n) {
      if (!(all[k] > least)) {
        continue;
      }
      const double fall = std::fmin(all[k], all[before]) - least;
      const bool is_full = all[k] >= recording.sensor.taxels.saturated_at;
      const auto lost = static_cast<double>((k - before) / n - 1);
      if (lost > 0 && lost <= longest && all[before] > least && fall > clear && !is_full &&
          std::abs(all[k] - all[before]) < fall / 2) {
        for (std::size_t at = before + n; at < k; at += n) {
          counted[taxel] += all[at] == least ? 1 : 0;
          all[at] = std::numeric_limits<double>::quiet_NaN();
        }
      }
      before = k;
    }
  }
  tell(recording, counted, "fall to " + number(least) + " for a moment, and are left out",
       "Leave the cells of lost readings empty, and check the cable.");
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

/// Whether taxels beside one are pressed or let go in these samples, so that it should change, too:
/// all of them, or those on two opposite sides.
bool should_change(const TaxelTable& table,
                   std::size_t taxel,
                   std::size_t from,
                   std::size_t to,
                   double pressed,
                   bool opposite_sides) {
  const int row = static_cast<int>(taxel) / table.cols, col = static_cast<int>(taxel) % table.cols;
  const auto changes = [&](int i, int j) {
    const bool is_in = i >= 0 && j >= 0 && i < table.rows && j < table.cols;
    const auto beside = static_cast<std::size_t>(i * table.cols + j);
    return is_in ? range_of(table, beside, from, to) > pressed : !opposite_sides;
  };
  const bool along_col = changes(row - 1, col) && changes(row + 1, col);
  const bool along_row = changes(row, col - 1) && changes(row, col + 1);
  return opposite_sides ? along_col || along_row : along_col && along_row;
}

/// Leaves out the longest run of equal readings of a taxel, if it should have changed in it. Of one
/// that never changes this is sure if many between two that are pressed do not, as where every
/// second row is dead; a single one may lie at the edge of a contact.
void leave_out_stuck(FoamRecording& recording) {
  constexpr std::size_t shortest = 60;  // samples, in which a taxel that is held still may rest
  TaxelTable& table = recording.table;
  const std::size_t n = table.taxels(), samples = table.frames.size();
  const double pressed = 0.05 * largest_reading(table);
  std::vector<int> counted(n, 0);
  std::vector<std::size_t> between;  // two that are pressed
  int live = 0, still = 0;
  for (std::size_t taxel = 0; taxel < n; ++taxel) {
    live += range_of(table, taxel, 0, samples) > pressed ? 1 : 0;
    std::size_t from = 0, to = 0;
    for (std::size_t since = 0, k = 1; k <= samples; ++k) {
      const double before = table.readings[(k - 1) * n + taxel];
      if (k == samples || !(table.readings[k * n + taxel] == before)) {
        if (std::isfinite(before) && k - since > to - from) {
          from = since;
          to = k;
        }
        since = k;
      }
    }
    if (to > from && (to - from >= shortest || to - from == samples) &&
        table.readings[from * n + taxel] < recording.sensor.taxels.saturated_at &&
        should_change(table, taxel, from, to, pressed, false)) {
      counted[taxel] = static_cast<int>(to - from);
    } else if (to - from == samples && should_change(table, taxel, from, to, pressed, true)) {
      between.push_back(taxel);
    }
    still += to - from == samples && counted[taxel] == 0 ? 1 : 0;
    for (std::size_t k = from; k < to && counted[taxel] > 0; ++k) {
      table.readings[k * n + taxel] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  if (4 * static_cast<int>(between.size()) > live) {
    still -= static_cast<int>(between.size());
    for (const std::size_t taxel : between) {
      counted[taxel] = static_cast<int>(samples);
      for (std::size_t at = taxel; at < table.readings.size(); at += n) {
        table.readings[at] = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  tell(recording, counted, "do not change while those beside them do, and are left out",
       "Check whether they are dead, saturated or disconnected, or leave out their fingers.");
  if (still > 0 && live > 0) {
    recording.told.push_back({"taxels.csv",
                              std::to_string(still) + " of " + std::to_string(n) +
                                  " taxels never change: nothing touches them, or they are dead",
                              "Press on each of them once to know.", false});
  }
}

/// The line y = offset + slope x.
struct Line {
  double offset = 0, slope = 0, offset_sd = 0, correlation = 0;
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
  return {my - xy / xx * mx, xy / xx, std::sqrt(residual * (1 / n + mx * mx / xx)),
          xy / std::sqrt(xx * yy)};
}

double sum_of(const Values& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Leaves out taxels that drift evenly beside what they share with the load on the others, by far
/// more than others do.
void leave_out_drifting(FoamRecording& recording) {
  TaxelTable& table = recording.table;
  const std::size_t n = table.taxels(), samples = table.frames.size();
  const auto at = [&](std::size_t sample, std::size_t taxel) {
    const double reading = table.readings[sample * n + taxel];
    return std::isfinite(reading) ? reading : 0;
  };
  Values sums(samples, 0), time(samples), drift(n, 0), of_pressed;
  for (std::size_t k = 0; k < samples; ++k) {
    time[k] = static_cast<double>(k) / static_cast<double>(samples);
    for (std::size_t taxel = 0; taxel < n; ++taxel) {
      sums[k] += at(k, taxel);
    }
  }
  const double least = 0.05 * largest_reading(table);
  std::vector<int> counted(n, 0);
  for (std::size_t taxel = 0; taxel < n; ++taxel) {
    Values others(samples), own(samples), later(samples);
    for (std::size_t k = 0; k < samples; ++k) {
      own[k] = at(k, taxel);
      others[k] = sums[k] - own[k];
    }
    const Line by_load = line_through(others, own), by_time = line_through(others, time);
    for (std::size_t k = 0; k < samples; ++k) {
      own[k] -= by_load.slope * others[k];
      later[k] = time[k] - by_time.slope * others[k];
    }
    const Line rest = line_through(later, own);
    drift[taxel] = std::abs(rest.slope);
    counted[taxel] = drift[taxel] > least && std::abs(rest.correlation) > 0.95 ? 1 : 0;
    if (range_of(table, taxel, 0, samples) > least) {
      of_pressed.push_back(drift[taxel]);
    }
  }
  const double usual = of_pressed.size() > 3 ? median_of(of_pressed) : 0;
  for (std::size_t taxel = 0; taxel < n; ++taxel) {
    const bool drifts = counted[taxel] > 0 && of_pressed.size() > 3 && drift[taxel] > 8 * usual;
    counted[taxel] = drifts ? static_cast<int>(samples) : 0;
    for (std::size_t k = 0; k < samples && drifts; ++k) {
      table.readings[k * n + taxel] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  tell(recording, counted, "drift while the others do not, and are left out",
       "Let the array warm up, or leave out the fingers of these taxels.");
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
  const std::size_t most_first =
      (std::min)(4 * static_cast<std::size_t>(sensor.taxels.window), samples / 3);
  constexpr std::size_t least_first = 8;
  if (most_first < least_first) {
    return;
  }
  Values first = means_of(table, {order.begin(), order.begin() + std::ptrdiff_t(least_first)});
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
  const double least = 3 * noise * std::sqrt(static_cast<double>(n));
  const double at_start = median_of(Values(sums.begin(), sums.begin() + least_first));
  std::size_t first_ones = least_first;  // until the load rises
  while (first_ones < most_first && sums[first_ones] - at_start < least) {
    ++first_ones;
  }
  first = means_of(table, {order.begin(), order.begin() + std::ptrdiff_t(first_ones)});
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
  const double most = largest_reading(table);
  const double below = *std::min_element(low.begin(), low.end());
  const Line started = line_through(rise, first), held = line_through(change, high);
  const Line least_read = line_through(change, low);
  if (n >= 8 && least_read.correlation < -0.98 && least_read.slope < -0.8 &&
      std::abs(most - least_read.offset) < 0.05 * most) {
    fail(folder / "taxels.csv",
         "the readings fall where they should rise: all taxels read about " +
             number(least_read.offset) +
             " at most, and the more they change the less they read; write that number less each "
             "reading instead");
  }
  if (sum_of(rise) > 10 * least && sum_of(first) - sum_of(low) < least + 0.02 * sum_of(rise) &&
      std::abs(started.correlation) < 0.5) {
    const auto [lowest, highest] = std::minmax_element(first.begin(), first.end());
    if (std::fmax(*highest, -*lowest) > 3 * noise) {
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
  } else if (below < -(3 * noise + 0.02 * most)) {
    fail(folder / "taxels.csv",
         "a taxel reads " + number(below) +
             ", and a load is never below 0, so the array was set to zero under a load; record a "
             "second before anything touches the array, and set foam.free_until_s in sensor.json "
             "to its end");
  }
}

}  // namespace

void repair_readings(const std::filesystem::path& folder, FoamRecording& recording) {
  find_full_scale(recording);
  leave_out_lost(recording);
  leave_out_spikes(recording);
  leave_out_stuck(recording);
  leave_out_drifting(recording);
  set_zero(folder, recording);
}

}  // namespace replay
