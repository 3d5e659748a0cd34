// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shape sensing: errors of depth maps of rendered frames.
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/scene_frames.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/depth.hpp"
#include "table.hpp"

namespace bench::papers {

/// Depth errors of all pixels whose point lies within 17.5 mm of the axis and, with `contact`,
/// touches.
inline std::vector<double> depth_errors(const SceneFrame& frame,
                                        const test::Image<float>& depth_mm,
                                        const std::string& contact = {}) {
  const test::Pad& pad = SceneFrames::instance().pad();
  std::vector<double> errors;
  for (fingerpad::Index i = 0; i < pad.rows; ++i) {
    for (fingerpad::Index j = 0; j < pad.cols; ++j) {
      const double l = frame.truth_mm(i, j);
      if (std::isnan(l)) {
        continue;
      }
      const auto p = point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), l);
      static const test::TrueContact press("press"), tilt("tilt"), cylinder("cylinder"),
          roll("roll");
      const auto& touches = contact == "press"  ? press
                            : contact == "tilt" ? tilt
                            : contact == "roll" ? roll
                                                : cylinder;
      const double error = static_cast<double>(depth_mm(i, j)) - l;
      if (std::hypot(p.x, p.y) < 17.5 && (contact.empty() || touches(p.x, p.y)) &&
          !std::isnan(error)) {
        errors.push_back(error);
      }
    }
  }
  return errors;
}

/// The published depth with a free pad that is the mean of many frames, as in the default.
inline fingerpad::published::DepthEstimator<> published_depth() {
  const SceneFrames& scenes = SceneFrames::instance();
  const test::Pad& pad = scenes.pad();
  test::Frame<double> mean(pad.rows, pad.cols);
  test::Random random(99);
  for (fingerpad::Index i = 0; i < pad.rows; ++i) {
    for (fingerpad::Index j = 0; j < pad.cols; ++j) {
      const double l = scenes.free_mm()(i, j);
      if (!std::isnan(l)) {
        const auto c = pad.colour(i, j, l, 57);
        mean.red(i, j) = c.red + 0.25 * random.normal();
        mean.green(i, j) = c.green + 0.25 * random.normal();
      }
    }
  }
  return {pad.published(), mean.red, mean.green, scenes.free_mm()};
}

/// Standard deviation of a pixel's depth from frame to frame, from two frames of one shape.
inline double noise_mm(const test::Image<float>& one, const test::Image<float>& other) {
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < one.cells.size(); ++k) {
    const double d = static_cast<double>(one.cells[k] - other.cells[k]);
    if (!std::isnan(d)) {
      squares += d * d / 2;
      count += 1;
    }
  }
  return std::sqrt(squares / count);
}

/// Change of red and green on the axis from zero depth to 11.7 mm.
inline std::string colour_change() {
  const test::Pad& pad = SceneFrames::instance().pad();
  const fingerpad::Index row = pad.rows / 2, col = pad.cols / 2;
  const auto shallow = pad.colour(row, col, 0, 57), deep = pad.colour(row, col, 11.7, 57);
  return number(std::abs(shallow.red - deep.red)) + " / " +
         number(std::abs(shallow.green - deep.green));
}

inline Section shape_section() {
  SceneFrames& frames = SceneFrames::instance();
  auto estimate = published_depth();
  const auto published = [&](const SceneFrame& frame) {
    test::Image<float> depth(frame.truth_mm.rows(), frame.truth_mm.cols());
    (void)estimate(frame.frame.red, frame.frame.green, depth);
    return depth;
  };
  Section section{"Shape [S]", {}};
  const auto add = [&](const std::string& experiment, const std::string& printed,
                       const std::string& name, const std::string& nearest, bool in_contact) {
    const SceneFrame& frame = frames(name);
    const std::string contact = in_contact ? name : std::string();
    const Spread old(depth_errors(frame, published(frame), contact));
    const Spread ours(depth_errors(frame, frame.measured_mm, contact));
    section.rows.push_back({experiment, "error of depth, mean / sd, mm", printed, old.mean_and_sd(),
                            ours.mean_and_sd(), nearest});
  };
  add("pad without contact", "0.16 / 0.10; compensated 0.10 / 0.07", "free", "free pad", false);
  add("contact (1)", "0.53 / 0.29; compensated 0.30 / 0.20", "press",
      "flat plate, 3.5 mm deep, whole pad", false);
  add("", "", "press", "the same, where it touches", true);
  add("contact (2)", "0.43 / 0.25; compensated 0.25 / 0.18", "roll", "sphere of 18 mm, whole pad",
      false);
  add("contact (2), another", "0.53 / 0.39; compensated 0.43 / 0.24", "tilt",
      "plate tilted by 8 degrees, whole pad", false);
  add("limits of shape, three objects",
      "0.72 / 0.70, 0.67 / 0.62, 0.74 / 0.54; compensated 0.58 / 0.42, 0.60 / 0.37, 0.56 / 0.35",
      "cylinder", "cylinder of 12 mm, whole pad", false);
  add("", "", "cylinder", "the same, where it touches", true);
  const SceneFrame &one = frames("free"), &other = frames("free", 2);
  section.rows.push_back({"\"resolution\"", "sd of a pixel's depth from frame to frame, mm",
                          "0.00037 (a step of the smoothed colour, no noise)",
                          number(noise_mm(published(one), published(other))),
                          number(noise_mm(one.measured_mm, other.measured_mm)),
                          "free pad, one grey level of noise"});
  section.rows.push_back({"colour over 11.7 mm of depth", "change of red / green, grey levels",
                          "8 / 31.5", colour_change(), colour_change(),
                          "the light of the frames here"});
  return section;
}

/// Intersection over union of a mask and the true contact.
inline std::string overlap(const SceneFrame& frame,
                           const test::Image<std::uint8_t>& mask,
                           const std::string& name) {
  const test::Pad& pad = SceneFrames::instance().pad();
  const test::TrueContact truth(name);
  double both = 0, either = 0;
  for (fingerpad::Index i = 0; i < pad.rows; ++i) {
    for (fingerpad::Index j = 0; j < pad.cols; ++j) {
      const auto p = point_at(pad.camera, static_cast<double>(i), static_cast<double>(j),
                              frame.truth_mm(i, j));
      const bool in = mask(i, j) != 0, is = !std::isnan(p.z) && truth(p.x, p.y);
      both += in && is ? 1 : 0;
      either += in || is ? 1 : 0;
    }
  }
  return percent(both / either);
}

inline Section contact_section() {
  using namespace fingerpad;
  SceneFrames& frames = SceneFrames::instance();
  const test::Pad& pad = frames.pad();
  Section section{"Contact region [C]", {}};
  for (const std::string name : {"press", "tilt", "cylinder", "roll"}) {
    const SceneFrame& frame = frames(name);
    test::Image<std::uint8_t> mask(pad.rows, pad.cols);
    (void)published::contact_by_slides(frame.measured_mm, mask, {.pitch_mm = pad.camera.pitch_mm});
    section.rows.push_back({name == "press" ? "square, hexagon bolt, ring (pictures)" : "",
                            "overlap with the true region: intersection over union", "none",
                            overlap(frame, mask, name), overlap(frame, frame.measured, name),
                            name == "press"      ? "flat plate"
                            : name == "tilt"     ? "tilted plate"
                            : name == "cylinder" ? "cylinder of 12 mm"
                                                 : "sphere of 18 mm"});
  }
  return section;
}

}  // namespace bench::papers
