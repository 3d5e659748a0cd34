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
inline namespace v1 {

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
  out.green = means_of(reference.green);
  return out;
}

namespace detail {

/// 64 samples of a row, with loops whose length the compiler knows. Step 0: any step.
template <class Pixel, int Step>
class SampleBlock {
 public:
  static constexpr std::size_t samples = 64;

  explicit SampleBlock(int step) : step_(Step > 0 ? Step : step) {}

  /// Takes in the samples from (row, col) of the frame on, `n` pixels wide.
  template <class Red, class Green>
  void read(const Red& red, const Green& green, Index row, Index col, Index n) {
    if (Step == 0) {
      red_ = green_ = {};
      count_ = bright_ = {};
    }
    for (Index k = 0; k < step(); k += Index(rows)) {
      for (std::size_t i = 0; i < rows; ++i) {
        load_pixels(red, green, row + k + Index(i), col, n, &reds_[i * pixels],
                    &greens_[i * pixels]);
      }
      for (std::size_t at = 0; at < samples * across(); at += samples) {
        add(&reds_[at], &greens_[at], &red_[at], &green_[at], &count_[at], &bright_[at]);
      }
    }
  }

  /// Writes `samples` samples of both channels.
  void write(std::uint16_t* to_red, std::uint16_t* to_green) const {
    std::uint64_t lost = 0;
    for (std::size_t k = 0; k < samples * across(); k += 8) {
      lost |= load<std::uint64_t>(&count_[k]) ^ (0x0101010101010101U * across());
    }
    if (lost == 0) {
      whole(red_.data(), step(), to_red);
      whole(green_.data(), step(), to_green);
      return;
    }
    const auto all = static_cast<std::uint32_t>(step() * step());
    for (std::size_t j = 0; j < samples; ++j) {
      const std::uint32_t count = sum_of(count_.data(), j, step());
      if (count == 0) {
        to_red[j] = to_green[j] = sum_of(bright_.data(), j, step()) > 0
                                      ? std::uint16_t(grey_scale_of<std::uint16_t>().saturated)
                                      : std::uint16_t(0);
        continue;
      }
      const std::uint32_t red = sum_of(red_.data(), j, step());
      const std::uint32_t green = sum_of(green_.data(), j, step());
      to_red[j] = count == all ? mean(red, all) : mean(red, count);
      to_green[j] = count == all ? mean(green, all) : mean(green, count);
    }
  }

 private:
  static constexpr std::size_t pixels = samples * (Step > 0 ? Step : 16);
  static constexpr std::size_t rows = Step > 0 ? Step : 1;  // read at once
  using Column = std::conditional_t<sizeof(Pixel) == 1, std::uint16_t, std::uint32_t>;

  constexpr int step() const { return Step > 0 ? Step : step_; }
  constexpr std::size_t across() const { return static_cast<std::size_t>(step()); }

  static std::uint16_t mean(std::uint32_t sum, std::uint32_t count) {
    constexpr std::uint32_t units = sizeof(Pixel) == 1 ? 256 : 1;
    return static_cast<std::uint16_t>((sum * units + count / 2) / count);
  }

  /// Adds 64 pixels of some rows to their columns, leaving out those without information.
  [[gnu::noinline]] static void add(const Pixel* __restrict reds,
                                    const Pixel* __restrict greens,
                                    Column* __restrict red_sums,
                                    Column* __restrict green_sums,
                                    std::uint8_t* __restrict counts,
                                    std::uint8_t* __restrict brights) {
    constexpr auto top = static_cast<Pixel>(grey_scale_of<Pixel>().saturated), dark = Pixel(0);
    for (std::size_t i = 0; i < samples; ++i) {
      Column red = Step > 0 ? Column(0) : red_sums[i], green = Step > 0 ? Column(0) : green_sums[i];
      std::uint8_t count = Step > 0 ? std::uint8_t(0) : counts[i];
      std::uint8_t any_bright = Step > 0 ? std::uint8_t(0) : brights[i];
      [&]<std::size_t... K>(std::index_sequence<K...>) __attribute__((always_inline)) {
        const auto one = [&](Pixel r, Pixel g) __attribute__((always_inline)) {
          const auto bright = static_cast<Pixel>(-int((r >= top) | (g >= top)));
          const auto black = static_cast<Pixel>(-int((r <= dark) | (g <= dark)));
          const auto keep = static_cast<Pixel>(~(bright | black));  // all bits, or none
          any_bright = static_cast<std::uint8_t>(any_bright | (bright & 1));
          count = static_cast<std::uint8_t>(count + (keep & 1));
          red = static_cast<Column>(red + static_cast<Column>(r & keep));
          green = static_cast<Column>(green + static_cast<Column>(g & keep));
        };
        (one(reds[K * pixels + i], greens[K * pixels + i]), ...);
      }
      (std::make_index_sequence<rows>{});
      red_sums[i] = red;
      green_sums[i] = green;
      counts[i] = count;
      brights[i] = any_bright;
    }
  }

