// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shape and irregularity of the object. Within the contact the membrane lies on the object, so the
// depth map there is the object's own surface. Source: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor for dexterous handling of robot hands" (slides), which name shape and
// irregularity but give no equations. Here a quadric is fitted. Its frame has the origin in the
// middle of the contact, w along the normal of the plane through its depths, and u and v in it:
//
//   w = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2 + g w^2
//
// Without g (a paraboloid) the curvature of a cap of radius A on a sphere of radius R is too large
// by a share of about A^2 / (4 R^2). Therefore g is set from the curvatures k1, k2 that c3, c4, c5
// give: g = (k1^3 + k2^3) / (k1^2 + k2^2) / 2 makes spheres and cylinders exact, and is 0 for a
// saddle that bends both ways alike. It also keeps |grad| close to 1, so that least squares
// minimise the distance.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// The object's surface at the middle of the contact. All numbers are NaN unless ok(): if grids
/// differ in size (0 pixels), with no more than 6 pixels, and where the pixels determine no
/// quadric: all in one line or in two level lines, or on a surface that no camera could see.
/// Curvatures are positive where the object is convex: where it dents the pad. Standard deviations
/// are those of pixels with independent errors as large as the rms. A depth map averaged over w x w
/// pixels has errors that are alike within w px: its true standard deviations are about w times
/// larger.
struct [[nodiscard]] SurfaceResult {
  Index pixels = 0;                                    ///< in contact with a depth
  double curvature_1_per_mm = not_a_number<double>();  ///< principal curvature, larger in magnitude
  double curvature_2_per_mm = not_a_number<double>();  ///< the other one; 0 for a cylinder
  double curvature_1_sd_per_mm = not_a_number<double>();
  double curvature_2_sd_per_mm = not_a_number<double>();
  Point3<double> direction_1 = detail::missing_point<double>();  ///< unit vector; no meaning where
                                                                 ///< both curvatures are alike
  Point3<double> direction_2 = detail::missing_point<double>();  ///< a cylinder's axis
  Point3<double> point_mm = detail::missing_point<double>();  ///< on the surface, near the centroid
  Point3<double> normal = detail::missing_point<double>();    ///< there; unit vector to the object
  double rms_mm = not_a_number<double>();  ///< of the distances from the surface: irregularity

  bool ok() const { return is_finite(rms_mm); }
};

namespace detail {

/// Two unit vectors that are normal to the unit vector `n`, toward +z, and to each other.
inline std::array<Point3<double>, 2> tangents(const Point3<double>& n) {
  const Point3<double> along_x = normalized(Point3<double>{n.z, 0, -n.x});
  return {along_x, cross(n, along_x)};
}

/// The quadric of a patch in its own frame, by least squares: its coefficients c and g.
struct QuadricFit {
  NormalEquations<double, 6> equations;
  std::array<double, 6> c = {};
  double g = 0;
  double sum_sq = 0;  // of the distances

  /// From the sums over the points of 1, u, v, u^2, u v, v^2, w and w^2.
  explicit QuadricFit(const ProductSums<double, 8>& sums) : equations(sums.corner<6>()) {
    const auto of_w = sums.column<6>(6), of_w_sq = sums.column<6>(7);
    const auto a = equations.solve(of_w), b = equations.solve(of_w_sq);
    c = a;
    for (int round = 0; round < 60; ++round) {  // each shrinks the error of g by the squared angle
      const double sum = 2 * (c[3] + c[5]), product = 4 * c[3] * c[5] - c[4] * c[4];
      const double squares = sum * sum - 2 * product;  // k1^2 + k2^2
      g = squares > 0 ? sum * (squares - product) / squares / 2 : 0;
      for (std::size_t k = 0; k < c.size(); ++k) {
        c[k] = a[k] - g * b[k];
      }
    }
    sum_sq = sums(6, 6) - 2 * g * sums(7, 6) + g * g * sums(7, 7);
    for (std::size_t k = 0; k < c.size(); ++k) {
      sum_sq -= c[k] * (of_w[k] - g * of_w_sq[k]);
    }
    sum_sq = (std::max)(sum_sq, 0.0);
  }
};

}  // namespace detail

