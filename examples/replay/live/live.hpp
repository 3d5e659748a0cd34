// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The pictures of the montage, frame by frame as a camera gives them, in a window.
#include <filesystem>
#include <optional>

#include "replay/replay.hpp"

namespace replay {

struct LiveOptions {
  std::optional<int> camera;    ///< its number; empty: the video
  std::filesystem::path video;  ///< shown at its own frame rate
  bool headless = false;        ///< no window: pictures go to Options::out, those of all frames of
                                ///< a video, as fast as they are made

  bool asked_for() const { return camera || !video.empty(); }
};

/// Of the recording only sensor.json and the free pad are read. Ends with the video, with
/// Options::range, when the user closes the window or presses q or Esc, or on an interrupt. Returns
/// the exit status; throws Failure.
int run_live(const Options& options, const LiveOptions& live);

}  // namespace replay
