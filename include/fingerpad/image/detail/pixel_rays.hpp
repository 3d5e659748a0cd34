// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The points that a camera's pixels see at given depths: point_at() of optics/camera.hpp without
// its square roots and divisions.
#include <cstddef>
#include <type_traits>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A pixel's ray is straight and lies in a plane with the optical axis: its point is (column -
/// center, row - center) in pixel widths, times mm_per_px = at_plate + per_mm depth.
template <scalar S>
struct MmPerPx {
  S at_plate;
  S per_mm;
};
template <scalar S>
MmPerPx<S> mm_per_px(const Camera<S>& camera, const S& row, const S& col) {
  const S t_sq = squared_norm(tangents_of_pixel(camera, row, col));
  const S in_air = camera.plate_distance_mm - camera.plate_thickness_mm;
  const S in_plate = camera.plate_thickness_mm * tangent_ratio(t_sq, camera.plate_index);
  const S per_px = tangent_per_px(camera);
  return {per_px * (in_air + in_plate), per_px * tangent_ratio(t_sq, camera.refractive_index)};
}
template <scalar S>
MmPerPx<S> mm_per_px(const OrthographicCamera<S>& camera, const S&, const S&) {
  return {camera.pitch_mm, S(0)};
}

template <class CameraType>
using camera_scalar_t = std::remove_cvref_t<decltype(CameraType::pitch_mm)>;

/// Two numbers per pixel are stored.
template <class CameraType>
class PixelRays {
 public:
  using S = camera_scalar_t<CameraType>;

  PixelRays(const CameraType& camera, Index rows, Index cols)
      : center_x_(camera.center_x_px),
        center_y_(camera.center_y_px),
        aspect_(camera.pixel_aspect),
        cols_(cols) {
    at_plate_.reserve(static_cast<std::size_t>(rows * cols));
    per_mm_.reserve(static_cast<std::size_t>(rows * cols));
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const MmPerPx<S> pixel =
            detail::mm_per_px(camera, S(static_cast<double>(i)), S(static_cast<double>(j)));
        at_plate_.push_back(pixel.at_plate);
        per_mm_.push_back(pixel.per_mm);
      }
    }
  }

  /// Distance of a column or row from the center, in pixel widths.
  S x_px(Index col) const { return S(static_cast<double>(col)) - center_x_; }
  S y_px(Index row) const { return (S(static_cast<double>(row)) - center_y_) * aspect_; }
  /// Height of a pixel in pixel widths.
  const S& aspect() const { return aspect_; }

  /// The factor of one pixel, or of as many adjacent pixels as V has lanes.
  template <class V>
  [[gnu::always_inline]] V mm_per_px(Index row, Index col, const V& depth_mm) const {
    const Index at = row * cols_ + col;
    return load_cells<V, S>(at_plate_.data() + at) +
           load_cells<V, S>(per_mm_.data() + at) * depth_mm;
  }

  Point3<S> operator()(Index row, Index col, const S& depth_mm) const {
    const S scale = mm_per_px(row, col, depth_mm);
    return {x_px(col) * scale, y_px(row) * scale, depth_mm};
  }

 private:
  S center_x_;
  S center_y_;
  S aspect_;
  Index cols_;
  aligned_vector<S> at_plate_;
  aligned_vector<S> per_mm_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
