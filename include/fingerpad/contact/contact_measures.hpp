// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Area and center of a contact from its mask and the depths, in any scalar. ContactRegion already
// measures every frame in double; use this for your own masks, and for derivatives with respect to
// camera and depth.
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// Area and center of a contact. If no pixel counts, the area is 0 and the center NaN.
template <scalar S>
struct [[nodiscard]] ContactMeasures {
  S area_mm2 = S(0);  ///< projected on the plate
  Point3<S> center_mm = {not_a_number<S>(), not_a_number<S>(),
                         not_a_number<S>()};  ///< centroid of that area
  Index pixels = 0;                           ///< pixels in contact that have a depth
};

/// Measures a contact: its area is the sum of the areas that its pixels cover at their depths,
/// projected on the plate. The area of a pixel follows from the differences of its neighbours'
/// points; a neighbour without depth is taken to be as deep as the pixel. It is linear in the
/// differences along each axis, so that noise does not accumulate. Grids of different sizes, and
/// images of a single row or column, give no pixels and no area. O(rows cols); allocates nothing.
template <template <class> class CameraType, scalar S, contact_mask Mask, grid Depth>
ContactMeasures<S> contact_measures(const CameraType<S>& camera,
                                    const Mask& contact,
                                    const Depth& depth_mm) {
  ContactMeasures<S> out;
  const auto mask = as_view(contact);
  const auto depth = as_view(depth_mm);
  const Index rows = depth.rows(), cols = depth.cols();
  if (!same_size(mask, depth) || rows < 2 || cols < 2) {
    return out;
  }
  const auto point = [&](Index i, Index j, const S& otherwise) {
    const S l = S(depth(i, j));
    return point_at(camera, S(static_cast<double>(i)), S(static_cast<double>(j)),
                    is_depth(l) ? l : otherwise);
  };
  Point3<S> moment = {S(0), S(0), S(0)};
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const S l = S(depth(i, j));
      if (!is_contact(cell_t<Mask>(mask(i, j))) || !is_depth(l)) {
        continue;
      }
      const Index left = j > 0 ? j - 1 : j, right = j + 1 < cols ? j + 1 : j;
      const Index up = i > 0 ? i - 1 : i, down = i + 1 < rows ? i + 1 : i;
      const Point3<S> across = point(i, right, l) - point(i, left, l);
      const Point3<S> along = point(down, j, l) - point(up, j, l);
      const S span = S(static_cast<double>((right - left) * (down - up)));
      const S area = (across.x * along.y - across.y * along.x) / span;
      out.area_mm2 = out.area_mm2 + area;
      moment += area * point(i, j, l);
      ++out.pixels;
    }
  }
  if (value(out.area_mm2) > 0) {
    out.center_mm = moment / out.area_mm2;
  }
  return out;
}

}  // namespace v0
}  // namespace fingerpad
