// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth from two colours without an exponential or a square root per pixel. With s = l / l_max and
// u = (rho / rho_max)^2 the absorption balance b e^{delta k l} - kappa r + g W(l) = 0 becomes
//   kappa r - b = sum_j (b E_j(u) + g W_j(u)) s^j,   j = 1..Degree,
// where E stands for e^{delta k l} - 1 and W for the scatter integral, both near-minimax.
// The right side grows from 0 at s = 0 to `total` at s = 1, so the range tests are exact signs and
// the start, a hyperbola through both ends with the slope at s = 0, never leaves [0, 1].
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

/// What `invert_row` writes per pixel; the depth is NaN unless the status is `ok`.
enum class InversionStatus : std::uint8_t {
  ok = 0,
  below_range = 1,   ///< kappa r < b: the colours ask for a depth below zero
  above_range = 2,   ///< the colours ask for a depth above l_max
  not_a_number = 3,  ///< a colour or the gain is not finite, or the iteration failed
  outside = 4,       ///< farther from the optical axis than rho_max
};

/// Where a table is valid: pixels on the plate around the optical axis, depths up to `l_max_mm`.
struct ScatterDomain {
  double centre_row_px;
  double centre_col_px;
  double pitch_mm;    ///< mm on the plate per pixel
  double rho_max_mm;  ///< radius on the plate
  double l_max_mm;
};

/// Coefficients of E and W: row j - 1 belongs to s^j, column p to u^p.
/// Degree 5 or 6, Radial 3 suit float; Radial 4 a wide-angle camera; 12 and 8 suit double.
template <int Degree, class Scalar = float, int Radial = (sizeof(Scalar) > 4 ? 8 : 3)>
struct ScatterPolynomial {
  static_assert(Degree >= 4 && Degree <= 16 && Radial >= 2 && Radial <= 8);
  static constexpr int exp_degree = (Degree + 3) / 2;  // delta k l_max is small: fewer terms do

  // Higher powers of s carry less of the sum, so they need less of u.
  static constexpr int scatter_radial(int j) { return at_least(1, Radial - j / 2); }
  static constexpr int exp_radial(int j) { return at_least(0, Radial - j); }
  static constexpr int at_least(int low, int n) { return n < low ? low : n; }

