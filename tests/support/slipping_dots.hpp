// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots on a membrane that an object drags along, with the true stick states. Dots within a stick
// disc move as the object does. Dots outside lag, the more the further they are from it, up to a
// width beyond which they stand still. The size of the disc is given step by step.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "pad.hpp"

namespace test {

using PointsPx = Image<fingerpad::Point2<double>>;
using ContactFlags = Image<std::uint8_t>;

/// The options from which these U and delta_0 follow.
inline fingerpad::StickOptions stick_options(double reference, double slip) {
  const double per_noise = 2 * std::sqrt(56.0) / 18 * std::sqrt(std::log(100.0));
  return {.noise = slip / per_noise, .slip_share = slip / reference, .covers_pattern = false};
}

struct SlippingPattern {
  Index rows = 21;
  Index cols = 21;
  double pitch_px = 19.5;
  double middle_x_px = 320;
  double middle_y_px = 240;
  double contact_pitches = 8.2;  ///< radius of the contact, in pitches of the dots
  double shear_pitches = 1;      ///< from the stick disc to standing dots; 0: a jump
  double disc_row = 0.3;         ///< center of the stick disc from that of the pattern, in
  double disc_col = -0.2;        ///< pitches: off the dots, so that rings do not leave at once

  double home_x_px(Index col) const {
    return middle_x_px + pitch_px * (static_cast<double>(col) - static_cast<double>(cols - 1) / 2);
  }
  double home_y_px(Index row) const {
    return middle_y_px + pitch_px * (static_cast<double>(row) - static_cast<double>(rows - 1) / 2);
  }
  /// Distance of (row, col) from a place of the pattern, in pitches.
  double pitches_from(double at_row, double at_col, Index row, Index col) const {
    return std::hypot(static_cast<double>(row) - static_cast<double>(rows - 1) / 2 - at_row,
                      static_cast<double>(col) - static_cast<double>(cols - 1) / 2 - at_col);
  }
};

/// Motion from one frame to the next.
struct SlipStep {
  double shift_px = 0;
  double direction_rad = 0;
  double turn_rad = 0;     ///< about the object's middle
  double zoom = 1;         ///< of the whole image, about its center
  double stick_share = 9;  ///< radius of the stick disc / that of the contact
};

class SlippingDots {
 public:
  explicit SlippingDots(const SlippingPattern& pattern = {})
      : dots(pattern.rows, pattern.cols),
        contact(pattern.rows, pattern.cols),
        pattern_(pattern),
        object_x_px_(pattern.middle_x_px),
        object_y_px_(pattern.middle_y_px),
        stuck_steps_(pattern.rows, pattern.cols, whole_recording) {
    for (Index i = 0; i < pattern.rows; ++i) {
      for (Index j = 0; j < pattern.cols; ++j) {
        dots(i, j) = {pattern.home_x_px(j), pattern.home_y_px(i)};
        contact(i, j) = pattern.pitches_from(0, 0, i, j) < pattern.contact_pitches ? 1 : 0;
      }
    }
  }

  void step(const SlipStep& s) {
    const double cosine = std::cos(s.turn_rad), sine = std::sin(s.turn_rad);
    const double shift_x = s.shift_px * std::cos(s.direction_rad);
    const double shift_y = s.shift_px * std::sin(s.direction_rad);
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const double lag = lag_of(i, j, s.stick_share * pattern_.contact_pitches);
        auto& p = dots(i, j);
        const double x = p.x - object_x_px_, y = p.y - object_y_px_;
        p.x += (1 - lag) * (cosine * x - sine * y - x + shift_x);
        p.y += (1 - lag) * (sine * x + cosine * y - y + shift_y);
        p.x = zoomed(p.x, pattern_.middle_x_px, s.zoom);
        p.y = zoomed(p.y, pattern_.middle_y_px, s.zoom);
        stuck_steps_(i, j) = lag > 0 ? 0 : stuck_steps_(i, j) + 1;
      }
    }
    object_x_px_ = zoomed(object_x_px_ + shift_x, pattern_.middle_x_px, s.zoom);
    object_y_px_ = zoomed(object_y_px_ + shift_y, pattern_.middle_y_px, s.zoom);
  }

  /// Dots that did not follow in the last step return by this share of their distance from home.
  void spring_back(double share) {
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        if (stuck_steps_(i, j) == 0) {
          auto& p = dots(i, j);
          p.x += share * (pattern_.home_x_px(j) - p.x);
          p.y += share * (pattern_.home_y_px(i) - p.y);
        }
      }
    }
  }

  /// Whether a dot has followed the object in each of the last `steps` steps.
  bool has_stuck(Index row, Index col, Index steps) const {
    return contact(row, col) != 0 && stuck_steps_(row, col) >= steps;
  }
  double stick_ratio(Index steps) const {
    double stick = 0, all = 0;
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        stick += has_stuck(i, j, steps) ? 1 : 0;
        all += contact(i, j) != 0 ? 1 : 0;
      }
    }
    return stick / all;
  }

  PointsPx dots;
  ContactFlags contact;

 private:
  static constexpr Index whole_recording = Index(1) << 40;

  static double zoomed(double p, double middle, double zoom) {
    return middle + zoom * (p - middle);
  }
  /// Share of the object's motion by which a dot lags.
  double lag_of(Index row, Index col, double stick_pitches) const {
    const double outside =
        pattern_.pitches_from(pattern_.disc_row, pattern_.disc_col, row, col) - stick_pitches;
    if (!(outside > 0)) {
      return 0;
    }
    return outside < pattern_.shear_pitches ? outside / pattern_.shear_pitches : 1;
  }

  SlippingPattern pattern_;
  double object_x_px_;
  double object_y_px_;
  Image<Index> stuck_steps_;
};

