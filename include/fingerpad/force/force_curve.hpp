// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Normal force as a function of one measure of the contact: its area in mm^2, its depth in mm or
// its radius in mm. A curve says how the force rises, and over which range that was identified.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/force/detail/smooth_step.hpp"
#include "fingerpad/force/detail/zeros.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// F = c_0 + c_1 m + c_2 m^2 + ..., in N; c_k in N over the measure's unit to the k-th.
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
      sum = S(sum * measure) + coefficients[k];
    }
    return sum;
  }
  /// dF/dm.
  S slope(const S& measure) const {
    S sum = S(Degree) * coefficients[parameters - 1];
    for (int k = Degree - 1; k >= 1; --k) {
      sum = S(sum * measure) + S(S(k) * coefficients[static_cast<std::size_t>(k)]);
    }
    return sum;
  }
  /// dF by each coefficient.
  std::array<S, parameters> gradient(const S& measure) const {
    std::array<S, parameters> powers;
    powers[0] = S(1);
    for (std::size_t k = 1; k < powers.size(); ++k) {
      powers[k] = powers[k - 1] * measure;
    }
    return powers;
  }
};

/// Ito, Kim and Obinata, eq. 18, over about 1 to 28 N, where both curves rise together. They give
/// 0.62 N and 0.34 N without contact, which NormalForce fades out.
template <scalar S = double>
PolynomialForce<2, S> published_force_of_area() {
  return {{S(0.6242), S(0.0191), S(0.00008)}, S(18), S(478)};
}
template <scalar S = double>
PolynomialForce<2, S> published_force_of_depth() {
  return {{S(0.3435), S(0.5563), S(0.776)}, S(0.63), S(5.62)};
}

/// Elastic pads: the contact radius grows with a power of the force, r_c = c f^gamma (eq. 1 there,
/// after Xydas and Kao 1999; gamma is 1/3 for Hertz's contact). The measure is the radius. The
/// sources print neither c nor gamma: fit_power_law identifies them.
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
    using std::log;
    if (!(value(radius_mm) > 0)) {
      return S(0);
    }
    const S ratio = radius_mm / coefficient_mm;
    const S log_ratio = log(ratio);
    return S(exp(S(log_ratio / exponent)));
  }
  S slope(const S& radius_mm) const {
    if (!(value(radius_mm) > 0)) {
      return S(0);
    }
    const S force = force_n(radius_mm);
    return value(force) > 0 ? S(S(force / radius_mm) / exponent) : S(0);
  }
  /// dF by the coefficient and by the exponent.
  std::array<S, parameters> gradient(const S& radius_mm) const {
    using std::log;
    if (!(value(radius_mm) > 0)) {
      return {S(0), S(0)};
    }
    const S force = force_n(radius_mm);
    const S ratio = radius_mm / coefficient_mm;
    const S log_ratio = log(ratio);
    return {S(-force / S(exponent * coefficient_mm)), S(S(-force * log_ratio) / square(exponent))};
  }
  /// The inverse; 0 for a force that does not press.
  S radius_mm(const S& force) const {
    using std::exp;
    using std::log;
    if (!(value(force) > 0)) {
      return S(0);
    }
    const S log_force = log(force);
    return S(coefficient_mm * S(exp(S(exponent * log_force))));
  }
};

/// Refuses what has no meaning (parameter_error), and a force that falls while the contact grows.
template <int Degree, scalar S>
void expects_valid(const PolynomialForce<Degree, S>& curve) {
  const char* const owner = "PolynomialForce";
  for (const S& coefficient : curve.coefficients) {
    expects(is_finite(coefficient), owner, "coefficients", coefficient, "finite");
  }
  expects(is_finite(curve.from) && value(curve.from) >= 0, owner, "from", curve.from,
          "finite and >= 0");
  const S& constant = curve.coefficients[0];
  expects(value(curve.from) > 0 || value(constant) == 0, owner, "first of the coefficients",
          constant, "0 where from is 0: the force would begin with a step");
  expects(is_finite(curve.to) && value(curve.to) > value(curve.from), owner, "to", curve.to,
          "finite and > from");
  constexpr int steps = Degree > 2 ? 16 : 1;  // a slope of first degree is lowest at an end
  const S end = curve.force_n(curve.to);
  const S end_slope = curve.slope(curve.to);
  expects(is_finite(end) && is_finite(end_slope), owner, "to", curve.to,
          "where force and slope are finite");
  const S size = value(end) < 0 ? S(-end) : end;
  const S rounding = S(64 * epsilon<S>()) * S(size / curve.to);  // of the slope of a level end
  for (int k = 0; k <= steps; ++k) {
    const S share = S(k) / S(steps);
    const S slope = curve.slope(S(curve.from + S(share * S(curve.to - curve.from))));
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
  expects(is_finite(curve.from) && value(curve.from) >= 0, owner, "from", curve.from,
          "finite and >= 0");
  expects(is_finite(curve.to) && value(curve.to) > value(curve.from), owner, "to", curve.to,
          "finite and > from");
  const S end = curve.force_n(curve.to);
  const S end_slope = curve.slope(curve.to);
  expects(is_finite(end) && is_finite(end_slope), owner, "to", curve.to,
          "where force and slope are finite");
}

namespace detail {

/// A curve over all measures: none where there is no contact, faded in smoothly below the range,
/// and beyond it carried on along the tangent, since a polynomial may do anything there.
template <class Curve>
class WholeCurve {
 public:
  using S = typename Curve::number;

  explicit WholeCurve(const Curve& curve)
      : curve_(curve),
        end_slope_(curve.slope(curve.to)),
        one_over_from_(value(curve.from) > value(S(1e-30)) ? S(S(1) / curve.from) : S(1e30)) {}

  const Curve& curve() const { return curve_; }

  /// The same for whatever is not a number as for no contact: look at the measure first.
  S force_n(const S& measure) const {
    const S held = held_within(measure);
    const S past = measure - held;
    const S beyond = value(past) > 0 ? past : S(0);
    const S force = curve_.force_n(held) + S(end_slope_ * beyond);
    return S(force * fade(measure));
  }
  /// dF/dm.
  S slope(const S& measure) const {
    const S held = held_within(measure);
    return S(S(curve_.slope(held) * fade(measure)) + S(curve_.force_n(held) * fade_slope(measure)));
  }
  /// How much of the force is faded in, in [0, 1]: 1 from the start of the range on.
  S fade(const S& measure) const { return smooth_step(S(held_within(measure) * one_over_from_)); }
  S fade_slope(const S& measure) const {
    return S(smooth_step_slope(S(held_within(measure) * one_over_from_)) * one_over_from_);
  }

 private:
  S held_within(const S& measure) const {
    const S above = value(measure) > 0 ? measure : S(0);
    return value(above) <= value(curve_.to) ? above : curve_.to;
  }

  Curve curve_;
  S end_slope_;
  S one_over_from_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
