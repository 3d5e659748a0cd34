// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The reference of the depth model from one frame of the free pad, whose shape is known. Means over
// blocks of pixels are fitted, printed dots included: the depth equation does not contain the
// brightness. calibrate/depth.hpp finds the light from presses, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail {

template <scalar C>
Ray<C> ray_of(const Camera<C>& camera, Index row, Index col) {
  return ray_at_pixel(camera, C(static_cast<double>(row)), C(static_cast<double>(col)));
}

template <scalar C>
Point2<C> on_plate(const Camera<C>& camera, Index row, Index col) {
  const auto p = point_at(camera, C(static_cast<double>(row)), C(static_cast<double>(col)), C(0));
  return {p.x, p.y};
}

/// The depth equation, averaged over a square of pixels of the free pad. It is linear in the
/// coefficients of kappa and g.
template <scalar C>
struct FreeBlock {
  using Light = PadLight<C>;
  static constexpr std::size_t kappa_terms = decltype(Light::kappa)::terms;
  static constexpr std::size_t terms = kappa_terms + decltype(Light::scattering)::terms;

  Index row, col;             ///< of its first pixel
  std::array<C, terms> by;    ///< of each coefficient: red and -W times monomials
  C membrane;                 ///< green exp(delta k l)
  C membrane_slope, w_slope;  ///< the derivatives of membrane and W by depth
  bool fits = true;

  /// What this light leaves of the equation, grey levels.
  C residual(const Light& light) const { return membrane - sum(light.kappa, 0) + g_w(light); }
  /// The error of the depth that follows, mm.
  C error_mm(const Light& light) const {
    return residual(light) / (membrane_slope - g_w(light) / by[kappa_terms] * w_slope);
  }

 private:
  template <class Polynomial>
  C sum(const Polynomial& p, std::size_t first) const {
    C total = C(0);
    for (std::size_t k = 0; k < Polynomial::terms; ++k) {
      total = total + p.coefficient[k] * by[first + k];
    }
    return total;
  }
  C g_w(const Light& light) const { return -sum(light.scattering, kappa_terms); }
};

/// Width of the blocks: some 40 over the pad.
inline Index block_width(double pad_pixels) {
  return (std::max)(Index(1), static_cast<Index>(std::lround(std::sqrt(pad_pixels) / 35)));
}

/// The blocks of the free pad that lie half a block inside of its rim or more, where light from
/// beside it does not reach. Means are those of the pixels that count, at least half of a block.
/// Places are in units of scale_mm.
template <scalar C, class Red, class Green, class Depth>
std::vector<FreeBlock<C>> free_blocks(const Camera<C>& camera,
                                      const Absorption<C>& fluid,
                                      const Red& red,
                                      const Green& green,
                                      const Depth& depth_mm,
                                      Index width,
                                      const C& scale_mm) {
  using std::exp;
  constexpr GreyScale scale = grey_scale_of<cell_t<Red>>();
  std::vector<FreeBlock<C>> blocks;
  const C delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
  const auto in_pad = [&](Index i, Index j) {
    return i >= 0 && j >= 0 && i < depth_mm.rows() && j < depth_mm.cols() &&
           value(static_cast<C>(depth_mm(i, j))) > 0 &&
           value(static_cast<C>(depth_mm(i, j))) <= value(fluid.max_depth_mm);
  };
  for (Index row = 0; row + width <= depth_mm.rows(); row += width) {
    for (Index col = 0; col + width <= depth_mm.cols(); col += width) {
      const Index half = width / 2, low = row + width - 1 + half, right = col + width - 1 + half;
      if (half > 0 && !(in_pad(row - half, col - half) && in_pad(row - half, right) &&
                        in_pad(low, col - half) && in_pad(low, right))) {
        continue;
      }
      FreeBlock<C> sum{row, col, zeros<C, FreeBlock<C>::terms>(), C(0), C(0), C(0)};
      double count = 0;
      each_pixel(width, width, [&](Index i, Index j) {
        const C r = static_cast<C>(red(row + i, col + j));
        const C b = static_cast<C>(green(row + i, col + j));
        if (!in_pad(row + i, col + j) || !scale.counts(r) || !scale.counts(b)) {
          return;
        }
        const C l = static_cast<C>(depth_mm(row + i, col + j));
        const Ray<C> ray = ray_of(camera, row + i, col + j);
        const C along = delta * ray.path_factor;
        const C membrane = b * exp(along * l) / C(scale.units_per_level);
        const C w = scattered_light(l, fluid.c_red_per_mm, ray);
        const Point2<C> place = on_plate(camera, row + i, col + j);
        const C x = place.x / scale_mm, y = place.y / scale_mm;
        std::size_t k = 0;
        for (const C& m : decltype(PadLight<C>::kappa)::monomials(x, y)) {
          sum.by[k] = sum.by[k] + r / C(scale.units_per_level) * m;
          ++k;
        }
        for (const C& m : decltype(PadLight<C>::scattering)::monomials(x, y)) {
          sum.by[k] = sum.by[k] - w * m;
          ++k;
        }
        sum.membrane = sum.membrane + membrane;
        sum.membrane_slope = sum.membrane_slope + along * membrane;
        sum.w_slope = sum.w_slope + scattered_light_slope(l, fluid.c_red_per_mm, ray);
        count += 1;
      });
      if (2 * count >= static_cast<double>(width * width)) {
        const C n = C(count);
        for (C& x : sum.by) {
          x = x / n;
        }
        sum.membrane = sum.membrane / n;
        sum.membrane_slope = sum.membrane_slope / n;
        sum.w_slope = sum.w_slope / n;
        blocks.push_back(sum);
      }
    }
  }
  return blocks;
}

