// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/signals.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <vector>

#include "common/csv_cells.hpp"
#include "common/failure.hpp"

namespace replay {

std::string Signals::time_s(int frame) const {
  const auto found = times_s.find(frame);
  return found == times_s.end() ? "" : found->second;
}

double Signals::pressure_mpa(int frame) const {
  const auto found = pressures_mpa.find(frame);
  return found == pressures_mpa.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

Signals read_signals(const std::filesystem::path& file, int frame_count) {
  Signals signals;
  if (!std::filesystem::exists(file)) {
    return signals;
  }
  std::ifstream stream(file);
  std::string line;
  const auto refuse = [&](int number, const std::string& why) {
    fail(file, "line " + std::to_string(number) + ": " + why);
  };
  if (!std::getline(stream, line)) {
    fail(file, "is empty or cannot be read");
  }
  const std::vector<std::string> header = cells_of(line);
  const bool with_pressure = header == std::vector<std::string>{"frame", "time_s", "pressure_mpa"};
  if (!with_pressure && header != std::vector<std::string>{"frame", "time_s"}) {
    refuse(1, "must be frame,time_s,pressure_mpa (the last is optional)");
  }
  for (int number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() == 1 && cells[0].empty()) {
      continue;
    }
    if (cells.size() != header.size()) {
      refuse(number, "has " + std::to_string(cells.size()) + " values, must have " +
                         std::to_string(header.size()));
    }
    double frame = 0;
    if (!is_number(cells[0], frame) || frame != std::floor(frame) || frame < 0 ||
        frame >= frame_count) {
      refuse(number, "frame '" + cells[0] + "' is not one of the frames 0 to " +
                         std::to_string(frame_count - 1));
    }
    double value = 0;
    for (std::size_t i = 1; i < cells.size(); ++i) {
      if (!(i == 2 && cells[i].empty()) && !is_number(cells[i], value)) {
        refuse(number, header[i] + " '" + cells[i] + "' is not a number");
      }
    }
    if (with_pressure && !cells[2].empty()) {
      signals.pressures_mpa.emplace(static_cast<int>(frame), value);
    }
    if (!signals.times_s.emplace(static_cast<int>(frame), cells[1]).second) {
      refuse(number, "frame " + cells[0] + " is given twice");
    }
  }
  return signals;
}

}  // namespace replay
