// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on the pose of the object. A rigid object carries dots 1.5 mm apart; noise of 0.02 mm in
// the plane and 0.05 mm in depth; 60 frames, 150 for a roll.
// A patch of 5 mm around the middle touches:
//   press                carried 2 mm deeper
//   drag                 dragged by 3 mm, while the patch slips from its edge to 3.8 mm
//   reversal             the same, and back
//   twist                rotated by 20 degrees, while it slips
//   normal force change  2 mm deeper and back, the patch growing from 3.5 to 6 mm and shrinking
//   rolling              tests/support/rolling.hpp: a ball of 18 mm rolled along a circle
//   wedge                a strip 3 dots wide touches; rocked by 10 degrees about its long axis,
//                        then rotated by 20 about z
//   tilted               tilted by 15 degrees, then in all directions, once around
//   noisy                the tilt with three times the noise
//   dots lost            the tilt with a fifth of the dots missing, different ones in each frame
// Errors: the angle of the remaining rotation and the place, in each frame with a pose.
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "support/rolling.hpp"
#include "table.hpp"

namespace bench::ablation {

struct MotionFrame {
  test::Dots dots;
  test::Flags contact;
  fingerpad::Pose<double> truth;
};
using MotionRecording = std::vector<MotionFrame>;

struct MotionRecordings {
  Scene scene;
  fingerpad::Point3<double> middle_mm;  ///< of the first contact
  std::vector<MotionRecording> recordings;
};

/// Motion of an object as functions of the elapsed share of the recording.
struct Held {
  std::function<fingerpad::Pose<double>(double)> pose;  ///< about the middle of the contact
  std::function<double(double)> patch_mm = [](double) { return 5.0; };
  std::function<double(double)> stick_mm = [](double) { return 99.0; };  ///< beyond, dots slip
  double half_width_mm = 99;                                             ///< of the contact along y
  double noise = 1;
  double lost_share = 0;
};

/// `noise`: 1, or 0 for exact dots.
inline MotionRecording recording_of(const Held& held, double noise, std::uint64_t seed) {
  constexpr int frames = 60;
  constexpr double depth_mm = 10;
  const test::RollingBall grid;
  const test::Dots free = grid.initial();
  test::Dots on_object = free, dots = free;
  test::Flags contact(grid.rows, grid.cols, 0);
  test::Gauss gauss(seed);
  std::mt19937_64 bits(seed);
  const fingerpad::Point3<double> middle{0, 0, depth_mm};
  MotionRecording recording;
  for (int k = 0; k < frames; ++k) {
    const double share = static_cast<double>(k) / (frames - 1);
    const auto about = held.pose(share);
    const fingerpad::Pose<double> pose{about.rotation,
                                       about.translation_mm + middle - about.rotation(middle)};
    for (std::size_t c = 0; c < free.cells.size(); ++c) {
      const auto& f = free.cells[c];
      const double r = std::hypot(f.x, f.y);
      const bool touches = r < held.patch_mm(share) && std::abs(f.y) < held.half_width_mm;
      if (touches && contact.cells[c] == 0) {
        const auto taken = inverse(pose)(fingerpad::Point3<double>{f.x, f.y, 0});
        on_object.cells[c] = {taken.x, taken.y, depth_mm};
      } else if (touches && r > held.stick_mm(share)) {
        // a slipping dot keeps its position in the plane
        const auto slid = inverse(pose)(dots.cells[c]);
        on_object.cells[c] = {slid.x, slid.y, depth_mm};
      }
      contact.cells[c] = touches ? 1 : 0;
      dots.cells[c] = touches ? pose(on_object.cells[c]) : f;
    }
    auto seen = noisy(dots, contact, gauss, 0.02 * noise * held.noise, 0.05 * noise * held.noise);
    for (auto& p : seen.cells) {
      if (std::ldexp(static_cast<double>(bits() >> 11U), -53) < held.lost_share) {
        p = fingerpad::detail::missing_point<double>();
      }
    }
    recording.push_back({seen, contact, pose});
  }
  return recording;
}

inline MotionRecording rolling_along_a_circle(double noise, std::uint64_t seed) {
  test::Gauss gauss(seed);
  const auto x = [](int k) { return 4.8 * std::cos(k * 0.0416) + 0.2; };
  const auto y = [](int k) { return 4.8 * std::sin(k * 0.0416) - 0.1; };
  test::Rolling roll(test::RollingBall(), x(0), y(0));
  MotionRecording recording;
  for (int k = 0; k < 150; ++k) {
    roll.step(x(k), y(k));
    const auto dots = noisy(roll.dots, roll.contact, gauss, 0.02 * noise, 0.05 * noise);
    recording.push_back({dots, roll.contact, roll.pose});
  }
  // poses are relative to the first visible frame
  const auto first = inverse(recording.front().truth);
  for (auto& frame : recording) {
    frame.truth = frame.truth * first;
  }
  return recording;
}

/// Motion of the held object in each scene that has no recording of its own.
struct HeldScenes {
  Held press, drag, reversal, twist, force, strip, tilted;
};

inline HeldScenes held_scenes() {
  using fingerpad::Pose;
  constexpr double degree = std::numbers::pi / 180;
  const auto turn = [](double x, double y, double z) {
    return test::turned_by({x * degree, y * degree, z * degree});
  };
  const auto shift = [=](double x, double z) { return Pose<double>{turn(0, 0, 0), {x, 0, z}}; };
  const auto about = [](const auto& rotation) { return Pose<double>{rotation, {0, 0, 0}}; };
  const auto there_and_back = [](double share) { return 1 - std::abs(2 * share - 1); };
  const auto to_edge = [](double share) { return 5.2 - 1.4 * share; };
  HeldScenes s;
  s.press.pose = [=](double share) { return shift(0, -2 * share); };
  s.drag.pose = [=](double share) { return shift(3 * share, 0); };
  s.drag.stick_mm = to_edge;
  s.reversal.pose = [=](double share) { return shift(3 * there_and_back(share), 0); };
  s.reversal.stick_mm = [=](double share) {
    return to_edge(share < 0.5 ? 2 * share : 2 * share - 1);
  };
  s.twist.pose = [=](double share) { return about(turn(0, 0, 20 * share)); };
  s.twist.stick_mm = to_edge;
  s.force.pose = [=](double share) { return shift(0, -2 * there_and_back(share)); };
  s.force.patch_mm = [=](double share) { return 3.5 + 2.5 * there_and_back(share); };
  s.strip.pose = [=](double share) {
    const double first_half = (std::min)(1.0, 2 * share);
    const double second_half = (std::max)(0.0, 2 * share - 1);
    return about(turn(0, 0, 20 * second_half) * turn(10 * first_half, 0, 0));
  };
  s.strip.half_width_mm = 2;
  s.strip.patch_mm = [](double) { return 7.0; };
  s.tilted.pose = [=](double share) {
    const double angle = 15 * (std::min)(1.0, 5 * share);
    const double direction = 2 * std::numbers::pi * (std::max)(0.0, share - 0.2) / 0.8;
    return about(turn(angle * std::cos(direction), angle * std::sin(direction), 0));
  };
  return s;
}

inline std::vector<MotionRecordings> motion_recordings(double noise) {
  std::vector<MotionRecordings> all;
  const auto add = [&](Scene scene, const auto& make) {
    all.push_back({scene, {0, 0, 10}, {}});
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      all.back().recordings.push_back(make(noise, seed));
    }
  };
  const auto held = [](const Held& h) {
    return [h](double by, std::uint64_t seed) { return recording_of(h, by, seed); };
  };
  const HeldScenes scenes = held_scenes();
  Held rough = scenes.tilted, sparse = scenes.tilted;
  rough.noise = 3;
  sparse.lost_share = 0.2;
  add(Scene::press, held(scenes.press));
  add(Scene::drag, held(scenes.drag));
  add(Scene::reversal, held(scenes.reversal));
  add(Scene::twist, held(scenes.twist));
  add(Scene::normal_force_change, held(scenes.force));
  add(Scene::rolling, rolling_along_a_circle);
  all.back().middle_mm = {5, -0.1, 10};
  add(Scene::wedge, held(scenes.strip));
  add(Scene::tilted, held(scenes.tilted));
  if (noise > 0) {
    add(Scene::noisy, held(rough));
  }
  add(Scene::dots_lost, held(sparse));
  return all;
}

