// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The last readings of every taxel with their running sums, so that the spread of each is known in
// O(1) a sample. With d = reading - reference and u = 0 (oldest) ... n - 1 (newest):
//   sum d, sum d^2, and for a line sum u d
// A running sum in floating point collects rounding, and one about a far reference loses digits:
// so at each sample a few taxels are summed anew about their newest reading, all of them once
// within a window.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// What of the window counts as vibration: all that is not its mean, as published.
struct MeanRemoved {
  static constexpr bool has_slope = false;
};
/// All that is not a straight line: a grip that is loosened or raised evenly does not vibrate.
struct TrendRemoved {
  static constexpr bool has_slope = true;
};

namespace detail {

template <class Level, scalar S>
class TaxelWindow {
 public:
  TaxelWindow(Index taxels, Index length)
      : taxels_(taxels),
        length_(length),
        refreshed_((taxels / length + lanes) / lanes * lanes),
        readings_(static_cast<std::size_t>(taxels * length), S(0)),
        reference_(static_cast<std::size_t>(taxels), S(0)),
        sum_(reference_),
        moment_(Level::has_slope ? reference_.size() : 0, S(0)),
        squares_(reference_) {}

  Index length() const { return length_; }

  /// As if `now` had been read all along.
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

  /// `now` becomes the newest reading of every taxel; the oldest is forgotten.
  void push(const S* now) {
    exchange(now, row(oldest_), reference_.data(), sum_.data(), moment_.data(), squares_.data());
    oldest_ = oldest_ + 1 < length_ ? oldest_ + 1 : 0;
    refresh();
  }

  const S& reading(Index taxel, Index u) const {
    return readings_[static_cast<std::size_t>(place(u) * taxels_ + taxel)];
  }

  /// Mean square of what is left of each taxel without its mean or line, >= 0.
  void variances(scalar_real_t<S>* out) const {
    const Weights w(length_);
    for (Index k = 0; k < taxels_; ++k) {
      const scalar_real_t<S> left = value(squares_left(static_cast<std::size_t>(k), w));
      out[k] = left > 0 ? left : scalar_real_t<S>(0);
    }
  }

  /// What is left of one taxel at each time of the window, oldest first; returns its mean square.
  S residuals(Index taxel, S* out) const {
    const Weights w(length_);
    const std::size_t i = static_cast<std::size_t>(taxel);
    const S mean = sum_[i] * w.share;  // of the differences from the reference, which are exact
    S slope = S(0);
    if constexpr (Level::has_slope) {
      slope = S(moment_[i] - S(w.middle * sum_[i])) * w.spread;
    }
    S squares = S(0);
    for (Index u = 0; u < length_; ++u) {
      S level = mean;
      if constexpr (Level::has_slope) {
        level = mean + S(slope * S(S(static_cast<int>(u)) - w.middle));
      }
      out[u] = S(reading(taxel, u) - reference_[i]) - level;
      squares = squares + square(out[u]);
    }
    return S(squares * w.share);
  }

 private:
  struct Weights {
    explicit Weights(Index length)
        : middle(S(static_cast<int>(length - 1)) / S(2)),
          share(S(1) / S(static_cast<int>(length))),
          spread(S(12) /
                 S(S(static_cast<int>(length)) * S(square(S(static_cast<int>(length))) - S(1)))) {}
    S middle;  // mean of u
    S share;   // 1 / n
    S spread;  // 1 / sum (u - middle)^2
  };

  S squares_left(std::size_t i, const Weights& w) const {
    const S flat = squares_[i] - S(square(sum_[i]) * w.share);
    if constexpr (!Level::has_slope) {
      return S(flat * w.share);
    } else {
      const S tilt = moment_[i] - S(w.middle * sum_[i]);
      return S(S(flat - S(square(tilt) * w.spread)) * w.share);
    }
  }

  /// The oldest reading of each taxel for the newest. The columns do not overlap.
  void exchange(const S* __restrict newest,
                S* __restrict oldest,
                const S* __restrict reference,
                S* __restrict sum,
                S* __restrict moment,
                S* __restrict squares) const {
    const S last = S(static_cast<int>(length_ - 1));
    for (Index k = 0; k < taxels_; ++k) {
      const S gone = oldest[k] - reference[k];
      const S come = newest[k] - reference[k];
      const S rest = sum[k] - gone;  // of those that stay; each of them grows one sample older
      if constexpr (Level::has_slope) {
        moment[k] = moment[k] - rest + S(last * come);
      }
      sum[k] = rest + come;
      squares[k] = squares[k] + S(S(come - gone) * S(come + gone));
      oldest[k] = newest[k];
    }
  }

  void refresh() {
    const Index end = (std::min)(next_ + refreshed_, taxels_);
    for (; next_ + lanes <= end; next_ += lanes) {
      sum_anew<static_cast<std::size_t>(lanes)>(next_);
    }
    for (; next_ < end; ++next_) {
      sum_anew<1>(next_);
    }
    next_ = end < taxels_ ? end : 0;
  }

  /// Of taxels side by side, in registers.
  template <std::size_t Taxels>
  void sum_anew(Index first) {
    std::array<S, Taxels> reference, sum, moment, squares;
    for (std::size_t k = 0; k < Taxels; ++k) {
      // finite, whatever the sums had become
      reference[k] = reading(first + static_cast<Index>(k), length_ - 1);
      sum[k] = moment[k] = squares[k] = S(0);
    }
    for (Index u = 0; u < length_; ++u) {
      const S* const readings = row(place(u)) + first;
      const S age = S(static_cast<int>(u));
      for (std::size_t k = 0; k < Taxels; ++k) {
        const S d = readings[k] - reference[k];
        sum[k] = sum[k] + d;
        if constexpr (Level::has_slope) {
          moment[k] = moment[k] + S(age * d);
        }
        squares[k] = squares[k] + S(d * d);
      }
    }
    std::copy(reference.begin(), reference.end(), reference_.begin() + first);
    std::copy(sum.begin(), sum.end(), sum_.begin() + first);
    if constexpr (Level::has_slope) {
      std::copy(moment.begin(), moment.end(), moment_.begin() + first);
    }
    std::copy(squares.begin(), squares.end(), squares_.begin() + first);
  }

  Index place(Index u) const { return oldest_ + u < length_ ? oldest_ + u : oldest_ + u - length_; }
  S* row(Index at) { return readings_.data() + at * taxels_; }

  static constexpr Index lanes = 8;

  Index taxels_;
  Index length_;
  Index refreshed_;  // taxels summed anew at each sample, at least taxels / length
  Index oldest_ = 0;
  Index next_ = 0;
  std::vector<S> readings_;  // length x taxels, from `oldest_` round
  std::vector<S> reference_;
  std::vector<S> sum_;
  std::vector<S> moment_;
  std::vector<S> squares_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