  /// Means of samples all of whose pixels count: a constant divisor needs no division.
  [[gnu::noinline]] static void whole(const Column* __restrict sums,
                                      int step,
                                      std::uint16_t* __restrict to) {
    const auto all = static_cast<std::uint32_t>(Step > 0 ? Step * Step : step * step);
    for (std::size_t j = 0; j < samples; ++j) {
      to[j] = mean(sum_of(sums, j, step), all);
    }
  }

  /// Sum over the columns of sample j.
  template <class Cell>
  [[gnu::always_inline]] static std::uint32_t sum_of(const Cell* cells, std::size_t j, int step) {
    if constexpr (Step > 0) {  // no loop, so that the one over the samples becomes vectors
      return [&]<std::size_t... K>(std::index_sequence<K...>) __attribute__((always_inline)) {
        return (std::uint32_t(0) + ... + std::uint32_t(cells[j * std::size_t(Step) + K]));
      }
      (std::make_index_sequence<std::size_t(Step)>{});
    } else {
      cells += j * static_cast<std::size_t>(step);
      return std::accumulate(cells, cells + step, std::uint32_t(0));
    }
  }

  int step_;
  std::array<Pixel, (rows * pixels)> reds_ = {}, greens_ = {};  // zeros beyond a narrow frame
  std::array<Column, pixels> red_, green_;                      // sums of each column
  std::array<std::uint8_t, pixels> count_, bright_;  // pixels that count; whether any is too bright
};

}  // namespace detail

/// Writes the samples of a frame of 8 or 16 bit, in 16 bit: means over step x step pixels, leaving
/// out pixels that carry no information. If all are left out, the sample is saturated if one of
/// them is, else 0, and carries no information either. False, and nothing written, for a step
/// outside of 1..16 or where a grid has another size. Allocates nothing; O(rows cols), fastest for
/// 8-bit pixels and steps up to 4.
template <grid Red, grid Green, class Pixel = std::remove_cv_t<cell_t<Red>>>
bool sample_frame(const Red& red,
                  const Green& green,
                  int step,
                  const StridedView<std::uint16_t>& to_red,
                  const StridedView<std::uint16_t>& to_green) {
  static_assert(std::same_as<Pixel, std::uint8_t> || std::same_as<Pixel, std::uint16_t>,
                "a frame has cells of 8 or 16 bit; for others use DepthEstimator");
  const auto from_red = as_view(red);
  const auto from_green = as_view(green);
  const Index rows = to_red.rows(), cols = to_red.cols();
  if (step < 1 || step > 16 || !same_size(from_red, from_green) || !same_size(to_red, to_green) ||
      rows != from_red.rows() / step || cols != from_red.cols() / step) {
    return false;
  }
  const bool in_place = to_red.col_stride() == 1 && to_green.col_stride() == 1;
  const auto sample = [&]<int Step>(detail::SampleBlock<Pixel, Step> block) {
    constexpr Index size = block.samples;
    const Index blocks = (cols + size - 1) / size, n = (std::min)(size, cols);
    for (Index k = 0; k < rows * blocks; ++k) {
      const Index i = k / blocks, first = (std::min)(k % blocks * size, cols - n);  // some twice
      block.read(from_red, from_green, i * step, first * step, n * step);
      if (in_place && n == size) {
        block.write(&to_red(i, first), &to_green(i, first));
        continue;
      }
      std::array<std::uint16_t, block.samples> reds, greens;
      block.write(reds.data(), greens.data());
      for (Index j = 0; j < n; ++j) {
        to_red(i, first + j) = reds[static_cast<std::size_t>(j)];
        to_green(i, first + j) = greens[static_cast<std::size_t>(j)];
      }
    }
  };
  step == 1   ? sample(detail::SampleBlock<Pixel, 1>(step))
  : step == 2 ? sample(detail::SampleBlock<Pixel, 2>(step))
  : step == 3 ? sample(detail::SampleBlock<Pixel, 3>(step))
  : step == 4 ? sample(detail::SampleBlock<Pixel, 4>(step))
              : sample(detail::SampleBlock<Pixel, 0>(step));
  return true;
}

}  // namespace v1
}  // namespace fingerpad
