// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The light over a pad, g(x, y) and kappa(x, y): polynomials of the place on the plate, because a
// lamp lights no pad evenly. The depth equation
//   green exp(delta k l) - kappa(x, y) red + g(x, y) W(l) = 0
// is linear in all their coefficients. Means over blocks of pixels are fitted, printed dots
// included: the equation does not contain the brightness.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
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

/// A polynomial of the place on the plate, with x and y in units of scale_mm.
template <scalar S, int Degree>
struct PlanePolynomial {
  static constexpr std::size_t terms = static_cast<std::size_t>((Degree + 1) * (Degree + 2) / 2);

  std::array<S, terms> coefficient = detail::zeros<S, terms>();  ///< of 1; x, y; x^2, x y, y^2; ...
  S scale_mm = S(1);                                             ///< > 0

  static std::array<S, terms> monomials(const S& x, const S& y) {
    std::array<S, terms> m = detail::zeros<S, terms>();
    m[0] = S(1);
    std::size_t at = 1;
    for (std::size_t n = 1; n <= static_cast<std::size_t>(Degree); ++n, at += n) {
      for (std::size_t j = 0; j < n; ++j) {
        m[at + j] = m[at + j - n] * x;
      }
      m[at + n] = m[at - 1] * y;
    }
    return m;
  }
  S at(const Point2<S>& plate_mm) const {
    const auto m = monomials(plate_mm.x / scale_mm, plate_mm.y / scale_mm);
    S sum = S(0);
    for (std::size_t k = 0; k < terms; ++k) {
      sum = sum + coefficient[k] * m[k];
    }
    return sum;
  }
};

/// The light over a pad. A lamp's colours vary less than its brightness.
template <scalar S = double, int Degree = 6>
struct PadLight {
  PlanePolynomial<S, Degree> scattering;           ///< g, grey levels per mm^2
  PlanePolynomial<S, (Degree > 0 ? 1 : 0)> kappa;  ///< alpha_G beta_G / (alpha_R beta_R)
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
                                      const GreyScale& scale,
                                      Index width,
                                      const C& scale_mm) {
  using std::exp;
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
        const Pencil<C> pencil = pencil_of(camera, ray_of(camera, row + i, col + j));
        const C along = delta * pencil.path_factor;
        const C membrane = b * exp(along * l) / C(scale.units_per_level);
        const C w = scattered_light(l, fluid.c_red_per_mm, pencil);
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
        sum.w_slope = sum.w_slope + scattered_light_slope(l, fluid.c_red_per_mm, pencil);
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
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double limit = (std::max)(0.05, 6 * 1.4826 * *middle);
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

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
