// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tables over all recordings.
#include "recordings.hpp"

namespace replay_many {

struct Counts {
  int done = 0, failed = 0, left = 0;
  long long frames = 0;
};

/// Writes DIR/all_frames.csv (all lines of all frames.csv, preceded by the recording's name, with
/// the union of the columns) and DIR/summary.csv (one line per recording). Throws replay::Failure.
Counts write_overview(const Recordings& recordings, const Path& out);

}  // namespace replay_many
