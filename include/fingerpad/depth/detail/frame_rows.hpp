// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Copies rows of a frame, of any kind of grid, to plain memory and back, and tells what is wrong
// with a pixel.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/smoothing.hpp"
#include "fingerpad/image/detail/interleaved.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_means.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// The anchor of an anchored mean: the colours that the free pad's known shape predicts.

/// The terms of the free pad's depth l0 that an anchored mean needs, per pixel. The residual r =
/// rise green - kappa red + scattered is F(l0), which is 0 where the membrane has not moved.
template <class S>
struct Anchor {
  std::vector<S> rise;       ///< exp(delta k l0)
  std::vector<S> scattered;  ///< g W(l0), grey levels
  S kappa = S(1);
};

/// The anchor at the free pad of `reference`. Outside the pad, where nothing is averaged, `rise` is
/// 1 and `scattered` 0.
template <class S, class Scattering, class Heights>
Anchor<S> anchor_of(const Camera<double>& camera,
                    const Absorption<double>& fluid,
                    const DepthReference<S, Scattering, Heights>& reference) {
  const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
  Anchor<S> anchor;
  anchor.kappa = S(fluid.kappa);
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      S rise = S(1);
      S scattered = S(0);
      if (reference.in_pad(i, j)) {
        const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
        const auto pencil = pencil_of<Heights>(camera, ray);
        const auto l = static_cast<double>(value(reference.depth(i, j)));
        const S g = reference.scattering(i, j, S(square(ray.plate_rho_mm)));
        if (is_finite(g)) {
          rise = S(std::exp(delta * pencil.path_factor * l));
          scattered = g * S(scattered_light(l, fluid.c_red_per_mm, pencil));
        }
      }
      anchor.rise.push_back(rise);
      anchor.scattered.push_back(scattered);
    }
  }
  return anchor;
}

// Which pixels of a row count: those inside the pad with both channels within a closed range.

/// Sets valid[j] to nonzero if inside[j] is nonzero and both channels are in `range`, else to 0.
template <std::unsigned_integral Pixel>
void mark_valid(const ClosedRange<Pixel>& range,
                const Pixel* red,
                const Pixel* green,
                const std::uint8_t* inside,
                std::uint8_t* valid,
                Index count) {
  Index j = 0;
#if defined(FINGERPAD_HAS_VECTORS)
  constexpr int n = row_lanes<Pixel>;
  using V = lanes<Pixel, n>;
  const V low = V{} + range.low;
  const V high = V{} + range.high;
  for (; j + n <= count; j += n) {
    const V r = load<V>(red + j);
    const V g = load<V>(green + j);
    const V in_range = V((r >= low) & (r <= high) & (g >= low) & (g <= high));
    using Bytes = lanes<std::uint8_t, n>;
    store(valid + j, each_as<Bytes>(in_range) & load<Bytes>(inside + j));
  }
#endif
  for (; j < count; ++j) {
    const bool in_range = red[j] >= range.low && red[j] <= range.high && green[j] >= range.low &&
                          green[j] <= range.high;
    valid[j] = in_range ? inside[j] : std::uint8_t(0);
  }
}

/// Why a pixel has no smoothed colour, judged by its own channels.
template <class Cell>
PixelStatus status_of_cells(const Cell& red, const Cell& green, const GreyScale& scale) {
  using S = real_of_t<Cell>;
  const auto r = static_cast<double>(value(S(red)));
  const auto g = static_cast<double>(value(S(green)));
  if (!is_finite(r) || !is_finite(g)) {
    return PixelStatus::not_a_number;
  }
  if (r >= scale.saturated || g >= scale.saturated) {
    return PixelStatus::saturated;
  }
  return r <= scale.dark || g <= scale.dark ? PixelStatus::dark : PixelStatus::not_a_number;
}

/// The status grid of a caller that wants none: it ignores what is assigned.
struct IgnoredCell {
  struct Sink {
    constexpr const Sink& operator=(PixelStatus) const { return *this; }
  };
  constexpr Sink operator()(Index, Index) const { return {}; }
};

/// Writes nothing. The other overload is in lanes.hpp.
template <class View>
void store_row(const PixelStatus*, const View& view, Index row) requires
    std::is_same_v<decltype(view(row, Index(0))), IgnoredCell::Sink> {}

/// Copies one row of each channel to plain memory.
template <class Red, class Green, class Pixel>
void load_pixels(const Red& red, const Green& green, Index row, Pixel* to_red, Pixel* to_green) {
  for (Index j = 0; j < red.cols(); ++j) {
    to_red[j] = static_cast<Pixel>(red(row, j));
    to_green[j] = static_cast<Pixel>(green(row, j));
  }
}
/// The same for images in plain memory. Two channels of one interleaved image are read together.
template <std::unsigned_integral Pixel>
void load_pixels(const StridedView<const Pixel>& red,
                 const StridedView<const Pixel>& green,
                 Index row,
                 Pixel* to_red,
                 Pixel* to_green) {
  const Pixel* r = red.row(row);
  const Pixel* g = green.row(row);
  const Index step = red.col_stride();
  const Index n = red.cols();
  const auto bytes = static_cast<std::size_t>(n) * sizeof(Pixel);
  if (step == 1 && green.col_stride() == 1) {
    std::memcpy(to_red, r, bytes);
    std::memcpy(to_green, g, bytes);
    return;
  }
  Index done = 0;
  const bool together = n > 0 && step == green.col_stride() && r - g < step && g - r < step;
  if (together && (step == 3 || step == 4)) {
    // The last pixel is left to the loop below. It is not known which channel of a pixel `first`
    // is, and a block from there on may reach past the last pixel.
    const Pixel* first = (std::min)(r, g);
    const auto red_at = static_cast<int>(r - first);
    const auto green_at = static_cast<int>(g - first);
    done = n - 1;
    if (step == 3) {
      load_interleaved_row<3>(first, done, red_at, green_at, to_red, to_green);
    } else {
      load_interleaved_row<4>(first, done, red_at, green_at, to_red, to_green);
    }
  }
  for (Index j = done; j < n; ++j) {
    to_red[j] = r[j * step];
    to_green[j] = g[j * green.col_stride()];
  }
}
template <std::unsigned_integral Pixel>
void load_pixels(const StridedView<Pixel>& red,
                 const StridedView<Pixel>& green,
                 Index row,
                 Pixel* to_red,
                 Pixel* to_green) {
  load_pixels(StridedView<const Pixel>(red), StridedView<const Pixel>(green), row, to_red,
              to_green);
}

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
