// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Area, center and depth of a region of the image, in mm: each pixel counts with the area that it
// sees, projected on the plate.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/detail/contact/regions.hpp"
#include "fingerpad/dots.hpp"
#include "fingerpad/grid.hpp"
#include "fingerpad/optics.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The ray of every pixel: what it sees moves along a straight line with depth, whatever the
/// camera.
class RayTable {
 public:
  template <class CameraType>
  RayTable(const CameraType& camera, Index rows, Index cols) : rows_(rows), cols_(cols) {
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const auto row = static_cast<double>(i);
        const auto col = static_cast<double>(j);
        const Point3<double> foot = point_at(camera, row, col, 0.0);
        const Point3<double> above = point_at(camera, row, col, 1.0);
        rays_.push_back(
            {{static_cast<float>(foot.x), static_cast<float>(foot.y)},
             {static_cast<float>(above.x - foot.x), static_cast<float>(above.y - foot.y)}});
      }
    }
  }

  Point2<float> at(Index i, Index j, float z) const {
    const Line& ray = rays_[static_cast<std::size_t>(i * cols_ + j)];
    return {ray.foot.x + z * ray.per_mm.x, ray.foot.y + z * ray.per_mm.y};
  }

  /// The area on the plate under a pixel in contact, by differences between its neighbours; one
  /// that is unknown is taken to be as deep. Linear in the differences along each axis, so noise
  /// does not add up.
  template <class Depth>
  double area_mm2(const StridedView<Mark>& marks, const Depth& depth_mm, Index i, Index j) const {
    const auto seen = [&](Index row, Index col) {
      const bool known = marks(row, col) != Mark::unknown;
      const float z = static_cast<float>(known ? depth_mm(row, col) : depth_mm(i, j));
      return at(row, col, z);
    };
    const Index left = (std::max)(j - 1, Index(0));
    const Index right = (std::min)(j + 1, cols_ - 1);
    const Index top = (std::max)(i - 1, Index(0));
    const Index bottom = (std::min)(i + 1, rows_ - 1);
    const Point2<float> a = seen(i, left);
    const Point2<float> b = seen(i, right);
    const Point2<float> c = seen(top, j);
    const Point2<float> d = seen(bottom, j);
    const float area = (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
    return static_cast<double>(area) / static_cast<double>((right - left) * (bottom - top));
  }

 private:
  struct Line {
    Point2<float> foot;    ///< on the plate
    Point2<float> per_mm;  ///< of depth
  };
  Index rows_;
  Index cols_;
  std::vector<Line> rays_;
};

/// Sums over the pixels of a region, in double: there may be a million of them.
struct RegionMeasures {
  Index pixels = 0;
  double area_mm2 = 0;
  double x = 0, y = 0, z = 0;  ///< moments, mm^3

  template <class Depth>
  RegionMeasures(const StridedView<Mark>& marks, const Depth& depth_mm, const RayTable& rays) {
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
  template <class Depth>
  void add(const StridedView<Mark>& marks,
           const Depth& depth_mm,
           const RayTable& rays,
           Index i,
           Index j) {
    const float depth = static_cast<float>(depth_mm(i, j));
    const Point2<float> at = rays.at(i, j, depth);
    const double area = rays.area_mm2(marks, depth_mm, i, j);
    ++pixels;
    area_mm2 += area;
    x += area * static_cast<double>(at.x);
    y += area * static_cast<double>(at.y);
    z += area * static_cast<double>(depth);
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
