// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/true_forces.hpp"

#include <string>

#include "common/table.hpp"

namespace replay {

std::map<int, TrueForce> read_true_forces(const std::filesystem::path& file, int frame_count) {
  std::map<int, TrueForce> forces;
  if (!std::filesystem::exists(file)) {
    return forces;
  }
  Table table(file, {"frame", "force_x_n", "force_y_n", "force_z_n", "moment_z_nm"});
  while (table.next()) {
    const int frame = table.index(0, frame_count, "frames");
    const TrueForce force{{table.number(1), table.number(2), table.number(3)},
                          1000 * table.number(4)};
    if (!forces.emplace(frame, force).second) {
      table.refuse("frame " + std::to_string(frame) + " is given twice");
    }
  }
  return forces;
}

}  // namespace replay
