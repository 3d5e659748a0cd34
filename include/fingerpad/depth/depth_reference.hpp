// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The reference of the depth model: which pixels see the pad, and how strongly the fluid scatters
// light, g. Both come from one frame of the free pad, whose shape is known. The published quotient
// per pixel, g = (kappa red - green exp(delta k l)) / W, is useless at the rim, where W vanishes.
// But g depends only on the ray's angle. Therefore it is fitted as a polynomial in rho^2 by least
// squares on the depth equation itself, which is linear in the coefficients and nowhere 0/0.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
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
};

/// Refuses a scale on which no pixel could count, or whose levels exceed those of an 8-bit image.
inline void expects_valid(const GreyScale& scale) {
  expects(scale.units_per_level > 0 && is_finite(scale.units_per_level), "GreyScale",
          "units_per_level", scale.units_per_level, "finite and > 0");
  expects(is_finite(scale.dark), "GreyScale", "dark", scale.dark, "finite");
  expects(scale.saturated > scale.dark && scale.saturated <= 256 * scale.units_per_level,
          "GreyScale", "saturated", scale.saturated, "in (dark, 256 units_per_level]");
}

/// The scale of a cell type: 16-bit images hold 256 times the grey level, all others the grey
/// level.
template <class Cell>
constexpr GreyScale grey_scale_of() {
  return std::is_same_v<Cell, std::uint16_t> ? GreyScale{256, 0, 255 * 256} : GreyScale{};
}

/// g as a polynomial of degree `Degree` in v = (rho / rho_max)^2; grey levels per mm^2.
template <scalar S, int Degree = 3>
struct RadialScattering {
  static constexpr bool is_radial = true;
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
  S operator()(Index /*row*/, Index /*col*/, const S& rho_sq_mm2) const { return at(rho_sq_mm2); }
  /// The same in another part of the image.
  RadialScattering cropped(Index, Index, Index, Index) const { return *this; }
  /// The same in an image of larger pixels.
  RadialScattering sampled(Index, Index, int) const { return *this; }
};

/// The free pad, in the form that the depth estimator needs. The type includes the height policy
/// with which g was fitted, so that the estimator uses the same one.
template <scalar S, class Scattering = RadialScattering<S>, class Heights = AstigmaticHeights>
struct DepthReference {
  Index rows = 0;
  Index cols = 0;
  std::vector<S> depth_mm;  ///< rows x cols, of the free pad along each pixel's ray; NaN outside
  Scattering scattering;
  Index pixels_used = 0;
  S residual_rms = S(0);  ///< of the depth equation at the known depths, grey levels
  S rim_green = S(0);     ///< mean green near the rim, grey levels; frames are compared with it to
                          ///< detect changed light. 0: unknown

  const S& depth(Index row, Index col) const {
    return depth_mm[static_cast<std::size_t>(row * cols + col)];
  }
  bool in_pad(Index row, Index col) const { return is_finite(depth(row, col)); }
};

