// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames of the gel of elastic_gel.hpp. Colours show the slope of the surface, as under three
// lamps at the pad's sides, and dark dots move with the gel. Noise in grey levels, an exposure, and
// jitter of the detected dots are included.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "elastic_gel.hpp"
#include "fingerpad/core/dots.hpp"
#include "pad.hpp"

namespace test {

using ColourFrame = Image<std::array<std::uint8_t, 3>>;
using GelDots = Image<fingerpad::Point2<double>>;

/// A copy of the frame.
inline cv::Mat mat_of(const ColourFrame& frame) {
  auto* const bytes = const_cast<std::array<std::uint8_t, 3>*>(frame.cells.data());
  return cv::Mat(static_cast<int>(frame.rows()), static_cast<int>(frame.cols()), CV_8UC3, bytes)
      .clone();
}

struct GelCamera {
  Index rows = 240;
  Index cols = 320;
  double mm_per_px = 0.08;
  double pitch_mm = 2.4;  ///< of the dots
  double dot_mm = 0.8;    ///< their diameter; 0: none
  double level = 130;     ///< grey level of the free gel in the middle
  double contrast = 0.5;  ///< relative change of brightness per slope
  double noise = 1;       ///< standard deviation, grey levels
  double exposure = 1;
  double jitter_px = 0.03;

  double pitch_px() const { return pitch_mm / mm_per_px; }
  Index dot_rows() const { return static_cast<Index>(static_cast<double>(rows) / pitch_px()); }
  Index dot_cols() const { return static_cast<Index>(static_cast<double>(cols) / pitch_px()); }

  fingerpad::Point2<double> mm_of(double row, double col) const {
    return {(col - static_cast<double>(cols - 1) / 2) * mm_per_px,
            (row - static_cast<double>(rows - 1) / 2) * mm_per_px};
  }
  fingerpad::Point2<double> px_of(const fingerpad::Point2<double>& mm) const {
    return {mm.x / mm_per_px + static_cast<double>(cols - 1) / 2,
            mm.y / mm_per_px + static_cast<double>(rows - 1) / 2};
  }

  /// Positions of the dots without jitter.
  GelDots true_dots(const BallOnGel<>& contact) const {
    GelDots dots(dot_rows(), dot_cols());
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const fingerpad::Point2<double> at = {
            (static_cast<double>(j) - static_cast<double>(dots.cols() - 1) / 2) * pitch_mm,
            (static_cast<double>(i) - static_cast<double>(dots.rows() - 1) / 2) * pitch_mm};
        const auto moved = contact.displacement_mm(at);
        dots(i, j) = px_of({at.x + moved.x, at.y + moved.y});
      }
    }
    return dots;
  }
  GelDots dots(const BallOnGel<>& contact, Random& random) const {
    GelDots found = true_dots(contact);
    for (auto& dot : found.cells) {
      dot.x += jitter_px * random.normal();
      dot.y += jitter_px * random.normal();
    }
    return found;
  }

  ColourFrame frame(const BallOnGel<>& contact, Random& random) const {
    ColourFrame frame(rows, cols);
    const auto slope = slopes(contact);
    const auto ball = px_of(contact.ball_mm());
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const double x = static_cast<double>(j) - ball.x;
        const double y = static_cast<double>(i) - ball.y;
        const double r = std::hypot(x, y);
        const double steep = r > 0 ? slope_at(slope, r) / r : 0;
        frame(i, j) = seen(i, j, {steep * x, steep * y}, random);
      }
    }
    if (dot_mm > 0) {
      draw(true_dots(contact), frame);
    }
    return frame;
  }

  /// The pixels that the ball touches.
  Image<std::uint8_t> touched(const BallOnGel<>& contact) const {
    Image<std::uint8_t> mask(rows, cols);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const auto p = mm_of(static_cast<double>(i), static_cast<double>(j)) - contact.ball_mm();
        mask(i, j) = contact.touches() && norm(p) < contact.radius_mm() ? 255 : 0;
      }
    }
    return mask;
  }

 private:
  static constexpr double step_px = 0.5;

  /// dz / dr at multiples of step_px from the ball's axis.
  std::vector<double> slopes(const BallOnGel<>& contact) const {
    std::vector<double> slope;
    const double step_mm = step_px * mm_per_px;
    const auto far = static_cast<Index>(2 * static_cast<double>(rows + cols) / step_px);
    for (Index k = 0; k <= far; ++k) {
      const double r = static_cast<double>(k) * step_mm;
      const auto z = [&](double at) {
        return contact.displacement_mm({contact.ball_mm().x + at, contact.ball_mm().y}).z;
      };
      slope.push_back((z(r + step_mm / 2) - z(r > 0 ? r - step_mm / 2 : step_mm / 2)) / step_mm);
    }
    return slope;
  }
  static double slope_at(const std::vector<double>& slope, double r_px) {
    const double at = (std::min)(r_px / step_px, static_cast<double>(slope.size()) - 2);
    const auto k = static_cast<std::size_t>(at);
    return slope[k] + (at - static_cast<double>(k)) * (slope[k + 1] - slope[k]);
  }

  std::array<std::uint8_t, 3> seen(Index i,
                                   Index j,
                                   const fingerpad::Point2<double>& slope,
                                   Random& random) const {
    constexpr std::array<fingerpad::Point2<double>, 3> lamps = {
        {{1, 0}, {-0.5, 0.8660254}, {-0.5, -0.8660254}}};
    std::array<std::uint8_t, 3> pixel{};
    const fingerpad::Point2<double> place = {
        static_cast<double>(j) / static_cast<double>(cols) - 0.5,
        static_cast<double>(i) / static_cast<double>(rows) - 0.5};
    for (std::size_t c = 0; c < 3; ++c) {
      const double bright =
          (1 + 0.5 * dot(lamps[c], place)) * (1 + contrast * dot(lamps[c], slope));
      // a sum of three uniform numbers: near enough to a normal one, and fast for many pixels
      const double grain = 2 * (random.uniform() + random.uniform() + random.uniform()) - 3;
      pixel[c] = stored<std::uint8_t>(exposure * level * bright + noise * grain);
    }
    return pixel;
  }

  void draw(const GelDots& dots, ColourFrame& frame) const {
    const double radius = dot_mm / mm_per_px / 2;
    for (const auto& dot : dots.cells) {
      const auto first = [&](double at) {
        return (std::max)(Index(0), static_cast<Index>(std::floor(at - radius - 1)));
      };
      for (Index i = first(dot.y); i < rows && static_cast<double>(i) < dot.y + radius + 1; ++i) {
        for (Index j = first(dot.x); j < cols && static_cast<double>(j) < dot.x + radius + 1; ++j) {
          const double r =
              std::hypot(static_cast<double>(j) - dot.x, static_cast<double>(i) - dot.y);
          const double inside = (std::clamp)(radius + 0.5 - r, 0.0, 1.0);
          for (auto& channel : frame(i, j)) {
            channel = static_cast<std::uint8_t>(channel * (1 - 0.6 * inside));
          }
        }
      }
    }
  }
};

}  // namespace test
