// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six axes from dots near the rim of finite-element membranes: what noise, lost dots, the gauge,
// and what is wrong about the pad do to them. Prints a table. six_axes [GRID ROWS] takes other
// scenes than tests/data/rim_marks.txt and rim_rows.txt, in their format.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "support/rim_marks.hpp"

using namespace fingerpad;
using test::RimScene;

namespace {

struct Case {
  const char* name;
  bool is_loose = true;
  double noise_px = 0.06;
  /// What the fit believes of pad and gauge.
  std::function<void(WrenchOptions&)> believe = [](WrenchOptions&) {};
  /// Whether a dot is seen.
  std::function<bool(std::size_t, const Mark&)> sees = [](std::size_t, const Mark&) {
    return true;
  };
  double gauge_noise = 0, gauge_gain = 1, gauge_offset_mpa = 0;
  bool has_gauge = true;   ///< else it says what it said of the free pad
  double pitch_share = 0;  ///< by which the camera's pitch is wrong
  bool has_rows = false;   ///< dots in rows at 2, 4 and 6 mm, not a grid
};

/// Mean errors as a share of the scene's largest load: F_xy, F_z, M_xy, M_z.
struct Sums {
  std::array<double, 4> error = {};
  std::array<int, 4> scenes = {};
  double worst_z = 0;
  int frames = 0, refused = 0, uncertain = 0, wrong = 0, wrong_ok = 0, parts = 0, within = 0;
};

/// By how much a result may be off before it is wrong, by the load of a press that is as large as
/// the scene's largest.
std::array<double, 4> limits(const RimScene& s, double pressure_mpa) {
  auto full = s.largest();
  const double arm_mm = std::sqrt(full[1] / (std::numbers::pi * pressure_mpa));
  full[0] = (std::max)(full[0], full[1] / 2);
  full[2] = (std::max)(full[2], 0.9 * arm_mm * full[1]);
  full[3] = (std::max)(full[3], 0.3 * arm_mm * full[1]);
  return {0.03 * full[0], 0.096 * full[1], 0.09 * full[2], 0.057 * full[3]};
}

/// The frames of a scene in which something touches.
void add(Sums& sums, const RimScene& s, const Case& c) {
  constexpr int free_frames = 16;
  const auto largest = s.largest();
  auto options = test::SeenRim::options_of(s, c.is_loose);
  options.full_scale_n = largest[1];
  c.believe(options);
  const auto truth = s.camera();
  auto camera = truth;
  camera.pitch_mm *= 1 + c.pitch_share;
  test::Random random(5), of_gauge(6);
  const auto seen = [&](const Point3<double>& at, double sd_px) {
    const auto px = pixel_of(truth, at);
    return Point2<double>{px.x + sd_px * random.normal(), px.y + sd_px * random.normal()};
  };
  const auto gauge = [&](double mpa, double noise) {
    return mpa * (c.gauge_gain + noise * of_gauge.normal()) + c.gauge_offset_mpa;
  };
  Wrench<> wrench(camera, options);
  const test::RimFrame& free = s.frames.front();
  (void)wrench.begin(gauge(free.pressure_mpa, c.gauge_noise / std::sqrt(free_frames)));
  std::vector<Mark> places;
  std::vector<std::size_t> number;
  for (std::size_t k = 0; k < free.dots_mm.size(); ++k) {
    const auto px = seen(free.dots_mm[k], c.noise_px / std::sqrt(free_frames));
    if (auto mark = wrench.place_in_free_picture(px)) {
      mark->sd_px = c.noise_px * std::sqrt(1 + 1.0 / free_frames);
      places.push_back(*mark);
      number.push_back(k);
    }
  }
  std::array<double, 4> sum = {};
  int frames = 0;
  for (const test::RimFrame& frame : s.frames) {
    if (!(std::fabs(frame.load[2]) > 0)) {
      continue;
    }
    std::vector<Mark> marks;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto& at = frame.dots_mm[number[k]];
      const auto px = seen(at, c.noise_px);
      if (at.z > 0 && c.sees(k, places[k])) {
        marks.push_back(places[k]);
        marks.back().px = px;
      }
    }
    const double mpa = c.has_gauge ? gauge(frame.pressure_mpa, c.gauge_noise) : free.pressure_mpa;
    const auto r = wrench(marks, mpa);
    ++sums.frames;
    sums.uncertain += r.status == WrenchStatus::uncertain ? 1 : 0;
    if (!r.has_force()) {
      ++sums.refused;
      continue;
    }
    ++frames;
    const std::array<double, 6> found = {r.force_n.x,     r.force_n.y,     r.force_n.z,
                                         r.moment_n_mm.x, r.moment_n_mm.y, r.moment_n_mm.z};
    std::array<double, 6> off;
    for (std::size_t k = 0; k < 6; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      off[k] = found[k] - frame.load[k];
      ++sums.parts;
      sums.within += square(off[k]) < 4 * r.covariance(i, i) ? 1 : 0;
    }
    const std::array<double, 4> error = {std::hypot(off[0], off[1]), std::fabs(off[2]),
                                         std::hypot(off[3], off[4]), std::fabs(off[5])};
    const auto most = limits(s, frame.pressure_mpa);
    bool is_wrong = false;
    for (std::size_t k = 0; k < 4; ++k) {
      sum[k] += error[k];
      is_wrong = is_wrong || error[k] > most[k];
    }
    sums.worst_z = (std::max)(sums.worst_z, error[1] / largest[1]);
    sums.wrong += is_wrong ? 1 : 0;
    sums.wrong_ok += is_wrong && r.ok() ? 1 : 0;
  }
  for (std::size_t k = 0; k < 4 && frames > 0; ++k) {
    if (largest[k] > (k < 2 ? 0.1 : 4.0)) {
      sums.error[k] += sum[k] / frames / largest[k];
      ++sums.scenes[k];
    }
  }
}

