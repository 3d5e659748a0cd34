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
#include <numeric>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
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

namespace detail {

/// The mean of `count` pixels, as a sample.
template <class Pixel, class Sum>
sample_t<Pixel> sample_of(const Sum& sum, int count) {
  if constexpr (std::integral<Pixel>) {
    constexpr Sum units = sizeof(sample_t<Pixel>) > sizeof(Pixel) ? 256 : 1;
    const Sum pixels = static_cast<Sum>(count);
    return static_cast<sample_t<Pixel>>((sum * units + pixels / 2) / pixels);
  } else {
    return sum / Sum(count);
  }
}

/// One sample of both channels, whose first pixel is at (row, col).
template <class Pixel, class Red, class Green>
std::pair<sample_t<Pixel>, sample_t<Pixel>> one_sample(
    const Red& red, const Green& green, Index row, Index col, int step) {
  using Sample = sample_t<Pixel>;
  using Sum = std::conditional_t<std::integral<Pixel>, std::uint32_t, Pixel>;
  constexpr GreyScale scale = grey_scale_of<Pixel>();
  Sum red_sum = Sum(0), green_sum = Sum(0);
  int count = 0;
  bool saturated = false, no_number = false;
  for (Index k = 0; k < step * step; ++k) {
    const Pixel of_red = red(row + k / step, col + k % step);
    const Pixel of_green = green(row + k / step, col + k % step);
    const auto r = static_cast<double>(of_red), g = static_cast<double>(of_green);
    saturated = saturated || r >= scale.saturated || g >= scale.saturated;
    no_number = no_number || r != r || g != g;
    if (scale.counts(r) && scale.counts(g)) {
      ++count;
      red_sum = red_sum + Sum(of_red);
      green_sum = green_sum + Sum(of_green);
    }
  }
  if (count > 0) {
    return {sample_of<Pixel>(red_sum, count), sample_of<Pixel>(green_sum, count)};
  }
  Sample none = Sample(0);
  if constexpr (!std::integral<Sample>) {
    none = no_number ? not_a_number<Sample>() : none;
  }
  none = saturated ? Sample(grey_scale_of<Sample>().saturated) : none;
  return {none, none};
}

/// 64 samples of 8-bit pixels, with loops whose length the compiler knows. Step 0: any step.
template <int Step>
class SampleBlock {
 public:
  static constexpr std::size_t samples = 64;

  explicit SampleBlock(int step) : step_(Step > 0 ? Step : step) {}

  /// Samples from (row, col) of the frame, in pixels, on.
  template <class Red, class Green>
  void operator()(const Red& red,
                  const Green& green,
                  Index row,
                  Index col,
                  std::uint16_t* to_red,
                  std::uint16_t* to_green) {
    red_ = green_ = {};
    count_ = bright_ = {};
    const std::size_t width = samples * step();
    std::array<std::uint8_t, pixels> red_row, green_row;
    for (Index k = row; k < row + static_cast<Index>(step()); ++k) {
      load_pixels(red, green, k, col, static_cast<Index>(width), red_row.data(), green_row.data());
      for (std::size_t at = 0; at < width; at += samples) {
        add(&red_row[at], &green_row[at], &red_[at], &green_[at], &count_[at], &bright_[at]);
      }
    }
    write(to_red, to_green);
  }

 private:
  static constexpr std::size_t pixels = samples * (Step > 0 ? Step : 16);

  constexpr std::size_t step() const { return Step > 0 ? Step : static_cast<std::size_t>(step_); }

  void write(std::uint16_t* to_red, std::uint16_t* to_green) const {
    std::uint8_t lost = 0;
    for (std::size_t k = 0; k < samples * step(); ++k) {
      lost = static_cast<std::uint8_t>(lost | (count_[k] ^ step()));
    }
    if (lost == 0) {  // a constant divisor needs no division
      const int all = static_cast<int>(step() * step());
      for (std::size_t j = 0; j < samples; ++j) {
        to_red[j] = sample_of<std::uint8_t>(sum_of(red_, j), all);
      }
      for (std::size_t j = 0; j < samples; ++j) {
        to_green[j] = sample_of<std::uint8_t>(sum_of(green_, j), all);
      }
      return;
    }
    for (std::size_t j = 0; j < samples; ++j) {
      const auto count = static_cast<int>(sum_of(count_, j));
      const auto none = static_cast<std::uint16_t>(sum_of(bright_, j) > 0 ? 255 * 256 : 0);
      to_red[j] = count > 0 ? sample_of<std::uint8_t>(sum_of(red_, j), count) : none;
      to_green[j] = count > 0 ? sample_of<std::uint8_t>(sum_of(green_, j), count) : none;
    }
  }

