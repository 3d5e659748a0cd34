// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The printed dots of a recording, frame by frame and in print order. They are read from dots.csv
// if it exists. Otherwise the library's dot_finder.hpp finds them on the free pad and
// dot_follower.hpp follows them, if sensor.json describes the print. In a dots-only recording the
// finder finds them in every frame: dots behind an elastic pad need not move like their neighbours.
// Rows of dots around the rim are those of side_dots.hpp.
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/recording.hpp"
#include "common/sensor.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/dots/dot_follower.hpp"
#include "fingerpad/dots/side_dots.hpp"
#include "fingerpad/force/wrench.hpp"
#include "replay/dots/grid.hpp"

namespace replay {

class DotSource {
 public:
  /// Reads dots.csv of the recording's folder, or finds the free pad's dots in `reference_image`.
  /// With `frame_count` 0, dots.csv is not read. Throws Failure.
  DotSource(const std::filesystem::path& folder,
            const Sensor& sensor,
            const cv::Mat& reference_image,
            const cv::Mat_<float>& reference_depth,
            int frame_count);

  /// The same for a dots-only recording. Without dots.csv, the grid is found in the reference, else
  /// in the first of the first ten frames that shows one. Throws Failure if none does.
  static DotSource of_dots_only(const std::filesystem::path& folder, Recording& recording);

  /// False if there is neither dots.csv nor a print on the free pad; then every grid is empty
  /// (0 x 0).
  bool present() const { return !initial_.empty(); }
  /// "dots.csv", "found in the frames", or "none".
  const std::string& how() const { return how_; }

  /// The free pad's dots. With dots.csv these are the dots of its first frame, or those found in
  /// the reference if there are more of them and they are the same dots (more than half of the
  /// common ones lie within half a pitch).
  DotGrid initial() const { return initial_.clone(); }

  /// Diameter of the dots on the free pad; 0 if they are read from dots.csv.
  double diameter_px() const { return finder_ ? 2 * finder_->pattern().radius_px : 0; }

  /// Whether the dots of a dots-only recording are lighter than their background.
  bool bright() const { return finder_ ? finder_->pattern().bright.value_or(false) : bright_; }

  /// The dots of rows around the rim in the frame of the last of(), NaN where lost. Empty if
  /// sensor.json has no such rows, or the free pad does not show them.
  std::span<const fingerpad::Mark> side() const { return side_marks_; }
  /// "216 around the rim", or why there are none; "" if sensor.json has no such rows.
  std::string side_how() const;

  /// The dots of a frame; all NaN for a frame that is not in dots.csv. Without dots.csv the dots
  /// are tracked from frame to frame, so call it in ascending order of frames.
  DotGrid of(int frame, const cv::Mat& image);

 private:
  DotSource() = default;
  void read(const std::filesystem::path& file, int frame_count, cv::Size size);
  void follow(fingerpad::DotFinder finder, const DotGrid& free);
  DotGrid found(const cv::Mat& image);
  DotGrid followed(const cv::Mat& image);
  void look_for_side(const cv::Mat& image);

  std::string how_ = "none";
  DotGrid initial_;
  bool bright_ = false;
  std::map<int, DotGrid> listed_;
  std::optional<fingerpad::DotFinder> finder_;
  std::optional<fingerpad::DotFollower> follower_;
  std::optional<fingerpad::SideDots> side_;
  std::vector<fingerpad::Mark> side_marks_;
};

/// The rows around the rim on the free pad that are not too near to it; empty if sensor.json has
/// none.
std::optional<fingerpad::SideDots> side_dots_of(const Sensor& sensor, const cv::Mat& free_frame);

/// The print to find on the free pad: section "dots" of sensor.json, scaled to the pad's median
/// depth. Only pixels with a depth are searched, and not where `side` has its dots.
fingerpad::DotFinderOptions print_of(const Sensor& sensor,
                                     const cv::Mat_<float>& reference_depth,
                                     const std::optional<fingerpad::SideDots>& side);

}  // namespace replay
