// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Faults of a foam array that its readings show: full scale, spikes, and an array that reads more
// than nothing when nothing touches it.
#include <filesystem>

#include "replay/foam/recording.hpp"

namespace replay {

/// Leaves out what cannot be a reading, takes the zero of each taxel off, and adds to
/// `recording.told` what was done. Throws Failure for an array whose zero is not known.
void repair_readings(const std::filesystem::path& folder, FoamRecording& recording);

}  // namespace replay
