// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/recording.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "common/failure.hpp"
#include "common/median.hpp"
#include "common/table.hpp"
#include "replay/foam/faults.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;
using Place = std::pair<int, int>;  // row and column

constexpr int max_places = 4096;  // rows or columns

/// Reads up to four digits from position `at`, which it advances; nullopt if none or too large.
std::optional<int> digits(const std::string& text, std::size_t& at) {
  const std::size_t first = at;
  int number = 0;
  for (; at < text.size() && at < first + 4 && text[at] >= '0' && text[at] <= '9'; ++at) {
    number = 10 * number + (text[at] - '0');
  }
  return at > first && number < max_places ? std::optional<int>(number) : std::nullopt;
}

/// Parses a column name such as "r3_c0".
std::optional<Place> place_of(const std::string& name) {
  std::size_t at = 1;
  if (name.empty() || name[0] != 'r') {
    return {};
  }
  const auto row = digits(name, at);
  if (!row || name.compare(at, 2, "_c") != 0) {
    return {};
  }
  at += 2;
  const auto col = digits(name, at);
  return col && at == name.size() ? std::optional<Place>({*row, *col}) : std::nullopt;
}

std::string name_of(const Place& place) {
  std::string name = "r";
  name += std::to_string(place.first) + "_c" + std::to_string(place.second);
  return name;
}

/// Positions of the columns in a line.
struct Header {
  std::size_t frame = 0;
  std::size_t time = 0;
  std::map<Place, std::size_t> taxels;
  int rows = 0;
  int cols = 0;
};

Header header_of(const Table& table) {
  const auto refuse = [&](const std::string& why) { table.refuse(why); };
  Header header;
  std::map<std::string, std::size_t> others;
  for (std::size_t k = 0; k < table.header().size(); ++k) {
    const std::string& name = table.header()[k];
    const auto place = place_of(name);
    if (!place && name != "frame" && name != "time_s") {
      refuse("unknown column '" + name + "' (known: frame, time_s, r<row>_c<col>)");
    }
    if (!(place ? header.taxels.emplace(*place, k).second : others.emplace(name, k).second)) {
      refuse("column " + name + " is given twice");
    }
    header.rows = place ? (std::max)(header.rows, place->first + 1) : header.rows;
    header.cols = place ? (std::max)(header.cols, place->second + 1) : header.cols;
  }
  for (const char* name : {"frame", "time_s"}) {
    if (others.count(name) == 0) {
      refuse(std::string("column ") + name + " is missing");
    }
  }
  header.frame = others["frame"];
  header.time = others["time_s"];
  if (header.taxels.empty()) {
    refuse("there are no taxel columns r<row>_c<col>");
  }
  Place expected(0, 0);
  for (const auto& [place, column] : header.taxels) {
    if (place != expected) {
      break;
    }
    expected = expected.second + 1 < header.cols ? Place(expected.first, expected.second + 1)
                                                 : Place(expected.first + 1, 0);
  }
  if (expected.first < header.rows) {
    refuse("column " + name_of(expected) + " is missing; the other columns belong to an array of " +
           std::to_string(header.rows) + " x " + std::to_string(header.cols) + " taxels");
  }
  return header;
}

void add_line(const Table& from, const Header& header, TaxelTable& to) {
  const double frame = from.number_or_nan(header.frame);
  if (std::isfinite(frame) && (frame != std::floor(frame) || frame < 0 || frame > 1e9)) {
    from.refuse("frame '" + from.cells()[header.frame] + "' is not a whole number >= 0");
  }
  const int next = to.frames.empty() ? 0 : to.frames.back() + 1;
  to.frames.push_back(std::isfinite(frame) ? static_cast<int>(frame) : next);
  const double time_s = from.number_or_nan(header.time);
  to.times_s.push_back(time_s);
  to.times.push_back(std::isfinite(time_s) ? from.cells()[header.time] : "");
  for (const auto& [place, column] : header.taxels) {
    to.readings.push_back(from.number_or_nan(column));
    to.missing += std::isfinite(to.readings.back()) ? 0 : 1;
  }
}

/// Median time step between samples; 0 if no step is positive.
double median_step_s(const std::vector<double>& times_s) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times_s.size(); ++k) {
    const double step = times_s[k] - times_s[k - 1];
    if (std::isfinite(step) && step > 0) {
      steps.push_back(step);
    }
  }
  return steps.empty() ? 0 : median_of(steps);
}

void expects_seconds(const fs::path& file, double step_s) {
  constexpr double longest_s = 5;
  if (step_s > longest_s) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", step_s);
    const char* const unit = step_s < 5e3   ? "If the unit is ms, divide by 1000"
                             : step_s < 5e6 ? "If the unit is us, divide by 1,000,000"
                                            : "If the unit is ns, divide by 1,000,000,000";
    fail(file, std::string("time_s: the median interval is ") + text +
                   " s, but must be at most 5 s. " + unit);
  }
}