struct PoseErrors {
  Errors attitude_deg;
  Errors place_mm;  ///< of the middle of the first contact
};

template <class Motion>
PoseErrors pose_errors(const Motion& fresh, const MotionRecordings& of) {
  PoseErrors errors;
  for (const MotionRecording& recording : of.recordings) {
    auto motion = fresh;
    for (const MotionFrame& frame : recording) {
      const auto r = motion(frame.dots, frame.contact);
      if (r.begun) {
        continue;
      }
      const double none = std::numeric_limits<double>::quiet_NaN();
      const double angle = angle_between(r.pose.rotation, frame.truth.rotation);
      const auto off = r.pose(of.middle_mm) - frame.truth(of.middle_mm);
      errors.attitude_deg.add(r.ok() ? 180 / std::numbers::pi * angle : none);
      errors.place_mm.add(r.ok() ? std::sqrt(squared_norm(off)) : none);
    }
  }
  return errors;
}

class MotionEffects {
 public:
  /// Adds rows for exact dots, and for attitude and place with noisy dots.
  template <class With, class Without>
  void add(const std::string& name,
           const std::string& on,
           const std::string& off,
           const With& with,
           const Without& without) {
    Effect row{.name = name, .unit = "degrees", .on = on, .off = off};
    const MotionRecording& twist = noisy_[3].recordings.front();
    const auto run = [&](auto motion) {
      for (const auto& frame : twist) {
        (void)motion(frame.dots, frame.contact);
      }
    };
    row.cost_us =
        cost_us([&] { run(with); }, [&] { run(without); }, static_cast<double>(twist.size()));
    Effect attitude = row, place = row;
    row.quantity = "attitude by exact dots";
    attitude.quantity = "attitude by noisy dots";
    place.quantity = "place by noisy dots";
    place.unit = "mm";
    for (const auto& recordings : exact_) {
      row.with_in(recordings.scene).add(pose_errors(with, recordings).attitude_deg);
      row.without_in(recordings.scene).add(pose_errors(without, recordings).attitude_deg);
    }
    for (const auto& recordings : noisy_) {
      const PoseErrors e_with = pose_errors(with, recordings);
      const PoseErrors e_without = pose_errors(without, recordings);
      attitude.with_in(recordings.scene).add(e_with.attitude_deg);
      attitude.without_in(recordings.scene).add(e_without.attitude_deg);
      place.with_in(recordings.scene).add(e_with.place_mm);
      place.without_in(recordings.scene).add(e_without.place_mm);
    }
    effects.insert(effects.end(), {row, attitude, place});
  }

  std::vector<Effect> effects;

 private:
  std::vector<MotionRecordings> exact_ = motion_recordings(0);
  std::vector<MotionRecordings> noisy_ = motion_recordings(1);
};

inline std::vector<Effect> motion_effects() {
  using namespace fingerpad;
  MotionEffects all;
  const auto initial = test::RollingBall().initial();
  all.add("map of all dots, rotations composed", "`ObjectMotion`", "`published::ObjectMotion`",
          ObjectMotion<>(initial.rows(), initial.cols()), published::ObjectMotion(initial));
  return all.effects;
}

}  // namespace bench::ablation
