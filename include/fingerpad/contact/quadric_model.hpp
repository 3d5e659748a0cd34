// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The quadric that fits a patch best, with its principal curvatures. Its frame has the origin at
// the patch's centroid, w along the normal of the best plane, and u and v in that plane:
//
//   w = a + b u + c v + d u^2 + e u v + f v^2 + g w^2
//
// Without g (a paraboloid) the curvature of a cap of radius A on a sphere of radius R is too large
// by a share of about A^2 / (4 R^2). Therefore g is set from d, e, f: with the curvatures k1, k2
// that these give, g = (k1^3 + k2^3) / (k1^2 + k2^2) / 2. This g makes spheres and cylinders exact
// and is 0 for a saddle that bends both ways alike. It also keeps |grad| close to 1, so that least
// squares minimise the distance. As w^2 only adds a second right side, g is found by iteration
// without another pass over the points.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/contact/detail/patch.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

/// A quadric in mm in its own frame, with its principal curvatures at the patch's center.
/// Curvatures are positive where the object is convex; the first is larger in magnitude. Standard
/// errors hold for pixels with independent errors (see SurfaceFit).
template <scalar S = double>
struct Quadric {
  S curvature_1_per_mm = not_a_number<S>();            ///< principal curvature, larger in magnitude
  S curvature_2_per_mm = not_a_number<S>();            ///< the other one; 0 for a cylinder
  Point3<S> direction_1 = detail::missing_point<S>();  ///< unit vector of the first curvature
  Point3<S> direction_2 =
      detail::missing_point<S>();  ///< unit vector of the second one: a cylinder's axis
  Point3<S> point_mm = detail::missing_point<S>();  ///< point of it, along w from the centroid
  Point3<S> normal = detail::missing_point<S>();    ///< normal there; unit vector toward the object
  S curvature_1_sd_per_mm = not_a_number<S>();      ///< standard errors of both
  S curvature_2_sd_per_mm = not_a_number<S>();

  Point3<S> origin_mm = detail::missing_point<S>();  ///< centroid of the patch
  Point3<S> u = detail::missing_point<S>();          ///< axes of the frame; w = u x v, toward the
  Point3<S> v = detail::missing_point<S>();          ///< object
  Point3<S> w = detail::missing_point<S>();
  std::array<S, 6> coefficients = detail::zeros<S, 6>();  ///< a, b, c, d, e, f; mm, -, -, 1/mm
  S g_per_mm = not_a_number<S>();

  S mean_curvature_per_mm() const { return S(S(0.5) * (curvature_1_per_mm + curvature_2_per_mm)); }

  /// Signed distance of p from the quadric, mm, to first order in the distance; positive on the
  /// side away from the object.
  S stands_out(const Point3<S>& p) const {
    using std::sqrt;
    const auto& [a, b, c, d, e, f] = coefficients;
    const Point3<S> q = p - origin_mm;
    const S x = dot(u, q);
    const S y = dot(v, q);
    const S z = dot(w, q);
    const S height = a + x * (b + d * x + e * y) + y * (c + f * y);
    const S below = height - z * (S(1) - g_per_mm * z);
    const S along_u = b + S(2) * d * x + e * y;
    const S along_v = c + S(2) * f * y + e * x;
    const S along_w = S(1) - S(2) * g_per_mm * z;
    return S(below / S(sqrt(S(along_u * along_u + along_v * along_v + along_w * along_w))));
  }
};
template <scalar To, scalar From>
Quadric<To> cast(const Quadric<From>& q) {
  Quadric<To> out{To(q.curvature_1_per_mm),
                  To(q.curvature_2_per_mm),
                  cast<To>(q.direction_1),
                  cast<To>(q.direction_2),
                  cast<To>(q.point_mm),
                  cast<To>(q.normal),
                  To(q.curvature_1_sd_per_mm),
                  To(q.curvature_2_sd_per_mm),
                  cast<To>(q.origin_mm),
                  cast<To>(q.u),
                  cast<To>(q.v),
                  cast<To>(q.w)};
  for (std::size_t k = 0; k < q.coefficients.size(); ++k) {
    out.coefficients[k] = To(q.coefficients[k]);
  }
  out.g_per_mm = To(q.g_per_mm);
  return out;
}

namespace detail {

/// Sums for the normal equations: the monomials of u and v to fourth order, and the products with w
/// that the right sides need.
template <scalar S>
struct QuadricKernel {
  static constexpr std::size_t sums = 28;
  SurfaceFrame<S> frame;

