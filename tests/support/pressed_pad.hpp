// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Round membranes whose tension is known in closed form, and side dots of a given pull. The
// membrane meets a flat object of radius r_c without a kink; the part between r_c and r is in
// balance by itself (r, inclination phi, tension f_v along the slope):
//   f_v 2 pi r sin(phi) = p pi (r^2 - r_c^2).
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "height_map.hpp"
#include "pad.hpp"
#include "soap_film.hpp"

namespace test {

/// A membrane of revolution. The profile provides
///   height(r), slope(r) < 0, touches(r).
template <class Profile>
struct RoundPad : Profile {
  double x_mm = 0;  ///< of the axis
  double y_mm = 0;

  template <class S>
  MembranePoint<S> operator()(const S& x, const S& y) const {
    const double u = static_cast<double>(x) - x_mm;
    const double v = static_cast<double>(y) - y_mm;
    const double r = std::hypot(u, v);
    const double slope = this->slope(r);
    const double share = r > 0 ? slope / r : 0;
    return {S(this->height(r)), S(share * u), S(share * v)};
  }
  template <class S>
  bool in_contact(const S& x, const S& y) const {
    return this->touches(std::hypot(static_cast<double>(x) - x_mm, static_cast<double>(y) - y_mm));
  }
  double sine(double r) const {
    const double t = -this->slope(r);
    return t / std::sqrt(1 + t * t);
  }
  /// f_v from the balance, N/mm.
  double tension(double r, double pressure_mpa) const {
    const double contact = this->contact_mm;
    return pressure_mpa * (r * r - contact * contact) / (2 * r * sine(r));
  }
};

/// Flat in the middle, with a circular arc from there down to the rim.
struct ArcSide {
  double radius_mm = 18.735;
  double contact_mm = 8;
  double height_mm = 9;

  double bend_mm() const {
    const double wide = radius_mm - contact_mm;
    return (wide * wide + height_mm * height_mm) / (2 * height_mm);
  }
  double height(double r) const {
    const double s = r - contact_mm;
    if (!(r <= radius_mm + 1e-9)) {
      return nan;
    }
    return s <= 0 ? height_mm : height_mm - bend_mm() + std::sqrt(bend_mm() * bend_mm() - s * s);
  }
  double slope(double r) const {
    const double s = r - contact_mm;
    return s <= 0 ? 0 : -s / std::sqrt(bend_mm() * bend_mm() - s * s);
  }
  bool touches(double r) const { return r <= contact_mm; }
};

/// A uniform tension, as in a soap film: sin(phi) = L (r - r_c^2 / r), f_v = p / (2 L).
struct FilmSide {
  double radius_mm = 18.735;
  double contact_mm = 8;
  double rim_sine = 0.9;

  double curvature_per_mm() const {
    return rim_sine / (radius_mm - contact_mm * contact_mm / radius_mm);
  }
  double slope(double r) const {
    const double sine =
        r <= contact_mm ? 0 : curvature_per_mm() * (r - contact_mm * contact_mm / r);
    return -sine / std::sqrt(1 - sine * sine);
  }
  /// Height by 4-point Gauss quadrature in each of 16 steps from the rim.
  double height(double r) const {
    if (!(r <= radius_mm + 1e-9)) {
      return nan;
    }
    const double from = r < contact_mm ? contact_mm : r;
    const double step = (radius_mm - from) / 16;
    double z = 0;
    for (int k = 0; k < 16; ++k) {
      const double middle = from + (k + 0.5) * step;
      for (const auto& [at, weight] : {std::pair{0.8611363115940526, 0.3478548451374538},
                                       {0.3399810435848563, 0.6521451548625461}}) {
        z -= (slope(middle + at * step / 2) + slope(middle - at * step / 2)) * weight * step / 2;
      }
    }
    return z;
  }
  bool touches(double r) const { return r <= contact_mm; }
};

/// Tensions at the rim, N/mm: along the slope of the membrane and along the rim (counterclockwise).
struct RimLoad {
  double normal = 0.2;
  double shear = 0;
};

/// A rim and the parameters of its side dots.
struct RimOfDots {
  double radius_mm = 18.735;
  double length_mm = 0.8;         ///< of an unstressed side dot
  double modulus_n_per_mm = 0.5;  ///< mu t
  double rise = 2;                ///< tan of the membrane's inclination at the rim
  double bend_per_mm = 0;         ///< of the material line through both rows of dots
  Index count = 72;