/// Dots with the noise of a camera.
inline PointsPx noisy(PointsPx dots, double noise_px, Random& random) {
  for (auto& p : dots.cells) {
    const double x = random.normal(), y = random.normal();
    p = {p.x + noise_px * x, p.y + noise_px * y};
  }
  return dots;
}

/// Recordings with one effect each; `everything` has all of them but the reversal.
enum class SlipScene {
  shear,       ///< dragged until hardly anything sticks
  reversal,    ///< and back
  slips,       ///< three times in the same direction: after each slip all sticks again
  turn,        ///< by 20 degrees in place
  shift_turn,  ///< by 20 degrees while it is dragged
  press,       ///< appears 1.15 times as large, all sticks
  zoom_in,     ///< the same while it is dragged and slips
  zoom_out,    ///< appears 0.85 times as large while it is dragged and slips
  everything,  ///< dragged, rotated and pressed, twice
};
inline constexpr std::array all_slip_scenes = {
    SlipScene::shear,   SlipScene::reversal,   SlipScene::slips,
    SlipScene::turn,    SlipScene::shift_turn, SlipScene::press,
    SlipScene::zoom_in, SlipScene::zoom_out,   SlipScene::everything};

constexpr const char* name_of(SlipScene scene) {
  constexpr std::array names = {"shear", "reversal", "slips",    "turn",      "shift and turn",
                                "press", "zoom in",  "zoom out", "everything"};
  return names[static_cast<std::size_t>(scene)];
}

/// Steps of a recording: 16 for each time the disc shrinks from the whole contact to a fifth of it.
inline std::vector<SlipStep> steps_of(SlipScene scene, double direction_rad) {
  constexpr int phase_steps = 16;
  const auto zoom_to = [](double zoom) { return std::pow(zoom, 1.0 / phase_steps); };
  const double turn_rad = std::numbers::pi / 9 / phase_steps;
  SlipStep step{.shift_px = 1.2, .direction_rad = direction_rad};
  std::vector<SlipStep> steps;
  const auto add_phase = [&](double last_share = 0.2) {
    for (int k = 1; k <= phase_steps; ++k) {
      step.stick_share = 1.05 - (1.05 - last_share) * k / phase_steps;
      steps.push_back(step);
    }
  };
  switch (scene) {
    case SlipScene::shear:
      add_phase();
      break;
    case SlipScene::reversal:
      add_phase();
      step.direction_rad += std::numbers::pi;
      add_phase();
      break;
    case SlipScene::slips:
      add_phase();
      add_phase();
      add_phase();
      break;
    case SlipScene::turn:
      step.shift_px = 0;
      step.turn_rad = turn_rad;
      add_phase();
      break;
    case SlipScene::shift_turn:
      step.turn_rad = turn_rad;
      add_phase();
      break;
    case SlipScene::press:
      step.shift_px = 0;
      step.zoom = zoom_to(1.15);
      add_phase(1.05);
      break;
    case SlipScene::zoom_in:
      step.zoom = zoom_to(1.15);
      add_phase();
      break;
    case SlipScene::zoom_out:
      step.zoom = zoom_to(0.85);
      add_phase();
      break;
    case SlipScene::everything:
      step.turn_rad = turn_rad;
      step.zoom = zoom_to(1.15);
      add_phase();
      step.turn_rad = -turn_rad;
      step.zoom = zoom_to(0.85);
      add_phase();
      break;
  }
  return steps;
}

/// Errors of a ratio in recordings of a scene.
struct StickError {
  double mean_abs = 0;  ///< of the ratio, over frames with an answer
  double mean = 0;
  double worst = 0;
  double updated = 0;     ///< share of the frames with an answer
  double wrong_dots = 0;  ///< share of the dots with a wrong state
};

/// Errors with noise in each coordinate, for an object dragged in many directions. `ratio` has seen
/// no frame.
template <class Ratio>
StickError error_of(const Ratio& ratio,
                    SlipScene scene,
                    double noise_px,
                    const SlippingPattern& pattern = {},
                    int recordings = 12) {
  StickError e;
  double frames = 0, answers = 0, dots = 0;
  for (int n = 0; n < recordings; ++n) {
    Random random(static_cast<std::uint64_t>(1 + n));
    SlippingDots truth(pattern);
    Ratio stick = ratio;
    (void)stick(noisy(truth.dots, noise_px, random), truth.contact);
    for (const SlipStep& step : steps_of(scene, 2.4 * n)) {
      truth.step(step);
      const auto r = stick(noisy(truth.dots, noise_px, random), truth.contact);
      ++frames;
      if (!r.updated()) {
        continue;
      }
      ++answers;
      const double error =
          static_cast<double>(fingerpad::value(r.stick_ratio)) - truth.stick_ratio(r.reference_age);
      e.mean_abs += std::abs(error);
      e.mean += error;
      e.worst = (std::max)(e.worst, std::abs(error));
      for (Index i = 0; i < pattern.rows; ++i) {
        for (Index j = 0; j < pattern.cols; ++j) {
          const bool known = stick.states()(i, j) >= fingerpad::DotState::slip;
          const bool sticks = stick.states()(i, j) == fingerpad::DotState::stick;
          dots += known ? 1 : 0;
          e.wrong_dots += known && sticks != truth.has_stuck(i, j, r.reference_age) ? 1 : 0;
        }
      }
    }
  }
  e.mean_abs /= answers;
  e.mean /= answers;
  e.wrong_dots /= dots;
  e.updated = answers / frames;
  return e;
}

}  // namespace test