  template <class V>
  [[gnu::always_inline]] Terms<V, sums> terms(const V& x, const V& y, const V& z) const {
    const V u = frame.u.x * x + frame.u.y * y + frame.u.z * z;
    const V v = frame.v.x * x + frame.v.y * y + frame.v.z * z;
    const V w = frame.n.x * x + frame.n.y * y + frame.n.z * z;
    const V uu = u * u, uv = u * v, vv = v * v, ww = w * w;
    const V uuu = u * uu, uuv = u * uv, uvv = v * uv, vvv = v * vv;
    const V uuuu = uu * uu, uuuv = uu * uv, uuvv = uu * vv, uvvv = uv * vv, vvvv = vv * vv;
    const V wu = w * u, wv = w * v, wuu = w * uu, wuv = w * uv, wvv = w * vv;
    const V zu = ww * u, zv = ww * v, zuu = ww * uu, zuv = ww * uv, zvv = ww * vv;
    const V www = ww * w, wwww = ww * ww;
    return {{u, v,  uu, uv,  vv,  uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv,
             w, wu, wv, wuu, wuv, wvv, zu,  zv,  zuu, zuv,  zvv,  ww,   www,  wwww}};
  }
};

/// Eigenvalues of {p, q; q, r}, the larger in magnitude first, and the direction (cos, sin) of the
/// first.
template <scalar S>
struct Eigen2 {
  S first;
  S second;
  S cos;
  S sin;

  Eigen2(const S& p, const S& q, const S& r) {
    using std::sqrt;
    const S t = jacobi_tangent(p, r, q);
    const S low = p - t * q;
    const S high = r + t * q;
    const S c = S(1) / S(sqrt(S(S(1) + t * t)));
    const S s = t * c;
    const bool swap = value(S(low * low)) < value(S(high * high));
    first = swap ? high : low;
    second = swap ? low : high;
    cos = swap ? s : c;
    sin = swap ? c : S(-s);
  }
};

/// g as a function of d, e, f, through the curvatures that they give.
template <scalar S>
S tied_g(const std::array<S, 6>& c) {
  const S twice_d = c[3] + c[3];
  const S twice_f = c[5] + c[5];
  const Eigen2<S> k(twice_d, c[4], twice_f);
  if (value(k.first) == 0) {
    return S(0);
  }
  const S ratio = k.second / k.first;
  const S ratio_sq = ratio * ratio;
  return S(S(0.5) * k.first * (S(1) + ratio * ratio_sq) / (S(1) + ratio_sq));
}

/// Fits a Quadric to a patch.
struct QuadricModel {
  static constexpr int unknowns = 6;
  template <scalar S>
  using Moments = MomentKernel<S, false>;
  template <scalar S>
  using Shape = Quadric<S>;

  template <scalar S>
  static bool is_finite_shape(const Quadric<S>& q) {
    bool finite = is_finite(q.g_per_mm) && is_finite(q.curvature_1_sd_per_mm) &&
                  is_finite(q.curvature_2_sd_per_mm) && is_finite(q.curvature_1_per_mm) &&
                  is_finite(q.curvature_2_per_mm);
    for (const S& c : q.coefficients) {
      finite = finite && is_finite(c);
    }
    for (const Point3<S>& p :
         {q.direction_1, q.direction_2, q.point_mm, q.normal, q.origin_mm, q.u, q.v, q.w}) {
      finite = finite && is_finite(p);
    }
    return finite;
  }

  /// The quadric of a patch, and the mean square distance from it. `add_up(kernel)` gives the sums
  /// of a kernel over the points relative to the patch's centroid. False if the points do not
  /// determine it.
  template <scalar S, class AddUp>
  static bool fit(const PatchMoments<S>& patch,
                  const AddUp& add_up,
                  Quadric<S>& quadric,
                  S& mean_sq) {
    const Eigen3<S> e = eigenvectors(patch.second);
    const Point3<S> n = toward_object(e.vector[2]);
    const QuadricKernel<S> kernel{SurfaceFrame<S>::around(n)};
    const auto s = add_up(kernel);
    const S& count = patch.count;
    const SmallMatrix<S, 6> a = {{{count, s[0], s[1], s[2], s[3], s[4]},
                                  {s[0], s[2], s[3], s[5], s[6], s[7]},
                                  {s[1], s[3], s[4], s[6], s[7], s[8]},
                                  {s[2], s[5], s[6], s[9], s[10], s[11]},
                                  {s[3], s[6], s[7], s[10], s[11], s[12]},
                                  {s[4], s[7], s[8], s[11], s[12], s[13]}}};
    const NormalEquations<S, 6> equations(a);
    if (!equations.good) {
      return false;
    }
    const std::array<S, 6> w = {s[14], s[15], s[16], s[17], s[18], s[19]};
    const std::array<S, 6> w_sq = {s[25], s[20], s[21], s[22], s[23], s[24]};
    const std::array<S, 6> c_w = equations.solve(w);
    const std::array<S, 6> c_w_sq = equations.solve(w_sq);
    quadric.origin_mm = patch.centroid;
    quadric.u = kernel.frame.u;
    quadric.v = kernel.frame.v;
    quadric.w = kernel.frame.n;
    tie(c_w, c_w_sq, quadric);
    S sum_sq = s[25] - quadric.g_per_mm * (S(2) * s[26] - quadric.g_per_mm * s[27]);
    for (std::size_t k = 0; k < 6; ++k) {
      sum_sq = sum_sq - quadric.coefficients[k] * (w[k] - quadric.g_per_mm * w_sq[k]);
    }
    sum_sq = value(sum_sq) < 0 ? S(0) : sum_sq;
    mean_sq = sum_sq / count;
    const S freedom = count - S(unknowns);
    bend(equations, value(freedom) > 0 ? S(sum_sq / freedom) : S(0), quadric);
    return true;
  }

