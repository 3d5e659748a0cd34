// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Uncertainty of the number of sticking dots due to noise.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/detail/dot_frames.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Standard deviation of the answer "sticks" (1) or "slips" (0) of a dot due to noise:
/// sqrt(p (1 - p)), with p from the logistic curve nearest to the normal distribution. `sd` is that
/// of the slip along one axis, in the unit of slip and limit.
template <class S>
S doubt_of(const S& slip_sq, const S& limit_sq, const S& sd) {
  using std::exp;
  using std::sqrt;
  if (!(slip_sq < S(9) * limit_sq)) {
    return S(0);  // no doubt beyond three times the limit
  }
  const S off = (S(sqrt(slip_sq)) - S(sqrt(limit_sq))) / sd;
  const S grown = exp(S(S(-0.851) * (off < S(0) ? S(-off) : off)));
  return grown / (S(1) + grown * grown);
}

/// Correlation of the answers of two dots whose slips are means over neighbours. If the means have
/// the correlation r, answers near the limit have (2 / pi) asin(r) (Sheppard 1899).
struct SharedDoubt {
  double beside, diagonal;

  /// Weights of the mean: of the dot, of side neighbours and of diagonal ones.
  SharedDoubt(double self, double side, double across) {
    const double all = self * self + 4 * side * side + 4 * across * across;
    const auto shared = [&](double weight) {
      return 2 / std::numbers::pi * std::asin(weight / all);
    };
    beside = shared(2 * side * (self + 2 * across));
    diagonal = shared(2 * (self * across + side * side));
  }
};

/// Doubts of the dots of one frame, in a grid with a border of one cell. Dots two apart have a
/// correlation of at most 1/15, which is neglected.
template <class S>
class DotDoubts {
 public:
  explicit DotDoubts(const DotLayout& layout)
      : across_(layout.cols + 2),
        doubts_(static_cast<std::size_t>((layout.rows + 2) * across_), S(0)) {}

  void clear() { std::fill(doubts_.begin(), doubts_.end(), S(0)); }
  void set(const DotIndex& d, const S& doubt) {
    set(static_cast<std::size_t>((d.row + 1) * across_ + d.col + 1), doubt);
  }
  /// `padded`: index of the dot in the grid with the border.
  void set(std::size_t padded, const S& doubt) { doubts_[padded] = doubt; }
  /// Variance of the number of sticking dots.
  S variance(const SharedDoubt& shared) const {
    S sum = S(0);
    const S* const end = doubts_.data() + doubts_.size() - across_;
    for (const S* d = doubts_.data() + across_; d != end; ++d) {
      if (*d > S(0)) {
        const S beside = d[-across_] + d[-1] + d[1] + d[across_];
        const S diagonal = d[-across_ - 1] + d[1 - across_] + d[across_ - 1] + d[across_ + 1];
        sum = sum + *d * (*d + S(shared.beside) * beside + S(shared.diagonal) * diagonal);
      }
    }
    return sum;
  }

 private:
  Index across_;
  std::vector<S> doubts_;
};

/// Working memory for marking dots.
template <class S>
struct MarkingRoom {
  Dots<Point2<S>> residuals;
  DotDoubts<S> doubts;
};

/// Standard deviation of the ratio of sticking dots to `dots`, from the variance of their number.
template <class S>
S ratio_sd_of(const S& variance, const S& dots) {
  using std::sqrt;
  return S(0) < variance ? S(sqrt(variance) / dots) : S(0);
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
