// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/true_forces.hpp"

#include <string>

#include "common/number_table.hpp"

namespace replay {

std::map<int, TrueForce> read_true_forces(const std::filesystem::path& file, int frame_count) {
  std::map<int, TrueForce> forces;
  if (!std::filesystem::exists(file)) {
    return forces;
  }
  const NumberTable table(file, {"frame", "force_x_n", "force_y_n", "force_z_n", "moment_z_nm"});
  for (const auto& line : table.lines()) {
    const int frame = table.index(line, 0, frame_count, "frames");
    const auto& v = line.values;
    if (!forces.emplace(frame, TrueForce{{v[1], v[2], v[3]}, 1000 * v[4]}).second) {
      table.refuse(line, "frame " + std::to_string(frame) + " is given twice");
    }
  }
  return forces;
}

}  // namespace replay
