// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Normal force by look-up from the area, depth or radius of the contact. Source: Ito, Kim and
// Obinata, "Acquisition of Contact Force and Slippage Using a Vision-Based Tactile Sensor with a
// Fluid-Type Touchpad for the Dexterous Handling of Robots", "Method for measuring normal force":
//
//   F_z = p_in S_c                                                   (2)
//   F_z = F_S(S_c) or F_D(D), quadratic                              (3), (18)
//   r_c = c f^gamma, for elastic pads                                (1)
//
// Pressure, contact area and depth rise together, so any one of them gives the force after a
// calibration (calibrate/force.hpp). A curve holds for objects of the shape with which it was
// calibrated; docs/force/normal_force.md shows the effect of other shapes.
//
// The force is how hard the object presses, >= 0; on the pad it points along -z. Without contact it
// is 0, whatever the displacement, and it rises from there without a step.
#include <cmath>
#include <cstddef>
#include <optional>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/force_curve.hpp"
#include "fingerpad/force/force_status.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

/// 3 x^2 - 2 x^3, with x limited to 1. It rises from 0 at x = 0 to 1 at x = 1, with slope 0 at
/// both, and stays 1 beyond.
template <scalar S>
S smooth_step(const S& share) {
  const S x = value(share) < 1 ? share : S(1);
  return S(x * x * (S(3) - S(2) * x));
}
template <scalar S>
S smooth_step_slope(const S& share) {
  const S x = value(share) < 1 ? share : S(1);
  return S(S(6) * x * (S(1) - x));
}

/// Effect of a displacement and a rotation on the plain force: gain F + shift.
template <scalar S>
struct ForceChange {
  S gain;
  S shift_n;
};

/// A curve extended to all measures: 0 without contact, faded in smoothly below the calibrated
/// range, and continued along its tangent beyond it, because a polynomial may turn anywhere.
template <class Curve>
class WholeCurve {
 public:
  using S = typename Curve::number;

  explicit WholeCurve(const Curve& curve)
      : curve_(curve),
        end_slope_(curve.slope(curve.to)),
        one_over_from_(value(curve.from) > value(S(1e-30)) ? S(S(1) / curve.from) : S(1e30)) {}

  const Curve& curve() const { return curve_; }

  /// Treats NaN like no contact: check the measure first.
  S force_n(const S& measure) const {
    return S((curve_.force_n(held_within(measure)) + end_slope_ * beyond(measure)) * fade(measure));
  }
  /// dF/dm.
  S slope(const S& measure) const {
    const S held = held_within(measure);
    return S(curve_.slope(held) * fade(measure) + curve_.force_n(held) * fade_slope(measure));
  }
  /// Derivatives of F by the curve's parameters.
  auto gradient(const S& measure) const {
    const S held = held_within(measure), past = beyond(measure), faded = fade(measure);
    auto gradient = curve_.gradient(held);
    const auto steeper = curve_.slope_gradient(held);
    for (std::size_t k = 0; k < gradient.size(); ++k) {
      gradient[k] = (gradient[k] + past * steeper[k]) * faded;
    }
    return gradient;
  }
  /// Difference between the curve and its tangent beyond the range, else 0. Nothing shows which of
  /// the two is right.
  S bend_n(const S& measure) const {
    return value(beyond(measure)) > 0 ? S(curve_.force_n(measure) - force_n(measure)) : S(0);
  }
  /// The share of the force that is faded in, in [0, 1]; 1 from the start of the range on.
  S fade(const S& measure) const { return smooth_step(S(held_within(measure) * one_over_from_)); }
  S fade_slope(const S& measure) const {
    return S(smooth_step_slope(S(held_within(measure) * one_over_from_)) * one_over_from_);
  }

 private:
  S held_within(const S& measure) const {
    const S above = value(measure) > 0 ? measure : S(0);
    return value(above) <= value(curve_.to) ? above : curve_.to;
  }
  S beyond(const S& measure) const {
    return value(measure) > value(curve_.to) ? S(measure - curve_.to) : S(0);
  }

  Curve curve_;
  S end_slope_;
  S one_over_from_;
};

}  // namespace detail

/// No compensation: displacement and angle are ignored. For contacts that are only pressed.
struct NoCompensation {
  static constexpr bool reads_motion = false;
};

