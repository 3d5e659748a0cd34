// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Optics and depth.
#include <cmath>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/published/depth.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

using fingerpad::Absorption;
using fingerpad::Camera;
using fingerpad::Colour;
using fingerpad::PixelStatus;
using fingerpad::Ray;

/// The slides' closed form, with Q1 and Q2 as printed.
template <class S>
S closed_scattered_light(const S& l, const S& c, const Ray<S>& p) {
  using std::exp;
  const S& k = p.path_factor;
  const S product = p.meridional_mm * p.sagittal_mm;
  const S sum = p.meridional_mm + p.sagittal_mm;
  const S q1 = product / k + sum / (c * k * k) + S(2) / (c * c * k * k * k);
  const S q2 = (l * l + sum * l) / k + S(2) * l / (c * k * k);
  const S e = exp(S(-c * k * l));
  return S(q1 * (S(1) - e) - q2 * e);
}

template <class To, class From>
Ray<To> as(const Ray<From>& p) {
  return {.path_factor = To(p.path_factor),
          .meridional_mm = To(p.meridional_mm),
          .sagittal_mm = To(p.sagittal_mm)};
}
template <class S>
Ray<S> pencil_at_rim() {
  return as<S>(Ray<double>{.path_factor = 2.05, .meridional_mm = 72.7, .sagittal_mm = 68.5});
}

template <class S>
Forms scattered_light_forms(const std::vector<double>& c_per_mm, const std::vector<double>& l_mm) {
  Forms f;
  const auto p = pencil_at_rim<S>();
  for (const double c : c_per_mm) {
    for (const double depth : l_mm) {
      const S absorbs = S(c), l = S(depth);
      const Digits50 exact =
          closed_scattered_light(Digits50(l), Digits50(absorbs), as<Digits50>(p));
      f.naive.add_relative(closed_scattered_light(l, absorbs, p), exact);
      f.stable.add_relative(fingerpad::scattered_light(l, absorbs, p), exact);
    }
  }
  return f;
}

inline Row small_depth() {
  return row("depth", "`W(l)`, c = 0.029/mm, l from 1e-6 to 14 mm; relative",
             "moments of exp(-t s), series of positive terms",
             []<class S>(S) { return scattered_light_forms<S>({0.029}, sweep(1e-6, 14, 1.5)); });
}
inline Row small_absorption() {
  return row("depth", "`W(l)`, c from 1e-5 to 1e-3/mm, l = 1 mm; relative", "the same",
             []<class S>(S) { return scattered_light_forms<S>(sweep(1e-5, 1e-3, 1.5), {1.0}); });
}

/// Colours of a pixel at a depth in S.
template <class S>
struct SeenPixel {
  Absorption<S> fluid = fingerpad::cast<S>(Absorption<double>());
  Ray<S> light = pencil_at_rim<S>();
  S g = S(0.0163);
  Colour<S> colour;

  explicit SeenPixel(double depth_mm) {
    const auto c = fingerpad::colour_at_depth(fingerpad::cast<double>(fluid), as<double>(light),
                                              57.0, static_cast<double>(g), depth_mm);
    colour = {S(c.red), S(c.green)};
  }
  Digits50 exact_depth() const {
    const Colour<Digits50> seen{Digits50(colour.red), Digits50(colour.green)};
    return fingerpad::newton_depth(fingerpad::cast<Digits50>(fluid), as<Digits50>(light),
                                   Digits50(g), seen)
        .depth_mm;
  }
  fingerpad::DepthRoot<S> depth() const { return fingerpad::newton_depth(fluid, light, g, colour); }
};

/// The published bisection: as printed from l = 0 (E006), or with the first step repaired.
template <class S>
S published_bisection(const SeenPixel<S>& p, bool repaired) {
  namespace published = fingerpad::published;
  const published::Fluid<S> fluid{p.fluid.c_red_per_mm, p.fluid.c_green_per_mm, p.fluid.kappa};
  const S k = p.light.path_factor, h2 = p.light.meridional_mm;
  const auto& [red, green] = p.colour;
  if (repaired) {
    return published::bisect(fluid, k, h2, p.g, red, green, p.fluid.max_depth_mm);
  }
  S depth = S(0);
  S step = p.fluid.max_depth_mm / S(2);
  for (int i = 0; i < 16; ++i, step = step / S(2)) {
    const S f = published::quotient(fluid, k, h2, red, green, depth);
    depth = f >= p.g ? depth + step : depth - step;
  }
  return depth;
}

inline Row first_halving() {
  return row("depth", "published bisection, which begins at l = 0 with 0/0; l = 1 to 13 mm; mm",
             "Newton on F(l), no quotient", []<class S>(S) {
               Forms f;
               for (double l = 1; l < 13.5; l += 0.5) {
                 const SeenPixel<S> p(l);
                 f.naive.add_absolute(published_bisection(p, false), p.exact_depth());
                 f.stable.add_absolute(p.depth().depth_mm, p.exact_depth());
               }
               return f;
             });
}

