// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A spherical cap of rubber, clamped at its rim and inflated. See calibrate/rim.hpp.
#include <cmath>
#include <numbers>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Mooney-Rivlin membrane that is a spherical cap without stress. S is the arc from the apex, rho
/// and r are the radii without and with stress, and lambda_2 = r / rho. The tensions per mu t are
///   T_1 = (lambda_1 / lambda_2 - (lambda_1 lambda_2)^-3) (1 - m + m lambda_2^2),
/// and T_2 with 1 and 2 exchanged. The balance of the part inside r gives T_1 = q r / (2 sin(phi))
/// with q = p / (mu t). The profile follows from r' = lambda_1 cos(phi), z' = -lambda_1 sin(phi),
///   phi' = lambda_1 (q - T_2 sin(phi) / r) / T_1.
template <scalar S>
class InflatedCap {
 public:
  InflatedCap(const S& base_radius_mm, const S& stress_free_height_mm, const S& mooney_share)
      : base_mm_(base_radius_mm),
        bend_mm_((square(base_radius_mm) + square(stress_free_height_mm)) /
                 (S(2) * stress_free_height_mm)),
        m_(mooney_share) {
    using std::atan;
    arc_mm_ = S(2) * bend_mm_ * atan(stress_free_height_mm / base_radius_mm);
  }

  /// Height of the apex, mm, under p / (mu t) = `load_per_mm` > 0. NaN if there is no equilibrium
  /// with a stretch of the apex below 2.
  S apex_mm(const S& load_per_mm) const {
    double low = 1.001, high = 2;
    const auto misses = [&](double stretch) {
      return static_cast<double>(value(profile(S(stretch), load_per_mm).r - base_mm_));
    };
    if (!(misses(low) < 0) || !(misses(high) > 0)) {
      return not_a_number<S>();
    }
    for (int k = 0; k < 12; ++k) {
      const double middle = (low + high) / 2;
      (misses(middle) < 0 ? low : high) = middle;
    }
    // the last steps are in S, so that derivatives are right, too
    const double step = 1e-4;
    const S slope = S((misses(low + step) - misses(low - step)) / (2 * step));
    S stretch = S(low);
    for (int k = 0; k < 4; ++k) {
      stretch = stretch - (profile(stretch, load_per_mm).r - base_mm_) / slope;
    }
    return -profile(stretch, load_per_mm).z;
  }

 private:
  struct Place {
    S r, z, phi;
  };

  Place change(const S& arc, const Place& at, const S& q) const {
    using std::cos;
    using std::sin;
    const S sine = sin(at.phi);
    const S hoop = at.r / (bend_mm_ * sin(arc / bend_mm_));
    const S t1 = q * at.r / (S(2) * sine);
    const S x = stretch_of(t1, hoop);
    const S area_cubed = x * hoop * x * hoop * x * hoop;
    const S t2 = (hoop / x - S(1) / area_cubed) * (S(1) - m_ + m_ * x * x);
    return {x * cos(at.phi), -x * sine, x * (q - t2 * sine / at.r) / t1};
  }

  /// lambda_1 for a tension, from lambda - k lambda^-3 = c by Newton's method. The left side rises
  /// and is concave, so the iteration converges from below.
  S stretch_of(const S& t1, const S& hoop) const {
    const S k = S(1) / (hoop * hoop);
    const S c = t1 * hoop / (S(1) - m_ + m_ * hoop * hoop);
    S x = S(1);
    for (int step = 0; step < 8; ++step) {
      const S cubed = k / (x * x * x);
      x = x - (x - cubed - c) / (S(1) + S(3) * cubed / x);
    }
    return x;
  }

  /// State at the rim, by the Runge-Kutta method from the apex at (0, 0). r = 0 if the cap closes
  /// before the rim.
  Place profile(const S& apex_stretch, const S& q) const {
    const S l = apex_stretch, l_sq = l * l;
    const S tension = (S(1) - S(1) / (l_sq * l_sq * l_sq)) * (S(1) - m_ + m_ * l_sq);
    constexpr int steps = 60;
    S arc = arc_mm_ / S(2000);
    const S step = (arc_mm_ - arc) / S(steps);
    const S bend = l * q / (S(2) * tension);
    Place at = {l * arc, -bend * l * arc * arc / S(2), bend * arc};
    const auto moved = [](const Place& from, const S& by, const Place& d) {
      return Place{from.r + by * d.r, from.z + by * d.z, from.phi + by * d.phi};
    };
    for (int k = 0; k < steps; ++k) {
      const S half = step / S(2);
      const Place a = change(arc, at, q);
      const Place b = change(arc + half, moved(at, half, a), q);
      const Place c = change(arc + half, moved(at, half, b), q);
      const Place d = change(arc + step, moved(at, step, c), q);
      const Place sum = moved(moved(moved(a, S(2), b), S(2), c), S(1), d);
      at = moved(at, step / S(6), sum);
      arc = arc + step;
      if (!(value(at.phi) < 3) || !(value(at.r) > 0)) {
        return {S(0), S(0), S(0)};
      }
    }
    return at;
  }

  S base_mm_, bend_mm_, m_;
  S arc_mm_ = S(0);
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
