// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of the dots, measured while nothing touches the pad, for the thresholds of slip.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/slip/detail/dot_frames.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Measures noise from successive free frames. Except for noise, a dot moves like the mean of the
/// two dots beside it. With displacements d and a standard deviation s of a position,
/// e = 2 d - d_before - d_after has the variance 12 s^2 per axis, for any shift, rotation, scale
/// and shear of the pad. Each frame yields the median of e^2, which is robust to a few wrong dots.
/// The result is the median over the latest frames, which is robust to frames with an unnoticed
/// touch.
template <class P>
class FreeDots {
  static constexpr bool in_space = requires(P p) { p.z; };
  static constexpr std::size_t memory = 32;  // frames
  static constexpr std::size_t fewest = 12;  // values needed of a frame

 public:
  FreeDots() = default;
  explicit FreeDots(const DotLayout& layout)
      : layout_(layout),
        before_(static_cast<std::size_t>(layout.size()), no_dot<P>()),
        moved_(before_),
        squares_(2 * before_.size()) {}

  /// Adds a frame without contact. Frames that repeat the one before do not count.
  void add(const Dots<P>& now) {
    if (has_before_) {
      for (std::size_t k = 0; k < now.size(); ++k) {
        moved_[k] = now[k] - before_[k];
      }
      const double level =
          median_of([](const P& e) { return coordinate<P>(e.x * e.x + e.y * e.y); });
      if (level > 0) {
        lateral_sq_[newest_] = level / (12 * 2 * 0.6931471805599453);  // chi^2 of 2: 2 ln 2
        if constexpr (in_space) {
          depth_sq_[newest_] = median_of([](const P& e) { return coordinate<P>(e.z * e.z); }) /
                               (12 * 0.4549364231195724);
        }
        newest_ = (newest_ + 1) % memory;
        frames_ = (std::min)(frames_ + 1, memory);
      }
    }
    std::copy(now.begin(), now.end(), before_.begin());
    has_before_ = true;
  }
  /// Call for a frame with contact: the frames before and after it are not compared.
  void interrupt() { has_before_ = false; }
  void reset() {
    interrupt();
    frames_ = newest_ = 0;
  }

  /// Number of pairs of frames measured, at most the latest 32.
  Index frames() const { return static_cast<Index>(frames_); }
  /// Standard deviation of one position along x or y; NaN without frames.
  double lateral() const { return middle_of(lateral_sq_); }
  double depth() const { return middle_of(depth_sq_); }

 private:
  using Levels = std::array<double, memory>;

  template <class Square>
  double median_of(const Square& square) {
    squares_.clear();
    for (Index i = 0; i < layout_.rows; ++i) {
      for (Index j = 0; j < layout_.cols; ++j) {
        const Index k = i * layout_.cols + j;
        if (j > 0 && j + 1 < layout_.cols) {
          add_square(square, k, 1);
        }
        if (i > 0 && i + 1 < layout_.rows) {
          add_square(square, k, layout_.cols);
        }
      }
    }
    const auto middle = squares_.begin() + static_cast<std::ptrdiff_t>(squares_.size() / 2);
    std::nth_element(squares_.begin(), middle, squares_.end());
    return squares_.size() < fewest ? 0 : *middle;
  }
  template <class Square>
  void add_square(const Square& square, Index k, Index beside) {
    const P e = coordinate<P>(2) * at(moved_, k) - at(moved_, k - beside) - at(moved_, k + beside);
    const double sq = static_cast<double>(value(square(e)));
    if (is_finite(sq)) {
      squares_.push_back(sq);
    }
  }

  double middle_of(Levels levels) const {
    const auto end = levels.begin() + static_cast<std::ptrdiff_t>(frames_);
    const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(frames_ / 2);
    std::nth_element(levels.begin(), middle, end);
    return frames_ > 0 ? std::sqrt(*middle) : not_a_number<double>();
  }

  DotLayout layout_;
  Dots<P> before_, moved_;
  ReservedVector<double> squares_;
  Levels lateral_sq_{}, depth_sq_{};
  std::size_t frames_ = 0, newest_ = 0;
  bool has_before_ = false;
};

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
