// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Follows the dots from frame to frame. Several guesses of how they moved are grown into labels;
// the one with the most and the most regular labels is taken. Where two guesses do nearly as well
// but disagree, the dots they disagree about count as not found.
#include <opencv2/core.hpp>

#include "replay/dots/grid.hpp"
#include "replay/dots/match.hpp"
#include "replay/dots/order.hpp"

namespace replay {

class DotTracker {
 public:
  explicit DotTracker(const FirstOrder& free_pad, const Smoothness& smoothness = membrane);

  /// The dots among the spots of the next frame.
  DotGrid track(const Blobs& blobs);

 private:
  void remember(const DotGrid& found);

  Smoothness smoothness_;
  DotGrid free_;            ///< every dot on the free pad: found there, or where it should be
  DotGrid last_;            ///< where every dot was last, or where its neighbours put it
  DotGrid velocity_;        ///< px per frame, 0 where unknown
  cv::Mat_<uchar> border_;  ///< dots at the border of the print, which the rim holds
  cv::Point middle_;        ///< column and row of the dot in the middle
  int count_;               ///< dots found on the free pad
};

}  // namespace replay
