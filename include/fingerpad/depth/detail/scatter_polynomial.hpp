// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth from two colours without an exponential or a square root per pixel. With s = l / l_max and
// u = (rho / rho_max)^2 the absorption balance b e^{delta k l} - kappa r + g W(l) = 0 becomes
//   kappa r - b = sum_j (b E_j(u) + g W_j(u)) s^j,   j = 1..Degree,
// where E stands for e^{delta k l} - 1 and W for the scatter integral, both fitted near-minimax.
// The right side grows from 0 at s = 0 to `total` at s = 1, so the range tests are exact
// comparisons. The start of the iteration, a hyperbola through both ends with the slope at s = 0,
// never leaves [0, 1].
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <type_traits>

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Where a table is valid: pixels on the plate around the optical axis, depths up to `l_max_mm`.
struct ScatterDomain {
  double center_row_px;
  double center_col_px;
  double pitch_mm;    ///< mm on the plate per pixel
  double rho_max_mm;  ///< radius on the plate
  double l_max_mm;
};

/// Coefficients of E and W: row j - 1 belongs to s^j, column p to u^p.
/// Degree 5 or 6, Radial 3 suit float; Radial 4 a wide-angle camera; 12 and 8 suit double.
template <int Degree, class Scalar = float, int Radial = (sizeof(Scalar) > 4 ? 8 : 3)>
struct ScatterPolynomial {
  static_assert(Degree >= 4 && Degree <= 16 && Radial >= 2 && Radial <= 8);
  static constexpr int exp_degree = (Degree + 3) / 2;  // fewer terms, as delta k l_max is small

  // Higher powers of s carry less of the sum, so they need less of u.
  static constexpr int scatter_radial(int j) { return at_least(1, Radial - j / 2); }
  static constexpr int exp_radial(int j) { return at_least(0, Radial - j); }
  static constexpr int at_least(int low, int n) { return n < low ? low : n; }

  using Row = Scalar[std::size_t(Radial) + 1];
  Row scatter[std::size_t(Degree)] = {};
  Row exp_minus_1[std::size_t(exp_degree)] = {};
  Scalar kappa = Scalar(1);
  Scalar l_max_mm = Scalar(0);
  Scalar center_row_px = Scalar(0);
  Scalar center_col_px = Scalar(0);
  Scalar u_root_per_px = Scalar(0);  ///< pitch / rho_max: u is the square of this times px
};

/// Chebyshev projection of f(s, u) on [0, 1]^2 to sum c[j][p] s^j u^p, p <= radial(j), from the
/// highest power down. Each coefficient is rounded to Scalar and removed before the next is taken,
/// so that the lower powers make up for what rounding and truncation cut off.
template <std::size_t Rows, std::size_t Cols, class Scalar, class Radial, class Function>
void project(const Function& f, const Radial& radial, Scalar (&c)[Rows][Cols]) {
  constexpr int num_s = int(Rows) + 8;
  constexpr int num_u = int(Cols) + 8;
  const auto angle = [](int i, int n) { return std::numbers::pi * (i + 0.5) / n; };
  const auto node = [&](int i, int n) { return 0.5 + 0.5 * std::cos(angle(i, n)); };
  double rest[Rows + 8][Cols + 8];
  for (int i = 0; i < num_s; ++i) {
    for (int a = 0; a < num_u; ++a) {
      rest[i][a] = f(node(i, num_s), node(a, num_u));
    }
  }
  for (int j = int(Rows) - 1; j >= 0; --j) {
    for (int p = radial(j); p >= 0; --p) {
      double sum = 0;
      for (int i = 0; i < num_s; ++i) {
        for (int a = 0; a < num_u; ++a) {
          sum += rest[i][a] * std::cos(j * angle(i, num_s)) * std::cos(p * angle(a, num_u));
        }
      }
      c[j][p] = Scalar(std::ldexp(sum / (num_s * num_u), 2 * (j + p)));  // T_n leads with 2^{2n-1}
      for (int i = 0; i < num_s; ++i) {
        for (int a = 0; a < num_u; ++a) {
          rest[i][a] -= double(c[j][p]) * std::pow(node(i, num_s), j) * std::pow(node(a, num_u), p);
        }
      }
    }
  }
}

