// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The last n readings of every taxel, and how much they vary about a straight line.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Sums are those of the differences from the newest reading, so that a large reading costs no
/// digits; places in the window are counted from its middle.
template <scalar S>
class TaxelWindow {
 public:
  TaxelWindow(Index taxels, Index length)
      : taxels_(taxels),
        length_(length),
        readings_(static_cast<std::size_t>(taxels * length), S(0)),
        sum_(static_cast<std::size_t>(taxels), S(0)),
        tilt_(sum_) {
    const S n = S(static_cast<int>(length));
    spread_ = S(12) / (n * (square(n) - S(1)));
  }

  Index taxels() const { return taxels_; }
  Index length() const { return length_; }

  /// Fills the whole window with `now`.
  void restart(const S* now) {
    for (Index u = 0; u < length_; ++u) {
      push(now);
    }
  }

  /// Adds `now` as the newest reading of every taxel and removes the oldest.
  void push(const S* now) {
    std::copy(now, now + taxels_, readings_.begin() + oldest_ * taxels_);
    oldest_ = oldest_ + 1 < length_ ? oldest_ + 1 : 0;
  }

  /// Mean square of the residuals of each taxel about its line; roundoff may make it negative.
  /// O(taxels length).
  void variances(S* out) {
    std::fill(sum_.begin(), sum_.end(), S(0));
    std::fill(tilt_.begin(), tilt_.end(), S(0));
    std::fill(out, out + taxels_, S(0));
    const S* const newest = row(length_ - 1);
    for (Index u = 0; u < length_; ++u) {
      const S* const now = row(u);
      const S from_middle = from_middle_of(u);
      for (std::size_t k = 0; k < sum_.size(); ++k) {
        const S d = now[k] - newest[k];
        sum_[k] = sum_[k] + d;
        tilt_[k] = tilt_[k] + from_middle * d;
        out[k] = out[k] + d * d;
      }
    }
    const S n = S(static_cast<int>(length_));
    for (std::size_t k = 0; k < sum_.size(); ++k) {
      out[k] = (out[k] - square(sum_[k]) / n - square(tilt_[k]) * spread_) / n;
    }
  }

  /// Residuals of a taxel about its line, oldest first. Returns their mean square.
  S residuals(Index taxel, S* out) const {
    S sum = S(0), tilt = S(0), squares = S(0);
    for (Index u = 0; u < length_; ++u) {
      out[u] = row(u)[taxel] - row(length_ - 1)[taxel];
      sum = sum + out[u];
      tilt = tilt + from_middle_of(u) * out[u];
    }
    const S n = S(static_cast<int>(length_));
    for (Index u = 0; u < length_; ++u) {
      out[u] = out[u] - (sum / n + tilt * spread_ * from_middle_of(u));
      squares = squares + square(out[u]);
    }
    return squares / n;
  }

 private:
  S from_middle_of(Index u) const { return S(static_cast<int>(2 * u + 1 - length_)) / S(2); }
  /// Readings at one time; u is 0 for the oldest.
  const S* row(Index u) const {
    const Index at = oldest_ + u < length_ ? oldest_ + u : oldest_ + u - length_;
    return readings_.data() + at * taxels_;
  }

  Index taxels_;
  Index length_;
  Index oldest_ = 0;
  S spread_;                 // 1 / sum of the squared distances from the middle
  std::vector<S> readings_;  // length x taxels, a ring from `oldest_`
  std::vector<S> sum_;       // of each taxel, in variances()
  std::vector<S> tilt_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
