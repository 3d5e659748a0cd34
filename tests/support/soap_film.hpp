// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Membranes in equilibrium around a contact. A dome cut off by a plane is not in equilibrium,
// because it has a kink at the edge. A free membrane has one mean curvature L and leaves the object
// tangentially. Around a round contact of radius R on an object of mean curvature H, both falling
// with the slope tan(psi), this gives
//   sin(psi) = L rho - (L - H) R^2 / rho                   (rho sin(psi))' = 2 L rho,
// which for small slopes opens a gap of J ((rho^2 - R^2) / 2 - R^2 ln(rho / R)), J = L - H. Across
// a straight edge it is an arc of radius 1 / (2 L), with a gap of J s^2. Over a hole in the object
// or a slit between two objects, the membrane bulges.
#include <cmath>
#include <vector>

#include "fingerpad/optics/camera.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "pad.hpp"

namespace test {

/// Fall of an arc at the distance s from its top; NaN beyond its end.
inline double arc(double curvature_per_mm, double s) {
  const double sine = curvature_per_mm * s;
  return s * sine / (1 + std::sqrt(1 - sine * sine));
}

struct RoundContact {
  double radius_mm = 6;       ///< of the contact; 0: a free pad
  double free_per_mm = 0.05;  ///< L
  double object_per_mm = 0;   ///< H: > 0 for a hollow object, < 0 for a bulging one
  double hole_mm = 0;         ///< radius of a hole in the middle of the object
  double slope = 0;           ///< of the object along x, small
  double top_mm = 10;
  double x_mm = 0;  ///< center
  double y_mm = 0;

  bool touches(double x, double y) const {
    const double rho = std::hypot(x - x_mm, y - y_mm);
    return rho <= radius_mm && rho >= hole_mm;
  }
  double area_mm2() const {
    return 3.14159265358979323846 * (radius_mm * radius_mm - hole_mm * hole_mm);
  }
};

class RoundFilm : public RoundContact {
 public:
  explicit RoundFilm(const RoundContact& contact) : RoundContact(contact) {
    // fall by Simpson's rule in each step
    fall_.push_back(arc(object_per_mm, radius_mm));
    for (double rho = radius_mm; fall_.size() < 3000; rho += step_mm) {
      const double middle = tangent(rho + step_mm / 2);
      fall_.push_back(fall_.back() +
                      step_mm / 6 * (tangent(rho) + 4 * middle + tangent(rho + step_mm)));
    }
  }

  double operator()(double x, double y) const {
    const double rho = std::hypot(x - x_mm, y - y_mm);
    const double top = top_mm + slope * (x - x_mm);
    if (rho > radius_mm) {
      return top - outside(rho);
    }
    const double bulge = rho < hole_mm ? arc(free_per_mm, hole_mm) - arc(free_per_mm, rho) : 0;
    return top - arc(object_per_mm, rho) + bulge;
  }

 private:
  double tangent(double rho) const {
    const double turn = (free_per_mm - object_per_mm) * radius_mm * radius_mm;
    const double sine = free_per_mm * rho - (rho > 0 ? turn / rho : 0);
    return sine / std::sqrt(1 - sine * sine);
  }
  /// Fall outside the contact, cubic between the steps; NaN beyond the rim.
  double outside(double rho) const {
    const double at = (rho - radius_mm) / step_mm;
    if (!(at < static_cast<double>(fall_.size()) - 1)) {
      return nan;
    }
    const auto k = static_cast<std::size_t>(at);
    const double t = at - static_cast<double>(k);
    const double low = radius_mm + step_mm * static_cast<double>(k);
    const double rise = fall_[k + 1] - fall_[k];
    const double before = tangent(low) * step_mm - rise;
    const double after = rise - tangent(low + step_mm) * step_mm;
    return fall_[k] + t * rise + t * (1 - t) * (before * (1 - t) + after * t);
  }

  static constexpr double step_mm = 0.01;
  std::vector<double> fall_;
};

/// Contact where slit_mm <= |x| <= half_mm: one strip, or two on either side of a slit.
struct StripFilm {
  double half_mm = 4;
  double slit_mm = 0;
  double free_per_mm = 0.05;
  double top_mm = 10;

  double operator()(double x, double) const {
    const double s = std::abs(x);
    const double bend = 2 * free_per_mm;
    const double bulge = s < slit_mm ? arc(bend, slit_mm) - arc(bend, s) : 0;
    return top_mm + bulge - (s > half_mm ? arc(bend, s - half_mm) : 0);
  }
  bool touches(double x, double) const { return std::abs(x) >= slit_mm && std::abs(x) <= half_mm; }
};

/// Depth at which the pixel's ray meets the film; NaN where that is below the plate or beyond the
/// film. Rays are steep and films flat, so alternating between the two converges.
template <class CameraType, class Film>
double depth_at_pixel(const CameraType& camera, const Film& film, Index row, Index col) {
  double z = film.top_mm;
  for (int step = 0; step < 60; ++step) {
    const auto p = point_at(camera, static_cast<double>(row), static_cast<double>(col), z);
    const double next = film(p.x, p.y);
    const double change = next - z;
    z = next;
    if (std::abs(change) < 1e-12) {
      break;
    }
  }
  return z > 0 ? z : nan;
}

template <class S, class CameraType, class Film>
Image<S> depths_of(const CameraType& camera, const Film& film, Index rows, Index cols) {
  Image<S> depth(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      depth(i, j) = static_cast<S>(depth_at_pixel(camera, film, i, j));
    }
  }
  return depth;
}

/// Height map of this many pixels with the axis in the middle.
inline fingerpad::OrthographicCamera<double> height_map(Index rows,
                                                        Index cols,
                                                        double pitch_mm = 0.08) {
  return {static_cast<double>(cols - 1) / 2, static_cast<double>(rows - 1) / 2, pitch_mm};
}
inline fingerpad::Camera<double> pad_camera(Index rows, Index cols, double pitch_mm = 0.08) {
  fingerpad::Camera<double> camera;
  camera.center_x_px = static_cast<double>(cols - 1) / 2;
  camera.center_y_px = static_cast<double>(rows - 1) / 2;
  camera.pitch_mm = pitch_mm;
  return camera;
}

}  // namespace test
