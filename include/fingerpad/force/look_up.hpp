// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces by look-up. Source: Ito, Kim and Obinata, "Acquisition of Contact Force and Slippage Using
// a Vision-Based Tactile Sensor with a Fluid-Type Touchpad for the Dexterous Handling of Robots".
//
// Normal force: pressure, area S_c and depth D of the contact rise together, so after a calibration
// (calibrate/look_up.hpp) any one of them gives the force,
//
//   F_z = F_S(S_c) or F_D(D), quadratic                              (3), (18)
//
// It is how hard the object presses, >= 0; on the pad it points along -z. A curve holds for objects
// of the shape with which it was calibrated; docs/force/normal_force.md shows the effect of others.
//
// Tangential force and moment: a larger contact is stiffer, so displacement d and rotation theta of
// the dots are normalised by its size,
//
//   d_nor     = (S_c / S_ref)^T_S d     or (D / D_ref)^T_D d          (4)
//   theta_nor = (S_c / S_ref)^R_S theta or (D / D_ref)^R_D theta      (5)
//
// with (5) corrected (docs/errata.md, E031); "the relationship between the normalized displacement
// and tangential force is almost linear". Both are what the object exerts on the pad: a pad that is
// dragged along x is pushed along x. The moment is about the normal through the center of the
// contact. motion/contact_shift.hpp measures d and theta.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {

/// Statuses from the best to the worst.
enum class ForceStatus : std::uint8_t {
  no_contact,    ///< the measure is 0 or negative: no force, whatever the displacement
  measured,      ///< within the calibrated range
  below_range,   ///< a smaller contact than any in the calibration, for Shear than a hundredth of
                 ///< the reference: the force fades to 0. If always, a measure in another unit?
  beyond_range,  ///< a larger contact or displacement than in the calibration: along the tangent
  held_at_zero,  ///< the curve gives a negative force, which is set to 0
  disagreeing,   ///< the forces by area and by depth differ by more than their errors allow: the
                 ///< contact is unlike those of the calibration, or a measure is in another unit
  implausible,   ///< a displacement above 100 mm, a rotation by more than half a turn, or a measure
                 ///< or force of a million or more: in px, um, degrees?
  not_finite,    ///< an input is not a number, or the force overflows
};
/// "measured", "below range", ...
constexpr const char* name_of(ForceStatus status) {
  constexpr std::array<const char*, 8> names = {"no contact",
                                                "measured",
                                                "below range",
                                                "beyond range",
                                                "held at zero",
                                                "disagreeing",
                                                "implausible: not in mm, rad?",
                                                "not finite"};
  return names[static_cast<std::size_t>(status)];
}

/// F = c_0 + c_1 m + c_2 m^2 + c_3 m^3 in N for a measure m of the contact: its area in mm^2, depth
/// in mm or, on elastic pads, radius in mm. The paper's compensation is published/look_up.hpp.
template <scalar S = double>
struct ForceCurve {
  static constexpr std::size_t size = 4;
  using Coefficients = std::array<S, size>;

  Coefficients coefficients = detail::zeros<S, size>();  ///< c_0 first, finite
  S from = not_a_number<S>();           ///< the smallest measure identified, finite, >= 0
  S to = not_a_number<S>();             ///< the largest, finite, > from
  S residual_sd_n = not_a_number<S>();  ///< standard deviation of a sample about the curve, N,
                                        ///< >= 0; NaN: forces get no variance
  std::array<Coefficients, size> covariance = detail::zero_matrix<S, size>();  ///< of coefficients

