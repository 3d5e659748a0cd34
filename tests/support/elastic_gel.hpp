// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A rigid ball that is pressed into a thick gel pad and dragged along it: where the contact sticks,
// where it slips, and how every point of the gel's surface is displaced. It makes test signals with
// known ground truth: the shape of the imprint and the motion of dots, in the contact and around
// it. The pad is an elastic half-space (Hertz; Cattaneo and Mindlin; surface displacements of
// Boussinesq and Cerruti in closed form: K. L. Johnson, "Contact Mechanics", 1985, eqs. 3.41-3.43,
// 3.91-3.92, 7.36-7.42). The fields of normal and shear load are not coupled, which is exact for an
// incompressible gel (poisson = 0.5) and good for a nearly incompressible one.
#include <cmath>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace test {

using fingerpad::not_a_number;
using fingerpad::Point2;
using fingerpad::Point3;
using fingerpad::scalar;
using fingerpad::square;

/// The gel and the ball that touches it.
struct GelPad {
  double young_mpa = 0.2;  ///< of the gel; > 0
  double poisson = 0.5;    ///< of the gel; in [0, 0.5]
  double ball_mm = 10;     ///< radius of the ball, > 0
  double friction = 0.6;   ///< >= 0
};
/// A ball on the gel: its position, its normal force, and the anchor, where the gel under it would
/// be without the ball. A value; drag() moves the ball. x and y are in mm on the free surface, z
/// points out of the gel. Every function is O(1).
template <scalar S = double>
class BallOnGel {
 public:
  explicit BallOnGel(const GelPad& pad, const Point2<S>& ball_mm = {S(0), S(0)})
      : pad_(pad), ball_mm_(ball_mm), anchor_mm_(ball_mm) {}

  /// Presses with `force_n` (0: the contact is lost; the gel springs back) and then moves the ball
  /// to `ball_mm`. The gel under the ball follows up to the limit of friction. Beyond it the ball
  /// slides and the gel stays behind.
  void drag(const S& force_n, const Point2<S>& ball_mm) {
    force_n_ = S(0) < force_n ? force_n : S(0);
    ball_mm_ = ball_mm;
    slides_ = false;
    if (!touches()) {
      anchor_mm_ = ball_mm;
      return;
    }
    const Point2<S> pull = ball_mm_ - anchor_mm_;
    const S distance = norm_of(pull);
    if (max_pull_mm() < distance) {
      slides_ = true;
      anchor_mm_ = ball_mm_ - S(max_pull_mm() / distance) * pull;
    }
  }

  bool touches() const { return S(0) < force_n_; }
  /// Whether the last drag went beyond the limit of friction, so that the whole contact slid.
  bool slides() const { return slides_; }
  const Point2<S>& ball_mm() const { return ball_mm_; }

  /// Hertz's contact radius a, eq. 4.22: a^3 = 3 P R / (4 E*).
  S radius_mm() const {
    using std::cbrt;
    return S(cbrt(S(force_n_ * S(0.75 * pad_.ball_mm) / modulus_mpa())));
  }
  /// Depth of the ball's lowest point, a^2 / R.
  S depth_mm() const { return S(square(radius_mm()) / S(pad_.ball_mm)); }
  /// How far the ball can be moved before all of the contact slides, eq. 7.42 with Q = mu P.
  S max_pull_mm() const {
    return touches() ? S(S(3 * pad_.friction * (2 - pad_.poisson)) * force_n_ /
                         (S(16 * shear_mpa()) * radius_mm()))
                     : S(0);
  }
  /// Stick radius c of Cattaneo and Mindlin: inside it the gel sticks, eqs. 7.40 and 7.42.
  S stick_radius_mm() const {
    using std::sqrt;
    const S max_pull = max_pull_mm();
    const S left = S(0) < max_pull ? S(S(1) - norm_of(pull_mm()) / max_pull) : S(0);
    return slides_ || !(S(0) < left) ? S(0) : S(radius_mm() * S(sqrt(left)));
  }
  /// c^2 / a^2, the share of the contact that sticks; NaN without contact.
  S stick_share() const {
    return touches() ? S(square(S(stick_radius_mm() / radius_mm()))) : not_a_number<S>();
  }
  /// Shear force Q of the ball on the gel, N.
  Point2<S> shear_n() const {
    const S c = touches() ? S(stick_radius_mm() / radius_mm()) : S(0);
    const S size = S(S(pad_.friction) * force_n_ * (S(1) - c * c * c));
    const S distance = norm_of(pull_mm());
    return S(0) < distance ? S(size / distance) * pull_mm() : Point2<S>{S(0), S(0)};
  }

