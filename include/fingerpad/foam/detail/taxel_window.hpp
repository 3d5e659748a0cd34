// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The last n readings of every taxel with running sums, so that the variance of each taxel about a
// straight line takes O(1) per sample. With d = reading - reference and u = 0 (oldest) ... n - 1
// (newest), the sums are sum d, sum u d and sum d^2. Running sums accumulate roundoff, and lose
// digits if the reference is far off. Each sample therefore recomputes the sums of a few taxels
// about their newest reading, so that every taxel is recomputed once per window.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <scalar S>
class TaxelWindow {
 public:
  TaxelWindow(Index taxels, Index length)
      : taxels_(taxels),
        length_(length),
        middle_(S(static_cast<int>(length - 1)) / S(2)),
        spread_(S(12) /
                S(S(static_cast<int>(length)) * S(square(S(static_cast<int>(length))) - S(1)))),
        readings_(static_cast<std::size_t>(taxels * length), S(0)),
        reference_(static_cast<std::size_t>(taxels), S(0)),
        sum_(reference_),
        moment_(reference_),
        squares_(reference_) {}

  Index taxels() const { return taxels_; }
  Index length() const { return length_; }

  /// Fills the whole window with `now`.
  void restart(const S* now) {
    for (Index u = 0; u < length_; ++u) {
      std::copy(now, now + taxels_, row(u));
    }
    std::copy(now, now + taxels_, reference_.data());
    std::fill(sum_.begin(), sum_.end(), S(0));
    std::fill(moment_.begin(), moment_.end(), S(0));
    std::fill(squares_.begin(), squares_.end(), S(0));
    oldest_ = 0;
  }

  /// Adds `now` as the newest reading of every taxel and removes the oldest.
  void push(const S* now) {
    S* const oldest = row(oldest_);
    const S last = S(static_cast<int>(length_ - 1));
    for (Index k = 0; k < taxels_; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const S gone = oldest[k] - reference_[i];
      const S come = now[k] - reference_[i];
      const S rest = sum_[i] - gone;  // sum of the remaining readings, whose u falls by 1
      moment_[i] = moment_[i] - rest + S(last * come);
      sum_[i] = rest + come;
      squares_[i] = squares_[i] + S(S(come - gone) * S(come + gone));
      oldest[k] = now[k];
    }
    oldest_ = oldest_ + 1 < length_ ? oldest_ + 1 : 0;
    for (Index k = 0; k <= taxels_ / length_; ++k) {
      sum_anew(next_);
      next_ = next_ + 1 < taxels_ ? next_ + 1 : 0;
    }
  }

  /// Mean square of the residuals of each taxel about its line; roundoff may make it negative.
  void variances(S* out) const {
    const S share = S(1) / S(static_cast<int>(length_));
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      const S tilt = moment_[i] - S(middle_ * sum_[i]);
      const S flat = squares_[i] - S(square(sum_[i]) * share);
      out[i] = S(flat - S(square(tilt) * spread_)) * share;
    }
  }

  /// Residuals of a taxel about its line, oldest first. Returns their mean square.
  S residuals(Index taxel, S* out) const {
    const auto i = static_cast<std::size_t>(taxel);
    const S length = S(static_cast<int>(length_));
    const S mean = sum_[i] / length;  // of the exact differences from the reference
    const S slope = S(moment_[i] - S(middle_ * sum_[i])) * spread_;
    S squares = S(0);
    for (Index u = 0; u < length_; ++u) {
      const S line = mean + S(slope * S(S(static_cast<int>(u)) - middle_));
      out[u] = S(row(place(u))[taxel] - reference_[i]) - line;
      squares = squares + square(out[u]);
    }
    return S(squares / length);
  }

 private:
  void sum_anew(Index taxel) {
    const S reference = row(place(length_ - 1))[taxel];  // finite, even if the sums are not
    S sum = S(0), moment = S(0), squares = S(0);
    for (Index u = 0; u < length_; ++u) {
      const S d = row(place(u))[taxel] - reference;
      sum = sum + d;
      moment = moment + S(S(static_cast<int>(u)) * d);
      squares = squares + S(d * d);
    }
    const auto i = static_cast<std::size_t>(taxel);
    reference_[i] = reference;
    sum_[i] = sum;
    moment_[i] = moment;
    squares_[i] = squares;
  }

  Index place(Index u) const { return oldest_ + u < length_ ? oldest_ + u : oldest_ + u - length_; }
  S* row(Index at) { return readings_.data() + at * taxels_; }
  const S* row(Index at) const { return readings_.data() + at * taxels_; }

  Index taxels_;
  Index length_;
  S middle_;  // mean of u
  S spread_;  // 1 / sum (u - middle)^2
  Index oldest_ = 0;
  Index next_ = 0;           // the next taxel to recompute
  std::vector<S> readings_;  // length x taxels, a ring from `oldest_`
  std::vector<S> reference_;
  std::vector<S> sum_;
  std::vector<S> moment_;
  std::vector<S> squares_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