  /// The polynomial.
  S force_n(const S& measure) const {
    const auto& [c_0, c_1, c_2, c_3] = coefficients;
    return ((c_3 * measure + c_2) * measure + c_1) * measure + c_0;
  }
  /// Its derivative by the measure.
  S slope(const S& measure) const {
    const auto& [c_0, c_1, c_2, c_3] = coefficients;
    return (S(3) * c_3 * measure + S(2) * c_2) * measure + c_1;
  }
  /// The smallest derivative between `low` and `to`.
  S lowest_slope(const S& low) const {
    const S a = slope(low), b = slope(to), turn = -coefficients[2] / (S(3) * coefficients[3]);
    const S ends = value(a) < value(b) ? a : b;
    const bool within = value(low) < value(turn) && value(turn) < value(to);
    return within && value(slope(turn)) < value(ends) ? slope(turn) : ends;
  }
};

/// Says which parameter has no meaning, or that the force falls while the contact grows.
template <scalar S>
std::string check(const ForceCurve<S>& c) {
  const char* const owner = "ForceCurve";
  const bool has_errors = value(c.residual_sd_n) == value(c.residual_sd_n);
  const double from = static_cast<double>(value(c.from));
  std::string refusal =
      check(owner, {{"from", c.from, not_negative},
                    {"to", c.to, {.min = from, .above_min = true}},
                    {"residual_sd_n", has_errors ? c.residual_sd_n : S(0), not_negative}});
  for (std::size_t k = 0; k < c.size && refusal.empty(); ++k) {
    refusal = check(owner, {{"coefficients", c.coefficients[k], finite_number},
                            {"variance of a coefficient", c.covariance[k][k], not_negative}});
  }
  const S end = c.force_n(c.to);
  const S rounding = S(64 * epsilon<S>()) * (value(end) < 0 ? -end : end) / c.to;  // of a slope
  const S first = from > 0 ? S(0) : c.coefficients[0], slope = c.lowest_slope(c.from) + rounding;
  return !refusal.empty() ? refusal
                          : check(owner, {{"force at to", end, finite_number},
                                          {"c_0 of a curve from 0 on", first, within(0, 0)},
                                          {"slope within the range", slope, not_negative}});
}

/// The normal force of one frame.
template <scalar S = double>
struct [[nodiscard]] ForceResult {
  ForceStatus status = ForceStatus::not_finite;
  S force_n = not_a_number<S>();       ///< >= 0; NaN: not known
  S variance_n2 = not_a_number<S>();   ///< NaN if the curve has no errors; beyond the range that of
                                       ///< the tangent plus its squared distance from the curve
  S disagreement = not_a_number<S>();  ///< of two fused forces: their difference over its standard
                                       ///< deviation

  /// Whether the calibration covers the force.
  bool ok() const { return status <= ForceStatus::measured; }
  bool has_force() const { return is_finite(force_n); }
};

/// The normal force from one measure of the contact. Below the calibrated range the curve is faded
/// in smoothly, so that the force rises without a step; beyond it continues along its tangent,
/// because a polynomial may turn anywhere. A call is const, O(1), and allocates nothing.
template <scalar S = double>
class NormalForce {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit NormalForce(const ForceCurve<S>& curve) : curve_(curve) { require(curve); }

