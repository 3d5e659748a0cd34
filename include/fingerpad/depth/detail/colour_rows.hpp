// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two channels of a frame as rows of averaged red and green, in grey levels. A pixel counts if it
// lies in the pad and both its channels lie strictly between the limits of the grey scale; a mean
// over no such pixel is NaN.
//
// Not the colours are averaged but F at the free pad's depth l0 (docs/depth/depth.md, averaging),
//   r = green exp(delta k l0) - kappa red + g W(l0),
// over two concentric windows: a mean(inner) - b mean(outer), with a - b = 1 and second moments
// that cancel, is exact for a quadratic r where no window is cut.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_means.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

#if defined(FINGERPAD_HAS_VECTORS)
using Bytes16 = lanes<std::uint8_t, 16>;

/// Interleaves the low (or high) eight bytes of a with the low (or high) eight of b.
[[gnu::always_inline]] inline Bytes16 mix_low(Bytes16 a, Bytes16 b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}
[[gnu::always_inline]] inline Bytes16 mix_high(Bytes16 a, Bytes16 b) {
  return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15,
                                 31);
}
[[gnu::always_inline]] inline Bytes16 swap_halves(Bytes16 a) {
  using Words = lanes<std::uint64_t, 2>;
  return Bytes16(__builtin_shufflevector(Words(a), Words(a), 1, 0));
}

/// Interleaves the first and the second half of all bytes.
[[gnu::always_inline]] inline void mix(std::array<Bytes16, 3>& v) {
  v = {mix_low(v[0], swap_halves(v[1])), mix_high(v[0], swap_halves(v[2])),
       mix_low(v[1], swap_halves(v[2]))};
}

/// Two channels of a row of pixels of three bytes (BGR): red[i] = from[3 i + red_offset], and
/// likewise green, for as many i < n as whole vectors hold; returns how many. Interleaving the
/// halves of 16 pixels four times brings byte 3 i + c to i + 16 c.
inline Index load_interleaved(const std::uint8_t* from,
                              Index n,
                              Index red_offset,
                              Index green_offset,
                              std::uint8_t* red,
                              std::uint8_t* green) {
  Index i = 0;
  for (; i + 16 <= n; i += 16) {
    std::array<Bytes16, 3> planes;
    for (std::size_t c = 0; c < 3; ++c) {
      planes[c] = load<Bytes16>(from + 3 * i + 16 * Index(c));
    }
    for (int k = 0; k < 4; ++k) {
      mix(planes);
    }
    store(red + i, planes[std::size_t(red_offset)]);
    store(green + i, planes[std::size_t(green_offset)]);
  }
  return i;
}
#else
inline Index load_interleaved(
    const std::uint8_t*, Index, Index, Index, std::uint8_t*, std::uint8_t*) {
  return 0;
}
#endif

