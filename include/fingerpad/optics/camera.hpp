// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The camera behind a plate: converts a pixel to its ray in the fluid, and a pixel with a depth to
// a point in mm and back. Light enters the pad along z and comes back along this ray. Source: Ito,
// Kim, Obinata, "Shape sensing by vision-based tactile sensor" (slides), theory of the intensity of
// light; Ito, Kim, Nagai, Obinata 2011, eq. 13.
//
// No trigonometric function is needed: with t = tan(phi_air) = rho / h from the pixel, every cosine
// is a square root, and nothing is 0/0 at the center or overflows at grazing angles.
//
//        camera           rho = h t: where the ray meets the plate's inner face, from the axis
//          |\  phi_air
//    ======|=\=========   plate, inner face is z = 0
//          |   `-_ phi_fluid
//          v z    `-_     sin(phi_air) = n sin(phi_fluid)
#include <cmath>
#include <string>
#include <type_traits>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// Camera and plate. Without distortion a pixel's direction is that of a pinhole: tan(phi_air) = t
/// grows linearly with the distance from the center pixel. A lens shows the direction t where a
/// pinhole would show t (1 + k1 t^2 + k2 t^4), as in OpenCV. Where that falls with t the polynomial
/// describes no lens: directions from there on have no pixel, and pixels beyond no ray (NaN).
template <scalar S = double>
struct Camera {
  S plate_distance_mm = S(50);           ///< camera center to the plate's inner face, > 0
  S refractive_index = S(133) / S(100);  ///< of the fluid relative to air, >= 1 (water)
  S center_x_px = S(639) / S(2);         ///< pixel on the optical axis, along columns
  S center_y_px = S(479) / S(2);         ///< the same along rows
  S pitch_mm = S(8) / S(100);   ///< width of a pixel on the plate's inner face near the axis, > 0
  S plate_thickness_mm = S(0);  ///< included in plate_distance_mm; 0 as in the papers
  S plate_index = S(149) / S(100);  ///< of the plate (acrylic) relative to air, >= 1
  S pixel_aspect = S(1);            ///< height of a pixel over its width, > 0
  S distortion_k1 = S(0);           ///< radial distortion of the lens, < 0: barrel
  S distortion_k2 = S(0);           ///< its next coefficient
};

/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const Camera<S>& c) {
  const auto distance_mm = static_cast<double>(value(c.plate_distance_mm));
  const Range thickness = {.min = 0, .max = distance_mm, .below_max = true};
  return check("Camera", {{"plate_distance_mm", c.plate_distance_mm, positive},
                          {"refractive_index", c.refractive_index, at_least(1)},
                          {"center_x_px", c.center_x_px, finite_number},
                          {"center_y_px", c.center_y_px, finite_number},
                          {"pitch_mm", c.pitch_mm, positive},
                          {"plate_thickness_mm", c.plate_thickness_mm, thickness},
                          {"plate_index", c.plate_index, at_least(1)},
                          {"pixel_aspect", c.pixel_aspect, positive},
                          {"distortion_k1", c.distortion_k1, finite_number},
                          {"distortion_k2", c.distortion_k2, finite_number}});
}

/// Whether a pixel can have this depth, in (-100, 100) mm. False for NaN.
template <scalar S>
constexpr bool is_depth(const S& depth_mm) {
  return -100 < value(depth_mm) && value(depth_mm) < 100;
}

/// The same camera in another scalar.
template <scalar To, scalar From>
Camera<To> cast(const Camera<From>& c) {
  return {To(c.plate_distance_mm), To(c.refractive_index),   To(c.center_x_px), To(c.center_y_px),
          To(c.pitch_mm),          To(c.plate_thickness_mm), To(c.plate_index), To(c.pixel_aspect),
          To(c.distortion_k1),     To(c.distortion_k2)};
}

namespace detail {
/// tan of the refracted angle in a medium of index n, over t = tan of the angle in air:
/// 1 / sqrt(n^2 + (n^2 - 1) t^2); 1/n on the axis.
template <scalar S>
S tangent_ratio(const S& t_sq, const S& n) {
  using std::sqrt;
  const S n_sq = n * n;
  return S(1) / sqrt(n_sq + (n_sq - S(1)) * t_sq);
}
/// Distance from the axis at depth z per unit of t: where it meets the point that t sees.
template <scalar S>
S reach_mm(const Camera<S>& camera, const S& t_sq, const S& depth_mm) {
  return camera.plate_distance_mm - camera.plate_thickness_mm +
         camera.plate_thickness_mm * tangent_ratio(t_sq, camera.plate_index) +
         depth_mm * tangent_ratio(t_sq, camera.refractive_index);
}
}  // namespace detail

