// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratios against the truth, on synthetic dots and on dots of finite-element membranes.
// test_figures "[stick_ratio]" -s prints all figures.
#include "fingerpad/slip/stick_ratio.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/finite_elements.hpp"
#include "support/slipping_dots.hpp"
#include "support/stick_scene.hpp"

using namespace fingerpad;
using test::ContactFlags;
using test::PointsPx;
using test::SlippedLess;
using test::SlippingPattern;
using test::SlipScene;
using test::StickError;
using test::StickScene;

namespace {

constexpr double noise_px = 0.14;  // noise of the published 0.24 px

}  // namespace

TEST_CASE("stick ratio of synthetic dots, with all effects", "[stick_ratio]") {
  // In the shear zone, dots that follow the object to within delta_0 count as sticking, which makes
  // the ratio too large. Noise of the dots makes it too small.
  for (const SlipScene scene : test::all_slip_scenes) {
    const StickError e =
        test::error_of(StickRatio<>(21, 21), scene, noise_px, SlippingPattern(), 8);
    INFO(name_of(scene) << ": mean absolute error " << e.mean_abs << ", mean " << e.mean
                        << ", worst " << e.worst << ", frames with an answer " << e.updated
                        << ", dots told wrong " << e.wrong_dots);
    CHECK(e.mean_abs <= 0.03);
    CHECK(e.updated >= 0.8);  // the first steps are shorter than U
  }
}

namespace {

constexpr double jitter_px = 0.06;
constexpr Index recordings = 20;
/// For a U of 2 px and the threshold for this noise: 2 sigma sqrt(ln(1 / p)), where p = 1 % of
/// sticking dots are taken for slipping and sigma = 0.416 x 0.06 px after denoising.
const double slip_px = 2 * 0.416 * jitter_px * std::sqrt(std::log(100.0));
const StickOptions scene_options = test::stick_options(2, slip_px);

struct SceneResult {
  double mean_abs = 0;  ///< over frames with an answer
  double mean = 0;
  double answers = 0;       ///< frames with an answer, mean of the recordings
  double to_reference = 0;  ///< the same error against the area that slipped less than the
                            ///< threshold since the reference
  Index announced_from = 1000, announced_to = -1;  ///< steps, over all recordings
  double max_sticking = 0;                         ///< the true ratio when slip is announced

  std::string line(const std::string& name) const {
    std::ostringstream line;
    line << name << ": mean absolute error " << mean_abs << ", mean " << mean << ", over "
         << answers << " frames a recording; against slip since the reference " << to_reference
         << "; announced at steps " << announced_from << " to " << announced_to
         << ", when as much as " << max_sticking << " sticks";
    return line.str();
  }
};
constexpr Index never = 999;

/// Compares with `slipped` as well; `keep` selects the steps.
template <class Slipped, class Keep>
SceneResult follow(const StickScene& scene,
                   const Slipped& slipped,
                   const Keep& keep,
                   const StickOptions& options = scene_options) {
  SceneResult result;
  double compared = 0;
  for (Index seed = 1; seed <= recordings; ++seed) {
    test::Random random(static_cast<std::uint64_t>(seed));
    StickRatio<> stick(21, 21, options);
    Index announced = never;
    for (Index k = 0; k < scene.steps(); ++k) {
      const auto r = stick(noisy(scene.dots(k), jitter_px, random), scene.contact(k));
      if (r.updated() && r.stick_ratio < 0.5 && announced == never) {
        announced = k;
        result.max_sticking = (std::max)(result.max_sticking, scene.stick_ratio(k));
      }
      if (r.updated() && keep(k)) {
        const double found = r.stick_ratio;
        // a pixel is 0.092 mm of membrane, 10 mm from the plate
        const double length_mm = 0.092 * options.slip_share * r.furthest;
        result.mean_abs += std::abs(found - scene.stick_ratio(k));
        result.mean += found - scene.stick_ratio(k);
        ++result.answers;
        const double truth = slipped(k, r.reference_age, length_mm);
        if (is_finite(truth)) {
          result.to_reference += std::abs(found - truth);
          ++compared;
        }
      }
    }
    result.announced_from = (std::min)(result.announced_from, announced);
    result.announced_to = (std::max)(result.announced_to, announced);
  }
  result.mean_abs /= result.answers;
  result.mean /= result.answers;
  result.to_reference /= compared;
  result.answers /= static_cast<double>(recordings);
  return result;
}

bool every_step(Index) {
  return true;
}

}  // namespace

