// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of the dots, measured while nothing touches the pad.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Measures noise from successive frames without contact. Except for noise, a dot moves like the
/// mean of the two dots beside it. With displacements d and a standard deviation s of a position,
/// e = 2 d - d_before - d_after has the variance 12 s^2 along x and along y, for any shift,
/// rotation, scale and shear of the pad. A frame gives the median of e^2, which a few wrong dots do
/// not change; the result is the median over the latest 32 frames, which a few touches that nobody
/// noticed do not change.
template <scalar S>
class FreeNoise {
  static constexpr std::size_t memory = 32;  // frames
  static constexpr std::size_t fewest = 12;  // values that a frame needs

 public:
  /// For grids of `cells` dots in rows of `width`, with a border of dots that are never found.
  FreeNoise(std::size_t cells, Index width) : width_(width), before_(cells), squares_(2 * cells) {}

  /// Adds a frame without contact; dots not found are NaN. Frames that repeat the one before do not
  /// count.
  void add(const std::vector<Point3<S>>& now) {
    if (has_before_) {
      squares_.clear();
      for (Index k = width_; k + width_ < static_cast<Index>(now.size()); ++k) {
        for (const Index beside : {Index(1), width_}) {
          const auto moved = [&](Index i) { return now.data()[i] - before_.data()[i]; };
          const Point3<S> e = S(2) * moved(k) - moved(k - beside) - moved(k + beside);
          const auto sq = static_cast<double>(value(S(e.x * e.x + e.y * e.y)));
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
    }
    std::copy(now.begin(), now.end(), before_.begin());
    has_before_ = true;
  }
  /// Call for a frame with contact: the frames before and after it are not compared.
  void interrupt() { has_before_ = false; }
  void reset() {
    interrupt();
    frames_ = 0;
  }

  /// Number of pairs of frames measured.
  Index frames() const { return static_cast<Index>(frames_); }
  /// Standard deviation of a position along x or y. Needs a pair of frames.
  double sd() const {
    auto levels = levels_;
    const std::size_t known = (std::min)(frames_, memory);
    const auto middle = levels.begin() + known / 2;
    std::nth_element(levels.begin(), middle, levels.begin() + known);
    return std::sqrt(*middle / (12 * 2 * 0.6931471805599453));  // chi^2 of 2: median 2 ln 2
  }

 private:
  Index width_;
  std::vector<Point3<S>> before_;
  ReservedVector<double> squares_;
  std::array<double, memory> levels_ = {};
  std::size_t frames_ = 0;
  bool has_before_ = false;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
