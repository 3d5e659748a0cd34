// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots on a curved patch in space that an object carries along by any rigid motion. Dots within a
// stick disc follow it; dots outside lag, the more the further out they are.
#include <algorithm>
#include <cmath>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/math/rotation.hpp"
#include "pad.hpp"

namespace test {

struct SlippingPatch {
  using Point = fingerpad::Point3<double>;
  using Pose = fingerpad::Pose<double>;

  double pitch_mm = 1.5;
  double radius_mm = 6;   ///< of the contact
  double sphere_mm = 18;  ///< of the object's surface; infinite: flat
  Index across = 21;
  Image<Point> dots{across, across};
  Image<std::uint8_t> contact{across, across};
  Image<double> slipped_mm{across, across};  ///< in the last step

  explicit SlippingPatch(double pitch = 1.5, double radius = 6, double sphere = 18)
      : pitch_mm(pitch), radius_mm(radius), sphere_mm(sphere) {
    for (Index i = 0; i < across; ++i) {
      for (Index j = 0; j < across; ++j) {
        const double x = pitch * static_cast<double>(j - across / 2);
        const double y = pitch * static_cast<double>(i - across / 2);
        const double sq = x * x + y * y;
        const bool near = sq < radius * radius;
        const double sag = std::isfinite(sphere) ? sq / (2 * sphere) : 0;
        dots(i, j) = {x, y, 10 + sag};
        contact(i, j) = near ? 1 : 0;
      }
    }
  }

  /// `stick_share`: radius of the stick disc / that of the contact. Beyond the disc dots lag;
  /// `rim` pitches further out they stand still.
  void step(const Pose& motion, double stick_share = 9, double rim = 1) {
    for (Index i = 0; i < across; ++i) {
      for (Index j = 0; j < across; ++j) {
        const double row = pitch_mm * static_cast<double>(i - across / 2);
        const double col = pitch_mm * static_cast<double>(j - across / 2);
        const double outside = std::hypot(row, col) - stick_share * radius_mm;
        const double lag = std::clamp(outside / (rim * pitch_mm), 0.0, 1.0);
        Point& p = dots(i, j);
        const Point moved = motion(p) - p;
        slipped_mm(i, j) = lag * norm(moved);
        p += (1 - lag) * moved;
      }
    }
  }
  double stick_ratio() const {
    double stick = 0, all = 0;
    for (std::size_t k = 0; k < contact.cells.size(); ++k) {
      all += contact.cells[k];
      stick += contact.cells[k] != 0 && slipped_mm.cells[k] == 0 ? 1 : 0;
    }
    return stick / all;
  }
};

/// Dots with the noise of a camera and its depth map.
inline Image<fingerpad::Point3<double>> noisy(Image<fingerpad::Point3<double>> dots,
                                              double lateral_mm,
                                              double depth_mm,
                                              Random& random) {
  for (auto& p : dots.cells) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    p = {p.x + lateral_mm * x, p.y + lateral_mm * y, p.z + depth_mm * z};
  }
  return dots;
}

/// Rotation about an axis through a point, in rad, followed by a shift.
inline fingerpad::Pose<double> moved_by(const fingerpad::Angles<double>& angles,
                                        const fingerpad::Point3<double>& about,
                                        const fingerpad::Point3<double>& shift) {
  const auto rotation = fingerpad::rotation_of(angles);
  return {rotation, about + shift - rotation(about)};
}

}  // namespace test