TEST_CASE("stick ratio of finite-element membranes", "[stick_ratio]") {
  const auto check = [](const std::string& name, double bound) {
    const StickScene scene(name);
    const SceneResult r = follow(scene, SlippedLess(name, scene.steps()), every_step);
    INFO(r.line(name) << "; all slips at step " << scene.first_slip_of_all());
    CHECK(r.mean_abs <= bound);
    CHECK(r.announced_to < scene.first_slip_of_all());
    CHECK(r.max_sticking < 0.7);
    return r;
  };
  // The truth is slip by 5 um within a step. The estimate is slip by the threshold, 10 to 19 um,
  // since a reference one to three steps back, so slow slip counts as sticking.
  check("drag", 0.06);      // 0.050 measured, goal 0.08
  check("cylinder", 0.10);  // 0.082, goal 0.12
  // 0.088, goal 0.08: slow creep at the end, where 0.3 of the nodes stick by the truth, but 0.36 to
  // 0.45 of the area by the threshold.
  const SceneResult mix = check("mix", 0.105);
  CHECK(mix.to_reference < 0.08);
  // 0.096, goal 0.08: only four frames, with 97 dots, have an answer.
  check("twist", 0.12);
  const StickScene drag("drag");
  const SceneResult back = follow(drag, SlippedLess("drag", drag.steps()),
                                  [&](Index k) { return drag.phase(k) == "back"; });
  INFO(back.line("reversal"));
  CHECK(back.mean_abs <= 0.045);  // 0.031, goal 0.08
}

TEST_CASE("no slip is announced on finite-element membranes that stick", "[stick_ratio]") {
  const auto unknown = [](Index, Index, double) { return test::nan; };
  const StickScene press("press"), roll("roll"), tilt("tilt");
  // Dots that stick to a pressed or rolled object hardly move, so there is no motion to compare.
  CHECK(follow(press, unknown, every_step).announced_from == never);
  CHECK(follow(roll, unknown, every_step).announced_from == never);
  // With a comparison after 1 px:
  const SceneResult r = follow(press, unknown, every_step, test::stick_options(1, slip_px));
  INFO(r.line("press"));
  CHECK(r.answers > 3);
  CHECK(r.announced_from == never);
  CHECK(r.mean_abs < 0.1);
  // A tilted plate is dragged until it slips; there is no goal.
  const SceneResult dragged = follow(tilt, unknown, every_step);
  INFO(dragged.line("tilt"));
  CHECK(dragged.announced_to < tilt.first_slip_of_all());
  CHECK(dragged.max_sticking < 0.9);
}

namespace {

struct GrossSlip {
  int wrong_runs = 0;  ///< runs with a ratio above 0.5 while under 5 % stick
  int wrong_frames = 0;
  int sliding_frames = 0;
};

/// An object is dragged until nothing sticks any more, and beyond.
GrossSlip drag_to_gross_slip(double step_px, double dot_noise_px, double spring_share) {
  const SlippingPattern pattern{.rows = 15, .cols = 15, .contact_pitches = 6};
  GrossSlip result;
  for (int run = 0; run < 40; ++run) {
    test::Random random(static_cast<std::uint64_t>(1 + run));
    test::SlippingDots truth(pattern);
    StickRatio<> stick(15, 15, {.noise = dot_noise_px});
    const double direction = random.uniform(0, 6.28);
    const int growing = static_cast<int>(14 / step_px);
    int wrong = 0;
    for (int k = 0; k < growing + 66; ++k) {
      const double share = k < growing ? 1.05 - 1.05 * k / growing : -5;
      truth.step({.shift_px = step_px, .direction_rad = direction, .stick_share = share});
      truth.spring_back(spring_share);
      const auto r = stick(noisy(truth.dots, dot_noise_px, random), truth.contact);
      const bool slides = truth.stick_ratio(1) < 0.05;
      result.sliding_frames += slides ? 1 : 0;
      wrong += slides && r.ok() && r.stick_ratio > 0.5 ? 1 : 0;
    }
    result.wrong_runs += wrong > 0 ? 1 : 0;
    result.wrong_frames += wrong;
  }
  return result;
}

}  // namespace

TEST_CASE("gross slip is never taken for sticking", "[stick_ratio]") {
  // Without the distinction of standing dots from the object, up to 40 of 40 runs had hundreds of
  // frames above 0.5. Now none has one; the requirement is at most one in 40 runs.
  for (const double spring_share : {0.0, 0.05, 0.3}) {
    for (const double dot_noise_px : {0.03, 0.06, 0.14}) {
      for (const double step_px : {0.2, 0.5, 1.0, 2.0}) {
        const GrossSlip gross = drag_to_gross_slip(step_px, dot_noise_px, spring_share);
        CAPTURE(spring_share, dot_noise_px, step_px, gross.wrong_runs);
        CHECK(gross.sliding_frames > 40 * 60);
        CHECK(gross.wrong_frames <= 1);
      }
    }
  }
}
