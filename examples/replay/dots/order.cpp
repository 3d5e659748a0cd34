// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/order.hpp"

#include <cmath>
#include <complex>
#include <opencv2/imgproc.hpp>

#include "replay/dots/match.hpp"

namespace replay {
namespace {

using Point = fingerpad::Point3<double>;

/// From a place in the print (columns, rows, from its center) to one in plan (mm).
struct Lay {
  double turn_rad = 0;
  double pitch_mm = 0;
  cv::Vec2d shift{0, 0};  ///< in pitches, along the print's columns and rows

  cv::Vec2d plan_mm(const cv::Vec2d& print) const {
    const cv::Vec2d p = pitch_mm * (print + shift);
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    return {c * p[0] - s * p[1], s * p[0] + c * p[1]};
  }
  /// The same without the shift, backwards.
  cv::Vec2d print(const cv::Vec2d& plan_mm) const {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    return cv::Vec2d(c * plan_mm[0] + s * plan_mm[1], -s * plan_mm[0] + c * plan_mm[1]) / pitch_mm;
  }
};

/// The free pad's surface as the camera sees it.
class Surface {
 public:
  Surface(const fingerpad::Camera<double>& camera, const cv::Mat_<float>& depth_mm)
      : camera_(camera), depth_mm_(depth_mm) {}

  /// x and y of what a pixel sees, mm; NaN off the pad.
  cv::Vec2d plan_mm(const cv::Vec2d& pixel) const {
    const double depth = depth_at(pixel);
    if (!std::isfinite(depth)) {
      return no_dot();
    }
    const Point point = fingerpad::point_at(camera_, pixel[1], pixel[0], depth);
    return {point.x, point.y};
  }

  /// The pixel that sees the surface at (x, y); NaN off the pad. The depth there changes the pixel
  /// by less than the pixel changes the depth, so repeating converges.
  cv::Vec2d pixel(const cv::Vec2d& plan_mm) const {
    constexpr int rounds = 40;
    cv::Vec2d at = pixel_at_depth(plan_mm, 0.0);
    for (int round = 0; round < rounds; ++round) {
      const double depth = depth_at(at);
      if (!std::isfinite(depth)) {
        return no_dot();
      }
      const cv::Vec2d next = pixel_at_depth(plan_mm, depth);
      if (cv::norm(next - at) < 1e-3) {
        return next;
      }
      at = next;
    }
    return at;
  }

 private:
  cv::Vec2d pixel_at_depth(const cv::Vec2d& plan_mm, double depth_mm) const {
    const auto pixel = fingerpad::pixel_of(camera_, Point{plan_mm[0], plan_mm[1], depth_mm});
    return {pixel.x, pixel.y};
  }

