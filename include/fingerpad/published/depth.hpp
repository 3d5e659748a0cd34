// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The RGB depth model as printed: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor"
// (slides), and Ito, Kim, Nagai, Obinata 2011, III.A and eq. 13. Means over 29 x 29 px of the frame
// and of the reference, a quotient g for each pixel, one height in both directions of a pencil,
// bisection in 16 halvings, and three equations for the fluid. With the repairs without which there
// is no number (docs/errata.md, E001-E006) and no others; docs/depth/depth.md says what the default
// does instead.
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

/// The camera above the fluid; the slides neglect the plate.
template <scalar S = double>
struct Pinhole {
  S h1_mm = S(50);         ///< from the camera to the fluid, > 0
  S n = S(133) / S(100);   ///< refractive index of the fluid, >= 1
  S center_row_px = S(0);  ///< pixel on the axis
  S center_col_px = S(0);
  S pitch_mm = S(8) / S(100);  ///< of pixels on the fluid's surface, > 0
};

/// The properties of the fluid; the defaults are the published values.
template <scalar S = double>
struct Fluid {
  S c_R = S(290) / S(10000);     ///< absorption of red per mm, > 0
  S c_G = S(336) / S(10000);     ///< absorption of green per mm, > 0
  S kappa = S(9924) / S(10000);  ///< of light source and camera, > 0
};

/// What a pixel's ray gives to the equations.
template <scalar S = double>
struct PixelRay {
  S k;      ///< 1 + 1/cos(phi1): the light goes k l to depth l and back
  S h2_mm;  ///< of the point in the fluid from which the light seems to come
};

/// The ray of the pixel at (row, col), at the angle phi1 in the fluid and phi2 in air. h2 = n h1
/// cos^3(phi1) / cos^3(phi2) is the closed form of the slides' chain of differentials; it holds in
/// the plane of the ray only (E007).
template <scalar S>
PixelRay<S> ray_of(const Pinhole<S>& camera, const S& row, const S& col) {
  using std::sqrt;
  const S x = (col - camera.center_col_px) * camera.pitch_mm;
  const S y = (row - camera.center_row_px) * camera.pitch_mm;
  const S tan_sq = (x * x + y * y) / square(camera.h1_mm);
  const S cos2 = S(1) / sqrt(S(1) + tan_sq);
  const S sin1_sq = tan_sq * cos2 * cos2 / square(camera.n);
  const S cos1 = sqrt(S(1) - sin1_sq);
  const S ratio = cos1 / cos2;
  return {S(1) + S(1) / cos1, camera.n * camera.h1_mm * ratio * ratio * ratio};
}

/// Eq. 13 of Ito et al. 2011 as printed, with the sine. It is right only if depth_mm is a length
/// along the ray. With a depth along z it is at most 0.026 mm short on a pad 50 mm from the camera,
/// and 0.39 mm at 30 degrees and a depth of 13 mm (E019).
template <scalar S>
Point3<S> point_at(const Pinhole<S>& camera, const S& row, const S& col, const S& depth_mm) {
  using std::sqrt;
  const S x = (col - camera.center_col_px) * camera.pitch_mm;
  const S y = (row - camera.center_row_px) * camera.pitch_mm;
  const S cos2 = S(1) / sqrt(S(1) + (x * x + y * y) / square(camera.h1_mm));
  const S stretch = S(1) + depth_mm * cos2 / (camera.n * camera.h1_mm);  // sin1 / tan2 = cos2 / n
  return {x * stretch, y * stretch, depth_mm};
}

/// The quotient f(l) = g at the depth l > 0 of a pixel, with the repairs E003-E005:
/// (b_G e^{c_G k l} - kappa b_R e^{c_R k l}) / (Q1 (1 - e^{c_R k l}) + Q2). It is 0/0 at l = 0.
/// Colours are grey levels.
template <scalar S>
S quotient(
    const Fluid<S>& fluid, const S& k, const S& h2_mm, const S& b_R, const S& b_G, const S& l) {
  using std::exp;
  const S ck = fluid.c_R * k;
  const S q1 = (h2_mm * h2_mm + (S(2) * h2_mm + S(2) / ck) / ck) / k;
  const S q2 = (l * l + S(2) * h2_mm * l + S(2) * l / ck) / k;
  const S e_R = exp(ck * l);
  const S e_G = exp(fluid.c_G * k * l);
  return (b_G * e_G - fluid.kappa * b_R * e_R) / (q1 * (S(1) - e_R) + q2);
}

