// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on the six-axis force, from shapes and side dots of finite-element membranes
// (tests/data/wrench_*). Scenes are those of membranes.hpp, beside:
//   rolling, wedge, tilted  the steps of these names, and those while they are dragged
//   noisy                   drag and twist, slipping, with twice the noise of the side dots
//   dots lost               the same two, a fifth of the side dots not found
// The shape is exact; side dots have 0.06 px (of 0.08 mm) of noise. Eight noises a frame. Errors:
// length of the difference of force, and of moment, to the truth. The free pad has no force,
// whatever is switched on.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "../../tests/support/rolling.hpp"
#include "fingerpad/wrench.hpp"
#include "membranes.hpp"

namespace bench::ablation {

inline constexpr Index side_dots = 72;
using SideDots = Image<fingerpad::Point3<double>>;

struct WrenchFrame {
  std::string name, heights, scene;
  double pressure_mpa = 0;
  fingerpad::Point3<double> force_n{}, moment_n_mm{};
  SideDots dots{1, side_dots, {0, 0, 0}};
  fingerpad::HeightMap<double> map{19.5, 0.5};
};

inline void fill_heights(WrenchFrame& f) {
  const Membrane membrane(f.heights);
  f.map.fill(
      [&](Index i, Index j) {
        const double x = f.map.position_mm(j), y = f.map.position_mm(i);
        return std::hypot(x, y) > base_radius_mm ? test::nan : membrane.height(x, y);
      },
      [&](Index i, Index j, const auto&...) {
        double share = 0;  // the mean over the node's surroundings
        for (const double down : {-0.125, 0.125}) {
          for (const double right : {-0.125, 0.125}) {
            share += membrane.touches(f.map.position_mm(j) + right, f.map.position_mm(i) + down)
                         ? 0.25
                         : 0;
          }
        }
        return share;
      });
}

inline std::vector<WrenchFrame> wrench_frames() {
  auto file = open_data("wrench_frames.csv", "frame,heights,scene,step,");
  auto dots = open_data("wrench_side_dots.csv", "frame,row,");
  std::vector<WrenchFrame> frames;
  std::string line, cell;
  std::getline(file, line);
  std::getline(dots, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    WrenchFrame f;
    std::getline(cells, f.name, ',');
    std::getline(cells, f.heights, ',');
    std::getline(cells, f.scene, ',');
    std::getline(cells, cell, ',');
    for (double* number : {&f.pressure_mpa, &f.force_n.x, &f.force_n.y, &f.force_n.z,
                           &f.moment_n_mm.x, &f.moment_n_mm.y, &f.moment_n_mm.z}) {
      std::getline(cells, cell, ',');
      *number = std::stod(cell);
    }
    for (int row = 1; row <= 3; ++row) {  // the first is that of one row of side dots
      std::getline(dots, line);
      std::istringstream numbers(line);
      std::getline(numbers, cell, ',');
      require(cell == f.name, "side dots of another frame than " + f.name);
      std::getline(numbers, cell, ',');
      for (Index k = 0; row == 1 && k < side_dots; ++k) {
        for (double* number : {&f.dots(0, k).x, &f.dots(0, k).y, &f.dots(0, k).z}) {
          std::getline(numbers, cell, ',');
          *number = std::stod(cell);
        }
      }
    }
    fill_heights(f);
    frames.push_back(f);
  }
  require(frames.size() == 15, "not 15 frames with forces");
  return frames;
}

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

inline SideDots border() {
  SideDots points(1, side_dots, {0, 0, 0});
  for (Index k = 0; k < side_dots; ++k) {
    const double at = 2 * std::numbers::pi * static_cast<double>(k) / side_dots;
    points(0, k) = {base_radius_mm * std::cos(at), base_radius_mm * std::sin(at), 0};
  }
  return points;
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
    for (const WrenchFrame& f : wrench_frames()) {
      shown_.push_back({scene_of(f), f, 1, 0});
      if (f.name == "drag_b" || f.name == "twist_b") {
        shown_.push_back({Scene::noisy, f, 2, 0});
        shown_.push_back({Scene::dots_lost, f, 1, 0.2});
      }
    }
  }

  /// Two rows, by the force and by the moment.
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
    auto work_with = with.workspace();
    auto work_without = without.workspace();
    force.cost_us = moment.cost_us =
        cost_us([&] { with(drag.map, drag.dots, drag.pressure_mpa, work_with); },
                [&] { without(drag.map, drag.dots, drag.pressure_mpa, work_without); });
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
  static void note(const W& wrench, const Shown& s, Errors& force, Errors& moment) {
    using fingerpad::detail::difference, fingerpad::detail::length_sq;
    auto workspace = wrench.workspace();
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const auto dots = seen_dots(s.frame.dots, s.noise, s.lost_share, seed);
      const auto r = wrench(s.frame.map, dots, s.frame.pressure_mpa, workspace);
      force.add(std::sqrt(length_sq(difference(r.force_n, s.frame.force_n))));
      moment.add(std::sqrt(length_sq(difference(r.moment_n_mm, s.frame.moment_n_mm))));
    }
  }

  std::vector<Shown> shown_;
};

inline std::vector<Effect> wrench_effects() {
  using namespace fingerpad;
  WrenchOptions<double> options;
  options.side_dot_length_mm = 0.79995;  // chord of 0.8 mm of a sphere of 21.45 mm
  const auto rim = border();
  const ExtrapolatedRow carried{1.0623};  // of a cap 11 mm high: 2 atan(11 / 18.735)
  const Wrench<> squares(rim, options);
  const Wrench<LeastSquares, ExtrapolatedRow> extrapolated(rim, options, {}, carried);
  const Wrench<PublishedIteration> clamped(rim, options);
  const Wrench<PublishedIteration, OneRow, PublishedDirection> published(rim, options);
  const Wrench<ClosedForm> columns(rim, options);
  const Wrench<BalancedRim> balanced(rim, options);
  const WrenchEffects scenes;
  std::vector<Effect> effects;
  scenes.add("shear terms", "`LeastSquares`", "`ClosedForm`", squares, columns, effects);
  scenes.add("shear terms as published", "`PublishedIteration`", "`ClosedForm`", clamped, columns,
             effects);
  scenes.add("corrected rim", "`ClampedRim`", "`PublishedDirection`", clamped, published, effects);
  scenes.add("extrapolated rim", "`ExtrapolatedRow`", "`OneRow`", extrapolated, squares, effects);
  scenes.add("inner balance", "`LeastSquares`", "`BalancedRim`", squares, balanced, effects);
  return effects;
}

}  // namespace bench::ablation
