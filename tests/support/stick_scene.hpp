// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Printed dots of a finite-element membrane, step by step while an object moves on it, with the
// true stick ratio (tests/data/README.md).
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "finite_elements.hpp"
#include "slipping_dots.hpp"

namespace test {

class StickScene {
 public:
  explicit StickScene(const std::string& name) : name_(name) {
    read_truth();
    read_dots();
  }
  Index steps() const { return static_cast<Index>(frames_.size()); }
  const PointsPx& dots(Index step) const { return frames_[at(step)].dots; }
  const ContactFlags& contact(Index step) const { return frames_[at(step)].contact; }
  const std::string& phase(Index step) const { return frames_[at(step)].phase; }
  /// Share of the nodes in contact that slipped less than 5 um in this step.
  double stick_ratio(Index step) const { return frames_[at(step)].stick_ratio; }

  Index first_slip_of_all() const {
    for (Index k = 0; k < steps(); ++k) {
      if (stick_ratio(k) < 0.1) {
        return k;
      }
    }
    return steps();
  }

 private:
  struct Frame {
    std::string phase;
    double stick_ratio = 0;
    PointsPx dots{21, 21, {nan, nan}};
    ContactFlags contact{21, 21};
  };
  static std::size_t at(Index step) { return static_cast<std::size_t>(step); }

  void read_truth() {
    auto file = open_data("stick_truth.csv", "scene,step,phase,stick_ratio_kin\n");
    std::string scene, step, phase, ratio;
    while (std::getline(file, scene, ',') && std::getline(file, step, ',') &&
           std::getline(file, phase, ',') && std::getline(file, ratio)) {
      if (scene == name_) {
        frames_.push_back({.phase = phase, .stick_ratio = std::stod(ratio)});
      }
    }
    require_data(steps() > 0, "stick_truth.csv has no " + name_);
  }

  void read_dots() {
    auto file = open_data(name_ + "_dots.pgm", "P5\n");
    int width = 0, height = 0, top = 0;
    file >> width >> height >> top;
    file.get();
    require_data(width % 2 == 0 && height == steps() + 1 && top == 65535,
                 name_ + "_dots.pgm has other steps");
    const auto next = [&] {
      const int high = file.get();
      return 256 * high + file.get();
    };
    std::vector<fingerpad::DotIndex> places;
    for (int k = 0; k < width / 2; ++k) {
      const Index col = next();
      places.push_back({next(), col});
    }
    for (Frame& frame : frames_) {
      for (const fingerpad::DotIndex& p : places) {
        const int x = next(), y = next();
        frame.dots(p.row, p.col) = {x / 64.0, y % 32768 / 64.0};
        frame.contact(p.row, p.col) = y >= 32768 ? 1 : 0;
      }
    }
    require_data(file.good(), name_ + "_dots.pgm is too short");
  }

  std::string name_;
  std::vector<Frame> frames_;
};

/// Share of the area in contact both in a step and `age` steps earlier that slipped less than a
/// length in between.
class SlippedLess {
 public:
  explicit SlippedLess(const std::string& name, Index steps) : shares_(steps, ages * lengths) {
    auto file = open_data(name + "_slip.pgm", "P5\n96 " + std::to_string(steps) + "\n255\n");
    for (int& share : shares_.cells) {
      share = file.get();
    }
    require_data(file.good(), name + "_slip.pgm is too short");
  }
  /// NaN if unknown.
  double operator()(Index step, Index age, double length_mm) const {
    const double place = std::log(length_mm / 0.002) / std::log(1.5);
    if (age < 1 || age > ages || !(place >= 0 && place < lengths - 1)) {
      return nan;
    }
    const Index t = static_cast<Index>(place);
    const double u = place - static_cast<double>(t);
    const int low = shares_(step, (age - 1) * lengths + t);
    const int high = shares_(step, (age - 1) * lengths + t + 1);
    return high == 255 ? nan : ((1 - u) * low + u * high) / 250;
  }

 private:
  static constexpr Index ages = 8, lengths = 12;
  Image<int> shares_;
};

}  // namespace test