  using Row = Scalar[std::size_t(Radial) + 1];
  Row scatter[std::size_t(Degree)] = {};
  Row exp_minus_1[std::size_t(exp_degree)] = {};
  Scalar kappa = Scalar(1);
  Scalar l_max_mm = Scalar(0);
  Scalar centre_row_px = Scalar(0);
  Scalar centre_col_px = Scalar(0);
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
  for (int i = 0; i < num_s; ++i)
    for (int a = 0; a < num_u; ++a) rest[i][a] = f(node(i, num_s), node(a, num_u));
  for (int j = int(Rows) - 1; j >= 0; --j)
    for (int p = radial(j); p >= 0; --p) {
      double sum = 0;
      for (int i = 0; i < num_s; ++i)
        for (int a = 0; a < num_u; ++a)
          sum += rest[i][a] * std::cos(j * angle(i, num_s)) * std::cos(p * angle(a, num_u));
      c[j][p] = Scalar(std::ldexp(sum / (num_s * num_u), 2 * (j + p)));  // T_n leads with 2^{2n-1}
      for (int i = 0; i < num_s; ++i)
        for (int a = 0; a < num_u; ++a)
          rest[i][a] -= double(c[j][p]) * std::pow(node(i, num_s), j) * std::pow(node(a, num_u), p);
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
  table.centre_row_px = Scalar(domain.centre_row_px);
  table.centre_col_px = Scalar(domain.centre_col_px);
  table.u_root_per_px = Scalar(domain.pitch_mm / domain.rho_max_mm);
  return table;
}

/// c[0] + c[1] u + ... + c[last] u^last.
template <class V, class Scalar>
[[gnu::always_inline]] inline V polynomial(const Scalar* c, int last, V u) noexcept {
  V sum = V{} + c[last];
  for (int p = last - 1; p >= 0; --p) sum = sum * u + c[p];
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
  for (int a = 0; a <= num_u; ++a)
    for (int i = 1; i <= num_s; ++i) {
      const double s = double(i) / num_s, u = double(a) / num_u;
      const double l = domain.l_max_mm * s, rho = domain.rho_max_mm * std::sqrt(u);
      double w_slope, e_slope;
      const double w = sum(table.scatter, s, u, w_slope) - l * w_over_l(l, rho);
      const double e = sum(table.exp_minus_1, s, u, e_slope) - std::expm1(l * delta_k(rho));
      const double miss = gain * std::abs(w) + green_max * std::abs(e);
      bound = (std::max)(bound, domain.l_max_mm * miss / (gain * w_slope));
    }
  return bound;
}

#if defined(__GNUC__) && !defined(FINGERPAD_NO_VECTOR_EXTENSION)
/// As many scalars as one register of the target holds.
template <class Scalar>
struct Pack {
#if defined(__AVX512F__)
  static constexpr int bytes = 64;
#elif defined(__AVX__)
  static constexpr int bytes = 32;
#else
  static constexpr int bytes = 16;
#endif
  typedef Scalar type __attribute__((vector_size(bytes)));
  static constexpr int lanes = bytes / int(sizeof(Scalar));
};
#else
template <class Scalar>
struct Pack {
  using type = Scalar;
  static constexpr int lanes = 1;
};
#endif

template <class V, class Scalar>
[[gnu::always_inline]] inline V load(const Scalar* from) noexcept {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

inline bool any(bool mask) noexcept {
  return mask;
}

template <class Mask>
bool any(const Mask& mask) noexcept {
  std::uint64_t words[sizeof(Mask) / 8];
  std::memcpy(words, &mask, sizeof mask);
  std::uint64_t found = 0;
  for (const std::uint64_t word : words) found |= word;
  return found != 0;
}

/// Improves a root s of sum f[j] s^{j+1} = target until its error is of the given order in the
/// error of the start: a Halley step for every factor 3 of Order, a Newton step for every 2.
template <int Order, std::size_t Degree, class V>
[[gnu::always_inline]] inline V refine(const V (&f)[Degree], V target, V s) noexcept {
  static_assert(Order == 1 || Order % 2 == 0 || Order % 3 == 0);
  if constexpr (Order == 1) {
    return s;
  } else {
    constexpr bool is_halley = Order % 3 == 0;
    V bend = f[Degree - 1];  // half the second derivative
    V slope = f[Degree - 1];
    V value = f[Degree - 1] * s + f[Degree - 2];
    slope = slope * s + value;
    for (int j = int(Degree) - 3; j >= 0; --j) {
      if constexpr (is_halley) bend = bend * s + slope;
      value = value * s + f[j];
      slope = slope * s + value;
    }
    value = value * s - target;
    if constexpr (is_halley)
      return refine<Order / 3>(f, target, s - value * slope / (slope * slope - value * bend));
    else
      return refine<Order / 2>(f, target, s - value / slope);
  }
}

/// A NaN that says why in its last two bits; any other NaN reads as `not_a_number`.
template <class Scalar>
constexpr Scalar nan_because(InversionStatus why) {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  const Bits bits = std::bit_cast<Bits>(std::numeric_limits<Scalar>::quiet_NaN());
  return std::bit_cast<Scalar>(bits | Bits(3 - int(why)));
}

/// Reads the reasons back from `Count` depths.
template <std::size_t Count, class Scalar>
void write_status(const Scalar* depth_mm, std::uint8_t* status) noexcept {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  Bits bits[Count];
  std::uint8_t code[Count];
  std::memcpy(bits, depth_mm, sizeof bits);
  constexpr Bits infinity = std::bit_cast<Bits>(std::numeric_limits<Scalar>::infinity());
  for (std::size_t i = 0; i < Count; ++i)
    code[i] = std::uint8_t((bits[i] & ~Bits(0) >> 1) > infinity ? 3 - (bits[i] & 3) : 0);
  std::memcpy(status, code, sizeof code);
}

/// Depth of one register of pixels, or a NaN with its reason. `gain` is a V, or null when folded.
template <int Order, class Table, class V, class Gain>
[[gnu::always_inline]] inline V invert(
    const Table& table, V u, V red, V green, Gain gain) noexcept {
  using Scalar = decltype(Table::kappa);
  constexpr bool has_gain = !std::is_null_pointer_v<Gain>;
  constexpr std::size_t degree = sizeof(table.scatter) / sizeof(table.scatter[0]);
  V f[degree];
  V total = V{};
#pragma GCC unroll 16
  for (int j = int(degree) - 1; j >= 0; --j) {
    f[j] = polynomial(table.scatter[j], Table::scatter_radial(j), u);
    if constexpr (has_gain) f[j] = f[j] * gain;
    if (j < Table::exp_degree)
      f[j] = f[j] + green * polynomial(table.exp_minus_1[j], Table::exp_radial(j), u);
    total = j == int(degree) - 1 ? f[j] : total + f[j];
  }
  const V target = table.kappa * red - green;
  const V scaled = target * total;
  const V s = refine<Order>(f, target, scaled / (f[0] * (total - target) + scaled));
  auto inside = (target >= Scalar(0)) & (target <= total);
  if constexpr (has_gain) inside = inside & (gain > Scalar(0));
  const V nan = V{} + nan_because<Scalar>(InversionStatus::not_a_number);
  const V below = V{} + nan_because<Scalar>(InversionStatus::below_range);
  const V above = V{} + nan_because<Scalar>(InversionStatus::above_range);
  const V none = target < Scalar(0) ? below : target > total ? above : nan;
  return inside ? s * table.l_max_mm : none;
}

/// Columns [first, last) of a row that the table covers.
struct ColumnSpan {
  std::ptrdiff_t first, last;
};

template <class Table>
ColumnSpan covered_columns(const Table& table, std::ptrdiff_t row, std::ptrdiff_t cols) noexcept {
  const double scale = double(table.u_root_per_px);
  const double dy = (double(row) - double(table.centre_row_px)) * scale;
  if (!(dy * dy <= 1)) return {0, 0};
  const double half_px = std::sqrt(1 - dy * dy) / scale;
  const auto clamp = [&](double col) {
    return col > 0 ? col < double(cols) ? std::ptrdiff_t(col) : cols : std::ptrdiff_t(0);
  };
  const std::ptrdiff_t first = clamp(std::ceil(double(table.centre_col_px) - half_px));
  const std::ptrdiff_t last = clamp(std::floor(double(table.centre_col_px) + half_px) + 1);
  return {first, last < first ? first : last};
}

/// Depths of one image row. `gain` is a row of g, or nullptr when g is folded into the table; it
/// must be positive where it is finite. Each output may be the input of the same column.
template <int Order, class Table, class Scalar, class Gain>
void invert_row(const Table& table,
                std::ptrdiff_t row,
                std::ptrdiff_t cols,
                const Scalar* red,
                const Scalar* green,
                Gain gain,
                Scalar* depth_mm,
                std::uint8_t* status) noexcept {
  constexpr bool has_gain = !std::is_null_pointer_v<Gain>;
  constexpr int lanes = Pack<Scalar>::lanes;
  constexpr std::ptrdiff_t block = 64;
  using V = typename Pack<Scalar>::type;
  const Table local = table;  // out of reach of the outputs, so it can stay in registers
  const auto [begin, end] = covered_columns(table, row, cols);
  const auto leave_out = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t col = first; col < last; ++col) {
      depth_mm[col] = std::numeric_limits<Scalar>::quiet_NaN();
      status[col] = std::uint8_t(InversionStatus::outside);
    }
  };
  leave_out(0, begin);
  leave_out(end, cols);

