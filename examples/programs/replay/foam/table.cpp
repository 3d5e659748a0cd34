// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/table.hpp"

#include <string>

#include "common/failure.hpp"
#include "common/table.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

using fingerpad::TaxelStatus;

}  // namespace

std::string finger_prefix(std::size_t finger, std::size_t fingers) {
  return fingers > 1 ? "finger" + std::to_string(finger) + "_" : "";
}

FoamCsv::FoamCsv(const std::filesystem::path& file, const FoamRecording& recording)
    : file_(file), stream_(file), fingers_(recording.sensor.fingers) {
  stream_ << "frame,time_s";
  const char* const sum = recording.sensor.newton_per_unit.empty() ? "sum" : "force_n";
  for (std::size_t k = 0; k < fingers_.size(); ++k) {
    for (const char* column : {"center_x_mm", "center_y_mm", sum, "vibrating_row", "vibrating_col",
                               "waves", "frequency_hz", "taxels_left_out", "taxel_status"}) {
      stream_ << ',' << finger_prefix(k, fingers_.size()) << column;
    }
  }
  stream_ << ",preslip,preslip_rule\n";
}

void FoamCsv::write(const FoamRow& row) {
  stream_ << row.frame << ',' << row.time_s;
  for (std::size_t k = 0; k < fingers_.size(); ++k) {
    const auto& finger = row.fingers[k];
    const bool has_waves =
        finger.status == TaxelStatus::vibrating || finger.status == TaxelStatus::quiet;
    stream_ << ',' << cell_of(finger.center_x_mm) << ',' << cell_of(finger.center_y_mm) << ','
            << (row.was_taken() ? format("%.9g", finger.sum) : "");
    if (finger.location == finger.no_location) {
      stream_ << ",,";
    } else {
      stream_ << ',' << finger.location / fingers_[k].cols << ','
              << finger.location % fingers_[k].cols;
    }
    stream_ << ',' << (has_waves ? std::to_string(finger.waves) : "") << ','
            << (has_waves ? cell_of(finger.frequency_hz) : "") << ','
            << (row.was_taken() ? std::to_string(finger.left_out) : "") << ','
            << name_of(finger.status);
  }
  stream_ << ',' << (row.alarm.any() ? 1 : 0) << ',' << row.alarm.names() << '\n';
}

void FoamCsv::close() {
  stream_.close();
  if (!stream_) {
    fail(file_, "cannot be written");
  }
}

}  // namespace replay
