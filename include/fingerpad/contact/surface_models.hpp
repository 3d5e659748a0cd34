// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The plane and the sphere that fit a patch best. The sphere is described by numbers that remain
// finite when it becomes flat: its point nearest to the patch's centroid, the normal n there, and
// its curvature k. The signed distance from it is
//
//   d = (1 - s) / k,  s = sqrt(1 - 2 k Q),  Q = n.q - k |q|^2 / 2
//
// with q measured from that point of the sphere. At k = 0 it is n.q, as for a plane. The fit starts
// with least squares of Q up to a factor, which are linear (Q differs from d by a share of k d / 2,
// as in Pratt's algebraic fit). One Gauss-Newton step on d follows.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/contact/detail/patch.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

// The plane that fits a patch best: orthogonal regression, from the moments alone.

/// A plane in mm. Standard errors hold for pixels with independent errors (see SurfaceFit).
template <scalar S = double>
struct Plane {
  Point3<S> normal = detail::missing_point<S>();  ///< unit vector toward the object
  S distance_mm = not_a_number<S>();              ///< from the origin along the normal: normal . p
  Point3<S> center_mm = detail::missing_point<S>();  ///< centroid of the patch, on the plane
  S distance_sd_mm = not_a_number<S>();              ///< standard error along the normal, at the
                                                     ///< center
  S tilt_sd_rad = not_a_number<S>();  ///< of the normal, in its least certain direction

  /// Signed distance of p from the plane, mm; positive away from the object.
  S stands_out(const Point3<S>& p) const { return S(-dot(normal, p - center_mm)); }
};
template <scalar To, scalar From>
Plane<To> cast(const Plane<From>& p) {
  return {cast<To>(p.normal), To(p.distance_mm), cast<To>(p.center_mm), To(p.distance_sd_mm),
          To(p.tilt_sd_rad)};
}

namespace detail {

/// Fits a Plane to a patch.
struct PlaneModel {
  static constexpr int unknowns = 3;
  template <scalar S>
  using Moments = MomentKernel<S, false>;
  template <scalar S>
  using Shape = Plane<S>;

  template <scalar S>
  static bool is_finite_shape(const Plane<S>& p) {
    return is_finite(p.normal) && is_finite(p.distance_mm) && is_finite(p.center_mm) &&
           is_finite(p.distance_sd_mm) && is_finite(p.tilt_sd_rad);
  }

  /// The plane of a patch, and the mean square distance from it. False if the points do not spread
  /// in two directions.
  template <scalar S, class AddUp>
  static bool fit(const PatchMoments<S>& patch, const AddUp&, Plane<S>& plane, S& mean_sq) {
    const Eigen3<S> e = eigenvectors(patch.second);
    plane.normal = toward_object(e.vector[2]);
    plane.center_mm = patch.centroid;
    plane.distance_mm = dot(plane.normal, plane.center_mm);
    mean_sq = value(e.value[2]) < 0 ? S(0) : e.value[2];
    const S across_sq = e.value[1];
    const S freedom = patch.count - S(unknowns);
    const S variance = value(freedom) > 0 ? S(mean_sq / freedom) : S(0);
    plane.distance_sd_mm = root(variance);
    plane.tilt_sd_rad = root(S(variance / across_sq));
    return value(across_sq) > 0;
  }

 private:
  template <scalar S>
  static S root(const S& x) {
    using std::sqrt;
    return value(x) > 0 ? S(sqrt(x)) : S(0);
  }
};

}  // namespace detail

/// A sphere in mm, or a plane if the curvature is 0. Standard errors hold for pixels with
/// independent errors (see SurfaceFit).
template <scalar S = double>
struct Sphere {
  S curvature_per_mm = not_a_number<S>();           ///< > 0: a convex object, which dents the pad
  Point3<S> point_mm = detail::missing_point<S>();  ///< point of it nearest to the patch's centroid
  Point3<S> normal = detail::missing_point<S>();    ///< normal there; unit vector toward the object
  S curvature_sd_per_mm = not_a_number<S>();        ///< standard error

