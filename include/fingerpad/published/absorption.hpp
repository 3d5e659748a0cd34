// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Identification of c_R, c_G and kappa as printed: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor" (slides), "Parameter identification": three measurements at known
// depths and a reference give three equations f(l_i) = f(l_0) in three unknowns, "solving by
// numerical analytical approach such as Newton method". This hardly determines the parameters:
// noise of 0.03 grey levels moves c_R by 70 %. calibrate/depth.hpp takes any number of samples and
// reports how well they determine each parameter; docs/errata.md, E002-E005.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/published/depth.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = double>
struct [[nodiscard]] Identification {
  const char* cause = cause::not_converged;  ///< likely mistake
  Absorption<S> fluid = {};                  ///< parameters after the last step
  S residual = S(0);                         ///< largest of |f(l_i) - f(l_0)| over |f(l_0)|
  int iterations = 0;

  bool ok() const { return cause == nullptr; }
};

}  // namespace published

namespace detail::identification {

template <scalar S>
using Triple = std::array<S, 3>;

/// (f(l_i) - f(l_0)) / f(l_0).
template <scalar S>
Triple<S> residuals(const DepthSample<S>& reference,
                    const std::array<DepthSample<S>, 3>& at,
                    const Triple<S>& p) {
  const Absorption<S> fluid{p[0], p[1], p[2]};
  const S g = published::quotient(fluid, reference.pencil, reference.colour, reference.depth_mm);
  Triple<S> r = p;
  for (std::size_t i = 0; i < 3; ++i) {
    r[i] = S(published::quotient(fluid, at[i].pencil, at[i].colour, at[i].depth_mm) / g - S(1));
  }
  return r;
}

/// Solves x_0 a_0 + x_1 a_1 + x_2 a_2 = b by Cramer's rule. Not finite if the a_i are coplanar.
template <scalar S>
Triple<S> solve(const std::array<Point3<S>, 3>& a, const Point3<S>& b) {
  const S volume = dot(a[0], cross(a[1], a[2]));
  return {S(dot(b, cross(a[1], a[2])) / volume), S(dot(b, cross(a[2], a[0])) / volume),
          S(dot(b, cross(a[0], a[1])) / volume)};
}

}  // namespace detail::identification

namespace published {

/// Newton's method from `guess`, with derivatives by central differences. Each step is halved until
/// the residual falls. Depths must be > 0 and pencils those of published::SingleHeight; weights and
/// pixel positions are not used. Never throws, bounded time.
template <scalar S>
Identification<S> identify_absorption(const DepthSample<S>& reference,
                                      const std::array<DepthSample<S>, 3>& measured,
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
    std::array<Point3<S>, 3> slope = {};
    for (std::size_t j = 0; j < 3; ++j) {
      Triple<S> up = p, down = p;
      up[j] += step * p[j];
      down[j] -= step * p[j];
      const auto above = detail::identification::residuals(reference, measured, up);
      const auto below = detail::identification::residuals(reference, measured, down);
      const S width = up[j] - down[j];
      slope[j] = {S((above[0] - below[0]) / width), S((above[1] - below[1]) / width),
                  S((above[2] - below[2]) / width)};
    }
    const Triple<S> change = detail::identification::solve(slope, {r[0], r[1], r[2]});
    if (!is_finite(size(change))) {
      break;  // the depths do not determine the parameters
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
    if (!falls) {  // converged to roundoff, or stuck
      if (value(before) < value(S(1000) * step * step)) {
        out.cause = nullptr;
      }
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
