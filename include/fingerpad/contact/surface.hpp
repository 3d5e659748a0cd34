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
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

enum class SurfaceStatus : unsigned char {
  ok,
  too_few,     ///< no more than six pixels in contact have a depth
  degenerate,  ///< the pixels do not determine a quadric: all in one line or in two level lines, or
               ///< on a surface that no camera could see
  refused,     ///< the grids differ in size
};

/// "ok", "too few", "degenerate" or "refused".
constexpr const char* name_of(SurfaceStatus status) {
  constexpr std::array<const char*, 4> names = {"ok", "too few", "degenerate", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// The object's surface at the middle of the contact; all numbers are NaN unless ok(). Curvatures
/// are positive where the object is convex: where it dents the pad. Standard deviations are those
/// of pixels with independent errors as large as the rms. A depth map averaged over w x w pixels
/// has errors that are alike within w px: its true standard deviations are about w times larger.
struct [[nodiscard]] SurfaceResult {
  SurfaceStatus status = SurfaceStatus::refused;
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

  bool ok() const { return status == SurfaceStatus::ok; }
};

namespace detail {

/// The place of a patch: its centroid and the axes u, v, w of its best plane, w toward the object.
struct PatchFrame {
  Index pixels = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  bool is_line = true;  ///< of pixels: thinner than a thousandth of its length

  /// `for_each_point` visits the points of a patch and the pixels that see them.
  template <class Points>
  explicit PatchFrame(const Points& for_each_point) {
    using Vector5 = Eigen::Matrix<double, 5, 1>;
    Vector5 first = Vector5::Zero(), mean = Vector5::Zero();  // x, y, z, row, col
    Eigen::Matrix<double, 5, 5> second = Eigen::Matrix<double, 5, 5>::Zero();
    for_each_point([&](const Eigen::Vector3d& p, double row, double col) {
      Vector5 all;
      all << p, row, col;
      first = pixels++ == 0 ? all : first;  // digits are kept relative to it
      all -= first;
      mean += all;
      second += all * all.transpose();
    });
    const double n = static_cast<double>(pixels);
    mean /= n;
    second = second / n - mean * mean.transpose();
    const Eigen::Matrix2d of_pixels = second.bottomRightCorner<2, 2>();
    is_line = !(of_pixels.determinant() > 1e-6 * of_pixels.trace() * of_pixels.trace());
    center = (first + mean).head<3>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(second.topLeftCorner<3, 3>());
    const Eigen::Vector3d w = spread.eigenvectors().col(0), u = w.unitOrthogonal();
    axes << u, w.cross(u), w;
    if (w.z() < 0) {
      axes.rightCols<2>() *= -1;
    }
  }
};

/// The quadric of a patch in its own frame, by least squares: its coefficients c and g.
struct QuadricFit {
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  template <class Points>
  QuadricFit(const Points& for_each_point, const PatchFrame& frame) {
    Eigen::Matrix<double, 8, 8> sums = Eigen::Matrix<double, 8, 8>::Zero();
    for_each_point([&](const Eigen::Vector3d& p, double, double) {
      const Eigen::Vector3d q = frame.axes.transpose() * (p - frame.center);
      const double u = q.x(), v = q.y(), w = q.z();
      Eigen::Matrix<double, 8, 1> terms;
      terms << 1, u, v, u * u, u * v, v * v, w, w * w;
      sums.selfadjointView<Eigen::Lower>().rankUpdate(terms);
    });
    sums = sums.selfadjointView<Eigen::Lower>();
    scale = sums.diagonal().head<6>().cwiseSqrt().cwiseInverse();
    solver.compute(scale.asDiagonal() * sums.topLeftCorner<6, 6>() * scale.asDiagonal());
    const Vector6 of_w = sums.col(6).head<6>(), of_w_sq = sums.col(7).head<6>();
    const Vector6 a = solve(of_w), b = solve(of_w_sq);
    c = a;
    for (int round = 0; round < 60; ++round) {  // each shrinks the error of g by the squared angle
      const double sum = 2 * (c[3] + c[5]), product = 4 * c[3] * c[5] - c[4] * c[4];
      const double squares = sum * sum - 2 * product;  // k1^2 + k2^2
      g = squares > 0 ? sum * (squares - product) / squares / 2 : 0;
      c = a - g * b;
    }
    sum_sq = sums(6, 6) - 2 * g * sums(7, 6) + g * g * sums(7, 7) - c.dot(of_w - g * of_w_sq);
    sum_sq = sum_sq < 0 ? 0 : sum_sq;
  }

  Vector6 solve(const Vector6& b) const {
    return scale.cwiseProduct(solver.solve(scale.cwiseProduct(b)));
  }
  bool is_determined() const { return solver.vectorD().minCoeff() > 1e-9; }

  Vector6 scale;  // so that units do not matter
  Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver;
  Vector6 c;
  double g = 0;
  double sum_sq = 0;  // of the distances
};

}  // namespace detail

/// Fits the object's surface where `contact` is true: `camera` is a Camera or OrthographicCamera,
/// `depth_mm` a map of depths along its rays, NaN where unknown. Computes in double, whatever the
/// grids hold; takes no memory and throws nothing. O(rows cols): two passes over the pixels.
template <template <class> class CameraType, scalar S, grid Depth, contact_mask Mask>
SurfaceResult fit_surface(const CameraType<S>& camera, const Depth& depth_mm, const Mask& contact) {
  using Eigen::Matrix2d, Eigen::Vector3d;
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
            visit(Vector3d(p.x, p.y, p.z), row, col);
          }
        }
      }
    }
  };
  const detail::PatchFrame frame(for_each_point);
  result.pixels = frame.pixels;
  result.status = frame.pixels > 6 ? SurfaceStatus::degenerate : SurfaceStatus::too_few;
  if (frame.pixels <= 6 || frame.is_line) {
    return result;
  }
  const detail::QuadricFit fit(for_each_point, frame);

  // at the height above the centroid, the curvature of F = w - c - g w^2 = 0 along a unit tangent t
  // is t^T (Hessian of -F) t / |grad F|
  const double height = 2 * fit.c[0] / (1 + std::sqrt((std::max)(1 - 4 * fit.g * fit.c[0], 0.0)));
  const Vector3d gradient(-fit.c[1], -fit.c[2], 1 - 2 * fit.g * height);
  const Vector3d n = gradient.normalized(), tangent = n.unitOrthogonal();
  Eigen::Matrix3d hessian;
  hessian << 2 * fit.c[3], fit.c[4], 0, fit.c[4], 2 * fit.c[5], 0, 0, 0, 2 * fit.g;
  Eigen::Matrix<double, 3, 2> along;
  along << tangent, n.cross(tangent);
  Eigen::SelfAdjointEigenSolver<Matrix2d> bend;
  bend.computeDirect(Matrix2d(along.transpose() * hessian * along / gradient.norm()));
  Eigen::Vector2d k = bend.eigenvalues();
  along *= bend.eigenvectors();
  if (std::abs(k[0]) < std::abs(k[1])) {
    k.reverseInPlace();
    along.col(0).swap(along.col(1));
  }
  const Vector3d normal = frame.axes * n, point = frame.center + height * frame.axes.col(2);
  if (!fit.is_determined() || !(normal.z() > 0) || !point.allFinite() || !k.allFinite()) {
    return result;
  }
  const double pixels = static_cast<double>(frame.pixels), variance = fit.sum_sq / (pixels - 6);
  const auto sd = [&](const Vector3d& t) {
    detail::QuadricFit::Vector6 h;
    h << 0, 0, 0, 2 * t.x() * t.x(), 2 * t.x() * t.y(), 2 * t.y() * t.y();
    return std::sqrt((std::max)(variance * h.dot(fit.solve(h)), 0.0));
  };
  const auto as_point = [](const Vector3d& p) { return Point3<double>{p.x(), p.y(), p.z()}; };
  return {.status = SurfaceStatus::ok,
          .pixels = frame.pixels,
          .curvature_1_per_mm = k[0],
          .curvature_2_per_mm = k[1],
          .curvature_1_sd_per_mm = sd(along.col(0)),
          .curvature_2_sd_per_mm = sd(along.col(1)),
          .direction_1 = as_point(frame.axes * along.col(0)),
          .direction_2 = as_point(frame.axes * along.col(1)),
          .point_mm = as_point(point),
          .normal = as_point(normal),
          .rms_mm = std::sqrt(fit.sum_sq / pixels)};
}

}  // namespace v0
}  // namespace fingerpad
