// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A grid of dots that nothing is known of: its dots' size, dark or bright, its two directions and
// how many rows and columns it has all come from one frame. The rows are those directions that run
// more nearly along the frame's; a grid may be rotated, sheared, and bent a little from dot to dot.
#include <opencv2/core.hpp>
#include <optional>

#include "replay/dots/blobs.hpp"
#include "replay/dots/grid.hpp"
#include "replay/dots/order.hpp"
#include "replay/io/sensor.hpp"

namespace replay {

/// Spots that lie in rows and columns, named by them; empty where there is no such grid. Spots
/// between the rows are left out.
DotGrid lattice_of(const Blobs& spots);

struct FoundPattern {
  FirstOrder order;
  SpotLook look;
};

/// The grid of dots in a frame; none where fewer than nine lie in order. What `given` says is
/// taken: of rows and columns those are kept that hold the most dots.
std::optional<FoundPattern> find_pattern(const cv::Mat& image, const DotPattern& given);

}  // namespace replay
