// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on the stick ratio. Synthetic dots (tests/support/slipping_dots.hpp) have 0.14 px of
// noise and the published thresholds. Dots of finite-element membranes (tests/data) have 0.06 px of
// noise and the threshold for it:
//   press                appears 1.15 times as large, all sticks
//   drag                 dragged until hardly anything sticks
//   reversal             and back
//   twist                rotated by 20 degrees, in place and while it is dragged
//   normal force change  appears 1.15 and 0.85 times as large while it is dragged and slips
//   rolling              finite elements: a ball that sticks and rolls; U = 1 px, because 2 px give
//                        no answer
//   wedge                finite elements: a cylinder, dragged
//   tilted               finite elements: a tilted plate, dragged
//   noisy                the drag with 0.28 px, twice the noise for which the thresholds are made
//   dots lost            the drag with a fifth of the dots missing, different ones in each frame
// Error: of the ratio, in frames with an answer, against the dots that stuck since the reference
// frame; of finite elements, against those that stuck within the step.
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"
#include "membranes.hpp"
#include "support/published_stick.hpp"
#include "support/slipping_dots.hpp"
#include "support/stick_scene.hpp"

namespace bench::ablation {

struct StickFrame {
  test::PointsPx dots;
  test::ContactFlags contact;
  std::function<double(Index)> truth;  ///< the ratio, by the age of the reference
};
using StickRecording = std::vector<StickFrame>;

/// Of the printed method; the default has them from its noise, 0.14 px unless they are given.
using Thresholds = fingerpad::published::StickRatioOptions;

struct StickRecordings {
  Scene scene;
  Thresholds test;
  std::vector<StickRecording> recordings;
};

/// Recordings of a scene in eight directions.
inline std::vector<StickRecording> slipping(test::SlipScene scene,
                                            double noise_px = 0.14,
                                            double lost_share = 0) {
  std::vector<StickRecording> all;
  for (int n = 0; n < 8; ++n) {
    test::Random random(static_cast<std::uint64_t>(1 + n));
    test::SlippingDots truth;
    StickRecording recording;
    const auto show = [&] {
      auto dots = noisy(truth.dots, noise_px, random);
      for (auto& p : dots.cells) {
        if (lost_share > 0 && random.uniform() < lost_share) {
          p = {test::nan, test::nan};
        }
      }
      recording.push_back(
          {dots, truth.contact, [truth](Index age) { return truth.stick_ratio(age); }});
    };
    show();
    for (const auto& step : steps_of(scene, 2.4 * n)) {
      truth.step(step);
      show();
    }
    all.push_back(recording);
  }
  return all;
}

/// Dots of NAME_dots.pgm with noise of 0.06 px, and truth of stick_truth.csv.
inline std::vector<StickRecording> finite_elements(const std::string& name) {
  const test::StickScene scene(name);
  StickRecording exact;
  for (Index k = 0; k < scene.steps(); ++k) {
    const double sticks = scene.stick_ratio(k);
    exact.push_back({scene.dots(k), scene.contact(k), [sticks](Index) { return sticks; }});
  }
  std::vector<StickRecording> all;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    test::Random random(seed);
    all.push_back(exact);
    for (StickFrame& frame : all.back()) {
      frame.dots = noisy(frame.dots, 0.06, random);
    }
  }
  return all;
}

inline std::vector<StickRecordings> stick_recordings() {
  using enum test::SlipScene;
  // 1 % of sticking dots are taken for slipping
  const double slip_px = 2 * 0.416 * 0.06 * std::sqrt(std::log(100.0));
  const Thresholds steady = {.U = 2, .U_min = 0.5, .delta_0 = slip_px};
  const Thresholds closer = {.U = 1, .U_min = 0.25, .delta_0 = slip_px};
  std::vector<StickRecordings> all = {{Scene::press, {}, slipping(press)},
                                      {Scene::drag, {}, slipping(shear)},
                                      {Scene::reversal, {}, slipping(reversal)},
                                      {Scene::twist, {}, slipping(turn)},
                                      {Scene::twist, {}, slipping(shift_turn)},
                                      {Scene::normal_force_change, {}, slipping(zoom_in)},
                                      {Scene::normal_force_change, {}, slipping(zoom_out)},
                                      {Scene::rolling, closer, finite_elements("roll")},
                                      {Scene::wedge, steady, finite_elements("cylinder")},
                                      {Scene::tilted, steady, finite_elements("tilt")},
                                      {Scene::noisy, {}, slipping(shear, 0.28)},
                                      {Scene::dots_lost, {}, slipping(shear, 0.14, 0.2)}};
  return all;
}

inline fingerpad::StickRatio<> stick_ratio(const Thresholds& of) {
  const bool given = of.delta_0 != Thresholds().delta_0;
  return {21, 21, given ? test::stick_options(of.U, of.delta_0) : fingerpad::StickOptions()};
}
inline test::PublishedStick printed(const Thresholds& of) {
  return {.ratio = {21, 21, of}};
}

template <class Ratio>
Errors stick_errors(const Ratio& ratio, const StickRecordings& of) {
  Errors errors;
  for (const StickRecording& recording : of.recordings) {
    Ratio stick = ratio;
    for (const StickFrame& frame : recording) {
      const auto r = stick(frame.dots, frame.contact);
      if (r.updated()) {
        errors.add(static_cast<double>(r.stick_ratio) - frame.truth(r.reference_age));
      }
    }
  }
  return errors;
}

/// With the effect and with it off; both are made of thresholds.
template <class With, class Without>
Effect stick_effect(const std::vector<StickRecordings>& all,
                    const std::string& name,
                    const std::string& on,
                    const std::string& off,
                    const With& with_of,
                    const Without& without_of) {
  Effect effect{.name = name, .quantity = "stick ratio", .unit = "1", .on = on, .off = off};
  for (const auto& recordings : all) {
    effect.with_in(recordings.scene).add(stick_errors(with_of(recordings.test), recordings));
    effect.without_in(recordings.scene).add(stick_errors(without_of(recordings.test), recordings));
  }
  const StickRecording& drag = all[1].recordings.front();
  const auto run = [&](const auto& ratio) {
    return [&, stick = ratio]() mutable {
      stick = ratio;
      for (const auto& frame : drag) {
        (void)stick(frame.dots, frame.contact);
      }
    };
  };
  const auto with = with_of({});
  const auto without = without_of({});
  auto run_with = run(with);
  auto run_without = run(without);
  effect.cost_us =
      cost_us([&] { run_with(); }, [&] { run_without(); }, static_cast<double>(drag.size()));
  return effect;
}

inline std::vector<Effect> stick_effects() {
  const auto all = stick_recordings();
  const auto without = [&](const char* name, const char* off, const auto& switch_off) {
    return stick_effect(all, name, "`published::StickRatio`", off, printed,
                        [switch_off](Thresholds options) {
                          switch_off(options);
                          return printed(options);
                        });
  };
  return {
      without("denoise", "`S2 = S3 = 0`", [](Thresholds& o) { o.S2 = o.S3 = 0; }),
      without("rotation cancel", "`cancels_rotation = false`",
              [](Thresholds& o) { o.cancels_rotation = false; }),
      without("scale cancel", "`StickScale::none`",
              [](Thresholds& o) { o.scale = fingerpad::published::StickScale::none; }),
      without("reference update", "`updates = false`", [](Thresholds& o) { o.updates = false; }),
      stick_effect(all, "motion of many dots", "`StickRatio<>`", "`published::StickRatio`",
                   stick_ratio, printed)};
}

}  // namespace bench::ablation