  /// Displacement of a point of the free surface, in mm; z < 0 is into the gel.
  Point3<S> displacement_mm(const Point2<S>& at_mm) const {
    if (!touches()) {
      return {S(0), S(0), S(0)};
    }
    const S a = radius_mm();
    const S p0 = S(S(2 / pi / pad_.ball_mm * modulus_mpa()) * a);
    const Point2<S> p = at_mm - ball_mm_;
    const S r = norm_of(p);
    Point3<S> u = {S(0), S(0), S(-sunk(r, a) / S(2 * pad_.ball_mm))};
    if (S(0) < r) {  // eq. 3.43; 0 in an incompressible gel
      const S inner = r < a ? S(S(1) - r * r / (a * a)) : S(0);
      const S radial = S(S((1 - 2 * pad_.poisson) / (6 * shear_mpa())) * a * a * p0 / (r * r) *
                         (S(1) - inner * root(inner)));
      u.x = S(-radial * p.x);
      u.y = S(-radial * p.y);
    }
    const S distance = norm_of(pull_mm());
    if (S(0) < distance) {
      const Point2<S> along = pull_mm() / distance;
      const S c = stick_radius_mm();
      const S q0 = S(S(pad_.friction) * p0);
      const Point2<S> all = sheared(p, along, r, a);
      const Point2<S> stuck = S(0) < c ? S(c / a) * sheared(p, along, r, c) : Point2<S>{S(0), S(0)};
      u.x = S(u.x + q0 * (all.x - stuck.x));
      u.y = S(u.y + q0 * (all.y - stuck.y));
    }
    return u;
  }

 private:
  static constexpr double pi = 3.14159265358979323846;
  double shear_mpa() const { return pad_.young_mpa / (2 * (1 + pad_.poisson)); }
  double modulus_mpa() const { return pad_.young_mpa / (1 - pad_.poisson * pad_.poisson); }
  Point2<S> pull_mm() const { return ball_mm_ - anchor_mm_; }
  static S root(const S& x) {
    using std::sqrt;
    return S(0) < x ? S(sqrt(x)) : S(0);
  }
  static S norm_of(const Point2<S>& p) { return root(squared_norm(p)); }
  static S arc(const S& r, const S& a) {
    using std::asin;
    return a < r ? S(asin(S(a / r))) : S(pi / 2);
  }

  /// 2 R times the depth of the surface, eq. 3.42.
  static S sunk(const S& r, const S& a) {
    const S inside = S(S(2) * a * a - r * r);
    if (!(a < r)) {
      return inside;
    }
    return S(S(2 / pi) * (inside * arc(r, a) + a * root(S(r * r - a * a))));
  }

  /// Displacement under the traction sqrt(1 - r^2 / a^2) along a direction, eqs. 3.91 and 3.92.
  Point2<S> sheared(const Point2<S>& p, const Point2<S>& along, const S& r, const S& a) const {
    const S even = S(S((2 - pad_.poisson) * pi / 2) * sunk(r, a));
    // the part that varies with twice the angle to the direction of the pull
    const S x = dot(p, along);
    const S y = S(along.x * p.y - along.y * p.x);
    S twice = S(pad_.poisson * pi / 4);
    if (a < r) {
      const S outside =
          S((S(2) * a * a / (r * r) - S(1)) * (a / r) * root(S(S(1) - a * a / (r * r))));
      twice = S(S(pad_.poisson / 2) * (arc(r, a) + outside));
    }
    const S per = S(S(1) / (S(8 * shear_mpa()) * a));
    const S ux = S(per * (even + twice * (x * x - y * y)));
    const S uy = S(per * S(2) * twice * x * y);
    return {S(ux * along.x - uy * along.y), S(ux * along.y + uy * along.x)};
  }

  GelPad pad_;
  Point2<S> ball_mm_;
  Point2<S> anchor_mm_;
  S force_n_ = S(0);
  bool slides_ = false;
};

}  // namespace test