/// Builds the table. `w_over_l(l_mm, rho_mm)` is W(l) / l, times g(rho) when no gain plane is used;
/// `delta_k(rho_mm)` is (c_green - c_red) k in 1/mm. Both must be smooth in rho^2, also at l = 0.
template <class Table, class Scatter, class Exponent>
Table make_scatter_polynomial(const ScatterDomain& domain,
                              double kappa,
                              const Scatter& w_over_l,
                              const Exponent& delta_k) {
  using Scalar = decltype(Table::kappa);
  const double l_max = domain.l_max_mm;
  const auto rho = [&](double u) { return domain.rho_max_mm * std::sqrt(u); };
  Table table;
  project([&](double s, double u) { return l_max * w_over_l(l_max * s, rho(u)); },
          Table::scatter_radial, table.scatter);
  project([&](double s, double u) { return std::expm1(l_max * s * delta_k(rho(u))) / s; },
          Table::exp_radial, table.exp_minus_1);
  table.kappa = Scalar(kappa);
  table.l_max_mm = Scalar(l_max);
  table.center_row_px = Scalar(domain.center_row_px);
  table.center_col_px = Scalar(domain.center_col_px);
  table.u_root_per_px = Scalar(domain.pitch_mm / domain.rho_max_mm);
  return table;
}

/// c[0] + c[1] u + ... + c[last] u^last.
template <class V, class Scalar>
[[gnu::always_inline]] inline V polynomial(const Scalar* c, int last, V u) noexcept {
  using Coefficient = std::conditional_t<std::is_floating_point_v<V>, V, Scalar>;
  V sum = V{} + Coefficient(c[last]);
  for (int p = last - 1; p >= 0; --p) {
    sum = sum * u + Coefficient(c[p]);
  }
  return sum;
}

/// Bound of the depth error in mm that the two fits cause, over a dense grid of depth and radius,
/// for green values up to `green_max` and the gain `gain` (1 when folded into `w_over_l`).
template <class Table, class Scatter, class Exponent>
double error_bound_mm(const Table& table,
                      const ScatterDomain& domain,
                      const Scatter& w_over_l,
                      const Exponent& delta_k,
                      double green_max,
                      double gain) {
  constexpr int num_s = 128, num_u = 32;
  const auto sum = [](const auto& rows, double s, double u, double& slope) {
    double value = 0;
    slope = 0;
    for (std::size_t j = sizeof(rows) / sizeof(rows[0]); j-- > 0;) {
      const int last = int(sizeof(rows[0]) / sizeof(rows[0][0])) - 1;
      value = value * s + polynomial(rows[j], last, u);
      slope = slope * s + value;
    }
    return value * s;
  };
  double bound = 0;
  for (int a = 0; a <= num_u; ++a) {
    for (int i = 1; i <= num_s; ++i) {
      const double s = double(i) / num_s, u = double(a) / num_u;
      const double l = domain.l_max_mm * s, rho = domain.rho_max_mm * std::sqrt(u);
      double w_slope, e_slope;
      const double w = sum(table.scatter, s, u, w_slope) - l * w_over_l(l, rho);
      const double e = sum(table.exp_minus_1, s, u, e_slope) - std::expm1(l * delta_k(rho));
      const double miss = gain * std::abs(w) + green_max * std::abs(e);
      const double error_mm = domain.l_max_mm * miss / (gain * w_slope);
      if (!(w_slope > 0 && error_mm >= 0)) {  // not rising, or NaN
        return std::numeric_limits<double>::infinity();
      }
      bound = (std::max)(bound, error_mm);
    }
  }
  return bound;
}
}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
