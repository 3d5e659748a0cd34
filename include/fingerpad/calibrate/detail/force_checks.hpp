// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Selects the force samples that a fit can use, and detects mistakes in them. See
// calibrate/force.hpp.
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/calibrate/detail/model_fit.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The samples that a fit can use, and their indices among the given ones.
template <class Sample>
struct UsableSamples {
  std::vector<Sample> samples;
  std::vector<std::size_t> places;
};

template <class Sample, class Usable>
UsableSamples<Sample> usable_samples(std::span<const Sample> samples, const Usable& usable) {
  UsableSamples<Sample> result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& s = samples[i];
    if (is_finite(s.measure) && value(s.measure) > 0 && usable(s)) {
      result.samples.push_back(s);
      result.places.push_back(i);
    }
  }
  return result;
}

template <class Sample>
bool has_finite_motion(const Sample& s) {
  return is_finite(s.displacement_mm) && is_finite(s.rotation_rad);
}

/// Quantities whose units are checked.
struct UnitsLookedAt {
  bool normal = false;
  bool tangential = false;
  bool displacement = false;
  bool rotation = false;
  bool moment = false;
};

/// Detects a quantity in a wrong unit. The bounds hold for every fingertip. A contact of 0.05 mm or
/// 0.05 mm^2 is not visible, and none is larger than 10000 mm^2 or displaced by 100 mm. A
/// calibration exceeds 0.05 N of normal and 0.01 N of tangential force, and 300 N are more than the
/// force of 0.2 MPa on a pad of 40 mm. A moment has a lever between 0.05 and 100 mm.
template <class Sample>
const char* unit_mistake(const std::vector<Sample>& samples, const UnitsLookedAt& looked_at) {
  double measure = 0, displacement = 0, rotation = 0, force = 0, aside = 0, moment = 0;
  const auto raise = [](double& largest, const auto& x) {
    const double size = std::abs(static_cast<double>(value(x)));
    largest = size > largest && is_finite(size) ? size : largest;
  };
  for (const Sample& s : samples) {
    raise(measure, s.measure);
    raise(displacement, s.displacement_mm.x);
    raise(displacement, s.displacement_mm.y);
    raise(rotation, s.rotation_rad);
    raise(force, s.normal_force_n);
    raise(aside, s.tangential_force_n.x);
    raise(aside, s.tangential_force_n.y);
    raise(moment, s.moment_n_mm);
  }
  if (measure < 0.05 || measure > 1e4) {
    return "no measure reaches 0.05, or one exceeds 10000: give areas in mm^2, depths and radii "
           "in mm";
  }
  if ((looked_at.normal && (force < 0.05 || force > 300)) ||
      (looked_at.tangential && (aside < 0.01 || aside > 300))) {
    return "no force reaches 0.05 (along the pad 0.01), or one exceeds 300: give forces in N";
  }
  if (looked_at.displacement && (displacement < 0.01 || displacement > 100)) {
    return "no displacement reaches 0.01, or one exceeds 100: give displacements in mm";
  }
  if (looked_at.rotation && rotation > 1.6) {
    return "a rotation exceeds a right angle: give rotations in rad";
  }
  const bool lever = moment >= 0.05 * force && (moment <= 100 * force || force <= 0);
  return looked_at.moment && !lever
             ? "moments are below 0.05 mm or above 100 mm times the normal force: "
               "give moments in N mm"
             : nullptr;
}

/// The likely mistake; nullptr: none. Causes of wrong parameters come before causes of inexact
/// ones. An outlier is a sample more than ten standard deviations off that makes up most of the
/// residual.
template <scalar S>
const char* cause_in(const ModelFit<S>& fit,
                     const char* units,
                     const char* mistake,
                     const FitOptions& options) {
  if (units != nullptr || mistake != nullptr) {
    return units != nullptr ? units : mistake;
  }
  if (!fit.converged) {
    return cause::not_converged;
  }
  const bool is_most = value(S(S(2) * fit.worst_sq)) > value(fit.left_sq);
  const bool is_off = !options.robust && is_most && value(fit.worst_sds) > 10;
  return is_off ? "a sample is far from the others: check its dots and its gauge reading, "
                  "or fit robustly"
                : nullptr;
}

/// "; " and the likely cause, for refusals.
inline std::string cause_of(const char* mistake) {
  return mistake == nullptr ? std::string() : std::string("; ") + mistake;
}

template <scalar S, class Residual>
void add_residuals(const ModelFit<S>& fit,
                   const typename ModelFit<S>::Vector& measured,
                   const std::vector<std::size_t>& places,
                   std::vector<Residual>& residuals) {
  for (Index i = 0; i < measured.size(); ++i) {
    residuals.push_back({places[static_cast<std::size_t>(i)], measured(i),
                         S(measured(i) - fit.residuals(i)), fit.weights(i)});
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
