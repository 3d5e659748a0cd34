// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Cases that are hard in any number type: the second table of docs/hard_cases.md. It compares the
// published method with the default on the same input.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "bench/support/scene_frames.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/depth.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "support/foam_signals.hpp"
#include "support/rim_marks.hpp"
#include "support/rolling.hpp"
#include "support/soap_film.hpp"
#include "support/wrench_frames.hpp"

namespace hard {

using fingerpad::Index;

struct CaseByNature {
  std::string method, hard_case, figure, published, ours;
};

inline std::string figure_of(const char* format, double a) {
  char text[64];
  std::snprintf(text, sizeof text, format, a);
  return text;
}
inline std::string figures_of(const char* format, double a, double b) {
  char text[64];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// ---- contact region

/// Grid on which the heights are sampled.
struct HeightMap {
  Index size = 120;
  double pitch_mm = 0.16;
  double within_mm = 7.5;  ///< of the middle; beyond, it is too steep for a pad
};
using Heights = std::function<double(double x_mm, double y_mm)>;

struct RegionFound {
  double share_of_true = 0;  ///< of the touching pixels, found
  double false_share = 0;    ///< of the other pixels, taken for contact
};

/// `find(camera, depth_mm, mask)` fills the mask.
template <class Find>
RegionFound region_of(const Heights& height,
                      const Heights& touches,
                      const HeightMap& map,
                      const Find& find) {
  using namespace fingerpad;
  const Index n = map.size;
  const double middle = static_cast<double>(n - 1) / 2;
  const OrthographicCamera<double> camera{middle, middle, map.pitch_mm};
  test::Image<float> depth(n, n);
  test::Image<std::uint8_t> mask(n, n);
  const auto place = [&](Index k) { return map.pitch_mm * (static_cast<double>(k) - middle); };
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      depth(i, j) = static_cast<float>(height(place(j), place(i)));
    }
  }
  RegionFound found;
  find(camera, depth, mask);
  double touching = 0, free = 0;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      if (std::hypot(place(j), place(i)) > map.within_mm) {
        continue;
      }
      const bool is = touches(place(j), place(i)) > 0, in = mask(i, j) != 0;
      touching += is ? 1 : 0;
      free += is ? 0 : 1;
      found.share_of_true += is && in ? 1 : 0;
      found.false_share += !is && in ? 1 : 0;
    }
  }
  found.share_of_true /= touching > 0 ? touching : 1;
  found.false_share /= free;
  return found;
}

/// Half of the curvature of a free pad of 20 mm, as fit_contact_threshold sets it.
inline constexpr double half_of_free_per_mm = 0.025;

inline RegionFound published_region(const Heights& height,
                                    const Heights& touches,
                                    const HeightMap& map = {}) {
  return region_of(height, touches, map, [](const auto& camera, const auto& depth, auto& mask) {
    fingerpad::published::SlidesContactOptions options;
    options.radius_px = 12;
    options.pitch_mm = camera.pitch_mm;
    (void)fingerpad::published::contact_by_slides(depth, mask, options);
  });
}
inline RegionFound default_region(const Heights& height,
                                  const Heights& touches,
                                  const HeightMap& map = {}) {
  return region_of(height, touches, map, [](const auto& camera, const auto& depth, auto& mask) {
    fingerpad::ContactTest test;
    test.ring_px = 12;
    test.threshold_per_mm = half_of_free_per_mm;
    fingerpad::ContactRegion<> region(camera, depth.rows(), depth.cols(), test);
    (void)region(depth, mask);
  });
}

/// Two bars. Gaps up to the default's touching gap count as contact.
inline void add_two_contacts(std::vector<CaseByNature>& rows) {
  const double touching_mm = fingerpad::ContactTest().touching_gap_mm;
  const HeightMap map{.size = 220, .pitch_mm = 0.08, .within_mm = 6.5};
  for (const double apart_mm : {3.0, 2.0}) {
    const test::StripFilm film{.half_mm = 4, .slit_mm = apart_mm / 2};
    const Heights bars = [=](double x, double y) { return film(x, y); };
    const Heights touch = [=](double x, double y) {
      return film.touches(x, y) || std::abs(film(x, y) - film.top_mm) < touching_mm ? 1.0 : 0.0;
    };
    const auto old = published_region(bars, touch, map), ours = default_region(bars, touch, map);
    rows.push_back(
        {"contact region",
         "two contacts " + figure_of("%.0f", apart_mm) +
             " mm apart on a ring of 1 mm; the membrane between them bulges",
         "share of the contacts that is found; of the free membrane, taken for contact, %",
         figures_of("%.0f; %.0f", 100 * old.share_of_true, 100 * old.false_share),
         figures_of("%.0f; %.0f", 100 * ours.share_of_true, 100 * ours.false_share)});
  }
}

