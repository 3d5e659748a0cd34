// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where rows of dots around a rim are seen on the free pad: rings around the axis that are darker
// with the period and the phase of their row.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Between four pixels; 0 outside.
template <class View>
double light_at(const View& image, const Point2<double>& p) {
  const double x = std::floor(p.x), y = std::floor(p.y), u = p.x - x, v = p.y - y;
  if (!(x >= 0 && y >= 0 && x + 1 < double(image.cols()) && y + 1 < double(image.rows()))) {
    return 0;
  }
  const auto j = Index(x), i = Index(y);
  return (1 - v) * ((1 - u) * double(image(i, j)) + u * double(image(i, j + 1))) +
         v * ((1 - u) * double(image(i + 1, j)) + u * double(image(i + 1, j + 1)));
}

/// Row has count, arc_mm and first_angle_rad.
template <class Row>
struct SideRings {
  const Camera<double>& camera;
  double base_radius_mm;
  std::span<const Row> rows;

  Point2<double> at(double rho_mm, double angle) const {
    return pixel_of(camera, Point3<double>{rho_mm * std::cos(angle), rho_mm * std::sin(angle), 0});
  }
  static double angle(const Row& row, double k) {
    return row.first_angle_rad + 2 * std::numbers::pi * k / double(row.count);
  }

  /// How much a ring is darkened with the period and phase of a row, as a share of its light.
  template <class View>
  double score(const View& image, const Row& row, double rho_mm) const {
    constexpr int samples = 8;  // of a spacing
    double dark = 0, light = 0;
    for (Index k = 0; k < samples * row.count; ++k) {
      const double step = double(k) / samples;
      const double here = light_at(image, at(rho_mm, angle(row, step)));
      dark -= here * std::cos(2 * std::numbers::pi * step);
      light += here;
    }
    return light > 0 ? dark / light : 0;
  }

  /// Each row's distance from the axis on the plate, from the rim inward: those with the largest
  /// sum of scores.
  template <class View>
  std::vector<double> radii(const View& image) const {
    const double step = camera.pitch_mm / 2;
    const auto count = std::size_t(0.7 * base_radius_mm / step);
    const auto rho = [&](std::size_t i) { return base_radius_mm - step * double(i); };
    std::vector<std::vector<double>> sums;
    std::vector<std::vector<std::size_t>> before;  // where the row before lies
    for (const Row& row : rows) {
      const std::size_t r = sums.size();
      const double apart = 0.2 * (row.arc_mm - (r > 0 ? rows[r - 1].arc_mm : 0));
      const auto gap = std::size_t(apart / step) + 1;
      std::vector<double> sum(count, -1e9);
      std::vector<std::size_t> from(count, 0);
      std::size_t best = 0;
      for (std::size_t i = gap; i < count; ++i) {
        if (r > 0 && sums[r - 1][i - gap] > sums[r - 1][best]) {
          best = i - gap;
        }
        from[i] = best;
        sum[i] = score(image, row, rho(i)) + (r > 0 ? sums[r - 1][best] : 0);
      }
      sums.push_back(sum);
      before.push_back(from);
    }
    std::vector<double> radii(sums.size());
    const auto& last = sums.back();
    auto at = std::size_t(std::max_element(last.begin(), last.end()) - last.begin());
    for (std::size_t r = sums.size(); r-- > 0;) {
      radii[r] = rho(at);
      at = before[r][at];
    }
    return radii;
  }
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