/// F = F_plain (1 + a |d|^2 + b theta^2). Without displacement and rotation it is the plain force.
/// It handles both at once, and is even and smooth in both, as the symmetry of a round pad
/// requires. The published form (eqs. 21 and 22, published/normal_force.hpp) has none of these
/// properties.
template <scalar S = double>
struct ScaledCompensation {
  static constexpr bool reads_motion = true;

  S per_mm_sq = S(0);   ///< a, 1/mm^2, finite
  S per_rad_sq = S(0);  ///< b, 1/rad^2, finite

  detail::ForceChange<S> operator()(const S& displacement_sq_mm2, const S& rotation_rad) const {
    return {S(S(1) + per_mm_sq * displacement_sq_mm2 + per_rad_sq * rotation_rad * rotation_rad),
            S(0)};
  }
};

/// Refuses values out of range (parameter_error).
inline void expects_valid(const NoCompensation&) {}
template <scalar S>
void expects_valid(const ScaledCompensation<S>& compensation) {
  expects(is_finite(compensation.per_mm_sq), "ScaledCompensation", "per_mm_sq",
          compensation.per_mm_sq, "finite");
  expects(is_finite(compensation.per_rad_sq), "ScaledCompensation", "per_rad_sq",
          compensation.per_rad_sq, "finite");
}

template <scalar S = double>
struct [[nodiscard]] NormalForceResult {
  ForceStatus status = ForceStatus::not_finite;
  S force_n = not_a_number<S>();      ///< >= 0; NaN only if not_finite
  S variance_n2 = not_a_number<S>();  ///< NaN without CurveErrors; beyond the range, that of the
                                      ///< tangent plus the square of its difference from the curve

  /// Whether the calibration covers the force.
  bool ok() const { return status == ForceStatus::measured || status == ForceStatus::no_contact; }
  bool has_force() const { return status != ForceStatus::not_finite; }
};

/// The normal force from one measure of the contact.
///   Curve         PolynomialForce     use it for fluid pads: of area in mm^2 or depth in mm
///                 PowerLawForce       use it for elastic pads: of the radius in mm
///   Compensation  NoCompensation      use it if the contact is only pressed
///                 ScaledCompensation  use it if the contact is also displaced or rotated, and the
///                                     calibration includes that
/// A call is const, O(1), and allocates nothing.
template <class Curve = PolynomialForce<>, class Compensation = NoCompensation>
class NormalForce {
 public:
  using S = typename Curve::number;
  using Errors = CurveErrors<Curve::parameters, S>;

  /// Without `errors` results have no variance. Refuses bad parameters (parameter_error).
  explicit NormalForce(const Curve& curve, const Compensation& compensation = {})
      : curve_(checked(curve)), compensation_(compensation) {
    expects_valid(compensation);
  }
  NormalForce(const Curve& curve, const Compensation& compensation, const Errors& errors)
      : NormalForce(curve, compensation) {
    expects_valid(errors);
    errors_ = errors;
  }

  /// The force of one frame. `displacement_mm` and `rotation_rad` are those of the contact;
  /// NoCompensation ignores them. `measure_variance` is the variance of this measure in addition to
  /// that of the calibration.
  NormalForceResult<S> operator()(const S& measure,
                                  const Point2<S>& displacement_mm = {S(0), S(0)},
                                  const S& rotation_rad = S(0),
                                  const S& measure_variance = S(0)) const {
    NormalForceResult<S> result;
    const detail::ForceChange<S> change = change_by(displacement_mm, rotation_rad);
    const S force = force_of(measure, change);
    if (!is_finite(measure) || !is_finite(force)) {
      return result;
    }
    result.force_n = value(force) > 0 ? force : S(0);
    result.status = value(measure) <= 0 ? ForceStatus::no_contact
                    : detail::beyond_all(measure) || detail::beyond_all(force) ||
                            is_wild(displacement_mm, rotation_rad)
                        ? ForceStatus::implausible
                    : value(force) < 0                     ? ForceStatus::held_at_zero
                    : value(measure) < value(curve().from) ? ForceStatus::below_range
                    : value(measure) > value(curve().to)   ? ForceStatus::beyond_range
                                                           : ForceStatus::measured;
    if (errors_) {
      result.variance_n2 = variance_n2(measure, change, measure_variance);
    }
    return result;
  }

  const Curve& curve() const { return curve_.curve(); }

