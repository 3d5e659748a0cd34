// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The reference of the depth model, a set of planes over the image: the depth of the free pad, how
// strongly the fluid scatters light there, g(x, y), and the gain of red. fit_reference() finds them
// from one frame of the free pad, whose shape is known. The published quotient per pixel, g =
// (kappa red - green exp(delta k l)) / W, is useless at the rim, where W vanishes. But g depends
// only on the ray's angle. Therefore it is fitted as a polynomial in rho^2 by least squares on the
// depth equation itself, which is linear in the coefficients and nowhere 0/0.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

/// Relation of stored intensities to grey levels 0..255, and the limits beyond which they carry no
/// information. A pixel counts only if both its channels lie strictly between the two limits.
struct GreyScale {
  double units_per_level = 1;  ///< stored units in one grey level: 1 for 8 bit, 256 for 16 bit
  double dark = 0;             ///< in stored units
  double saturated = 255;      ///< in stored units

  /// Whether an intensity carries information. False for NaN.
  template <scalar S>
  constexpr bool counts(const S& x) const {
    return value(x) > scalar_real_t<S>(dark) && value(x) < scalar_real_t<S>(saturated);
  }
};

/// Says which value is out of range; "" if none is. A scale has at most the levels of 8 bit.
inline std::string check(const GreyScale& scale) {
  const Range in_levels{.min = scale.dark, .max = 256 * scale.units_per_level, .above_min = true};
  return check("GreyScale", {{"units_per_level", scale.units_per_level, positive},
                             {"dark", scale.dark, finite_number},
                             {"saturated", scale.saturated, in_levels}});
}

/// The scale of a cell type: 16-bit images hold 256 times the grey level, all others the grey
/// level.
template <class Cell>
constexpr GreyScale grey_scale_of() {
  return std::is_same_v<Cell, std::uint16_t> ? GreyScale{256, 0, 255 * 256} : GreyScale{};
}

/// The free pad, as the depth estimator needs it. Planes have rows x cols elements.
template <scalar S>
struct DepthReference {
  Index rows = 0;
  Index cols = 0;
  std::vector<S> depth_mm;    ///< of the free pad along each pixel's ray; NaN outside
  std::vector<S> scattering;  ///< g, grey levels per mm^2; a pixel with g <= 0 or NaN is not used
  std::vector<S> red_gain;    ///< kappa of the pixel over that of the fluid; a pixel with a gain
                              ///< <= 0 or NaN is not used; empty: 1 everywhere
  Index pixels_used = 0;
  S residual_rms = S(0);  ///< of the depth equation at the known depths, grey levels
  S rim_green = S(0);     ///< mean green near the rim, grey levels; frames are compared with it to
                          ///< detect changed light. 0: unknown

  const S& depth(Index row, Index col) const { return depth_mm[at(row, col)]; }
  const S& g(Index row, Index col) const { return scattering[at(row, col)]; }
  S gain(Index row, Index col) const { return red_gain.empty() ? S(1) : red_gain[at(row, col)]; }
  bool in_pad(Index row, Index col) const { return is_finite(depth(row, col)); }

 private:
  std::size_t at(Index row, Index col) const { return static_cast<std::size_t>(row * cols + col); }
};

/// g as a polynomial in v = (rho / rho_max)^2; grey levels per mm^2.
template <scalar S, int Degree = 3>
struct RadialScattering {
  std::array<S, static_cast<std::size_t>(Degree) + 1> coefficient =
      detail::zeros<S, static_cast<std::size_t>(Degree) + 1>();  ///< of 1, v, v^2, ...
  S rho_max_mm = S(1);  ///< distance from the axis of the farthest pixel of the fit, on the plate

  S at(const S& rho_sq_mm2) const {
    const S v = rho_sq_mm2 / (rho_max_mm * rho_max_mm);
    S g = coefficient[static_cast<std::size_t>(Degree)];
    for (int j = Degree - 1; j >= 0; --j) {
      g = g * v + coefficient[static_cast<std::size_t>(j)];
    }
    return g;
  }
};

