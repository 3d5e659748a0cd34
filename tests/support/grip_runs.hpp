// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Closed loops of a simulated fingertip (bench/trials/grip) at 30 frames/s. Dots in space and the
// force of the contact, both with noise, go through StickRatio and FrictionLimit into GripControl,
// whose force goes back to the fingertip.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "bench/trials/grip/slipping_load.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/grip_control.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/pad.hpp"

namespace test {

enum class GripScene {
  slow,     ///< the load grows from 0.4 N to 3 N by 0.1 or 0.2 N/s
  fast,     ///< the same by 1.5 or 3 N/s
  changes,  ///< a load of 1.5 or 0.8 N; friction falls by 40 % in 3 s, rests, and comes back in 3 s
  rolls,    ///< the contact rolls 3 mm back and forth while the load grows to 2 N by 0.2 N/s
};
inline constexpr std::array grip_scenes = {GripScene::slow, GripScene::fast, GripScene::changes,
                                           GripScene::rolls};
inline constexpr int runs_of_a_grip_scene = 10;

/// Differences of a run from the usual one.
struct GripVariation {
  double friction = 1;                          ///< factor
  double load = 1;                              ///< factor
  double lateral_mm = 0.005, depth_mm = 0.025;  ///< noise of the dots
  double force_share = 0.015;                   ///< noise of the forces
  double lag_s = 0;                             ///< of the gripper
  double first = 2;  ///< force of the first grip over the least holding force
  bool falls_twice =
      false;  ///< friction, where it changes: by 30 % in 1 s, 3 s later by 40 % in 2 s
  bool knows_force = true;    ///< false: the stick ratio alone
  bool is_controlled = true;  ///< false: the force is constant
};

struct GripRun {
  double slip_mm;  ///< of the object as a whole
  double beyond;   ///< mean over time of the force over the least holding force, minus 1
};

/// The dots of the free pad.
inline Image<fingerpad::Point3<double>> free_dots(const grip::Fingertip& tip) {
  Image<fingerpad::Point3<double>> dots(tip.dots, tip.dots);
  for (fingerpad::Index i = 0; i < tip.dots; ++i) {
    for (fingerpad::Index j = 0; j < tip.dots; ++j) {
      dots(i, j) = {tip.pitch_mm * static_cast<double>(j - tip.dots / 2),
                    tip.pitch_mm * static_cast<double>(i - tip.dots / 2), 10};
    }
  }
  return dots;
}

/// Factor of the friction at a time of GripScene::changes.
inline double friction_left(const GripVariation& vary, double time_s) {
  const auto part = [&](double from_s, double for_s) {
    return std::clamp((time_s - from_s) / for_s, 0.0, 1.0);
  };
  return vary.falls_twice ? (1 - 0.3 * part(2, 1)) * (1 - 0.4 * part(6, 2))
                          : 1 - 0.4 * (part(2, 3) - part(7, 3));
}

/// Runs 0 to 9 have the friction 0.4, 0.55, 0.7, 0.85 and 1, with the slower and with the faster
/// load.
template <class S>
GripRun run_grip(const fingerpad::GripOptions<S>& options,
                 GripScene scene,
                 int number,
                 const GripVariation& vary = {}) {
  using namespace fingerpad;
  constexpr double frame_s = 1.0 / 30;
  const double friction = vary.friction * (0.4 + 0.15 * (number % 5));
  const bool faster = number >= 5;
  const bool changes = scene == GripScene::changes, rolls = scene == GripScene::rolls;
  const double first_n = vary.load * (changes ? (faster ? 0.8 : 1.5) : 0.4);
  const double last_n = changes ? first_n : vary.load * (rolls ? 2 : 3);
  const double rise = vary.load * (scene == GripScene::slow   ? (faster ? 0.2 : 0.1)
                                   : scene == GripScene::fast ? (faster ? 3 : 1.5)
                                                              : 0.2);
  const double end_s = changes ? 12 : (last_n - first_n) / rise + 3;

  const grip::Fingertip tip{.friction = friction};
  double force_n = vary.first * first_n / friction, real_n = force_n;
  grip::SlippingLoad load(tip, first_n, force_n);
  StickRatio<S> stick_ratio(tip.dots, tip.dots, {.noise = vary.lateral_mm});
  FrictionLimit<S> limit;
  GripControl<S> control(options, S(force_n));
  Random random(static_cast<std::uint64_t>(1 + number + 100 * static_cast<int>(scene)));
  Image<Point3<double>> dots = free_dots(tip);
  Image<unsigned char> touch(tip.dots, tip.dots);
  (void)stick_ratio(dots, touch, -1);  // the pad before the grip
  double sum = 0, frames = 0;
  for (double time_s = 0; time_s < end_s && load.slip_mm() < 20; time_s += frame_s) {
    const double load_n = (std::min)(first_n + rise * time_s, last_n);
    double now = friction;
    if (changes) {
      now *= friction_left(vary, time_s);
      load.set_friction(now);
    }
    if (rolls) {
      load.roll_to(3 * std::sin(time_s * (faster ? 0.9 : 0.5)));
    }
    real_n += (force_n - real_n) * (vary.lag_s > 0 ? 1 - std::exp(-frame_s / vary.lag_s) : 1);
    load.advance(load_n, real_n, frame_s);
    for (Index i = 0; i < tip.dots; ++i) {
      for (Index j = 0; j < tip.dots; ++j) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        dots(i, j) = {load.x_mm(int(i), int(j)) + vary.lateral_mm * x,
                      load.y_mm(int(i), int(j)) + vary.lateral_mm * y, 10 + vary.depth_mm * z};
        touch(i, j) = load.touches(int(i), int(j)) ? 1 : 0;
      }
    }
    const auto stick = stick_ratio(dots, touch, time_s);
    const double normal_n = real_n * (1 + vary.force_share * random.normal());
    const double tangential_n = load.held_n() * (1 + vary.force_share * random.normal());
    const auto slip = limit(ContactLoad<S>{S(normal_n), S(std::abs(tangential_n))}, stick);
    sum += real_n * now / load_n;
    frames += 1;
    const auto grip = vary.knows_force ? control(slip, S(frame_s)) : control(stick, S(frame_s));
    force_n = vary.is_controlled ? static_cast<double>(grip.force_n) : force_n;
  }
  return {load.slip_mm(), sum / frames - 1};
}

}  // namespace test
