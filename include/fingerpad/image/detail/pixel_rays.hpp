// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The points that a camera's pixels see at given depths. All that does not depend on the depth is
// precomputed: point_at() of optics/camera.hpp without its square roots and divisions.
#include <cmath>
#include <cstddef>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <class CameraType>
class PixelRays;

/// The point at a distance of (x, y) pixel widths from the center of the image.
template <scalar S>
Point3<S> point_beside(const S& x_px, const S& y_px, const S& mm_per_px, const S& depth_mm) {
  return {S(x_px * mm_per_px), S(y_px * mm_per_px), depth_mm};
}

/// A pixel's ray is straight and lies in a plane with the optical axis. Its point is (column -
/// center, row - center) times a factor that is linear in the depth, so that two numbers per pixel
/// are stored.
template <scalar S>
class PixelRays<Camera<S>> {
 public:
  using Scalar = S;

  PixelRays(const Camera<S>& camera, Index rows, Index cols)
      : center_x_(camera.center_x_px),
        center_y_(camera.center_y_px),
        aspect_(camera.pixel_aspect),
        cols_(cols) {
    at_plate_.reserve(static_cast<std::size_t>(rows * cols));
    per_mm_.reserve(static_cast<std::size_t>(rows * cols));
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const MmPerPx mm_per_px = ray(camera, i, j);
        at_plate_.push_back(mm_per_px.at_plate);
        per_mm_.push_back(mm_per_px.per_mm);
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
    return point_beside(x_px(col), y_px(row), mm_per_px(row, col, depth_mm), depth_mm);
  }

 private:
  struct MmPerPx {
    S at_plate;
    S per_mm;
  };

  static MmPerPx ray(const Camera<S>& camera, Index row, Index col) {
    using std::sqrt;
    const S x = S(static_cast<double>(col)) - camera.center_x_px;
    const S y = (S(static_cast<double>(row)) - camera.center_y_px) * camera.pixel_aspect;
    const S r_sq = x * x + y * y;
    // on the axis, approximate the limit by a pixel close to it
    const S r = value(r_sq) == 0 ? S(1) / S(1048576) : S(sqrt(r_sq));
    // a second depth, far enough that the difference of the two points keeps its digits
    const S far = S(64);
    const S near_x = point_at(camera, camera.center_y_px, S(camera.center_x_px + r), S(0)).x;
    const S far_x = point_at(camera, camera.center_y_px, S(camera.center_x_px + r), far).x;
    return {S(near_x / r), S((far_x - near_x) / (far * r))};
  }

  S center_x_;
  S center_y_;
  S aspect_;
  Index cols_;
  aligned_vector<S> at_plate_;
  aligned_vector<S> per_mm_;
};

/// All pixels have the same factor, so that nothing is stored per pixel.
template <scalar S>
class PixelRays<OrthographicCamera<S>> {
 public:
  using Scalar = S;

  PixelRays(const OrthographicCamera<S>& camera, Index, Index) : camera_(camera) {}

  S x_px(Index col) const { return S(static_cast<double>(col)) - camera_.center_x_px; }
  S y_px(Index row) const {
    return (S(static_cast<double>(row)) - camera_.center_y_px) * camera_.pixel_aspect;
  }
  const S& aspect() const { return camera_.pixel_aspect; }

  template <class V>
  [[gnu::always_inline]] V mm_per_px(Index, Index, const V&) const {
    return every_lane<V>(camera_.pitch_mm);
  }

  Point3<S> operator()(Index row, Index col, const S& depth_mm) const {
    return point_beside(x_px(col), y_px(row), camera_.pitch_mm, depth_mm);
  }

 private:
  OrthographicCamera<S> camera_;
};

template <class CameraType>
using camera_scalar_t = typename PixelRays<CameraType>::Scalar;

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
