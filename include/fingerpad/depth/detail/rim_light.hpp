// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The light near the pad's rim, relative to the reference. A press hardly moves the rim, so that a
// change shows that the lamp or the membrane is no longer that of the reference.
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/pad_area.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

class RimLight {
 public:
  /// `pixels` were examined, and `lit` of them are neither dark nor saturated. `light` is the sum
  /// of green over the reference's mean for the lit ones.
  struct Sum {
    Index pixels = 0;
    Index lit = 0;
    double light = 0;
  };

  template <class Pad>
  explicit RimLight(const Pad& pad)
      : reference_(static_cast<double>(value(pad.reference.rim_green))) {
    double deepest_mm = 0;
    for (const auto& depth : pad.reference.depth_mm) {
      const auto l = static_cast<double>(value(depth));
      deepest_mm = l > deepest_mm ? l : deepest_mm;
    }
    std::vector<Pixel> rim;
    for (Index i = 0; i < pad.reference.rows; ++i) {
      for (Index j = 0; j < pad.reference.cols; ++j) {
        if (static_cast<double>(value(pad.reference.depth(i, j))) <= rim_depth_mm(deepest_mm)) {
          rim.push_back({pad.area.row + i, pad.area.col + j});
        }
      }
    }
    const std::size_t step = rim.size() / most_samples + 1;
    for (std::size_t k = 0; reference_ > 0 && k < rim.size(); k += step) {
      pixels_.push_back(rim[k]);
    }
  }

  /// Sums over rows [first, last) of a frame.
  template <class Red, class Green>
  Sum sum(
      Index first, Index last, const Red& red, const Green& green, const GreyScale& scale) const {
    Sum sum;
    const auto is_lit = [&](double x) { return x > scale.dark && x < scale.saturated; };
    for (const Pixel& at : pixels_) {
      if (at.row < first || at.row >= last) {
        continue;
      }
      ++sum.pixels;
      const double g = level<Green>(green(at.row, at.col));
      if (is_lit(g) && is_lit(level<Red>(red(at.row, at.col)))) {
        ++sum.lit;
        sum.light += g / (scale.units_per_level * reference_);
      }
    }
    return sum;
  }

 private:
  static constexpr std::size_t most_samples = 1024;
  struct Pixel {
    Index row;
    Index col;
  };
  template <class View>
  static double level(const cell_t<View>& cell) {
    return static_cast<double>(value(real_of_t<cell_t<View>>(cell)));
  }

  double reference_;
  std::vector<Pixel> pixels_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
