// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reduces a frame to fewer, larger samples: means of step x step pixels. Depth averages colours
// over 29 pixels and contact uses a ring of 25, so samples of 2 or 3 pixels lose nothing that would
// not be averaged anyway, and all later stages cost 1 / step^2 as much. A sampled frame is the
// frame of a camera with larger pixels; sampled() gives that camera, and the free pad as it sees
// it. The methods need no change. Leftover pixels at the right and at the bottom are ignored.
#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/colour_rows.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The type in which samples are stored: 16 bit for 8-bit pixels, else the pixel's own type.
template <class Pixel>
using sample_t = std::conditional_t<std::same_as<Pixel, std::uint8_t>, std::uint16_t, Pixel>;

/// Where a position in pixels lies in samples, along one axis: pixel 0 is the first of sample 0.
template <scalar S>
S sampled_px(const S& px, int step) {
  return (px - S(step - 1) / S(2)) / S(step);
}

/// The camera whose pixels are the samples.
template <scalar S>
Camera<S> sampled(const Camera<S>& camera, int step) {
  Camera<S> out = camera;
  out.center_x_px = sampled_px(camera.center_x_px, step);
  out.center_y_px = sampled_px(camera.center_y_px, step);
  out.pitch_mm = camera.pitch_mm * S(step);
  return out;
}

/// The free pad as that camera sees it: means of each plane. A sample is of the pad where all its
/// pixels are. Refuses steps outside of 1..16 and larger than the image (parameter_error).
template <scalar S>
DepthReference<S> sampled(const DepthReference<S>& reference, int step) {
  expects(step >= 1 && step <= 16, "sampled", "step", step, "in 1..16");
  expects(step <= reference.rows && step <= reference.cols, "sampled", "step", step,
          "<= the rows and columns of the reference");
  DepthReference<S> out = reference;
  out.rows = reference.rows / step;
  out.cols = reference.cols / step;
  const auto means_of = [&](const std::vector<S>& plane) {
    std::vector<S> means;
    for (Index k = 0; !plane.empty() && k < out.rows * out.cols; ++k) {
      const Index first = k / out.cols * step * reference.cols + k % out.cols * step;
      S sum = S(0);
      for (Index m = 0; m < step * step; ++m) {
        sum = sum + plane[static_cast<std::size_t>(first + m / step * reference.cols + m % step)];
      }
      means.push_back(sum / S(step * step));
    }
    return means;
  };
  out.depth_mm = means_of(reference.depth_mm);
  out.scattering = means_of(reference.scattering);
  out.red_gain = means_of(reference.red_gain);
  return out;
}

/// Means over Step x Step pixels, leaving out pixels that carry no information, in
/// grey_scale_of<sample_t<Pixel>>(). If all are left out, the sample is the brightest value if one
/// is saturated, else NaN if one is NaN, else 0, and carries no information either. Use one object
/// per thread. No allocation per frame; O(rows cols).
template <class Pixel, int Step>
class FrameSampler {
  static_assert(Step >= 1 && Step <= 16, "the sampling step is in 1..16");

 public:
  using Sample = sample_t<Pixel>;

  /// For frames of so many columns, or fewer.
  explicit FrameSampler(Index cols)
      : cols_(cols), red_(static_cast<std::size_t>(Step * cols)), green_(red_) {}

  /// Rows [first, last) of the samples of a frame; false, and nothing written, where a grid has
  /// another size.
  template <grid Red, grid Green>
  bool band(Index first,
            Index last,
            const Red& red,
            const Green& green,
            const StridedView<Sample>& to_red,
            const StridedView<Sample>& to_green) {
    const auto from_red = as_view(red);
    const auto from_green = as_view(green);
    const Index cols = from_red.cols();
    if (!same_size(from_red, from_green) || !same_size(to_red, to_green) || cols > cols_ ||
        to_red.rows() != from_red.rows() / Step || to_red.cols() != cols / Step || first < 0 ||
        last < first || last > to_red.rows()) {
      return false;
    }
    for (Index i = first; i < last; ++i) {
      if constexpr (detail::plain_rows<std::remove_const_t<decltype(from_red)>, Pixel> &&
                    detail::plain_rows<std::remove_const_t<decltype(from_green)>, Pixel>) {
        if (from_red.col_stride() == 1 && from_green.col_stride() == 1 &&
            from_red.row_stride() == from_green.row_stride()) {
          const Rows in_place{from_red.row(i * Step), from_green.row(i * Step),
                              from_red.row_stride()};
          average(in_place, to_red, to_green, i);
          continue;
        }
      }
      for (Index k = 0; k < Step; ++k) {
        detail::load_pixels(from_red, from_green, i * Step + k, 0, cols, red_.data() + k * cols,
                            green_.data() + k * cols);
      }
      average({red_.data(), green_.data(), cols}, to_red, to_green, i);
    }
    return true;
  }

 private:
  static constexpr GreyScale scale = grey_scale_of<Pixel>();
  static constexpr std::size_t block = 64;  ///< cells of a loop whose length the compiler knows

  /// Step rows of each channel, `stride` pixels apart.
  struct Rows {
    const Pixel* red;
    const Pixel* green;
    Index stride;
  };

  static void average(const Rows& from,
                      const StridedView<Sample>& to_red,
                      const StridedView<Sample>& to_green,
                      Index row) {
    const Index cols = to_red.cols();
    Index j = 0;
    if constexpr (std::same_as<Pixel, std::uint8_t>) {
      constexpr auto n = static_cast<Index>(block);
      if (to_red.col_stride() == 1 && to_green.col_stride() == 1 && cols >= n) {
        for (; j < cols; j += n) {
          const Index first = (std::min)(j, cols - n);  // the last ones twice
          average_block(from, first, to_red.row(row) + first, to_green.row(row) + first);
        }
      }
    }
    for (; j < cols; ++j) {
      one(from, j, to_red(row, j), to_green(row, j));
    }
  }