bool share_taxels(const FingerPlace& a, const FingerPlace& b) {
  return a.first_row < b.first_row + b.rows && b.first_row < a.first_row + a.rows &&
         a.first_col < b.first_col + b.cols && b.first_col < a.first_col + a.cols;
}

void check_fingers(const fs::path& file, const FoamRecording& recording) {
  const auto& fingers = recording.sensor.fingers;
  for (std::size_t k = 0; k < fingers.size(); ++k) {
    const FingerPlace& place = fingers[k];
    const std::string name = "foam.fingers[" + std::to_string(k) + "]";
    // written so that no sum overflows
    if (place.rows > recording.table.rows - place.first_row ||
        place.cols > recording.table.cols - place.first_col) {
      fail(file, name + " extends beyond the array, which has " +
                     std::to_string(recording.table.rows) + " x " +
                     std::to_string(recording.table.cols) + " taxels in taxels.csv");
    }
    for (std::size_t other = 0; other < k; ++other) {
      if (share_taxels(fingers[other], place)) {
        fail(file, name + " shares taxels with foam.fingers[" + std::to_string(other) + "]");
      }
    }
  }
}

}  // namespace

TaxelTable read_taxels(const fs::path& file) {
  Table from(file, Table::Lines::may_end_early);
  const Header header = header_of(from);
  TaxelTable table;
  table.rows = header.rows;
  table.cols = header.cols;
  while (from.next()) {
    add_line(from, header, table);
  }
  if (table.frames.empty()) {
    fail(file, "holds no samples");
  }
  return table;
}

fingerpad::StridedView<const double> FoamRecording::finger(int sample, int finger) const {
  const FingerPlace& place = sensor.fingers[static_cast<std::size_t>(finger)];
  const double* const all =
      table.readings.data() + static_cast<std::size_t>(sample) * table.taxels();
  return {all + place.first_row * table.cols + place.first_col, place.rows, place.cols, table.cols};
}

std::size_t FoamRecording::taxel_of(int finger, Index k) const {
  const FingerPlace& place = sensor.fingers[static_cast<std::size_t>(finger)];
  const Index row = place.first_row + k / place.cols, col = place.first_col + k % place.cols;
  return static_cast<std::size_t>(row * table.cols + col);
}

double FoamRecording::newtons_of(std::size_t taxel) const {
  const std::vector<double>& all = sensor.newton_per_unit;
  return all.empty() ? 1 : all[all.size() > 1 ? taxel : 0];
}

std::string taxel_name(const TaxelTable& table, std::size_t taxel) {
  const int at = static_cast<int>(taxel);
  return name_of(Place{at / table.cols, at % table.cols});
}

double FoamRecording::seconds_in(double stated_s) const {
  const auto first = std::find_if(table.times_s.begin(), table.times_s.end(),
                                  [](double time_s) { return std::isfinite(time_s); });
  return first != table.times_s.end() && *first > stated_s ? *first + stated_s : stated_s;
}

bool is_foam_recording(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "taxels.csv", error);
}

FoamRecording open_foam_recording(const fs::path& folder) {
  FoamRecording recording;
  FoamSensor& sensor = recording.sensor;
  sensor = read_foam_sensor(folder / "sensor.json");
  recording.table = read_taxels(folder / "taxels.csv");
  if (sensor.fingers.empty()) {
    sensor.fingers = {{0, recording.table.rows, 0, recording.table.cols}};
  }
  check_fingers(folder / "sensor.json", recording);
  const std::size_t all = recording.table.taxels(), newtons = sensor.newton_per_unit.size();
  const auto expects_all = [&](const char* key, std::size_t given) {
    if (given != 0 && given != all) {
      fail(folder / "sensor.json", std::string("foam.") + key + " has " + std::to_string(given) +
                                       " entries, but taxels.csv has " + std::to_string(all) +
                                       " taxels");
    }
  };
  expects_all("newton_per_unit", newtons == 1 ? 0 : newtons);
  expects_all("places_mm", sensor.places_mm.size());
  fingerpad::TaxelOptions& taxels = sensor.taxels;
  const double measured_s = median_step_s(recording.table.times_s);
  expects_seconds(folder / "taxels.csv", measured_s);
  const double by_default_s = measured_s > 0 ? measured_s : taxels.sample_period_s;
  taxels.sample_period_s = sensor.sample_period_s.value_or(by_default_s);
  // the steps of a slow recording must not count as gaps
  taxels.longest_gap_s =
      sensor.longest_gap_s.value_or((std::max)(taxels.longest_gap_s, 4 * taxels.sample_period_s));
  repair_readings(folder, recording);
  return recording;
}

}  // namespace replay