  bool is_convex() const { return value(curvature_per_mm) > 0; }
  /// Negative for a hollow object, infinite for an exactly flat patch.
  S radius_mm() const { return S(S(1) / curvature_per_mm); }
  Point3<S> center_mm() const { return point_mm + radius_mm() * normal; }

  /// Signed distance of p from the sphere, mm; positive on the side away from the object.
  S stands_out(const Point3<S>& p) const {
    using std::sqrt;
    const Point3<S> q = p - point_mm;
    const S along = dot(normal, q);
    const S twice = S(2) * along - curvature_per_mm * dot(q, q);
    const S s_sq = S(1) - curvature_per_mm * twice;
    const S s = value(s_sq) > 0 ? S(sqrt(s_sq)) : S(0);  // 0 at the center
    return S(-twice / (S(1) + s));
  }
};
template <scalar To, scalar From>
Sphere<To> cast(const Sphere<From>& s) {
  return {To(s.curvature_per_mm), cast<To>(s.point_mm), cast<To>(s.normal),
          To(s.curvature_sd_per_mm)};
}

namespace detail {

/// Sums of J^T J and J^T d for the Gauss-Newton step on the distance d, and of d^2, which is the
/// last. The unknowns are the height of the sphere's point along the normal, the normal's rotation
/// toward u and v, and the curvature. Points are relative to the patch's centroid.
template <scalar S>
struct SphereStepKernel {
  static constexpr std::size_t sums = 15;
  SurfaceFrame<S> frame;
  S height;  ///< of the sphere's point above the centroid, along the normal
  S curvature;

  template <class V>
  [[gnu::always_inline]] Terms<V, sums> terms(const V& x, const V& y, const V& z) const {
    const V u = frame.u.x * x + frame.u.y * y + frame.u.z * z;
    const V v = frame.v.x * x + frame.v.y * y + frame.v.z * z;
    const V w = frame.n.x * x + frame.n.y * y + frame.n.z * z - height;
    const V q_sq = u * u + v * v + w * w;
    const V algebraic = w - S(0.5) * curvature * q_sq;
    // d as a series in k Q, without a square root; the relative error is about (k Q)^4
    const V t = curvature * algebraic;
    const V d = algebraic * (S(1) + t * (S(0.5) + t * (S(0.5) + S(0.625) * t)));
    const V inverse = S(1) / (S(1) - curvature * d);
    const V dh = (curvature * w - S(1)) * inverse;
    const V du = u * (S(1) + curvature * height) * inverse;
    const V dv = v * (S(1) + curvature * height) * inverse;
    const V dk = S(0.5) * (d * d - q_sq) * inverse;
    const V hh = dh * dh, hu = dh * du, hv = dh * dv, hk = dh * dk;
    const V uu = du * du, uv = du * dv, uk = du * dk;
    const V vv = dv * dv, vk = dv * dk, kk = dk * dk;
    const V hd = dh * d, ud = du * d, vd = dv * d, kd = dk * d, dd = d * d;
    return {{hh, hu, hv, hk, uu, uv, uk, vv, vk, kk, hd, ud, vd, kd, dd}};
  }
};

/// Fits a Sphere to a patch.
struct SphereModel {
  static constexpr int unknowns = 4;
  template <scalar S>
  using Moments = MomentKernel<S, true>;
  template <scalar S>
  using Shape = Sphere<S>;

  template <scalar S>
  static bool is_finite_shape(const Sphere<S>& s) {
    return is_finite(s.curvature_per_mm) && is_finite(s.point_mm) && is_finite(s.normal) &&
           is_finite(s.curvature_sd_per_mm);
  }

