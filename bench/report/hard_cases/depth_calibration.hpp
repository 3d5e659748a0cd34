// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the depth: g from the free pad, and the fluid.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "depth.hpp"
#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

inline Row scattering_at_rim() {
  return row("depth reference", "g at the rim, where l goes to 0; relative to the g of the colours",
             "weighted fit over rho^2 of the depth equation itself", []<class S>(S) {
               Forms f;
               const fingerpad::Index n = 64;
               Camera<double> camera;
               camera.center_x_px = camera.center_y_px = 0;
               camera.pitch_mm = 0.3;
               const Absorption<double> fluid;
               test::Image<S> red(n, n), green(n, n), depth(n, n, S(test::nan));
               std::vector<Ray<S>> light;
               for (fingerpad::Index i = 0; i < n; ++i) {  // a quarter of a pad
                 for (fingerpad::Index j = 0; i * i + j * j <= (n - 1) * (n - 1); ++j) {
                   const double share =
                       static_cast<double>(i * i + j * j) / double((n - 1) * (n - 1));
                   depth(i, j) = S(share < 1 ? 12 * (1 - share * share) : 0);
                   const auto p = fingerpad::ray_at_pixel(camera, double(i), double(j));
                   const auto c = fingerpad::colour_at_depth(fluid, p, 57.0, 0.0163,
                                                             static_cast<double>(depth(i, j)));
                   red(i, j) = S(c.red);
                   green(i, j) = S(c.green);
                   if (i == 0) {
                     light.push_back(as<S>(p));
                   }
                 }
               }
               depth(0, n - 2) = S(1e-3);  // a thousandth and a millionth of a millimetre
               depth(0, n - 3) = S(1e-6);
               for (const fingerpad::Index j : {n - 2, n - 3}) {
                 const auto c = fingerpad::colour_at_depth(
                     fluid, as<double>(light[static_cast<std::size_t>(j)]), 57.0, 0.0163,
                     static_cast<double>(depth(0, j)));
                 red(0, j) = S(c.red);
                 green(0, j) = S(c.green);
               }
               const auto reference = fingerpad::fit_reference<S>(camera, fluid, red, green, depth);
               const auto fluid_s = fingerpad::cast<S>(fluid);
               const S delta = fluid_s.c_green_per_mm - fluid_s.c_red_per_mm;
               for (fingerpad::Index j = 0; j < n; ++j) {
                 const Ray<S>& p = light[static_cast<std::size_t>(j)];
                 const S l = depth(0, j);
                 const S known =
                     fluid_s.kappa * red(0, j) - green(0, j) * std::exp(delta * p.path_factor * l);
                 const S quotient = known / fingerpad::scattered_light(l, fluid_s.c_red_per_mm, p);
                 f.naive.add_relative(quotient, Digits50(0.0163));
                 f.stable.add_relative(reference.g(0, j), Digits50(0.0163));
               }
               return f;
             });
}

/// Plain Newton's method for c_red, c_green, kappa and g from four equations F(l_i) = 0, with the
/// exponentials of the printed equation.
template <class S>
std::array<S, 4> bare_newton(const std::array<SeenPixel<S>, 4>& seen,
                             const std::array<S, 4>& depth_mm,
                             std::array<S, 4> x) {
  for (int iteration = 0; iteration < 30; ++iteration) {
    std::array<std::array<S, 5>, 4> a;
    const auto f = [&](const std::array<S, 4>& at, std::size_t i) {
      const S path = seen[i].light.path_factor * depth_mm[i];
      const S w = closed_scattered_light(depth_mm[i], at[0], seen[i].light);
      return S(seen[i].colour.green * std::exp(at[1] * path) -
               (at[2] * seen[i].colour.red - at[3] * w) * std::exp(at[0] * path));
    };
    for (std::size_t i = 0; i < 4; ++i) {
      a[i][4] = -f(x, i);
      for (std::size_t k = 0; k < 4; ++k) {
        std::array<S, 4> other = x;
        const S step = x[k] * std::sqrt(fingerpad::epsilon<S>());
        other[k] += step;
        a[i][k] = (f(other, i) + a[i][4]) / step;
      }
    }
    for (std::size_t j = 0; j < 4; ++j) {  // Gauss-Jordan elimination
      for (std::size_t i = 0; i < 4; ++i) {
        const S factor = a[i][j] / a[j][j];
        for (std::size_t k = j; i != j && k < 5; ++k) {
          a[i][k] -= factor * a[j][k];
        }
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      x[k] += a[k][4] / a[k][k];
    }
  }
  return x;
}

inline Row equal_absorption() {
  return row("depth calibration",
             "c_red = c_green, four colours for four unknowns; the depths they then give, mm",
             "delta by itself, variable projection with QR, Levenberg-Marquardt", []<class S>(S) {
               Forms f;
               const auto pixel = [](double l) {
                 SeenPixel<S> p(l);
                 p.fluid.c_green_per_mm = p.fluid.c_red_per_mm;
                 const auto c = fingerpad::colour_at_depth(fingerpad::cast<double>(p.fluid),
                                                           as<double>(p.light), 57.0,
                                                           static_cast<double>(p.g), l);
                 p.colour = {S(c.red), S(c.green)};
                 return p;
               };
               const std::array<S, 4> l = {S(0.5), S(4), S(8), S(12)};
               const std::array<SeenPixel<S>, 4> seen = {pixel(0.5), pixel(4), pixel(8), pixel(12)};
               const auto depths = [&](const Absorption<S>& fluid, const S& g, Tally& tally) {
                 for (const double depth : {2.0, 6.0, 10.0}) {
                   const auto p = pixel(depth);
                   const auto root = fingerpad::newton_depth(fluid, p.light, g, p.colour);
                   tally.add_absolute(root.depth_mm, p.exact_depth());
                 }
               };
               for (const double red : {0.7, 0.9, 1.2}) {
                 for (const double green : {0.8, 1.1, 1.3}) {
                   const auto x =
                       bare_newton<S>(seen, l, {S(0.029 * red), S(0.029 * green), S(0.9), S(0.02)});
                   depths({x[0], x[1], x[2], S(14)}, x[3], f.naive);
                 }
               }
               std::vector<fingerpad::DepthSample<S>> samples;
               for (std::size_t i = 0; i < 4; ++i) {
                 samples.push_back({seen[i].light, {S(0), S(0)}, l[i], seen[i].colour});
               }
               const auto fit = fingerpad::fit_absorption<0, S>(
                   std::span<const fingerpad::DepthSample<S>>(samples));
               depths(fit.fluid, fit.light.scattering.at({S(0), S(0)}), f.stable);
               return f;
             });
}

}  // namespace hard