/// Marks the blocks that the light does not explain: glare, dirt, a scratch. They would err by more
/// than 0.05 mm and lie beyond six sd of the others.
template <scalar C>
void mark_unexplained(const PadLight<C>& light, std::vector<FreeBlock<C>>& blocks) {
  std::vector<double> error;
  for (const FreeBlock<C>& b : blocks) {
    error.push_back(std::abs(static_cast<double>(value(b.error_mm(light)))));
  }
  std::vector<double> sorted = error;
  const double limit = (std::max)(0.05, 6 * 1.4826 * detail::median(sorted));
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    blocks[k].fits = error[k] <= limit;
  }
}

/// The light by least squares over the blocks, each over the slope of W, so that a grey level
/// counts as the depth that it moves. Refuses data that do not determine it.
template <scalar C>
PadLight<C> fit_light(std::vector<FreeBlock<C>>& blocks, const C& scale_mm) {
  constexpr std::size_t all = FreeBlock<C>::terms, kappa_terms = FreeBlock<C>::kappa_terms;
  PadLight<C> light;
  light.scattering.scale_mm = light.kappa.scale_mm = scale_mm;
  for (int round = 0; round < 3; ++round) {
    std::vector<C> rows;
    for (const FreeBlock<C>& b : blocks) {
      for (std::size_t k = 0; k < all && b.fits; ++k) {
        rows.push_back(b.by[k] / b.w_slope);
      }
      if (b.fits) {
        rows.push_back(b.membrane / b.w_slope);
      }
    }
    const std::size_t count = rows.size() / (all + 1);
    const Triangle<C> triangle(std::move(rows), all + 1);
    bool determined = count >= all;
    for (std::size_t k = 0; k < all; ++k) {
      determined = determined && value(triangle.independent_share(k)) > 1e-7;
    }
    expects(determined, "fit_reference", "blocks of pixels with a known depth", count,
            "enough, and far enough apart, to determine the light over the pad");
    const std::vector<C> x = triangle.solve(all, all);
    std::copy_n(x.begin(), kappa_terms, light.kappa.coefficient.begin());
    std::copy(x.begin() + kappa_terms, x.end(), light.scattering.coefficient.begin());
    mark_unexplained(light, blocks);
  }
  return light;
}

