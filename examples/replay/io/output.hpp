// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The folder that the program writes, all or nothing: it grows under another name beside its place
// and moves there when it is complete. An earlier run's folder is replaced; anybody else's is not.
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
  /// Makes the folders above `place` where they lack. Refuses a place that holds anything but an
  /// earlier run's files, or cannot be written; Failure.
  explicit OutputFolder(const std::filesystem::path& place);
  /// Removes what was written, unless publish() came first.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// "PART/NAME" in the growing folder; makes PART.
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
  double valid_share = 0;    ///< NaN, and empty in the file, where the recording is of dots only
  double depth_mean_mm = 0;  ///< NaN where no pixel is valid, then empty in the file
  double depth_max_mm = 0;
  ContactResult contact;  ///< not accepted: the recording is of dots only
  fingerpad::ObjectMotionResult<double> motion;
  bool has_dots = false;
  fingerpad::StickRatioResult<float> stick;
  fingerpad::SlipEvidence slip_evidence = fingerpad::SlipEvidence::none;
  ForceFrame force;  ///< by look-up
  std::optional<TrueForce> truth;
  fingerpad::WrenchResult<double> wrench;  ///< not ok(), and empty in the file: no answer
  double pressure_mpa = 0;                 ///< NaN: not known
  bool pad_has_changed = false;            ///< its light is not that of the reference

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
