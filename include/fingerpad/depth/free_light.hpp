// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How the light of a frame has changed since the reference: a lamp that ages or warms up, a white
// balance that drifts. Measured in frames in which nothing touches the pad, and held in between: a
// press turns the membrane near the rim outward, which looks like a change of colour, so that no
// light can be told from a frame with contact.
//
// Three numbers are fitted to means over blocks of the free pad: the gains of green and red, and
// how much higher the pad stands than in the reference. Two equations hold in each block: that of
// depth, and that the membrane is as bright as in the reference once the path through the fluid is
// taken off (docs/depth/depth.md). During a press the second one still tells that the light
// changes, though not how: from the measured depth follows how bright the membrane should be. A
// change of red moves the depth, and by it the brightness, by what the fluid absorbs in that
// length.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// The light of a frame of the free pad.
struct FreeLightResult {
  LightGains gains;
  double height = 1;                    ///< of the pad, over that of the reference
  double green_sd = 0, balance_sd = 0;  ///< of green, and of red over green, as shares
  /// Error of depth, in mm, that an error of one in both gains would make, and one in red over
  /// green; means over the pad.
  double mm_per_green = 0, mm_per_balance = 0;
};

/// How much brighter the membrane is than in the reference, at the depths that were measured.
struct Brightness {
  double share = 0;         ///< 0: as bright; NaN if fewer than 50 blocks carry information
  double mm_per_share = 0;  ///< depth per share if red has changed; another lamp moves it by less
};

/// Finds the gains of frames of the free pad. Constant after its construction: share it. A call
/// allocates nothing, throws nothing, and takes O(rows cols).
template <scalar S = float>
class FreeLight {
 public:
  /// Of the pixels or samples of `reference`; refuses bad parameters (parameter_error).
  FreeLight(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S>& reference)
      : rows_(reference.rows), cols_(reference.cols) {
    require(camera);
    require(fluid);
    const double pixels = static_cast<double>(rows_ * cols_);
    width_ = (std::max)(Index(2), static_cast<Index>(std::lround(std::sqrt(pixels) / 45)));
    for (Index i = 0; i + width_ <= rows_ && !reference.green.empty(); i += width_) {
      for (Index j = 0; j + width_ <= cols_; j += width_) {
        add_block(camera, fluid, reference, i, j);
      }
    }
  }

  /// Empty if the frame has another size, if fewer than 50 blocks carry information, or if the
  /// light has changed by more than a half.
  template <grid Red, grid Green>
  std::optional<FreeLightResult> operator()(const Red& red, const Green& green) const {
    if (fingerpad::rows(red) != rows_ || fingerpad::cols(red) != cols_ ||
        fingerpad::rows(green) != rows_ || fingerpad::cols(green) != cols_) {
      return std::nullopt;
    }
    return fitted(as_view(red), as_view(green));
  }

  /// Of a frame in the light `gains`, free or pressed, with the depth that was measured in it, both
  /// of the reference's size. Pixels beyond 20 % of what is expected are dots, and left out.
  /// What grows with the difference from the free depth is no light: the fluid's constants may be
  /// off by a few per cent.
  template <grid Green, grid Depth>
  Brightness brightness(const Green& green, const Depth& depth_mm, const LightGains& gains) const {
    constexpr GreyScale scale = grey_scale_of<cell_t<Green>>();
    std::array<std::array<double, 2>, 2> a{};
    std::array<double, 2> b{};
    double fades = 0;
    for (const Block& block : blocks_) {
      const double higher =
          static_cast<double>(depth_mm(block.row + width_ / 2, block.col + width_ / 2)) -
          block.middle_mm;
      const double fade = block.darkens / block.depth_mm;
      const double expected =
          block.bright * gains.green * scale.units_per_level * std::exp(-fade * higher);
      double sum = 0, count = 0;
      for (Index k = 0; k < width_ * width_; ++k) {
        const auto g = static_cast<double>(green(block.row + k / width_, block.col + k % width_));
        const bool is_lit = std::abs(g - expected) < 0.2 * expected && scale.counts(g);
        sum += is_lit ? g : 0;
        count += is_lit ? 1 : 0;
      }
      const double share = std::log(sum / count / expected);
      if (3 * count > static_cast<double>(width_ * width_) && std::abs(share) < 0.1) {
        a[0][0] += 1;
        a[0][1] += higher;
        a[1][1] += square(higher);
        b[0] += share;
        b[1] += share * higher;
        fades += fade;
      }
    }
    a[1][0] = a[0][1];
    a[1][1] += a[0][0] / 100;  // of a free pad there is nothing to tell
    const detail::NormalEquations<double, 2> equations(a);
    const bool is_told = a[0][0] >= 50 && equations.good;
    return {is_told ? equations.solve(b)[0] : not_a_number<double>(), a[0][0] / fades};
  }

 private:
  struct Block {
    Index row, col;
    // means over the block, of the free pad
    double rise, kappa;  ///< factors of green and red in the depth equation
    double scattered;    ///< its last term
    double green;        ///< of the reference
    double bright;       ///< of its pixels beside the dots
    double middle_mm;    ///< depth of the free pad in the middle of the block
    double depth_mm;     ///< of the free pad
    double slope;        ///< of the equation, for a pad as high again
    double darkens;      ///< ln of green, for the same
  };
  /// Means of a block in a frame, grey levels; green 0: no information.
  struct Seen {
    double red = 0, green = 0;
  };

