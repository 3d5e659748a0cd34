// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A recording of a foam array: taxels.csv, and sensor.json where there is one.
#include <filesystem>
#include <string>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "replay/foam/sensor.hpp"

namespace replay {

using fingerpad::Index;

/// taxels.csv: frame,time_s,r<row>_c<col>,... in any order of the columns.
struct TaxelTable {
  int rows = 0;
  int cols = 0;
  std::vector<int> frames;         ///< as written; where that is empty, one more than the last
  std::vector<std::string> times;  ///< as written
  std::vector<double> times_s;     ///< NaN: not known
  std::vector<double> readings;    ///< sample after sample, row by row; NaN: missing
  long long missing = 0;           ///< readings

  int samples() const { return static_cast<int>(frames.size()); }
  std::size_t taxels() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
};

/// Empty cells, missing ones at the end of a line, and those that are not finite are missing
/// readings. Throws Failure.
TaxelTable read_taxels(const std::filesystem::path& file);

struct FoamRecording {
  FoamSensor sensor;  ///< with fingers, sample period and longest gap
  TaxelTable table;

  int fingers() const { return static_cast<int>(sensor.fingers.size()); }
  /// The readings of one finger.
  fingerpad::StridedView<const double> finger(int sample, int finger) const;
};

/// Whether the folder holds taxels.csv.
bool is_foam_recording(const std::filesystem::path& folder);

/// Opens and checks a recording; throws Failure.
FoamRecording open_foam_recording(const std::filesystem::path& folder);

}  // namespace replay
