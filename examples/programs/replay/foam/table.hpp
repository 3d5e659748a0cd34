// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The columns of frames.csv of a foam recording.
#include <vector>

#include "common/table.hpp"
#include "replay/foam/step.hpp"

namespace replay {

std::vector<Column<FoamRow>> foam_columns(const FoamSensor& sensor);

}  // namespace replay
