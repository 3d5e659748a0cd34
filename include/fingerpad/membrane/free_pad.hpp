// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The pad that nothing touches: a cap of rubber, spherical without stress, held at its rim and
// inflated.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/membrane/rubber.hpp"

namespace fingerpad {
inline namespace v1 {

/// The membrane without stress: a spherical cap of one rubber.
template <scalar S = double>
struct StressFreeCap {
  S base_radius_mm = S(20);  ///< of the rim, > 0
  S height_mm = S(11);       ///< of its apex, > 0
  S mooney_share = S(0);     ///< C2 / (C1 + C2), in [0, 1]; 0: neo-Hookean
  S uneven_x = S(0);         ///< share by which mu t grows from the axis to the rim along x,
  S uneven_y = S(0);         ///< and along y; together in [0, 0.3]

  S radius_mm() const {
    return (base_radius_mm * base_radius_mm + height_mm * height_mm) / (S(2) * height_mm);
  }
  bool is_uneven() const { return value(uneven_x) != 0 || value(uneven_y) != 0; }
  /// From the rim to the apex.
  S arc_mm() const {
    using std::atan;
    return S(2) * radius_mm() * atan(height_mm / base_radius_mm);
  }
  /// Distance from the axis at `arc_mm` from the rim.
  S rho_mm(const S& arc) const {
    using std::sin;
    return radius_mm() * sin((arc_mm() - arc) / radius_mm());
  }
};

/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const StressFreeCap<S>& cap) {
  const double uneven = std::hypot(static_cast<double>(value(cap.uneven_x)),
                                   static_cast<double>(value(cap.uneven_y)));
  return check("StressFreeCap", {{"base_radius_mm", cap.base_radius_mm, positive},
                                 {"height_mm", cap.height_mm, positive},
                                 {"mooney_share", cap.mooney_share, within(0, 1)},
                                 {"uneven_x and uneven_y together", uneven, within(0, 0.3)}});
}

/// How the membrane of a free pad leaves its rim.
template <scalar S>
struct FreeRim {
  S slope_rad;  ///< of the meridian: 0 level, 90 degrees upright
  S stretch;    ///< along the meridian
  S apex_mm;    ///< height of the apex above the rim's level
};

/// Shoots from the apex. S is the arc from it, rho and r are the radii without and with stress, and
/// lambda_2 = r / rho; T_1 and T_2 are the tensions of the stretched membrane per mu t. The balance
/// of the part inside r gives T_1 = q r / (2 sin(phi)) with q = p / (mu t). The profile follows
/// from
///   r' = lambda_1 cos(phi), z' = -lambda_1 sin(phi), phi' = lambda_1 (q - T_2 sin(phi) / r) / T_1.
template <scalar S>
class FreePad {
 public:
  explicit FreePad(const StressFreeCap<S>& cap) : cap_(cap) {
    require(cap);
    bend_mm_ = cap.radius_mm();
    arc_mm_ = cap.arc_mm();
  }

  /// The rim under p / (mu t) = `load_per_mm` > 0. Empty if there is no equilibrium with a stretch
  /// of the apex below 2.
  std::optional<FreeRim<S>> rim(const S& load_per_mm) const {
    using std::sin;
    const auto stretch_at = apex_stretch(load_per_mm);
    if (!stretch_at) {
      return {};
    }
    const Place at = profile(*stretch_at, load_per_mm);
    const S hoop = at.r / cap_.rho_mm(S(0));
    const S along = stretch_of(load_per_mm * at.r / (S(2) * sin(at.phi)), hoop, *stretch_at);
    return FreeRim<S>{at.phi, along, -at.z};
  }

  /// Points of the meridian under this load, from the apex to the rim: distance from the axis and
  /// height above the rim's level, some hundredths of a millimetre apart. Empty where rim() is.
  std::vector<Point2<S>> meridian(const S& load_per_mm) const {
    std::vector<Point2<S>> points;
    if (const auto stretch = apex_stretch(load_per_mm)) {
      points.push_back({S(0), S(0)});
      const S end = profile(*stretch, load_per_mm, 600, &points).z;
      for (Point2<S>& p : points) {
        p.y = p.y - end;
      }
    }
    return points;
  }

