// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Six-axis force of finite-element membranes: as published from exact shapes and side dots; the
// default from printed dots in the picture with 0.06 px of noise, of a plate dragged or turned.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "fingerpad/published/segment_equilibrium.hpp"
#include "support/rim_marks.hpp"
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

/// Compares frames with their truth, one after the other.
class Sums {
 public:
  template <class Result>
  void add(const Result& r, const fingerpad::Point3<double>& force, double moment_z) {
    if (!r.ok()) {
      ++loads_.no_answer;
      return;
    }
    loads_.normal.push_back(r.force_n.z - force.z);
    loads_.along.push_back(std::hypot(r.force_n.x - force.x, r.force_n.y - force.y));
    loads_.moment_z.push_back(r.moment_n_mm.z - moment_z);
    along_ += r.force_n.x * force.x + r.force_n.y * force.y;
    along_sq_ += force.x * force.x + force.y * force.y;
    moment_ += r.moment_n_mm.z * moment_z;
    moment_sq_ += moment_z * moment_z;
  }
  Loads loads() {
    loads_.along_gain = along_ / along_sq_;
    loads_.moment_gain = moment_ / moment_sq_;
    return loads_;
  }

 private:
  Loads loads_;
  double along_ = 0, along_sq_ = 0, moment_ = 0, moment_sq_ = 0;
};

/// Loads of the frames of one scene, from exact shapes and side dots.
inline Loads published_loads(const std::string& scene) {
  fingerpad::published::SegmentEquilibrium<> wrench(test::rim_border());
  Sums sums;
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    if (f.scene == scene) {
      sums.add(wrench(test::exact_heights(f.heights), test::rows_of(f.dots, 1), f.pressure_mpa),
               f.force_n, f.moment_n_mm.z);
    }
  }
  return sums.loads();
}

/// The same of a plate that is dragged or turned, from printed dots in the picture.
inline Loads loads_of_dots(const std::string& scene) {
  Sums sums;
  for (const test::RimScene& s : test::rim_scenes()) {
    if (s.name == scene) {
      test::SeenRim seen(s, test::SeenRim::options_of(s, true), 0.06, 1);
      for (std::size_t k = 1; k < s.frames.size(); ++k) {
        const auto& load = s.frames[k].load;
        sums.add(seen.fit(k), {load[0], load[1], load[2]}, load[5]);
      }
    }
  }
  return sums.loads();
}

inline Section six_axis_section() {
  using namespace fingerpad;
  const FullScale full;
  Section section{"Six-axis force [M]", {}};
  const auto add = [&](const std::string& experiment, const std::string& figure,
                       const std::string& printed, const std::string& scene,
                       const std::string& nearest,
                       const std::function<std::string(const Loads&)>& cell) {
    const auto told = [&](const Loads& loads) {
      return (loads.normal.empty() ? "" : cell(loads)) +
             (loads.normal.empty() && loads.no_answer == 0 ? "not of this scene" : "") +
             (loads.no_answer > 0 ? " (no answer " + std::to_string(loads.no_answer) + " times)"
                                  : "");
    };
    section.rows.push_back({experiment, figure, printed, told(published_loads(scene)),
                            told(loads_of_dots(scene)), nearest});
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
  add("", "", "", "two_balls", "two balls, another pad", normal);
  add("", "", "", "bowl", "hollow object, another pad", normal);
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
