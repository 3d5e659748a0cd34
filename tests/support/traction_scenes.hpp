// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots of finite-element membranes under known loads (tests/data/traction_*.csv), and the errors of
// a traction field in them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "fingerpad/force/traction.hpp"
#include "rolling.hpp"

namespace test {

inline Dots no_dots(std::ptrdiff_t rows = 21, std::ptrdiff_t cols = 21) {
  return {rows, cols, fingerpad::detail::missing_point<double>()};
}

/// A frame with its true loads.
struct TractionScene {
  std::string name;
  double pressure_mpa = 0;
  fingerpad::Point3<double> force_n{};
  fingerpad::Point3<double> moment_n_mm{};
  Dots dots = no_dots();
  Flags contact = Flags(21, 21, 0);
  Image<double> contact_pressure_mpa = Image<double>(21, 21, 0);

  double largest_force_n() const {
    return (std::max)({std::abs(force_n.x), std::abs(force_n.y), std::abs(force_n.z)});
  }
  double largest_moment_n_mm() const {
    return (std::max)({std::abs(moment_n_mm.x), std::abs(moment_n_mm.y), std::abs(moment_n_mm.z)});
  }
  /// Whether the dot and all dots up to `ring` steps away are in contact.
  bool inside_contact(std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t ring) const {
    for (std::ptrdiff_t r = i - ring; r <= i + ring; ++r) {
      for (std::ptrdiff_t c = j - ring; c <= j + ring; ++c) {
        if (r < 0 || c < 0 || r >= 21 || c >= 21 || contact(r, c) == 0) {
          return false;
        }
      }
    }
    return true;
  }
};

inline std::ifstream traction_data(const std::string& name) {
  const auto folder = std::filesystem::path(__FILE__).parent_path().parent_path() / "data";
  std::ifstream file(folder / ("traction_" + name + ".csv"));
  if (!file) {
    std::fprintf(stderr, "no data: traction_%s.csv\n", name.c_str());
    std::abort();
  }
  return file;
}

inline Dots stress_free_dots(const std::string& name = "stress_free") {
  auto file = traction_data(name);
  Dots dots = no_dots();
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    int col = 0, row = 0;
    fingerpad::Point3<double> p{};
    if (std::sscanf(line.c_str(), "%d,%d,%lf,%lf,%lf", &col, &row, &p.x, &p.y, &p.z) == 5) {
      dots(row, col) = p;
    }
  }
  return dots;
}

inline TractionScene traction_scene(const std::string& name) {
  auto file = traction_data(name);
  TractionScene s;
  s.name = name;
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &s.pressure_mpa, &s.force_n.x,
              &s.force_n.y, &s.force_n.z, &s.moment_n_mm.x, &s.moment_n_mm.y, &s.moment_n_mm.z);
  while (std::getline(file, line)) {
    int col = 0, row = 0, touches = 0;
    double pressure = 0;
    fingerpad::Point3<double> p{};
    if (std::sscanf(line.c_str(), "%d,%d,%lf,%lf,%lf,%d,%lf", &col, &row, &p.x, &p.y, &p.z,
                    &touches, &pressure) == 7) {
      s.dots(row, col) = p;
      s.contact(row, col) = static_cast<unsigned char>(touches);  // number of the object, from 1
      s.contact_pressure_mpa(row, col) = pressure;
    }
  }
  return s;
}

/// All scenes with an object; the free pad is traction_scene("free").
inline const std::vector<TractionScene>& traction_scenes() {
  static const std::vector<TractionScene> all = [] {
    std::vector<TractionScene> scenes;
    for (const char* name : {"press", "drag", "twist", "mix", "roll", "tilt", "cylinder"}) {
      scenes.push_back(traction_scene(name));
    }
    return scenes;
  }();
  return all;
}

inline Dots noisy(Dots dots, double noise_mm, Gauss& gauss) {
  for (auto& p : dots.cells) {
    p = {p.x + noise_mm * gauss(), p.y + noise_mm * gauss(), p.z + noise_mm * gauss()};
  }
  return dots;
}

/// Errors in one scene over frames with different noise. Force and moment are rms values relative
/// to the largest true component; pressures are relative to the pressure of the pad.
struct TractionError {
  std::array<double, 3> force{};
  std::array<double, 3> moment{};
  double pressure_rms = 0;    ///< contact pressure of dots whose neighbours all touch
  double pressure_worst = 0;  ///< largest, of dots with two rows of such around them
  double pressure_mean = 0;   ///< of the mean pressure over the dots of pressure_rms
  double mu_t = 0;            ///< mean, N/mm
  double free_load = 0;       ///< rms load on the free part
  int frames = 0;             ///< with a force of all dots
};

template <class S>
TractionError traction_error(fingerpad::TractionField<S>& field,
                             const TractionScene& s,
                             double noise_mm = 0,
                             int frames = 1) {
  TractionError e;
  Gauss gauss(11);
  double dots = 0, sum_sq = 0;
  for (int k = 0; k < frames; ++k) {
    const auto r = field(noisy(s.dots, noise_mm, gauss), s.contact, S(s.pressure_mpa));
    e.frames += r.ok();
    const auto f = [](auto x) { return static_cast<double>(x); };
    const std::array<double, 6> off = {
        f(r.force_n.x) - s.force_n.x,         f(r.force_n.y) - s.force_n.y,
        f(r.force_n.z) - s.force_n.z,         f(r.moment_n_mm.x) - s.moment_n_mm.x,
        f(r.moment_n_mm.y) - s.moment_n_mm.y, f(r.moment_n_mm.z) - s.moment_n_mm.z};
    for (std::size_t c = 0; c < 3; ++c) {
      e.force[c] += off[c] * off[c];
      e.moment[c] += off[c + 3] * off[c + 3];
    }
    e.mu_t += f(r.mu_t_n_per_mm) / frames;
    e.free_load += f(r.free_load_rms_mpa) / s.pressure_mpa / frames;
    double mean = 0, count = 0;
    for (std::ptrdiff_t i = 0; i < 21; ++i) {
      for (std::ptrdiff_t j = 0; j < 21; ++j) {
        if (!s.inside_contact(i, j, 1)) {
          continue;
        }
        const double error =
            (f(field.pressure_mpa()(i, j)) - s.contact_pressure_mpa(i, j)) / s.pressure_mpa;
        sum_sq += error * error;
        mean += error;
        count += 1;
        if (s.inside_contact(i, j, 2)) {
          e.pressure_worst = (std::max)(e.pressure_worst, std::abs(error));
        }
      }
    }
    dots += count;
    e.pressure_mean += count > 0 ? (mean / count) * (mean / count) / frames : 0;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    e.force[c] = std::sqrt(e.force[c] / frames) / s.largest_force_n();
    e.moment[c] = std::sqrt(e.moment[c] / frames) / s.largest_moment_n_mm();
  }
  e.pressure_rms = std::sqrt(sum_sq / dots);
  e.pressure_mean = std::sqrt(e.pressure_mean);
  return e;
}

}  // namespace test
