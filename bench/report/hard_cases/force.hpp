// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces by look-up and from the membrane.
#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/force/look_up.hpp"
#include "fingerpad/force/traction.hpp"
#include "fingerpad/published/look_up.hpp"
#include "row.hpp"
#include "support/curves.hpp"

namespace hard {

using fingerpad::Index;
using fingerpad::Point3;

inline Row no_area() {
  return row("force by look-up", "(S / S_ref)^0.65 for S from -5 mm^2 through 0 to 500; factor",
             "0 without contact, before any power", []<class S>(S) {
               Forms f;
               for (const double area : {-5.0, -1e-3, -1e-30, 0.0, 1e-30, 1e-3, 1.0, 500.0}) {
                 const S a = S(area), exponent = S(0.65), reference = S(100);
                 const Digits50 ratio = Digits50(a) / Digits50(reference);
                 const Digits50 exact =
                     a > 0 ? Digits50(exp(Digits50(Digits50(exponent) * log(ratio)))) : Digits50(0);
                 f.naive.add_absolute(std::pow(a / reference, exponent), exact);
                 const fingerpad::Shear<S> shear({reference, {S(1), exponent}, {S(0)}});
                 f.stable.add_absolute(shear(a, {S(1), S(0)}, S(0)).tangential_force_n.x, exact);
               }
               return f;
             });
}

inline Row below_range() {
  return row("force by look-up",
             "eq. 21 by depth, shallow contacts moved by 1 mm; how far below 0, N",
             "the default: faded out below the range, held at 0 with a status", []<class S>(S) {
               Forms f;
               const auto printed = fingerpad::published::normal_force_by_depth<S>();
               const fingerpad::NormalForce force(test::curve_of_depth<S>());
               for (const double depth : {-0.5, 0.0, 0.01, 0.1, 0.3, 0.63, 0.9, 1.2}) {
                 const S d = S(depth);
                 const S held = force(d).force_n;
                 f.naive.add_absolute((std::min)(printed(d, {S(1), S(0)}), S(0)), Digits50(0));
                 f.stable.add_absolute((std::min)(held, S(0)), Digits50(0));
               }
               return f;
             });
}

/// Twice the area of a triangle from its edges, by Heron's formula.
template <class S>
S twice_area_of_edges(const std::array<Point3<S>, 3>& x) {
  using std::sqrt;
  std::array<S, 3> edge;
  for (std::size_t k = 0; k < 3; ++k) {
    edge[k] = sqrt(squared_norm(x[(k + 1) % 3] - x[k]));
  }
  const S half = (edge[0] + edge[1] + edge[2]) / S(2);
  const S product = half * (half - edge[0]) * (half - edge[1]) * (half - edge[2]);
  return S(S(2) * sqrt(product));
}

inline Row thin_triangle() {
  return row("traction", "area of a triangle of dots, 1.5 mm long, 1e-9 to 1 mm high; relative",
             "half the cross product", []<class S>(S) {
               Forms f;
               for (const double high : sweep(1e-9, 1, 2)) {
                 const std::array<Point3<S>, 3> x = {
                     Point3<S>{S(0), S(0), S(0)}, {S(1.5), S(0), S(0)}, {S(0.7), S(high), S(0)}};
                 const Digits50 exact = Digits50(x[1].x) * Digits50(x[2].y);
                 f.naive.add_relative(twice_area_of_edges(x), exact);
                 const auto area = fingerpad::detail::traction::twice_area(x[0], x[1], x[2]);
                 f.stable.add_relative(std::sqrt(squared_norm(area)), exact);
               }
               return f;
             });
}

}  // namespace hard
