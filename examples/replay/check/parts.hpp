// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The parts of check.hpp, each for one kind of mistake.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "replay/check/check.hpp"
#include "replay/foam/recording.hpp"
#include "replay/io/recording.hpp"

namespace replay {

/// Pressure, side dots, look-up curves and true forces: units, signs, order.
void check_numbers(const Recording& recording, Findings& findings);
/// The reference: its depth against camera, pad and light.
void check_reference(const Recording& recording, Findings& findings);
/// Exposure, noise and lamp of the frames, whether the free frames are free, and what the force
/// gauge reads in them.
void check_light(Recording& recording, Findings& findings);
/// The dots of dots.csv, or the print against what the reference shows.
void check_dots(const std::filesystem::path& folder,
                const Recording& recording,
                Findings& findings);
/// The directions of forces.csv against those in which the dots move.
void check_gauge(const std::filesystem::path& folder, Recording& recording, Findings& findings);
/// Clock and taxels of a foam array.
void check_foam(const FoamRecording& recording, Findings& findings);
/// Times in s, NaN where one is missing, `what` after `what` ("frame", "sample").
void check_clock(const std::string& place,
                 const std::string& what,
                 const std::vector<double>& times_s,
                 Findings& findings);

/// NaN where there are none.
inline double median_of(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace replay
