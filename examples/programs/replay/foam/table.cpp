// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/table.hpp"

#include <string>
#include <utility>

#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

using fingerpad::TaxelStatus;
using Finger = fingerpad::FingerSample<double>;
using Columns = std::vector<Column<FoamRow>>;

bool has_waves(const Finger& finger) {
  return finger.status == TaxelStatus::vibrating || finger.status == TaxelStatus::quiet;
}

/// Row or column of the vibration.
std::string place(const Finger& finger, fingerpad::Index number) {
  return finger.location == finger.no_location ? "" : std::to_string(number);
}

}  // namespace

Columns foam_columns(const FoamSensor& sensor) {
  Columns columns = {{"frame", [](const FoamRow& r) { return std::to_string(r.frame); }},
                     {"time_s", [](const FoamRow& r) { return r.time_s; }}};
  for (std::size_t k = 0; k < sensor.fingers.size(); ++k) {
    const std::string prefix = sensor.fingers.size() > 1 ? "finger" + std::to_string(k) + "_" : "";
    const auto add = [&](const char* name, auto cell) {
      columns.push_back(
          {prefix + name, [k, cell](const FoamRow& r) { return cell(r.fingers[k]); }});
    };
    const int cols = sensor.fingers[k].cols;
    add("center_x_mm", [](const Finger& f) { return cell_of(f.center_x_mm); });
    add("center_y_mm", [](const Finger& f) { return cell_of(f.center_y_mm); });
    add(sensor.newton_per_unit.empty() ? "sum" : "force_n", [](const Finger& f) {
      return f.status == TaxelStatus::refused ? "" : format("%.9g", f.sum);
    });
    add("vibrating_row", [cols](const Finger& f) { return place(f, f.location / cols); });
    add("vibrating_col", [cols](const Finger& f) { return place(f, f.location % cols); });
    add("waves", [](const Finger& f) { return has_waves(f) ? std::to_string(f.waves) : ""; });
    add("frequency_hz",
        [](const Finger& f) { return has_waves(f) ? cell_of(f.frequency_hz) : ""; });
    add("taxels_left_out", [](const Finger& f) {
      return f.status == TaxelStatus::refused ? "" : std::to_string(f.left_out);
    });
    add("taxel_status", [](const Finger& f) { return std::string(name_of(f.status)); });
  }
  columns.push_back({"preslip", [](const FoamRow& r) { return r.alarm.any() ? "1" : "0"; }});
  columns.push_back({"preslip_rule", [](const FoamRow& r) { return r.alarm.names(); }});
  return columns;
}

}  // namespace replay