  V ramp = {};
  Scalar steps[std::size_t(lanes)];
  for (int i = 0; i < lanes; ++i) steps[i] = Scalar(i) - local.centre_col_px;
  std::memcpy(&ramp, steps, sizeof ramp);
  const Scalar dy = (Scalar(row) - local.centre_row_px) * local.u_root_per_px;
  const Scalar dy_sq = dy * dy;
  for (std::ptrdiff_t first = begin; first < end; first += block) {
    const std::ptrdiff_t count = end - first < block ? end - first : block;
    const std::size_t bytes = std::size_t(count) * sizeof(Scalar);
    Scalar spare[4][std::size_t(block)];
    const Scalar* r = red + first;
    const Scalar* b = green + first;
    const Scalar* g = nullptr;
    if constexpr (has_gain) g = gain + first;
    Scalar* d = depth_mm + first;
    if (count < block) {
      std::memset(spare, 0, sizeof spare);
      r = static_cast<const Scalar*>(std::memcpy(spare[0], r, bytes));
      b = static_cast<const Scalar*>(std::memcpy(spare[1], b, bytes));
      if constexpr (has_gain) g = static_cast<const Scalar*>(std::memcpy(spare[2], g, bytes));
      d = spare[3];
    }
    auto bad = V{} != V{};
    for (std::ptrdiff_t i = 0; i < block; i += lanes) {
      const V dx = (ramp + Scalar(first + i)) * local.u_root_per_px;
      const V u = dx * dx + dy_sq;
      V l;
      if constexpr (has_gain)
        l = invert<Order>(local, u, load<V>(r + i), load<V>(b + i), load<V>(g + i));
      else
        l = invert<Order>(local, u, load<V>(r + i), load<V>(b + i), nullptr);
      bad = bad | (l != l);
      std::memcpy(d + i, &l, sizeof l);
    }
    if (count == block && !any(bad)) {
      std::memset(status + first, 0, block);
    } else {
      std::uint8_t code[std::size_t(block)];
      write_status<block>(d, code);
      std::memcpy(status + first, code, std::size_t(count));
      if (count < block) std::memcpy(depth_mm + first, d, bytes);
    }
  }
}
}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