/// Refuses depths that no free pad has, and names the likely mistake. Returns the number of pixels
/// of the pad; of none the fit tells. `depth_mm` holds doubles.
template <scalar C, class Depth>
double expects_free_pad(const Camera<C>& camera, double max_depth_mm, const Depth& depth_mm) {
  constexpr const char* owner = "fit_reference";
  const auto center_x_px = static_cast<double>(value(camera.center_x_px));
  const auto center_y_px = static_cast<double>(value(camera.center_y_px));
  const auto aspect = static_cast<double>(value(camera.pixel_aspect));
  const Index rows = depth_mm.rows(), cols = depth_mm.cols();
  double pixels = 0, deepest_mm = 0, at_zero = 0, sum_x = 0, sum_y = 0;
  bool reaches_border = false;
  each_pixel(rows, cols, [&](Index i, Index j) {
    const double l = depth_mm(i, j);
    if (is_finite(l) && l >= 0) {
      pixels += 1;
      at_zero += l == 0 ? 1 : 0;
      deepest_mm = l > max_depth_mm ? deepest_mm : (std::max)(deepest_mm, l);
      sum_x += static_cast<double>(j) - center_x_px;
      sum_y += (static_cast<double>(i) - center_y_px) * aspect;
      reaches_border = reaches_border || i == 0 || j == 0 || i + 1 == rows || j + 1 == cols;
    }
  });
  if (pixels == 0) {
    return 0;
  }
  const double radius_sq = pixels * aspect / std::numbers::pi;  // of a disc of as many pixels
  double middle = 0, too_deep = 0;
  each_pixel(rows, cols, [&](Index i, Index j) {
    const double x = static_cast<double>(j) - center_x_px - sum_x / pixels;
    const double y = (static_cast<double>(i) - center_y_px) * aspect - sum_y / pixels;
    if (depth_mm(i, j) >= 0 && x * x + y * y <= radius_sq / 16) {
      middle += 1;
      too_deep += depth_mm(i, j) > max_depth_mm ? 1 : 0;
    }
  });
  expects(2 * too_deep <= middle, owner, "share of the pad's middle beyond max_depth_mm",
          too_deep / middle, "<= 0.5: raise max_depth_mm, or give mm");
  expects(deepest_mm >= 0.1 * max_depth_mm, owner, "deepest point of depth_mm", deepest_mm,
          ">= a tenth of max_depth_mm: give mm, not m");
  expects(at_zero <= 0.1 * pixels, owner, "share of pixels at depth 0", at_zero / pixels,
          "<= 0.1: depth_mm must be NaN outside of the pad");
  // the center of a pad that is not seen as a whole is not known
  const double off_axis = std::hypot(sum_x, sum_y) / (pixels * std::sqrt(radius_sq));
  expects(off_axis <= 0.25 || reaches_border || pixels < 100, owner,
          "distance of the pad's center from the axis, in radii", off_axis,
          "<= 0.25: camera.center_x_px, center_y_px are not those of this image");
  return pixels;
}

/// Refuses a light that no pad has. It holds one fluid; lamp and lens may fall to a third toward
/// the rim, but are hardly darker on the axis than elsewhere, except where the membrane is pressed
/// there. The limit of the residual, 5 grey levels, is what a poor camera leaves.
template <scalar S>
void expects_light(const DepthReference<S>& reference, const S& on_axis) {
  constexpr const char* owner = "fit_reference";
  constexpr double infinite = (std::numeric_limits<double>::infinity)();
  double min_g = infinite, max_g = -infinite, min_gain = infinite;
  for (std::size_t k = 0; k < reference.scattering.size(); ++k) {
    const auto g = static_cast<double>(value(reference.scattering[k]));
    const auto gain = static_cast<double>(value(reference.red_gain[k]));
    min_g = g < min_g ? g : min_g;  // not for NaN
    max_g = g > max_g ? g : max_g;
    min_gain = g == g && gain < min_gain ? gain : min_gain;
  }
  const double axis_share = static_cast<double>(value(on_axis)) / max_g;
  const auto residual = static_cast<double>(value(reference.residual_rms));
  expects(min_g > 0 && min_gain > 0, owner, "scattering of the fluid", min_g,
          "> 0: are red and green exchanged, is depth_mm the height of the free pad, and are the "
          "constants of absorption those of this fluid?");
  expects(
      min_g >= 0.3 * max_g, owner, "least scattering, as a share of the largest", min_g / max_g,
      ">= 0.3: is the frame one of the free pad, and depth_mm its height along each pixel's ray?");
  expects(axis_share >= 0.75, owner, "scattering on the axis, as a share of the largest",
          axis_share, ">= 0.75: is the reference of the free pad?");
  expects(residual <= 5, owner, "residual in grey levels", residual,
          "<= 5: do red, green and depth_mm show the same free pad?");
}

}  // namespace detail

