// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The object's surface as points in mm: as a view that computes them when they are asked for, or
// written to a grid of points or to three grids of coordinates.
#include <concepts>
#include <utility>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/optics/camera.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

template <class To, class S>
void set_coordinates(To& to, const Point3<S>& p) {
  if constexpr (requires { to.x = p.x; }) {
    to.x = static_cast<std::remove_cvref_t<decltype(to.x)>>(p.x);
    to.y = static_cast<std::remove_cvref_t<decltype(to.y)>>(p.y);
    to.z = static_cast<std::remove_cvref_t<decltype(to.z)>>(p.z);
  } else {
    to[0] = static_cast<std::remove_cvref_t<decltype(to[0])>>(p.x);
    to[1] = static_cast<std::remove_cvref_t<decltype(to[1])>>(p.y);
    to[2] = static_cast<std::remove_cvref_t<decltype(to[2])>>(p.z);
  }
}

}  // namespace detail

/// The point that each pixel in contact sees, as a grid of Point3 computed on demand; NaN where
/// there is no contact or no depth. Depth and mask must outlive it. Without rows and columns where
/// their sizes differ.
template <template <class> class CameraType, scalar S, grid Depth, grid Mask>
auto surface_points(const CameraType<S>& camera, const Depth& depth_mm, const Mask& contact) {
  const auto depth = as_view(depth_mm);
  const auto mask = as_view(contact);
  const auto point = [camera, depth, mask](Index i, Index j) {
    const S l = static_cast<bool>(mask(i, j)) ? S(depth(i, j)) : not_a_number<S>();
    if (!is_finite(l)) {
      return Point3<S>{not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
    }
    return point_at(camera, S(static_cast<double>(i)), S(static_cast<double>(j)), l);
  };
  const bool fits = same_size(depth, mask);
  return LazyView(fits ? depth.rows() : Index(0), fits ? depth.cols() : Index(0), point);
}

/// Writes them to a grid whose cells are points with x, y, z or [0], [1], [2] (Point3, cv::Vec3f,
/// Eigen::Vector3f, pcl::PointXYZ); false, and nothing written, where the sizes differ.
template <template <class> class CameraType, scalar S, grid Depth, grid Mask, grid Points>
bool write_surface_points(const CameraType<S>& camera,
                          const Depth& depth_mm,
                          const Mask& contact,
                          Points&& points) {
  const auto from = surface_points(camera, depth_mm, contact);
  const auto to = as_view(std::forward<Points>(points));
  if (!same_size(depth_mm, contact) || !same_size(from, to)) {
    return false;
  }
  for (Index i = 0; i < to.rows(); ++i) {
    for (Index j = 0; j < to.cols(); ++j) {
      detail::set_coordinates(to(i, j), from(i, j));
    }
  }
  return true;
}

/// Writes them to three grids, one for each coordinate.
template <template <class> class CameraType,
          scalar S,
          grid Depth,
          grid Mask,
          writable_grid<S> X,
          writable_grid<S> Y,
          writable_grid<S> Z>
bool write_surface_points(const CameraType<S>& camera,
                          const Depth& depth_mm,
                          const Mask& contact,
                          X&& x_mm,
                          Y&& y_mm,
                          Z&& z_mm) {
  const auto from = surface_points(camera, depth_mm, contact);
  const auto x = as_view(std::forward<X>(x_mm));
  const auto y = as_view(std::forward<Y>(y_mm));
  const auto z = as_view(std::forward<Z>(z_mm));
  if (!same_size(depth_mm, contact) || !same_size(from, x) || !same_size(from, y) ||
      !same_size(from, z)) {
    return false;
  }
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j) {
      const Point3<S> p = from(i, j);
      x(i, j) = static_cast<cell_t<X>>(p.x);
      y(i, j) = static_cast<cell_t<Y>>(p.y);
      z(i, j) = static_cast<cell_t<Z>>(p.z);
    }
  }
  return true;
}

}  // namespace v0
}  // namespace fingerpad