/// The ray of one pixel, as the depth model needs it, and the pencil of light that comes back along
/// it: the area that the pixel sees at depth z is proportional to (z + meridional_mm)(z +
/// sagittal_mm).
template <scalar S = double>
struct Ray {
  S tan_air = S(0);       ///< t = tan(phi_air)
  S tan_fluid = S(0);     ///< tan(phi_fluid): distance from the axis gained per mm of depth
  S cos_fluid = S(1);     ///< cos(phi_fluid)
  S plate_rho_mm = S(0);  ///< distance from the axis on the plate's inner face
  S path_factor = S(2);   ///< k = 1 + 1/cos(phi_fluid): light travels k z to depth z and back
  S meridional_mm =
      S(0);              ///< heights above the plate of the points from which it seems to come, in
  S sagittal_mm = S(0);  ///< the plane of the ray and across it: refraction makes it astigmatic
                         ///< (erratum E007)
};

/// The ray at tangent t = tan(phi_air) >= 0. The heights are exact for thin pencils. O(1), three
/// square roots.
template <scalar S>
Ray<S> ray_at_tangent(const Camera<S>& camera, const S& t) {
  using std::sqrt;
  const S t_sq = t * t;
  const S ratio = detail::tangent_ratio(t_sq, camera.refractive_index);
  const S inv_cos_air = sqrt(S(1) + t_sq);
  // cos(phi_fluid) = sqrt(n^2 + (n^2 - 1) t^2) / (n sqrt(1 + t^2)), and likewise in the plate
  const S inv_cos_fluid = camera.refractive_index * inv_cos_air * ratio;
  const S inv_cos_plate =
      camera.plate_index * inv_cos_air * detail::tangent_ratio(t_sq, camera.plate_index);
  const S in_air = (camera.plate_distance_mm - camera.plate_thickness_mm) * inv_cos_air;
  const S in_plate = camera.plate_thickness_mm / camera.plate_index * inv_cos_plate;
  const S cos_fluid = S(1) / inv_cos_fluid, n_cos = camera.refractive_index * cos_fluid;
  const S meridional =
      n_cos * cos_fluid * cos_fluid *
      (in_air * inv_cos_air * inv_cos_air + in_plate * inv_cos_plate * inv_cos_plate);
  return {t,
          t * ratio,
          cos_fluid,
          t * detail::reach_mm(camera, t_sq, S(0)),
          S(1) + inv_cos_fluid,
          meridional,
          n_cos * (in_air + in_plate)};
}

/// Tangent per pixel of distance from the center pixel, along a row, near the axis.
template <scalar S>
S tangent_per_px(const Camera<S>& camera) {
  return camera.pitch_mm / (camera.plate_distance_mm - camera.plate_thickness_mm +
                            camera.plate_thickness_mm / camera.plate_index);
}

/// c: at depth l, pixels near the axis see points that are pitch_mm (1 + c l) apart along x.
template <scalar S>
S growth_per_mm(const Camera<S>& camera) {
  return tangent_per_px(camera) / camera.pitch_mm / camera.refractive_index;
}

namespace detail {
/// 1 + k1 t^2 + k2 t^4; NaN if t (1 + k1 t^2 + k2 t^4) does not grow all the way to t.
template <scalar S>
S distortion(const Camera<S>& camera, const S& t_sq) {
  const auto s = value(t_sq), k1 = value(camera.distortion_k1), k2 = value(camera.distortion_k2);
  const bool grows_here = 1 + s * (3 * k1 + s * 5 * k2) > 0;
  const bool fell_before = k1 < 0 && 10 * k2 * s > -3 * k1 && 9 * k1 * k1 >= 20 * k2;
  return grows_here && !fell_before
             ? S(1) + t_sq * (camera.distortion_k1 + t_sq * camera.distortion_k2)
             : not_a_number<S>();
}

/// q = t / d, of the square of the distorted tangent d = t (1 + k1 t^2 + k2 t^4), by Newton's
/// method from q = 1; exactly 1 without distortion. NaN where no t is seen.
template <scalar S>
S undistortion(const Camera<S>& camera, const S& d_sq) {
  const S a = camera.distortion_k1 * d_sq, b = camera.distortion_k2 * d_sq * d_sq;
  S q = S(1);
  if (std::is_floating_point_v<S> && value(a) == 0 && value(b) == 0) {  // no derivatives to find
    return q;
  }
  bool is_near = false;
  for (int step = 0; step < 64; ++step) {
    const S q_sq = q * q;
    const S slope = S(1) + q_sq * (S(3) * a + q_sq * S(5) * b);
    const S miss = S(1) - q * (S(1) + q_sq * (a + q_sq * b));
    const S change = value(slope) > 0 ? miss / slope : q / S(-4);  // back from beyond the fold
    q = q + change;
    if (is_near) {  // the step that doubles the digits of q, and of its derivatives
      return is_finite(distortion(camera, d_sq * q * q)) ? q : not_a_number<S>();
    }
    is_near = value(change * change) <= epsilon<S>() * value(q * q);
  }
  return not_a_number<S>();
}
}  // namespace detail

