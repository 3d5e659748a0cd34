// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of the dots, measured between successive frames, whether something touches or not.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Except for noise, a dot moves like the mean of the two dots beside it. With displacements d
/// since the frame before and a standard deviation s of a position, e = 2 d - d_before - d_after
/// has the variance 12 s^2 along x and along y, for any shift, rotation, scale and shear of the
/// pad. A frame gives the median of e^2, which a few wrong dots and the edge of a contact do not
/// change. Bending of the pad between two frames only adds to it: the result is the lower quartile
/// over the latest 32 frames.
template <scalar S>
class FrameNoise {
  static constexpr std::size_t memory = 32;  // frames
  static constexpr std::size_t fewest = 12;  // values that a frame needs

 public:
  /// For grids of `cells` dots in rows of `width`, with a border of dots that are never found.
  FrameNoise(std::size_t cells, Index width)
      : width_(width), before_(cells, missing_point<S>()), squares_(2 * cells) {}

  /// Adds a frame; dots not found are NaN. Frames that repeat the one before do not count.
  void add(const std::vector<Point3<S>>& now) {
    squares_.clear();
    for (Index k = width_; k + width_ < size_of(now); ++k) {
      for (const Index beside : {Index(1), width_}) {
        const auto moved = [&](Index i) { return now.data()[i] - before_.data()[i]; };
        const Point3<S> e = S(2) * moved(k) - moved(k - beside) - moved(k + beside);
        const auto sq = static_cast<double>(value(e.x * e.x + e.y * e.y));
        if (is_finite(sq)) {
          squares_.push_back(sq);
        }
      }
    }
    const auto middle = squares_.begin() + static_cast<Index>(squares_.size() / 2);
    std::nth_element(squares_.begin(), middle, squares_.end());
    if (squares_.size() >= fewest && *middle > 0) {
      levels_[frames_++ % memory] = *middle;
    }
    std::copy(now.begin(), now.end(), before_.begin());
  }
  void reset() {
    frames_ = 0;
    levels_ = {};
    std::fill(before_.begin(), before_.end(), missing_point<S>());
  }

  /// Standard deviation of a position along x or y; 0 before the first pair of frames.
  double sd() const {
    auto levels = levels_;
    const std::size_t known = (std::min)(frames_, memory);
    const auto quarter = levels.begin() + known / 4;
    std::nth_element(levels.begin(), quarter, levels.begin() + known);
    return std::sqrt(*quarter / (12 * 2 * 0.6931471805599453));  // chi^2 of 2: median 2 ln 2
  }

 private:
  Index width_;
  std::vector<Point3<S>> before_;
  ReservedVector<double> squares_;
  std::array<double, memory> levels_ = {};
  std::size_t frames_ = 0;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
