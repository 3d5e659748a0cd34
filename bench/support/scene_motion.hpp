// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Objects that move over finite-element membranes, frame by frame: dots in space from noisy frames
// (scene_frames.hpp), with 0.06 px of noise of the dots, measured contact, and the true pose of the
// object (tests/data/motion_poses.csv).
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "scene_frames.hpp"
#include "support/stick_scene.hpp"

namespace bench {

using SpatialDots = test::Image<fingerpad::Point3<double>>;

struct SceneMotionFrame {
  SpatialDots dots_mm;
  test::ContactFlags contact;
  fingerpad::Pose<double> truth;  ///< of the object, from the first frame of the recording
};

struct SceneMotion {
  SpatialDots initial_mm;
  fingerpad::Point3<double> middle_mm;  ///< of the contact in the first frame
  std::vector<SceneMotionFrame> frames;
};

struct PoseRecord {
  fingerpad::Index step;
  std::string heights;
  fingerpad::Pose<double> pose;
};

inline std::vector<PoseRecord> pose_records(const std::string& scene) {
  auto file = test::open_data("motion_poses.csv", "scene,step,heights,");
  std::string line, name, step, heights, cell;
  std::getline(file, line);
  std::vector<PoseRecord> records;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::getline(cells, name, ',');
    std::getline(cells, step, ',');
    std::getline(cells, heights, ',');
    double pose[6];
    for (double& number : pose) {
      std::getline(cells, cell, ',');
      number = std::stod(cell);
    }
    if (name == scene) {
      const fingerpad::Angles<double> angles{pose[3], pose[4], pose[5]};
      records.push_back(
          {std::stol(step), heights, {rotation_of(angles), {pose[0], pose[1], pose[2]}}});
    }
  }
  test::require_data(!records.empty(), "motion_poses.csv has no " + scene);
  return records;
}

/// Dots in space from the measured depths of one frame.
inline SpatialDots dots_in_space(const test::PointsPx& dots_px, const test::Image<float>& depth) {
  SpatialDots out(dots_px.rows(), dots_px.cols());
  (void)fingerpad::spatial_dots(SceneFrames::instance().pad().camera, dots_px, depth, out);
  return out;
}

inline SceneMotion make_scene_motion(const std::string& scene, std::uint64_t seed) {
  SceneFrames& frames = SceneFrames::instance();
  const test::StickScene dots(scene);
  test::Random random(seed);
  constexpr double jitter_px = 0.06;
  SceneMotion motion;
  motion.initial_mm =
      dots_in_space(noisy(dots.dots(0), jitter_px, random), frames("free", seed).measured_mm);
  const auto records = pose_records(scene);
  const auto first = inverse(records.front().pose);
  for (const PoseRecord& record : records) {
    const SceneFrame& frame = frames(record.heights, seed);
    const auto seen = noisy(dots.dots(record.step), jitter_px, random);
    test::ContactFlags contact(seen.rows(), seen.cols());
    (void)fingerpad::contact_at_dots(seen, frame.measured, contact);
    motion.frames.push_back({dots_in_space(seen, frame.measured_mm), contact, record.pose * first});
  }
  fingerpad::Point3<double> sum{0, 0, 0};
  double count = 0;
  const auto& begin = motion.frames.front();
  for (std::size_t k = 0; k < begin.dots_mm.cells.size(); ++k) {
    const auto& p = begin.dots_mm.cells[k];
    if (begin.contact.cells[k] != 0 && !std::isnan(p.z)) {
      sum = sum + p;
      count += 1;
    }
  }
  motion.middle_mm = {sum.x / count, sum.y / count, sum.z / count};
  return motion;
}

/// Each recording is made once.
inline const SceneMotion& scene_motion(const std::string& scene, std::uint64_t seed) {
  static std::map<std::pair<std::string, std::uint64_t>, SceneMotion> made;
  const auto key = std::pair{scene, seed};
  const auto found = made.find(key);
  return found != made.end() ? found->second
                             : made.emplace(key, make_scene_motion(scene, seed)).first->second;
}

template <class S>
fingerpad::Pose<double> in_double(const fingerpad::Pose<S>& pose) {
  fingerpad::Pose<double> out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out.rotation.m[i][j] = static_cast<double>(pose.rotation.m[i][j]);
    }
  }
  const auto& t = pose.translation_mm;
  out.translation_mm = {static_cast<double>(t.x), static_cast<double>(t.y),
                        static_cast<double>(t.z)};
  return out;
}

struct SceneMotionErrors {
  std::vector<double> attitude_deg;  ///< angle of the remaining rotation
  std::vector<double> about_deg[3];  ///< errors of the angles about x, y and z
  std::vector<double> plane_mm;      ///< of the middle of the first contact, in the plane
  std::vector<double> depth_mm;      ///< the same along z
  int no_answer = 0;
};

/// Errors of every frame but the first, with noises 1 to `seeds`. `make` makes the method from the
/// dots of the free pad.
template <class Make>
SceneMotionErrors motion_on_scene(const std::string& scene, const Make& make, std::uint64_t seeds) {
  constexpr double degrees = 57.29577951308232;
  SceneMotionErrors errors;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const SceneMotion& recording = scene_motion(scene, seed);
    auto motion = make(recording.initial_mm);
    for (const SceneMotionFrame& frame : recording.frames) {
      const auto r = motion(frame.dots_mm, frame.contact);
      if (r.begun) {
        continue;
      }
      if (!r.ok()) {
        ++errors.no_answer;
        continue;
      }
      const auto truth = zyx_angles(frame.truth.rotation);
      const fingerpad::Pose<double> found = in_double(r.pose);
      const auto off = found(recording.middle_mm) - frame.truth(recording.middle_mm);
      errors.attitude_deg.push_back(degrees * angle_between(found.rotation, frame.truth.rotation));
      errors.about_deg[0].push_back(degrees * (static_cast<double>(r.angles.x_rad) - truth.x_rad));
      errors.about_deg[1].push_back(degrees * (static_cast<double>(r.angles.y_rad) - truth.y_rad));
      errors.about_deg[2].push_back(degrees * (static_cast<double>(r.angles.z_rad) - truth.z_rad));
      errors.plane_mm.push_back(std::hypot(off.x, off.y));
      errors.depth_mm.push_back(off.z);
    }
  }
  return errors;
}

/// Notes errors of attitude and place named "... on scenes", for the rolling ball.
template <class Make>
void note_motion_on_scene(Counters& counters, const Make& make) {
  SceneMotionErrors errors = motion_on_scene("roll", make, 4);
  errors.attitude_deg.resize(
      errors.attitude_deg.size() + static_cast<std::size_t>(errors.no_answer), test::nan);
  note_errors(counters, "attitude on scenes", "deg", errors.attitude_deg);
  note_errors(counters, "place on scenes", "mm", errors.depth_mm);
}

}  // namespace bench