 private:
  static const Curve& checked(const Curve& curve) {
    expects_valid(curve);
    return curve;
  }

  static bool is_wild(const Point2<S>& displacement_mm, const S& rotation_rad) {
    return Compensation::reads_motion &&
           (detail::beyond_displacement(displacement_mm) || detail::beyond_rotation(rotation_rad));
  }

  detail::ForceChange<S> change_by(const Point2<S>& displacement_mm, const S& rotation_rad) const {
    if constexpr (Compensation::reads_motion) {
      return compensation_(squared_norm(displacement_mm), rotation_rad);
    } else {
      return {S(1), S(0)};
    }
  }

  /// The shift of the compensation fades with the contact, too.
  S force_of(const S& measure, const detail::ForceChange<S>& change) const {
    if constexpr (Compensation::reads_motion) {
      return S(change.gain * curve_.force_n(measure) + change.shift_n * curve_.fade(measure));
    } else {  // the compiler would not leave out times 1 and plus 0
      return curve_.force_n(measure);
    }
  }

  [[gnu::pure]] S variance_n2(const S& measure,
                              const detail::ForceChange<S>& change,
                              const S& measure_variance) const {
    auto gradient = curve_.gradient(measure);
    for (S& by_parameter : gradient) {
      by_parameter = by_parameter * change.gain;
    }
    const S slope =
        change.gain * curve_.slope(measure) + change.shift_n * curve_.fade_slope(measure);
    const S bend = change.gain * curve_.bend_n(measure);
    return S(errors_->variance_n2(gradient, slope) + slope * slope * measure_variance +
             bend * bend);
  }

  detail::WholeCurve<Curve> curve_;
  Compensation compensation_;
  std::optional<Errors> errors_;
};

/// A force from two measures.
template <scalar S = double>
struct [[nodiscard]] FusedForce {
  ForceStatus status = ForceStatus::not_finite;  ///< the worse of those that took part, or
                                                 ///< disagreeing
  S force_n = not_a_number<S>();
  S variance_n2 = not_a_number<S>();
  S disagreement = not_a_number<S>();  ///< difference of the two forces over its standard deviation
  int sources = 0;                     ///< how many of the two measures took part

  /// Whether the calibration covers the force.
  bool ok() const { return status == ForceStatus::measured || status == ForceStatus::no_contact; }
  bool has_force() const { return is_finite(force_n); }
};

/// Combines the forces by area and by depth, weighted by their variances; their errors are assumed
/// to be independent. A force that is NaN or has no variance does not take part, but an implausible
/// one makes the result implausible. Two forces that differ by more than `max_disagreement`
/// standard deviations are disagreeing.
template <scalar S>
FusedForce<S> fused(const NormalForceResult<S>& a,
                    const NormalForceResult<S>& b,
                    double max_disagreement = 3) {
  using std::sqrt;
  const bool with_a = a.has_force() && is_finite(a.variance_n2);
  const bool with_b = b.has_force() && is_finite(b.variance_n2);
  if (!with_a || !with_b) {
    const NormalForceResult<S>& one = with_a ? a : b;
    const bool wild = a.status == ForceStatus::implausible || b.status == ForceStatus::implausible;
    const int sources = with_a || with_b ? 1 : 0;
    return {wild           ? ForceStatus::implausible
            : sources == 1 ? one.status
                           : ForceStatus::not_finite,
            sources == 1 ? one.force_n : not_a_number<S>(),
            sources == 1 ? one.variance_n2 : not_a_number<S>(), not_a_number<S>(), sources};
  }
  const S sum = a.variance_n2 + b.variance_n2;
  const S difference = a.force_n - b.force_n;
  const bool exact = !(value(sum) > 0);
  const S share_of_a = exact ? S(S(1) / S(2)) : S(b.variance_n2 / sum);
  const S disagreement = value(difference) == 0 ? S(0)
                         : exact                ? not_a_number<S>()
                                                : S(difference / S(sqrt(sum)));
  const S most = S(max_disagreement);
  const bool agree = disagreement * disagreement <= most * most;
  const ForceStatus worst = detail::worse(a.status, b.status);
  return {agree ? worst : detail::worse(worst, ForceStatus::disagreeing),
          S(b.force_n + share_of_a * difference), S(share_of_a * a.variance_n2), disagreement, 2};
}

}  // namespace v0
}  // namespace fingerpad
