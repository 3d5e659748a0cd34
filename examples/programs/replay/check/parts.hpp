// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The parts of check.hpp, one for each kind of mistake.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "common/median.hpp"
#include "common/recording.hpp"
#include "replay/check/check.hpp"
#include "replay/foam/recording.hpp"

namespace replay {

/// Pressure, side dots, look-up curves and true forces: units, signs, order.
void check_numbers(const Recording& recording, Findings& findings);
/// The reference: its depth compared with camera, pad and light.
void check_reference(const Recording& recording, Findings& findings);
/// Exposure, noise and lamp of the frames, contact in the free frames, and the tare of the force
/// gauge.
void check_light(Recording& recording, Findings& findings);
/// The dots of dots.csv, or the print compared with the dots in the reference.
void check_dots(const std::filesystem::path& folder,
                const Recording& recording,
                Findings& findings);
/// The directions of forces.csv compared with the motion of the dots.
void check_gauge(const std::filesystem::path& folder, Recording& recording, Findings& findings);
/// Clock and taxels of a foam array.
void check_foam(const FoamRecording& recording, Findings& findings);
/// Times in s, one per `what` ("frame", "sample"); NaN if missing.
void check_clock(const std::string& place,
                 const std::string& what,
                 const std::vector<double>& times_s,
                 Findings& findings);

inline std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace replay
