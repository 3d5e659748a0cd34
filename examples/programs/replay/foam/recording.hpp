// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A recording of a foam array: taxels.csv, and sensor.json if it exists.
#include <filesystem>
#include <string>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "replay/check/check.hpp"
#include "replay/foam/sensor.hpp"

namespace replay {

using fingerpad::Index;

/// The content of taxels.csv: columns frame,time_s,r<row>_c<col>,... in any order.
struct TaxelTable {
  int rows = 0;
  int cols = 0;
  std::vector<int> frames;         ///< as written; if empty, one more than the previous
  std::vector<std::string> times;  ///< as written
  std::vector<double> times_s;     ///< NaN if unknown
  std::vector<double> readings;    ///< by sample, row and column; NaN if missing
  long long missing = 0;           ///< number of missing readings

  int samples() const { return static_cast<int>(frames.size()); }
  std::size_t taxels() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
};

/// "r0_c0", the column of a taxel.
std::string taxel_name(const TaxelTable& table, std::size_t taxel);

/// Reads taxels.csv. A cell that is empty, not finite, or absent at the end of a line is a missing
/// reading. Throws Failure.
TaxelTable read_taxels(const std::filesystem::path& file);

struct FoamRecording {
  FoamSensor sensor;  ///< with defaults for fingers, sample period and longest gap resolved
  TaxelTable table;
  Findings told;  ///< faults of the readings, which are taken out of the table

  /// A time of sensor.json on the clock of the table: from the first sample on, if that comes later
  /// (as with seconds since 1970).
  double seconds_in(double stated_s) const;
  /// Number in the array of the k-th taxel of a finger.
  std::size_t taxel_of(int finger, fingerpad::Index k) const;
  /// What a unit of its readings is in N; 1 without newton_per_unit.
  double newtons_of(std::size_t taxel) const;
  int fingers() const { return static_cast<int>(sensor.fingers.size()); }
  /// The readings of one finger.
  fingerpad::StridedView<const double> finger(int sample, int finger) const;
};

/// Whether the folder holds taxels.csv.
bool is_foam_recording(const std::filesystem::path& folder);

/// Opens and checks a recording; throws Failure.
FoamRecording open_foam_recording(const std::filesystem::path& folder);

}  // namespace replay
