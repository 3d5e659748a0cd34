// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Stick ratio of finite-element scenes with 0.06 px of noise of the dots: S and D over U, the
// effect of denoising, and the course over slip and reversal.
#include <cmath>
#include <string>
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"
#include "support/published_stick.hpp"
#include "support/ratio_measures.hpp"
#include "support/stick_scene.hpp"
#include "table.hpp"

namespace bench::papers {

constexpr double jitter_px = 0.06;

/// One run of a scene.
struct Course {
  std::vector<double> found, truth;  ///< in frames with an answer
  double sum = 0;                    ///< S: mean of the ratios
  double falls = 0;                  ///< D: sum of all decreases
  double falls_beyond = 0;           ///< D'
};

template <class Ratio>
Course course_of(const Ratio& ratio,
                 const test::StickScene& scene,
                 std::uint64_t seed,
                 const std::string& phase = {}) {
  test::Random random(seed);
  Ratio stick = ratio;
  Course c;
  for (fingerpad::Index k = 0; k < scene.steps(); ++k) {
    const auto r = stick(noisy(scene.dots(k), jitter_px, random), scene.contact(k));
    if (r.updated() && (phase.empty() || scene.phase(k) == phase)) {
      c.found.push_back(static_cast<double>(r.stick_ratio));
      c.truth.push_back(scene.stick_ratio(k));
    }
  }
  const test::RatioMeasures m = test::measures_of(c.found);
  c.sum = m.steps > 0 ? m.sum / m.steps : 0;
  c.falls = m.decreases;
  c.falls_beyond = m.rises;
  return c;
}

/// delta_0 for 0.06 px of noise before denoising, as in the accuracy tests.
inline const double slip_px = 2 * 0.416 * jitter_px * std::sqrt(std::log(100.0));
inline fingerpad::StickRatio<> default_ratio(double reference_px) {
  return {21, 21, test::stick_options(reference_px, slip_px)};
}
inline test::PublishedStick printed_ratio(double reference_px) {
  return {.ratio = {21, 21, {.U = reference_px, .U_min = reference_px / 4, .delta_0 = slip_px}}};
}

/// S, D and D' of the drag, averaged over 10 noises.
template <class Ratio>
std::string measures(const Ratio& ratio) {
  const test::StickScene drag("drag");
  double sum = 0, falls = 0, beyond = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Course c = course_of(ratio, drag, seed, "drag");
    sum += c.sum / 10;
    falls += c.falls / 10;
    beyond += c.falls_beyond / 10;
  }
  return number(sum) + " / " + number(falls) + " / " + number(beyond);
}

template <class Ratio>
std::vector<double> ratio_errors(const Ratio& ratio,
                                 const std::string& name,
                                 const std::string& phase = {}) {
  const test::StickScene scene(name);
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Course c = course_of(ratio, scene, seed, phase);
    for (std::size_t k = 0; k < c.found.size(); ++k) {
      errors.push_back(c.found[k] - c.truth[k]);
    }
  }
  return errors;
}

/// Standard deviation of a dot's position relative to the central dot at rest, before and after
/// denoising.
struct Noise {
  double before_px = 0, after_px = 0;
};
template <class Weights>
Noise denoised(const Weights& mean) {
  test::SlippingDots at_rest;
  test::Random random(5);
  Noise noise;
  const auto center = [](const test::PointsPx& d) { return d(10, 10); };
  double count = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const test::PointsPx seen = noisy(at_rest.dots, 0.14 / std::sqrt(2.0), random);
    const test::PointsPx smooth = mean(seen);
    for (fingerpad::Index i = 2; i < 19; ++i) {
      for (fingerpad::Index j = 2; j < 19; ++j) {
        const auto &home = at_rest.dots(i, j), &middle = center(at_rest.dots);
        const auto off = [&](const test::PointsPx& d) {
          const double e = d(i, j).x - center(d).x - (home.x - middle.x);
          return e * e;
        };
        noise.before_px += off(seen);
        noise.after_px += off(smooth);
        count += 1;
      }
    }
  }
  return {std::sqrt(noise.before_px / count), std::sqrt(noise.after_px / count)};
}

/// The slides' weighted mean over the 3 x 3 neighbours, S1 : S2 : S3 = 6 : 2 : 1.
inline test::PointsPx weighted_mean(const test::PointsPx& dots) {
  test::PointsPx out = dots;
  for (fingerpad::Index i = 1; i + 1 < dots.rows(); ++i) {
    for (fingerpad::Index j = 1; j + 1 < dots.cols(); ++j) {
      double x = 0, y = 0, sum = 0;
      for (fingerpad::Index a = -1; a <= 1; ++a) {
        for (fingerpad::Index b = -1; b <= 1; ++b) {
          const double w = a == 0 && b == 0 ? 6 : a == 0 || b == 0 ? 2 : 1;
          x += w * dots(i + a, j + b).x;
          y += w * dots(i + a, j + b).y;
          sum += w;
        }
      }
      out(i, j) = {x / sum, y / sum};
    }
  }
  return out;
}

inline Section slippage_section() {
  using namespace fingerpad;
  Section section{"Slippage [R], [F]", {}};
  const Noise noise = denoised(weighted_mean);
  section.rows.push_back({"dots at rest, against the central dot",
                          "sd before / after the mean over neighbours, px", "0.14 / 0.06",
                          number(noise.before_px) + " / " + number(noise.after_px),
                          "none of its own: residuals are averaged, not places",
                          "white noise on 21 x 21 dots, weights 6 : 2 : 1"});
  for (const double u : {0.5, 1.0, 2.0, 3.0}) {
    section.rows.push_back({u == 0.5 ? "measures S and D over U, 58 steps" : "",
                            "U = " + number(u) + " px: S / n, D, D' (D beyond the net drop)",
                            u == 2 ? "chosen: S and D small" : "", measures(printed_ratio(u)),
                            measures(default_ratio(u)), "plate dragged to slip, 18 steps"});
  }
  const auto add = [&](const std::string& experiment, const std::string& printed,
                       const std::string& scene, const std::string& phase,
                       const std::string& nearest) {
    const auto cell = [&](const auto& ratio) {
      return Spread(ratio_errors(ratio, scene, phase)).mean_and_worst();
    };
    section.rows.push_back({experiment, "error of the ratio, mean / largest", printed,
                            cell(printed_ratio(2)), cell(default_ratio(2)), nearest});
  };
  add("dragged to slip", "curves of Fig. 16", "drag", "drag", "plate dragged to slip");
  add("the opposite direction", "\"can still estimate\"", "drag", "back", "the same, back to slip");
  add("moment applied", "curves", "twist", "", "plate turned to slip");
  add("normal force changed", "curves", "mix", "", "dragged, turned and pressed at once");
  add("curved object", "\"future work\"", "cylinder", "", "cylinder of 12 mm dragged");
  return section;
}

}  // namespace bench::papers
