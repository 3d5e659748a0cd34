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
#include <cmath>
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
#include "fingerpad/depth/detail/frame_rows.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"
#include "fingerpad/image/detail/window_means.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The type in which samples are stored: 16 bit for 8-bit pixels, else the pixel's own type.
template <class Pixel>
using sample_t = std::conditional_t<std::same_as<Pixel, std::uint8_t>, std::uint16_t, Pixel>;

/// Where a position in pixels lies in samples, along one axis: pixel 0 is the first of sample 0.
template <scalar S>
S sampled_px(const S& px, int step) {
  return S((px - S(step - 1) / S(2)) / S(step));
}

/// The camera whose pixels are the samples.
template <scalar S>
Camera<S> sampled(const Camera<S>& camera, int step) {
  Camera<S> out = camera;
  out.center_x_px = sampled_px(camera.center_x_px, step);
  out.center_y_px = sampled_px(camera.center_y_px, step);
  out.pitch_mm = S(camera.pitch_mm * S(step));
  return out;
}

/// The free pad as that camera sees it. A sample is of the pad where all its pixels are. Refuses
/// steps outside of 1..16 and larger than the image (parameter_error).
template <scalar S, class Scattering, class Heights>
DepthReference<S, Scattering, Heights> sampled(
    const DepthReference<S, Scattering, Heights>& reference, int step) {
  expects(step >= 1 && step <= 16, "sampled", "step", step, "in 1..16");
  expects(step <= reference.rows && step <= reference.cols, "sampled", "step", step,
          "<= the rows and columns of the reference");
  auto out = reference;
  out.rows = reference.rows / step;
  out.cols = reference.cols / step;
  out.depth_mm.clear();
  out.scattering = reference.scattering.sampled(out.rows, out.cols, step);
  for (Index i = 0; i < out.rows; ++i) {
    for (Index j = 0; j < out.cols; ++j) {
      S sum = S(0);
      for (Index k = 0; k < step * step; ++k) {
        sum = sum + reference.depth(i * step + k / step, j * step + k % step);
      }
      out.depth_mm.push_back(S(sum / S(step * step)));
    }
  }
  return out;
}

/// Means over Step x Step pixels, leaving out pixels that carry no information, in
/// grey_scale_of<sample_t<Pixel>>(). If all are left out, the sample is the brightest value if one
/// is saturated, else NaN if one is NaN, else 0, and carries no information either. No allocation
/// per frame; O(rows cols).
template <class Pixel, int Step>
class FrameSampler {
  static_assert(Step >= 1 && Step <= 16, "the sampling step is in 1..16");

 public:
  using Sample = sample_t<Pixel>;
  /// Step rows of both channels; one per thread.
  using Workspace = std::vector<Pixel>;

  /// For frames of so many columns, or fewer.
  static Workspace workspace(Index cols) {
    return Workspace(static_cast<std::size_t>(2 * Step * cols));
  }

  /// Rows [first, last) of the samples of a frame; false, and nothing written, where grids or
  /// workspace have another size.
  template <grid Red, grid Green>
  static bool band(Index first,
                   Index last,
                   const Red& red,
                   const Green& green,
                   const StridedView<Sample>& to_red,
                   const StridedView<Sample>& to_green,
                   Workspace& workspace) {
    const auto from_red = as_view(red);
    const auto from_green = as_view(green);
    const Index cols = from_red.cols();
    if (!same_size(from_red, from_green) || !same_size(to_red, to_green) ||
        to_red.rows() != from_red.rows() / Step || to_red.cols() != cols / Step || first < 0 ||
        last < first || last > to_red.rows() ||
        workspace.size() < static_cast<std::size_t>(2 * Step * cols)) {
      return false;
    }
    for (Index i = first; i < last; ++i) {
      if constexpr (detail::plain_rows<std::remove_const_t<decltype(from_red)>, Pixel> &&
                    detail::plain_rows<std::remove_const_t<decltype(from_green)>, Pixel>) {
        if (from_red.col_stride() == 1 && from_green.col_stride() == 1 &&
            from_red.row_stride() == from_green.row_stride()) {
          FrameSampler(from_red.row(i * Step), from_green.row(i * Step), from_red.row_stride())
              .average(to_red, to_green, i);
          continue;
        }
      }
      Pixel* reds = workspace.data();
      Pixel* greens = reds + Step * cols;
      for (Index k = 0; k < Step; ++k) {
        detail::load_pixels(from_red, from_green, i * Step + k, reds + k * cols, greens + k * cols);
      }
      FrameSampler(reds, greens, cols).average(to_red, to_green, i);
    }
    return true;
  }