inline void add_regions(std::vector<CaseByNature>& rows) {
  // dome of 20 mm with twice the curvature where it leaves a contact of 5 mm
  const auto around = [](double rho, double inside) {
    const double off = rho - 5;
    return rho < 5 ? inside : inside - 0.03 * off * off;
  };
  const Heights within_5 = [](double x, double y) { return std::hypot(x, y) < 5 ? 1.0 : 0.0; };
  for (const double hollow_mm : {100.0, 30.0}) {
    const Heights hollow = [=](double x, double y) {
      const double rho = std::hypot(x, y), held = (std::min)(rho, 5.0);
      return around(rho, 10 - held * held / (2 * hollow_mm)) -
             (rho > 5 ? 5 / hollow_mm * (rho - 5) : 0);
    };
    const auto old = published_region(hollow, within_5), ours = default_region(hollow, within_5);
    rows.push_back(
        {"contact region", "concave object, hollow of " + figure_of("%.0f", hollow_mm) + " mm",
         "share of the contact that is found, %", figure_of("%.0f", 100 * old.share_of_true),
         figure_of("%.0f", 100 * ours.share_of_true)});
  }
  const Heights saddle = [](double x, double y) { return 10 - 0.08 * x * x + 0.085 * y * y; };
  const Heights nowhere = [](double, double) { return 0.0; };
  rows.push_back(
      {"contact region", "free saddle, curvatures 0.16 and -0.17 per mm",
       "free membrane taken for contact, %",
       figure_of("%.0f", 100 * published_region(saddle, nowhere, {.within_mm = 4}).false_share),
       figure_of("%.0f", 100 * default_region(saddle, nowhere, {.within_mm = 4}).false_share)});
  add_two_contacts(rows);
}

// ---- depth

inline void add_lamp(std::vector<CaseByNature>& rows) {
  using namespace fingerpad;
  auto& scenes = bench::SceneFrames::instance();
  const auto& pad = scenes.pad();
  const auto& press = scenes("press");
  test::Scene scene;
  const auto reference = scene.reference(scenes.free_mm());
  DepthEstimator<> ours(pad.camera, pad.fluid, reference);
  test::Frame<double> mean(pad.rows, pad.cols);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      if (!std::isnan(scenes.free_mm()(i, j))) {
        const auto c = pad.colour(i, j, scenes.free_mm()(i, j), 57);
        mean.red(i, j) = c.red;
        mean.green(i, j) = c.green;
      }
    }
  }
  published::DepthEstimator<> old(pad.published(), mean.red, mean.green, scenes.free_mm());
  test::Image<float> depth(pad.rows, pad.cols);
  const auto error_mm = [&](auto& estimator, double red, double green) {
    test::Frame<std::uint8_t> frame = press.frame;
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        const auto brighter = [](std::uint8_t level, double times) {
          return test::stored<std::uint8_t>(times * static_cast<double>(level));
        };
        frame.red(i, j) = brighter(press.frame.red(i, j), red);
        frame.green(i, j) = brighter(press.frame.green(i, j), green);
      }
    }
    (void)estimator(frame.red, frame.green, depth);
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      const double off = static_cast<double>(depth.cells[k]) - press.truth_mm.cells[k];
      sum += std::isnan(off) ? 0 : std::abs(off);
      count += std::isnan(off) ? 0 : 1;
    }
    return sum / count;
  };
  for (const auto& [said, red, green] :
       {std::tuple{"both colours 5 % brighter", 1.05, 1.05}, {"red 2 % brighter", 1.02, 1.0}}) {
    rows.push_back({"depth", std::string("the lamp has changed since the reference: ") + said,
                    "mean error of a pressed pad, mm; unchanged lamp: " +
                        figures_of("%.3f, %.3f", error_mm(old, 1, 1), error_mm(ours, 1, 1)),
                    figure_of("%.2f", error_mm(old, red, green)),
                    figure_of("%.2f", error_mm(ours, red, green))});
  }
}

