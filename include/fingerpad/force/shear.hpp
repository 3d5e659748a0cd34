// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tangential force and moment about the contact's normal by look-up, from displacement and rotation
// of the dots, normalised by the size of the contact. Source: Ito, Kim and Obinata, "Acquisition of
// Contact Force and Slippage ...", "Method for measuring tangential force" and "... moment around
// normal direction":
//
//   d_nor     = (S_c / S_ref)^T_S d     or (D / D_ref)^T_D d          (4)
//   theta_nor = (S_c / S_ref)^R_S theta or (D / D_ref)^R_D theta      (5)
//
// with (5) corrected (docs/errata.md, E031). A map then gives force and moment: "the relationship
// between the normalized displacement and tangential force is almost linear". Its slopes are not
// printed, so calibrate/force.hpp identifies them. Forces are what the object exerts on the pad: a
// pad that is dragged along x is pushed along x. The moment is about the normal through the center
// of the contact.
//
// motion/contact_shift.hpp chooses the dots. The paper takes the central one.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/force_status.hpp"

namespace fingerpad {
inline namespace v0 {

/// Normalisation by the size of the contact, because a larger contact is stiffer. Displacement and
/// rotation are multiplied by (measure / reference) to these exponents.
template <scalar S = double>
struct ShearNormalisation {
  S reference = not_a_number<S>();  ///< in the measure's unit, finite, > 0
  S displacement_exponent = S(0);   ///< T_S or T_D, finite; > 0 in the sources
  S rotation_exponent = S(0);       ///< R_S or R_D, likewise
};

/// Elastic pads, by the contact radius: the tangential stiffness of a round contact is proportional
/// to its radius, the torsional one to its cube (Johnson, Contact Mechanics). The slides on elastic
/// pads show the look-up by displacement and radius without a formula.
template <scalar S = double>
ShearNormalisation<S> shear_by_radius(const S& reference_mm) {
  return {reference_mm, S(1), S(3)};
}
/// No normalisation, for contacts of unknown size. Pass any positive measure.
template <scalar S = double>
ShearNormalisation<S> shear_without_measure() {
  return {S(1), S(0), S(0)};
}

namespace detail {

/// c_1 x + c_2 x |x| + c_3 x |x|^2 + ...: odd, because the force reverses with the displacement.
template <int Degree = 1, scalar S = double>
struct OddPolynomial {
  static_assert(Degree >= 1 && Degree <= 4);
  static constexpr std::size_t size = static_cast<std::size_t>(Degree);

  std::array<S, size> coefficients = none();  ///< c_1 first, finite, c_1 > 0
  S to = not_a_number<S>();  ///< the largest |x| identified, > 0; beyond it the tangent continues.
                             ///< NaN: not known, for Degree 1 only

  /// The polynomial divided by x: the factor of a vector x of this length.
  S gain(const S& length) const {
    const bool beyond = value(length) > value(to);
    const S held = beyond ? to : length;
    S sum = coefficients[size - 1];
    S slope = S(Degree) * coefficients[size - 1];
    for (std::size_t k = size - 1; k-- > 0;) {
      sum = sum * held + coefficients[k];
      slope = slope * held + S(static_cast<int>(k) + 1) * coefficients[k];
    }
    if constexpr (Degree == 1) {
      return sum;
    } else {
      return beyond ? S((sum * held + slope * (length - held)) / length) : sum;
    }
  }

 private:
  static constexpr std::array<S, size> none() {
    std::array<S, size> coefficients{};
    coefficients.fill(not_a_number<S>());
    return coefficients;
  }
};

}  // namespace detail

/// An isotropic map: the force is along the displacement. Degree 1 is that of the paper.
template <int Degree = 1, scalar S = double>
struct RadialShear {
  using number = S;

  detail::OddPolynomial<Degree, S> force = {};   ///< N/mm, N/mm^2, ...
  detail::OddPolynomial<Degree, S> moment = {};  ///< N mm/rad, N mm/rad^2, ...

  Point2<S> force_n(const Point2<S>& normalised_mm) const {
    const S gain = Degree == 1 ? force.coefficients[0] : force.gain(length_of(normalised_mm));
    return gain * normalised_mm;
  }
  S moment_n_mm(const S& normalised_rad) const {
    return S(moment.gain(size_of(normalised_rad)) * normalised_rad);
  }
  bool within(const Point2<S>& normalised_mm) const {
    return !(value(squared_norm(normalised_mm)) > value(square(force.to)));
  }
  bool within(const S& normalised_rad) const {
    return !(value(size_of(normalised_rad)) > value(moment.to));
  }

 private:
  /// Its derivative at 0 is taken as 0; nothing depends on it there.
  static S length_of(const Point2<S>& v) {
    using std::sqrt;
    const S sum_sq = squared_norm(v);
    return value(sum_sq) > 0 ? S(sqrt(sum_sq)) : S(0);
  }
  static S size_of(const S& x) { return value(x) < 0 ? S(-x) : x; }
};

/// A general linear map, for sensors that are not round or whose axes are not those of the image:
/// F = K d + offset, M = c theta + offset.
template <scalar S = double>
struct LinearShear {
  using number = S;

  S x_by_x = not_a_number<S>();  ///< K, N/mm, finite
  S x_by_y = not_a_number<S>();
  S y_by_x = not_a_number<S>();
  S y_by_y = not_a_number<S>();
  Point2<S> offset_n = {S(0), S(0)};          ///< finite
  S moment_n_mm_per_rad = not_a_number<S>();  ///< finite
  S moment_offset_n_mm = S(0);                ///< finite
  S to = not_a_number<S>();                   ///< the largest |d| identified, > 0; NaN: not known

  Point2<S> force_n(const Point2<S>& d) const {
    return {S(x_by_x * d.x + x_by_y * d.y + offset_n.x),
            S(y_by_x * d.x + y_by_y * d.y + offset_n.y)};
  }
  S moment_n_mm(const S& normalised_rad) const {
    return S(moment_n_mm_per_rad * normalised_rad + moment_offset_n_mm);
  }
  bool within(const Point2<S>& d) const { return !(value(squared_norm(d)) > value(square(to))); }
  bool within(const S&) const { return true; }
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const ShearNormalisation<S>& normalisation) {
  const char* const owner = "ShearNormalisation";
  expects(is_finite(normalisation.reference) && value(normalisation.reference) > 0, owner,
          "reference", normalisation.reference, "finite and > 0");
  expects(is_finite(normalisation.displacement_exponent), owner, "displacement_exponent",
          normalisation.displacement_exponent, "finite");
  expects(is_finite(normalisation.rotation_exponent), owner, "rotation_exponent",
          normalisation.rotation_exponent, "finite");
}
template <int Degree, scalar S>
void expects_valid(const RadialShear<Degree, S>& map) {
  const auto check = [](const detail::OddPolynomial<Degree, S>& polynomial, const char* owner) {
    for (const S& coefficient : polynomial.coefficients) {
      expects(is_finite(coefficient), owner, "coefficients", coefficient, "finite");
    }
    expects(value(polynomial.coefficients[0]) > 0, owner, "first of the coefficients",
            polynomial.coefficients[0], "> 0");
    const bool unknown = !(value(polynomial.to) == value(polynomial.to));
    expects((unknown && Degree == 1) || (is_finite(polynomial.to) && value(polynomial.to) > 0),
            owner, "to", polynomial.to, "finite and > 0, or NaN for degree 1");
  };
  check(map.force, "RadialShear: force");
  check(map.moment, "RadialShear: moment");
  using std::sqrt;
  const S size_mm = sqrt(S(map.moment.coefficients[0] / map.force.coefficients[0]));
  expects(2 * value(size_mm) >= 1 && value(size_mm) <= 1000, "RadialShear",
          "size of the contact from moment over force, mm", size_mm,
          "in [0.5, 1000]: give N/mm and N mm/rad");
}
template <scalar S>
void expects_valid(const LinearShear<S>& map) {
  const auto check = [](const S& given, const char* name) {
    expects(is_finite(given), "LinearShear", name, given, "finite");
  };
  check(map.x_by_x, "x_by_x");
  check(map.x_by_y, "x_by_y");
  check(map.y_by_x, "y_by_x");
  check(map.y_by_y, "y_by_y");
  check(map.offset_n.x, "offset_n.x");
  check(map.offset_n.y, "offset_n.y");
  check(map.moment_n_mm_per_rad, "moment_n_mm_per_rad");
  check(map.moment_offset_n_mm, "moment_offset_n_mm");
  const bool unknown = !(value(map.to) == value(map.to));
  expects(unknown || (is_finite(map.to) && value(map.to) > 0), "LinearShear", "to", map.to,
          "finite and > 0, or NaN");
}

/// (measure / reference)^exponent. Without contact (measure not above 0) it is 0, so that displaced
/// dots give no force.
template <scalar S>
S shear_factor(const S& measure, const S& reference, const S& exponent) {
  using std::exp;
  using std::log;
  if (!(value(measure) > 0)) {
    return S(0);
  }
  const S ratio = measure / reference;
  return S(exp(S(exponent * S(log(ratio)))));
}

/// Moment about the sensor's origin: the moment about the contact's center at `center_mm`, plus
/// that of the force acting there.
template <scalar S>
S moment_about_origin(const S& moment_n_mm, const Point2<S>& force_n, const Point2<S>& center_mm) {
  return S(moment_n_mm + center_mm.x * force_n.y - center_mm.y * force_n.x);
}

/// Tangential force and moment of a frame. Each has its own status, because one can fail without
/// the other.
template <scalar S = double>
struct [[nodiscard]] ShearResult {
  ForceStatus force_status = ForceStatus::not_finite;
  ForceStatus moment_status = ForceStatus::not_finite;
  Point2<S> tangential_force_n = {not_a_number<S>(), not_a_number<S>()};
  S moment_n_mm = not_a_number<S>();
  Point2<S> normalised_displacement_mm = {not_a_number<S>(), not_a_number<S>()};
  S normalised_rotation_rad = not_a_number<S>();

  /// The worse of both.
  ForceStatus status() const { return detail::worse(force_status, moment_status); }
  /// Whether the calibration covers both.
  bool ok() const { return status() <= ForceStatus::measured; }
  bool has_force() const { return force_status != ForceStatus::not_finite; }
  bool has_moment() const { return moment_status != ForceStatus::not_finite; }
};

/// Finds tangential force and moment by look-up.
///   Map  RadialShear<Degree>  take this for round pads; published with Degree 1
///        LinearShear          take this for others, or axes that are not those of the image
/// A call is const, O(1), and allocates nothing.
template <class Map = RadialShear<>>
class Shear {
 public:
  using S = typename Map::number;

  /// Refuses bad parameters (parameter_error).
  Shear(const ShearNormalisation<S>& normalisation, const Map& map)
      : normalisation_(normalisation), map_(map) {
    expects_valid(normalisation);
    expects_valid(map);
  }

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
    const S ratio = contact ? S(measure / normalisation_.reference) : S(1);
    const S log_ratio = log(ratio);  // once for both powers
    const auto factor = [&](const S& exponent) {
      return contact ? S(exp(S(exponent * log_ratio))) : S(0);
    };
    const Point2<S> d = factor(normalisation_.displacement_exponent) * displacement_mm;
    const Point2<S> force = contact ? map_.force_n(d) : Point2<S>{S(0), S(0)};
    if (is_finite(displacement_mm) && is_finite(force)) {
      result.normalised_displacement_mm = d;
      result.tangential_force_n = force;
      result.force_status = status_of(measure, normalisation_.displacement_exponent,
                                      detail::beyond_displacement(displacement_mm), map_.within(d));
    }
    const S theta = factor(normalisation_.rotation_exponent) * rotation_rad;
    const S moment = contact ? map_.moment_n_mm(theta) : S(0);
    if (is_finite(rotation_rad) && is_finite(moment)) {
      result.normalised_rotation_rad = theta;
      result.moment_n_mm = moment;
      result.moment_status = status_of(measure, normalisation_.rotation_exponent,
                                       detail::beyond_rotation(rotation_rad), map_.within(theta));
    }
    return result;
  }

 private:
  /// A measure below a hundredth of the reference is below_range, because no calibration has such a
  /// contact.
  ForceStatus status_of(const S& measure, const S& exponent, bool wild, bool within) const {
    const bool tiny =
        value(exponent) != 0 && value(S(S(100) * measure)) < value(normalisation_.reference);
    return !(value(measure) > 0)                 ? ForceStatus::no_contact
           : wild || detail::beyond_all(measure) ? ForceStatus::implausible
           : !within                             ? ForceStatus::beyond_range
           : tiny                                ? ForceStatus::below_range
                                                 : ForceStatus::measured;
  }

  ShearNormalisation<S> normalisation_;
  Map map_;
};

}  // namespace v0
}  // namespace fingerpad
