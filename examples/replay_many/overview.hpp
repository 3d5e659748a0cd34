// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What is told of all recordings together.
#include "recordings.hpp"

namespace replay_many {

struct Counts {
  int done = 0, failed = 0, left = 0;
  long long frames = 0;
};

/// Writes DIR/all_frames.csv (every line of every frames.csv, with the recording's name before it
/// and the columns of all), DIR/summary.csv (a line a recording) and DIR/overview.html (a small
/// picture of each). Throws replay::Failure.
Counts write_overview(const Recordings& recordings, const Path& out);

}  // namespace replay_many
