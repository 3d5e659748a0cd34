// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// forces.csv of a recording: true forces from a force gauge or a simulation.
#include <filesystem>
#include <map>

#include "fingerpad/core/dots.hpp"

namespace replay {

/// Load that the object exerts on the pad.
struct TrueForce {
  fingerpad::Point3<double> force_n;
  double moment_n_mm = 0;  ///< about the normal through the contact's center
};

/// Reads frame,force_x_n,force_y_n,force_z_n,moment_z_nm, one line per known frame. Returns an
/// empty map if there is no such file; throws Failure.
std::map<int, TrueForce> read_true_forces(const std::filesystem::path& file, int frame_count);

}  // namespace replay
