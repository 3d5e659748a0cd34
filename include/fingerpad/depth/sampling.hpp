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

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/frame_rows.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"
#include "fingerpad/image/detail/window_rows.hpp"
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

  /// For frames of so many columns.
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
        workspace.size() != static_cast<std::size_t>(2 * Step * cols)) {
      return false;
    }
    for (Index i = first; i < last; ++i) {
      if constexpr (detail::plain_rows<decltype(from_red), Pixel> &&
                    detail::plain_rows<decltype(from_green), Pixel>) {
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
  /// Bytes of a vector. Short ones, the more so where three are worked on at once: fewer of them
  /// hold a pixel without information, for which all their samples are done one by one.
  static constexpr int width = (std::min)(Step == 3 ? 16 : 32, detail::native_vector_bytes);
  static constexpr Index samples_at_once = Step == 3 ? width : width / Step;

  /// Step rows of each channel, `stride` pixels apart.
  FrameSampler(const Pixel* red, const Pixel* green, Index stride)
      : red_(red), green_(green), stride_(stride) {}

  void average(const StridedView<Sample>& to_red,
               const StridedView<Sample>& to_green,
               Index row) const {
    Index j = 0;
    const auto upto = [&](Index last) {
      for (; j < last; ++j) {
        one(j, to_red(row, j), to_green(row, j));
      }
    };
    if constexpr (by_vectors) {
      constexpr Index n = samples_at_once;
      while (to_red.col_stride() == 1 && to_green.col_stride() == 1 && j + n <= to_red.cols()) {
        if (several(j, to_red.row(row) + j, to_green.row(row) + j)) {
          j += n;
        } else {
          upto(j + n);
        }
      }
    }
    upto(to_red.cols());
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
  /// The samples that a vector of pixels holds, from column `col` on; false, and nothing written,
  /// where pixels of a sample differ in whether they carry information.
  bool several(Index col, Sample* to_red, Sample* to_green) const requires(Step != 3) {
    using Bytes = detail::lanes<std::uint8_t, width>;
    using Word = std::conditional_t<Step == 2, std::uint16_t, std::uint32_t>;  // one a sample
    using Words = detail::lanes<Word, width / Step>;
    using Pairs = detail::lanes<std::uint16_t, width / 2>;
    Bytes bad{}, all_bad = ~bad, bright{};
    Pairs red{}, green{};
    const Bytes top = Bytes{} + std::uint8_t(255);
    for (Index k = 0; k < Step; ++k) {
      const Index at = k * stride_ + col * Step;
      const Bytes r = detail::load<std::uint8_t, width>(red_ + at);
      const Bytes g = detail::load<std::uint8_t, width>(green_ + at);
      const Bytes bright_here = Bytes((r == top) | (g == top));
      const Bytes bad_here = Bytes((r == Bytes{}) | (g == Bytes{})) | bright_here;
      bright |= bright_here;
      bad |= bad_here;
      all_bad &= bad_here;
      const auto of_red = detail::unzip_wide<std::uint16_t, width / 2>(r);
      const auto of_green = detail::unzip_wide<std::uint16_t, width / 2>(g);
      red += of_red.first + of_red.second;
      green += of_green.first + of_green.second;
    }
    const Words none = Words(Words(all_bad) == ~Words{});
    if (detail::any_lane(Words(none ^ Words(Words(bad) != Words{})))) {
      return false;
    }
    const Words told = Words(Words(bright) != Words{}) & (Words{} + Word(255 * 256));
    store_means(red, none, told, to_red);
    store_means(green, none, told, to_green);
    return true;
  }

  /// The samples that three vectors hold; false where a pixel carries no information but for
  /// samples that are all dark.
  bool several(Index col, Sample* to_red, Sample* to_green) const requires(Step == 3) {
    using Bytes = detail::lanes<std::uint8_t, width>;
    using Words = detail::lanes<std::uint16_t, width / 2>;
    using ColumnSums = std::array<std::uint16_t, std::size_t(3 * width)>;
    alignas(Bytes) ColumnSums red, green;
    Bytes bad{}, all_bad = ~bad, bright{};
    const Bytes top = Bytes{} + std::uint8_t(255);
    for (int part = 0; part < 3; ++part) {
      detail::Two<Words> reds{}, greens{};
      for (Index k = 0; k < 3; ++k) {
        const Index at = k * stride_ + col * 3 + part * width;
        const Bytes r = detail::load<std::uint8_t, width>(red_ + at);
        const Bytes g = detail::load<std::uint8_t, width>(green_ + at);
        const Bytes bright_here = Bytes((r == top) | (g == top));
        const Bytes bad_here = Bytes((r == Bytes{}) | (g == Bytes{})) | bright_here;
        bright |= bright_here;
        bad |= bad_here;
        all_bad &= bad_here;
        add(r, reds);
        add(g, greens);
      }
      store(reds, red.data() + part * width);
      store(greens, green.data() + part * width);
    }
    if (!detail::any_lane(bad)) {
      for (int k = 0; k < width; ++k) {
        to_red[k] = mean_of_columns(&red[static_cast<std::size_t>(3 * k)]);
        to_green[k] = mean_of_columns(&green[static_cast<std::size_t>(3 * k)]);
      }
      return true;
    }
    if (detail::any_lane(Bytes(~all_bad | bright))) {
      return false;
    }
    std::fill(to_red, to_red + width, Sample(0));
    std::fill(to_green, to_green + width, Sample(0));
    return true;
  }

  template <class Bytes, class Words>
  [[gnu::always_inline]] static void add(const Bytes& pixels, detail::Two<Words>& sums) {
    const auto wide = detail::widen<std::uint16_t, width / 2>(pixels);
    sums.first += wide.first;
    sums.second += wide.second;
  }
  template <class Words>
  [[gnu::always_inline]] static void store(const detail::Two<Words>& sums, std::uint16_t* to) {
    detail::store(to, sums.first);
    detail::store(to + width / 2, sums.second);
  }
  static Sample mean_of_columns(const std::uint16_t* sums) {
    return mean(static_cast<std::uint32_t>(sums[0] + sums[1] + sums[2]), Step * Step);
  }

  template <class Pairs, class Words>
  [[gnu::always_inline]] static void store_means(const Pairs& sums,
                                                 const Words& none,
                                                 const Words& told,
                                                 Sample* to) {
    constexpr int n = width / Step;
    if constexpr (Step == 2) {
      detail::store(to, Words(((sums << 6) & ~none) | told));
    } else {
      const auto both = detail::unzip_wide<std::uint32_t, n>(sums);
      const Words mean = (((both.first + both.second) << 4) & ~none) | told;
      detail::store(to, detail::convert<std::uint16_t, n>(mean));
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