namespace detail {

/// Calls visit(row, col) for every pixel.
template <class Visit>
void each_pixel(Index rows, Index cols, const Visit& visit) {
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      visit(i, j);
    }
  }
}

template <scalar C>
Ray<C> ray_of(const Camera<C>& camera, Index row, Index col) {
  return ray_at_pixel(camera, C(static_cast<double>(row)), C(static_cast<double>(col)));
}

/// Shape of the free pad, to detect mistakes.
struct FreePadShape {
  double pixels = 0;
  double deepest_mm = 0;  ///< of the depths up to max_depth_mm
  double at_zero = 0;     ///< pixels at depth 0
  double too_deep = 0;    ///< share of the pixels in their middle that lie beyond max_depth_mm
  double off_axis = 0;  ///< distance of their centroid from the optical axis, in radii of a disc of
                        ///< as many pixels; 0 if part of the pad is not seen
};

/// `depth_mm` holds doubles.
template <scalar C, class Depth>
FreePadShape shape_of_free_pad(const Camera<C>& camera,
                               double max_depth_mm,
                               const Depth& depth_mm) {
  const auto center_x_px = static_cast<double>(value(camera.center_x_px));
  const auto center_y_px = static_cast<double>(value(camera.center_y_px));
  const auto aspect = static_cast<double>(value(camera.pixel_aspect));
  const Index rows = depth_mm.rows(), cols = depth_mm.cols();
  FreePadShape shape;
  double sum_x = 0, sum_y = 0;
  bool reaches_border = false;
  each_pixel(rows, cols, [&](Index i, Index j) {
    const double l = depth_mm(i, j);
    if (is_finite(l) && l >= 0) {
      shape.pixels += 1;
      shape.at_zero += l == 0 ? 1 : 0;
      shape.deepest_mm = l > max_depth_mm ? shape.deepest_mm : (std::max)(shape.deepest_mm, l);
      sum_x += static_cast<double>(j) - center_x_px;
      sum_y += (static_cast<double>(i) - center_y_px) * aspect;
      reaches_border = reaches_border || i == 0 || j == 0 || i + 1 == rows || j + 1 == cols;
    }
  });
  const double radius_sq = shape.pixels * aspect / std::numbers::pi;
  double middle = 0;
  each_pixel(rows, cols, [&](Index i, Index j) {
    const double x = static_cast<double>(j) - center_x_px - sum_x / shape.pixels;
    const double y = (static_cast<double>(i) - center_y_px) * aspect - sum_y / shape.pixels;
    if (depth_mm(i, j) >= 0 && x * x + y * y <= radius_sq / 16) {
      middle += 1;
      shape.too_deep += depth_mm(i, j) > max_depth_mm ? 1 : 0;
    }
  });
  shape.too_deep = middle > 0 ? shape.too_deep / middle : 0;
  if (!reaches_border && shape.pixels >= 100) {  // else there may be no pad at all
    shape.off_axis = std::hypot(sum_x, sum_y) / (shape.pixels * std::sqrt(radius_sq));
  }
  return shape;
}

/// Refuses shapes that no free pad has, and names the likely mistake.
inline void expects_free_pad(const FreePadShape& shape, double max_depth_mm) {
  constexpr const char* owner = "fit_reference";
  if (shape.pixels == 0) {
    return;  // the fit reports it
  }
  expects(shape.too_deep <= 0.5, owner, "share of the pad's middle beyond max_depth_mm",
          shape.too_deep, "<= 0.5: raise max_depth_mm, or give mm");
  expects(shape.deepest_mm >= 0.1 * max_depth_mm, owner, "deepest point of depth_mm",
          shape.deepest_mm, ">= a tenth of max_depth_mm: give mm, not m");
  expects(shape.at_zero <= 0.1 * shape.pixels, owner, "share of pixels at depth 0",
          shape.at_zero / shape.pixels, "<= 0.1: depth_mm must be NaN outside of the pad");
  expects(shape.off_axis <= 0.25, owner, "distance of the pad's center from the axis, in radii",
          shape.off_axis, "<= 0.25: camera.center_x_px, center_y_px are not those of this image");
}

