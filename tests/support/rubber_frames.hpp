// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Steps of a membrane of Mooney-Rivlin rubber under known force and moment
// (tests/data/wrench_rubber.csv), and frames of four of them.
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "finite_elements.hpp"
#include "wrench_frames.hpp"

namespace test {

struct RubberStep {
  int number = 0;
  double pressure_mpa = 0;
  Point3<double> force_n{}, moment_n_mm{};
  Image<Point3<double>> dots{1, side_dots, {0, 0, 0}};
};

/// All steps; the first is the free pad.
inline std::vector<RubberStep> rubber_steps() {
  auto file = open_data("wrench_rubber.csv", "step,pressure_mpa,");
  std::string line, cell;
  std::getline(file, line);
  std::vector<RubberStep> all;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    const auto next = [&] {
      std::getline(cells, cell, ',');
      return std::stod(cell);
    };
    const auto next_point = [&] {
      const double x = next(), y = next();
      return Point3<double>{x, y, next()};
    };
    RubberStep step;
    step.number = static_cast<int>(next());
    step.pressure_mpa = next();
    step.force_n = next_point();
    step.moment_n_mm = next_point();
    for (auto& dot : step.dots.cells) {
      dot = next_point();
    }
    all.push_back(step);
  }
  require_data(all.size() == 10, "wrench_rubber.csv has not 10 steps");
  return all;
}

/// Name of the shape of a step; empty if it has none.
inline std::string rubber_shape(int step) {
  return step == 0    ? "wrench_rubber_free"
         : step == 14 ? "wrench_rubber_drag"
         : step == 22 ? "wrench_rubber_turn"
         : step == 30 ? "wrench_rubber_back"
                      : "";
}

constexpr double rubber_cap_height_mm = 11, rubber_apex_mm = 12.96482;
constexpr double rubber_dot_length_mm = 0.79995;

/// Side dots with the noise of a camera: 0.06 px of 0.08 mm.
inline Image<Point3<double>> jittered(Image<Point3<double>> dots, std::uint64_t seed) {
  Random random(seed);
  for (auto& p : dots.cells) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    p = p + 0.06 * 0.08 * Point3<double>{x, y, z};
  }
  return dots;
}

/// Heights from the default methods in 8-bit frames with one grey level of noise. The reference is
/// this pad's own free shape.
class RubberFrames {
 public:
  RubberFrames() {
    std::vector<Image<float>> free_mm;
    for (std::uint64_t seed = 901; seed <= 904; ++seed) {
      free_mm.push_back(estimate<float>(estimator_, scene_.frame(free_mm_, seed)).depth_mm);
    }
    test_.threshold_per_mm = fit_contact_threshold(pad().camera, free_mm).threshold_per_mm;
  }

  fingerpad::PadHeights<>::Map heights(const std::string& shape, std::uint64_t seed) {
    const auto depth =
        estimate<float>(estimator_, scene_.frame(scene_.depth(shape), seed)).depth_mm;
    fingerpad::ContactRegion<> region(pad().camera, pad().rows, pad().cols, test_);
    Image<std::uint8_t> mask(pad().rows, pad().cols);
    (void)region(depth, mask);
    const fingerpad::PadHeights<fingerpad::Camera<double>> in_plan(pad().rows, pad().cols,
                                                                   pad().camera);
    auto map = in_plan.map();
    require_data(in_plan(depth, mask, map), shape + " has no heights");
    return map;
  }

 private:
  const Pad& pad() const { return scene_.pad(); }

  Scene scene_;
  Image<double> free_mm_ = scene_.depth(rubber_shape(0));
  fingerpad::DepthEstimator<> estimator_{pad().camera, pad().fluid, scene_.reference(free_mm_)};
  fingerpad::ContactTest test_;
};

/// Slope of the result over the truth, for F_x and F_y together and for M_z.
struct RubberGain {
  double tangential = 0, turning = 0;
};

/// Slope from frames, three of each of the three steps that have shapes.
template <class W>
RubberGain gain_from_frames(W wrench, RubberFrames& frames) {
  double force = 0, force_sq = 0, moment = 0, moment_sq = 0;
  for (const RubberStep& s : rubber_steps()) {
    const std::string shape = rubber_shape(s.number);
    for (std::uint64_t seed = 1; seed <= 3 && s.number > 0 && !shape.empty(); ++seed) {
      const auto number = 10 * static_cast<std::uint64_t>(s.number) + seed;
      const auto r =
          wrench(frames.heights(shape, number), jittered(s.dots, number), s.pressure_mpa);
      require_data(r.ok(), shape + " has no force");
      force += r.force_n.x * s.force_n.x + r.force_n.y * s.force_n.y;
      force_sq += fingerpad::square(s.force_n.x) + fingerpad::square(s.force_n.y);
      moment += r.moment_n_mm.z * s.moment_n_mm.z;
      moment_sq += fingerpad::square(s.moment_n_mm.z);
    }
  }
  return {force / force_sq, moment / moment_sq};
}

}  // namespace test
