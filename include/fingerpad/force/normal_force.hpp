// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Normal force by look-up: from how large the contact is, or how deep. Source: Ito, Kim and
// Obinata, "Acquisition of Contact Force and Slippage Using a Vision-Based Tactile Sensor with a
// Fluid-Type Touchpad for the Dexterous Handling of Robots", "Method for measuring normal force":
//
//   F_z = p_in S_c                                                   (2)
//   F_z = F_S(S_c) or F_D(D), quadratic                              (3), (18)
//   r_c = c f^gamma, for elastic pads                                (1)
//   F_z = gain F + slope |d| + offset, displaced or rotated           (21), (22)
//
// Pressure, contact area and depth rise together, so one of them tells the force once a calibration
// has tied them (calibrate/force.hpp). A curve holds for objects of the shape that it was
// calibrated with: docs/force/normal_force.md has what another shape does.
//
// The force is that which presses, >= 0 (its z component on the pad is the negative of it). It is 0
// without contact, whatever moved, and rises from there without a step.
#include <cmath>
#include <cstddef>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/compensation.hpp"
#include "fingerpad/force/force_curve.hpp"
#include "fingerpad/force/force_errors.hpp"
#include "fingerpad/force/force_status.hpp"
#include "fingerpad/force/sample_block.hpp"

