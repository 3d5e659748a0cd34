// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The columns of frames.csv, every number of a frame beside its doubt, and of dots.csv.
#include <vector>

#include "common/table.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

/// Of recordings with frames; a cell is empty where the recording does not have it.
std::vector<Column<FrameRow>> frame_columns();

/// A dot that was found in a frame.
struct DotRow {
  int frame, row, col;
  const FrameDots& dots;
};
std::vector<Column<DotRow>> dot_columns();

}  // namespace replay
