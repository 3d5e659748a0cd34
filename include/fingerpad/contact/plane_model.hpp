// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The plane nearest to a patch: orthogonal regression, from the moments alone.
#include <cmath>
#include <cstddef>

#include "fingerpad/contact/detail/patch.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Angles of a direction n with n.z > 0, as turns of the z axis: n = Ry(about_y) Rx(about_x) z.
template <scalar S = double>
struct Tilt {
  S about_x_rad;
  S about_y_rad;
  S total_rad;  ///< between n and the z axis
};

template <scalar S>
Tilt<S> tilt_of(const Point3<S>& n) {
  using std::atan2;
  using std::sqrt;
  const S across = sqrt(S(n.x * n.x + n.z * n.z));
  const S aside_sq = n.x * n.x + n.y * n.y;
  const S aside = value(aside_sq) == 0 ? S(0) : S(sqrt(aside_sq));
  const S about_x = atan2(S(-n.y), across);
  const S about_y = atan2(n.x, n.z);
  const S total = atan2(aside, n.z);
  return {about_x, about_y, total};
}

/// A plane in mm. Standard errors hold for pixels whose errors are independent (see SurfaceFit).
template <scalar S = double>
struct Plane {
  Point3<S> normal = detail::missing_point<S>();     ///< unit vector toward the object
  S distance_mm = not_a_number<S>();                 ///< of the origin from it: normal . p
  Point3<S> center_mm = detail::missing_point<S>();  ///< centroid of the patch, on the plane
  S distance_sd_mm = not_a_number<S>();              ///< standard error along the normal, at the
                                                     ///< center
  S tilt_sd_rad = not_a_number<S>();                 ///< of the normal, where it is least certain

  Tilt<S> tilt() const { return tilt_of(normal); }
  /// Signed distance of p from the plane, mm; positive away from the object.
  S stands_out(const Point3<S>& p) const {
    return S(-dot(normal, detail::difference(p, center_mm)));
  }
};

/// Policy of SurfaceFit.
struct PlaneModel {
  static constexpr int unknowns = 3;
  template <scalar S>
  using Moments = detail::MomentKernel<S, false>;
  template <scalar S>
  using Shape = Plane<S>;

  template <scalar S>
  static bool is_finite_shape(const Plane<S>& p) {
    return detail::is_finite_point(p.normal) && is_finite(p.distance_mm) &&
           detail::is_finite_point(p.center_mm) && is_finite(p.distance_sd_mm) &&
           is_finite(p.tilt_sd_rad);
  }

  /// The plane of a patch into `plane`, and the mean square distance from it.
  template <scalar S, class AddUp>
  static bool fit(const detail::PatchMoments<S>& patch, const AddUp&, Plane<S>& plane, S& mean_sq) {
    const detail::Eigen3<S> e = detail::eigenvectors(patch.second);
    plane.normal = detail::toward_object(e.vector[2]);
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

}  // namespace v0
}  // namespace fingerpad
