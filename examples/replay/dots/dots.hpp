// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The printed dots of a recording, frame by frame and in print order: read from dots.csv where the
// recording has it, else found in the frames, with the library's dot_finder.hpp, where sensor.json
// says what is printed or the recording is of dots only.
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "fingerpad/adapt/dot_finder.hpp"
#include "replay/dots/grid.hpp"
#include "replay/io/recording.hpp"
#include "replay/io/sensor.hpp"

namespace replay {

class DotSource {
 public:
  /// Reads dots.csv of the recording's folder, or finds the free pad's dots in `reference_image`.
  /// Without frames (0) that it could name, dots.csv is not read. Throws Failure.
  DotSource(const std::filesystem::path& folder,
            const Sensor& sensor,
            const cv::Mat& reference_image,
            const cv::Mat_<float>& reference_depth,
            int frame_count);

  /// The same for a dots-only recording. Without dots.csv, dots are found by the grid that the
  /// reference shows, else the first of the first ten frames that shows one. Throws Failure where
  /// none does.
  static DotSource of_dots_only(const std::filesystem::path& folder, Recording& recording);

  /// False where there is neither dots.csv nor a print that the free pad shows; then every grid is
  /// empty (0 x 0).
  bool present() const { return !initial_.empty(); }
  /// "dots.csv", "found in the frames", or "none".
  const std::string& how() const { return how_; }

  /// The free pad's dots. With dots.csv: those of the first frame that it names, or those found in
  /// the reference, if these are more and are the same dots (half of those that both have lie
  /// within half a pitch).
  DotGrid initial() const { return initial_.clone(); }

  /// Of the dots, as the free pad shows them; 0 where they are read from dots.csv.
  double diameter_px() const { return finder_ ? 2 * finder_->pattern().radius_px : 0; }

  /// The dots of a frame; all NaN for a frame that dots.csv does not name. Found dots are followed
  /// from frame to frame, so frames are asked for in ascending order.
  DotGrid of(int frame, const cv::Mat& image);

 private:
  DotSource() = default;
  void read(const std::filesystem::path& file, int frame_count, cv::Size size);
  void follow(fingerpad::DotFinder finder);

  std::string how_ = "none";
  DotGrid initial_;
  std::map<int, DotGrid> listed_;
  std::optional<fingerpad::DotFinder> finder_;
  std::optional<fingerpad::DotFinder::State> state_;
};

/// What is looked for on the free pad: the print of sensor.json's section on dots, as large as it
/// appears at the pad's median depth, where the pad has a depth.
fingerpad::DotFinderOptions print_of(const Sensor& sensor, const cv::Mat_<float>& reference_depth);

}  // namespace replay
