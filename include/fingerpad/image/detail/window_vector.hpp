// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Window means of 8- and 16-bit images by vector instructions. See window_sums.hpp for the
// contract.
//
// Each row is cleaned (invalid pixels become 0) and replaced by its running sum, kept for as many
// rows as the largest window is high. A sum along a row is then one difference for any window
// width, and a sum over a window moves down by adding one such difference and subtracting another.
// Unsigned arithmetic wraps, so running sums may overflow: differences stay exact.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/detail/aligned_vector.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_rows.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// A block of neighbouring windows: their sums along a row, how many valid pixels they hold, and the
// factors of their sums.

enum class Cover : std::uint8_t {
  none,   ///< no window of the block holds a valid pixel
  cut,    ///< anything in between
  whole,  ///< every window holds nothing but valid pixels
};

#if defined(FINGERPAD_HAS_VECTORS)
/// Sums along one row over windows of 2 r + 1 columns: differences of its running sum.
template <class T>
struct AlongRow {
  const T *right, *left;
  AlongRow(const T* running, Index r) : right(running + r), left(running - r - 1) {}
  template <int N>
  [[gnu::always_inline]] lanes<T, N> at(Index j) const {
    return load<T, N>(right + j) - load<T, N>(left + j);
  }
};

/// 1 / n in float, NaN where n is 0.
template <int N>
[[gnu::always_inline]] inline lanes<float, N> reciprocal(lanes<std::uint32_t, N> n) {
  using Floats = lanes<float, N>;
  const Floats count = convert<float, N>(lanes<std::int32_t, N>(n));
  const Floats one = Floats{} + 1.0f;
  const auto empty = count < one;
  return choose(empty, Floats{} + not_a_number<float>(), one / choose(empty, one, count));
}

/// The cover of N windows with n of at most `full` valid pixels; if it is `cut`, `weight` is set to
/// 1 / n.
template <int N>
[[gnu::always_inline]] inline Cover weigh(lanes<std::uint16_t, N> n,
                                          lanes<std::uint16_t, N> full,
                                          float* weight) {
  if (all_zero<std::uint16_t, N>(n ^ full)) {
    return Cover::whole;
  }
  if (all_zero<std::uint16_t, N>(n)) {
    return Cover::none;
  }
  constexpr int half = N / 2;
  const auto counts = widen<std::uint32_t, half>(n);
  store(weight, reciprocal<half>(counts.first));
  store(weight + half, reciprocal<half>(counts.second));
  return Cover::cut;
}

template <class Pixel, int Windows, int Bytes>
class VectorWindowSums {
  static_assert(std::same_as<Pixel, std::uint8_t> || std::same_as<Pixel, std::uint16_t>);

 public:
  using Mean = float;

  VectorWindowSums(Index rows,
                   Index cols,
                   const std::array<int, std::size_t(Windows)>& window_px,
                   const ValueLimits<double>& limits,
                   float scale = 1)
      : rows_(rows),
        cols_(cols),
        radius_(window_radii<Windows>(window_px)),
        range_(limits),
        scale_(scale) {
    expects(rows >= 1, "WindowSums", "rows", rows, ">= 1");
    expects(cols >= 1, "WindowSums", "cols", cols, ">= 1");
    padded_ = (cols + 63) / 64 * 64;
    margin_ = (radius_.back() + 1 + 63) / 64 * 64;
    pitch_ = margin_ + padded_ + margin_ + 64;
    ring_rows_ = 2 * radius_.back() + 2;
    red_.assign(std::size_t(padded_), 0);
    green_.assign(std::size_t(padded_), 0);
    valid_.assign(std::size_t(padded_), 0);
    weight_.assign(std::size_t(padded_), 0.0f);
    cover_.assign(std::size_t(padded_ / half), Cover::none);
    const std::size_t ring = std::size_t(pitch_ * (ring_rows_ + 1));  // the last row remains zero
    red_ring_.assign(ring, 0);
    green_ring_.assign(ring, 0);
    valid_ring_.assign(ring, 0);
    for (Sums& sums : sums_) {
      sums.red.assign(std::size_t(padded_), 0);
      sums.green.assign(std::size_t(padded_), 0);
      sums.count.assign(std::size_t(padded_), 0);
    }
  }