namespace fingerpad {
inline namespace v0 {

template <scalar S = double>
struct [[nodiscard]] NormalForceResult {
  ForceStatus status = ForceStatus::not_finite;
  S force_n = not_a_number<S>();      ///< >= 0; NaN only where not finite
  S variance_n2 = not_a_number<S>();  ///< NaN without CurveErrors; beyond the range it is that of
                                      ///< the curve carried on as it is, and grows fast

  bool has_force() const { return status != ForceStatus::not_finite; }
};

/// The normal force from one measure of the contact: `Curve` PolynomialForce (of area in mm^2 or of
/// depth in mm) or PowerLawForce (of the radius in mm); `Compensation` none, ScaledCompensation or
/// PublishedCompensation; `Errors` none or CurveErrors. Const, O(1), no memory from the heap.
template <class Curve = PolynomialForce<>,
          class Compensation = NoCompensation,
          class Errors = NoErrors>
class NormalForce {
 public:
  using S = typename Curve::number;

  /// Refuses bad parameters (parameter_error).
  explicit NormalForce(const Curve& curve,
                       const Compensation& compensation = {},
                       const Errors& errors = {})
      : curve_(checked(curve)), compensation_(compensation), errors_(errors) {
    expects_valid(compensation);
    expects_valid(errors);
  }

  /// One frame. `displacement_mm` and `rotation_rad` are how far the contact was carried along and
  /// rotated; without a compensation they are not looked at.
  NormalForceResult<S> operator()(const S& measure,
                                  const Point2<S>& displacement_mm = {S(0), S(0)},
                                  const S& rotation_rad = S(0)) const {
    NormalForceResult<S> result;
    if (!is_finite(measure) || !knows_motion(displacement_mm, rotation_rad)) {
      return result;
    }
    const ForceChange<S> change = change_by(displacement_mm, rotation_rad);
    const S force = force_of(measure, change);
    if (!is_finite(force)) {  // too large for a number
      return result;
    }
    result.force_n = value(force) > 0 ? force : S(0);
    result.status = value(measure) <= 0                    ? ForceStatus::no_contact
                    : value(force) < 0                     ? ForceStatus::held_at_zero
                    : value(measure) < value(curve().from) ? ForceStatus::below_range
                    : value(measure) > value(curve().to)   ? ForceStatus::beyond_range
                                                           : ForceStatus::measured;
    if constexpr (Errors::known) {
      auto gradient = curve().gradient(value(measure) > 0 ? measure : S(0));
      const S gain = change.gain * curve_.fade(measure);
      for (S& by_parameter : gradient) {
        by_parameter = by_parameter * gain;
      }
      const S slope =
          S(change.gain * curve_.slope(measure)) + S(change.shift_n * curve_.fade_slope(measure));
      result.variance_n2 = errors_.variance_n2(gradient, slope);
    }
    return result;
  }

  /// Many frames: `samples` has a row for each, with the measure in column 0 and, for a
  /// compensation, the displacement's x and y and the angle in columns 1 to 3; `forces_n` has one
  /// column. NaN where there is no answer. O(rows), vector code where the compiler can.
  template <grid Samples, writable_grid<S> Forces>
  SampleCounts for_samples(const Samples& samples, Forces&& forces_n) const {
    constexpr std::size_t needed = Compensation::reads_motion ? 4 : 1;
    const auto in = as_view(samples);
    const auto out = as_view(forces_n);
    SampleCounts counts;
    if (in.cols() < static_cast<Index>(needed) || out.cols() != 1 || out.rows() != in.rows()) {
      return counts;
    }
    counts.status = FrameStatus::ok;
    detail::for_each_block<S, needed, 1>(in, out, [&](const auto& block, auto& forces) {
      int not_finite = 0, beyond = 0;
      for (std::size_t k = 0; k < block.size; ++k) {
        const S& measure = block.column[0][k];
        bool known = is_finite(measure);
        ForceChange<S> change{S(1), S(0)};
        if constexpr (Compensation::reads_motion) {
          const Point2<S> displacement{block.column[1][k], block.column[2][k]};
          known = known & knows_motion(displacement, block.column[3][k]);
          change = change_by(displacement, block.column[3][k]);
        }
        const S force = force_of(measure, change);
        known = known & is_finite(force);
        const S held = value(force) > 0 ? force : S(0);
        forces.column[0][k] = known ? held : not_a_number<S>();
        not_finite += static_cast<int>(!known);
        beyond += static_cast<int>(known) & static_cast<int>(value(measure) > value(curve().to));
      }
      counts.not_finite += not_finite;
      counts.beyond_range += beyond;
    });
    return counts;
  }

  const Curve& curve() const { return curve_.curve(); }

 private:
  static const Curve& checked(const Curve& curve) {
    expects_valid(curve);
    return curve;
  }
  static bool knows_motion(const Point2<S>& displacement_mm, const S& rotation_rad) {
    if constexpr (Compensation::reads_motion) {
      const S size_sq = square(displacement_mm.x) + square(displacement_mm.y);
      return is_finite(S(size_sq + square(rotation_rad)));
    } else {
      return true;
    }
  }
  ForceChange<S> change_by(const Point2<S>& displacement_mm, const S& rotation_rad) const {
    if constexpr (Compensation::reads_motion) {
      const S size_sq = square(displacement_mm.x) + square(displacement_mm.y);
      return compensation_(size_sq, rotation_rad);
    } else {
      return {S(1), S(0)};
    }
  }
  /// What the compensation adds fades with the contact, too.
  S force_of(const S& measure, const ForceChange<S>& change) const {
    if constexpr (Compensation::reads_motion) {
      const S shift = change.shift_n * curve_.fade(measure);
      return S(S(change.gain * curve_.force_n(measure)) + shift);
    } else {  // times 1 and plus 0 would not be left out by itself
      return curve_.force_n(measure);
    }
  }

  detail::WholeCurve<Curve> curve_;
  Compensation compensation_;
  Errors errors_;
};

/// A force from two measures.
template <scalar S = double>
struct [[nodiscard]] FusedForce {
  S force_n = not_a_number<S>();
  S variance_n2 = not_a_number<S>();
  S disagreement = not_a_number<S>();  ///< difference over its standard deviation: beyond 3 or so
                                       ///< the contact is not like those of the calibration
  int sources = 0;                     ///< how many of the two took part
};

/// Forces by area and by depth combined by their variances, whose errors are taken for independent.
/// One without a force or without a variance does not take part.
template <scalar S>
FusedForce<S> fused(const NormalForceResult<S>& a, const NormalForceResult<S>& b) {
  using std::sqrt;
  const bool with_a = a.has_force() && is_finite(a.variance_n2);
  const bool with_b = b.has_force() && is_finite(b.variance_n2);
  if (!with_a || !with_b) {
    const NormalForceResult<S>& one = with_a ? a : b;
    return with_a || with_b ? FusedForce<S>{one.force_n, one.variance_n2, not_a_number<S>(), 1}
                            : FusedForce<S>{};
  }
  const S sum = a.variance_n2 + b.variance_n2;
  const S difference = a.force_n - b.force_n;
  if (!(value(sum) > 0)) {
    const S mean = S(a.force_n + b.force_n) / S(2);
    return {mean, S(0), value(difference) == 0 ? S(0) : not_a_number<S>(), 2};
  }
  const S share_of_a = b.variance_n2 / sum;
  return {S(b.force_n + S(share_of_a * difference)), S(share_of_a * a.variance_n2),
          S(difference / S(sqrt(sum))), 2};
}

}  // namespace v0
}  // namespace fingerpad
