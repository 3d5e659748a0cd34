// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots near the rim of finite-element membranes, where they are seen, and the loads
// (tests/data/rim_marks.txt).
#include <array>
#include <cmath>
#include <istream>
#include <string>
#include <vector>

#include "fingerpad/force/wrench.hpp"
#include "support/finite_elements.hpp"
#include "support/generators.hpp"

namespace test {

struct RimFrame {
  double pressure_mpa = 0;
  std::array<double, 6> load = {};  ///< force, N; moment, N mm
  std::vector<fingerpad::Point3<double>> dots_mm;
};

struct RimScene {
  std::string name;
  double modulus_n_per_mm = 0;
  fingerpad::StressFreeCap<double> cap;
  std::vector<RimFrame> frames;  ///< the first is the free pad

  fingerpad::Camera<double> camera() const {
    fingerpad::Camera<double> camera;
    camera.pitch_mm *= cap.base_radius_mm / base_radius_mm;  // every pad fills the picture
    return camera;
  }
  /// Largest force along the plate, F_z, moment along the plate, M_z.
  std::array<double, 4> largest() const {
    std::array<double, 4> most = {};
    for (const RimFrame& f : frames) {
      const std::array<double, 4> now = {std::hypot(f.load[0], f.load[1]), std::fabs(f.load[2]),
                                         std::hypot(f.load[3], f.load[4]), std::fabs(f.load[5])};
      for (std::size_t k = 0; k < 4; ++k) {
        most[k] = (std::max)(most[k], now[k]);
      }
    }
    return most;
  }
};

/// Up to the end of the file. Dots that the object touches are at the origin.
inline std::vector<RimScene> read_rim_scenes(std::istream& file) {
  std::vector<RimScene> scenes;
  RimScene s;
  std::size_t dots = 0, frames = 0;
  while (file >> s.name >> s.modulus_n_per_mm >> s.cap.base_radius_mm >> s.cap.height_mm >>
         s.cap.mooney_share >> dots >> frames) {
    s.frames.assign(frames, {});
    for (RimFrame& f : s.frames) {
      file >> f.pressure_mpa;
      for (double& part : f.load) {
        file >> part;
      }
      f.dots_mm.resize(dots);
      for (auto& p : f.dots_mm) {
        file >> p.x >> p.y >> p.z;
        p = p / 1e4;
      }
    }
    require_data(!file.fail(), "marks near the rim are too few");
    scenes.push_back(s);
  }
  return scenes;
}

inline const std::vector<RimScene>& rim_scenes() {
  static const std::vector<RimScene> all = [] {
    auto file = open_data("rim_marks.txt", "rim marks\n");
    auto scenes = read_rim_scenes(file);
    require_data(scenes.size() == 8, "rim_marks.txt has other scenes");
    return scenes;
  }();
  return all;
}

/// Membranes that are thicker toward an azimuth of 0.6 rad, by these shares at the rim: the first
/// four frames are the free pad at 16, 8, 12 and 20 kPa.
struct UnevenScene {
  double share;
  bool grows;  ///< in proportion to the distance from the axis; else it is the same everywhere
  RimScene scene;
};
inline const std::vector<UnevenScene>& uneven_scenes() {
  static const std::vector<UnevenScene> all = [] {
    auto file = open_data("uneven_marks.txt", "uneven marks\n");
    const auto scenes = read_rim_scenes(file);
    require_data(scenes.size() == 4, "uneven_marks.txt has other scenes");
    return std::vector<UnevenScene>{{0, true, scenes[0]},
                                    {0.04, true, scenes[1]},
                                    {0.08, true, scenes[2]},
                                    {0.08, false, scenes[3]}};
  }();
  return all;
}

/// A scene as a camera sees it.
class SeenRim {
 public:
  using Wrench = fingerpad::Wrench<>;

  SeenRim(const RimScene& scene,
          fingerpad::WrenchOptions options,
          double noise_px,
          std::uint64_t seed,
          int free_frames = 16)
      : scene_(scene), noise_px_(noise_px), random_(seed), wrench(scene.camera(), options) {
    const RimFrame& free = scene.frames.front();
    wrench.begin(free.pressure_mpa);
    const double place_px = noise_px / std::sqrt(free_frames);
    for (std::size_t k = 0; k < free.dots_mm.size(); ++k) {
      auto mark = wrench.place_in_free_picture(pixel(free.dots_mm[k], place_px));
      if (mark) {
        mark->sd_px = (std::max)(std::hypot(noise_px, place_px), 0.005);
        marks.push_back(*mark);
        number_.push_back(k);
      }
    }
  }

  static fingerpad::WrenchOptions options_of(const RimScene& scene, bool loose_rim) {
    fingerpad::WrenchOptions options;
    options.cap = scene.cap;
    options.modulus_n_per_mm = scene.modulus_n_per_mm;
    options.modulus_sd_share = options.pressure_sd_share = 0;
    options.loose_rim = loose_rim;
    return options;
  }

  /// The marks where frame `k` shows them.
  void show(std::size_t k) {
    for (std::size_t i = 0; i < marks.size(); ++i) {
      marks[i].px = pixel(scene_.frames[k].dots_mm[number_[i]], noise_px_);
    }
  }
  fingerpad::WrenchResult fit(std::size_t k) {
    show(k);
    return wrench(marks, scene_.frames[k].pressure_mpa);
  }

 private:
  fingerpad::Point2<double> pixel(const fingerpad::Point3<double>& p, double sd_px) {
    const auto px = pixel_of(scene_.camera(), p);
    return {px.x + sd_px * random_.normal(), px.y + sd_px * random_.normal()};
  }

  const RimScene& scene_;
  double noise_px_;
  Random random_;
  std::vector<std::size_t> number_;

 public:
  Wrench wrench;
  std::vector<fingerpad::Mark> marks;
};

}  // namespace test
