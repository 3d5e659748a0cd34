// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Runs the program on a recording of a foam array.
#include "replay/replay.hpp"

namespace replay {

/// Returns the exit status: 0, or 130 after an interrupt. Throws Failure.
int run_foam(const Options& options);

}  // namespace replay
