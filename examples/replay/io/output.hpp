// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The output folder, written all or nothing: it is built under a temporary name beside its place
// and moved there when it is complete. The folder of an earlier run is replaced; any other is
// refused.
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "replay/io/true_forces.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

class OutputFolder {
 public:
  /// Creates missing parent folders of `place`. Throws Failure if `place` contains anything but the
  /// files of an earlier run, or cannot be written.
  explicit OutputFolder(const std::filesystem::path& place);
  /// Removes the written files unless publish() was called.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Path of PART/NAME in the temporary folder; creates PART.
  std::filesystem::path file(const std::string& part, const std::string& name) const;
  std::filesystem::path file(const std::string& name) const { return growing_ / name; }
  /// Moves the folder to its place; throws Failure.
  void publish();
  const std::filesystem::path& place() const { return place_; }

 private:
  void make_parents(const std::filesystem::path& folder);
  void remove_traces();
  std::filesystem::path place_;
  std::filesystem::path growing_;
  std::vector<std::filesystem::path> made_parents_;  ///< outermost first
};

/// "000012.tiff", or "depth_000012.png" with a stem.
std::string numbered(const std::string& stem, int frame, const std::string& extension);

/// One line of frames.csv.
struct FrameRow {
  int frame = 0;
  std::string time_s;        ///< empty where unknown
  double valid_share = 0;    ///< NaN, an empty cell, for a dots-only recording
  double depth_mean_mm = 0;  ///< NaN, an empty cell, if no pixel is valid
  double depth_max_mm = 0;
  ContactResult contact;  ///< not accepted for a dots-only recording
  fingerpad::ObjectMotionResult<double> motion;
  bool has_dots = false;
  fingerpad::StickResult<> stick;
  fingerpad::SlipEvidence slip_evidence = fingerpad::SlipEvidence::none;
  ForceFrame force;  ///< by look-up
  std::optional<TrueForce> truth;
  fingerpad::WrenchResult wrench;   ///< not ok(), empty cells, if there is no result
  std::array<double, 6> wrench_sd;  ///< N and N mm
  double pressure_mpa = 0;          ///< NaN if unknown
  bool pad_has_changed = false;     ///< its light differs from the reference

  bool has_wrench() const { return wrench.ok(); }
};

class FramesCsv {
 public:
  explicit FramesCsv(const std::filesystem::path& file);
  void write(const FrameRow& row);
  void close();  ///< throws Failure where anything could not be written

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
};

/// dots.csv: one line for each dot that was found in a frame.
class DotsCsv {
 public:
  explicit DotsCsv(const std::filesystem::path& file);
  void write(int frame, const FrameDots& dots);
  void close();  ///< throws Failure where anything could not be written

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
};

}  // namespace replay