/// Depth up to which a pixel of the free pad counts as near the rim, where a press hardly moves it.
inline double rim_depth_mm(double deepest_mm) {
  return 0.2 * deepest_mm;
}

/// The depth equation of a pixel of the free pad: known = g(rho) scattered.
template <scalar C>
struct ScatteringEquation {
  C rho_sq_mm2;
  C known;
  C scattered;
};

/// g by least squares. In double, the cubic that is needed is far from losing digits. Refuses data
/// that do not determine g.
template <scalar C>
RadialScattering<C> fit_scattering(const std::vector<ScatteringEquation<C>>& equations) {
  using std::sqrt;
  constexpr std::size_t n = 4;
  C rho_sq_max = C(0);
  for (const auto& e : equations) {
    rho_sq_max = value(rho_sq_max) < value(e.rho_sq_mm2) ? e.rho_sq_mm2 : rho_sq_max;
  }
  std::array<C, n> projected = zeros<C, n>(), term;
  SmallMatrix<C, n> normal;
  normal.fill(projected);
  for (const auto& [rho_sq, known, scattered] : equations) {
    C power = scattered;
    for (std::size_t a = 0; a < n; ++a, power = power * rho_sq / rho_sq_max) {
      term[a] = power;
      projected[a] = projected[a] + power * known;
      for (std::size_t b = 0; b <= a; ++b) {
        normal[a][b] = normal[b][a] = normal[a][b] + power * term[b];
      }
    }
  }
  const NormalEquations<C, n> solver(normal, static_cast<double>(1000 * epsilon<C>()));
  expects(equations.size() >= n && solver.good, "fit_reference", "pixels with a known depth",
          equations.size(),
          "enough, and far enough apart, to determine the scattering over the radius");
  return {solver.solve(projected), sqrt(rho_sq_max)};
}

/// Refuses a g that no fluid has. The pad holds one fluid, and a lens darkens toward the rim by
/// less than half, so g may vary by a factor of 2 at most. It is hardly less on the axis than
/// elsewhere, except where the membrane is pressed there. The limit of the residual, 5 grey levels,
/// is what a poor camera with a noise of three grey levels leaves.
template <scalar S>
void expects_scattering(const DepthReference<S>& reference, const S& on_axis) {
  constexpr const char* owner = "fit_reference";
  double min_g = (std::numeric_limits<double>::infinity)();
  double max_g = -min_g;
  for (const S& g : reference.scattering) {
    const auto plain = static_cast<double>(value(g));
    min_g = plain < min_g ? plain : min_g;  // not for NaN
    max_g = plain > max_g ? plain : max_g;
  }
  const auto residual = static_cast<double>(value(reference.residual_rms));
  const double axis_share = static_cast<double>(value(on_axis)) / max_g;
  expects(min_g > 0, owner, "scattering of the fluid", min_g,
          "> 0: are red and green exchanged, is depth_mm the height of the free pad, and are the "
          "constants of absorption those of this fluid?");
  expects(
      min_g >= 0.5 * max_g, owner, "least scattering, as a share of the largest", min_g / max_g,
      ">= 0.5: is the frame one of the free pad, and depth_mm its height along each pixel's ray?");
  expects(axis_share >= 0.75, owner, "scattering on the axis, as a share of the largest",
          axis_share, ">= 0.75: is the reference of the free pad?");
  expects(residual <= 5, owner, "residual in grey levels", residual,
          "<= 5: do red, green and depth_mm show the same free pad?");
}

}  // namespace detail