  double angle(Index k) const {
    return 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
  }
  fingerpad::Point3<double> border(Index k) const {
    return {radius_mm * std::cos(angle(k)), radius_mm * std::sin(angle(k)), 0};
  }
  fingerpad::Point3<double> tangent(Index k) const {
    return {-std::sin(angle(k)), std::cos(angle(k)), 0};
  }
  /// Unit vector up the membrane.
  fingerpad::Point3<double> upward(Index k) const {
    const double c = 1 / std::sqrt(1 + rise * rise);
    return {-c * std::cos(angle(k)), -c * std::sin(angle(k)), c * rise};
  }
  /// Force per length on the base.
  fingerpad::Point3<double> pull(Index k, const RimLoad& load) const {
    const auto m = upward(k), e = tangent(k);
    return {load.normal * m.x + load.shear * e.x, load.normal * m.y + load.shear * e.y,
            load.normal * m.z};
  }
  /// Stretch for this normal tension.
  double stretch(double normal_n_per_mm) const {
    const double wanted = normal_n_per_mm / modulus_n_per_mm;
    double l = 1 + wanted / 4;
    for (int k = 0; k < 60; ++k) {
      const double cube = l * l * l;
      l -= (l - 1 / cube - wanted) / (1 + 3 / (cube * l));
    }
    return l;
  }
  /// d of rim-traction: shear along e, stretch along m.
  fingerpad::Point3<double> along(Index k, const RimLoad& load) const {
    const auto m = upward(k), e = tangent(k);
    const double l = stretch(load.normal), s = load.shear / modulus_n_per_mm;
    return {l * m.x + s * e.x, l * m.y + s * e.y, l * m.z};
  }

  Image<fingerpad::Point3<double>> borders() const {
    Image<fingerpad::Point3<double>> out(1, count, {0, 0, 0});
    for (Index k = 0; k < count; ++k) {
      out(0, k) = border(k);
    }
    return out;
  }
  /// Side dots of the pull `load(angle)`, in one row or more.
  template <class Load>
  Image<fingerpad::Point3<double>> dots(const Load& load, Index rows = 1) const {
    Image<fingerpad::Point3<double>> out(rows, count, {0, 0, 0});
    for (Index k = 0; k < count; ++k) {
      const auto d = along(k, load(angle(k))), b = border(k);
      for (Index r = 0; r < rows; ++r) {
        const double s = static_cast<double>(r + 1) * length_mm;
        const double bent = bend_per_mm * s * s;
        out(r, k) = {b.x + s * d.x, b.y + s * d.y, b.z + s * d.z - bent};
      }
    }
    return out;
  }
};

/// Force and moment about Q that the rim of `dots` and the pressure exert.
struct Wrench6 {
  fingerpad::Point3<double> force_n{0, 0, 0};
  fingerpad::Point3<double> moment_n_mm{0, 0, 0};
};

template <class Load>
Wrench6 wrench_of(const RimOfDots& rim, const Load& load, double pressure_mpa) {
  Wrench6 w;
  RimOfDots fine = rim;
  fine.count = 7200;  // for the integral of a smooth function over a circle
  const double step = 2 * std::numbers::pi * rim.radius_mm / static_cast<double>(fine.count);
  for (Index k = 0; k < fine.count; ++k) {
    const auto f = step * fine.pull(k, load(fine.angle(k)));
    w.force_n = w.force_n + f;
    w.moment_n_mm = w.moment_n_mm + cross(fine.border(k), f);
  }
  w.force_n.z -= pressure_mpa * std::numbers::pi * rim.radius_mm * rim.radius_mm;
  return w;
}

/// Pressure of all wrench tests with an exact shape: 10 kPa.
constexpr double pressed_mpa = 0.01;

/// Rim of a pad for its side dots.
template <class Pad>
RimOfDots rim_of(const Pad& pad) {
  RimOfDots rim;
  rim.radius_mm = pad.radius_mm;
  rim.rise = -pad.slope(pad.radius_mm);
  return rim;
}

}  // namespace test