/// The depth in (0, max_depth_mm) at which f(l) = g. Each halving moves l by half as much as the
/// one before: by 0.43 um at the last of 16 for 14 mm. As printed it starts at l = 0, where f is
/// 0/0, and every pixel ends at the wrong end of the range (E006); so the first step goes to the
/// middle. Where there is no root, it ends at an end of the range.
template <scalar S>
S bisect(const Fluid<S>& fluid,
         const S& k,
         const S& h2_mm,
         const S& g,
         const S& b_R,
         const S& b_G,
         const S& max_depth_mm,
         int halvings = 16) {
  S l = max_depth_mm / S(2);
  S step = l / S(2);
  for (int i = 2; i < halvings; ++i) {
    const bool root_is_deeper = !(quotient(fluid, k, h2_mm, b_R, b_G, l) < g);
    l = root_is_deeper ? l + step : l - step;
    step = step / S(2);
  }
  return l;
}

template <scalar S = double>
struct DepthOptions {
  Pinhole<S> camera = {};
  Fluid<S> fluid = {};
  int window_px = 29;        ///< width of the window of both means, odd, 1..255
  int halvings = 16;         ///< in 2..100
  S max_depth_mm = S(14);    ///< > 0
  S units_per_level = S(1);  ///< of the frames: 1 for 8 bit, 256 for 16 bit
};

/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const DepthOptions<S>& o) {
  return fingerpad::check("published::DepthOptions",
                          {{"camera.h1_mm", o.camera.h1_mm, positive},
                           {"camera.n", o.camera.n, at_least(1)},
                           {"camera.center_row_px", o.camera.center_row_px, finite_number},
                           {"camera.center_col_px", o.camera.center_col_px, finite_number},
                           {"camera.pitch_mm", o.camera.pitch_mm, positive},
                           {"fluid.c_R", o.fluid.c_R, positive},
                           {"fluid.c_G", o.fluid.c_G, positive},
                           {"fluid.kappa", o.fluid.kappa, positive},
                           {"window_px", o.window_px, odd_within(1, 255)},
                           {"halvings", o.halvings, within(2, 100)},
                           {"max_depth_mm", o.max_depth_mm, positive},
                           {"units_per_level", o.units_per_level, positive}});
}

/// Depth of frames of one pad. A mean is one over the pixels of the window that lie in the pad and
/// are neither 0 nor 255 in a channel. A call allocates nothing; O(rows cols halvings).
template <scalar S = double>
class DepthEstimator {
 public:
  /// From a frame of the free pad and its depth l0 along each pixel's ray; NaN outside the pad. g
  /// is the quotient of its averaged colours; it is useless near the rim, where l0 vanishes.
  /// Refuses bad options and grids of different sizes (parameter_error).
  template <grid Red, grid Green, grid Depth>
  DepthEstimator(const DepthOptions<S>& options,
                 const Red& red,
                 const Green& green,
                 const Depth& free_depth_mm)
      : options_(options), rows_(fingerpad::rows(red)), cols_(fingerpad::cols(red)) {
    require(options);
    expects_grid_size("published::DepthEstimator", rows_, cols_);
    expects(has_size(green) && has_size(free_depth_mm), "published::DepthEstimator",
            "rows of free_depth_mm", static_cast<long long>(fingerpad::rows(free_depth_mm)),
            "of the same size as the red and green image");
    const auto l0 = as_view(free_depth_mm);
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        in_pad_.push_back(value(static_cast<S>(l0(i, j))) >= 0);
      }
    }
    columns_.resize(static_cast<std::size_t>(cols_));
    for_each_mean(as_view(red), as_view(green), [&](Index i, Index j, const S& b_R, const S& b_G) {
      const auto ray = ray_at(i, j);
      const S l = static_cast<S>(l0(i, j));
      g_.push_back(value(l) > 0 ? quotient(options_.fluid, ray.k, ray.h2_mm, b_R, b_G, l)
                                : not_a_number<S>());
    });
  }

  /// Depth of a frame; NaN where g is unknown or no pixel of the window counts. False, and nothing
  /// written, where a grid has another size.
  template <grid Red, grid Green, class Depth>
  bool operator()(const Red& red, const Green& green, Depth&& depth_mm) {
    if (!(has_size(red) && has_size(green) && has_size(depth_mm))) {
      return false;
    }
    const auto to = as_view(depth_mm);
    for_each_mean(as_view(red), as_view(green), [&](Index i, Index j, const S& b_R, const S& b_G) {
      const S g = g_[place(i, j)];
      S l = not_a_number<S>();
      if (is_finite(g) && is_finite(b_R)) {
        const auto ray = ray_at(i, j);
        l = bisect(options_.fluid, ray.k, ray.h2_mm, g, b_R, b_G, options_.max_depth_mm,
                   options_.halvings);
      }
      to(i, j) = static_cast<cell_t<Depth>>(l);
    });
    return true;
  }

 private:
  using Sums = Point3<S>;  // over pixels that count: of 1, red and green

  template <class G>
  bool has_size(const G& g) const {
    return fingerpad::rows(g) == rows_ && fingerpad::cols(g) == cols_;
  }
  std::size_t place(Index i, Index j) const { return static_cast<std::size_t>(i * cols_ + j); }
  PixelRay<S> ray_at(Index i, Index j) const {
    return ray_of(options_.camera, S(static_cast<double>(i)), S(static_cast<double>(j)));
  }

  /// Calls visit(i, j, b_R, b_G) with the means of each pixel's window in grey levels, NaN where
  /// none counts. The sums of columns move down the image, and their sum along each row.
  template <class Red, class Green, class Visit>
  void for_each_mean(const Red& red, const Green& green, const Visit& visit) {
    const auto counts = [](const S& x) { return value(x) > 0 && value(x) < 255; };
    const auto pixel = [&](Index i, Index j) -> Sums {
      if (i < 0 || i >= rows_ || !in_pad_[place(i, j)]) {
        return {S(0), S(0), S(0)};
      }
      const S r = static_cast<S>(red(i, j)) / options_.units_per_level;
      const S g = static_cast<S>(green(i, j)) / options_.units_per_level;
      return counts(r) && counts(g) ? Sums{S(1), r, g} : Sums{S(0), S(0), S(0)};
    };
    const auto column = [&](Index j) {
      return j < 0 || j >= cols_ ? Sums{S(0), S(0), S(0)} : columns_[static_cast<std::size_t>(j)];
    };
    const Index half = options_.window_px / 2;
    columns_.assign(columns_.size(), Sums{S(0), S(0), S(0)});
    for (Index i = -half; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        columns_[static_cast<std::size_t>(j)] += pixel(i + half, j) - pixel(i - half - 1, j);
      }
      Sums sum = {S(0), S(0), S(0)};
      for (Index j = -half; j < cols_ && i >= 0; ++j) {
        sum += column(j + half) - column(j - half - 1);
        if (j >= 0) {
          visit(i, j, sum.y / sum.x, sum.z / sum.x);
        }
      }
    }
  }

  DepthOptions<S> options_;
  Index rows_, cols_;
  std::vector<bool> in_pad_;
  std::vector<S> g_;           // of each pixel
  std::vector<Sums> columns_;  // over the window's rows
};

