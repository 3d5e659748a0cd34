// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Window means of 8- and 16-bit images by vector instructions. See window_sums.hpp for the contract.
//
// Each row is cleaned (invalid pixels become 0) and replaced by its running sum, kept for as many
// rows as the largest window is high. A sum along the row is then one difference, whatever the
// window, and a sum over the window moves down by adding one such difference and taking off
// another. Unsigned arithmetic wraps, so running sums may overflow: differences stay exact.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <vector>

#include "fingerpad/detail/window_lanes.hpp"
#include "fingerpad/detail/window_rows.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Memory that begins on a cache line, so that aligned vectors never straddle two.
template <class T>
struct LineAllocator {
  using value_type = T;
  static constexpr std::align_val_t line{64};
  LineAllocator() = default;
  template <class U>
  constexpr LineAllocator(const LineAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), line)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, line); }
  friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};
template <class T>
using line_vector = std::vector<T, LineAllocator<T>>;

template <class Pixel, int Windows, int Bytes>
class VectorWindowSums {
  static_assert(std::same_as<Pixel, std::uint8_t> || std::same_as<Pixel, std::uint16_t>);

 public:
  using Mean = float;

  VectorWindowSums(Index rows,
                   Index cols,
                   const std::array<int, std::size_t(Windows)>& window_px,
                   const ValueLimits<double>& limits)
      : rows_(rows), cols_(cols), radius_(window_radii<Windows>(window_px)), range_(limits) {
    expects(rows >= 1, "WindowSums", "rows", rows, ">= 1");
    expects(cols >= 1, "WindowSums", "cols", cols, ">= 1");
    padded_ = (cols + 63) / 64 * 64;
    margin_ = (radius_.back() + 1 + 63) / 64 * 64;
    pitch_ = margin_ + padded_ + margin_ + 64;
    ring_rows_ = 2 * radius_.back() + 2;
    red_.assign(std::size_t(padded_), 0);
    green_.assign(std::size_t(padded_), 0);
    valid_.assign(std::size_t(padded_), 0);
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
    for (Index row = first_row - r_max; row < first_row + r_max; ++row) take_in(row, load_row);
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      Sums& sums = sums_[k];
      std::fill(sums.red.begin(), sums.red.end(), 0u);
      std::fill(sums.green.begin(), sums.green.end(), 0u);
      std::fill(sums.count.begin(), sums.count.end(), std::uint16_t(0));
      for (Index row = first_row - radius_[k]; row < first_row + radius_[k]; ++row) {
        if (in_image(row)) slide<false>(k, slot(row), zero_slot(), {});
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
  /// Holds window sums of a row: 255 * 255 = 65025 for 8 bits, all of 32 bits for 16.
  using Lane = std::conditional_t<sizeof(Pixel) == 1, std::uint16_t, std::uint32_t>;
  struct Sums {
    line_vector<std::uint32_t> red, green;
    line_vector<std::uint16_t> count;
  };
  static constexpr int block = Bytes / 2;     // columns done at once: one vector of counts
  static constexpr int sum_lanes = Bytes / 4;  // two vectors of sums

  bool in_image(Index row) const { return row >= 0 && row < rows_; }
  Index slot(Index row) const { return row % ring_rows_ * pitch_ + margin_; }
  Index zero_slot() const { return ring_rows_ * pitch_ + margin_; }

  template <class Load>
  void take_in(Index row, Load& load_row) {
    if (!in_image(row)) return;
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
    for (Index j = 0; j < padded_; j += N) {
      const V red = load<Pixel, N>(red_.data() + j), green = load<Pixel, N>(green_.data() + j);
      V valid = V((red >= low) & (red <= high) & (green >= low) & (green <= high));
      if constexpr (Masked) {
        valid &= V(convert<Pixel, N>(load<std::uint8_t, N>(valid_.data() + j)) != V{});
      }
      store(red_.data() + j, V(red & valid));
      store(green_.data() + j, V(green & valid));
      store(valid_.data() + j, convert<std::uint8_t, N>(V(valid & (V{} + Pixel(1)))));
    }
    std::fill(red_.begin() + cols_, red_.end(), Pixel(0));
    std::fill(green_.begin() + cols_, green_.end(), Pixel(0));
    std::fill(valid_.begin() + cols_, valid_.end(), std::uint8_t(0));
  }

  /// Sums of `N` windows of one row that begin at `from`: differences of its running sum.
  template <int N, class T>
  static lanes<T, N> along_row(const T* from, Index r) {
    return load<T, N>(from + r) - load<T, N>(from - r - 1);
  }

  /// Moves window k down by one row, from the ring rows at offsets `past` to `in`.
  template <bool Emit>
  void slide(std::size_t k, Index in, Index past, const MeanRows<float>& out) {
    const Index r = radius_[k];
    const int area = int((2 * r + 1) * (2 * r + 1));
    using Counts = lanes<std::uint16_t, block>;
    const Counts full = Counts{} + std::uint16_t(area);
    Sums& sums = sums_[k];
    for (Index j = 0; j < cols_; j += block) {
      Counts count = load<std::uint16_t, block>(sums.count.data() + j);
      count += convert<std::uint16_t, block>(along_row<block>(valid_ring_.data() + in + j, r));
      count -= convert<std::uint16_t, block>(along_row<block>(valid_ring_.data() + past + j, r));
      store(sums.count.data() + j, count);
      slide_sums(red_ring_.data() + j, in, past, r, sums.red.data() + j);
      slide_sums(green_ring_.data() + j, in, past, r, sums.green.data() + j);
      if constexpr (Emit) {
        if (j + block > cols_) {
          emit_rest(sums, j, area, out);
        } else if (all_zero<std::uint16_t, block>(count ^ full)) {
          emit_whole(sums.red.data() + j, area, out.red + j);
          emit_whole(sums.green.data() + j, area, out.green + j);
        } else if (all_zero<std::uint16_t, block>(count)) {
          emit_empty(out.red + j);
          emit_empty(out.green + j);
        } else {
          emit_cut(sums.red.data() + j, sums.count.data() + j, area, out.red + j);
          emit_cut(sums.green.data() + j, sums.count.data() + j, area, out.green + j);
        }
      }
    }
    if constexpr (Emit) {
      if (out.count != nullptr) std::copy_n(sums.count.data(), cols_, out.count);
    }
  }

  static void slide_sums(const Lane* ring, Index in, Index past, Index r, std::uint32_t* sum) {
    for (int part = 0; part < block; part += sum_lanes) {
      auto s = load<std::uint32_t, sum_lanes>(sum + part);
      s += convert<std::uint32_t, sum_lanes>(along_row<sum_lanes>(ring + in + part, r));
      s -= convert<std::uint32_t, sum_lanes>(along_row<sum_lanes>(ring + past + part, r));
      store(sum + part, s);
    }
  }

  /// Sums as float, rounded once. 8-bit sums fit a signed int, which is cheaper to convert.
  static lanes<float, sum_lanes> as_float(const std::uint32_t* sum) {
    using From = std::conditional_t<sizeof(Pixel) == 1, std::int32_t, std::uint32_t>;
    return convert<float, sum_lanes>(lanes<From, sum_lanes>(load<std::uint32_t, sum_lanes>(sum)));
  }

  static void emit_whole(const std::uint32_t* sum, int area, float* out) {
    const float scale = float(1.0 / area);
    for (int part = 0; part < block; part += sum_lanes) {
      store(out + part, as_float(sum + part) * scale);
    }
  }

  static void emit_empty(float* out) {
    for (int part = 0; part < block; part += sum_lanes) {
      store(out + part, lanes<float, sum_lanes>{} + not_a_number<float>());
    }
  }

  /// window_mean() lane by lane.
  static void emit_cut(const std::uint32_t* sum, const std::uint16_t* count, int area, float* out) {
    using Ints = lanes<std::int32_t, sum_lanes>;
    using Floats = lanes<float, sum_lanes>;
    const Floats scale = Floats{} + float(1.0 / area);
    const Floats nan = Floats{} + not_a_number<float>();
    for (int part = 0; part < block; part += sum_lanes) {
      const Ints n = convert<std::int32_t, sum_lanes>(load<std::uint16_t, sum_lanes>(count + part));
      const Ints empty = n == Ints{};
      const Floats s = as_float(sum + part);
      const Floats cut = s / convert<float, sum_lanes>(n - empty);  // n + 1 where n is 0
      const Floats whole = s * scale;
      store(out + part, choose(empty, nan, choose(Ints(n == Ints{} + area), whole, cut)));
    }
  }

  /// The last, incomplete block.
  void emit_rest(const Sums& sums, Index j, int area, const MeanRows<float>& out) const {
    for (Index i = j; i < cols_; ++i) {
      const std::size_t at = std::size_t(i);
      out.red[i] = window_mean(sums.red[at], sums.count[at], area);
      out.green[i] = window_mean(sums.green[at], sums.count[at], area);
    }
  }

  Index rows_, cols_;
  std::array<Index, std::size_t(Windows)> radius_;
  ClosedRange<Pixel> range_;
  Index padded_ = 0, margin_ = 0, pitch_ = 0, ring_rows_ = 0;
  Index began_ = 0, next_row_ = 0;
  line_vector<Pixel> red_, green_;
  line_vector<std::uint8_t> valid_;
  line_vector<Lane> red_ring_, green_ring_;
  line_vector<std::uint8_t> valid_ring_;
  std::array<Sums, std::size_t(Windows)> sums_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