/// Finds the reference from one frame of the free pad and its depth along each pixel's ray in mm,
/// NaN outside the pad. An average of many frames is better: store it as 16 bit or float. Refuses
/// grids of different sizes, data that do not determine g, and shapes that no free pad has, and
/// names the likely mistake (parameter_error). If camera and fluid consist of dual numbers and S is
/// that dual number, g carries the derivatives. O(rows cols); allocates.
template <scalar S = float, scalar C, grid Red, grid Green, grid Depth>
DepthReference<S> fit_reference(const Camera<C>& camera,
                                const Absorption<C>& fluid,
                                const Red& red,
                                const Green& green,
                                const Depth& depth_mm,
                                const GreyScale& scale = grey_scale_of<cell_t<Red>>()) {
  using std::exp;
  using std::sqrt;
  const auto reds = as_view(red);
  const auto greens = as_view(green);
  const auto depths = as_view(depth_mm);
  require(camera);
  require(fluid);
  require(scale);
  expects(same_size(reds, greens) && same_size(reds, depths), "fit_reference", "rows of depth_mm",
          static_cast<long long>(depths.rows()), "of the same size as the red and green image");
  DepthReference<S> reference;
  reference.rows = depths.rows();
  reference.cols = depths.cols();
  expects_grid_size("fit_reference", reference.rows, reference.cols);
  for (const Index k : {0, 1, 2, 3}) {
    const auto corner =
        detail::ray_of(camera, k / 2 * (reference.rows - 1), k % 2 * (reference.cols - 1));
    expects(is_finite(corner.tan_air), "fit_reference", "camera.distortion_k1",
            static_cast<double>(value(camera.distortion_k1)),
            "a distortion that does not fold back within the image");
  }
  const auto max_depth_mm = static_cast<double>(value(fluid.max_depth_mm));
  const LazyView plain_depth(depths.rows(), depths.cols(), [&](Index i, Index j) {
    return static_cast<double>(value(static_cast<C>(depths(i, j))));
  });
  const auto shape = detail::shape_of_free_pad(camera, max_depth_mm, plain_depth);
  detail::expects_free_pad(shape, max_depth_mm);

  std::vector<detail::ScatteringEquation<C>> equations;
  detail::each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
    const C l = static_cast<C>(depths(i, j));
    const C r = static_cast<C>(reds(i, j));
    const C b = static_cast<C>(greens(i, j));
    if (value(l) > 0 && value(l) <= value(fluid.max_depth_mm) && scale.counts(r) &&
        scale.counts(b)) {
      const Ray<C> ray = detail::ray_of(camera, i, j);
      const Pencil<C> pencil = pencil_of(camera, ray);
      const C delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
      const C membrane = b * exp(delta * pencil.path_factor * l);
      equations.push_back({square(ray.plate_rho_mm),
                           (fluid.kappa * r - membrane) / C(scale.units_per_level),
                           scattered_light(l, fluid.c_red_per_mm, pencil)});
    }
  });
  const RadialScattering<C> g = detail::fit_scattering(equations);
  C left_sq = C(0);
  for (const auto& [rho_sq, known, scattered] : equations) {
    left_sq = left_sq + square(known - g.at(rho_sq) * scattered);
  }
  // The square root has no derivative at 0.
  const C mean_sq = left_sq / C(static_cast<double>(equations.size()));
  reference.residual_rms = S(value(mean_sq) > 0 ? sqrt(mean_sq) : C(0));
  reference.pixels_used = static_cast<Index>(equations.size());

  double light = 0, count = 0;
  detail::each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
    const double l = plain_depth(i, j);
    const bool inside = l >= 0 && l <= max_depth_mm;
    reference.depth_mm.push_back(inside ? S(static_cast<C>(depths(i, j))) : not_a_number<S>());
    reference.scattering.push_back(
        inside ? S(g.at(square(detail::ray_of(camera, i, j).plate_rho_mm))) : not_a_number<S>());
    const C b = static_cast<C>(greens(i, j));
    if (l >= 0 && l <= detail::rim_depth_mm(shape.deepest_mm) && scale.counts(b)) {
      light += static_cast<double>(value(b)) / scale.units_per_level;
      count += 1;
    }
  });
  reference.rim_green = S(count > 0 ? light / count : 0);
  detail::expects_scattering(reference, S(g.at(C(0))));
  return reference;
}

}  // namespace v0
}  // namespace fingerpad
