// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Area and center of a contact from any mask, by the plainest loop: to compare with.
#include "fingerpad/core/grid.hpp"
#include "fingerpad/optics/camera.hpp"

namespace test {

struct ContactMeasures {
  double area_mm2 = 0;  ///< projected on the plate
  fingerpad::Point3<double> center_mm = {0, 0, 0};
  fingerpad::Index pixels = 0;
};

/// The area of a pixel is that between the points which its neighbours see; a neighbour without
/// depth is as deep as the pixel.
template <class CameraType, class Mask, class Depth>
ContactMeasures contact_measures(const CameraType& camera,
                                 const Mask& mask,
                                 const Depth& depth_mm) {
  using fingerpad::Index;
  ContactMeasures out;
  const auto point = [&](Index i, Index j, double otherwise) {
    const double l = static_cast<double>(depth_mm(i, j));
    return point_at(camera, static_cast<double>(i), static_cast<double>(j),
                    fingerpad::is_depth(l) ? l : otherwise);
  };
  const Index rows = depth_mm.rows(), cols = depth_mm.cols();
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double l = static_cast<double>(depth_mm(i, j));
      if (mask(i, j) == 0 || !fingerpad::is_depth(l)) {
        continue;
      }
      const Index left = j > 0 ? j - 1 : j, right = j + 1 < cols ? j + 1 : j;
      const Index up = i > 0 ? i - 1 : i, down = i + 1 < rows ? i + 1 : i;
      const auto across = point(i, right, l) - point(i, left, l);
      const auto along = point(down, j, l) - point(up, j, l);
      const double area = (across.x * along.y - across.y * along.x) /
                          static_cast<double>((right - left) * (down - up));
      out.area_mm2 += area;
      out.center_mm += area * point(i, j, l);
      ++out.pixels;
    }
  }
  out.center_mm = out.center_mm / out.area_mm2;
  return out;
}

}  // namespace test