inline Row no_depth() {
  return row("depth", "colours of no depth: green > kappa red, or deeper than the range; answers",
             "signs of F(0) and F(l_max), status", []<class S>(S) {
               Forms f;
               const auto add = [&](const SeenPixel<S>& p) {
                 f.naive.answer_none(!fingerpad::is_finite(published_bisection(p, true)));
                 const PixelStatus status = p.depth().status;
                 f.stable.answer_none(status == PixelStatus::below_range ||
                                      status == PixelStatus::above_range);
               };
               for (const double more : {0.001, 0.01, 0.1, 1.0}) {
                 SeenPixel<S> p(1e-6);
                 p.colour.green = p.fluid.kappa * p.colour.red * S(1 + more);
                 add(p);
               }
               for (const double beyond : {14.01, 14.1, 15.0, 17.0}) {
                 add(SeenPixel<S>(beyond));
               }
               return f;
             });
}

/// Mean of all pixels of a window, whatever their values.
template <class S>
S plain_box(const test::Image<S>& image, fingerpad::Index row, fingerpad::Index col) {
  S sum = S(0);
  for (fingerpad::Index i = row - 2; i <= row + 2; ++i) {
    for (fingerpad::Index j = col - 2; j <= col + 2; ++j) {
      sum += image(i, j);
    }
  }
  return S(sum / S(25));
}

inline Row saturated_pixels() {
  return row("depth", "a glare of 2 x 2 saturated pixels in a window of 5; against no glare, mm",
             "such pixels do not count in the mean", []<class S>(S) {
               Forms f;
               const test::Pad pad;
               const auto free = pad.free_depths();
               auto frame = pad.frame<S>(free);
               auto estimator = pad.estimator<S>({.window_px = 5});
               const auto clean = test::estimate(estimator, frame);
               for (fingerpad::Index i : {24, 25}) {
                 frame.red(i, 28) = frame.red(i, 29) = S(255);
                 frame.green(i, 28) = frame.green(i, 29) = S(255);
               }
               const auto glared = test::estimate(estimator, frame);
               for (fingerpad::Index i = 22; i < 28; ++i) {
                 for (fingerpad::Index j = 26; j < 32; ++j) {
                   const auto root = fingerpad::newton_depth(
                       fingerpad::cast<S>(pad.fluid), as<S>(pad.pencil(i, j)), S(pad.g(i, j)),
                       Colour<S>{plain_box(frame.red, i, j), plain_box(frame.green, i, j)});
                   if (root.status == PixelStatus::ok) {
                     f.naive.add_absolute(root.depth_mm, Digits50(free(i, j)));
                   } else {
                     f.naive.answer_none(true);
                   }
                   f.stable.add_absolute(glared.depth_mm(i, j), Digits50(clean.depth_mm(i, j)));
                 }
               }
               return f;
             });
}

/// Virtual height by angles, as the slides write it.
template <class S>
S height_by_angles(const Camera<S>& camera, const S& tan_air) {
  using std::asin;
  using std::atan;
  using std::cos;
  using std::sin;
  const S air = atan(tan_air);
  const S fluid = asin(S(sin(air) / camera.refractive_index));
  const S ratio = cos(fluid) / cos(air);
  return S(camera.refractive_index * camera.plate_distance_mm * ratio * ratio * ratio);
}

inline Row grazing_rays() {
  return row("optics", "virtual height, tan(phi_air) from 0.1 to 1e9; relative",
             "tangents from the pixel, cosines by square roots", []<class S>(S) {
               Forms f;
               const Camera<S> camera = fingerpad::cast<S>(Camera<double>());
               const auto exact_camera = fingerpad::cast<Digits50>(camera);
               for (const double t : sweep(0.1, 1e9, 2)) {
                 const S tangent = S(t);
                 const Digits50 exact = height_by_angles(exact_camera, Digits50(tangent));
                 f.naive.add_relative(height_by_angles(camera, tangent), exact);
                 const auto ray = fingerpad::ray_at_tangent(camera, tangent);
                 f.stable.add_relative(ray.meridional_mm, exact);
               }
               return f;
             });
}

/// x of eq. 13 with the tangent instead of the sine, by angles and the direction x / rho.
template <class S>
S position_by_angles(const Camera<S>& camera, const S& row, const S& col, const S& depth_mm) {
  const S x = (col - camera.center_x_px) * camera.pitch_mm;
  const S y = (row - camera.center_y_px) * camera.pitch_mm;
  const S rho = std::sqrt(x * x + y * y);
  const S air = std::atan(rho / camera.plate_distance_mm);
  const S fluid = std::asin(std::sin(air) / camera.refractive_index);
  return x + depth_mm * std::tan(fluid) * x / rho;
}

inline Row center_pixel() {
  return row(
      "dot position", "the row of pixels through the axis, 10 mm deep; mm",
      "1 / sqrt(n^2 + (n^2 - 1) t^2): no direction, no angle", []<class S>(S) {
        Forms f;
        Camera<S> camera = fingerpad::cast<S>(Camera<double>());
        camera.center_x_px = S(320);
        camera.center_y_px = S(240);
        const auto exact_camera = fingerpad::cast<Digits50>(camera);
        for (int col = 0; col < 640; ++col) {
          const Digits50 exact =
              fingerpad::point_at(exact_camera, Digits50(240), Digits50(col), Digits50(10)).x;
          f.naive.add_absolute(position_by_angles(camera, S(240), S(col), S(10)), exact);
          f.stable.add_absolute(fingerpad::point_at(camera, S(240), S(col), S(10)).x, exact);
        }
        return f;
      });
}

}  // namespace hard