std::vector<Case> cases() {
  const auto no_gauge = [](WrenchOptions& o) { o.pressure_sd_share = 1; };
  const auto fifth = [](std::size_t k, const Mark&) { return (k * 2654435761U >> 7) % 5 != 0; };
  const auto third = [](std::size_t, const Mark& m) { return m.azimuth_rad < 1.0472; };
  return {
      {.name = "clamped rim", .is_loose = false},
      {.name = "clamped rim, 0.02 px", .is_loose = false, .noise_px = 0.02},
      {.name = "loose rim, 0.06 px: the rows below"},
      {.name = "0.02 px", .noise_px = 0.02},
      {.name = "0.2 px", .noise_px = 0.2},
      {.name = "rows at 2, 4, 6 mm", .has_rows = true},
      {.name = "rows, 0.02 px", .noise_px = 0.02, .has_rows = true},
      {.name = "a fifth of the dots lost", .sees = fifth},
      {.name = "a third of the rim hidden", .sees = third},
      {.name = "no gauge, 0.02 px", .noise_px = 0.02, .believe = no_gauge, .has_gauge = false},
      {.name = "no gauge", .believe = no_gauge, .has_gauge = false},
      {.name = "gauge noise 0.5 %, told",
       .believe = [](WrenchOptions& o) { o.pressure_sd_share = 0.005; },
       .gauge_noise = 0.005},
      {.name = "gauge gain 2 % wrong", .gauge_gain = 1.02},
      {.name = "gauge 0.3 kPa off", .gauge_offset_mpa = 0.0003},
      {.name = "pitch 0.3 % wrong", .pitch_share = 0.003},
      {.name = "radius 0.05 mm wrong",
       .believe = [](WrenchOptions& o) { o.cap.base_radius_mm += 0.05; }},
      {.name = "stress-free height 1 % wrong",
       .believe = [](WrenchOptions& o) { o.cap.height_mm *= 1.01; }},
      {.name = "mu t 3 % wrong, told",
       .believe =
           [](WrenchOptions& o) {
             o.modulus_n_per_mm *= 1.03;
             o.modulus_sd_share = 0.03;
           }},
      {.name = "Mooney's share 0.3 wrong",
       .believe = [](WrenchOptions& o) { o.cap.mooney_share = 0.3 - o.cap.mooney_share; }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  const auto read = [&](int which, const char* name) {
    auto file = argc > 2 ? std::ifstream(argv[which]) : test::open_data(name, "");
    std::string title;
    std::getline(file, title);
    return test::read_rim_scenes(file);
  };
  const auto grid = read(1, "rim_marks.txt"), rows = read(2, "rim_rows.txt");
  std::printf(
      "| | F_xy | F_z (worst) | M_xy | M_z | within 2 sd | refused | wrong | of these ok | "
      "uncertain | frames |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const Case& c : cases()) {
    Sums sums;
    for (const RimScene& s : c.has_rows ? rows : grid) {
      add(sums, s, c);
    }
    const auto mean = [&](std::size_t k) { return 100 * sums.error[k] / sums.scenes[k]; };
    std::printf("| %s | %.2f | %.2f (%.1f) | %.2f | %.2f | %.0f | %d | %d | %d | %d | %d |\n",
                c.name, mean(0), mean(1), 100 * sums.worst_z, mean(2), mean(3),
                100.0 * sums.within / sums.parts, sums.refused, sums.wrong, sums.wrong_ok,
                sums.uncertain, sums.frames);
    std::fflush(stdout);
  }
  return 0;
}
