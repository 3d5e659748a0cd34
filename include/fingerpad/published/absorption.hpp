// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Identification of c_R, c_G and kappa as printed: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor" (slides), "Parameter identification": three measurements at known
// depths against the reference give three equations f(l_i) = f(l_0) in three unknowns, "solving by
// numerical analytical approach such as Newton method". The parameters are hardly determined so:
// noise of 0.03 grey levels moves c_R by 70 %. calibrate/depth.hpp takes any number of samples and
// says how well they determine what; docs/errata.md, E002-E005.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "fingerpad/core/scalar.hpp"
#include "fingerpad/published/depth.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// A pixel at a known depth. The pencil of published::SingleHeight.
template <scalar S = double>
struct KnownDepth {
  Pencil<S> pencil;
  S depth_mm;  ///< > 0
  Colour<S> colour;
};

enum class IdentificationStatus : std::uint8_t {
  ok,
  singular,       ///< the three depths do not tell the parameters apart
  not_converged,  ///< after max_iterations
};

template <scalar S = double>
struct [[nodiscard]] Identification {
  IdentificationStatus status = IdentificationStatus::not_converged;
  Absorption<S> fluid = {};  ///< where it came to
  S residual = S(0);         ///< largest of |f(l_i) - f(l_0)| over |f(l_0)|
  int iterations = 0;

  bool ok() const { return status == IdentificationStatus::ok; }
};

}  // namespace published

namespace detail::identification {

template <scalar S>
using Triple = std::array<S, 3>;

/// f(l_i) - f(l_0), as shares of f(l_0).
template <scalar S>
Triple<S> residuals(const published::KnownDepth<S>& reference,
                    const std::array<published::KnownDepth<S>, 3>& at,
                    const Triple<S>& p) {
  const Absorption<S> fluid{p[0], p[1], p[2]};
  const S g = published::quotient(fluid, reference.pencil, reference.colour, reference.depth_mm);
  Triple<S> r = p;
  for (std::size_t i = 0; i < 3; ++i) {
    r[i] = S(published::quotient(fluid, at[i].pencil, at[i].colour, at[i].depth_mm) / g - S(1));
  }
  return r;
}

/// x with a x = b by Gauss with pivots; false where a is singular to roundoff.
template <scalar S>
bool solve(std::array<Triple<S>, 3> a, Triple<S> b, Triple<S>& x) {
  for (std::size_t j = 0; j < 3; ++j) {
    std::size_t best = j;
    for (std::size_t i = j + 1; i < 3; ++i) {
      best = value(square(a[i][j])) > value(square(a[best][j])) ? i : best;
    }
    std::swap(a[j], a[best]);
    std::swap(b[j], b[best]);
    if (!is_finite(a[j][j]) || value(a[j][j]) == 0) {
      return false;
    }
    for (std::size_t i = j + 1; i < 3; ++i) {
      const S factor = a[i][j] / a[j][j];
      for (std::size_t c = j; c < 3; ++c) {
        a[i][c] -= factor * a[j][c];
      }
      b[i] -= factor * b[j];
    }
  }
  for (std::size_t i = 3; i-- > 0;) {
    x[i] = b[i];
    for (std::size_t c = i + 1; c < 3; ++c) {
      x[i] -= a[i][c] * x[c];
    }
    x[i] = S(x[i] / a[i][i]);
  }
  return is_finite(x[0]) && is_finite(x[1]) && is_finite(x[2]);
}

}  // namespace detail::identification

namespace published {

/// Newton's method from `guess`, with derivatives by differences and steps halved until the
/// residual falls. Never throws, bounded time.
template <scalar S>
Identification<S> identify_absorption(const KnownDepth<S>& reference,
                                      const std::array<KnownDepth<S>, 3>& measured,
                                      const Absorption<S>& guess = {},
                                      int max_iterations = 100) {
  using detail::identification::Triple;
  using std::sqrt;
  const auto size = [](const Triple<S>& r) {
    S largest = S(0);
    for (const S& x : r) {
      const S magnitude = value(x) < 0 ? S(-x) : x;
      largest = !is_finite(x) || value(magnitude) > value(largest) ? magnitude : largest;
    }
    return largest;
  };
  Identification<S> out;
  Triple<S> p = {guess.c_red_per_mm, guess.c_green_per_mm, guess.kappa};
  Triple<S> r = detail::identification::residuals(reference, measured, p);
  const S step = S(sqrt(S(epsilon<S>())));
  for (; out.iterations < max_iterations; ++out.iterations) {
    std::array<Triple<S>, 3> slope = {};
    for (std::size_t j = 0; j < 3; ++j) {
      Triple<S> up = p, down = p;
      up[j] += step * p[j];
      down[j] -= step * p[j];
      const auto above = detail::identification::residuals(reference, measured, up);
      const auto below = detail::identification::residuals(reference, measured, down);
      for (std::size_t i = 0; i < 3; ++i) {
        slope[i][j] = S((above[i] - below[i]) / (up[j] - down[j]));
      }
    }
    Triple<S> change = p;
    if (!detail::identification::solve(slope, r, change)) {
      out.status = IdentificationStatus::singular;
      break;
    }
    const S before = size(r);
    S share = S(1);
    Triple<S> next = p;
    bool falls = false;
    for (int half = 0; half < 30 && !falls; ++half, share = share / S(2)) {
      for (std::size_t j = 0; j < 3; ++j) {
        next[j] = p[j] - share * change[j];
      }
      const auto there = detail::identification::residuals(reference, measured, next);
      const bool positive = value(next[0]) > 0 && value(next[1]) > 0 && value(next[2]) > 0;
      if (positive && value(size(there)) < value(before)) {
        falls = true;
        r = there;
      }
    }
    if (!falls) {  // as near as roundoff lets it come, or stuck
      out.status = value(before) < value(S(1000) * step * step)
                       ? IdentificationStatus::ok
                       : IdentificationStatus::not_converged;
      break;
    }
    p = next;
  }
  out.fluid = {p[0], p[1], p[2], guess.max_depth_mm};
  out.residual = size(r);
  return out;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