namespace detail {

/// Converts a cell of a grid to the scalar C. Integers and floats go through double.
template <scalar C, class Cell>
C in_scalar(const Cell& cell) {
  if constexpr (std::is_floating_point_v<C>) {
    return static_cast<C>(cell);
  } else if constexpr (std::is_arithmetic_v<Cell>) {
    return C(static_cast<double>(cell));
  } else {
    return C(cell);
  }
}

/// A cell without its derivatives.
template <class Cell>
double plain(const Cell& cell) {
  if constexpr (std::is_arithmetic_v<Cell>) {
    return static_cast<double>(cell);
  } else {
    return static_cast<double>(value(cell));
  }
}

/// Calls visit(row, col, rho_sq, known, scattered) for every usable pixel of the reference, where
/// the depth equation reads known = g * scattered.
template <class Heights, scalar C, class Red, class Green, class Depth, class Visit>
void visit_reference(const Camera<C>& camera,
                     const Absorption<C>& fluid,
                     const GreyScale& scale,
                     const Red& red,
                     const Green& green,
                     const Depth& depth_mm,
                     Visit&& visit) {
  using std::exp;
  const C delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
  const auto good = [&](double x) { return x > scale.dark && x < scale.saturated; };
  for (Index i = 0; i < depth_mm.rows(); ++i) {
    for (Index j = 0; j < depth_mm.cols(); ++j) {
      const C l = in_scalar<C>(depth_mm(i, j));
      const C r = in_scalar<C>(red(i, j));
      const C b = in_scalar<C>(green(i, j));
      if (!(value(l) > 0 && value(l) <= value(fluid.max_depth_mm)) || !good(plain(red(i, j))) ||
          !good(plain(green(i, j)))) {
        continue;
      }
      const auto ray = ray_at_pixel(camera, C(static_cast<double>(i)), C(static_cast<double>(j)));
      const auto pencil = pencil_of<Heights>(camera, ray);
      const C membrane = b * exp(C(delta * pencil.path_factor * l));
      const C known = (fluid.kappa * r - membrane) / C(scale.units_per_level);
      visit(i, j, square(ray.plate_rho_mm), known, scattered_light(l, fluid.c_red_per_mm, pencil));
    }
  }
}

/// Least squares of known = g(rho) scattered over the powers of v. In double, the cubic that is
/// needed is far from losing digits. Refuses data that do not determine g.
template <scalar C, scalar S, int Degree, class Heights, class VisitAll>
void fit_scattering(const VisitAll& visit_all,
                    DepthReference<S, RadialScattering<S, Degree>, Heights>& reference) {
  using std::sqrt;
  constexpr auto n = static_cast<std::size_t>(Degree + 1);
  C rho_sq_max = C(0);
  visit_all([&](Index, Index, const C& rho_sq, const C&, const C&) {
    rho_sq_max = value(rho_sq_max) < value(rho_sq) ? rho_sq : rho_sq_max;
  });
  std::array<C, n> projected;
  projected.fill(C(0));
  SmallMatrix<C, n> normal;
  normal.fill(projected);
  C known_sq = C(0);
  visit_all([&](Index, Index, const C& rho_sq, const C& known, const C& scattered) {
    std::array<C, n> term;
    term[0] = scattered;
    for (std::size_t a = 1; a < n; ++a) {
      term[a] = term[a - 1] * rho_sq / rho_sq_max;
    }
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        normal[a][b] = normal[a][b] + term[a] * term[b];
      }
      projected[a] = projected[a] + term[a] * known;
    }
    known_sq = known_sq + square(known);
    ++reference.pixels_used;
  });
  const NormalEquations<C, n> equations(normal, static_cast<double>(1000 * epsilon<C>()));
  expects(reference.pixels_used > Degree && equations.good, "fit_reference",
          "pixels with a known depth", static_cast<long long>(reference.pixels_used),
          "enough, and far enough apart, to determine the scattering over the radius");
  const std::array<C, n> g = equations.solve(projected);
  C explained_sq = C(0);
  for (std::size_t a = 0; a < n; ++a) {
    explained_sq = explained_sq + projected[a] * g[a];
    reference.scattering.coefficient[a] = S(g[a]);
  }
  const C left_sq = known_sq - explained_sq;
  reference.scattering.rho_max_mm = S(C(sqrt(rho_sq_max)));
  const C count = C(static_cast<double>(reference.pixels_used));
  // The square root has no derivative at 0, and roundoff may lie below it.
  reference.residual_rms = value(left_sq) > 0 ? S(C(sqrt(C(left_sq / count)))) : S(0);
}

/// Shape of the free pad, to detect mistakes. `deepest_mm` is its deepest point within range,
/// `pixels` the number of its pixels, and `at_zero` how many of them lie at depth 0. `off_axis` is
/// the distance of their centroid from the optical axis, in radii of a disc of as many pixels.
/// `too_deep` is the share of the pixels in the middle that lie beyond max_depth_mm.
struct FreePadShape {
  double deepest_mm = 0;
  double pixels = 0;
  double at_zero = 0;
  double off_axis = 0;
  double too_deep = 0;
};

template <scalar C, class Depth>
FreePadShape shape_of_free_pad(const Camera<C>& camera,
                               double max_depth_mm,
                               const Depth& depth_mm) {
  FreePadShape shape;
  const double center_x_px = plain(camera.center_x_px);
  const double center_y_px = plain(camera.center_y_px);
  const auto each_pixel = [&](auto&& visit) {
    for (Index i = 0; i < depth_mm.rows(); ++i) {
      for (Index j = 0; j < depth_mm.cols(); ++j) {
        const double l = plain(depth_mm(i, j));
        if (is_finite(l) && l >= 0) {
          visit(i, j, l);
        }
      }
    }
  };
  double sum_x = 0;
  double sum_y = 0;
  bool reaches_border = false;
  each_pixel([&](Index i, Index j, double l) {
    shape.deepest_mm = l > max_depth_mm ? shape.deepest_mm : (std::max)(shape.deepest_mm, l);
    shape.pixels += 1;
    shape.at_zero += l == 0 ? 1 : 0;
    sum_x += static_cast<double>(j) - center_x_px;
    sum_y += static_cast<double>(i) - center_y_px;
    reaches_border =
        reaches_border || i == 0 || j == 0 || i + 1 == depth_mm.rows() || j + 1 == depth_mm.cols();
  });
  const double radius_sq = shape.pixels / 3.14159265358979;
  // else part of the pad is not seen and its center is unknown, or there is no pad at all
  if (!reaches_border && shape.pixels >= 100) {
    shape.off_axis =
        std::sqrt((square(sum_x) + square(sum_y)) / (radius_sq * square(shape.pixels)));
  }
  double middle = 0;
  double deep = 0;
  each_pixel([&](Index i, Index j, double l) {
    const double x = static_cast<double>(j) - sum_x / shape.pixels - center_x_px;
    const double y = static_cast<double>(i) - sum_y / shape.pixels - center_y_px;
    const bool in_middle = square(x) + square(y) <= radius_sq / 16;
    middle += in_middle ? 1 : 0;
    deep += in_middle && l > max_depth_mm ? 1 : 0;
  });
  shape.too_deep = middle > 0 ? deep / middle : 0;
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

/// Refuses a g that no fluid has. The pad holds one fluid, and a lens darkens toward the rim by
/// less than half, so g may vary by a factor of 2 at most. The limit of the residual, 5 grey
/// levels, is what a poor camera with a noise of three grey levels leaves.
template <scalar C, scalar S, int Degree, class Heights>
void expects_scattering(const Camera<C>& camera,
                        const DepthReference<S, RadialScattering<S, Degree>, Heights>& reference) {
  constexpr const char* owner = "fit_reference";
  const double residual = plain(reference.residual_rms);
  double least = (std::numeric_limits<double>::infinity)();
  double most = -least;
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      if (reference.in_pad(i, j)) {
        const auto ray = ray_at_pixel(camera, C(static_cast<double>(i)), C(static_cast<double>(j)));
        const double g = plain(reference.scattering.at(S(square(ray.plate_rho_mm))));
        least = (std::min)(least, g);
        most = (std::max)(most, g);
      }
    }
  }
  expects(least > 0, owner, "scattering of the fluid", least,
          "> 0: are red and green exchanged, is depth_mm the height of the free pad, and are the "
          "constants of absorption those of this fluid?");
  expects(
      least >= 0.5 * most, owner, "least scattering, as a share of the largest", least / most,
      ">= 0.5: is the frame one of the free pad, and depth_mm its height along each pixel's ray?");
  expects(residual <= 5, owner, "residual in grey levels", residual,
          "<= 5: do red, green and depth_mm show the same free pad?");
}

