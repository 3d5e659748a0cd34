// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Motion of the object on finite-element membranes, from the sticking dots. test_figures
// "[object_motion]" -s prints all figures.
#include "fingerpad/motion/object_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/spatial_scene.hpp"

using namespace fingerpad;
using test::SpatialScene;
using test::SpatialStep;

namespace {

constexpr double degree = 0.017453292519943295;

struct PoseErrors {
  double place_mm = 0;               ///< rms, of the middle of the contact, since the pose began
  double rotation_deg = 0;           ///< rms
  double furthest_mm = 0;            ///< the largest error of place
  double told = 0;                   ///< share of the frames in contact with a pose
  double told_sticking = 0;          ///< the same while a fifth or more sticks
  double held_mm = 0, held_deg = 0;  ///< the same while at least a fifth has stuck since the start
};

Point3<double> middle_of(const SpatialStep& step) {
  Point3<double> sum{0, 0, 0};
  double count = 0;
  for (std::size_t k = 0; k < step.dots.cells.size(); ++k) {
    if (step.contact.cells[k] != 0) {
      sum += step.dots.cells[k];
      count += 1;
    }
  }
  return sum / count;
}

/// Errors with the slips of the dots known, or with all dots counted as sticking.
PoseErrors errors_of(const std::string& name, bool knows_slip) {
  const SpatialScene scene(name);
  const Index n = scene.dots_across();
  const double along = 0.005, deep = 0.025;
  const StickRatio<> fresh(n, n, {.noise = along});
  PoseErrors e;
  double told = 0, frames = 0, held = 0, told_sticking = 0, sticking = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    test::Random random(seed);
    StickRatio<> ratio = fresh;
    FrictionLimit<double> limit;
    ObjectMotion<> motion(n, n);
    test::Image<std::uint8_t> slips(n, n);
    Pose<double> began;
    Point3<double> middle{0, 0, 0};
    bool holds = true;
    for (Index k = 0; k < scene.size(); ++k) {
      auto dots = scene[k].dots;
      for (auto& p : dots.cells) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        p = {p.x + along * x, p.y + along * y, p.z + deep * z};
      }
      const auto seen = ratio(dots, scene[k].contact);
      const auto load =
          contact_load(scene[k].force_n, scene[k].moment_n_mm, dots, scene[k].contact);
      const auto slip = limit(load, seen);
      for (Index i = 0; knows_slip && i < n; ++i) {
        for (Index j = 0; j < n; ++j) {
          slips(i, j) = slip.holds(ratio.states()(i, j)) ? 0 : 1;
        }
      }
      const auto r = motion(dots, scene[k].contact, slips);
      const bool touches = scene[k].contact_area_mm2 > 0;
      const bool sticks = touches && scene[k].stick_ratio >= 0.2;
      frames += touches ? 1 : 0;
      sticking += sticks ? 1 : 0;
      told_sticking += sticks && r.ok() ? 1 : 0;
      holds = (r.begun || holds) && scene[k].stick_ratio >= 0.2;
      if (!r.ok()) {
        continue;
      }
      began = r.begun ? scene[k].object : began;
      middle = r.begun ? middle_of(scene[k]) : middle;
      const Pose<double> truth = scene[k].object * inverse(began);
      const double off_mm_sq = squared_norm(truth(middle) - r.pose(middle));
      const double off_deg_sq = square(angle_between(truth.rotation, r.pose.rotation) / degree);
      e.place_mm += off_mm_sq;
      e.rotation_deg += off_deg_sq;
      told += 1;
      e.furthest_mm = std::max(e.furthest_mm, std::sqrt(off_mm_sq));
      e.held_mm += holds ? off_mm_sq : 0;
      e.held_deg += holds ? off_deg_sq : 0;
      held += holds ? 1 : 0;
    }
  }
  e.place_mm = std::sqrt(e.place_mm / told);
  e.rotation_deg = std::sqrt(e.rotation_deg / told);
  e.told = told / frames;
  e.told_sticking = told_sticking / sticking;
  e.held_mm = std::sqrt(e.held_mm / held);
  e.held_deg = std::sqrt(e.held_deg / held);
  return e;
}

void check(const std::string& name, double place_mm, double rotation_deg) {
  const PoseErrors e = errors_of(name, true), blind = errors_of(name, false);
  INFO(name << ": place " << e.place_mm << " mm, rotation " << e.rotation_deg << " degrees, in "
            << e.told << " of the frames, " << e.told_sticking
            << " of those in which a fifth sticks; furthest off " << e.furthest_mm
            << " mm; while a fifth sticks " << e.held_mm << " mm, " << e.held_deg
            << " degrees; without the slips " << blind.place_mm << " mm, " << blind.rotation_deg
            << " degrees");
  CHECK(e.place_mm < place_mm);
  CHECK(e.rotation_deg < rotation_deg);
  // in the twist a fifth sticks in a quarter of the frames, the last of them barely: in 60
  // recordings 0.233 of the frames have a pose
  CHECK(e.told > 0.23);
  CHECK(e.told_sticking > 0.75);  // measured: 0.81 to 1
  CHECK(e.held_mm < 0.03);  // goal: 0.15 mm and 2 degrees; measured: 0.006 to 0.017, 0.2 to 1.1
  CHECK(e.held_deg < 1.5);
}

}  // namespace

TEST_CASE("object motion on finite-element membranes, by the dots that stick", "[object_motion]") {
  // all poses, slides included; measured: 0.010 mm 0.2 degrees, 0.006 0.2, 0.014 0.9, 0.014 0.6,
  // 0.016 0.6, 0.015 1.0, 0.015 1.0, 0.010 0.9, 0.012 0.8
  check("drag", 0.02, 0.5);
  check("twist", 0.02, 0.5);
  check("tilt", 0.03, 1.5);
  check("roll", 0.03, 1);
  check("cylinder", 0.03, 1);
  check("mix", 0.03, 1.5);
  check("rod_turn", 0.05, 1.5);
  check("rubber", 0.03, 1.5);
  check("press", 0.03, 1.5);
  // slides that carry the dots along: 0.023 mm 0.8 degrees, 0.014 0.6
  check("slide", 0.06, 1.5);
  check("ball_slip", 0.06, 1.5);
}

TEST_CASE("object motion: slides that are not told bend the pose", "[object_motion]") {
  CHECK(errors_of("drag", false).place_mm > 0.5);
  CHECK(errors_of("twist", false).rotation_deg > 5);
}
