// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The output of replay for a gel pad with dots: its columns of frames.csv, and a picture of each
// frame.
#include <optional>

#include "common/output.hpp"
#include "replay/dots/dots.hpp"
#include "replay/gel/free_pad.hpp"
#include "replay/gel/slide_picture.hpp"
#include "replay/gel/slide_step.hpp"
#include "replay/replay.hpp"

namespace replay {

class GelReplay {
 public:
  /// Options and output must outlive this object. Throws Failure, as does
  /// the function below.
  GelReplay(Recording& recording,
            const Options& options,
            const DotSource& dots,
            const OutputFolder& output);

  /// Sets gel and contact mask of the scene, and paints it.
  void operator()(Scene& scene);
  void print_summary() const;

 private:
  const Options& options_;
  const OutputFolder& output_;
  FreePad free_;
  SlideStep step_;
  int touching_ = 0;         ///< frames
  int unlike_ = 0;           ///< frames that are not of this pad
  std::optional<int> slip_;  ///< first frame with an alarm
};

}  // namespace replay
