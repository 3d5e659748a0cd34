// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shows the pictures of the montage in a window, frame by frame, live from a camera.
#include <filesystem>
#include <optional>

#include "replay/replay.hpp"

namespace replay {

struct LiveOptions {
  std::optional<int> camera;     ///< number of the camera; empty: use `video`
  std::filesystem::path video;   ///< shown at its own frame rate
  std::filesystem::path record;  ///< where recordings go that the key r begins and ends
  bool headless = false;  ///< no window: pictures are written to Options::out, for all frames
                          ///< of a video, as fast as possible; `record` takes all frames

  bool asked_for() const { return camera || !video.empty(); }
};

/// Reads only sensor.json and the free pad of the recording. Ends with the video or Options::range,
/// when the user closes the window or presses q or Esc (r: see LiveOptions::record), or on an
/// interrupt. Returns the exit status; throws Failure.
int run_live(const Options& options, const LiveOptions& live);

}  // namespace replay