  template <row_source<Pixel> Load>
  void start(Index first_row, Load&& load_row) {
    next_row_ = first_row;
    const Index r_max = radius_.back();
    for (Index row = first_row - r_max; row < first_row + r_max; ++row) {
      take_in(row, load_row);
    }
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      Sums& sums = sums_[k];
      std::fill(sums.red.begin(), sums.red.end(), 0u);
      std::fill(sums.green.begin(), sums.green.end(), 0u);
      std::fill(sums.count.begin(), sums.count.end(), std::uint16_t(0));
      for (Index row = first_row - radius_[k]; row < first_row + radius_[k]; ++row) {
        if (in_image(row)) {
          slide<false>(k, slot(row), zero_slot(), {});
        }
      }
    }
    began_ = first_row;
  }

  Index next_row() const { return next_row_; }

  template <row_source<Pixel> Load>
  void advance(Load&& load_row, const MeanRows<float> (&out)[std::size_t(Windows)]) {
    const Index row = next_row_++;
    take_in(row + radius_.back(), load_row);
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const Index in = row + radius_[k], past = row - radius_[k] - 1;
      slide<true>(k, in_image(in) ? slot(in) : zero_slot(),
                  row > began_ && in_image(past) ? slot(past) : zero_slot(), out[k]);
    }
  }

 private:
  /// Holds window sums along a row: up to 255 * 255 = 65025 for 8-bit pixels; 16-bit pixels need 32
  /// bits.
  using Lane = std::conditional_t<sizeof(Pixel) == 1, std::uint16_t, std::uint32_t>;
  struct Sums {
    aligned_vector<std::uint32_t> red, green;
    aligned_vector<std::uint16_t> count;
  };
  static constexpr int wide = Bytes / 4;  // lanes of sums and means
  static constexpr int half = Bytes / 2;  // lanes of counts: two vectors of sums
  using Floats = lanes<float, wide>;
  using Wide = lanes<std::uint32_t, wide>;

  bool in_image(Index row) const { return row >= 0 && row < rows_; }
  Index slot(Index row) const { return row % ring_rows_ * pitch_ + margin_; }
  Index zero_slot() const { return ring_rows_ * pitch_ + margin_; }

  template <class Load>
  void take_in(Index row, Load& load_row) {
    if (!in_image(row)) {
      return;
    }
    if constexpr (masked_row_source<Load, Pixel>) {
      load_row(row, red_.data(), green_.data(), valid_.data());
    } else {
      load_row(row, red_.data(), green_.data());
    }
    clean_row<masked_row_source<Load, Pixel>>();
    const Index to = slot(row), tail = radius_.back() + 1;
    running_sum_row<Bytes>(red_.data(), red_ring_.data() + to, padded_, tail);
    running_sum_row<Bytes>(green_.data(), green_ring_.data() + to, padded_, tail);
    running_sum_row<Bytes>(valid_.data(), valid_ring_.data() + to, padded_, tail);
  }

  /// Invalid pixels become 0 in both channels, and valid_ becomes 1 or 0.
  template <bool Masked>
  void clean_row() {
    constexpr int N = Bytes / int(sizeof(Pixel));
    using V = lanes<Pixel, N>;
    const V low = V{} + range_.low, high = V{} + range_.high;
    Pixel *const reds = red_.data(), *const greens = green_.data();
    std::uint8_t* const valids = valid_.data();
    for (Index j = 0, end = padded_; j < end; j += N) {
      const V red = load<Pixel, N>(reds + j), green = load<Pixel, N>(greens + j);
      V valid = V((red >= low) & (red <= high) & (green >= low) & (green <= high));
      if constexpr (Masked) {
        valid &= V(convert<Pixel, N>(load<std::uint8_t, N>(valids + j)) != V{});
      }
      store(reds + j, V(red & valid));
      store(greens + j, V(green & valid));
      store(valids + j, convert<std::uint8_t, N>(V(valid & (V{} + Pixel(1)))));
    }
    std::fill(red_.begin() + cols_, red_.end(), Pixel(0));
    std::fill(green_.begin() + cols_, green_.end(), Pixel(0));
    std::fill(valid_.begin() + cols_, valid_.end(), std::uint8_t(0));
  }

  /// Moves window k down by one row, from the ring rows at offsets `past` to `in`.
  template <bool Emit>
  void slide(std::size_t k, Index in, Index past, const MeanRows<float>& out) {
    slide_counts(k, in, past);
    const auto slide_both = [&]<bool Signed>(std::bool_constant<Signed>) {
      slide_sums<Emit, Signed>(k, red_ring_.data(), in, past, sums_[k].red.data(), out.red);
      if (k == 0) {
        slide_sums<Emit, Signed>(k, green_ring_.data(), in, past, sums_[k].green.data(), out.green);
      }
    };
    // Sums that fit a signed int are cheaper to convert: all sums of 8-bit pixels, and those of
    // 16-bit pixels in windows up to 181 x 181.
    if (sizeof(Pixel) == 1 || area(radius_[k]) <= 32767) {
      slide_both(std::true_type{});
    } else {
      slide_both(std::false_type{});
    }
  }

  void slide_counts(std::size_t k, Index in, Index past) {
    using Counts = lanes<std::uint16_t, half>;
    const Index r = radius_[k], cols = cols_;
    const AlongRow<std::uint8_t> entering(valid_ring_.data() + in, r);
    const AlongRow<std::uint8_t> leaving(valid_ring_.data() + past, r);
    const Counts full = Counts{} + std::uint16_t(area(r));
    std::uint16_t* const count = sums_[k].count.data();
    Cover* cover = cover_.data();
    float* const weight = weight_.data();
    for (Index j = 0; j < cols; j += Bytes) {
      const auto gain = widen<std::uint16_t, half>(entering.template at<Bytes>(j));
      const auto loss = widen<std::uint16_t, half>(leaving.template at<Bytes>(j));
      const Counts first = load<std::uint16_t, half>(count + j) + gain.first - loss.first;
      const Counts second = load<std::uint16_t, half>(count + j + half) + gain.second - loss.second;
      store(count + j, first);
      store(count + j + half, second);
      *cover++ = weigh<half>(first, full, weight + j);
      *cover++ = weigh<half>(second, full, weight + j + half);
    }
  }

  template <bool Emit, bool Signed>
  void slide_sums(
      std::size_t k, const Lane* ring, Index in, Index past, std::uint32_t* sum, float* mean) {
    const Index r = radius_[k], cols = cols_;
    const AlongRow<Lane> entering(ring + in, r), leaving(ring + past, r);
    const Cover* const cover = cover_.data();
    const float* const weight = weight_.data();
    const Floats missing = Floats{} + missing_;
    const Floats whole = Floats{} + scale_ / float(area(r));
    const auto step = [&](Index j, float* to) __attribute__((always_inline)) {
      const Cover c = cover[j / half];
      if (c == Cover::none) {
        store(sum + j, Wide{});
        store(sum + j + wide, Wide{});
        if constexpr (Emit) {
          store(to, missing);
          store(to + wide, missing);
        }
        return;
      }
      const Two<Floats> sums = slide_block<Signed>(entering, leaving, j, sum + j);
      if constexpr (!Emit) {
        return;
      }
      if (c == Cover::whole) {
        store(to, sums.first * whole);
        store(to + wide, sums.second * whole);
      } else {
        store(to, sums.first * (load<float, wide>(weight + j) * scale_));
        store(to + wide, sums.second * (load<float, wide>(weight + j + wide) * scale_));
      }
    };
    Index j = 0;
    for (; j + half <= cols; j += half) {
      step(j, Emit ? mean + j : nullptr);
    }
    if (j < cols) {
      float rest[std::size_t(half)];
      step(j, rest);
      if constexpr (Emit) {
        std::copy_n(rest, cols - j, mean + j);
      }
    }
  }

  /// Updates `half` sums and returns them as float, rounded once.
  template <bool Signed>
  [[gnu::always_inline]] static Two<Floats> slide_block(const AlongRow<Lane>& entering,
                                                        const AlongRow<Lane>& leaving,
                                                        Index j,
                                                        std::uint32_t* sum) {
    Wide first = load<std::uint32_t, wide>(sum), second = load<std::uint32_t, wide>(sum + wide);
    if constexpr (sizeof(Pixel) == 1) {
      const auto gain = widen<std::uint32_t, wide>(entering.template at<half>(j));
      const auto loss = widen<std::uint32_t, wide>(leaving.template at<half>(j));
      first += gain.first - loss.first;
      second += gain.second - loss.second;
    } else {
      first += entering.template at<wide>(j) - leaving.template at<wide>(j);
      second += entering.template at<wide>(j + wide) - leaving.template at<wide>(j + wide);
    }
    store(sum, first);
    store(sum + wide, second);
    if constexpr (Signed) {
      using Ints = lanes<std::int32_t, wide>;
      return {convert<float, wide>(Ints(first)), convert<float, wide>(Ints(second))};
    } else {
      return {convert<float, wide>(first), convert<float, wide>(second)};
    }
  }

  static int area(Index r) { return int((2 * r + 1) * (2 * r + 1)); }

  Index rows_, cols_;
  std::array<Index, std::size_t(Windows)> radius_;
  ClosedRange<Pixel> range_;
  float scale_;
  Index padded_ = 0, margin_ = 0, pitch_ = 0, ring_rows_ = 0;
  Index began_ = 0, next_row_ = 0;
  float missing_ = not_a_number<float>();  // a variable: GCC 12 builds a constant one lane by lane
  aligned_vector<Pixel> red_, green_;
  aligned_vector<Lane> red_ring_, green_ring_;
  aligned_vector<std::uint8_t> valid_, valid_ring_;
  std::array<Sums, std::size_t(Windows)> sums_;
  std::vector<Cover> cover_;
  aligned_vector<float> weight_;
};
#endif

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
