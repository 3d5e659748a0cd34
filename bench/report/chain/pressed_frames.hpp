// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames for the whole chain with the truth of every result. A membrane in equilibrium is pressed
// flat by a plate that drags its dots back and forth and rotates them without slip. Colours are
// 8-bit with one grey level of noise.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "chains.hpp"
#include "support/pressed_pad.hpp"
#include "support/soap_film.hpp"

namespace chain {

using fingerpad::Point3;

constexpr double pressure_mpa = test::pressed_mpa;
constexpr double pitch_mm = 1.5;  ///< of the dots

/// Pose of the plate in frame k of `count`, and its effect on the pad.
struct Plate {
  double shift_x_mm = 0;
  double shift_y_mm = 0;
  double turn_rad = 0;
  double contact_mm = 8;

  Plate(int k, int count) {
    const double at = 2 * std::numbers::pi * k / count;
    shift_x_mm = 0.5 * std::cos(at);
    shift_y_mm = 0.5 * std::sin(at);
    turn_rad = 0.05 * std::sin(at);
    contact_mm = 8 + 0.4 * std::sin(at + 1);
  }
};

/// One frame with its truth.
struct PressedFrame {
  Plate plate;
  test::RoundPad<test::FilmSide> membrane;
  test::Image<double> depth_mm;  ///< NaN outside of the pad
  test::Frame<std::uint8_t> image;
  test::Image<Point2<double>> dots_px;

  Inputs view() const {
    return {fingerpad::as_view(image.red), fingerpad::as_view(image.green), dots_px.view(),
            pressure_mpa};
  }
  double contact_area_mm2() const { return std::numbers::pi * plate.contact_mm * plate.contact_mm; }
};

class PressedFrames {
 public:
  /// The pad fills most of the image, whatever its size.
  explicit PressedFrames(Index rows = 480, Index cols = 640, int count = 16, Index dots = 21)
      : dots_(dots) {
    pad_.rows = rows;
    pad_.cols = cols;
    pad_.camera.pitch_mm = 0.0768 * 640 / static_cast<double>(cols);
    pad_.camera.center_x_px = static_cast<double>(cols - 1) / 2;
    pad_.camera.center_y_px = static_cast<double>(rows - 1) / 2;
    for (int k = 0; k < count; ++k) {
      frames_.push_back(frame(k, count));
    }
    free_dots_ = free_dots();
  }

  std::size_t size() const { return frames_.size(); }
  const PressedFrame& operator[](std::size_t k) const { return frames_[k]; }
  Index pixels() const { return pad_.rows * pad_.cols; }

  /// Options that refer to this object.
  FingertipOptions options() const {
    FingertipOptions f{pad_.camera, pad_.fluid, pad_.reference<float>()};
    f.free_dots_mm = free_dots_.view();
    // windows and rings of the default width on the pad, which is set for 640 x 480; 109 px is the
    // most without samples
    const double scale = static_cast<double>(pad_.cols) / 640;
    f.smoothing_px = (std::min)(2 * static_cast<int>(14 * scale) + 1, 109);
    f.contact.ring_px = 25 * scale;
    // by area: the plate's pressure on it; by depth: a line between two of the frames
    constexpr double residual_n = 0.1;
    f.force_of_area.emplace(fingerpad::ForceCurve<>{{0, pressure_mpa}, 50, 400, residual_n});
    const auto of_depth = [&](double contact_mm) {
      test::RoundPad<test::FilmSide> pad;
      pad.contact_mm = contact_mm;
      return std::pair{f.contact.free_apex_mm - pad.height(0),
                       pressure_mpa * std::numbers::pi * contact_mm * contact_mm};
    };
    const auto [less_mm, less_n] = of_depth(7.6);
    const auto [more_mm, more_n] = of_depth(8.4);
    const double slope = (more_n - less_n) / (more_mm - less_mm);
    f.force_of_depth.emplace(fingerpad::ForceCurve<>{
        {less_n - slope * less_mm, slope}, less_mm - 0.5, more_mm + 0.5, residual_n});
    f.shear.emplace(fingerpad::ShearMap<>{100, {1, 0.65, 10}, {1, 1.7, 1}});
    return f;
  }

  /// Frame k of `count`.
  PressedFrame frame(int k, int count) const {
    const Plate plate(k, count);
    test::RoundPad<test::FilmSide> membrane;
    membrane.contact_mm = plate.contact_mm;
    const test::RoundFilm film({.radius_mm = plate.contact_mm,
                                .free_per_mm = membrane.curvature_per_mm(),
                                .top_mm = membrane.height(0)});
    test::Image<double> depth(pad_.rows, pad_.cols, test::nan);
    for (Index i = 0; i < pad_.rows; ++i) {
      for (Index j = 0; j < pad_.cols; ++j) {
        if (pad_.ray(i, j).plate_rho_mm < pad_.base_radius_mm()) {
          depth(i, j) = test::depth_at_pixel(pad_.camera, film, i, j);
        }
      }
    }
    test::Image<Point2<double>> dots(dots_, dots_, {test::nan, test::nan});
    for (Index i = 0; i < dots_; ++i) {
      for (Index j = 0; j < dots_; ++j) {
        if (printed(home(i, j))) {
          const auto p = carried(plate, membrane.radius_mm, home(i, j));
          dots(i, j) = pixel_of(pad_.camera, Point3<double>{p.x, p.y, film(p.x, p.y)});
        }
      }
    }
    return {plate, membrane, depth,
            pad_.frame<std::uint8_t>(depth, 1, static_cast<std::uint64_t>(k + 1)), dots};
  }

 private:
  /// Where the plate carries a point from `home` on the pad: rigidly under the plate, not at all at
  /// the rim.
  static Point2<double> carried(const Plate& plate, double radius_mm, const Point2<double>& home) {
    const double r = std::hypot(home.x, home.y);
    const double share =
        r < plate.contact_mm ? 1 : (radius_mm - r) / (radius_mm - plate.contact_mm);
    const double c = std::cos(share * plate.turn_rad), s = std::sin(share * plate.turn_rad);
    return {c * home.x - s * home.y + share * plate.shift_x_mm,
            s * home.x + c * home.y + share * plate.shift_y_mm};
  }
  Point2<double> home(Index i, Index j) const {
    const double middle = static_cast<double>(dots_ - 1) / 2;
    const double step_mm = 20 * pitch_mm / static_cast<double>(dots_ - 1);
    return {step_mm * (static_cast<double>(j) - middle),
            step_mm * (static_cast<double>(i) - middle)};
  }
  bool printed(const Point2<double>& home) const {
    return std::hypot(home.x, home.y) < 0.93 * pad_.base_radius_mm();
  }

  test::Image<Point3<double>> free_dots() const {
    test::Image<Point3<double>> dots(dots_, dots_, {test::nan, test::nan, test::nan});
    const double low = pad_.height_mm - pad_.sphere_radius_mm;
    for (Index i = 0; i < dots_; ++i) {
      for (Index j = 0; j < dots_; ++j) {
        const auto h = home(i, j);
        if (printed(h)) {
          const double r_sq = h.x * h.x + h.y * h.y;
          dots(i, j) = {h.x, h.y,
                        low + std::sqrt(pad_.sphere_radius_mm * pad_.sphere_radius_mm - r_sq)};
        }
      }
    }
    return dots;
  }

  test::Pad pad_;
  Index dots_;
  std::vector<PressedFrame> frames_;
  test::Image<Point3<double>> free_dots_;
};

}  // namespace chain
