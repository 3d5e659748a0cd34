// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The vertical balance of the free pad's rim, mu t (A / L - B L^3) = p a / 2, and its solutions.
// See calibrate/rim.hpp.
#include <cmath>
#include <vector>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Of a level of pressure.
template <scalar S>
struct RimEquation {
  S a;
  S b;
  S pull;  ///< p a / 2, N/mm
  /// For mu t = 1.
  S mean_pull(const S& length) const { return S(a / length - b * length * length * length); }
};

/// Root of the ratio of the eigenvalues of [aa ab; ab bb], columns scaled to length 1.
template <scalar S>
S condition_of(const S& aa, const S& ab, const S& bb) {
  using std::sqrt;
  const S cosine_sq = ab * ab / (aa * bb);
  const S cosine = sqrt(cosine_sq);
  return S(sqrt(S((S(1) + cosine) / (S(1) - cosine))));
}

/// Both unknowns.
template <scalar S>
struct RimUnknowns {
  S u;  ///< mu t / L
  S v;  ///< mu t L^3
  S condition;
};

/// Least squares, all levels alike.
template <scalar S>
RimUnknowns<S> both_of(const std::vector<RimEquation<S>>& equations) {
  S aa = S(0), ab = S(0), bb = S(0), ap = S(0), bp = S(0);
  for (const RimEquation<S>& e : equations) {
    aa = aa + e.a * e.a;
    ab = ab + e.a * e.b;
    bb = bb + e.b * e.b;
    ap = ap + e.a * e.pull;
    bp = bp + e.b * e.pull;
  }
  const S determinant = aa * bb - ab * ab;
  return {S((ap * bb - bp * ab) / determinant), S((ap * ab - bp * aa) / determinant),
          condition_of(aa, ab, bb)};
}

/// mu t for a given L.
template <scalar S>
S modulus_of(const S& length, const std::vector<RimEquation<S>>& equations) {
  S gp = S(0), gg = S(0);
  for (const RimEquation<S>& e : equations) {
    const S g = e.mean_pull(length);
    gp = gp + g * e.pull;
    gg = gg + g * g;
  }
  return S(gp / gg);
}

/// L with which the pulls of all levels add up for a given mu t; NaN where none is.
template <scalar S>
S length_of(const S& modulus, const std::vector<RimEquation<S>>& equations) {
  using std::sqrt;
  RimEquation<S> total{S(0), S(0), S(0)};
  for (const RimEquation<S>& e : equations) {
    total = {S(total.a + e.a), S(total.b + e.b), S(total.pull + e.pull)};
  }
  if (!(value(total.a) > 0 && value(total.b) > 0)) {
    return not_a_number<S>();
  }
  // The pull falls as L grows, from infinity to 0 at L^4 = A / B, and below that it is convex:
  // Newton from below gets there without overshooting.
  const S wanted = total.pull / modulus;
  const S slack = sqrt(S(sqrt(S(total.a / total.b))));
  S length = slack / S(2);
  while (value(S(total.mean_pull(length) - wanted)) < 0) {
    length = length / S(2);
  }
  for (int step = 0; step < 100; ++step) {
    const S slope = -total.a / (length * length) - S(3) * total.b * length * length;
    const S change = (wanted - total.mean_pull(length)) / slope;
    length = length + change;
    const S small = length * S(static_cast<double>(4 * epsilon<S>()));
    if (value(change) < value(small) && value(change) > value(S(-small))) {
      break;
    }
  }
  return length;
}

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
