// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where the pad is in the image: colours are averaged in the rectangle of pixels that holds it. The
// light near its rim tells whether a frame is of this pad.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/depth_reference.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// `rows` x `cols` pixels from (row, col) on.
struct PadArea {
  Index row = 0;
  Index col = 0;
  Index rows = 0;
  Index cols = 0;
};

/// The smallest area with all pixels that have a depth; empty if there are none.
template <scalar S>
PadArea area_of(const DepthReference<S>& reference) {
  Index first_row = reference.rows, last_row = 0, first_col = reference.cols, last_col = 0;
  each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
    if (reference.in_pad(i, j)) {
      first_row = (std::min)(first_row, i);
      last_row = i + 1;
      first_col = (std::min)(first_col, j);
      last_col = (std::max)(last_col, j + 1);
    }
  });
  return {first_row, first_col, last_row - first_row, last_col - first_col};
}

/// A view of the area in a frame.
template <class T>
StridedView<T> crop(const StridedView<T>& frame, const PadArea& area) {
  return region(frame, area.row, area.col, area.rows, area.cols);
}
template <class View>
auto crop(const View& frame, const PadArea& area) {
  return LazyView(area.rows, area.cols, [frame, area](Index i, Index j) -> decltype(auto) {
    return frame(area.row + i, area.col + j);
  });
}

/// Green near the rim over that of the reference, summed over sampled pixels. A press hardly moves
/// the rim, so that a change shows another lamp or membrane.
struct RimLight {
  Index pixels = 0;
  Index lit = 0;  ///< those that are neither dark nor saturated
  double sum = 0;

  /// Displaced printed dots change the light by 1 % with a thousand samples and by 4 % with 64;
  /// fewer tell nothing.
  bool has_changed() const {
    const double mean = sum / static_cast<double>(lit);
    return pixels >= 64 && !(2 * lit >= pixels && std::abs(mean - 1) <= 0.05);
  }
  void add(const RimLight& other) {
    pixels += other.pixels;
    lit += other.lit;
    sum += other.sum;
  }
};

/// The pixels near the rim, at most 1024 of them.
class Rim {
 public:
  template <scalar S>
  explicit Rim(const DepthReference<S>& reference)
      : reference_(static_cast<double>(reference.rim_green)) {
    double deepest_mm = 0;
    for (const S& l : reference.depth_mm) {
      deepest_mm = l > S(deepest_mm) ? static_cast<double>(l) : deepest_mm;
    }
    std::vector<Pixel> rim;
    each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
      if (reference.depth(i, j) <= S(rim_depth_mm(deepest_mm))) {
        rim.push_back({i, j});
      }
    });
    for (std::size_t k = 0; reference_ > 0 && k < rim.size(); k += rim.size() / 1024 + 1) {
      pixels_.push_back(rim[k]);
    }
  }

  /// The light in rows [first, last) of a frame.
  template <class Red, class Green>
  RimLight light(
      Index first, Index last, const Red& red, const Green& green, const GreyScale& scale) const {
    RimLight light;
    for (const auto& [row, col] : pixels_) {
      if (row >= first && row < last) {
        const auto r = static_cast<double>(red(row, col));
        const auto g = static_cast<double>(green(row, col));
        const bool lit = scale.counts(r) && scale.counts(g);
        light.pixels += 1;
        light.lit += lit ? 1 : 0;
        light.sum += lit ? g / (scale.units_per_level * reference_) : 0;
      }
    }
    return light;
  }

 private:
  struct Pixel {
    Index row;
    Index col;
  };
  double reference_;
  std::vector<Pixel> pixels_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