  static void one(const Rows& from, Index col, Sample& to_red, Sample& to_green) {
    using Sum = std::conditional_t<std::integral<Pixel>, std::uint32_t, Pixel>;
    Sum red = Sum(0);
    Sum green = Sum(0);
    int count = 0;
    bool saturated = false;
    bool no_number = false;
    for (Index k = 0; k < Step * Step; ++k) {
      const Index at = k / Step * from.stride + col * Step + k % Step;
      const auto r = static_cast<double>(from.red[at]), g = static_cast<double>(from.green[at]);
      saturated = saturated || r >= scale.saturated || g >= scale.saturated;
      no_number = no_number || r != r || g != g;
      if (scale.counts(r) && scale.counts(g)) {
        ++count;
        red = red + Sum(from.red[at]);
        green = green + Sum(from.green[at]);
      }
    }
    if (count == 0) {
      const Sample none = no_number ? not_a_sample() : Sample(0);
      to_red = saturated ? Sample(grey_scale_of<Sample>().saturated) : none;
      to_green = to_red;
    } else {
      to_red = mean(red, count);
      to_green = mean(green, count);
    }
  }

  static Sample not_a_sample() {
    if constexpr (std::integral<Sample>) {
      return Sample(0);
    } else {
      return not_a_number<Sample>();
    }
  }

  template <class Sum>
  static Sample mean(const Sum& sum, int count) {
    if constexpr (std::integral<Sum>) {
      constexpr Sum units = sizeof(Sample) > sizeof(Pixel) ? 256 : 1;
      const Sum pixels = static_cast<Sum>(count);
      return static_cast<Sample>((sum * units + pixels / 2) / pixels);
    } else {
      return Sample(sum / Sum(count));
    }
  }

  /// Sums over Step rows, column by column; pixels without information are left out.
  struct Columns {
    std::array<std::uint16_t, block*Step> red = {}, green = {};
    std::array<std::uint8_t, block*Step> count = {}, bright = {};

    /// Adds `block` pixels of a row to the columns from `at` on.
    void add(const std::uint8_t* from_red, const std::uint8_t* from_green, std::size_t at) {
      std::uint16_t* __restrict reds = red.data() + at;
      std::uint16_t* __restrict greens = green.data() + at;
      std::uint8_t* __restrict counts = count.data() + at;
      std::uint8_t* __restrict brights = bright.data() + at;
      std::array<std::uint8_t, block> keep;  // 255: carries information, else 0
      for (std::size_t i = 0; i < block; ++i) {
        const auto top =
            static_cast<std::uint8_t>(-int((from_red[i] == 255) | (from_green[i] == 255)));
        const auto dark =
            static_cast<std::uint8_t>(-int((from_red[i] == 0) | (from_green[i] == 0)));
        brights[i] = static_cast<std::uint8_t>(brights[i] | top);
        keep[i] = static_cast<std::uint8_t>(~(top | dark));
      }
      for (std::size_t i = 0; i < block; ++i) {
        reds[i] = static_cast<std::uint16_t>(reds[i] + (from_red[i] & keep[i]));
      }
      for (std::size_t i = 0; i < block; ++i) {
        greens[i] = static_cast<std::uint16_t>(greens[i] + (from_green[i] & keep[i]));
      }
      for (std::size_t i = 0; i < block; ++i) {
        counts[i] = static_cast<std::uint8_t>(counts[i] - keep[i]);  // 255 is -1
      }
    }
  };

  /// `block` samples from column `col` on.
  static void average_block(const Rows& rows, Index col, Sample* to_red, Sample* to_green) {
    Columns columns;
    for (Index k = 0; k < Step; ++k) {
      for (std::size_t at = 0; at < block * Step; at += block) {
        const Index from = k * rows.stride + col * Step + static_cast<Index>(at);
        columns.add(rows.red + from, rows.green + from, at);
      }
    }
    std::uint8_t lost = 0;
    for (std::size_t k = 0; k < block * Step; ++k) {
      lost = static_cast<std::uint8_t>(lost | (columns.count[k] ^ Step));
    }
    if (lost == 0) {  // a constant divisor needs no division
      for (std::size_t j = 0; j < block; ++j) {
        to_red[j] = mean(sum_of(columns.red, j), Step * Step);
      }
      for (std::size_t j = 0; j < block; ++j) {
        to_green[j] = mean(sum_of(columns.green, j), Step * Step);
      }
      return;
    }
    for (std::size_t j = 0; j < block; ++j) {
      const auto count = static_cast<int>(sum_of(columns.count, j));
      const Sample none = sum_of(columns.bright, j) > 0 ? Sample(255 * 256) : Sample(0);
      to_red[j] = count > 0 ? mean(sum_of(columns.red, j), count) : none;
      to_green[j] = count > 0 ? mean(sum_of(columns.green, j), count) : none;
    }
  }
  /// Sum over the columns of sample j.
  template <class Cells>
  [[gnu::always_inline]] static std::uint32_t sum_of(const Cells& cells, std::size_t j) {
    return [&]<std::size_t... K>(std::index_sequence<K...>) __attribute__((always_inline)) {
      return (std::uint32_t(0) + ... + std::uint32_t(cells[j * sizeof...(K) + K]));
    }
    (std::make_index_sequence<std::size_t(Step)>{});
  }

  Index cols_;
  std::vector<Pixel> red_, green_;  // Step rows that lie elsewhere in the frame
};

}  // namespace v0
}  // namespace fingerpad