/// Reads columns [col, col + n) of a row of both channels.
template <class Red, class Green, class Pixel>
void load_pixels(const Red& red,
                 const Green& green,
                 Index row,
                 Index col,
                 Index n,
                 Pixel* to_red,
                 Pixel* to_green) {
  Index done = 0;
  if constexpr (plain_rows<Red, Pixel> && plain_rows<Green, Pixel>) {
    const Index step = red.col_stride();
    const Pixel* r = red.row(row) + col * step;
    const Pixel* g = green.row(row) + col * green.col_stride();
    if (step == 1 && green.col_stride() == 1) {
      std::copy_n(r, n, to_red);
      std::copy_n(g, n, to_green);
      return;
    }
    if constexpr (std::same_as<Pixel, std::uint8_t>) {
      if (n > 0 && step == 3 && green.col_stride() == 3 && r - g < 3 && g - r < 3) {
        // Two channels of one image. The last pixel of a row is left to the loop below: which of
        // its channels comes first is not known, and a vector may reach past it.
        const Pixel* first = (std::min)(r, g);
        const Index whole = col + n < red.cols() ? n : n - 1;
        done = load_interleaved(first, whole, r - first, g - first, to_red, to_green);
      }
    }
  }
  for (Index j = done; j < n; ++j) {
    to_red[j] = static_cast<Pixel>(red(row, col + j));
    to_green[j] = static_cast<Pixel>(green(row, col + j));
  }
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
  ColourRows(const Camera<double>& camera,
             const Absorption<double>& fluid,
             const DepthReference<S>& reference,
             const PadArea& area,
             int window_px,
             int step)
      : cols_(area.cols),
        kappa_(S(fluid.kappa)),
        per_kappa_(1 / kappa_),
        rise_(padded(area.rows * area.cols), S(1)),
        scattered_(rise_.size()),
        per_g_(rise_.size()),
        gain_(reference.red_gain.empty() ? padded(area.cols) : rise_.size(), S(1)) {
    const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
    each_pixel(area.rows, area.cols, [&](Index i, Index j) {
      const Index row = area.row + i, col = area.col + j;
      const S g = reference.g(row, col), gain = reference.gain(row, col);
      if (reference.in_pad(row, col) && is_finite(g) && g > S(0) && gain > S(0) &&
          is_finite(gain * kappa_)) {
        const auto k = static_cast<std::size_t>(i * cols_ + j);
        const Ray<double> ray =
            ray_at_pixel(camera, static_cast<double>(row), static_cast<double>(col));
        const auto l = static_cast<double>(reference.depth(row, col));
        rise_[k] = S(std::exp(delta * ray.path_factor * l));
        scattered_[k] = g * S(scattered_light(l, fluid.c_red_per_mm, ray));
        per_g_[k] = S(1) / g;
        if (!reference.red_gain.empty()) {
          gain_[k] = gain;
        }
      }
    });
    if (window_px > 1) {
      const std::array<int, 2> size = two_windows(window_px, step);
      const double inner = size[0] * size[0] - 1;  // 12 times the second moment
      const double outer = size[1] * size[1] - 1;
      weight_ = {S(outer / (outer - inner)), S(-inner / (outer - inner))};
      wide_means_.emplace(area.rows, cols_, size);
      if constexpr (std::same_as<S, float>) {
        short_means_.emplace(area.rows, cols_, size);
      }
      inner_red_.resize(padded(cols_));
      inner_green_ = outer_red_ = inner_red_;
    }
  }

  /// Frames are taken back to the light of the reference.
  void set_light(const LightGains& gains) {
    green_level_ = S(1 / gains.green);
    red_level_ = S(1 / gains.red);
  }

  /// 1 / g of the pixels of a row, with a block of spare elements; 0 where a pixel is not used.
  const S* per_g(Index row) const { return per_g_.data() + row * cols_; }

  /// Begins with the first row of a frame.
  template <class Red, class Green>
  void start(const Red& red, const Green& green) {
    row_ = 0;
    if (wide_means_) {
      means<element_t<cell_t<Red>>>().start(source(red, green));
    }
  }

  /// Writes the next row, in memory for whole blocks of 64. Red is multiplied by the pixel's gain.
  template <class Red, class Green>
  void next(const Red& red, const Green& green, S* to_red, S* to_green) {
    using Element = element_t<cell_t<Red>>;
    const Index row = row_++;
    if (!wide_means_) {
      std::uint32_t counts[block];
      each_block(red, green, row, [&](Index j, const auto* r, const auto* g) {
        mark(r, g, per_g(row) + j, counts);
        single(r, g, gain(row) + j, counts, levels<cell_t<Red>>(), to_red + j, to_green + j);
      });
      return;
    }
    means<Element>().advance(source(red, green), inner_red_.data(), inner_green_.data(),
                             outer_red_.data());
    for (Index j = 0; j < cols_; j += block) {
      finish<Element>(row, j, to_red + j, to_green + j);
    }
  }

 private:
  static constexpr Index block = 64;
  /// Size of a row that may be read in whole blocks.
  static constexpr std::size_t padded(Index count) { return std::size_t(count + block); }

  template <class Cell>
  static constexpr bool is_short =
      std::same_as<Cell, std::uint8_t> || std::same_as<Cell, std::uint16_t>;
  template <class Cell>
  using pixel_t = std::conditional_t<is_short<Cell>, Cell, S>;  ///< as a cell is read

  // Pixels are averaged as whole numbers of steps: for float, 8- and 16-bit pixels in 16 bits with
  // residuals around the middle of their range, all others in 64 bits.
  template <class Cell>
  using element_t =
      std::conditional_t<is_short<Cell> && std::same_as<S, float>, std::uint32_t, std::uint64_t>;
  template <class Element, std::int64_t for_16_bits, std::int64_t for_64_bits>
  static constexpr S either = S(static_cast<double>(sizeof(Element) == 4 ? for_16_bits
                                                                         : for_64_bits));
  template <class E>
  static constexpr S residual_steps = either<E, 128, std::int64_t(1) << 38>;  ///< in a grey level
  template <class E>
  static constexpr S green_steps = either<E, 256, std::int64_t(1) << 38>;
  template <class E>
  static constexpr S middle = either<E, 32768, 0>;
  template <class E>
  static constexpr S low = either<E, 0, -(std::int64_t(1) << 47)>;
  template <class E>
  static constexpr S high = either<E, 65535, std::int64_t(1) << 47>;

  template <class Element>
  auto& means() {
    if constexpr (sizeof(Element) == 4) {
      return *short_means_;
    } else {
      return *wide_means_;
    }
  }
  /// Grey levels of a stored unit of red and of green, in the light of the reference.
  template <class Cell>
  std::array<S, 2> levels() const {
    const S level = S(1 / grey_scale_of<Cell>().units_per_level);
    return {level * red_level_, level * green_level_};
  }
  const S* gain(Index row) const {
    return gain_.data() + (gain_.size() == rise_.size() ? row * cols_ : 0);
  }

  /// Calls visit(j, red, green) for each block of pixels of a row, from column j on.
  template <class Red, class Green, class Visit>
  void each_block(const Red& red, const Green& green, Index row, const Visit& visit) const {
    constexpr Index chunk = 8 * block;  // read at once: a store is slow to read as a wider vector
    for (Index first = 0; first < cols_; first += chunk) {
      pixel_t<cell_t<Red>> reds[chunk] = {}, greens[chunk] = {};
      const Index n = (std::min)(chunk, cols_ - first);
      load_pixels(red, green, row, first, n, reds, greens);
      for (Index j = 0; j < n; j += block) {
        visit(first + j, reds + j, greens + j);
      }
    }
  }

  /// The row source of the window means: residuals and green of a row, and which pixels count.
  template <class Red, class Green>
  auto source(const Red& red, const Green& green) const {
    return [&, this](Index row, auto* residual, auto* to_green, std::uint32_t* counts) {
      each_block(red, green, row, [&](Index j, const auto* r, const auto* g) {
        mark(r, g, per_g(row) + j, counts + j);
        store(row, j, r, g, counts + j, residual + j, to_green + j);
      });
    };
  }

  // Loops over a block, on vectors: see window_means.hpp.

  template <class Pixel>
  [[gnu::noinline]] static void mark(const Pixel* red,
                                     const Pixel* green,
                                     const S* per_g,
                                     std::uint32_t* __restrict counts) {
    using Number = std::conditional_t<is_short<Pixel>, std::int32_t, S>;
    constexpr GreyScale scale = grey_scale_of<Pixel>();
    const Number dark = Number(scale.dark), saturated = Number(scale.saturated);
    for (Index i = 0; i < block; ++i) {
      const Number r = Number(red[i]), g = Number(green[i]);
      counts[i] = std::uint32_t(int(per_g[i] > S(0)) & int(r > dark) & int(r < saturated) &
                                int(g > dark) & int(g < saturated));
    }
  }

  template <class Pixel>
  [[gnu::noinline]] static void single(const Pixel* red,
                                       const Pixel* green,
                                       const S* gain,
                                       const std::uint32_t* counts,
                                       const std::array<S, 2>& levels,
                                       S* __restrict to_red,
                                       S* __restrict to_green) {
    const S red_level = levels[0], green_level = levels[1];
    for (Index i = 0; i < block; ++i) {
      const S one = S(int(counts[i])) / S(int(counts[i]));  // NaN where the pixel does not count
      to_red[i] = S(red[i]) * red_level * gain[i] * one;
      to_green[i] = S(green[i]) * green_level * one;
    }
  }

  template <class Pixel, class Element>
  [[gnu::noinline]] void store(Index row,
                               Index col,
                               const Pixel* red,
                               const Pixel* green,
                               const std::uint32_t* counts,
                               Element* __restrict residual,
                               Element* __restrict to_green) const {
    const S* rise = rise_.data() + row * cols_ + col;
    const S* scattered = scattered_.data() + row * cols_ + col;
    const S* gain = this->gain(row) + col;
    const std::array<S, 2> level = levels<Pixel>();
    const S green_level = level[1], kappa = kappa_ * level[0];
    const auto whole = [](S x) __attribute__((always_inline)) {  // NaN: the lowest
      x = x > low<Element> ? x : low<Element>;
      x = x < high<Element> ? x : high<Element>;
      return std::conditional_t<sizeof(Element) == 4, std::int32_t, std::int64_t>(x);
    };
    constexpr S zero = middle<Element> + S(0.5);  // + 1/2: truncation then rounds
    constexpr auto shift = static_cast<std::make_signed_t<Element>>(middle<Element>);
    for (Index i = 0; i < block; ++i) {
      const S b = S(green[i]) * green_level;
      const S r = rise[i] * b + (scattered[i] - S(red[i]) * (gain[i] * kappa));
      residual[i] = Element((whole(r * residual_steps<Element> + zero) - shift) & -int(counts[i]));
      to_green[i] = Element(whole(b * green_steps<Element>) & -int(counts[i]));
    }
  }

  /// Combines the means of the windows and converts residuals back to red. If a pixel's inner
  /// window holds no valid pixel, its mean is NaN and so is the result. Green needs only one
  /// window, because its share in the equation is small.
  template <class Element>
  [[gnu::noinline]] void finish(Index row,
                                Index col,
                                S* __restrict to_red,
                                S* __restrict to_green) const {
    const S* rise = rise_.data() + row * cols_ + col;
    const S* scattered = scattered_.data() + row * cols_ + col;
    const S* inner = inner_red_.data() + col;
    const S* outer = outer_red_.data() + col;
    const S* green = inner_green_.data() + col;
    const S per_kappa = per_kappa_, a = weight_[0], b = weight_[1];
    for (Index i = 0; i < block; ++i) {
      const S steps = a * inner[i] + b * outer[i];
      const S g = green[i] * (1 / green_steps<Element>);
      to_red[i] = (rise[i] * g + scattered[i] - steps * (1 / residual_steps<Element>)) * per_kappa;
      to_green[i] = g;
    }
  }

  Index cols_;
  S kappa_, per_kappa_;
  S red_level_ = S(1), green_level_ = S(1);  // of a frame, in the light of the reference
  // Planes of the area; a plane has a block of spare elements at its end.
  SharedVector<S> rise_;       // exp(delta k l0)
  SharedVector<S> scattered_;  // g W(l0), grey levels
  SharedVector<S> per_g_;
  SharedVector<S> gain_;  // a plane, or one row of 1
  std::optional<WindowMeans<std::uint32_t>> short_means_;
  std::optional<WindowMeans<std::uint64_t, S>> wide_means_;  // empty: no window
  std::array<S, 2> weight_ = {};
  std::vector<S> inner_red_, inner_green_, outer_red_;  // means over the windows
  Index row_ = 0;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