/// The reference for a light that is known, from one frame of the free pad and its depth along each
/// pixel's ray in mm, NaN outside the pad. Where the light does not explain the frame (glare, dirt,
/// a scratch), g is NaN and no depth is measured. Without `known` the light is fitted to the frame.
/// O(rows cols); allocates.
template <scalar S = float, scalar C, grid Red, grid Green, grid Depth>
DepthReference<S> fit_reference(const Camera<C>& camera,
                                const Absorption<C>& fluid,
                                const Red& red,
                                const Green& green,
                                const Depth& depth_mm,
                                const PadLight<C>* known = nullptr) {
  using std::sqrt;
  constexpr GreyScale scale = grey_scale_of<cell_t<Red>>();
  const auto reds = as_view(red);
  const auto greens = as_view(green);
  const auto depths = as_view(depth_mm);
  require(camera);
  require(fluid);
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
  const double pad_pixels = detail::expects_free_pad(camera, max_depth_mm, plain_depth);

  C scale_mm = known != nullptr ? known->kappa.scale_mm : C(1);
  detail::each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
    if (known == nullptr && plain_depth(i, j) > 0) {
      const C rho_sq = squared_norm(detail::on_plate(camera, i, j));
      scale_mm = value(scale_mm * scale_mm) < value(rho_sq) ? C(sqrt(rho_sq)) : scale_mm;
    }
  });
  const Index width = detail::block_width(pad_pixels);
  auto blocks = detail::free_blocks(camera, fluid, reds, greens, depths, width, scale_mm);
  const PadLight<C> light = known != nullptr ? *known : detail::fit_light(blocks, scale_mm);
  if (known != nullptr) {
    expects(!blocks.empty(), "fit_reference", "blocks of pixels with a known depth", 0, ">= 1");
    detail::mark_unexplained(light, blocks);
  }

  reference.depth_mm.assign(static_cast<std::size_t>(reference.rows * reference.cols),
                            not_a_number<S>());
  reference.scattering = reference.red_gain = reference.green = reference.depth_mm;
  detail::each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
    const double l = plain_depth(i, j);
    if (l >= 0 && l <= max_depth_mm) {
      const auto k = static_cast<std::size_t>(i * reference.cols + j);
      const Point2<C> place = detail::on_plate(camera, i, j);
      const C b = static_cast<C>(greens(i, j));
      reference.depth_mm[k] = S(static_cast<C>(depths(i, j)));
      reference.scattering[k] = S(light.scattering.at(place));
      reference.red_gain[k] = S(light.kappa.at(place) / fluid.kappa);
      reference.green[k] = scale.counts(b) ? S(b / C(scale.units_per_level)) : not_a_number<S>();
    }
  });

  C left_sq = C(0);
  for (const detail::FreeBlock<C>& b : blocks) {
    if (b.fits) {
      left_sq = left_sq + square(b.residual(light));
      reference.pixels_used += width * width;
    }
  }
  // The square root has no derivative at 0.
  const C mean_sq = left_sq * C(static_cast<double>(width * width)) /
                    C(static_cast<double>((std::max)(reference.pixels_used, Index(1))));
  reference.residual_rms = S(value(mean_sq) > 0 ? sqrt(mean_sq) : C(0));
  detail::expects_light(reference, S(light.scattering.at({C(0), C(0)})));
  for (const detail::FreeBlock<C>& b : blocks) {
    detail::each_pixel(b.fits ? 0 : width, width, [&](Index i, Index j) {
      reference.scattering[static_cast<std::size_t>((b.row + i) * reference.cols + b.col + j)] =
          not_a_number<S>();
    });
  }
  return reference;
}

}  // namespace v1
}  // namespace fingerpad
