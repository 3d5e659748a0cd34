// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The light over a pad, g(x, y) and kappa(x, y): polynomials of the place on the plate, because a
// lamp lights no pad evenly. The depth equation
//   green exp(delta k l) - kappa(x, y) red + g(x, y) W(l) = 0
// is linear in all their coefficients.
#include <array>
#include <cstddef>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// A polynomial of the place on the plate, with x and y in units of scale_mm.
template <scalar S, int Degree>
struct PlanePolynomial {
  static constexpr std::size_t terms = static_cast<std::size_t>((Degree + 1) * (Degree + 2) / 2);

  std::array<S, terms> coefficient = none();  ///< of 1; x, y; x^2, x y, y^2; ...
  S scale_mm = S(1);                          ///< > 0

  static std::array<S, terms> monomials(const S& x, const S& y) {
    std::array<S, terms> m = none();
    m[0] = S(1);
    std::size_t at = 1;
    for (std::size_t n = 1; n <= static_cast<std::size_t>(Degree); ++n, at += n) {
      for (std::size_t j = 0; j < n; ++j) {
        m[at + j] = m[at + j - n] * x;
      }
      m[at + n] = m[at - 1] * y;
    }
    return m;
  }
  S at(const Point2<S>& plate_mm) const {
    const auto m = monomials(plate_mm.x / scale_mm, plate_mm.y / scale_mm);
    S sum = S(0);
    for (std::size_t k = 0; k < terms; ++k) {
      sum = sum + coefficient[k] * m[k];
    }
    return sum;
  }

 private:
  static std::array<S, terms> none() {
    std::array<S, terms> all;
    all.fill(S(0));
    return all;
  }
};

/// The light over a pad. A lamp's colours vary less than its brightness.
template <scalar S = double, int Degree = 6>
struct PadLight {
  PlanePolynomial<S, Degree> scattering;           ///< g, grey levels per mm^2
  PlanePolynomial<S, (Degree > 0 ? 1 : 0)> kappa;  ///< alpha_G beta_G / (alpha_R beta_R)
};

}  // namespace v1
}  // namespace fingerpad