  /// The force of one frame. `measure_variance`, >= 0, is that of this measure in addition to that
  /// of the calibration; the force gets no variance where it is negative or NaN.
  ForceResult<S> operator()(const S& measure, const S& measure_variance = S(0)) const {
    ForceResult<S> result;
    if (!is_finite(measure)) {
      return result;
    }
    const S above = value(measure) > 0 ? measure : S(0);
    const bool past = value(above) > value(curve_.to);
    const S within = past ? curve_.to : above, beyond = past ? above - curve_.to : S(0);
    const bool fades = value(within) < value(curve_.from);
    const S x = fades ? within / curve_.from : S(1), fade = x * x * (S(3) - S(2) * x);
    const S slope = curve_.slope(within), plain_n = curve_.force_n(within) + slope * beyond;
    const S force = fade * plain_n;
    if (!is_finite(force)) {
      return result;
    }
    const bool wild = !is_plausible(measure) || !is_plausible(force);
    result.force_n = value(force) > 0 ? force : S(0);
    result.status = value(measure) <= 0 ? ForceStatus::no_contact
                    : wild              ? ForceStatus::implausible
                    : value(force) < 0  ? ForceStatus::held_at_zero
                    : fades             ? ForceStatus::below_range
                    : past              ? ForceStatus::beyond_range
                                        : ForceStatus::measured;
    if (value(curve_.residual_sd_n) >= 0 && value(measure_variance) >= 0) {
      // the coefficients, what the calibration could not explain, noise of the measure, and the
      // distance of the tangent from the curve, because nothing shows which of them is right
      typename ForceCurve<S>::Coefficients by_coefficient = {fade};
      S power = fade, of_curve = S(0);
      for (std::size_t k = 1; k < curve_.size; ++k) {
        by_coefficient[k] = power * (within + S(static_cast<int>(k)) * beyond);
        power = power * within;
      }
      for (std::size_t i = 0; i < curve_.size; ++i) {
        for (std::size_t j = 0; j < curve_.size; ++j) {
          of_curve = of_curve + by_coefficient[i] * curve_.covariance[i][j] * by_coefficient[j];
        }
      }
      const S fade_slope = fades ? S(6) * x * (S(1) - x) / curve_.from : S(0);
      const S bend = past ? curve_.force_n(measure) - plain_n : S(0);
      result.variance_n2 = (value(of_curve) > 0 ? of_curve : S(0)) + square(curve_.residual_sd_n) +
                           square(fade * slope + fade_slope * plain_n) * measure_variance +
                           square(bend);
    }
    return result;
  }

 private:
  ForceCurve<S> curve_;
};

/// Combines the forces by area and by depth, weighted by their variances; their errors are assumed
/// to be independent. A force that is NaN or has no variance does not take part, but an implausible
/// one makes the result implausible. Two forces that differ by more than three standard deviations
/// are disagreeing.
template <scalar S>
ForceResult<S> fused(const ForceResult<S>& a, const ForceResult<S>& b) {
  using std::sqrt;
  const bool with_a = a.has_force() && is_finite(a.variance_n2);
  const bool with_b = b.has_force() && is_finite(b.variance_n2);
  if (!with_a || !with_b) {
    ForceResult<S> one = with_a ? a : with_b ? b : ForceResult<S>();
    const bool wild = a.status == ForceStatus::implausible || b.status == ForceStatus::implausible;
    one.status = wild ? ForceStatus::implausible : one.status;
    return one;
  }
  const S sum = a.variance_n2 + b.variance_n2, difference = a.force_n - b.force_n;
  const S share_of_a = value(sum) > 0 ? b.variance_n2 / sum : S(1) / S(2);
  const S disagreement = value(difference) == 0 ? S(0) : difference / sqrt(sum);
  const bool agree = value(square(disagreement)) <= 9;
  const ForceStatus apart = agree ? ForceStatus::no_contact : ForceStatus::disagreeing;
  return {(std::max)({a.status, b.status, apart}), b.force_n + share_of_a * difference,
          share_of_a * a.variance_n2, disagreement};
}

/// slope x of a displacement or rotation x that is multiplied by (measure / reference)^exponent.
template <scalar S = double>
struct ShearLaw {
  S slope = not_a_number<S>();  ///< finite, >= 0
  S exponent = S(0);            ///< T or R, finite; > 0 in the paper. 0: the size does not matter
  S to = not_a_number<S>();     ///< the largest |x| identified, > 0; NaN: not known
};

/// Force and moment from displacement and rotation. Elastic pads, by the radius of the contact: the
/// exponents are 1 and 3, because the tangential stiffness of a round contact is proportional to
/// its radius, the torsional one to its cube (Johnson, Contact Mechanics).
template <scalar S = double>
struct ShearMap {
  S reference = S(1);  ///< in the measure's unit, finite, > 0
  ShearLaw<S> force;   ///< N/mm
  ShearLaw<S> moment;  ///< N mm/rad
};

