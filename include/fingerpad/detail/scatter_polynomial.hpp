// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth from two colours without an exponential or a square root per pixel. With s = l / l_max and
// u = (rho / rho_max)^2 the absorption balance b e^{delta k l} - kappa r + g W(l) = 0 becomes
//   (kappa r - b) = sum_j (b E_j(u) + g W_j(u)) s^j,   j = 1..Degree,
// where E approximates e^{delta k l} - 1 and W the scatter integral, both to near-minimax accuracy.
// The right side grows from 0 at s = 0 to `total` at s = 1, so the range tests are exact signs and
// the start, a hyperbola through both ends with the slope at s = 0, never leaves [0, 1].
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <type_traits>

namespace fingerpad { inline namespace v0 { namespace detail {

enum class InversionStatus : std::uint8_t {
  ok = 0,
  below_range = 1,   ///< the colours ask for a depth below zero
  above_range = 2,   ///< the colours ask for a depth above l_max
  not_a_number = 3,  ///< a colour, the gain or the start slope is unusable
  outside = 4,       ///< farther from the optical axis than the table reaches
};

/// Where the table is valid: pixels on the plate around the optical axis, depths up to `l_max_mm`.
struct ScatterDomain {
  double centre_row_px;
  double centre_col_px;
  double pitch_mm;  ///< mm on the plate per pixel
  double rho_max_mm;
  double l_max_mm;
};

/// Coefficients of E and W; row j - 1 belongs to s^j, column p to u^p.
template <int Degree, class Scalar = float>
struct ScatterPolynomial {
  static_assert(Degree >= 3 && Degree <= 16);
  static constexpr bool is_single = sizeof(Scalar) <= 4;
  static constexpr int radial_degree = is_single ? 3 : 8;
  static constexpr int exp_degree = (Degree + 3) / 2;  // delta k l_max is small: fewer terms do

  /// Higher powers of s carry less of W, so they need less of u.
  static constexpr int radial_degree_of(int power) {
    const int reduced = radial_degree - (power - 1) / 2;
    return reduced > 1 ? reduced : 1;
  }