/// Fits the object's surface where `contact` is true: `camera` is a Camera or OrthographicCamera,
/// `depth_mm` a map of depths along its rays, NaN where unknown. Computes in double, whatever the
/// grids hold; takes no memory and throws nothing. O(rows cols): two passes over the pixels.
template <template <class> class CameraType, scalar S, grid Depth, contact_mask Mask>
SurfaceResult fit_surface(const CameraType<S>& camera, const Depth& depth_mm, const Mask& contact) {
  SurfaceResult result;
  const auto depth = as_view(depth_mm);
  const auto mask = as_view(contact);
  if (!same_size(depth, mask)) {
    return result;
  }
  using Point = Point3<double>;
  const auto for_each_depth = [&](Index top, Index bottom, const auto& visit) {
    for (Index i = top; i < bottom; ++i) {
      for (Index j = 0; j < depth.cols(); ++j) {
        if (is_contact(cell_t<Mask>(mask(i, j))) && is_depth(depth(i, j))) {
          visit(static_cast<double>(i), static_cast<double>(j),
                static_cast<double>(value(depth(i, j))));
        }
      }
    }
  };
  // the frame: about the middle of the contact, on the plane through the depths; digits are kept
  // relative to the first pixel
  std::array<double, 3> first = {}, last = {};
  detail::ProductSums<double, 4> pixels;  // of 1, row, column, depth
  for_each_depth(0, depth.rows(), [&](double row, double col, double z) {
    last = {row, col, z};
    first = result.pixels++ == 0 ? last : first;
    pixels.add({1, row - first[0], col - first[1], z - first[2]});
  });
  const detail::NormalEquations<double, 3> plane(pixels.corner<3>());
  if (result.pixels <= 6 || !plane.good) {
    return result;
  }
  const double count = static_cast<double>(result.pixels);
  const auto seen = [eye = cast<double>(camera)](double row, double col, double z) {
    return point_at(eye, row, col, z);
  };
  const double row = first[0] + pixels(0, 1) / count, col = first[1] + pixels(0, 2) / count;
  const double z = first[2] + pixels(0, 3) / count;
  const auto slope = plane.solve(pixels.column<3>(3));
  const Point center = seen(row, col, z);
  const Point w =
      normalized(cross(seen(row, col + 1, z + slope[2]) - seen(row, col - 1, z - slope[2]),
                       seen(row + 1, col, z + slope[1]) - seen(row - 1, col, z - slope[1])));
  const auto [u, v] = detail::tangents(w);
  const auto outside = [&, u = u, v = v](const Point& d) { return d.x * u + d.y * v + d.z * w; };

  detail::ProductSums<double, 8> sums;
  const Index top = static_cast<Index>(first[0]), bottom = static_cast<Index>(last[0]) + 1;
  for_each_depth(top, bottom, [&, u = u, v = v](double i, double j, double l) {
    const Point q = seen(i, j, l) - center;
    const double x = dot(u, q), y = dot(v, q), h = dot(w, q);
    sums.add({1, x, y, x * x, x * y, y * y, h, h * h});
  });
  const detail::QuadricFit fit(sums);

  // at the height above the centroid, the curvature of F = w - c - g w^2 = 0 along a unit tangent t
  // is t^T (Hessian of -F) t / |grad F|
  const double height = 2 * fit.c[0] / (1 + std::sqrt((std::max)(1 - 4 * fit.g * fit.c[0], 0.0)));
  const Point gradient = {-fit.c[1], -fit.c[2], 1 - 2 * fit.g * height};
  const Point n = normalized(gradient);
  const auto [s, t] = detail::tangents(n);
  const auto bend = [&](const Point& a, const Point& b) {
    return (2 * fit.c[3] * a.x * b.x + fit.c[4] * (a.x * b.y + a.y * b.x) +
            2 * fit.c[5] * a.y * b.y + 2 * fit.g * a.z * b.z) /
           norm(gradient);
  };
  const double mean = (bend(s, s) + bend(t, t)) / 2, half = (bend(s, s) - bend(t, t)) / 2;
  const double radius = std::hypot(half, bend(s, t)), angle = std::atan2(bend(s, t), half) / 2;
  std::array<double, 2> k = {mean + radius, mean - radius};
  std::array<Point, 2> along = {std::cos(angle) * s + std::sin(angle) * t,
                                std::cos(angle) * t - std::sin(angle) * s};
  if (std::abs(k[0]) < std::abs(k[1])) {
    std::swap(k[0], k[1]);
    std::swap(along[0], along[1]);
  }
  const Point normal = outside(n), point = center + height * w;
  if (!fit.equations.good || !(normal.z > 0) || !is_finite(point) || !is_finite(k[0]) ||
      !is_finite(k[1])) {
    return result;
  }
  const auto sd = [&](const Point& d) {
    const double by_c =
        fit.equations.variance({0, 0, 0, 2 * d.x * d.x, 2 * d.x * d.y, 2 * d.y * d.y});
    return std::sqrt((std::max)(fit.sum_sq / (count - 6) * by_c, 0.0));
  };
  return {.pixels = result.pixels,
          .curvature_1_per_mm = k[0],
          .curvature_2_per_mm = k[1],
          .curvature_1_sd_per_mm = sd(along[0]),
          .curvature_2_sd_per_mm = sd(along[1]),
          .direction_1 = outside(along[0]),
          .direction_2 = outside(along[1]),
          .point_mm = point,
          .normal = normal,
          .rms_mm = std::sqrt(fit.sum_sq / count)};
}

}  // namespace v1
}  // namespace fingerpad
