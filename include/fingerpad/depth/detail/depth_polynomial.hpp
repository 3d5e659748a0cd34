// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth from two colours without an exponential or a square root per pixel. With s = l / l_max and
// u = (rho / rho_max)^2 the depth equation b e^{delta k l} - kappa r + g W(l) = 0, divided by g,
// becomes
//   (kappa r - b) / g = sum_j (b / g E_j(u) + W_j(u)) s^j,   j = 1..degree,
// where E stands for e^{delta k l} - 1 and W for the scattered light, both fitted near-minimax. The
// right side grows from 0 at s = 0 to `total` at s = 1, so the range tests are exact comparisons.
// The start of the iteration, a hyperbola through both ends with the slope at s = 0, never leaves
// [0, 1].
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Calls f(0), f(1), ... f(N - 1) with constants. GCC 12 vectorises at -O2 only loops that hold no
/// other loop.
template <int N, class F>
[[gnu::always_inline]] inline void unrolled(const F& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, static_cast<int>(I)>{}), ...);
  }
  (std::make_index_sequence<std::size_t(N)>{});
}

/// c[0] + c[1] u + ... + c[last] u^last.
template <int last, class S>
[[gnu::always_inline]] inline S polynomial(const S* c, S u) {
  S sum = c[last];
  unrolled<last>([&](auto k) __attribute__((always_inline)) { sum = sum * u + c[last - 1 - k]; });
  return sum;
}

/// The solution for one camera and fluid, for pixels up to `radius_px` from the axis. The error is
/// below 1e-5 mm in float and 1e-12 mm in double for depths up to 14 mm of the published fluid, at
/// the angles from which a camera sees the published pad.
template <class S>
class DepthPolynomial {
  static_assert(std::same_as<S, float> || std::same_as<S, double>,
                "rows of depth are computed in float or double: use newton_depth() for other "
                "scalars");
  static constexpr bool is_float = sizeof(S) == 4;
  static constexpr int degree = is_float ? 6 : 12;
  static constexpr int radial = is_float ? 3 : 8;
  static constexpr int steps = is_float ? 1 : 2;  ///< Halley's cubes the error, .06 mm at first,
                                                  ///< and Newton's after it squares what is left
  static constexpr int exp_degree = (degree + 3) / 2;  ///< fewer terms, as delta k l_max is small

  // Higher powers of s carry less of the sum, so they need less of u.
  static constexpr int scatter_radial(int j) { return (std::max)(1, radial - j / 2); }
  static constexpr int exp_radial(int j) { return (std::max)(0, radial - j); }

 public:
  static constexpr Index block = 64;  ///< pixels that are inverted together

  /// Refuses cameras and fluids for which the polynomials are off by more than 0.005 mm somewhere,
  /// in pixels with g >= `min_g` (parameter_error).
  DepthPolynomial(const Camera<double>& camera,
                  const Absorption<double>& fluid,
                  double radius_px,
                  double min_g)
      : kappa_(S(fluid.kappa)),
        l_max_mm_(S(fluid.max_depth_mm)),
        center_row_px_(S(camera.center_y_px)),
        center_col_px_(S(camera.center_x_px)),
        u_root_per_col_(S(1 / radius_px)),
        u_root_per_row_(S(camera.pixel_aspect / radius_px)) {
    const double l_max = fluid.max_depth_mm;
    const auto ray = [&](double u) {
      const double distorted = radius_px * std::sqrt(u) * tangent_per_px(camera);
      const double tangent = distorted * undistortion(camera, distorted * distorted);
      return ray_at_tangent(camera, tangent);
    };
    const auto scattered = [&](double s, double u) {
      return scattered_light(l_max * s, fluid.c_red_per_mm, ray(u));
    };
    const auto exp_minus_1 = [&](double s, double u) {
      const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
      return std::expm1(delta * ray(u).path_factor * l_max * s);
    };
    project([&](double s, double u) { return scattered(s, u) / s; }, scatter_radial, scatter_);
    project([&](double s, double u) { return exp_minus_1(s, u) / s; }, exp_radial, exp_minus_1_);

    double worst_mm = 0;
    for (int k = 1; k <= 128 * 33; ++k) {
      const double s = 1.0 / 128 * ((k - 1) % 128 + 1);
      const double u = 1.0 / 32 * ((k - 1) / 128);
      for (const double b : {0.0, 255.0}) {
        const double kappa_r = b + b * exp_minus_1(s, u) + min_g * scattered(s, u);
        const S l = root(S(u), S(kappa_r / fluid.kappa), S(b), S(1 / min_g)).depth_mm;
        const double error_mm = std::abs(static_cast<double>(l) - l_max * s);
        worst_mm = error_mm <= worst_mm ? worst_mm : error_mm;  // or NaN
      }
    }
    expects(worst_mm <= 0.005, "DepthEstimator", "error of the polynomials in mm", worst_mm,
            "<= 0.005: is the reference of the free pad, and is the angle of view that of a "
            "camera behind a pad?");
  }

  struct Root {
    S depth_mm;  ///< valid if target is in [0, total]
    S target;
    S total;
  };