  Scalar exp_minus_one[exp_degree][radial_degree + 1] = {};
  Scalar scatter[Degree][radial_degree + 1] = {};
  Scalar kappa = Scalar(1);
  Scalar l_max_mm = Scalar(0);
  Scalar centre_row_px = Scalar(0);
  Scalar centre_col_px = Scalar(0);
  Scalar u_root_per_px = Scalar(0);  ///< pitch / rho_max, so that u = (this * distance in px)^2
};

/// Chebyshev projection of f(s, u) on [0, 1]^2 to sum c[j][p] s^j u^p, highest power first: each
/// coefficient is rounded and removed before the next, so lower powers absorb what was cut off.
template <class Table, int Rows, int Cols, class Scalar, class Function>
void project(const Function& f, Scalar (&c)[Rows][Cols]) {
  constexpr int num_s = Rows + 8;
  constexpr int num_u = Cols + 8;
  const auto angle = [](int i, int n) { return std::numbers::pi * (i + 0.5) / n; };
  const auto node = [&](int i, int n) { return 0.5 + 0.5 * std::cos(angle(i, n)); };
  double rest[num_s][num_u];
  for (int i = 0; i < num_s; ++i)
    for (int a = 0; a < num_u; ++a) rest[i][a] = f(node(i, num_s), node(a, num_u));
  for (int j = Rows - 1; j >= 0; --j)
    for (int p = Table::radial_degree_of(j + 1); p >= 0; --p) {
      double sum = 0;
      for (int i = 0; i < num_s; ++i)
        for (int a = 0; a < num_u; ++a)
          sum += rest[i][a] * std::cos(j * angle(i, num_s)) * std::cos(p * angle(a, num_u));
      c[j][p] = Scalar(std::ldexp(sum / (num_s * num_u), 2 * (j + p)));
      for (int i = 0; i < num_s; ++i)
        for (int a = 0; a < num_u; ++a)
          rest[i][a] -= double(c[j][p]) * std::pow(node(i, num_s), j) * std::pow(node(a, num_u), p);
    }
}

/// Builds the table. `w_over_l(l_mm, rho_mm)` is W(l) / l, times g(rho) when no gain plane is used;
/// `delta_k(rho_mm)` is (c_green - c_red) k in 1/mm. Both are smooth in rho^2 and finite at l = 0.
template <int Degree, class Scalar = float, class Scatter, class Exponent>
ScatterPolynomial<Degree, Scalar> make_scatter_polynomial(const ScatterDomain& domain,
                                                          double kappa,
                                                          const Scatter& w_over_l,
                                                          const Exponent& delta_k) {
  using Table = ScatterPolynomial<Degree, Scalar>;
  Table table;
  const double l_max = domain.l_max_mm;
  const auto rho = [&](double u) { return domain.rho_max_mm * std::sqrt(u); };
  project<Table>([&](double s, double u) { return l_max * w_over_l(l_max * s, rho(u)); },
                 table.scatter);
  project<Table>([&](double s, double u) { return std::expm1(l_max * s * delta_k(rho(u))) / s; },
                 table.exp_minus_one);
  table.kappa = Scalar(kappa);
  table.l_max_mm = Scalar(l_max);
  table.centre_row_px = Scalar(domain.centre_row_px);
  table.centre_col_px = Scalar(domain.centre_col_px);
  table.u_root_per_px = Scalar(domain.pitch_mm / domain.rho_max_mm);
  return table;
}

/// A vector of as many scalars as one register of the target holds, or one scalar elsewhere.
template <class Scalar>
struct Pack {
#if defined(__GNUC__)
#if defined(__AVX512F__)
  static constexpr int bytes = 64;
#elif defined(__AVX__)
  static constexpr int bytes = 32;
#else
  static constexpr int bytes = 16;
#endif
  typedef Scalar type __attribute__((vector_size(bytes)));
#else
  static constexpr int bytes = sizeof(Scalar);
  using type = Scalar;
#endif
  static constexpr int size = bytes / int(sizeof(Scalar));
};

template <class V, class Scalar>
V load(const Scalar* from) noexcept {
  V v;
  std::memcpy(&v, from, sizeof(V));
  return v;
}

/// c[0] + c[1] u + ... + c[last] u^last.
template <class V, class Scalar>
[[gnu::always_inline]] inline V radial(const Scalar* c, int last, V u) noexcept {
  V sum = c[last] + V{};
  for (int p = last - 1; p >= 0; --p) sum = sum * u + c[p];
  return sum;
}

/// A mask with every lane set or clear, reduced to one answer.
template <class Mask>
bool any(const Mask& mask) noexcept {
  std::uint64_t words[sizeof(Mask) / 8];
  std::memcpy(words, &mask, sizeof(Mask));
  std::uint64_t found = 0;
  for (const std::uint64_t word : words) found |= word;
  return found != 0;
}

#ifndef ORDER
#define ORDER 3
#endif
/// Marks in the depth of a pixel without a root, replaced by NaN when the status is written.
template <class Scalar>
inline constexpr Scalar below_mark = Scalar(-1);
template <class Scalar>
inline constexpr Scalar above_mark = Scalar(-2);

/// One register of pixels. Lanes where `good` comes back false hold a mark or NaN.
template <int Steps, class V, class Mask, int Degree, class Scalar, class Gain>
[[gnu::always_inline]] inline V invert_pack(const ScatterPolynomial<Degree, Scalar>& table,
              V u,
              V red,
              V green,
              Gain gain,
              Mask& good) noexcept {
  using Table = ScatterPolynomial<Degree, Scalar>;
  V f[Degree];
  V total = V{};
#pragma GCC unroll 16
  for (int j = Degree - 1; j >= 0; --j) {
    f[j] = radial(table.scatter[j], Table::radial_degree_of(j + 1), u);
    if constexpr (std::is_same_v<Gain, V>) f[j] = f[j] * gain;
    if (j < Table::exp_degree)
      f[j] = f[j] + green * radial(table.exp_minus_one[j], Table::radial_degree_of(j + 1), u);
    total = j == Degree - 1 ? f[j] : total + f[j];
  }
  const V target = table.kappa * red - green;
  V s = target * total / (f[0] * (total - target) + target * total);
  V slope = V{};
#pragma GCC unroll 4
  for (int step = 0; step < Steps; ++step) {
    V value = f[Degree - 1];
    slope = value;
    V bend = value;
    value = value * s + f[Degree - 2];
    slope = slope * s + value;
#pragma GCC unroll 16
    for (int j = Degree - 3; j >= 0; --j) {
      if (ORDER == 3) bend = bend * s + slope;
      value = value * s + f[j];
      slope = slope * s + value;
    }
    value = value * s - target;
    if (ORDER == 3)
      s = s - value * slope / (slope * slope - value * bend);
    else
      s = s - value / slope;
  }
  good = (target >= Scalar(0)) & (target <= total) & (slope > Scalar(0));
#ifdef CLAMP
  s = s < Scalar(0) ? V{} : s;
  s = s > Scalar(1) ? V{} + Scalar(1) : s;
#endif
  const V nan = V{} + std::numeric_limits<Scalar>::quiet_NaN();
  const V above = target > total ? V{} + above_mark<Scalar> : nan;
  const V mark = target < Scalar(0) ? V{} + below_mark<Scalar> : above;
  return good ? s * table.l_max_mm : mark;
}

template <class Scalar>
void write_status(Scalar* depth, std::uint8_t* status, int count) noexcept {
  for (int i = 0; i < count; ++i) {
    const Scalar d = depth[i];
    const int bad = d == below_mark<Scalar> ? 1 : d == above_mark<Scalar> ? 2 : 3;
    const bool ok = d > Scalar(-0.5);
    status[i] = std::uint8_t(ok ? 0 : bad);
    depth[i] = ok ? d : std::numeric_limits<Scalar>::quiet_NaN();
  }
}

template <int Steps, int Degree, class Scalar, class Gain>
void invert_row(const ScatterPolynomial<Degree, Scalar>& shared,
                std::ptrdiff_t row,
                std::ptrdiff_t cols,
                const Scalar* red,
                const Scalar* green,
                Gain gain,
                Scalar* depth_mm,
                std::uint8_t* status) noexcept {
  const ScatterPolynomial<Degree, Scalar> table = shared;
  using V = typename Pack<Scalar>::type;
  constexpr int lanes = Pack<Scalar>::size;
  constexpr int chunk = 64;
  V ramp;
  for (int t = 0; t < lanes; ++t) reinterpret_cast<Scalar*>(&ramp)[t] = Scalar(t);
  const Scalar dy = (Scalar(row) - table.centre_row_px) * table.u_root_per_px;
  const Scalar dy_sq = dy * dy;
  for (std::ptrdiff_t first = 0; first + chunk <= cols; first += chunk) {
    auto bad = V{} != V{};
    for (int t = 0; t < chunk; t += lanes) {
      const std::ptrdiff_t col = first + t;
      const V dx = (ramp + (Scalar(col) - table.centre_col_px)) * table.u_root_per_px;
      const V u = dx * dx + dy_sq;
      auto good = bad;
      V d;
      if constexpr (std::is_same_v<Gain, std::nullptr_t>)
        d = invert_pack<Steps>(table, u, load<V>(red + col), load<V>(green + col), nullptr, good);
      else
        d = invert_pack<Steps>(table, u, load<V>(red + col), load<V>(green + col), load<V>(gain + col), good);
      bad = bad | ~good;
      std::memcpy(depth_mm + col, &d, sizeof d);
    }
    if (any(bad)) write_status(depth_mm + first, status + first, chunk);
    else std::memset(status + first, 0, chunk);
  }
}
}}}  // namespace fingerpad::v0::detail
