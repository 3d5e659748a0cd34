// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Runs the program, from its options to its output.
#include <filesystem>
#include <optional>
#include <string>

#include "replay/steps/fingertip_step.hpp"

namespace replay {

/// Frames [first, last); no last: to the end.
struct Range {
  int first = 0;
  std::optional<int> last;
};

/// Reads "A:B", "A:" or ":B"; throws std::invalid_argument.
Range parse_range(const std::string& text);

/// Resolves the range against the `size` existing frames; throws Failure if it names others.
Range within(const Range& range, int size, const std::filesystem::path& recording);

struct Options {
  std::filesystem::path recording;
  std::filesystem::path sensor;  ///< sensor.json; empty: the one in the recording
  std::filesystem::path out;
  std::optional<int> smoothing_px;  ///< empty: that of sensor.json, else 1
  Range range;
  bool raw = false;
  bool pictures = true;
};

/// Returns the exit status: 0, or 130 after an interrupt. Throws Failure.
int run(const Options& options);

}  // namespace replay
