// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rows of the page, in its order.
#include <vector>

#include "depth.hpp"
#include "depth_calibration.hpp"
#include "foam.hpp"
#include "force.hpp"
#include "rotation.hpp"
#include "row.hpp"
#include "samples.hpp"
#include "stick_ratio.hpp"
#include "surface.hpp"

namespace hard {

using MakeRow = Row (*)();

inline std::vector<MakeRow> all_rows() {
  return {small_depth,  small_absorption, equal_absorption,  grazing_rays,   first_halving,
          no_depth,     saturated_pixels, scattering_at_rim, flat_section,   flat_contact,
          center_pixel, gimbal_lock,      small_angle,       thin_triangle,  half_a_turn,
          plain_press,  nothing_moved,    long_times,        short_step,     no_load,
          no_area,      below_range,      long_image,        small_vibration};
}

}  // namespace hard