  /// Between the four pixels around; NaN where one of them is off the pad.
  double depth_at(const cv::Vec2d& pixel) const {
    const int col = static_cast<int>(std::floor(pixel[0]));
    const int row = static_cast<int>(std::floor(pixel[1]));
    if (!(row >= 0 && col >= 0 && row + 1 < depth_mm_.rows && col + 1 < depth_mm_.cols)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const double u = pixel[0] - col;
    const double v = pixel[1] - row;
    const auto d = [&](int i, int j) { return static_cast<double>(depth_mm_(row + i, col + j)); };
    return (1 - v) * ((1 - u) * d(0, 0) + u * d(0, 1)) + v * ((1 - u) * d(1, 0) + u * d(1, 1));
  }

  const fingerpad::Camera<double>& camera_;
  const cv::Mat_<float>& depth_mm_;
};

/// Turn and pitch under which the spots lie best on a square grid, and the grid's shift within one
/// pitch: the phases of all spots agree there.
Lay regular_lay(const Blobs& plan_mm, const Dots& dots) {
  constexpr double pi = 3.14159265358979323846;
  // Parity of the print: of an even number of dots none lies at the center.
  const cv::Vec2d half((dots.cols - 1) / 2.0, (dots.rows - 1) / 2.0);
  Lay best;
  double best_agreement = -1;
  for (int turn = -24; turn <= 24; ++turn) {
    for (int stretch = -15; stretch <= 15; ++stretch) {
      Lay lay;
      lay.turn_rad = turn * 0.5 * pi / 180;
      lay.pitch_mm = dots.pitch_mm * (1 + 0.01 * stretch);
      std::complex<double> x = 0;
      std::complex<double> y = 0;
      for (const cv::Vec2d& at : plan_mm) {
        const cv::Vec2d print = lay.print(at) + half;
        x += std::polar(1.0, 2 * pi * print[0]);
        y += std::polar(1.0, 2 * pi * print[1]);
      }
      const double agreement = std::abs(x) + std::abs(y);
      if (agreement > best_agreement) {
        best_agreement = agreement;
        lay.shift = {std::arg(x) / (2 * pi), std::arg(y) / (2 * pi)};
        best = lay;
      }
    }
  }
  return best;
}

DotGrid projected(const Lay& lay, const Surface& surface, cv::Size size) {
  DotGrid pixels(size);
  for (int i = 0; i < size.height; ++i) {
    for (int j = 0; j < size.width; ++j) {
      const cv::Vec2d print(j - (size.width - 1) / 2.0, i - (size.height - 1) / 2.0);
      pixels(i, j) = surface.pixel(lay.plan_mm(print));
    }
  }
  return pixels;
}

/// The dots within `reach` (in the grid) of the one nearest to `center`.
cv::Mat_<uchar> dots_around(const DotGrid& pixels, const cv::Vec2d& center, int reach) {
  cv::Point nearest(0, 0);
  double distance = std::numeric_limits<double>::infinity();
  for (int i = 0; i < pixels.rows; ++i) {
    for (int j = 0; j < pixels.cols; ++j) {
      if (is_present(pixels(i, j)) && cv::norm(pixels(i, j) - center) < distance) {
        distance = cv::norm(pixels(i, j) - center);
        nearest = {j, i};
      }
    }
  }
  cv::Mat_<uchar> seeds(pixels.size(), uchar{0});
  const cv::Rect box(nearest - cv::Point(reach, reach), nearest + cv::Point(reach + 1, reach + 1));
  seeds(box & cv::Rect(cv::Point(0, 0), pixels.size())) = 1;
  return seeds;
}

}  // namespace

FirstOrder order_free_pad(const Sensor& sensor,
                          const cv::Mat_<float>& reference_depth,
                          const Blobs& blobs) {
  const Dots& dots = *sensor.dots;
  const cv::Size size(dots.cols, dots.rows);
  const Surface surface(sensor.camera, reference_depth);
  const cv::Vec2d axis_px(sensor.camera.center_x_px, sensor.camera.center_y_px);
  Blobs central_mm;  // where the membrane is nearly level, so that a stretch does least
  for (const cv::Vec2d& blob : blobs) {
    const cv::Vec2d plan_mm = surface.plan_mm(blob);
    if (is_present(plan_mm) && cv::norm(plan_mm) < 0.4 * sensor.pad.base_radius_mm) {
      central_mm.push_back(plan_mm);
    }
  }
  const Lay lay = regular_lay(central_mm, dots);
  const BlobMap map(blobs);
  FirstOrder best{no_dots(size), no_dots(size)};
  double best_score = 0;
  // The spots alone do not say which of them is the first; the print's border does.
  for (int down = -1; down <= 1; ++down) {
    for (int right = -1; right <= 1; ++right) {
      Lay shifted = lay;
      shifted.shift += cv::Vec2d(right, down);
      const DotGrid expected = projected(shifted, surface, size);
      const Matcher matcher(expected, map);
      constexpr int reach = 3;
      const Labels labels =
          matcher.match(dots_around(expected, axis_px, reach), DotGrid(size, cv::Vec2d(0, 0)));
      const double found = cv::countNonZero(labels >= 0);
      const double score = found - cv::norm(shifted.shift);
      if (found > 0 && score > best_score) {
        best_score = score;
        best = {dots_of(labels, map), expected};
      }
    }
  }
  return best;
}

}  // namespace replay