  /// Adds 64 pixels of a row to their columns, leaving out those without information.
  static void add(const std::uint8_t* __restrict from_red,
                  const std::uint8_t* __restrict from_green,
                  std::uint16_t* __restrict reds,
                  std::uint16_t* __restrict greens,
                  std::uint8_t* __restrict counts,
                  std::uint8_t* __restrict brights) {
    std::array<std::uint8_t, samples> keep;  // 255: carries information, else 0
    for (std::size_t i = 0; i < samples; ++i) {
      const auto top =
          static_cast<std::uint8_t>(-int((from_red[i] == 255) | (from_green[i] == 255)));
      const auto dark = static_cast<std::uint8_t>(-int((from_red[i] == 0) | (from_green[i] == 0)));
      brights[i] = static_cast<std::uint8_t>(brights[i] | top);
      keep[i] = static_cast<std::uint8_t>(~(top | dark));
    }
    for (std::size_t i = 0; i < samples; ++i) {
      reds[i] = static_cast<std::uint16_t>(reds[i] + (from_red[i] & keep[i]));
    }
    for (std::size_t i = 0; i < samples; ++i) {
      greens[i] = static_cast<std::uint16_t>(greens[i] + (from_green[i] & keep[i]));
    }
    for (std::size_t i = 0; i < samples; ++i) {
      counts[i] = static_cast<std::uint8_t>(counts[i] - keep[i]);  // 255 is -1
    }
  }

  /// Sum over the columns of sample j.
  template <class Cells>
  [[gnu::always_inline]] std::uint32_t sum_of(const Cells& cells, std::size_t j) const {
    if constexpr (Step > 0) {  // no loop, so that the one over the samples becomes vectors
      return [&]<std::size_t... K>(std::index_sequence<K...>) __attribute__((always_inline)) {
        return (std::uint32_t(0) + ... + std::uint32_t(cells[j * Step + K]));
      }
      (std::make_index_sequence<std::size_t(Step)>{});
    } else {
      return std::accumulate(&cells[j * step()], &cells[j * step()] + step(), std::uint32_t(0));
    }
  }

  int step_;
  std::array<std::uint16_t, pixels> red_, green_;  // sums of each column
  std::array<std::uint8_t, pixels> count_, bright_;
};

}  // namespace detail

/// Writes the samples of a frame: means over step x step pixels, leaving out pixels that carry no
/// information, in grey_scale_of<sample_t<Pixel>>(). If all are left out, the sample is the
/// brightest value if one is saturated, else NaN if one is NaN, else 0, and carries no information
/// either. False, and nothing written, for a step outside of 1..16 or where a grid has another
/// size. Allocates nothing; O(rows cols), fastest for 8-bit pixels and steps up to 4.
template <grid Red, grid Green, class Pixel = std::remove_cv_t<cell_t<Red>>>
bool sample_frame(const Red& red,
                  const Green& green,
                  int step,
                  const StridedView<sample_t<Pixel>>& to_red,
                  const StridedView<sample_t<Pixel>>& to_green) {
  const auto from_red = as_view(red);
  const auto from_green = as_view(green);
  const Index rows = to_red.rows(), cols = to_red.cols();
  if (step < 1 || step > 16 || !same_size(from_red, from_green) || !same_size(to_red, to_green) ||
      rows != from_red.rows() / step || cols != from_red.cols() / step) {
    return false;
  }
  Index done = 0;  // samples of each row
  if constexpr (std::same_as<Pixel, std::uint8_t>) {
    const auto blocks = [&]<int Step>(detail::SampleBlock<Step> block) {
      constexpr Index n = block.samples;
      const Index across = (cols + n - 1) / n;
      for (Index k = 0; k < rows * across; ++k) {
        const Index row = k / across, first = (std::min)(k % across * n, cols - n);  // some twice
        block(from_red, from_green, row * step, first * step, to_red.row(row) + first,
              to_green.row(row) + first);
      }
      done = cols;
    };
    constexpr Index least = detail::SampleBlock<0>::samples;
    if (cols >= least && to_red.col_stride() == 1 && to_green.col_stride() == 1) {
      step == 1   ? blocks(detail::SampleBlock<1>(step))
      : step == 2 ? blocks(detail::SampleBlock<2>(step))
      : step == 3 ? blocks(detail::SampleBlock<3>(step))
      : step == 4 ? blocks(detail::SampleBlock<4>(step))
                  : blocks(detail::SampleBlock<0>(step));
    }
  }
  for (Index k = 0; k < rows * (cols - done); ++k) {
    const Index i = k / (cols - done), j = done + k % (cols - done);
    std::tie(to_red(i, j), to_green(i, j)) =
        detail::one_sample<Pixel>(from_red, from_green, i * step, j * step, step);
  }
  return true;
}

}  // namespace v0
}  // namespace fingerpad