// ---- six-axis force

inline void add_wrench(std::vector<CaseByNature>& rows) {
  using namespace fingerpad;
  const auto rim = test::rim_border();
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    if (f.name != "drag_b") {
      continue;
    }
    Index outward = 0;
    for (Index k = 0; k < test::side_dots; ++k) {
      const Point3<double>&b = rim(0, k), &d = f.dots(0, k);
      outward += b.x * (d.x - b.x) + b.y * (d.y - b.y) > 0 ? 1 : 0;
    }
    const auto error_n = [&](auto wrench) {
      const auto r =
          wrench(test::exact_heights(f.heights), test::rows_of(f.dots, 1), f.pressure_mpa);
      return figure_of("%.2f", norm(r.force_n - f.force_n));
    };
    const test::RimScene& scene = test::rim_scenes().front();
    const std::size_t last = scene.frames.size() - 1;
    test::SeenRim seen(scene, test::SeenRim::options_of(scene, true), 0.06, 1);
    const auto& load = scene.frames[last].load;
    const std::string of_dots =
        figure_of("%.2f", norm(seen.fit(last).force_n - Point3<double>{load[0], load[1], load[2]}));
    rows.push_back({"six-axis force",
                    "the membrane bulges past the rim, at " + std::to_string(outward) +
                        " of 72 points: a plate dragged until it slips",
                    "error of the force, of 6.3 N, N",
                    error_n(published::SegmentEquilibrium<>(rim)), of_dots});
  }
}

// ---- foam

/// Number of detected slips out of 40 slips of single taxels. Two taxels of each finger slip, each
/// with waves of its own.
inline int slips_found(fingerpad::PreslipRule rule) {
  using namespace fingerpad;
  int found = 0;
  std::mt19937 random(17);
  const auto any = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  constexpr double rate_hz = 100;
  for (unsigned k = 0; k < 40; ++k) {
    test::FoamScene scene;
    for (auto& finger : scene.patches) {
      for (const double share : {0.1, 0.22}) {
        test::VibratingPatch patch;
        patch.rows = patch.cols = 1;
        patch.row = static_cast<Index>(any(0, 15));
        patch.col = static_cast<Index>(any(0, 3));
        patch.begin_s = (60 + any(0, 1)) / rate_hz;
        patch.frequency_hz = rate_hz * share;
        patch.phase = any(0, 6.28);
        finger.push_back(patch);
      }
    }
    test::FoamSignal signal(scene, k);
    const TaxelFeatures<> finger(scene.rows, scene.cols,
                                 {.sample_period_s = 1 / rate_hz, .noise = scene.noise});
    FoamHand<> hand({finger, finger}, {.rule = rule});
    bool alarms = false;
    for (int n = 0; n < 140 && !alarms; ++n) {
      const double time_s = n / rate_hz;
      const auto left = signal.finger(0, time_s), right = signal.finger(1, time_s);
      alarms = hand(std::array{left, right}, time_s) == PreslipStatus::preslip;
    }
    found += alarms ? 1 : 0;
  }
  return found;
}

inline std::vector<CaseByNature> cases_by_nature() {
  std::vector<CaseByNature> rows;
  add_regions(rows);
  add_lamp(rows);
  add_wrench(rows);
  rows.push_back({"pre-slip, grasp-optimise",
                  "several taxels vibrate: two of each finger, each with waves of its own",
                  "slips that are found, of 40",
                  std::to_string(slips_found(fingerpad::PreslipRule::printed_grasp_optimise)),
                  std::to_string(slips_found(fingerpad::PreslipRule::grasp_optimise))});
  return rows;
}

inline std::string line_of(const CaseByNature& c) {
  return "| " + c.method + " | " + c.hard_case + " | " + c.figure + " | " + c.published + " | " +
         c.ours + " |";
}

}  // namespace hard
