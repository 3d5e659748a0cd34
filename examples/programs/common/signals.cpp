// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/signals.hpp"

#include <limits>
#include <vector>

#include "common/table.hpp"

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
  Table table(file);
  const bool with_pressure =
      table.header() == std::vector<std::string>{"frame", "time_s", "pressure_mpa"};
  if (!with_pressure && table.header() != std::vector<std::string>{"frame", "time_s"}) {
    table.refuse("must be frame,time_s,pressure_mpa (the last is optional)");
  }
  while (table.next()) {
    const int frame = table.index(0, frame_count, "frames");
    (void)table.number(1);
    if (with_pressure && !table.cells()[2].empty()) {
      signals.pressures_mpa.emplace(frame, table.number(2));
    }
    if (!signals.times_s.emplace(frame, table.cells()[1]).second) {
      table.refuse("frame " + std::to_string(frame) + " is given twice");
    }
  }
  return signals;
}

}  // namespace replay
