// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The output of replay for a gel pad with dots: slide.csv, a picture of each frame, and one chart.
#include <fstream>
#include <optional>
#include <vector>

#include "common/output.hpp"
#include "replay/dots/dots.hpp"
#include "replay/gel/free_pad.hpp"
#include "replay/gel/slide_picture.hpp"
#include "replay/gel/slide_step.hpp"
#include "replay/replay.hpp"

namespace replay {

class GelReplay {
 public:
  /// Options and output must outlive this object. Throws Failure, as do the
  /// functions below.
  GelReplay(Recording& recording,
            const Options& options,
            const DotSource& dots,
            const OutputFolder& output);

  void operator()(int frame, const std::string& time_s, const cv::Mat& image, const DotGrid& dots);
  /// Closes the table.
  void finish();
  void print_summary() const;

 private:
  void write_row(const GelScene& scene);

  const Options& options_;
  const OutputFolder& output_;
  FreePad free_;
  SlideStep step_;
  std::filesystem::path file_;
  std::ofstream table_;
  int touching_ = 0;         ///< frames
  int unlike_ = 0;           ///< frames that are not of this pad
  std::optional<int> slip_;  ///< first frame with an alarm
};

}  // namespace replay
