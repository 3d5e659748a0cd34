// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// forces.csv of a recording: what a force gauge measured, or a simulation knows.
#include <filesystem>
#include <map>

#include "fingerpad/core/dots.hpp"

namespace replay {

/// What the object exerts on the pad.
struct TrueForce {
  fingerpad::Point3<double> force_n;
  double moment_n_mm = 0;  ///< about the normal through the middle of the contact
};

/// frame,force_x_n,force_y_n,force_z_n,moment_z_nm, a line for each frame that is known. Nothing
/// where there is no such file; throws Failure.
std::map<int, TrueForce> read_true_forces(const std::filesystem::path& file, int frame_count);

}  // namespace replay
