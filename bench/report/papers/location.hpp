// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Displacement of objects from rendered frames of finite-element membranes.
#include <string>
#include <vector>

#include "bench/support/scene_motion.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "table.hpp"

namespace bench::papers {

inline Section location_section() {
  using namespace fingerpad;
  constexpr std::uint64_t seeds = 4;
  const auto printed = [](const SpatialDots& free) { return published::ObjectMotion(free); };
  const auto by_default = [](const SpatialDots& free) {
    return ObjectMotion<>(free.rows(), free.cols());
  };
  const auto old_drag = motion_on_scene("drag", printed, seeds);
  const auto drag = motion_on_scene("drag", by_default, seeds);
  const auto old_roll = motion_on_scene("roll", printed, seeds);
  const auto roll = motion_on_scene("roll", by_default, seeds);
  const auto worst = [](const std::vector<double>& e) { return number(Spread(e).worst); };
  const std::string press = "plate pressed by 1.4 mm more, then dragged 1.0 mm; it begins to slip";
  const std::string ball = "sphere of 18 mm that rolls by 20 degrees about y";
  return {"Position and rotation of the object [C]",
          {{"moved along x and z", "largest error along the plate, mm", "0.3",
            worst(old_drag.plane_mm), worst(drag.plane_mm), press},
           {"", "largest error along z, mm", "0.4", worst(old_drag.depth_mm), worst(drag.depth_mm),
            "the same"},
           {"moved along z, rotated about x", "largest error of the angle, degrees", "3",
            worst(old_drag.attitude_deg), worst(drag.attitude_deg),
            "the same plate, which does not rotate"},
           {"rolled", "largest error of the angle about the axis, degrees", "10 (slides)",
            worst(old_roll.about_deg[1]), worst(roll.about_deg[1]), ball},
           {"", "largest angle of what is left of the attitude, degrees", "",
            worst(old_roll.attitude_deg), worst(roll.attitude_deg), "the same"},
           {"", "largest error of position, mm", "0.5 (slides)", worst(old_roll.depth_mm),
            worst(roll.depth_mm), "the same, along z"}}};
}

}  // namespace bench::papers
