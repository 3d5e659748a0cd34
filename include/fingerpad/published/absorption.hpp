// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Identification of c_R, c_G and kappa as printed: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor" (slides), "Parameter identification": three measurements at known
// depths and a reference give three equations f(l_i) = f(l_0) in three unknowns, "solving by
// numerical analytical approach such as Newton method". This hardly determines the parameters
// (docs/papers.md); calibrate/depth.hpp takes any number of samples and tells how well they
// determine each. Printed errors: docs/errata.md, E002-E005.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The published quotient f(l) = g at the depth l > 0 of a pixel, with the repairs E003-E005:
/// (b_G e^{c_G k l} - kappa b_R e^{c_R k l}) / (Q1 (1 - e^{c_R k l}) + Q2). It is 0/0 at l = 0.
template <scalar S>
S quotient(const Absorption<S>& fluid,
           const Pencil<S>& pencil,
           const Colour<S>& colour,
           const S& depth_mm) {
  using std::exp;
  const S& c = fluid.c_red_per_mm;
  const S& k = pencil.path_factor;
  const S& l = depth_mm;
  const S product = pencil.height.meridional_mm * pencil.height.sagittal_mm;
  const S sum = pencil.height.meridional_mm + pencil.height.sagittal_mm;
  const S ck = c * k;
  const S q1 = (product + (sum + S(2) / ck) / ck) / k;
  const S q2 = (l * l + sum * l + S(2) * l / ck) / k;
  const S e_red = exp(ck * l);
  const S e_green = exp(fluid.c_green_per_mm * k * l);
  return (colour.green * e_green - fluid.kappa * colour.red * e_red) / (q1 * (S(1) - e_red) + q2);
}

/// A colour at a known depth.
template <scalar S = double>
struct KnownDepth {
  Pencil<S> pencil;  ///< of the pixel, with one height (published::SingleHeight)
  S depth_mm;        ///< l along the ray, > 0
  Colour<S> colour;  ///< grey levels, > 0
};

template <scalar S = double>
struct [[nodiscard]] Identification {
  Absorption<S> fluid = {};  ///< parameters after the last step
  S residual = S(0);         ///< largest of |f(l_i) - f(l_0)| over |f(l_0)|
  int iterations = 0;
  bool converged = false;

  bool ok() const { return converged; }
};

/// Newton's method from `guess`, with derivatives by central differences. Each step is halved until
/// the residual falls. Never throws, bounded time.
template <scalar S>
Identification<S> identify_absorption(const KnownDepth<S>& reference,
                                      const std::array<KnownDepth<S>, 3>& measured,
                                      const Absorption<S>& guess = {},
                                      int max_iterations = 100) {
  using std::sqrt;
  const auto f = [](const Point3<S>& p, const KnownDepth<S>& at) {
    return quotient(Absorption<S>{p.x, p.y, p.z}, at.pencil, at.colour, at.depth_mm);
  };
  const auto residuals = [&](const Point3<S>& p) {
    const S g = f(p, reference);
    return Point3<S>{f(p, measured[0]) / g - S(1), f(p, measured[1]) / g - S(1),
                     f(p, measured[2]) / g - S(1)};
  };
  const auto size = [](const Point3<S>& r) {
    S largest = S(0);
    for (const S& x : {r.x, r.y, r.z}) {
      const S magnitude = value(x) < 0 ? -x : x;
      largest = !is_finite(x) || value(magnitude) > value(largest) ? magnitude : largest;
    }
    return largest;
  };
  Identification<S> out;
  Point3<S> p = {guess.c_red_per_mm, guess.c_green_per_mm, guess.kappa};
  Point3<S> r = residuals(p);
  const S step = sqrt(S(epsilon<S>()));
  for (; out.iterations < max_iterations; ++out.iterations) {
    std::array<Point3<S>, 3> slope = {};
    for (std::size_t j = 0; j < 3; ++j) {
      S Point3<S>::*const of = std::array{&Point3<S>::x, &Point3<S>::y, &Point3<S>::z}[j];
      Point3<S> up = p, down = p;
      up.*of += step * p.*of;
      down.*of -= step * p.*of;
      slope[j] = (S(1) / (up.*of - down.*of)) * (residuals(up) - residuals(down));
    }
    // Cramer's rule; not finite if the depths do not determine the parameters
    const S volume = dot(slope[0], cross(slope[1], slope[2]));
    const Point3<S> change = {dot(r, cross(slope[1], slope[2])) / volume,
                              dot(r, cross(slope[2], slope[0])) / volume,
                              dot(r, cross(slope[0], slope[1])) / volume};
    if (!is_finite(size(change))) {
      break;
    }
    const S before = size(r);
    S share = S(1);
    bool falls = false;
    for (int half = 0; half < 30 && !falls; ++half, share = share / S(2)) {
      const Point3<S> next = p - share * change;
      const Point3<S> there = residuals(next);
      falls = value(next.x) > 0 && value(next.y) > 0 && value(next.z) > 0 &&
              value(size(there)) < value(before);
      if (falls) {
        p = next;
        r = there;
      }
    }
    if (!falls) {  // converged to roundoff, or stuck
      out.converged = value(before) < value(S(1000) * step * step);
      break;
    }
  }
  out.fluid = {p.x, p.y, p.z, guess.max_depth_mm};
  out.residual = size(r);
  return out;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
