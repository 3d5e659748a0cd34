// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Normal force as a function of one measure of the contact (its area in mm^2, depth in mm or radius
// in mm), and the uncertainty of that function. calibrate/force.hpp fits both. A curve also stores
// the range of measures in which it was identified.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

/// F = c_0 + c_1 m + c_2 m^2 + ..., in N, for the measure m; c_k in N per (unit of the measure)^k.
template <int Degree = 2, scalar S = double>
struct PolynomialForce {
  static_assert(Degree >= 1 && Degree <= 5);
  using number = S;
  static constexpr std::size_t parameters = static_cast<std::size_t>(Degree) + 1;

  std::array<S, parameters> coefficients =
      detail::zeros<S, parameters>();  ///< lowest power first, finite
  S from = not_a_number<S>();          ///< the smallest measure identified, finite, >= 0
  S to = not_a_number<S>();            ///< the largest, finite, > from

  S force_n(const S& measure) const {
    S sum = coefficients[parameters - 1];
    for (std::size_t k = parameters - 1; k-- > 0;) {
      sum = sum * measure + coefficients[k];
    }
    return sum;
  }
  /// dF/dm.
  S slope(const S& measure) const {
    S sum = S(Degree) * coefficients[parameters - 1];
    for (int k = Degree - 1; k >= 1; --k) {
      sum = sum * measure + S(k) * coefficients[static_cast<std::size_t>(k)];
    }
    return sum;
  }
  /// Derivatives of F by the coefficients.
  std::array<S, parameters> gradient(const S& measure) const {
    std::array<S, parameters> powers;
    powers[0] = S(1);
    for (std::size_t k = 1; k < parameters; ++k) {
      powers[k] = powers[k - 1] * measure;
    }
    return powers;
  }
  /// Derivatives of the slope by the coefficients.
  std::array<S, parameters> slope_gradient(const S& measure) const {
    const std::array<S, parameters> powers = gradient(measure);
    std::array<S, parameters> slopes;
    slopes[0] = S(0);
    for (std::size_t k = 1; k < parameters; ++k) {
      slopes[k] = S(static_cast<int>(k)) * powers[k - 1];
    }
    return slopes;
  }
};

/// Elastic pads: the contact radius grows with a power of the force, r_c = c f^gamma (eq. 1 of the
/// source of normal_force.hpp, after Xydas and Kao 1999; gamma is 1/3 for Hertz's contact). The
/// measure is the radius. The sources print neither c nor gamma: fit_power_law identifies them.
template <scalar S = double>
struct PowerLawForce {
  using number = S;
  static constexpr std::size_t parameters = 2;

  S coefficient_mm = not_a_number<S>();  ///< c, the radius at 1 N, finite, > 0
  S exponent = not_a_number<S>();        ///< gamma, in (0, 2]
  S from = not_a_number<S>();            ///< the smallest radius identified, mm, >= 0
  S to = not_a_number<S>();              ///< the largest, mm, > from

  S force_n(const S& radius_mm) const {
    using std::exp;
    return value(radius_mm) > 0 ? S(exp(S(log_ratio(radius_mm) / exponent))) : S(0);
  }
  S slope(const S& radius_mm) const {
    const S force = force_n(radius_mm);
    return value(force) > 0 ? S(force / radius_mm / exponent) : S(0);
  }
  /// Derivatives of F by the coefficient and by the exponent.
  std::array<S, parameters> gradient(const S& radius_mm) const {
    if (!(value(radius_mm) > 0)) {
      return {S(0), S(0)};
    }
    const S force = force_n(radius_mm);
    return {S(-force / S(exponent * coefficient_mm)),
            S(-force * log_ratio(radius_mm) / square(exponent))};
  }
  /// Derivatives of the slope by both.
  std::array<S, parameters> slope_gradient(const S& radius_mm) const {
    if (!(value(radius_mm) > 0)) {
      return {S(0), S(0)};
    }
    const S steep = slope(radius_mm);
    return {S(-steep / S(exponent * coefficient_mm)),
            S(-steep * (log_ratio(radius_mm) / exponent + S(1)) / exponent)};
  }
  /// The radius in mm for a force in N, the inverse of force_n(); 0 for a force <= 0.
  S radius_mm(const S& force) const {
    using std::exp;
    using std::log;
    if (!(value(force) > 0)) {
      return S(0);
    }
    const S log_force = log(force);
    return S(coefficient_mm * S(exp(S(exponent * log_force))));
  }

 private:
  S log_ratio(const S& radius_mm) const {
    using std::log;
    const S ratio = radius_mm / coefficient_mm;
    return log(ratio);
  }
};

/// The uncertainty of a force from a curve. Three things contribute: the curve's parameters, what
/// the calibration could not explain, and noise of the measure beyond that in the calibration.
template <std::size_t Parameters, scalar S = double>
struct CurveErrors {
  static constexpr std::size_t size = Parameters;

  std::array<std::array<S, size>, size> covariance =
      detail::zero_matrix<S, size>();  ///< of the parameters: symmetric, no eigenvalue < 0
  S residual_sd_n = S(0);              ///< standard deviation of a sample about the curve, N, >= 0
  S measure_sd = S(0);  ///< sd of noise in the measure beyond that of the samples, >= 0