 private:
  struct Place {
    S r, z, phi;
  };

  /// The stretch of the apex at which the membrane ends at its rim.
  std::optional<S> apex_stretch(const S& load_per_mm) const {
    const auto miss = [&](const S& stretch) {
      return profile(stretch, load_per_mm).r - cap_.base_radius_mm;
    };
    const auto misses = [&](double stretch) {
      return static_cast<double>(value(miss(S(stretch))));
    };
    double low = 1.001, high = 2;
    if (!(misses(low) < 0) || !(misses(high) > 0)) {
      return {};
    }
    for (int k = 0; k < 20; ++k) {
      const double middle = (low + high) / 2;
      (misses(middle) < 0 ? low : high) = middle;
    }
    // the last steps are in S, so that derivatives are right, too
    const double step = (std::max)(1e-5, std::cbrt(static_cast<double>(epsilon<S>()))) * (low - 1);
    const S slope = S((misses(low + step) - misses(low - step)) / (2 * step));
    S stretch = S(low);
    for (int k = 0; k < 8; ++k) {
      const S change = miss(stretch) / slope;
      stretch = stretch - change;
      if (value(change * change) < square(epsilon<S>())) {
        break;
      }
    }
    return stretch;
  }

  Place change(const S& arc, const Place& at, const S& q, S& x) const {
    using std::cos;
    using std::sin;
    const S sine = sin(at.phi);
    const S hoop = at.r / (bend_mm_ * sin(arc / bend_mm_));
    const S t1 = q * at.r / (S(2) * sine);
    x = stretch_of(t1, hoop, x);
    const S t2 = rubber_pull(hoop, x, cap_.mooney_share) / x;
    return {x * cos(at.phi), -x * sine, x * (q - t2 * sine / at.r) / t1};
  }

  /// lambda_1 for a tension along the meridian, from nearly that value; its pull per stress-free
  /// length is T_1 lambda_2.
  S stretch_of(const S& t1, const S& hoop, S near) const {
    (void)detail::membrane::stretch_of_pull({t1 * hoop, S(0), S(0)}, {S(0), hoop, S(0)},
                                            cap_.mooney_share, near);
    return near;
  }

  /// State at the rim, by the Runge-Kutta method from the apex at (0, 0). r = 0 if the cap closes
  /// before the rim.
  Place profile(const S& apex_stretch,
                const S& q,
                int steps = 60,
                std::vector<Point2<S>>* points = nullptr) const {
    S arc = arc_mm_ / S(2000);
    const S step = (arc_mm_ - arc) / S(steps);
    const S l = apex_stretch, tension = rubber_pull(l, l, cap_.mooney_share) / l;
    const S bend = l * q / (S(2) * tension);
    Place at = {l * arc, -bend * l * arc * arc / S(2), bend * arc};
    S stretch = l;
    const auto moved = [](const Place& from, const S& by, const Place& d) {
      return Place{from.r + by * d.r, from.z + by * d.z, from.phi + by * d.phi};
    };
    for (int k = 0; k < steps; ++k) {
      const S half = step / S(2);
      const Place a = change(arc, at, q, stretch);
      const Place b = change(arc + half, moved(at, half, a), q, stretch);
      const Place c = change(arc + half, moved(at, half, b), q, stretch);
      const Place d = change(arc + step, moved(at, step, c), q, stretch);
      const Place sum = moved(moved(moved(a, S(2), b), S(2), c), S(1), d);
      at = moved(at, step / S(6), sum);
      arc = arc + step;
      if (!(value(at.phi) < 3) || !(value(at.r) > 0)) {
        return {S(0), S(0), S(0)};
      }
      if (points != nullptr) {
        points->push_back({at.r, at.z});
      }
    }
    return at;
  }

  StressFreeCap<S> cap_;
  S bend_mm_ = S(0), arc_mm_ = S(0);
};

}  // namespace v1
}  // namespace fingerpad
