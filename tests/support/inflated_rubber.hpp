// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A cap of Mooney-Rivlin rubber that is inflated and then twisted a little, from its energy alone:
// tensions are numerical derivatives of the energy, and the profile is integrated from the apex by
// the balance along and across it. Energy per mu t, with C = F^T F and J^2 = det C:
//   w = (1 - m) / 2 (tr C + J^-2 - 3) + m / 2 (tr C / J^2 + J^2 - 3)
#include <cmath>
#include <vector>

namespace test {

struct InflatedRubber {
  double mooney_share = 0;
  double modulus_n_per_mm = 0.5;  ///< mu t
  double radius_mm = 18.735;
  double height_mm = 11;  ///< stress-free
  double pressure_mpa = 0.016;

  /// Energy per mu t of stretches along and around the meridian and of the shear between them.
  double energy(double along, double around, double shear) const {
    const double trace = along * along + shear * shear + around * around;
    const double area_sq = along * along * around * around;
    const double m = mooney_share;
    return (1 - m) / 2 * (trace + 1 / area_sq - 3) + m / 2 * (trace / area_sq + area_sq - 3);
  }
  /// First derivative of the energy: pull along the meridian per stress-free length.
  double pull_along(double along, double around) const {
    return slope([&](double x) { return energy(x, around, 0); }, along);
  }
  double pull_around(double along, double around) const {
    return slope([&](double x) { return energy(along, x, 0); }, around);
  }
  double shear_pull(double along, double around, double shear) const {
    return slope([&](double x) { return energy(along, around, x); }, shear);
  }

  struct Place {
    double arc, r, z, stretch, inclination, stress_free_r;
  };

  /// Profile from the apex to the rim; z is measured from the base.
  std::vector<Place> profile() const {
    double low = 1.001, high = 1.9;
    std::vector<Place> places;
    for (int k = 0; k < 36; ++k) {
      const double middle = (low + high) / 2;
      places = from_apex(middle);
      (places.back().r < radius_mm ? low : high) = middle;
    }
    const double base = places.back().z;
    for (Place& p : places) {
      p.z -= base;
    }
    return places;
  }

  /// Angle in rad by which the membrane rotates `arc_mm` from the rim if it is sheared by `shear`
  /// at the rim. The torque is the same all along.
  double turn(const std::vector<Place>& places, double shear, double arc_mm) const {
    const Place& rim = places.back();
    const double torque =
        rim.r * rim.stress_free_r * shear_pull(rim.stretch, rim.r / rim.stress_free_r, shear);
    double angle = 0;
    for (std::size_t k = places.size() - 1; k > 0 && rim.arc - places[k].arc < arc_mm; --k) {
      const Place &a = places[k], &b = places[k - 1];
      const double step = std::fmin(a.arc - b.arc, arc_mm - (rim.arc - a.arc));
      const auto rate = [&](const Place& p) {
        const double around = p.r / p.stress_free_r;
        return torque / (p.r * p.stress_free_r * shear_pull(p.stretch, around, 1)) / p.r;
      };
      angle += step * (rate(a) + rate(b)) / 2;
    }
    return angle;
  }

 private:
  template <class F>
  static double slope(const F& f, double x) {
    const double h = 1e-4;
    return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h);
  }

  struct State {
    double r, z, inclination, tension;  ///< per stressed length and mu t
  };

  double stretch_of(double tension, double around) const {
    double along = 1.1;
    for (int k = 0; k < 6; ++k) {
      const double over = pull_along(along, around) - tension * around;
      along -= over / slope([&](double x) { return pull_along(x, around); }, along);
    }
    return along;
  }

  double bend() const { return (radius_mm * radius_mm + height_mm * height_mm) / (2 * height_mm); }

  State change(double arc, const State& s) const {
    const double around = s.r / (bend() * std::sin(arc / bend()));
    const double along = stretch_of(s.tension, around);
    const double hoop = pull_around(along, around) / along;
    const double cosine = std::cos(s.inclination), sine = std::sin(s.inclination);
    const double load = pressure_mpa / modulus_n_per_mm;
    return {along * cosine, -along * sine, along * (load - hoop * sine / s.r) / s.tension,
            along * (hoop - s.tension) * cosine / s.r};
  }

  std::vector<Place> from_apex(double stretch) const {
    constexpr int steps = 300;
    const double whole = 2 * bend() * std::atan(height_mm / radius_mm);
    const double tension = pull_along(stretch, stretch) / stretch;
    double arc = whole / 1e4;
    const double step = (whole - arc) / steps;
    State s = {stretch * arc, 0, pressure_mpa / modulus_n_per_mm / (2 * tension) * stretch * arc,
               tension};
    std::vector<Place> places = {{0, 0, 0, stretch, 0, 0}};
    const auto keep = [&] {
      const double free_r = bend() * std::sin(arc / bend());
      places.push_back({arc, s.r, s.z, stretch_of(s.tension, s.r / free_r), s.inclination, free_r});
    };
    keep();
    const auto moved = [](const State& a, double t, const State& d) {
      return State{a.r + t * d.r, a.z + t * d.z, a.inclination + t * d.inclination,
                   a.tension + t * d.tension};
    };
    for (int k = 0; k < steps && s.r > 0 && s.inclination < 3; ++k) {
      const State a = change(arc, s);
      const State b = change(arc + step / 2, moved(s, step / 2, a));
      s = moved(s, step, b);  // midpoint rule
      arc += step;
      keep();
    }
    if (!(s.inclination < 3) || !(s.r > 0)) {
      places.back().r = 0;
    }
    return places;
  }
};

}  // namespace test