/// The direction in air of the pixel at (row, col), which may lie between pixel centers: tangents
/// of its angles to the axis along x and along y. With pixel_at_tangents, the only place where
/// pixels become rays.
template <scalar S>
Point2<S> tangents_of_pixel(const Camera<S>& camera, const S& row, const S& col) {
  const S scale = tangent_per_px(camera);
  const Point2<S> distorted = {(col - camera.center_x_px) * scale,
                               (row - camera.center_y_px) * camera.pixel_aspect * scale};
  return detail::undistortion(camera, squared_norm(distorted)) * distorted;
}
/// The pixel that looks in this direction; inverse of tangents_of_pixel.
template <scalar S>
Point2<S> pixel_at_tangents(const Camera<S>& camera, const Point2<S>& tangents) {
  const S px = detail::distortion(camera, squared_norm(tangents)) / tangent_per_px(camera);
  return {camera.center_x_px + tangents.x * px,
          camera.center_y_px + tangents.y * px / camera.pixel_aspect};
}

/// The ray of the pixel at (row, col).
template <scalar S>
Ray<S> ray_at_pixel(const Camera<S>& camera, const S& row, const S& col) {
  using std::sqrt;
  const S t_sq = squared_norm(tangents_of_pixel(camera, row, col));
  // The square root has no derivative at 0; on the axis t itself is 0 for every camera.
  return ray_at_tangent(camera, value(t_sq) == 0 ? S(0) : sqrt(t_sq));
}

/// The point seen at (row, col) when its depth is depth_mm; NaN depth gives NaN. Ito et al. 2011,
/// eq. 13, with tan(phi_fluid) in the place of its sine, because z is a depth (E019).
template <scalar S>
Point3<S> point_at(const Camera<S>& camera, const S& row, const S& col, const S& depth_mm) {
  const Point2<S> tangents = tangents_of_pixel(camera, row, col);
  const S reach_mm = detail::reach_mm(camera, squared_norm(tangents), depth_mm);
  return {tangents.x * reach_mm, tangents.y * reach_mm, depth_mm};
}

/// The pixel that sees `point`; inverse of point_at. Requires point.z >= 0. The distance from the
/// axis is concave in t, so Newton's method from the paraxial ray rises to the root and needs no
/// safeguard: three to five steps in double, at most eight for up to 50 digits.
template <scalar S>
Point2<S> pixel_of(const Camera<S>& camera, const Point3<S>& point) {
  using std::sqrt;
  const S n = camera.refractive_index, m = camera.plate_index;
  const S in_air = camera.plate_distance_mm - camera.plate_thickness_mm;
  const S rho_sq = point.x * point.x + point.y * point.y;
  const S rho = value(rho_sq) == 0 ? S(0) : sqrt(rho_sq);
  S reach = camera.pitch_mm / tangent_per_px(camera) + point.z / n;  // near the axis
  S t = rho / reach;
  for (int step = 0; step <= 8; ++step) {
    const S t_sq = t * t;
    const S fluid = detail::tangent_ratio(t_sq, n), plate = detail::tangent_ratio(t_sq, m);
    reach = in_air + camera.plate_thickness_mm * plate + point.z * fluid;
    // d/dt of t / sqrt(n^2 + (n^2 - 1) t^2) is n^2 / (...)^(3/2)
    const S slope = in_air + camera.plate_thickness_mm * m * m * plate * plate * plate +
                    point.z * n * n * fluid * fluid * fluid;
    const S change = (rho - t * reach) / slope;
    t = t + change;
    if (value(change) <= epsilon<S>() * value(t)) {  // t rises to the root, up to roundoff
      break;
    }
  }
  return pixel_at_tangents(camera, {point.x / reach, point.y / reach});
}

}  // namespace v1
}  // namespace fingerpad
