// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The RGB depth model as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile information by
// vision-based tactile sensor for dexterous handling of robot hands", III.A. It uses a scattering
// quotient for each pixel, the mean over 29 x 29 px, one height in both directions of a pencil, and
// bisection. docs/errata.md and docs/depth/depth.md list its errors and what the default does
// instead.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/published/absorption.hpp"
#include "fingerpad/published/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The mean of the colours over a square window.
struct BoxMean {
  static constexpr bool anchored = false;
  int window_px = 29;  ///< odd, 3..255

  std::array<int, 1> windows_px() const { return {window_px}; }
};

/// The published bisection with `halvings` halvings. The final half-width is
/// max_depth / 2^(halvings - 1): 0.43 um for 16 halvings and 14 mm. As printed it starts at l = 0,
/// where f is 0/0, and every pixel ends at the wrong end of the range (E006). Here the first step
/// always goes to the middle.
template <scalar S>
DepthRoot<S> bisect_depth(const Absorption<S>& fluid,
                          const Pencil<S>& pencil,
                          const S& scattering,
                          const Colour<S>& colour,
                          int halvings = 16) {
  const PixelStatus range = detail::range_of_root(fluid, pencil, scattering, colour);
  if (range != PixelStatus::ok) {
    return {not_a_number<S>(), range};
  }
  S depth = fluid.max_depth_mm / S(2);
  S step = depth / S(2);
  for (int i = 2; i < halvings; ++i) {
    const bool root_is_deeper = !(quotient(fluid, pencil, colour, depth) < scattering);
    depth = root_is_deeper ? S(depth + step) : S(depth - step);
    step = step / S(2);
  }
  return {depth, PixelStatus::ok};
}

/// The published bisection, in any scalar.
struct Bisection {
  int halvings = 16;  ///< in 2..100

  template <scalar S>
  DepthRoot<S> operator()(const Absorption<S>& fluid,
                          const Pencil<S>& pencil,
                          const S& scattering,
                          const Colour<S>& colour) const {
    return bisect_depth(fluid, pencil, scattering, colour, halvings);
  }
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const Bisection& inverse) {
  expects(inverse.halvings >= 2 && inverse.halvings <= 100, "Bisection", "halvings",
          static_cast<long long>(inverse.halvings), "in 2..100");
}

/// g per pixel, the published quotient; NaN where the reference has no usable depth.
template <scalar S>
struct PixelScattering {
  static constexpr bool is_radial = false;
  Index cols = 0;
  std::vector<S> plane;  ///< rows x cols

  const S* row(Index i) const { return plane.data() + i * cols; }
  S operator()(Index i, Index j, const S& /*rho_sq_mm2*/) const { return row(i)[j]; }

  PixelScattering cropped(Index first_row, Index first_col, Index rows, Index cropped_cols) const {
    PixelScattering out{cropped_cols, {}};
    for (Index i = 0; i < rows; ++i) {
      const S* from = row(first_row + i) + first_col;
      out.plane.insert(out.plane.end(), from, from + cropped_cols);
    }
    return out;
  }
  /// Means over blocks of step x step pixels.
  PixelScattering sampled(Index rows, Index sampled_cols, int step) const {
    PixelScattering out{sampled_cols, {}};
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < sampled_cols; ++j) {
        S sum = S(0);
        for (Index k = 0; k < step * step; ++k) {
          sum = sum + row(i * step + k / step)[j * step + k % step];
        }
        out.plane.push_back(S(sum / S(step * step)));
      }
    }
    return out;
  }
  S largest() const {
    S found = S(0);
    for (const S& g : plane) {
      found = is_finite(g) ? (std::max)(found, g) : found;
    }
    return found;
  }
};

/// Reference of the free pad as printed. Its colours b(t0) are averaged as those of every frame,
/// and g is a quotient for each pixel, which grows without bound toward the rim. NoSmoothing{} uses
/// the colours without averaging; their noise then enters every later depth. Refuses what
/// fit_reference refuses (parameter_error).
template <scalar S = float,
          class Heights = SingleHeight,
          class Smoothing = BoxMean,
          grid Red,
          grid Green,
          grid Depth>
DepthReference<S, PixelScattering<S>, Heights> depth_reference(
    const Camera<double>& camera,
    const Absorption<double>& fluid,
    const Red& red,
    const Green& green,
    const Depth& depth_mm,
    const Smoothing& smoothing = {},
    const GreyScale& scale = grey_scale_of<cell_t<Red>>()) {
  using Reference = DepthReference<S, PixelScattering<S>, Heights>;
  const auto from_red = as_view(red);
  const auto from_green = as_view(green);
  const auto depth = as_view(depth_mm);
  auto reference =
      detail::free_pad<Reference, S>(camera, fluid, from_red, from_green, depth, scale);
  detail::ColourSetup<double> setup{reference.rows, reference.cols, {}, {}};
  for (const S& l : reference.depth_mm) {
    setup.in_pad.push_back(is_finite(l) ? 1 : 0);
  }
  const auto size = static_cast<std::size_t>(setup.rows * setup.cols);
  std::vector<double> red_levels(size);
  std::vector<double> green_levels(size);
  detail::ColourRows<cell_t<Red>, double, Smoothing> colours(setup, smoothing, scale);
  colours.start(setup, from_red, from_green, 0);
  for (Index i = 0; i < setup.rows; ++i) {
    const Index first = i * setup.cols;
    colours.next(setup, from_red, from_green, red_levels.data() + first,
                 green_levels.data() + first);
  }
  PixelScattering<S>& g = reference.scattering;
  g.cols = reference.cols;
  g.plane.assign(size, not_a_number<S>());
  const auto levels_of = [&](const std::vector<double>& plane) {
    return StridedView<const double>(plane.data(), setup.rows, setup.cols, setup.cols);
  };
  detail::visit_reference<Heights>(
      camera, fluid, GreyScale{}, levels_of(red_levels), levels_of(green_levels), depth,
      [&](Index row, Index col, double, double known, double scattered) {
        g.plane[static_cast<std::size_t>(row * g.cols + col)] = S(known / scattered);
        ++reference.pixels_used;
      });
  expects(reference.pixels_used > 0, "depth_reference", "pixels with a known depth",
          static_cast<long long>(reference.pixels_used), "at least 1");
  const auto good = std::count_if(g.plane.begin(), g.plane.end(),
                                  [](const S& x) { return is_finite(x) && value(x) > 0; });
  expects(2 * good > reference.pixels_used, "depth_reference", "pixels with g > 0",
          static_cast<long long>(good),
          "more than half: are red and green exchanged, is depth_mm the height of the free pad?");
  return reference;
}

/// Depth as printed, in the scalar S.
template <scalar S = float>
using DepthEstimator =
    fingerpad::DepthEstimator<BoxMean, Bisection, SingleHeight, S, PixelScattering<S>>;

/// `reference` from depth_reference(). Refuses bad parameters (parameter_error).
template <scalar S>
DepthEstimator<S> depth_estimator(
    const Camera<double>& camera,
    const Absorption<double>& fluid,
    const DepthReference<S, PixelScattering<S>, SingleHeight>& reference,
    int window_px = 29) {
  return DepthEstimator<S>(camera, fluid, reference, BoxMean{window_px});
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
