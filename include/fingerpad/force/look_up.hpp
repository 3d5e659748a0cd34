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
inline namespace v0 {

/// Statuses from the best to the worst.
enum class ForceStatus : std::uint8_t {
  no_contact,    ///< the measure is 0 or negative: no force, whatever the displacement
  measured,      ///< within the calibrated range
  below_range,   ///< the contact is smaller than any in the calibration, and the force fades to 0
                 ///< with it; Shear: smaller than a hundredth of the reference. If this is always
                 ///< so, the measure may be in another unit
  beyond_range,  ///< a larger contact or displacement than in the calibration: the curve continues
                 ///< along its tangent
  held_at_zero,  ///< the compensation gives a negative force, which is set to 0
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

/// F = (c_0 + c_1 m + c_2 m^2 + ...) (1 + a |d|^2 + b theta^2) in N for a measure m of the contact,
/// a displacement d and a rotation theta. m is its area in mm^2, depth in mm or, on elastic pads,
/// radius in mm. The paper's own compensation is published/look_up.hpp.
template <scalar S = double>
struct ForceCurve {
  static constexpr std::size_t size = 6;
  using Coefficients = std::array<S, size>;

  Coefficients coefficients = detail::zeros<S, size>();  ///< c_0 first, finite; those not given: 0
  S from = not_a_number<S>();           ///< the smallest measure identified, finite, >= 0
  S to = not_a_number<S>();             ///< the largest, finite, > from
  S per_mm_sq = S(0);                   ///< a, 1/mm^2; 0: the displacement is not read
  S per_rad_sq = S(0);                  ///< b, 1/rad^2; 0: the rotation is not read
  S residual_sd_n = not_a_number<S>();  ///< standard deviation of a sample about the curve, N,
                                        ///< >= 0; NaN: forces get no variance
  S measure_sd = S(0);                  ///< of noise in the measure beyond that of the samples
  std::array<Coefficients, size> covariance = detail::zero_matrix<S, size>();  ///< of coefficients

  /// The polynomial.
  S force_n(const S& measure) const {
    S sum = coefficients[size - 1];
    for (std::size_t k = size - 1; k-- > 0;) {
      sum = sum * measure + coefficients[k];
    }
    return sum;
  }
  /// Its derivative by the measure.
  S slope(const S& measure) const {
    S sum = S(0);
    for (std::size_t k = size - 1; k >= 1; --k) {
      sum = sum * measure + S(static_cast<int>(k)) * coefficients[k];
    }
    return sum;
  }
};

/// Says which parameter has no meaning, or that the force falls while the contact grows.
template <scalar S>
std::string check(const ForceCurve<S>& c) {
  const char* const owner = "ForceCurve";
  const double from = static_cast<double>(value(c.from));
  const bool has_errors = value(c.residual_sd_n) == value(c.residual_sd_n);
  std::string refusal =
      check(owner, {{"from", c.from, not_negative},
                    {"to", c.to, {.min = from, .above_min = true}},
                    {"per_mm_sq", c.per_mm_sq, finite_number},
                    {"per_rad_sq", c.per_rad_sq, finite_number},
                    {"residual_sd_n", has_errors ? c.residual_sd_n : S(0), not_negative},
                    {"measure_sd", c.measure_sd, not_negative}});
  for (std::size_t k = 0; k < c.size && refusal.empty(); ++k) {
    refusal = check(owner, {{"coefficients", c.coefficients[k], finite_number},
                            {"variance of a coefficient", c.covariance[k][k], not_negative}});
  }
  for (std::size_t k = 0; k < c.size; ++k) {
    for (std::size_t j = 0; j < c.size && refusal.empty(); ++j) {
      const S largest_sq = S(1.000001) * c.covariance[k][k] * c.covariance[j][j];
      if (!(value(square(c.covariance[k][j])) <= value(largest_sq))) {
        refusal = "ForceCurve: covariance has a correlation above 1";
      }
    }
  }
  const S end = c.force_n(c.to);
  const S rounding = S(64 * epsilon<S>()) * (value(end) < 0 ? -end : end) / c.to;  // of a slope
  if (refusal.empty()) {  // a force at 0 would be a step
    refusal = check(
        owner, {{"force at to", end, finite_number},
                {"c_0 of a curve from 0 on", from > 0 ? S(0) : c.coefficients[0], within(0, 0)}});
  }
  for (int k = 0; k <= 16 && refusal.empty(); ++k) {
    const S slope = c.slope(c.from + S(k) / S(16) * (c.to - c.from));
    if (!(value(slope + rounding) >= 0)) {
      refusal = check(owner, {{"slope within the range", slope, not_negative}});
    }
  }
  return refusal;
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

namespace detail {

/// 3 x^2 - 2 x^3 from 0 at x = 0 to 1 at x = 1, level at both, and 1 beyond; and its slope.
template <scalar S>
S smooth_step(const S& share) {
  const S x = value(share) < 1 ? share : S(1);
  return x * x * (S(3) - S(2) * x);
}
template <scalar S>
S smooth_step_slope(const S& x) {
  return value(x) < 1 ? S(6) * x * (S(1) - x) : S(0);
}

/// Finite, but impossible for the contact of a fingertip.
template <scalar S>
bool is_wild(const Point2<S>& displacement_mm) {
  return is_finite(displacement_mm) && value(squared_norm(displacement_mm)) > 10000;
}
template <scalar S>
bool is_wild_rotation(const S& rotation_rad) {
  return is_finite(rotation_rad) && value(square(rotation_rad)) > 10;
}
constexpr ForceStatus worse(ForceStatus a, ForceStatus b) {
  return a < b ? b : a;
}

}  // namespace detail

/// The normal force from one measure of the contact. Without contact it is 0, whatever the
/// displacement. Below the calibrated range the curve is faded in smoothly, so that the force rises
/// without a step; beyond it continues along its tangent, because a polynomial may turn anywhere.
/// A call is const, O(1), and allocates nothing.
template <scalar S = double>
class NormalForce {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit NormalForce(const ForceCurve<S>& curve) : curve_(curve) {
    require(curve);
    end_slope_ = curve.slope(curve.to);
    one_over_from_ = value(curve.from) > value(S(1e-30)) ? S(1) / curve.from : S(1e30);
    for (std::size_t k = 0; k < curve.size; ++k) {
      const bool used = value(curve.coefficients[k]) != 0 || value(curve.covariance[k][k]) != 0;
      terms_ = used ? k + 1 : terms_;
    }
  }

  /// The force of one frame. Displacement and rotation are those of the contact.
  /// `measure_variance` is that of this measure in addition to that of the calibration.
  ForceResult<S> operator()(const S& measure,
                            const Point2<S>& displacement_mm = {S(0), S(0)},
                            const S& rotation_rad = S(0),
                            const S& measure_variance = S(0)) const {
    const Place at = place_of(measure);
    const S gain = gain_of(displacement_mm, rotation_rad);
    const S force = gain * at.faded * at.plain_n;
    ForceResult<S> result;
    if (!is_finite(measure) || !is_finite(force)) {
      return result;
    }
    const bool wild = !is_plausible(measure) || !is_plausible(force) ||
                      (value(curve_.per_mm_sq) != 0 && detail::is_wild(displacement_mm)) ||
                      (value(curve_.per_rad_sq) != 0 && detail::is_wild_rotation(rotation_rad));
    result.force_n = value(force) > 0 ? force : S(0);
    result.status = value(measure) <= 0                   ? ForceStatus::no_contact
                    : wild                                ? ForceStatus::implausible
                    : value(force) < 0                    ? ForceStatus::held_at_zero
                    : value(measure) < value(curve_.from) ? ForceStatus::below_range
                    : value(measure) > value(curve_.to)   ? ForceStatus::beyond_range
                                                          : ForceStatus::measured;
    if (value(curve_.residual_sd_n) >= 0) {
      result.variance_n2 = variance_n2(measure, at, gain, measure_variance);
    }
    return result;
  }

  const ForceCurve<S>& curve() const { return curve_; }

 private:
  /// A measure limited to [0, to], what it exceeds `to` by, and the force there.
  struct Place {
    S within, beyond, faded, plain_n;
  };

  /// Treats NaN like no contact: the measure is checked.
  Place place_of(const S& measure) const {
    const S above = value(measure) > 0 ? measure : S(0);
    const bool past = value(above) > value(curve_.to);
    const S within = past ? curve_.to : above, beyond = past ? above - curve_.to : S(0);
    return {within, beyond, detail::smooth_step(within * one_over_from_),
            curve_.force_n(within) + end_slope_ * beyond};
  }

  S gain_of(const Point2<S>& displacement_mm, const S& rotation_rad) const {
    S gain(1);
    if (value(curve_.per_mm_sq) != 0) {
      gain = gain + curve_.per_mm_sq * squared_norm(displacement_mm);
    }
    if (value(curve_.per_rad_sq) != 0) {
      gain = gain + curve_.per_rad_sq * square(rotation_rad);
    }
    return gain;
  }

  /// Four parts: the coefficients, what the calibration could not explain, noise of the measure,
  /// and the distance of the tangent from the curve, because nothing shows which of them is right.
  [[gnu::pure]] S variance_n2(const S& measure,
                              const Place& at,
                              const S& gain,
                              const S& measure_variance) const {
    const S fade_slope = detail::smooth_step_slope(at.within * one_over_from_) * one_over_from_;
    const S slope = gain * (curve_.slope(at.within) * at.faded + at.plain_n * fade_slope);
    const S bend = value(at.beyond) > 0 ? gain * (curve_.force_n(measure) - at.plain_n) : S(0);
    typename ForceCurve<S>::Coefficients by_coefficient = {gain * at.faded};
    S power = gain * at.faded;
    for (std::size_t k = 1; k < terms_; ++k) {
      by_coefficient[k] = power * (at.within + S(static_cast<int>(k)) * at.beyond);
      power = power * at.within;
    }
    S sum(0);
    for (std::size_t i = 0; i < terms_; ++i) {
      for (std::size_t j = 0; j < terms_; ++j) {
        sum = sum + by_coefficient[i] * curve_.covariance[i][j] * by_coefficient[j];
      }
    }
    return (value(sum) > 0 ? sum : S(0)) + square(curve_.residual_sd_n) +
           square(slope) * (square(curve_.measure_sd) + measure_variance) + square(bend);
  }

  ForceCurve<S> curve_;
  S end_slope_, one_over_from_;
  std::size_t terms_ = 1;  // coefficients with a value or a variance
};

/// Combines the forces by area and by depth, weighted by their variances; their errors are assumed
/// to be independent. A force that is NaN or has no variance does not take part, but an implausible
/// one makes the result implausible. Two forces that differ by more than `max_disagreement`
/// standard deviations are disagreeing.
template <scalar S>
ForceResult<S> fused(const ForceResult<S>& a,
                     const ForceResult<S>& b,
                     double max_disagreement = 3) {
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
  const bool exact = !(value(sum) > 0);
  const S share_of_a = exact ? S(1) / S(2) : b.variance_n2 / sum;
  const S disagreement = value(difference) == 0 ? S(0)
                         : exact                ? not_a_number<S>()
                                                : difference / sqrt(sum);
  const bool agree = value(square(disagreement)) <= value(square(S(max_disagreement)));
  const ForceStatus worst = detail::worse(a.status, b.status);
  return {agree ? worst : detail::worse(worst, ForceStatus::disagreeing),
          b.force_n + share_of_a * difference, share_of_a * a.variance_n2, disagreement};
}

/// (measure / reference)^exponent, eqs. 4 and 5. Without contact (measure not above 0) it is 0, so
/// that displaced dots give no force.
template <scalar S>
S shear_factor(const S& measure, const S& reference, const S& exponent) {
  using std::exp;
  using std::log;
  return value(measure) > 0 ? exp(exponent * log(measure / reference)) : S(0);
}

/// Moment about the sensor's origin: the moment about the contact's center at `center_mm`, plus
/// that of the force acting there.
template <scalar S>
S moment_about_origin(const S& moment_n_mm, const Point2<S>& force_n, const Point2<S>& center_mm) {
  return moment_n_mm + center_mm.x * force_n.y - center_mm.y * force_n.x;
}

/// c_1 x + c_2 x |x| + c_3 x |x|^2 + ... of a displacement or rotation x that is multiplied by
/// (measure / reference)^exponent: odd, because the force reverses with the displacement.
template <scalar S = double>
struct ShearLaw {
  std::array<S, 4> coefficients = {not_a_number<S>(), S(0), S(0), S(0)};  ///< c_1 first, finite,
                                                                          ///< c_1 >= 0
  S exponent = S(0);         ///< T or R, finite; > 0 in the paper. 0: the size does not matter
  S to = not_a_number<S>();  ///< the largest |x| identified, > 0; beyond it the tangent continues.
                             ///< NaN: not known, for a straight line only

  bool straight() const {
    return value(coefficients[1]) == 0 && value(coefficients[2]) == 0 &&
           value(coefficients[3]) == 0;
  }
  /// The law divided by x, for |x| = length: the factor of a vector of this length.
  S gain(const S& length) const {
    const S within = value(length) > value(to) ? to : length;
    S sum = coefficients[3], slope = S(4) * coefficients[3];
    for (std::size_t k = 3; k-- > 0;) {
      sum = sum * within + coefficients[k];
      slope = slope * within + S(static_cast<int>(k) + 1) * coefficients[k];
    }
    return value(length) > value(to) ? (sum * to + slope * (length - to)) / length : sum;
  }
};

/// Force and moment from displacement and rotation, F = K g(|d_nor|) d_nor + offset. With K = 1
/// the force is along the displacement; other K are for sensors that are not round, or whose axes
/// are not those of the image. Elastic pads, by the radius of the contact: the exponents are 1 and
/// 3, because the tangential stiffness of a round contact is proportional to its radius, the
/// torsional one to its cube (Johnson, Contact Mechanics).
template <scalar S = double>
struct ShearMap {
  S reference = S(1);  ///< in the measure's unit, finite, > 0
  ShearLaw<S> force;   ///< N/mm, N/mm^2, ...
  ShearLaw<S> moment;  ///< N mm/rad, N mm/rad^2, ...
  S x_by_x = S(1);     ///< K, finite
  S x_by_y = S(0);
  S y_by_x = S(0);
  S y_by_y = S(1);
  Point2<S> offset_n = {S(0), S(0)};  ///< finite
};

/// Says which parameter has no meaning.
template <scalar S>
std::string check(const ShearMap<S>& m) {
  const char* const owner = "ShearMap";
  std::string refusal = check(owner, {{"reference", m.reference, positive},
                                      {"x_by_x", m.x_by_x, finite_number},
                                      {"x_by_y", m.x_by_y, finite_number},
                                      {"y_by_x", m.y_by_x, finite_number},
                                      {"y_by_y", m.y_by_y, finite_number},
                                      {"offset_n.x", m.offset_n.x, finite_number},
                                      {"offset_n.y", m.offset_n.y, finite_number}});
  for (const ShearLaw<S>* law : {&m.force, &m.moment}) {
    const char* const whose = law == &m.force ? "ShearMap: force" : "ShearMap: moment";
    const bool unknown = !(value(law->to) == value(law->to)) && law->straight();
    refusal = !refusal.empty() ? refusal
                               : check(whose, {{"c_1", law->coefficients[0], not_negative},
                                               {"c_2", law->coefficients[1], finite_number},
                                               {"c_3", law->coefficients[2], finite_number},
                                               {"c_4", law->coefficients[3], finite_number},
                                               {"exponent", law->exponent, finite_number},
                                               {"to", unknown ? S(1) : law->to, positive}});
  }
  const S force = m.force.coefficients[0], moment = m.moment.coefficients[0];
  if (refusal.empty() && value(force) > 0 && value(moment) > 0) {
    using std::sqrt;
    refusal =
        check(owner, {{"size of the contact from moment over force, in mm for N/mm and N mm/rad,",
                       sqrt(moment / force), fingerpad::within(0.5, 1000)}});
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
  /// finite, the moment if the measure or the rotation is not finite. Both are 0 without contact.
  ShearResult<S> operator()(const S& measure,
                            const Point2<S>& displacement_mm,
                            const S& rotation_rad) const {
    using std::exp;
    using std::log;
    ShearResult<S> result;
    if (!is_finite(measure)) {
      return result;
    }
    const bool contact = value(measure) > 0;
    const S log_ratio = contact ? log(measure / map_.reference) : S(0);  // once for both powers
    const Point2<S> d = exp(map_.force.exponent * log_ratio) * displacement_mm;
    const S distance = length_of(d);
    const Point2<S> pull = map_.force.gain(distance) * d;
    const Point2<S> force = {map_.x_by_x * pull.x + map_.x_by_y * pull.y + map_.offset_n.x,
                             map_.y_by_x * pull.x + map_.y_by_y * pull.y + map_.offset_n.y};
    const S theta = exp(map_.moment.exponent * log_ratio) * rotation_rad;
    const S angle = value(theta) < 0 ? -theta : theta;
    const S moment = map_.moment.gain(angle) * theta;
    const bool has_force = is_finite(displacement_mm) && is_finite(force);
    const bool has_moment = is_finite(rotation_rad) && is_finite(moment);
    if (has_force) {
      result.tangential_force_n = contact ? force : Point2<S>{S(0), S(0)};
    }
    if (has_moment) {
      result.moment_n_mm = contact ? moment : S(0);
    }
    if (has_force && has_moment) {
      result.status = detail::worse(
          status_of(measure, map_.force, distance, detail::is_wild(displacement_mm)),
          status_of(measure, map_.moment, angle, detail::is_wild_rotation(rotation_rad)));
    }
    return result;
  }

  const ShearMap<S>& map() const { return map_; }

 private:
  /// Its derivative at 0 is taken as 0; nothing depends on it there.
  static S length_of(const Point2<S>& v) {
    using std::sqrt;
    const S sum_sq = squared_norm(v);
    return value(sum_sq) > 0 ? sqrt(sum_sq) : S(0);
  }
  /// A measure below a hundredth of the reference is below_range, because no calibration has such a
  /// contact.
  ForceStatus status_of(const S& measure, const ShearLaw<S>& law, const S& size, bool wild) const {
    const bool tiny = value(law.exponent) != 0 && value(S(100) * measure) < value(map_.reference);
    return !(value(measure) > 0)            ? ForceStatus::no_contact
           : wild || !is_plausible(measure) ? ForceStatus::implausible
           : value(size) > value(law.to)    ? ForceStatus::beyond_range
           : tiny                           ? ForceStatus::below_range
                                            : ForceStatus::measured;
  }

  ShearMap<S> map_;
};

}  // namespace v0
}  // namespace fingerpad
