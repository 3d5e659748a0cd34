// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The run of the program on a recording of a foam array.
#include "replay/replay.hpp"

namespace replay {

/// The exit status: 0, or 130 where the user interrupted. Throws Failure.
int run_foam(const Options& options);

}  // namespace replay
