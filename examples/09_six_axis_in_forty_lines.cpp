// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes the six-axis force and moment of a plate that is pressed into the pad and rotated about
// its normal. The inputs are the fluid's pressure, the membrane's shape and the dots beside its
// rim.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "fingerpad/force/wrench.hpp"

using Point = fingerpad::Point3<double>;
using fingerpad::Index;
constexpr double pi = std::numbers::pi, radius = 18, touch = 8;  // of the pad and the plate, mm

/// Sine of the inclination of a membrane with uniform tension; 0.9 at the rim.
double sine(double r) {
  return 0.9 * radius / (radius * radius - touch * touch) * (r * r - touch * touch) / r;
}

struct Slope {
  double height_mm, along_x, along_y;
};

struct Pad {  // flat under the plate, then a surface of constant mean curvature down to the rim
  Slope operator()(double x, double y) const {
    const double r = std::fmax(std::hypot(x, y), touch);
    const auto steepness = [](double at) { return std::tan(std::asin(sine(at))); };
    double height = 0;
    for (int k = 0; k < 100; ++k) {
      height += (radius - r) / 100 * steepness(r + (k + 0.5) * (radius - r) / 100);
    }
    return {height, -steepness(r) * x / r, -steepness(r) * y / r};
  }
  bool in_contact(double x, double y) const { return std::hypot(x, y) < touch; }
};

int main() {
  // The truth: stretch of the rim, and its shear by the rotation. At this pressure the stretched
  // rim balances the part of the pressure that the plate does not bear.
  constexpr double mu_t = 0.5, length = 0.8, stretch = 1.1, turn = 0.05;
  const double phi = std::asin(sine(radius));
  const double pull = mu_t * (stretch - std::pow(stretch, -3)) * std::sin(phi);
  const double p = 2 * radius * pull / (radius * radius - touch * touch);
  std::vector<Point> rim, dots;
  for (int k = 0; k < 36; ++k) {
    const double angle = pi * k / 18, c = std::cos(angle), s = std::sin(angle);
    const double inward = length * stretch * std::cos(phi), along = length * turn;
    rim.push_back({radius * c, radius * s, 0});
    dots.push_back({(radius - inward) * c - along * s, (radius - inward) * s + along * c,
                    length * stretch * std::sin(phi)});
  }
  const fingerpad::StridedView<const Point> border(rim.data(), 1, 36, 36);
  const fingerpad::StridedView<const Point> side_dots(dots.data(), 1, 36, 36);

  fingerpad::Wrench<> wrench(border,
                             {.base_radius_mm = radius, .side_dot_length_mm = length});  // once
  const auto seen = wrench(Pad(), side_dots, p);  // every frame

  const double fz = -p * pi * touch * touch;
  const double mz = mu_t * turn * 2 * pi * radius * radius;
  std::printf("%s: force (%.3f, %.3f, %.3f) N, moment (%.2f, %.2f, %.2f) N mm\n",
              name_of(seen.status), seen.force_n.x, seen.force_n.y, seen.force_n.z,
              seen.moment_n_mm.x, seen.moment_n_mm.y, seen.moment_n_mm.z);
  std::printf("true: force (0, 0, %.3f) N, moment (0, 0, %.2f) N mm\n", fz, mz);
  const double error = std::abs(seen.force_n.z / fz - 1) + std::abs(seen.moment_n_mm.z / mz - 1);
  return seen.ok() && error < 0.01 ? 0 : 1;
}