  /// Variance in N^2 of the force where the curve has this gradient and slope.
  S variance_n2(const std::array<S, size>& gradient, const S& slope) const {
    S sum = square(residual_sd_n) + square(S(slope * measure_sd));
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        sum = sum + gradient[i] * covariance[i][j] * gradient[j];
      }
    }
    return sum;
  }
};

namespace detail {

/// Refuses an empty range, and a curve whose force or slope is not finite at its end.
template <class Curve>
void expects_range(const Curve& curve, const char* owner) {
  expects(is_finite(curve.from) && value(curve.from) >= 0, owner, "from", curve.from,
          "finite and >= 0");
  expects(is_finite(curve.to) && value(curve.to) > value(curve.from), owner, "to", curve.to,
          "finite and > from");
  expects(is_finite(curve.force_n(curve.to)) && is_finite(curve.slope(curve.to)), owner, "to",
          curve.to, "where force and slope are finite");
}

/// Whether a matrix can be a covariance: symmetric and positive semidefinite, up to rounding.
template <scalar S, std::size_t N>
bool is_covariance(const SmallMatrix<S, N>& covariance) {
  const double rounding =
      std::sqrt(static_cast<double>(epsilon<S>()) + static_cast<double>(epsilon<double>()));
  SmallMatrix<double, N> a{};
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      a[i][j] = static_cast<double>(value(covariance[i][j]));
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double largest = std::sqrt(a[i][i]) * std::sqrt(a[j][j]);
      const bool is_symmetric = std::abs(a[i][j] - a[j][i]) <= rounding * largest;
      if (!is_symmetric || !(std::abs(a[i][j]) <= (1 + rounding) * largest)) {
        return false;
      }
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    a[i][i] += a[i][i] > 0 ? rounding * a[i][i] : 1.0;
  }
  for (std::size_t k = 0; k < N; ++k) {  // elimination: a pivot below 0 is a variance below 0
    if (!(a[k][k] > 0)) {
      return false;
    }
    for (std::size_t i = k + 1; i < N; ++i) {
      for (std::size_t j = k + 1; j < N; ++j) {
        a[i][j] -= a[i][k] * a[k][j] / a[k][k];
      }
    }
  }
  return true;
}

}  // namespace detail

/// Refuses values out of range, and a force that falls while the contact grows (parameter_error).
template <int Degree, scalar S>
void expects_valid(const PolynomialForce<Degree, S>& curve) {
  const char* const owner = "PolynomialForce";
  for (const S& coefficient : curve.coefficients) {
    expects(is_finite(coefficient), owner, "coefficients", coefficient, "finite");
  }
  detail::expects_range(curve, owner);
  const S& constant = curve.coefficients[0];
  expects(value(curve.from) > 0 || value(constant) == 0, owner, "first of the coefficients",
          constant, "0 if from is 0, else the force would begin with a step");
  constexpr int steps = Degree > 2 ? 16 : 1;  // a slope of first degree is lowest at an end
  const S end = curve.force_n(curve.to);
  const S size = value(end) < 0 ? S(-end) : end;
  const S rounding = S(64 * epsilon<S>()) * size / curve.to;  // of the slope at a level end
  for (int k = 0; k <= steps; ++k) {
    const S share = S(k) / S(steps);
    const S slope = curve.slope(S(curve.from + share * (curve.to - curve.from)));
    expects(value(slope) >= -value(rounding), owner, "slope within the range", slope, ">= 0");
  }
}
template <scalar S>
void expects_valid(const PowerLawForce<S>& curve) {
  const char* const owner = "PowerLawForce";
  expects(is_finite(curve.coefficient_mm) && value(curve.coefficient_mm) > 0, owner,
          "coefficient_mm", curve.coefficient_mm, "finite and > 0");
  expects(value(curve.exponent) > 0 && value(curve.exponent) <= 2, owner, "exponent",
          curve.exponent, "in (0, 2]");
  detail::expects_range(curve, owner);
}
template <std::size_t Parameters, scalar S>
void expects_valid(const CurveErrors<Parameters, S>& errors) {
  const char* const owner = "CurveErrors";
  for (std::size_t i = 0; i < errors.size; ++i) {
    for (const S& entry : errors.covariance[i]) {
      expects(is_finite(entry), owner, "covariance", entry, "finite");
    }
    expects(value(errors.covariance[i][i]) >= 0, owner, "variance of a parameter",
            errors.covariance[i][i], ">= 0");
  }
  if (!detail::is_covariance(errors.covariance)) {
    refuse("CurveErrors: covariance must be symmetric, without a negative eigenvalue");
  }
  expects(is_finite(errors.residual_sd_n) && value(errors.residual_sd_n) >= 0, owner,
          "residual_sd_n", errors.residual_sd_n, "finite and >= 0");
  expects(is_finite(errors.measure_sd) && value(errors.measure_sd) >= 0, owner, "measure_sd",
          errors.measure_sd, "finite and >= 0");
}

}  // namespace v0
}  // namespace fingerpad