 private:
  static constexpr GreyScale scale = grey_scale_of<Pixel>();
  static constexpr bool by_vectors = std::same_as<Pixel, std::uint8_t> &&
                                     (Step == 2 || Step == 3 || Step == 4) &&
                                     detail::native_vector_bytes > 0;
  /// Bytes of a vector: short ones where three are worked on at once.
  static constexpr int width = (std::min)(Step == 3 ? 16 : 64, detail::native_vector_bytes);
  static constexpr Index samples_at_once = Step == 3 ? width : width / Step;

  /// Step rows of each channel, `stride` pixels apart.
  FrameSampler(const Pixel* red, const Pixel* green, Index stride)
      : red_(red), green_(green), stride_(stride) {}

  void average(const StridedView<Sample>& to_red,
               const StridedView<Sample>& to_green,
               Index row) const {
    const Index cols = to_red.cols();
    Index j = 0;
    if constexpr (by_vectors) {
      constexpr Index n = samples_at_once;
      if (to_red.col_stride() == 1 && to_green.col_stride() == 1 && cols >= n) {
        for (; j < cols; j += n) {
          const Index from = (std::min)(j, cols - n);  // the last ones twice
          several(from, to_red.row(row) + from, to_green.row(row) + from);
        }
      }
    }
    for (; j < cols; ++j) {
      one(j, to_red(row, j), to_green(row, j));
    }
  }

