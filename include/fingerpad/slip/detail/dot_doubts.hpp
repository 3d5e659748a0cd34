// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// By how much noise scatters the number of dots that stick.
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

/// Standard deviation that noise gives to "sticks" (1) or "slips" (0) of a dot whose slip is near
/// the limit: sqrt(p (1 - p)), p by the logistic curve nearest to the normal one. `sd`: of that
/// slip along one axis, in the unit of both.
template <class S>
S doubt_of(const S& slip_sq, const S& limit_sq, const S& sd) {
  using std::exp;
  using std::sqrt;
  if (!(slip_sq < S(9) * limit_sq)) {
    return S(0);  // two limits beyond it there is none
  }
  const S off = (S(sqrt(slip_sq)) - S(sqrt(limit_sq))) / sd;
  const S grown = exp(S(S(-0.851) * (off < S(0) ? S(-off) : off)));
  return grown / (S(1) + grown * grown);
}

/// How the answers of two dots go together whose slips are means over neighbours: where these have
/// the correlation r, answers near the limit have (2 / pi) asin(r) (Sheppard 1899).
struct SharedDoubt {
  double beside, diagonal;

  /// Weights of the mean: of the dot, those beside it, those across.
  SharedDoubt(double self, double side, double across) {
    const double all = self * self + 4 * side * side + 4 * across * across;
    const auto shared = [&](double weight) {
      return 2 / std::numbers::pi * std::asin(weight / all);
    };
    beside = shared(2 * side * (self + 2 * across));
    diagonal = shared(2 * (self * across + side * side));
  }
};

/// Doubts of the dots of one frame, in a grid with a border of one cell. Dots that are two apart
/// share a 15th and less: left out.
template <class S>
class DotDoubts {
 public:
  explicit DotDoubts(const DotLayout& layout)
      : across_(layout.cols + 2),
        doubts_(static_cast<std::size_t>((layout.rows + 2) * across_), S(0)) {}

  void clear() { std::fill(doubts_.begin(), doubts_.end(), S(0)); }
  void set(const DotIndex& d, const S& doubt) {
    doubts_[static_cast<std::size_t>((d.row + 1) * across_ + d.col + 1)] = doubt;
  }
  /// Of the number of dots that stick.
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

/// Room in which dots are marked.
template <class S>
struct MarkingRoom {
  Dots<Point2<S>> residuals;
  DotDoubts<S> doubts;
};

/// Standard deviation of the share of so many dots.
template <class S>
S ratio_sd_of(const S& variance, const S& dots) {
  using std::sqrt;
  return S(0) < variance ? S(sqrt(variance) / dots) : S(0);
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