  /// The sphere of a patch, and the mean square distance from it. `add_up(kernel)` gives the sums
  /// of a kernel over the points relative to the patch's centroid. False if the points do not
  /// determine it.
  template <scalar S, class AddUp>
  static bool fit(const PatchMoments<S>& patch,
                  const AddUp& add_up,
                  Sphere<S>& sphere,
                  S& mean_sq) {
    SphereStepKernel<S> start;
    if (!algebraic(patch, start)) {
      return false;
    }
    const std::array<S, 15> s = add_up(start);
    const SmallMatrix<S, 4> a = {{{s[0], s[1], s[2], s[3]},
                                  {s[1], s[4], s[5], s[6]},
                                  {s[2], s[5], s[7], s[8]},
                                  {s[3], s[6], s[8], s[9]}}};
    const NormalEquations<S, 4> equations(a);
    if (!equations.good) {
      return false;
    }
    const std::array<S, 4> slope = {S(-s[10]), S(-s[11]), S(-s[12]), S(-s[13])};
    const std::array<S, 4> step = equations.solve(slope);
    S sum_sq = s[14];
    for (std::size_t k = 0; k < 4; ++k) {
      sum_sq = sum_sq - slope[k] * step[k];
    }
    sum_sq = value(sum_sq) < 0 ? S(0) : sum_sq;
    mean_sq = sum_sq / patch.count;
    const SurfaceFrame<S>& f = start.frame;
    sphere.normal = normalized(f.n + step[1] * f.u + step[2] * f.v);
    sphere.point_mm = patch.centroid + S(start.height + step[0]) * sphere.normal;
    sphere.curvature_per_mm = start.curvature + step[3];
    sphere.curvature_sd_per_mm = standard_error(patch.count, sum_sq, equations);
    return true;
  }

 private:
  /// The start of the fit, from the moments alone: least squares of
  /// w = a + b u + c v + e (u^2 + v^2 + w^2), with w the height above the best plane.
  template <scalar S>
  static bool algebraic(const PatchMoments<S>& patch, SphereStepKernel<S>& start) {
    using std::sqrt;
    const Eigen3<S> e = eigenvectors(patch.second);
    const Point3<S> n = toward_object(e.vector[2]);
    const SurfaceFrame<S> plane = SurfaceFrame<S>::around(n);
    const Point3<S> t = plane.to_frame(patch.third);
    const Point3<S> mu = plane.to_frame(times(patch.second, plane.u));
    const Point3<S> mv = plane.to_frame(times(patch.second, plane.v));
    const S mean_q = patch.second[0][0] + patch.second[1][1] + patch.second[2][2];
    const S q_var = patch.fourth - mean_q * mean_q;
    const SmallMatrix<S, 3> a = {{{mu.x, mu.y, t.x}, {mu.y, mv.y, t.y}, {t.x, t.y, q_var}}};
    const NormalEquations<S, 3> equations(a);
    if (!equations.good) {
      return false;
    }
    const std::array<S, 3> c = equations.solve({mu.z, mv.z, t.z});
    const S offset = -c[2] * mean_q;
    // Q = (w - a - b u - c v - e q) / N has |grad Q| = 1 on the sphere
    const S norm_sq = S(1) + c[0] * c[0] + c[1] * c[1] - S(4) * c[2] * offset;
    if (!(value(norm_sq) > 0)) {
      return false;
    }
    const S norm = sqrt(norm_sq);
    start.curvature = S(2) * c[2] / norm;
    const Point3<S> gradient = {S(-c[0]), S(-c[1]), S(1)};
    start.frame = SurfaceFrame<S>::around(plane.from_frame(normalized(gradient)));
    // the centroid lies at the signed distance d along the normal: d = 2 Q / (1 + s), Q = -a / N
    const S at_center = -offset / norm;
    const S s_sq = S(1) - S(2) * start.curvature * at_center;
    const S s = value(s_sq) > 0 ? S(sqrt(s_sq)) : S(0);
    start.height = -S(2) * at_center / (S(1) + s);
    return true;
  }

  template <scalar S>
  static S standard_error(const S& count, const S& sum_sq, const NormalEquations<S, 4>& equations) {
    using std::sqrt;
    const S freedom = count - S(unknowns);
    const S unit_variance = equations.variance({S(0), S(0), S(0), S(1)});
    const S variance = value(freedom) > 0 ? S(unit_variance * sum_sq / freedom) : S(0);
    return value(variance) > 0 ? S(sqrt(variance)) : S(0);
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
