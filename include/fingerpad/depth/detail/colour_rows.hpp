// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two channels of a frame as rows of averaged red and green, in grey levels. A pixel counts if it
// lies in the pad and both its channels lie strictly between the limits of the grey scale; a mean
// over no such pixel is NaN.
//
// One grey level of noise in both channels is 0.7 mm of depth in a single pixel, so several hundred
// pixels must be averaged. A mean of colours over a curved membrane is biased by curvature times
// window^2 / 24 per axis, and near the rim, where the window is cut, also by slope. Therefore not
// the colours are averaged but F at the free pad's depth l0,
//   r = green exp(delta k l0) - kappa red + g W(l0),
// which is 0 where the membrane has not moved, over two concentric windows: a mean(inner) - b
// mean(outer), with a - b = 1 and second moments that cancel, is exact for a quadratic r where no
// window is cut.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/pad.hpp"
#include "fingerpad/image/detail/interleaved.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_means.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The integer pixels inside an open interval as a closed range; [1, 0] if there are none.
template <std::unsigned_integral Pixel>
struct ClosedRange {
  Pixel low = 1;
  Pixel high = 0;

  ClosedRange(double dark, double saturated) {
    const double top = double((std::numeric_limits<Pixel>::max)());
    const double first = (std::max)(0.0, std::floor(dark) + 1);
    const double last = (std::min)(top, std::ceil(saturated) - 1);
    if (dark < saturated && first <= last) {  // not for NaN
      low = static_cast<Pixel>(first);
      high = static_cast<Pixel>(last);
    }
  }
};

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
  if (step == 1 && green.col_stride() == 1) {
    std::copy_n(r, n, to_red);
    std::copy_n(g, n, to_green);
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

/// The odd number nearest to x, at least 3.
inline int odd_near(double x) {
  return (std::max)(3, 2 * static_cast<int>(std::floor(x / 2)) + 1);
}

/// Inner and outer window in samples of `step` pixels: 1.4 and 2.3 times window_px, which gives the
/// noise of a mean over window_px.
inline std::array<int, 2> two_windows(int window_px, int step) {
  const int inner = odd_near(1.4 * window_px / step);
  return {inner, (std::max)(inner + 2, odd_near(2.3 * window_px / step))};
}

/// Averages of the frames of one pad. Rows are those of `area`, from first to last.
template <class S>
class ColourRows {
 public:
  /// The type in which cells are read: 8- and 16-bit images are averaged exactly as integers with
  /// means in float, all others in S.
  template <class Cell>
  using pixel_t = std::conditional_t<std::same_as<S, float> && (std::same_as<Cell, std::uint8_t> ||
                                                                std::same_as<Cell, std::uint16_t>),
                                     Cell,
                                     S>;

  ColourRows(const Camera<double>& camera,
             const Absorption<double>& fluid,
             const DepthReference<S>& reference,
             const PadArea& area,
             int window_px,
             int step)
      : cols_(area.cols),
        kappa_(S(fluid.kappa)),
        rise_(padded(area.rows * area.cols), S(1)),
        scattered_(rise_.size(), S(0)),
        per_g_(rise_.size(), S(0)),
        gain_(reference.red_gain.empty() ? padded(area.cols) : rise_.size(), S(1)),
        used_(rise_.size(), 0),
        pixels_(Pair<std::uint8_t>(cols_), Pair<std::uint16_t>(cols_), Pair<S>(cols_)) {
    const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
    each_pixel(area.rows, area.cols, [&](Index i, Index j) {
      const Index row = area.row + i, col = area.col + j;
      const S g = reference.g(row, col), gain = reference.gain(row, col);
      if (reference.in_pad(row, col) && is_finite(g) && g > S(0) && gain > S(0) &&
          is_finite(gain * kappa_)) {
        const auto k = static_cast<std::size_t>(i * cols_ + j);
        const Pencil<double> pencil = pencil_of(camera, ray_of(camera, row, col));
        const auto l = static_cast<double>(reference.depth(row, col));
        rise_[k] = S(std::exp(delta * pencil.path_factor * l));
        scattered_[k] = g * S(scattered_light(l, fluid.c_red_per_mm, pencil));
        per_g_[k] = S(1) / g;
        if (!reference.red_gain.empty()) {
          gain_[k] = gain;
        }
        used_[k] = 1;
      }
    });
    if (window_px > 1) {
      const std::array<int, 2> size = two_windows(window_px, step);
      const double inner = size[0] * size[0] - 1;  // 12 times the second moment
      const double outer = size[1] * size[1] - 1;
      weight_ = {S(outer / (outer - inner)), S(-inner / (outer - inner))};
      real_means_.emplace(area.rows, cols_, size);
      if constexpr (std::same_as<S, float>) {
        exact_means_.emplace(area.rows, cols_, size);
      }
      inner_ = Pair<S>(cols_);
      outer_red_ = inner_.red;
    }
  }

  /// 1 / g of the pixels of a row, with a block of spare elements; 0 where a pixel is not used.
  const S* per_g(Index row) const { return per_g_.data() + row * cols_; }
  const std::uint8_t* used(Index row) const { return used_.data() + row * cols_; }
  Index pixels_used() const { return std::count(used_.begin(), used_.end(), std::uint8_t(1)); }

  /// Begins with row `first` of a frame.
  template <class Red, class Green>
  void start(const Red& red, const Green& green, const GreyScale& scale, Index first) {
    row_ = first;
    if (real_means_) {
      means<pixel_t<cell_t<Red>>>().start(first, source(red, green, scale));
    }
  }

  /// Writes the next row. Red is multiplied by the pixel's gain.
  template <class Red, class Green>
  void next(const Red& red, const Green& green, const GreyScale& scale, S* to_red, S* to_green) {
    using Pixel = pixel_t<cell_t<Red>>;
    if (real_means_) {
      means<Pixel>().advance(source(red, green, scale), inner_.red.data(), inner_.green.data(),
                             outer_red_.data());
      finish<Pixel>(row_++, to_red, to_green);
      return;
    }
    auto& from = pixels<Pixel>();
    load_pixels(red, green, row_, from.red.data(), from.green.data());
    const std::uint8_t* used = this->used(row_);
    const S* gain = this->gain(row_++);
    const S level = S(1 / scale.units_per_level);
    for (Index j = 0; j < cols_; ++j) {
      const S r = S(from.red[std::size_t(j)]), g = S(from.green[std::size_t(j)]);
      const bool counts = used[j] != 0 && scale.counts(r) && scale.counts(g);
      to_red[j] = counts ? r * level * gain[j] : not_a_number<S>();
      to_green[j] = counts ? g * level : not_a_number<S>();
    }
  }

 private:
  template <class T>
  struct Pair {
    std::vector<T> red, green;
    explicit Pair(Index cols = 0) : red(padded(cols)), green(padded(cols)) {}
  };

  // Integer pixels are averaged as 16-bit numbers: residuals in steps of 1/128 grey level around
  // the middle of the range, green in steps of 1/256.
  template <class Pixel>
  using Element = std::conditional_t<std::integral<Pixel>, std::uint16_t, Pixel>;
  static constexpr int residual_units = 128;
  static constexpr int residual_zero = 32768;
  static constexpr int green_units = 256;
  static constexpr Index block = 64;

  /// Size of a row that may be read in whole blocks.
  static constexpr std::size_t padded(Index count) { return std::size_t(count + block); }

  template <class Pixel>
  Pair<Pixel>& pixels() {
    return std::get<Pair<Pixel>>(pixels_);
  }
  template <class Pixel>
  auto& means() {
    if constexpr (std::integral<Pixel>) {
      return *exact_means_;
    } else {
      return *real_means_;
    }
  }
  const S* gain(Index row) const {
    return gain_.data() + (gain_.size() == rise_.size() ? row * cols_ : 0);
  }

  /// The row source of the window means: residuals and green of a row, and which pixels count.
  template <class Red, class Green>
  auto source(const Red& red, const Green& green, const GreyScale& scale) {
    using Pixel = pixel_t<cell_t<Red>>;
    return [this, &red, &green, &scale](Index row, Element<Pixel>* residual,
                                        Element<Pixel>* to_green, std::uint8_t* counts) {
      auto& from = pixels<Pixel>();
      load_pixels(red, green, row, from.red.data(), from.green.data());
      load_residuals(row, from.red.data(), from.green.data(), scale, residual, to_green, counts);
    };
  }

  template <class Pixel>
  void load_residuals(Index row,
                      const Pixel* red,
                      const Pixel* green,
                      const GreyScale& scale,
                      Element<Pixel>* residual,
                      Element<Pixel>* to_green,
                      std::uint8_t* counts) const {
    const S* rise = rise_.data() + row * cols_;
    const S* scattered = scattered_.data() + row * cols_;
    const S* gain = this->gain(row);
    const std::uint8_t* used = this->used(row);
    const S level = S(1 / scale.units_per_level);
    const S kappa = kappa_ * level;
    if constexpr (std::integral<Pixel>) {
      const ClosedRange<Pixel> range(scale.dark, scale.saturated);
      for (Index j = 0; j < cols_; j += block) {
        mark(range, red + j, green + j, used + j, counts + j);
      }
      const S units = S(residual_units);
      const S zero = S(residual_zero) + S(0.5);  // + 1/2: truncation then rounds
      for_each_cell<S>(cols_, [&]<class V>(Index j) {
        const V b = load_cells<V, S>(green + j) * level;
        const V gained = load_cells<V, S>(red + j) * (load_cells<V, S>(gain + j) * kappa);
        const V membrane = load_cells<V, S>(rise + j) * b;
        const V stored = (membrane + (load_cells<V, S>(scattered + j) - gained)) * units + zero;
        const V low = V{} + S(1);
        const V high = V{} + S(65535);
        store_cells<S>(residual + j, stored < low ? low : stored > high ? high : stored);
        const V scaled = b * S(green_units);
        store_cells<S>(to_green + j, scaled > high ? high : scaled);
      });
    } else {
      for (Index j = 0; j < cols_; ++j) {
        const S b = green[j] * level;
        residual[j] = rise[j] * b - kappa * gain[j] * red[j] + scattered[j];
        to_green[j] = b;
        counts[j] = used[j] != 0 && scale.counts(red[j]) && scale.counts(green[j]);
      }
    }
  }

  template <class Pixel>
  static void mark(const ClosedRange<Pixel>& range,
                   const Pixel* red,
                   const Pixel* green,
                   const std::uint8_t* used,
                   std::uint8_t* __restrict counts) {
    for (Index i = 0; i < block; ++i) {
      const bool in_range = (red[i] >= range.low) & (red[i] <= range.high) &
                            (green[i] >= range.low) & (green[i] <= range.high);
      counts[i] = std::uint8_t(used[i] & -int(in_range));
    }
  }

  /// Combines the means of the windows and converts residuals back to red. If a pixel's inner
  /// window holds no valid pixel, its mean is NaN and so is the result. Green needs only one
  /// window, because its share in the equation is small.
  template <class Pixel>
  void finish(Index row, S* to_red, S* to_green) const {
    const S* rise = rise_.data() + row * cols_;
    const S* scattered = scattered_.data() + row * cols_;
    const S per_kappa = S(1) / kappa_;
    for_each_cell<S>(cols_, [&]<class V>(Index j) {
      V residual = weight_[0] * load_cells<V, S>(inner_.red.data() + j) +
                   weight_[1] * load_cells<V, S>(outer_red_.data() + j);
      V green = load_cells<V, S>(inner_.green.data() + j);
      if constexpr (std::integral<Pixel>) {
        green = green * (S(1) / S(green_units));
        residual = (residual - S(residual_zero)) * (S(1) / S(residual_units));
      }
      const V membrane = load_cells<V, S>(rise + j) * green;
      const V red = (membrane + load_cells<V, S>(scattered + j) - residual) * per_kappa;
      store_cells<S>(to_red + j, red);
      store_cells<S>(to_green + j, green);
    });
  }

  Index cols_;
  S kappa_;
  // Planes of the area; a plane has a block of spare elements at its end.
  std::vector<S> rise_;       // exp(delta k l0)
  std::vector<S> scattered_;  // g W(l0), grey levels
  std::vector<S> per_g_;
  std::vector<S> gain_;  // a plane, or one row of 1
  std::vector<std::uint8_t> used_;
  std::tuple<Pair<std::uint8_t>, Pair<std::uint16_t>, Pair<S>> pixels_;
  std::optional<WindowMeans<S>> real_means_;  // empty: no window
  std::optional<WindowMeans<std::uint16_t>> exact_means_;
  std::array<S, 2> weight_ = {};
  Pair<S> inner_;  // means over the windows
  std::vector<S> outer_red_;
  Index row_ = 0;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
