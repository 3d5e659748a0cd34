// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes the pose of a plate that is pressed into the pad, tilted and rotated, from the dots that
// stick to it.
#include <cmath>
#include <cstdio>
#include <vector>

#include "fingerpad/motion/object_motion.hpp"

using fingerpad::Index;
using Dot = fingerpad::Point3<double>;

int main() {
  // 21 x 21 dots on the free pad, a cap 13 mm high. Any grid of points with x, y and z works.
  constexpr Index n = 21;
  std::vector<Dot> free(n * n), dots(n * n);
  std::vector<unsigned char> contact(n * n);
  for (Index k = 0; k < n * n; ++k) {
    const double x = 1.5 * double(k % n - 10), y = 1.5 * double(k / n - 10);
    free[std::size_t(k)] = {x, y, 13 - (x * x + y * y) / 40};
  }
  const fingerpad::StridedView<const Dot> dot_grid(dots.data(), n, n, n);
  const fingerpad::StridedView<const unsigned char> contact_grid(contact.data(), n, n, n);

  fingerpad::ObjectMotion motion(n, n);  // once

  fingerpad::ObjectMotionResult<double> seen;
  fingerpad::Pose<double> plate;
  for (int frame = 0; frame <= 10; ++frame) {
    const double s = 0.1 * frame;  // share of the plate's true motion since first contact
    plate = {fingerpad::rotation_of(fingerpad::Angles<double>{0.10 * s, -0.05 * s, 0.20 * s}),
             {1.0 * s, -0.5 * s, -0.5 * s}};
    for (std::size_t k = 0; k < free.size(); ++k) {
      contact[k] = std::hypot(free[k].x, free[k].y) < 5 ? 1 : 0;
      const Dot pressed = {free[k].x, free[k].y, 11.5};
      dots[k] = contact[k] != 0 ? plate(pressed) : free[k];
    }
    seen = motion(dot_grid, contact_grid);  // every frame
    if (frame % 5 == 0) {
      std::printf("frame %2d: %s, %td dots, at (%.3f, %.3f, %.3f) mm, angles %.4f %.4f %.4f rad\n",
                  frame, name_of(seen.status), seen.dots_used, seen.position_mm.x,
                  seen.position_mm.y, seen.position_mm.z, seen.angles.x_rad, seen.angles.y_rad,
                  seen.angles.z_rad);
    }
  }
  // The pose moves any point of the object, here a corner of the plate.
  const Dot corner = seen.pose(Dot{20, 15, 11.5});
  std::printf("the corner of the object is now at (%.3f, %.3f, %.3f) mm\n", corner.x, corner.y,
              corner.z);
  const Dot truth = plate(Dot{20, 15, 11.5});
  return seen.ok() && std::abs(corner.x - truth.x) + std::abs(corner.z - truth.z) < 1e-9 ? 0 : 1;
}
