// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From the normalised displacement and rotation to tangential force and moment. "The relationship
// between the normalized displacement and tangential force is almost linear"; its slopes are not
// printed, so calibrate/force.hpp identifies them.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// How a contact's size stiffens it: displacement and rotation count by (measure / reference) to
/// these exponents.
template <scalar S = double>
struct ShearNormalisation {
  S reference = not_a_number<S>();  ///< in the measure's unit, finite, > 0
  S displacement_exponent = S(0);   ///< T_S or T_D, finite; the sources have it > 0
  S rotation_exponent = S(0);       ///< R_S or R_D, likewise
};

/// Eqs. 4 and 5 with the constants of "Measurement results of tangential force" and "... of
/// rotational moment": by contact area in mm^2, and by contact depth in mm.
template <scalar S = double>
ShearNormalisation<S> published_shear_by_area() {
  return {S(100), S(0.65), S(1.7)};
}
template <scalar S = double>
ShearNormalisation<S> published_shear_by_depth() {
  return {S(10), S(0.75), S(2.2)};
}
/// Elastic pads, by the contact radius: the tangential stiffness of a round contact is proportional
/// to its radius, the torsional one to its cube (Johnson, Contact Mechanics). The slides on elastic
/// pads show the look-up by displacement and radius without a formula.
template <scalar S = double>
ShearNormalisation<S> shear_by_radius(const S& reference_mm) {
  return {reference_mm, S(1), S(3)};
}
/// Where no size of the contact is known: give any positive measure.
template <scalar S = double>
ShearNormalisation<S> shear_without_measure() {
  return {S(1), S(0), S(0)};
}

/// c_1 x + c_2 x |x| + c_3 x |x|^2 + ...: odd, as a force must be that turns with its displacement.
template <int Degree = 1, scalar S = double>
struct OddPolynomial {
  static_assert(Degree >= 1 && Degree <= 4);
  static constexpr std::size_t size = static_cast<std::size_t>(Degree);

  std::array<S, size> coefficients = none();  ///< c_1 first, finite, c_1 > 0
  S to = not_a_number<S>();  ///< the largest |x| identified, > 0; beyond it along the tangent.
                             ///< NaN: not known, for Degree 1 only

  /// The polynomial over x, by which a vector x is multiplied.
  S gain(const S& length) const {
    const bool beyond = value(length) > value(to);
    const S held = beyond ? to : length;
    S sum = coefficients[size - 1];
    S slope = S(Degree) * coefficients[size - 1];
    for (std::size_t k = size - 1; k-- > 0;) {
      sum = S(sum * held) + coefficients[k];
      slope = S(slope * held) + S(S(static_cast<int>(k) + 1) * coefficients[k]);
    }
    if constexpr (Degree == 1) {
      return sum;
    } else {
      const S longer = S(sum * held) + S(slope * S(length - held));
      return beyond ? S(longer / length) : sum;
    }
  }

 private:
  static constexpr std::array<S, size> none() {
    std::array<S, size> coefficients{};
    coefficients.fill(not_a_number<S>());
    return coefficients;
  }
};

/// The same in all directions, as in the paper with Degree 1: a force along the displacement.
template <int Degree = 1, scalar S = double>
struct RadialShear {
  using number = S;

  OddPolynomial<Degree, S> force = {};   ///< N/mm, N/mm^2, ...
  OddPolynomial<Degree, S> moment = {};  ///< N mm/rad, N mm/rad^2, ...

  Point2<S> force_n(const Point2<S>& normalised_mm) const {
    const S gain = Degree == 1 ? force.coefficients[0] : force.gain(length_of(normalised_mm));
    return {S(gain * normalised_mm.x), S(gain * normalised_mm.y)};
  }
  S moment_n_mm(const S& normalised_rad) const {
    return S(moment.gain(size_of(normalised_rad)) * normalised_rad);
  }
  bool within(const Point2<S>& normalised_mm) const {
    const S length_sq = square(normalised_mm.x) + square(normalised_mm.y);
    return !(value(length_sq) > value(square(force.to)));
  }
  bool within(const S& normalised_rad) const {
    return !(value(size_of(normalised_rad)) > value(moment.to));
  }

 private:
  /// Its derivative at 0 is taken as 0; nothing depends on it there.
  static S length_of(const Point2<S>& v) {
    using std::sqrt;
    const S sum_sq = square(v.x) + square(v.y);
    return value(sum_sq) > 0 ? S(sqrt(sum_sq)) : S(0);
  }
  static S size_of(const S& x) { return value(x) < 0 ? S(-x) : x; }
};

/// Any linear map, for sensors that are not round or whose axes are not those of the image:
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

  Point2<S> force_n(const Point2<S>& normalised_mm) const {
    return {S(S(S(x_by_x * normalised_mm.x) + S(x_by_y * normalised_mm.y)) + offset_n.x),
            S(S(S(y_by_x * normalised_mm.x) + S(y_by_y * normalised_mm.y)) + offset_n.y)};
  }
  S moment_n_mm(const S& normalised_rad) const {
    return S(S(moment_n_mm_per_rad * normalised_rad) + moment_offset_n_mm);
  }
  bool within(const Point2<S>&) const { return true; }
  bool within(const S&) const { return true; }
};

/// Refuses what has no meaning (parameter_error).
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
  const auto check = [](const OddPolynomial<Degree, S>& polynomial, const char* owner) {
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
}

}  // namespace v0
}  // namespace fingerpad
