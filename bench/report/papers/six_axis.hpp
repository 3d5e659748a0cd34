// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Six-axis force of finite-element membranes, by exact shapes and side dots and by noisy frames
// with side dots of 0.06 px of noise.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bench/support/scene_frames.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "support/rolling.hpp"
#include "support/wrench_frames.hpp"
#include "table.hpp"

namespace bench::papers {

/// Full scales: the largest values of all scenes, in N, N and N mm.
struct FullScale {
  double along = 0, normal = 0, moment_z = 0;
  FullScale() {
    for (const auto& f : test::wrench_frames()) {
      along = (std::max)(along, f.largest_fxy);
      normal = (std::max)(normal, f.largest_fz);
      moment_z = (std::max)(moment_z, f.largest_mz);
    }
  }
};

struct Loads {
  std::vector<double> normal, along, moment_z;  ///< errors
  double along_gain = 0;                        ///< slope of the results over the truth
  double moment_gain = 0;
  int no_answer = 0;
};

inline const fingerpad::PadHeights<>::Map& measured_heights(const std::string& name) {
  static std::map<std::string, fingerpad::PadHeights<>::Map> all;
  const auto found = all.find(name);
  if (found != all.end()) {
    return found->second;
  }
  SceneFrames& scenes = SceneFrames::instance();
  const test::Pad& pad = scenes.pad();
  const fingerpad::PadHeights<fingerpad::Camera<double>> in_plan(pad.rows, pad.cols, pad.camera);
  auto map = in_plan.map();
  (void)in_plan(scenes(name).measured_mm, scenes(name).measured, map);
  return all.emplace(name, map).first->second;
}

/// Loads of the frames of one scene; `noisy`: from measured frames, otherwise from exact shapes.
template <class W>
Loads loads_of(W wrench, const std::string& scene, bool noisy) {
  Loads e;
  double along = 0, along_sq = 0, moment = 0, moment_sq = 0;
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    if (f.scene != scene) {
      continue;
    }
    auto dots = test::rows_of(f.dots, 1);
    test::Gauss gauss(f.number);
    for (auto& p : dots.cells) {
      const double sd = noisy ? 0.06 * 0.08 : 0;
      p = {p.x + sd * gauss(), p.y + sd * gauss(), p.z + sd * gauss()};
    }
    const auto& heights = noisy ? measured_heights(f.heights) : test::exact_heights(f.heights);
    const auto r = wrench(heights, dots, f.pressure_mpa);
    if (!r.ok()) {
      ++e.no_answer;
      continue;
    }
    e.normal.push_back(r.force_n.z - f.force_n.z);
    e.along.push_back(std::hypot(r.force_n.x - f.force_n.x, r.force_n.y - f.force_n.y));
    e.moment_z.push_back(r.moment_n_mm.z - f.moment_n_mm.z);
    along += r.force_n.x * f.force_n.x + r.force_n.y * f.force_n.y;
    along_sq += f.force_n.x * f.force_n.x + f.force_n.y * f.force_n.y;
    moment += r.moment_n_mm.z * f.moment_n_mm.z;
    moment_sq += f.moment_n_mm.z * f.moment_n_mm.z;
  }
  e.along_gain = along / along_sq;
  e.moment_gain = moment / moment_sq;
  return e;
}

inline Section six_axis_section() {
  using namespace fingerpad;
  const auto rim = test::rim_border();
  const published::SegmentEquilibrium<> old(rim);
  const Wrench<> ours(rim, {.side_dot_length_mm = 0.79995, .stress_free_inclination_rad = 1.0623});
  const FullScale full;
  Section section{"Six-axis force [M]", {}};
  const auto add = [&](const std::string& experiment, const std::string& figure,
                       const std::string& printed, const std::string& scene,
                       const std::string& nearest,
                       const std::function<std::string(const Loads&)>& cell) {
    const auto cells = [&](const auto& wrench) {
      const auto told = [&](bool noisy) {
        const Loads loads = loads_of(wrench, scene, noisy);
        return (loads.normal.empty() ? "" : cell(loads)) +
               (loads.no_answer > 0 ? " (no answer " + std::to_string(loads.no_answer) + " times)"
                                    : "");
      };
      return told(false) + "; frames " + told(true);
    };
    section.rows.push_back({experiment, figure, printed, cells(old), cells(ours), nearest});
  };
  const auto normal = [&](const Loads& e) { return percent(Spread(e.normal).worst / full.normal); };
  const auto along = [&](const Loads& e) { return Spread(e.along).shares(full.along); };
  const auto twist = [&](const Loads& e) {
    return percent(Spread(e.moment_z).worst / full.moment_z);
  };
  const std::string worst_fz = "largest error of F_z, of the full scale";
  add("flat, cylinder, triangular pole pressed to 28, 22, 15 N", worst_fz, "9.5 % (2.70 N)",
      "press", "flat plate, 9.9 N", normal);
  add("", "", "", "cylinder", "cylinder of 12 mm, pressed and dragged", normal);
  add("", "", "", "roll", "sphere of 18 mm", normal);
  add("triangular pole dragged along x", "error of F_x, mean / largest", "7.0 % / 19.7 %", "drag",
      "plate dragged half way to slip, slipping, half way back; F_x and F_y together", along);
  add("", "", "", "cylinder", "cylinder dragged across", along);
  add("", "", "", "tilt", "tilted plate, pressed and dragged", along);
  add("", worst_fz, "7.0 % (1.99 N)", "drag", "plate dragged", normal);
  add("plate turned to slip", "largest error of M_z", "13.1 % (0.0177 Nm)", "twist",
      "plate turned half way to slip, and slipping", twist);
  add("", worst_fz, "3.26 % (0.92 N)", "twist", "the same", normal);
  add("", "share of the true force along the plate", "", "drag", "plate dragged",
      [](const Loads& e) { return percent(e.along_gain); });
  add("", "share of the true M_z", "", "twist", "plate turned",
      [](const Loads& e) { return percent(e.moment_gain); });
  return section;
}

}  // namespace bench::papers
