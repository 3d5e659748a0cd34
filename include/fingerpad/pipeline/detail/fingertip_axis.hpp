// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where the axis of a pad lies in the picture of its free printed grid.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// On the plate, from the camera's axis; NaN: not found.
struct AxisOfGrid {
  Point2<double> at_mm = {not_a_number<double>(), not_a_number<double>()};
  double sd_mm = not_a_number<double>();  ///< of each coordinate, by what the fit leaves over
};

/// A free pad is the same all around its axis, so a square lattice on it is seen drawn out along
/// the radii, about one point: a dot at w of the lattice, v = w - apex, is seen at
///   axis + v (k0 + k1 |v|^2 + ... + k4 |v|^8),
/// all complex; by Gauss and Newton's method in the apex. Neither shape nor rubber need be known. A
/// lattice that is not square, or dots printed off their places, make the sd larger.
template <class Dots>
AxisOfGrid axis_of_grid(const Camera<double>& camera, const Dots& dots_px) {
  using Complex = std::complex<double>;
  constexpr std::size_t powers = 5, n = 2 * (powers + 2);  // k0, axis, k1 to k4, apex
  constexpr std::size_t axis = 2, apex_at = n - 2;
  const auto middle = [](Index count) { return static_cast<double>(count - 1) / 2; };
  const double row = middle(dots_px.rows()), col = middle(dots_px.cols());
  std::array<Complex, powers> k{};
  Complex apex = 0;
  for (int step = 0; step < 20; ++step) {
    ProductSums<double, n + 1> sums;
    for (std::size_t m = apex_at; m < n; ++m) {  // in proportion, it is the same as the axis
      sums.sum[m][m] = step == 1 ? 1 : 0;
    }
    double equations = 0;
    for (Index i = 0; i < dots_px.rows(); ++i) {
      for (Index j = 0; j < dots_px.cols(); ++j) {
        const Point2<double> px = dots_px(i, j);
        const auto at = point_at(camera, px.y, px.x, 0.0);
        if (!is_plausible(at)) {
          continue;
        }
        const Complex w(static_cast<double>(j) - col, static_cast<double>(i) - row);
        const Complex v = w / (std::max)({row, col, 1.0}) - apex;
        std::array<Complex, n> of{};  // the place by each unknown
        double power = 1, below = 0;  // |v|^2m, and that of m - 1
        for (std::size_t m = 0; m < powers; ++m) {
          const double order = static_cast<double>(m);
          const Complex along = (order + 1) * power, across = order * below * v * v;
          of[m == 0 ? 0 : 2 * m + 2] = power * v;
          of[apex_at] -= k[m] * (along + across);
          of[apex_at + 1] -= Complex(0, 1) * k[m] * (along - across);
          below = power;
          power *= std::norm(v);
        }
        of[axis] = 1;
        for (std::size_t m = 0; m < apex_at; m += 2) {
          of[m + 1] = Complex(0, 1) * of[m];
        }
        std::array<double, n + 1> x{}, y{};
        for (std::size_t m = 0; m < n; ++m) {
          x[m] = of[m].real(), y[m] = of[m].imag();
        }
        x[n] = at.x, y[n] = at.y;
        sums.add(x), sums.add(y);
        equations += 2;
      }
    }
    if (equations < 4 * n) {
      return {};
    }
    if (step == 0) {  // seen in proportion, about the camera's axis
      const auto linear =
          NormalEquations<double, 4>(sums.template corner<4>()).solve(sums.template column<4>(n));
      k[0] = {linear[0], linear[1]};
      apex = -Complex(linear[2], linear[3]) / k[0];
      continue;
    }
    const NormalEquations<double, n> normal(sums.template corner<n>(), 1e-12);
    const auto b = sums.template column<n>(n), x = normal.solve(b);
    const Complex change(x[apex_at], x[apex_at + 1]);
    if (!normal.good || !(std::norm(apex) < 1)) {
      return {};
    }
    for (std::size_t m = 0; m < powers; ++m) {
      k[m] = {x[m == 0 ? 0 : 2 * m + 2], x[m == 0 ? 1 : 2 * m + 3]};
    }
    apex += change * (std::min)(1.0, 0.1 / std::abs(change));
    if (step > 1 && std::abs(change) < 1e-5) {
      double left = sums(n, n);
      for (std::size_t m = 0; m < n; ++m) {
        left -= x[m] * b[m];
      }
      std::array<double, n> of_axis{};
      of_axis[axis] = 1;
      const double variance = normal.variance(of_axis) * left / (equations - n);
      return {{x[axis], x[axis + 1]}, std::sqrt((std::max)(variance, 0.0))};
    }
  }
  return {};
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