  void one(Index col, Sample& to_red, Sample& to_green) const {
    using Sum = std::conditional_t<std::integral<Pixel>, std::uint32_t, Pixel>;
    Sum red = Sum(0);
    Sum green = Sum(0);
    int count = 0;
    bool saturated = false;
    bool no_number = false;
    for (Index k = 0; k < Step * Step; ++k) {
      const Index at = k / Step * stride_ + col * Step + k % Step;
      const auto r = static_cast<double>(value(real_of_t<Pixel>(red_[at])));
      const auto g = static_cast<double>(value(real_of_t<Pixel>(green_[at])));
      saturated = saturated || r >= scale.saturated || g >= scale.saturated;
      no_number = no_number || r != r || g != g;
      if (r > scale.dark && g > scale.dark && r < scale.saturated && g < scale.saturated) {
        ++count;
        red = Sum(red + Sum(red_[at]));
        green = Sum(green + Sum(green_[at]));
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

#if defined(FINGERPAD_HAS_VECTORS)
  using Bytes = detail::lanes<std::uint8_t, width>;

  /// A vector of pixels: those that carry information, else 0, and which do not.
  struct Block {
    Bytes red, green, bright, bad;
  };
  [[gnu::always_inline]] Block block(Index row, Index col) const {
    const Index at = row * stride_ + col;
    // The next row of samples: a new frame is not in the cache yet, and processors do not see that
    // several rows are read at once.
    __builtin_prefetch(red_ + at + Step * stride_);
    __builtin_prefetch(green_ + at + Step * stride_);
    const Bytes r = detail::load<std::uint8_t, width>(red_ + at);
    const Bytes g = detail::load<std::uint8_t, width>(green_ + at);
    const Bytes top = Bytes{} + std::uint8_t(255);
    const Bytes bright = Bytes((r == top) | (g == top));
    const Bytes bad = Bytes((r == Bytes{}) | (g == Bytes{})) | bright;
    return {Bytes(r & ~bad), Bytes(g & ~bad), bright, bad};
  }

  /// The samples that a vector of pixels holds, from column `col` on.
  void several(Index col, Sample* to_red, Sample* to_green) const requires(Step != 3) {
    constexpr int n = width / 2;
    using Pairs = detail::lanes<std::uint16_t, n>;
    const auto pairs = [](const Bytes& pixels) __attribute__((always_inline)) {
      const auto both = detail::unzip_wide<std::uint16_t, n>(pixels);
      return Pairs(both.first + both.second);
    };
    Bytes bad{}, bright{}, bad_rows{};
    Pairs red{}, green{};
    for (Index k = 0; k < Step; ++k) {
      const Block b = block(k, col * Step);
      bright |= b.bright;
      bad |= b.bad;
      bad_rows -= b.bad;  // 255 is -1
      red += pairs(b.red);
      green += pairs(b.green);
    }
    if (!detail::any_lane(bad)) {
      store_means(red, to_red);
      store_means(green, to_green);
      return;
    }
    const Pairs count = Pairs{} + std::uint16_t(2 * Step) - pairs(bad_rows);
    const Pairs told = pairs(bright & (Bytes{} + std::uint8_t(1)));
    std::array<std::uint16_t, std::size_t(n)> reds, greens, counts, brights;
    detail::store(reds.data(), red);
    detail::store(greens.data(), green);
    detail::store(counts.data(), count);
    detail::store(brights.data(), told);
    for (std::size_t k = 0; k < std::size_t(samples_at_once); ++k) {
      set_sample<Step / 2>(k, reds, greens, counts, brights, to_red, to_green);
    }
  }

  /// The samples that three vectors hold.
  void several(Index col, Sample* to_red, Sample* to_green) const requires(Step == 3) {
    using Words = detail::lanes<std::uint16_t, width / 2>;
    using ColumnSums = std::array<std::uint16_t, std::size_t(3 * width)>;
    alignas(Bytes) ColumnSums reds, greens, counts, brights;
    Bytes bad{};
    const auto keep =
        [](const detail::Two<Words>& sums, std::uint16_t* to) __attribute__((always_inline)) {
      detail::store(to, sums.first);
      detail::store(to + width / 2, sums.second);
    };
    for (int part = 0; part < 3; ++part) {
      detail::Two<Words> red{}, green{};
      Bytes bright{}, count{};
      for (Index k = 0; k < 3; ++k) {
        const Block b = block(k, col * 3 + part * width);
        bright |= b.bright;
        bad |= b.bad;
        count -= Bytes(~b.bad);
        const auto r = detail::widen<std::uint16_t, width / 2>(b.red);
        const auto g = detail::widen<std::uint16_t, width / 2>(b.green);
        red.first += r.first;
        red.second += r.second;
        green.first += g.first;
        green.second += g.second;
      }
      keep(red, reds.data() + part * width);
      keep(green, greens.data() + part * width);
      keep(detail::widen<std::uint16_t, width / 2>(count), counts.data() + part * width);
      keep(detail::widen<std::uint16_t, width / 2>(bright), brights.data() + part * width);
    }
    if (!detail::any_lane(bad)) {
      for (std::size_t k = 0; k < std::size_t(width); ++k) {
        to_red[k] = mean(sum_of<3>(reds, k), 9);
        to_green[k] = mean(sum_of<3>(greens, k), 9);
      }
      return;
    }
    for (std::size_t k = 0; k < std::size_t(width); ++k) {
      set_sample<3>(k, reds, greens, counts, brights, to_red, to_green);
    }
  }

  template <std::size_t Parts, class Sums>
  static std::uint32_t sum_of(const Sums& sums, std::size_t sample) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < Parts; ++k) {
      sum += sums[Parts * sample + k];
    }
    return sum;
  }
  /// A sample some of whose pixels may carry no information, from the sums over its parts.
  template <std::size_t Parts, class Sums>
  static void set_sample(std::size_t k,
                         const Sums& reds,
                         const Sums& greens,
                         const Sums& counts,
                         const Sums& brights,
                         Sample* to_red,
                         Sample* to_green) {
    const auto count = static_cast<int>(sum_of<Parts>(counts, k));
    const Sample none = sum_of<Parts>(brights, k) > 0 ? Sample(255 * 256) : Sample(0);
    to_red[k] = count > 0 ? mean(sum_of<Parts>(reds, k), count) : none;
    to_green[k] = count > 0 ? mean(sum_of<Parts>(greens, k), count) : none;
  }

  /// Of samples all of whose pixels carry information.
  template <class Pairs>
  [[gnu::always_inline]] static void store_means(const Pairs& sums, Sample* to) {
    if constexpr (Step == 2) {
      detail::store(to, Pairs(sums << 6));
    } else {
      constexpr int n = width / Step;
      const auto both = detail::unzip_wide<std::uint32_t, n>(sums);
      detail::store(to, detail::convert<std::uint16_t, n>(
                            detail::lanes<std::uint32_t, n>((both.first + both.second) << 4)));
    }
  }
#endif

  const Pixel* red_;
  const Pixel* green_;
  Index stride_;
};

/// Depth of every pixel from the depth of samples: the difference from the free pad is interpolated
/// bilinearly and added to the free pad. Beside missing samples it is extrapolated from the other
/// side. A pixel has no depth if its own sample has none, except at the pad's rim, where a sample
/// may hold only some pixels. `free` and `free_samples` are the reference and sampled() of it; the
/// other grids have their sizes. O(rows cols).
template <class Reference, class S>
void depth_between_samples(const Reference& free,
                           const Reference& free_samples,
                           int step,
                           const StridedView<const S>& samples_mm,
                           const StridedView<const PixelStatus>& sample_status,
                           const StridedView<S>& depth_mm,
                           const StridedView<PixelStatus>& status) {
  const auto own = [step](Index px, Index count) { return (std::min)(px / step, count - 1); };
  const auto place = [step](Index px, Index count) {  // the sample before, and how far behind it
    const double at = sampled_px(static_cast<double>(px), step);
    const double last = static_cast<double>(count - 2);
    const double before = (std::max)(0.0, (std::min)(std::floor(at), last));
    return std::pair(static_cast<Index>(before), S(at - before));
  };
  const auto moved = [&](Index i, Index j) {
    return S(samples_mm(i, j) - S(free_samples.depth(i, j)));
  };
  const auto between = [&](Index i, Index j, const S& down, const S& right) {
    const S up = moved(i, j) + right * (moved(i, j + 1) - moved(i, j));
    const S low = moved(i + 1, j) + right * (moved(i + 1, j + 1) - moved(i + 1, j));
    return S(up + down * (low - up));
  };
  const auto beside = [&](Index i, Index j, const S& down, const S& right) {
    for (const Index di : {0, -1, 1}) {
      for (const Index dj : {0, -1, 1}) {
        const Index r = i + di, c = j + dj;
        if (r >= 0 && c >= 0 && r + 1 < samples_mm.rows() && c + 1 < samples_mm.cols()) {
          const S found = between(r, c, S(down - S(static_cast<double>(di))),
                                  S(right - S(static_cast<double>(dj))));
          if (found == found) {
            return found;
          }
        }
      }
    }
    return not_a_number<S>();
  };
  for (Index i = 0; i < depth_mm.rows(); ++i) {
    const auto [row, down] = place(i, samples_mm.rows());
    for (Index j = 0; j < depth_mm.cols(); ++j) {
      const auto [col, right] = place(j, samples_mm.cols());
      PixelStatus of = sample_status(own(i, samples_mm.rows()), own(j, samples_mm.cols()));
      S depth = not_a_number<S>();
      if (!free.in_pad(i, j)) {
        of = PixelStatus::outside_pad;
      } else if (of == PixelStatus::ok || of == PixelStatus::outside_pad) {
        const S known = between(row, col, down, right);
        depth = S(free.depth(i, j)) + (known == known ? known : beside(row, col, down, right));
        of = depth == depth ? PixelStatus::ok : PixelStatus::not_a_number;
      }
      depth_mm(i, j) = depth;
      status(i, j) = of;
    }
  }
}

}  // namespace v0
}  // namespace fingerpad
