// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Printed dots of a finite-element membrane in space, step by step while an object moves on it,
// with the pose and the loads of the object (tests/data/README.md).
#include <algorithm>
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
  /// Keeps each `every`-th row and column of dots; 2 doubles their spacing.
  explicit SpatialScene(const std::string& name, Index every = 1) : name_(name), every_(every) {
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
    const Index first = across_ / 2 % every_;
    across_ = (across_ - 1 - first) / every_ + 1;
    for (SpatialStep& step : steps_) {
      step.dots = DotsMm(across_, across_, {nan, nan, nan});
      step.contact = SpatialFlags(across_, across_);
      for (const fingerpad::DotIndex& p : places) {
        const int x = next(), y = next(), z = next();
        if ((p.row - first) % every_ == 0 && (p.col - first) % every_ == 0) {
          const Index row = (p.row - first) / every_, col = (p.col - first) / every_;
          step.dots(row, col) = {(x - 32768) / 1000.0, (y - 32768) / 1000.0, z % 32768 / 1000.0};
          step.contact(row, col) = z >= 32768 ? 1 : 0;
        }
      }
    }
    require_data(file.good(), name_ + "_space.pgm is too short");
  }

  std::string name_;
  Index every_;
  std::vector<SpatialStep> steps_;
  Index across_ = 0;
};

// Truth for the errors of a stick ratio: the share of the dots whose slip relative to the object's
// known pose is below slip_share of the longest move.

inline constexpr double slip_share = 0.0086 / 0.16;
inline constexpr double truth_reference_mm = 0.16;

inline double longest_move(const SpatialStep& then, const SpatialStep& now) {
  double longest = 0;
  for (std::size_t k = 0; k < now.dots.cells.size(); ++k) {
    if (then.contact.cells[k] != 0 && now.contact.cells[k] != 0) {
      longest = std::max(longest, norm(now.dots.cells[k] - then.dots.cells[k]));
    }
  }
  return longest;
}

/// Share of the dots whose slip relative to the object's known pose is below slip_share of the
/// longest move.
inline double truth_between(const SpatialStep& then, const SpatialStep& now) {
  const fingerpad::Pose<double> motion = now.object * inverse(then.object);
  const double limit = slip_share * longest_move(then, now);
  double stick = 0, all = 0;
  for (std::size_t k = 0; k < now.dots.cells.size(); ++k) {
    if (then.contact.cells[k] != 0 && now.contact.cells[k] != 0) {
      const auto slip = now.dots.cells[k] - motion(then.dots.cells[k]);
      all += 1;
      stick += norm(slip) < limit ? 1 : 0;
    }
  }
  return stick / all;
}

inline Index dots_of_both(const SpatialStep& then, const SpatialStep& now) {
  Index both = 0;
  for (std::size_t k = 0; k < now.dots.cells.size(); ++k) {
    both += then.contact.cells[k] != 0 && now.contact.cells[k] != 0 ? 1 : 0;
  }
  return both;
}

/// Truth since the reference of the answer. For a frame without an answer, since the newest step
/// from which a dot has moved far enough; otherwise within the step.
template <class Result>
double spatial_truth(const SpatialScene& scene, Index k, const Result& r) {
  if (r.updated()) {
    return truth_between(scene[k - r.reference_age], scene[k]);
  }
  for (Index then = k - 1; then > std::max<Index>(k - 8, 0); --then) {
    if (dots_of_both(scene[then], scene[k]) < 6) {
      break;
    }
    if (longest_move(scene[then], scene[k]) > truth_reference_mm) {
      return truth_between(scene[then], scene[k]);
    }
  }
  return scene[k].stick_ratio;
}

/// A vector with noise relative to each component.
inline fingerpad::Point3<double> noisy(const fingerpad::Point3<double>& p,
                                       double share,
                                       Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {p.x * (1 + share * x), p.y * (1 + share * y), p.z * (1 + share * z)};
}

}  // namespace test
