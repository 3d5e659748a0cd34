// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Area, center and depth of a region of the image, in mm: each pixel counts with the area that it
// sees, projected on the plate.
#include <algorithm>

#include "fingerpad/detail/contact/regions.hpp"
#include "fingerpad/detail/space/point_algebra.hpp"
#include "fingerpad/dots.hpp"
#include "fingerpad/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The area on the plate under a pixel in contact, by differences between its neighbours; one that
/// is unknown is taken to be as deep. Linear in the differences along each axis, so noise does not
/// add up.
template <class Depth, class Rays>
double pixel_area_mm2(
    const StridedView<Mark>& marks, const Depth& depth_mm, const Rays& rays, Index i, Index j) {
  const auto seen = [&](Index row, Index col) {
    const bool known = marks(row, col) != Mark::unknown;
    return rays(row, col, static_cast<double>(known ? depth_mm(row, col) : depth_mm(i, j)));
  };
  const Index left = (std::max)(j - 1, Index(0));
  const Index right = (std::min)(j + 1, marks.cols() - 1);
  const Index top = (std::max)(i - 1, Index(0));
  const Index bottom = (std::min)(i + 1, marks.rows() - 1);
  const Point3<double> across = difference(seen(i, right), seen(i, left));
  const Point3<double> down = difference(seen(bottom, j), seen(top, j));
  const double steps = static_cast<double>((right - left) * (bottom - top));
  return (across.x * down.y - across.y * down.x) / steps;
}

/// Sums over the pixels of a region, in double: there may be a million of them.
struct RegionMeasures {
  Index pixels = 0;
  double area_mm2 = 0;
  double x = 0, y = 0, z = 0;  ///< moments, mm^3

  template <class Depth, class Rays>
  RegionMeasures(const StridedView<Mark>& marks, const Depth& depth_mm, const Rays& rays) {
    for (Index i = 0; i < marks.rows(); ++i) {
      const Mark* row = marks.row(i);
      const Mark* end = row + marks.cols();
      for (const Mark* at = std::find(row, end, Mark::contact); at != end; ++at) {
        if (*at == Mark::contact) {
          add(marks, depth_mm, rays, i, at - row);
        }
      }
    }
  }

  /// NaN where there is no area.
  Point3<double> center_mm() const { return {x / area_mm2, y / area_mm2, z / area_mm2}; }

 private:
  template <class Depth, class Rays>
  void add(
      const StridedView<Mark>& marks, const Depth& depth_mm, const Rays& rays, Index i, Index j) {
    const Point3<double> at = rays(i, j, static_cast<double>(depth_mm(i, j)));
    const double area = pixel_area_mm2(marks, depth_mm, rays, i, j);
    ++pixels;
    area_mm2 += area;
    x += area * at.x;
    y += area * at.y;
    z += area * at.z;
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
