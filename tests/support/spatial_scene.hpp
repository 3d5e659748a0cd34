// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Printed dots of a finite-element membrane in space, step by step while an object moves on it, the
// object's pose, and what it exerts (tests/data/README.md).
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/math/rotation.hpp"
#include "finite_elements.hpp"

namespace test {

using DotsMm = Image<fingerpad::Point3<double>>;
using SpatialFlags = Image<std::uint8_t>;

struct SpatialStep {
  std::string phase;
  double stick_ratio =
      0;  ///< of the nodes in contact, those that slipped less than 5 um in the step
  double contact_area_mm2 = 0;
  fingerpad::Pose<double> object;
  fingerpad::Point3<double> force_n, moment_n_mm;  ///< object on pad, about Q
  DotsMm dots;
  SpatialFlags contact;
};

class SpatialScene {
 public:
  explicit SpatialScene(const std::string& name) : name_(name) {
    read_truth();
    read_dots();
  }
  Index size() const { return static_cast<Index>(steps_.size()); }
  Index dots_across() const { return across_; }
  const SpatialStep& operator[](Index step) const { return steps_[static_cast<std::size_t>(step)]; }

 private:
  void read_truth() {
    auto file = open_data("spatial_truth.csv",
                          "scene,step,phase,stick_ratio_kin,contact_area,x,y,z,rx,ry,rz,Fx,Fy,Fz,"
                          "Mx,My,Mz\n");
    std::string scene, cell;
    while (std::getline(file, scene, ',')) {
      SpatialStep step;
      std::getline(file, cell, ',');
      std::getline(file, step.phase, ',');
      std::vector<double> v;
      for (int k = 0; k < 14; ++k) {
        std::getline(file, cell, k == 13 ? '\n' : ',');
        v.push_back(std::stod(cell));
      }
      step.stick_ratio = v[0];
      step.contact_area_mm2 = v[1];
      step.object = {fingerpad::rotation_of(fingerpad::Angles<double>{v[5], v[6], v[7]}),
                     {v[2], v[3], v[4]}};
      step.force_n = {v[8], v[9], v[10]};
      step.moment_n_mm = {v[11], v[12], v[13]};
      if (scene == name_) {
        steps_.push_back(step);
      }
    }
    require_data(size() > 0, "spatial_truth.csv has no " + name_);
  }

  void read_dots() {
    auto file = open_data(name_ + "_space.pgm", "P5\n");
    Index width = 0, height = 0, top = 0;
    file >> width >> height >> top;
    file.get();
    require_data(width % 3 == 0 && height == size() + 1, name_ + "_space.pgm has other steps");
    const auto next = [&] {
      const int high = file.get();
      return 256 * high + file.get();
    };
    std::vector<fingerpad::DotIndex> places;
    for (Index k = 0; k < width / 3; ++k) {
      const Index col = next(), row = next();
      places.push_back({row, col});
      across_ = next();
    }
    for (SpatialStep& step : steps_) {
      step.dots = DotsMm(across_, across_, {nan, nan, nan});
      step.contact = SpatialFlags(across_, across_);
      for (const fingerpad::DotIndex& p : places) {
        const int x = next(), y = next(), z = next();
        step.dots(p.row, p.col) = {(x - 32768) / 1000.0, (y - 32768) / 1000.0, z % 32768 / 1000.0};
        step.contact(p.row, p.col) = z >= 32768 ? 1 : 0;
      }
    }
    require_data(file.good(), name_ + "_space.pgm is too short");
  }

  std::string name_;
  std::vector<SpatialStep> steps_;
  Index across_ = 0;
};

}  // namespace test
