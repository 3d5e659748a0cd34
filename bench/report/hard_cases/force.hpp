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
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/published/look_up.hpp"
#include "row.hpp"
#include "support/curves.hpp"
#include "support/pressed_pad.hpp"

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
                 f.stable.add_absolute(fingerpad::shear_factor(a, reference, exponent), exact);
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
                 const S held = force(d, {S(1), S(0)}).force_n;
                 f.naive.add_absolute((std::min)(printed(d, {S(1), S(0)}), S(0)), Digits50(0));
                 f.stable.add_absolute((std::min)(held, S(0)), Digits50(0));
               }
               return f;
             });
}

/// The tensions that a load at the contact adds on a sphere, marched up from the rim.
///   U = N_phi sin^2(phi) and V = N_phi,theta sin^2(phi)
/// are the parts of an analytic function of ln tan(phi / 2) and theta. Both are known at the rim
/// and marched upward by Runge-Kutta steps, with Fourier sums for the derivatives around the axis.
template <class S>
std::vector<S> marched_up(std::vector<S> u, std::vector<S> v, const S& way, int steps) {
  const std::size_t n = u.size();
  std::vector<S> slope_of(n, S(0));  // cot(k pi / n) / 2, with alternating signs
  for (std::size_t k = 1; k < n; ++k) {
    using std::tan;
    const S share = S(static_cast<int>(k)) / S(static_cast<int>(n));
    const S at = boost::math::constants::pi<S>() * share;
    slope_of[k] = S(k % 2 == 0 ? 0.5 : -0.5) / tan(at);
  }
  const auto along = [&](const std::vector<S>& of) {
    std::vector<S> slope(n, S(0));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 1; k < n; ++k) {
        slope[i] = slope[i] + slope_of[k] * of[(i + n - k) % n];
      }
    }
    return slope;
  };
  const S h = way / S(steps);
  const auto plus = [&](const std::vector<S>& a, const S& by, const std::vector<S>& b) {
    std::vector<S> out(n);
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = a[i] + by * b[i];
    }
    return out;
  };
  for (int step = 0; step < steps; ++step) {
    std::vector<S> u_sum = u, v_sum = v, u_at = u, v_at = v;
    for (const auto& [share, next] :
         {std::array<double, 2>{1.0 / 6, 0.5}, {1.0 / 3, 0.5}, {1.0 / 3, 1.0}, {1.0 / 6, 0.0}}) {
      const auto du = along(v_at), dv = along(u_at);  // u_s = v_theta, v_s = -u_theta
      u_sum = plus(u_sum, S(h * S(share)), du);
      v_sum = plus(v_sum, S(-h * S(share)), dv);
      u_at = plus(u, S(h * S(next)), du);
      v_at = plus(v, S(-h * S(next)), dv);
    }
    u = u_sum;
    v = v_sum;
  }
  return u;
}

inline Row march_from_rim() {
  return row(
      "membrane force",
      "lateral load: both tractions of the rim marched up to the contact, 36 lines, of the "
      "mean tension; fingerpad: lateral force by the rim's directions, relative",
      "the pulls of the rim up to one factor", []<class S>(S) {
        Forms f;
        const std::size_t n = 36;
        std::vector<S> u(n), v(n);
        std::vector<Digits50> exact_u(n), exact_v(n);
        for (std::size_t i = 0; i < n; ++i) {
          const double at = 2 * std::numbers::pi * static_cast<double>(i) / 36;
          exact_u[i] = Digits50(u[i] = S(1 + 0.3 * std::cos(at)));
          exact_v[i] = Digits50(v[i] = S(-0.3 * std::sin(at)));
        }
        // the m-th harmonic grows by (tan(phi_0 / 2) / tan(phi_1 / 2))^m = 3.3^m
        const S way = S(1.19);
        const auto up = marched_up(u, v, way, 40);
        const auto exact_up = marched_up(exact_u, exact_v, Digits50(way), 40);
        for (std::size_t i = 0; i < n; ++i) {
          f.naive.add_absolute(up[i], exact_up[i]);
        }
        const test::RoundPad<test::FilmSide> pad;
        test::RimOfDots rim = test::rim_of(pad);
        rim.count = 24;
        const auto load = [&](double angle) {
          const double even = pad.tension(pad.radius_mm, test::pressed_mpa);
          return test::RimLoad{even * (1 + 0.1 * std::cos(angle)), -0.1 * even * std::sin(angle)};
        };
        const auto force = [&]<class T>(T) {
          const auto in_s = [](const auto& from) {
            test::Image<Point3<T>> to(from.rows(), from.cols(), {T(0), T(0), T(0)});
            for (std::size_t k = 0; k < from.cells.size(); ++k) {
              const auto& p = from.cells[k];
              to.cells[k] = {T(S(p.x)), T(S(p.y)), T(S(p.z))};
            }
            return to;
          };
          fingerpad::Wrench<T> wrench(in_s(rim.borders()), test::exact_options<T>());
          return wrench(pad, in_s(rim.dots(load)), T(S(test::pressed_mpa))).force_n;
        };
        f.stable.add_relative(force(S(0)).x, force(Digits50(0)).x);
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