/// A colour at a known depth.
template <scalar S = double>
struct KnownPixel {
  S k;         ///< of the pixel's ray
  S h2_mm;     ///< of the pixel's ray
  S depth_mm;  ///< l along z, > 0
  S b_R;       ///< grey levels, > 0
  S b_G;
};

/// c_R, c_G and kappa from three measurements at known depths and a reference: f(l_i) = f(l_0), i =
/// 1, 2, 3, "solving by numerical analytical approach such as Newton method". Newton's method from
/// `guess`, with derivatives by central differences; each step is halved until the residual falls.
/// No fluid where that does not reach roundoff. This hardly determines the parameters
/// (docs/papers.md). Never throws, bounded time.
template <scalar S>
std::optional<Fluid<S>> identify_fluid(const KnownPixel<S>& reference,
                                       const std::array<KnownPixel<S>, 3>& measured,
                                       const Fluid<S>& guess = {}) {
  using std::sqrt;
  const S step = sqrt(S(epsilon<S>()));
  const auto residuals = [&](const Point3<S>& p) {  // f(l_i) / f(l_0) - 1
    const auto f = [&](const KnownPixel<S>& at) {
      return quotient(Fluid<S>{p.x, p.y, p.z}, at.k, at.h2_mm, at.b_R, at.b_G, at.depth_mm);
    };
    const S g = f(reference);
    return Point3<S>{f(measured[0]) / g - S(1), f(measured[1]) / g - S(1),
                     f(measured[2]) / g - S(1)};
  };
  Point3<S> p = {guess.c_R, guess.c_G, guess.kappa};
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Point3<S> r = residuals(p);
    const auto slope = [&](const Point3<S>& along) {
      return (residuals(p + step * along) - residuals(p - step * along)) / (S(2) * step);
    };
    const Point3<S> by_R = slope({p.x, S(0), S(0)}), by_G = slope({S(0), p.y, S(0)}),
                    by_kappa = slope({S(0), S(0), p.z});
    // Cramer's rule; not finite if the depths do not determine the parameters
    const S volume = dot(by_R, cross(by_G, by_kappa));
    Point3<S> change = {p.x * dot(r, cross(by_G, by_kappa)) / volume,
                        p.y * dot(r, cross(by_kappa, by_R)) / volume,
                        p.z * dot(r, cross(by_R, by_G)) / volume};
    const auto falls = [&](const Point3<S>& next) {
      const Point3<S> there = residuals(next);
      return value(next.x) > 0 && value(next.y) > 0 && value(next.z) > 0 &&
             value(dot(there, there)) < value(dot(r, r));
    };
    for (int half = 0; half < 30 && !falls(p - change); ++half) {
      change = change / S(2);
    }
    if (!falls(p - change)) {  // converged to roundoff, or stuck
      const bool converged =
          is_finite(change) && value(dot(r, r)) < value(square(S(1000) * step * step));
      return converged ? std::optional(Fluid<S>{p.x, p.y, p.z}) : std::nullopt;
    }
    p = p - change;
  }
  return std::nullopt;
}

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