/// Depth up to which a pixel of the free pad counts as near the rim, where a press hardly moves it.
inline double rim_depth_mm(double deepest_mm) {
  return 0.2 * deepest_mm;
}

/// The reference without its scattering: the depth of the free pad and the light near its rim.
/// Refuses values out of range and shapes that no free pad has (parameter_error).
template <class Reference, scalar S, scalar C, class Red, class Green, class Depth>
Reference free_pad(const Camera<C>& camera,
                   const Absorption<C>& fluid,
                   const Red& red,
                   const Green& green,
                   const Depth& depth_mm,
                   const GreyScale& scale) {
  require(camera);
  expects_valid(fluid);
  expects_valid(scale);
  expects(same_size(red, green) && same_size(red, depth_mm), "fit_reference", "rows of depth_mm",
          static_cast<long long>(depth_mm.rows()), "of the same size as the red and green image");
  Reference reference;
  reference.rows = depth_mm.rows();
  reference.cols = depth_mm.cols();
  expects_grid_size("fit_reference", reference.rows, reference.cols);
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      const C l = in_scalar<C>(depth_mm(i, j));
      const bool inside = value(l) >= 0 && value(l) <= value(fluid.max_depth_mm);
      reference.depth_mm.push_back(inside ? S(l) : not_a_number<S>());
    }
  }
  const double max_depth_mm = plain(fluid.max_depth_mm);
  const FreePadShape shape = shape_of_free_pad(camera, max_depth_mm, depth_mm);
  expects_free_pad(shape, max_depth_mm);
  double light = 0;
  double count = 0;
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      const double l = plain(depth_mm(i, j));
      const double green_here = plain(green(i, j));
      if (l >= 0 && l <= rim_depth_mm(shape.deepest_mm) && green_here > scale.dark &&
          green_here < scale.saturated) {
        light += green_here / scale.units_per_level;
        count += 1;
      }
    }
  }
  reference.rim_green = S(count > 0 ? light / count : 0);
  return reference;
}

}  // namespace detail

/// Finds the reference from one frame of the free pad and its depth along each pixel's ray in mm,
/// NaN outside the pad. An average of many frames is better: store it as 16 bit or float. Refuses
/// grids of different sizes, data that do not determine g, and shapes that no free pad has, and
/// names the likely mistake (parameter_error). If camera and fluid consist of dual numbers and S is
/// that dual number, g carries the derivatives. O(rows cols); allocates.
template <class Heights = AstigmaticHeights,
          scalar S = float,
          scalar C,
          grid Red,
          grid Green,
          grid Depth>
DepthReference<S, RadialScattering<S>, Heights> fit_reference(
    const Camera<C>& camera,
    const Absorption<C>& fluid,
    const Red& red,
    const Green& green,
    const Depth& depth_mm,
    const GreyScale& scale = grey_scale_of<cell_t<Red>>()) {
  using Reference = DepthReference<S, RadialScattering<S>, Heights>;
  const auto depth = as_view(depth_mm);
  auto reference =
      detail::free_pad<Reference, S>(camera, fluid, as_view(red), as_view(green), depth, scale);
  const auto visit = [&](auto&& visitor) {
    detail::visit_reference<Heights>(camera, fluid, scale, as_view(red), as_view(green), depth,
                                     visitor);
  };
  detail::fit_scattering<C>(visit, reference);
  detail::expects_scattering(camera, reference);
  return reference;
}

}  // namespace v0
}  // namespace fingerpad