  void add_block(const Camera<double>& camera,
                 const Absorption<double>& fluid,
                 const DepthReference<S>& reference,
                 Index row,
                 Index col) {
    Block sum{row, col, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
    const double n = static_cast<double>(width_ * width_);
    double brightest = 0;
    for (Index k = 0; k < width_ * width_; ++k) {
      const Index i = row + k / width_, j = col + k % width_;
      const auto l = static_cast<double>(reference.depth(i, j));
      const auto g = static_cast<double>(reference.g(i, j));
      const auto b = static_cast<double>(reference.green[static_cast<std::size_t>(i * cols_ + j)]);
      if (!(l > 0) || !(g > 0) || !(b > 0)) {
        return;  // a block lies in the pad as a whole
      }
      const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
      const double rise = std::exp(delta * ray.path_factor * l);
      const double w_slope = scattered_light_slope(l, fluid.c_red_per_mm, ray);
      sum.rise += rise / n;
      sum.kappa += fluid.kappa * static_cast<double>(reference.gain(i, j)) / n;
      sum.scattered += g * scattered_light(l, fluid.c_red_per_mm, ray) / n;
      sum.green += b / n;
      brightest = (std::max)(brightest, b);
      sum.depth_mm += l / n;
      sum.slope += (delta * ray.path_factor * rise * b + g * w_slope) * l / n;
      sum.darkens += fluid.c_green_per_mm * ray.path_factor * l / n;
    }
    double count = 0;
    for (Index k = 0; k < width_ * width_; ++k) {
      const std::size_t at =
          static_cast<std::size_t>((row + k / width_) * cols_ + col + k % width_);
      const auto b = static_cast<double>(reference.green[at]);
      sum.bright += b > 0.8 * brightest ? b : 0;
      count += b > 0.8 * brightest ? 1 : 0;
    }
    sum.bright /= count;
    sum.middle_mm = static_cast<double>(reference.depth(row + width_ / 2, col + width_ / 2));
    blocks_.push_back(sum);
  }

  template <class View>
  Seen seen(const Block& b, const View& red, const View& green) const {
    constexpr GreyScale scale = grey_scale_of<cell_t<View>>();
    double reds = 0, greens = 0, count = 0;
    for (Index i = b.row; i < b.row + width_; ++i) {
      for (Index j = b.col; j < b.col + width_; ++j) {
        const auto r = static_cast<double>(red(i, j)), g = static_cast<double>(green(i, j));
        if (scale.counts(r) && scale.counts(g)) {
          reds += r;
          greens += g;
          count += 1;
        }
      }
    }
    const double all = count * scale.units_per_level;
    return 2 * count > static_cast<double>(width_ * width_) ? Seen{reds / all, greens / all}
                                                            : Seen{};
  }

  /// Gauss-Newton in the logarithms of the gains and the height, with weights that fall with the
  /// residual, so that a spot of dirt or a print that has moved does not count.
  template <class View>
  std::optional<FreeLightResult> fitted(const View& reds, const View& greens) const {
    double green = 0, red = 0, height = 0;  // what takes the change off, as logarithms
    double scale = 0.05;                    // of the residuals, mm and shares alike
    FreeLightResult result;
    for (int round = 0; round < 5; ++round) {
      std::array<std::array<double, 3>, 3> a{};
      std::array<double, 3> b{};
      double squares = 0, weights = 0, count = 0;
      double by_green = 0, by_balance = 0;
      const auto add = [&](const std::array<double, 3>& by, double residual) {
        const double w = 1 / (1 + square(residual / (2 * scale)));
        for (std::size_t k = 0; k < 3; ++k) {
          for (std::size_t m = 0; m < 3; ++m) {
            a[k][m] += w * by[k] * by[m];
          }
          b[k] -= w * by[k] * residual;
        }
        squares += w * residual * residual;
        weights += w;
      };
      for (const Block& block : blocks_) {
        const Seen now = seen(block, reds, greens);
        if (!(now.green > 0)) {
          continue;
        }
        const double g = std::exp(green) * block.rise * now.green;
        const double r = std::exp(red) * block.kappa * now.red;
        // in shares of the light, so that both equations have the noise of a colour
        const double per = 1 / block.green;
        add({g * per, -r * per, block.slope * per},
            (g - r + block.scattered + height * block.slope) * per);
        add({1, 0, block.darkens},
            green + std::log(now.green / block.green) + height * block.darkens);
        count += 1;
        by_green += block.scattered * block.depth_mm / block.slope;
        by_balance += r * block.depth_mm / block.slope;
      }
      const detail::NormalEquations<double, 3> equations(a);
      if (count < 50 || !equations.good) {
        return std::nullopt;
      }
      const auto step = equations.solve(b);
      green += step[0];
      red += step[1];
      height += step[2];
      scale = std::sqrt(squares / weights);
      if (!(std::abs(green) < 0.5) || !(std::abs(red) < 0.5)) {
        return std::nullopt;
      }
      result = {{std::exp(-green), std::exp(-red)},
                1 + height,
                scale * std::sqrt(equations.variance({1, 0, 0})),
                scale * std::sqrt(equations.variance({1, -1, 0})),
                by_green / count,
                by_balance / count};
    }
    return result;
  }

  Index rows_, cols_, width_ = 2;
  std::vector<Block> blocks_;
};

}  // namespace v1
}  // namespace fingerpad