 private:
  /// Finds g and the coefficients by iteration: each round multiplies the error by about the square
  /// of the angle that the patch spans on the object.
  template <scalar S>
  static void tie(const std::array<S, 6>& c_w, const std::array<S, 6>& c_w_sq, Quadric<S>& q) {
    q.coefficients = c_w;
    q.g_per_mm = S(0);
    for (int round = 0; round < 60; ++round) {
      const S before = q.g_per_mm;
      q.g_per_mm = tied_g(q.coefficients);
      for (std::size_t k = 0; k < 6; ++k) {
        q.coefficients[k] = c_w[k] - q.g_per_mm * c_w_sq[k];
      }
      const S change = q.g_per_mm - before;
      if (value(S(change * change)) <= value(S(square(S(epsilon<S>() * q.g_per_mm))))) {
        break;
      }
    }
  }

  /// Principal curvatures at the point of the quadric along w from the centroid. The quadric
  /// F = w - g w^2 - ... = 0 has the curvature t^T (Hessian of -F) t / |grad F| along a unit
  /// tangent t.
  template <scalar S>
  static void bend(const NormalEquations<S, 6>& equations, const S& variance, Quadric<S>& quadric) {
    using std::sqrt;
    const S& a = quadric.coefficients[0];
    const S& d = quadric.coefficients[3];
    const S& e = quadric.coefficients[4];
    const S& f = quadric.coefficients[5];
    const S& g = quadric.g_per_mm;
    const S root_sq = S(1) - S(4) * g * a;
    const S root = value(root_sq) > 0 ? S(sqrt(root_sq)) : S(0);
    const S height = S(2) * a / (S(1) + root);
    const Point3<S> gradient = {S(-quadric.coefficients[1]), S(-quadric.coefficients[2]),
                                S(S(1) - S(2) * g * height)};
    const S length = sqrt(S(dot(gradient, gradient)));
    const SurfaceFrame<S> local = SurfaceFrame<S>::around(normalized(gradient));
    const auto bent = [&](const Point3<S>& s, const Point3<S>& t) {
      return S(
          (S(2) * (d * s.x * t.x + f * s.y * t.y + g * s.z * t.z) + e * (s.x * t.y + s.y * t.x)) /
          length);
    };
    const Eigen2<S> k(bent(local.u, local.u), bent(local.u, local.v), bent(local.v, local.v));
    const SurfaceFrame<S> axes = {quadric.u, quadric.v, quadric.w};
    const Point3<S> zero = {S(0), S(0), S(0)};
    const Point3<S> along = zero + k.cos * local.u + k.sin * local.v;
    const Point3<S> aside = zero + S(-k.sin) * local.u + k.cos * local.v;
    quadric.curvature_1_per_mm = k.first;
    quadric.curvature_2_per_mm = k.second;
    quadric.direction_1 = axes.from_frame(along);
    quadric.direction_2 = axes.from_frame(aside);
    quadric.normal = axes.from_frame(local.n);
    quadric.point_mm = quadric.origin_mm + height * quadric.w;
    const auto error = [&](const Point3<S>& t) {
      const std::array<S, 6> h = {
          S(0), S(0), S(0), S(S(2) * t.x * t.x), S(S(2) * t.x * t.y), S(S(2) * t.y * t.y)};
      const S squared = equations.variance(h) * variance;
      return value(squared) > 0 ? S(sqrt(squared)) : S(0);
    };
    quadric.curvature_1_sd_per_mm = error(along);
    quadric.curvature_2_sd_per_mm = error(aside);
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
