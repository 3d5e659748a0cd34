// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shape and irregularity of the object. Within the contact the membrane lies on the object, so the
// depth map there is the object's own surface. Source: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor for dexterous handling of robot hands" (slides), which name shape and
// irregularity but give no equations. Here a quadric is fitted. Its frame has the origin at the
// centroid of the contact, w along the normal of the best plane, and u and v in that plane:
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
inline namespace v0 {

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

/// The place of a patch: its centroid and the axes u, v, w of its best plane, w toward the object.
struct PatchFrame {
  Index pixels = 0;
  Point3<double> center = {0, 0, 0};
  std::array<Point3<double>, 3> axes = {};
  bool is_line = true;  ///< of pixels: thinner than a thousandth of its length

  /// `for_each_point` visits the points of a patch and the pixels that see them.
  template <class Points>
  explicit PatchFrame(const Points& for_each_point) {
    std::array<double, 6> first = {};
    ProductSums<double, 6> sums;  // of 1, x, y, z, row, col; the others relative to the first point
    for_each_point([&](const Point3<double>& p, double row, double col) {
      const std::array<double, 6> all = {0, p.x, p.y, p.z, row, col};
      first = pixels++ == 0 ? all : first;  // digits are kept relative to it
      sums.add({1, p.x - first[1], p.y - first[2], p.z - first[3], row - first[4], col - first[5]});
    });
    const double n = static_cast<double>(pixels);
    const auto mean = [&](std::size_t a) { return sums(0, a) / n; };
    const auto second = [&](std::size_t a, std::size_t b) {
      return sums(a, b) / n - mean(a) * mean(b);
    };
    const double determinant = second(4, 4) * second(5, 5) - square(second(4, 5));
    is_line = !(determinant > 1e-6 * square(second(4, 4) + second(5, 5)));
    center = {first[1] + mean(1), first[2] + mean(2), first[3] + mean(3)};
    SmallMatrix<double, 3> spread;
    for (std::size_t a = 0; a < 3; ++a) {
      spread[a] = {second(a + 1, 1), second(a + 1, 2), second(a + 1, 3)};
    }
    const auto [u, v, w] = eigenvectors(spread).vector;
    const Point3<double> up = w.z < 0 ? -w : w;
    axes = {u, cross(up, u), up};
  }

  Point3<double> inside(const Point3<double>& p) const {
    const Point3<double> q = p - center;
    return {dot(axes[0], q), dot(axes[1], q), dot(axes[2], q)};
  }
  Point3<double> outside(const Point3<double>& direction) const {
    return direction.x * axes[0] + direction.y * axes[1] + direction.z * axes[2];
  }
};

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
  const auto for_each_point = [&, eye = cast<double>(camera)](const auto& visit) {
    for (Index i = 0; i < depth.rows(); ++i) {
      for (Index j = 0; j < depth.cols(); ++j) {
        if (is_contact(cell_t<Mask>(mask(i, j)))) {
          const double row = static_cast<double>(i), col = static_cast<double>(j);
          const auto p = point_at(eye, row, col, static_cast<double>(value(depth(i, j))));
          if (is_depth(p.z)) {
            visit(p, row, col);
          }
        }
      }
    }
  };
  const detail::PatchFrame frame(for_each_point);
  result.pixels = frame.pixels;
  if (frame.pixels <= 6 || frame.is_line) {
    return result;
  }
  detail::ProductSums<double, 8> sums;
  for_each_point([&](const Point3<double>& p, double, double) {
    const auto [u, v, w] = frame.inside(p);
    sums.add({1, u, v, u * u, u * v, v * v, w, w * w});
  });
  const detail::QuadricFit fit(sums);

  // at the height above the centroid, the curvature of F = w - c - g w^2 = 0 along a unit tangent t
  // is t^T (Hessian of -F) t / |grad F|
  const double height = 2 * fit.c[0] / (1 + std::sqrt((std::max)(1 - 4 * fit.g * fit.c[0], 0.0)));
  const Point3<double> gradient = {-fit.c[1], -fit.c[2], 1 - 2 * fit.g * height};
  const Point3<double> n = normalized(gradient);
  const Point3<double> s = normalized(Point3<double>{n.z, 0, -n.x}), t = cross(n, s);
  const auto bend = [&](const Point3<double>& a, const Point3<double>& b) {
    return (2 * fit.c[3] * a.x * b.x + fit.c[4] * (a.x * b.y + a.y * b.x) +
            2 * fit.c[5] * a.y * b.y + 2 * fit.g * a.z * b.z) /
           norm(gradient);
  };
  const double mean = (bend(s, s) + bend(t, t)) / 2, half = (bend(s, s) - bend(t, t)) / 2;
  const double radius = std::hypot(half, bend(s, t)), angle = std::atan2(bend(s, t), half) / 2;
  std::array<double, 2> k = {mean + radius, mean - radius};
  std::array<Point3<double>, 2> along = {std::cos(angle) * s + std::sin(angle) * t,
                                         std::cos(angle) * t - std::sin(angle) * s};
  if (std::abs(k[0]) < std::abs(k[1])) {
    std::swap(k[0], k[1]);
    std::swap(along[0], along[1]);
  }
  const Point3<double> normal = frame.outside(n), point = frame.center + height * frame.axes[2];
  if (!fit.equations.good || !(normal.z > 0) || !is_finite(point) || !is_finite(k[0]) ||
      !is_finite(k[1])) {
    return result;
  }
  const double pixels = static_cast<double>(frame.pixels), variance = fit.sum_sq / (pixels - 6);
  const auto sd = [&](const Point3<double>& d) {
    const double by_c =
        fit.equations.variance({0, 0, 0, 2 * d.x * d.x, 2 * d.x * d.y, 2 * d.y * d.y});
    return std::sqrt((std::max)(variance * by_c, 0.0));
  };
  return {.pixels = frame.pixels,
          .curvature_1_per_mm = k[0],
          .curvature_2_per_mm = k[1],
          .curvature_1_sd_per_mm = sd(along[0]),
          .curvature_2_sd_per_mm = sd(along[1]),
          .direction_1 = frame.outside(along[0]),
          .direction_2 = frame.outside(along[1]),
          .point_mm = point,
          .normal = normal,
          .rms_mm = std::sqrt(fit.sum_sq / pixels)};
}

}  // namespace v0
}  // namespace fingerpad