  /// The law: the root at squared radius u for red, green and 1 / g of a pixel.
  [[gnu::always_inline]] Root root(S u, S red, S green, S per_g) const {
    S f[std::size_t(degree)];
    const S b = green * per_g;
    S total = S(0);
    unrolled<degree>([&](auto k) __attribute__((always_inline)) {
      constexpr int j = degree - 1 - k;
      f[j] = polynomial<scatter_radial(j)>(scatter_[j], u);
      if constexpr (j < exp_degree) {
        f[j] += b * polynomial<exp_radial(j)>(exp_minus_1_[j], u);
      }
      total += f[j];
    });
    const S target = (kappa_ * red - green) * per_g;
    const S scaled = target * total;
    S s = scaled / (f[0] * (total - target) + scaled);
    unrolled<steps>([&](auto step) __attribute__((always_inline)) {
      S bend = f[degree - 1];  // half the second derivative
      S slope = f[degree - 1];
      S sum = f[degree - 1] * s + f[degree - 2];
      slope = slope * s + sum;
      unrolled<degree - 2>([&](auto k) __attribute__((always_inline)) {
        constexpr int j = degree - 3 - k;
        bend = bend * s + slope;
        sum = sum * s + f[j];
        slope = slope * s + sum;
      });
      const S miss = sum * s - target;
      s = s - (step == 0 ? miss * slope / (slope * slope - miss * bend) : miss / slope);
    });
    return {s * l_max_mm_, target, total};
  }

  /// Squared radius of a pixel, 1 at radius_px.
  [[gnu::always_inline]] S radius_sq(int row, int col) const {
    const S dy = (S(row) - center_row_px_) * u_root_per_row_;
    const S dx = (S(col) - center_col_px_) * u_root_per_col_;
    return dx * dx + dy * dy;
  }

  /// Depths and statuses of `block` pixels of a row, from column `col` on. per_g is 1 / g, and 0
  /// outside the pad. No branch per pixel. Not inlined: GCC 12 forgets __restrict of inlined
  /// parameters, and then the loop is not vectorised.
  [[gnu::noinline]] void invert(int row,
                                int col,
                                const S* red,
                                const S* green,
                                const S* per_g,
                                S* __restrict depth_mm,
                                PixelStatus* __restrict status) const {
    using Bits = std::conditional_t<is_float, std::int32_t, std::int64_t>;
    constexpr auto nan = std::bit_cast<Bits>((std::numeric_limits<S>::quiet_NaN)());
    S target[block], total[block];
    for (int i = 0; i < block; ++i) {
      const Root at = root(radius_sq(row, col + i), red[i], green[i], per_g[i]);
      depth_mm[i] = at.depth_mm;
      target[i] = at.target;
      total[i] = at.total;
    }
    Bits code[block];  // in a loop of its own: SSE2 compares no doubles to 64-bit integers
    for (int i = 0; i < block; ++i) {
      const Bits in_pad = per_g[i] > 0;
      const Bits below = target[i] < 0;
      const Bits above = Bits(target[i] > total[i]) & (1 - below);
      const Bits ok = in_pad & Bits(target[i] >= 0) & Bits(target[i] <= total[i]);
      depth_mm[i] = std::bit_cast<S>((std::bit_cast<Bits>(depth_mm[i]) & -ok) | (nan & (ok - 1)));
      // below_range, above_range or not_a_number; outside_pad is twice not_a_number
      code[i] = (1 - ok) * (Bits(PixelStatus::outside_pad) -
                            in_pad * (Bits(PixelStatus::not_a_number) + 2 * below + above));
    }
    for (int i = 0; i < block; ++i) {
      status[i] = static_cast<PixelStatus>(code[i]);
    }
  }

 private:
  using Row = S[std::size_t(radial) + 1];  ///< coefficients of 1, u, u^2, ...

  /// Chebyshev projection of f(s, u) on [0, 1]^2 to sum c[j][p] s^j u^p, p <= last(j), from the
  /// highest power down. Each coefficient is rounded to S and its term taken off what is left of f
  /// before the next is computed; so the lower powers make up for roundoff and for terms left out.
  template <std::size_t rows, class Function, class Last>
  static void project(const Function& f, const Last& last, Row (&c)[rows]) {
    constexpr int num_s = int(rows) + 8;
    constexpr int num_u = radial + 9;
    const auto angle = [](int i, int n) { return std::numbers::pi * (i + 0.5) / n; };
    const auto node = [&](int i, int n) { return 0.5 + 0.5 * std::cos(angle(i, n)); };
    double left[rows + 8][std::size_t(num_u)];
    for (int i = 0; i < num_s; ++i) {
      for (int a = 0; a < num_u; ++a) {
        left[i][a] = f(node(i, num_s), node(a, num_u));
      }
    }
    for (int j = int(rows) - 1; j >= 0; --j) {
      for (int p = last(j); p >= 0; --p) {
        double sum = 0;
        for (int i = 0; i < num_s; ++i) {
          for (int a = 0; a < num_u; ++a) {
            sum += left[i][a] * std::cos(j * angle(i, num_s)) * std::cos(p * angle(a, num_u));
          }
        }
        c[j][p] = S(std::ldexp(sum / (num_s * num_u), 2 * (j + p)));  // T_n leads with 2^{2n-1}
        for (int i = 0; i < num_s; ++i) {
          for (int a = 0; a < num_u; ++a) {
            left[i][a] -=
                double(c[j][p]) * std::pow(node(i, num_s), j) * std::pow(node(a, num_u), p);
          }
        }
      }
    }
  }

  Row scatter_[std::size_t(degree)] = {};
  Row exp_minus_1_[std::size_t(exp_degree)] = {};
  S kappa_;
  S l_max_mm_;
  S center_row_px_;
  S center_col_px_;
  S u_root_per_col_;
  S u_root_per_row_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