/// Says which parameter has no meaning.
template <scalar S>
std::string check(const ShearMap<S>& m) {
  const char* const owner = "ShearMap";
  std::string refusal = check(owner, {{"reference", m.reference, positive}});
  for (const ShearLaw<S>* law : {&m.force, &m.moment}) {
    const char* const whose = law == &m.force ? "ShearMap: force" : "ShearMap: moment";
    const bool has_end = value(law->to) == value(law->to);
    refusal = refusal.empty() ? check(whose, {{"slope", law->slope, not_negative},
                                              {"exponent", law->exponent, finite_number},
                                              {"to", has_end ? law->to : S(1), positive}})
                              : refusal;
  }
  if (refusal.empty() && value(m.force.slope) > 0 && value(m.moment.slope) > 0) {
    using std::sqrt;
    refusal =
        check(owner, {{"size of the contact from moment over force, in mm for N/mm and N mm/rad,",
                       sqrt(m.moment.slope / m.force.slope), fingerpad::within(0.5, 1000)}});
  }
  return refusal;
}

/// Tangential force and moment of one frame.
template <scalar S = double>
struct [[nodiscard]] ShearResult {
  ForceStatus status = ForceStatus::not_finite;  ///< the worse of those of force and moment
  Point2<S> tangential_force_n = {not_a_number<S>(), not_a_number<S>()};  ///< NaN: not known
  S moment_n_mm = not_a_number<S>();  ///< about the contact's normal; NaN: not known

  /// Whether the calibration covers both.
  bool ok() const { return status <= ForceStatus::measured; }
  bool has_force() const { return is_finite(tangential_force_n); }
  bool has_moment() const { return is_finite(moment_n_mm); }
};

/// Finds tangential force and moment. A call is const, O(1), and allocates nothing.
template <scalar S = double>
class Shear {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit Shear(const ShearMap<S>& map) : map_(map) { require(map); }

  /// Force and moment of one frame. The force is NaN if the measure or the displacement is not
  /// finite, the moment if the measure or the rotation is not finite. Both are 0 without contact,
  /// whatever moves.
  ShearResult<S> operator()(const S& measure,
                            const Point2<S>& displacement_mm,
                            const S& rotation_rad) const {
    using std::exp;
    using std::log;
    ShearResult<S> result;
    if (!is_finite(measure)) {
      return result;
    }
    if (!(value(measure) > 0)) {
      return {ForceStatus::no_contact, {S(0), S(0)}, S(0)};
    }
    const S log_ratio = log(measure / map_.reference);  // once for both powers
    const Point2<S> d = exp(map_.force.exponent * log_ratio) * displacement_mm;
    const Point2<S> force = map_.force.slope * d;
    const S theta = exp(map_.moment.exponent * log_ratio) * rotation_rad;
    const S moment = map_.moment.slope * theta;
    if (is_finite(force)) {
      result.tangential_force_n = force;
    }
    if (is_finite(moment)) {
      result.moment_n_mm = moment;
    }
    if (is_finite(force) && is_finite(moment)) {
      const S moved_sq = squared_norm(displacement_mm), turned_sq = square(rotation_rad);
      result.status =
          (std::max)(status_of(measure, map_.force, squared_norm(d), value(moved_sq) > 10000),
                     status_of(measure, map_.moment, square(theta), value(turned_sq) > 10));
    }
    return result;
  }

 private:
  /// A measure below a hundredth of the reference is below_range: no calibration has such a
  /// contact.
  ForceStatus status_of(const S& measure,
                        const ShearLaw<S>& law,
                        const S& size_sq,
                        bool wild) const {
    const bool far = value(size_sq) > value(S(1 + 1e-6) * square(law.to));
    const bool tiny = value(law.exponent) != 0 && value(S(100) * measure) < value(map_.reference);
    return wild || !is_plausible(measure) ? ForceStatus::implausible
           : far                          ? ForceStatus::beyond_range
           : tiny                         ? ForceStatus::below_range
                                          : ForceStatus::measured;
  }

  ShearMap<S> map_;
};

}  // namespace v1
}  // namespace fingerpad
