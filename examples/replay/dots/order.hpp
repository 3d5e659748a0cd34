// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which spot is which printed dot on the free pad, whose surface is known: its dots lie on a square
// grid in plan, centered on the axis but for a shift and a turn, as no print is ever centered.
#include <opencv2/core.hpp>

#include "replay/dots/grid.hpp"
#include "replay/io/sensor.hpp"

namespace replay {

struct FirstOrder {
  DotGrid found;     ///< the free pad's dots
  DotGrid expected;  ///< where every printed dot should appear, NaN off the pad
};

/// `sensor` has its section on dots. Turns up to 12 degrees, pitches within 15 % and any shift are
/// followed; of shifts that explain the spots equally well the smallest is taken.
FirstOrder order_free_pad(const Sensor& sensor,
                          const cv::Mat_<float>& reference_depth,
                          const Blobs& blobs);

}  // namespace replay
