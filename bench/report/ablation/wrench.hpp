// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on the six-axis force, from shapes and side dots of finite-element membranes
// (tests/data/wrench_*). Scenes are those of membranes.hpp, except:
//   rolling, wedge, tilted  the steps of these names, and those while they are dragged
//   noisy                   drag and twist, slipping, with twice the noise of the side dots
//   dots lost               the same two, a fifth of the side dots missing
// The shape is exact; side dots have 0.06 px (of 0.08 mm) of noise, in eight realisations a frame.
// Errors: length of the difference of force, and of moment, to the truth. The free pad has no
// force, with any effect.
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "fingerpad/force/wrench.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "membranes.hpp"
#include "support/rolling.hpp"
#include "support/wrench_frames.hpp"

namespace bench::ablation {

using SideDots = Image<fingerpad::Point3<double>>;
using test::WrenchFrame;

inline Scene scene_of(const WrenchFrame& f) {
  if (f.name == "drag_c") {
    return Scene::reversal;
  }
  return f.scene == "press"   ? Scene::press
         : f.scene == "drag"  ? Scene::drag
         : f.scene == "twist" ? Scene::twist
         : f.scene == "mix"   ? Scene::normal_force_change
         : f.scene == "roll"  ? Scene::rolling
         : f.scene == "tilt"  ? Scene::tilted
                              : Scene::wedge;
}

inline SideDots seen_dots(SideDots dots, double noise, double lost_share, std::uint64_t seed) {
  test::Gauss gauss(seed);
  test::Random random(seed);
  for (auto& p : dots.cells) {
    const double sd = noise * 0.06 * 0.08;
    p = {p.x + sd * gauss(), p.y + sd * gauss(), p.z + sd * gauss()};
    if (random.uniform() < lost_share) {
      p = fingerpad::detail::missing_point<double>();
    }
  }
  return dots;
}

class WrenchEffects {
 public:
  WrenchEffects() {
    for (const WrenchFrame& f : test::wrench_frames()) {
      shown_.push_back({scene_of(f), f, 1, 0});
      if (f.name == "drag_b" || f.name == "twist_b") {
        shown_.push_back({Scene::noisy, f, 2, 0});
        shown_.push_back({Scene::dots_lost, f, 1, 0.2});
      }
    }
  }

  /// Adds two rows, for the force and for the moment.
  template <class With, class Without>
  void add(const std::string& name,
           const std::string& on,
           const std::string& off,
           const With& with,
           const Without& without,
           std::vector<Effect>& effects) const {
    Effect force{.name = name, .quantity = "force", .unit = "N", .on = on, .off = off};
    Effect moment{.name = name, .quantity = "moment", .unit = "N mm", .on = on, .off = off};
    for (const Shown& s : shown_) {
      note(with, s, force.with_in(s.scene), moment.with_in(s.scene));
      note(without, s, force.without_in(s.scene), moment.without_in(s.scene));
    }
    const WrenchFrame& drag = shown_[1].frame;
    With timed = with;
    Without timed_without = without;
    const auto& heights = test::exact_heights(drag.heights);
    const SideDots dots = test::rows_of(drag.dots, 1);
    force.cost_us = moment.cost_us =
        cost_us([&] { (void)timed(heights, dots, drag.pressure_mpa); },
                [&] { (void)timed_without(heights, dots, drag.pressure_mpa); });
    effects.push_back(force);
    effects.push_back(moment);
  }

 private:
  struct Shown {
    Scene scene;
    WrenchFrame frame;
    double noise;
    double lost_share;
  };

  template <class W>
  static void note(W wrench, const Shown& s, Errors& force, Errors& moment) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const auto dots = seen_dots(test::rows_of(s.frame.dots, 1), s.noise, s.lost_share, seed);
      const auto r = wrench(test::exact_heights(s.frame.heights), dots, s.frame.pressure_mpa);
      if (!r.ok()) {  // no answer is not counted
        continue;
      }
      force.add(norm(r.force_n - s.frame.force_n));
      moment.add(norm(r.moment_n_mm - s.frame.moment_n_mm));
    }
  }

  std::vector<Shown> shown_;
};

inline std::vector<Effect> wrench_effects() {
  using namespace fingerpad;
  WrenchOptions<double> options;
  options.side_dot_length_mm = 0.79995;  // chord of 0.8 mm of a sphere of 21.45 mm
  const auto rim = test::rim_border();
  const Wrench<> chord(rim, options);
  options.stress_free_inclination_rad = 1.0623;  // of a cap 11 mm high: 2 atan(11 / 18.735)
  const Wrench<> with_inclination(rim, options);
  const published::SegmentEquilibrium<> published(rim);
  const WrenchEffects scenes;
  std::vector<Effect> effects;
  scenes.add("corrected rim, one factor", "`Wrench`", "`published::SegmentEquilibrium`",
             with_inclination, published, effects);
  scenes.add("inclination of the rim", "`stress_free_inclination_rad`", "chord", with_inclination,
             chord, effects);
  return effects;
}

}  // namespace bench::ablation
