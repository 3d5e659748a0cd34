// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What must be known of a foam array and of the window in which its vibrations are looked for.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// The array and its window. Readings in the sensor's own unit (counts, V, N). The paper prints no
/// values: the defaults suit arrays of 12-bit counts read 30 times a second.
template <scalar S = double>
struct TaxelOptions {
  S pitch_mm = S(34) / S(10);        ///< between taxels, > 0
  Index window = 16;                 ///< samples in which vibration is looked for, in [4, 4096]
  S sample_period_s = S(1) / S(30);  ///< nominal, > 0; waves are counted in window times this
  S longest_gap_s = S(1) / S(4);     ///< a longer time between samples begins a new window, > 0
  S noise = S(6);                    ///< standard deviation of a taxel at rest, >= 0
  S noise_factor = S(5) / S(2);      ///< vibration is more than this many of them, >= 0
  S min_sum = S(0);                ///< a smaller sum of readings has no centroid, >= 0
  S saturated_at = S((std::numeric_limits<scalar_real_t<S>>::infinity)());  ///< readings from here
                                                                            ///< on do not count
  Index stuck_after = 0;  ///< a reading that is not 0 and was the same so many times in a row does
                          ///< not count, >= 0; 0: not looked for
};

/// Refuses what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const TaxelOptions<S>& o) {
  const auto positive = [](const S& x, const char* name) {
    expects(is_finite(x) && value(x) > 0, "TaxelOptions", name, x, "finite and > 0");
  };
  const auto not_negative = [](const S& x, const char* name) {
    expects(is_finite(x) && value(x) >= 0, "TaxelOptions", name, x, "finite and >= 0");
  };
  positive(o.pitch_mm, "pitch_mm");
  expects(o.window >= 4 && o.window <= 4096, "TaxelOptions", "window",
          static_cast<long long>(o.window), "in [4, 4096]");
  positive(o.sample_period_s, "sample_period_s");
  positive(o.longest_gap_s, "longest_gap_s");
  not_negative(o.noise, "noise");
  not_negative(o.noise_factor, "noise_factor");
  not_negative(o.min_sum, "min_sum");
  expects(value(o.saturated_at) > 0, "TaxelOptions", "saturated_at", o.saturated_at, "> 0");
  expects(o.stuck_after >= 0, "TaxelOptions", "stuck_after", static_cast<long long>(o.stuck_after),
          ">= 0");
}

// The last readings of every taxel with their running sums, so that the spread of each is known in
// O(1) a sample. With d = reading - reference and u = 0 (oldest) ... n - 1 (newest):
//   sum d, sum d^2, and for a line sum u d
// A running sum in floating point collects rounding, and one about a far reference loses digits:
// so at each sample a few taxels are summed anew about their newest reading, all of them once
// within a window.

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

// How many waves of vibration one taxel shows in its window: the paper's "number of sensed
// vibrating waves", which it calls frequency.

/// One taxel in its window: what is left without mean or line, and the receive times, oldest first.
template <scalar S>
struct WaveWindow {
  const S* residual;
  const S* time_s;
  Index length;
  S rms;         // of the residual, > 0
  S duration_s;  // in which waves are counted: length times the nominal period

  /// From the oldest sample to one period beyond the newest, by the clock.
  S span_s() const {
    const S period = S(time_s[length - 1] - time_s[0]) / S(static_cast<int>(length - 1));
    return S(period * S(static_cast<int>(length)));
  }
};

/// x >= 0 rounded to the nearest whole number, halves up, at most `most`.
template <scalar S>
Index rounded(const S& x, Index most) {
  using Real = scalar_real_t<S>;
  const Real half_up = value(x) + Real(0.5);
  return half_up < Real(static_cast<int>(most)) ? static_cast<Index>(half_up) : most;
}

}  // namespace detail

/// Counts how often the signal crosses its mean (or line). A crossing counts when the signal goes
/// beyond `hysteresis` times its rms on the other side, so that noise on a slow wave does not; a
/// wave has two, and one alone, as of a step, is a wave that has begun. Of waves shorter than three
/// samples some are missed. O(window).
struct ZeroCrossings {
  double hysteresis = 0.5;  ///< in [0, 1)

  void check() const {
    expects(hysteresis >= 0 && hysteresis < 1, "ZeroCrossings", "hysteresis", hysteresis,
            "in [0, 1)");
  }

  /// No memory of its own.
  template <scalar S>
  struct Scratch {
    explicit Scratch(Index) {}
  };

  template <scalar S>
  Index operator()(const detail::WaveWindow<S>& window, Scratch<S>&) const {
    const auto beyond = static_cast<scalar_real_t<S>>(hysteresis) * value(window.rms);
    int side = 0;
    int crossings = 0;
    for (Index u = 0; u < window.length; ++u) {
      const auto r = value(window.residual[u]);
      const int now = r > beyond ? 1 : r < -beyond ? -1 : side;
      crossings += now != side && side != 0 ? 1 : 0;
      side = now;
    }
    const S waves = S((crossings + 1) / 2);
    return detail::rounded(S(waves * S(window.duration_s / window.span_s())), window.length / 2);
  }
};

/// Counts the waves of the strongest line of the spectrum within a Hann window. Takes the times as
/// they are, so an uneven clock does not smear the line. O(window^2 / 2) for the one taxel.
struct SpectralPeak {
  void check() const {}

  template <scalar S>
  struct Scratch {
    explicit Scratch(Index length)
        : real(static_cast<std::size_t>(length), S(0)), imaginary(real), cosine(real), sine(real) {}
    std::vector<S> real, imaginary;  // residual times window times the k-th power of the turn
    std::vector<S> cosine, sine;     // one turn for each wave in the window
  };

  template <scalar S>
  Index operator()(const detail::WaveWindow<S>& window, Scratch<S>& scratch) const {
    prepare(window, scratch);
    Index best = 1;
    scalar_real_t<S> most = -1;
    for (Index k = 1; k <= window.length / 2; ++k) {
      const auto power = value(turn(window.length, scratch));
      if (power > most) {
        most = power;
        best = k;
      }
    }
    return best;
  }

 private:
  template <scalar S>
  static void prepare(const detail::WaveWindow<S>& window, Scratch<S>& scratch) {
    using std::cos;
    using std::sin;
    const S pi = S(std::numbers::pi_v<long double>);
    const S middle = S(window.time_s[0] + window.time_s[window.length - 1]) / S(2);
    for (std::size_t u = 0; u < static_cast<std::size_t>(window.length); ++u) {
      const S phase = S(S(2) * pi) * S(S(window.time_s[u] - middle) / window.duration_s);
      scratch.cosine[u] = S(cos(phase));
      scratch.sine[u] = S(sin(phase));
      const bool inside = value(phase) > -value(pi) && value(phase) < value(pi);
      scratch.real[u] = inside ? S(window.residual[u] * S(S(1) + scratch.cosine[u])) : S(0);
      scratch.imaginary[u] = S(0);
    }
  }

  /// Turns every term by one more wave and returns the power of their sum.
  template <scalar S>
  static S turn(Index length, Scratch<S>& scratch) {
    S real_sum = S(0), imaginary_sum = S(0);
    for (std::size_t u = 0; u < static_cast<std::size_t>(length); ++u) {
      const S real = scratch.real[u], imaginary = scratch.imaginary[u];
      scratch.real[u] = S(real * scratch.cosine[u]) - S(imaginary * scratch.sine[u]);
      scratch.imaginary[u] = S(real * scratch.sine[u]) + S(imaginary * scratch.cosine[u]);
      real_sum = real_sum + scratch.real[u];
      imaginary_sum = imaginary_sum + scratch.imaginary[u];
    }
    return S(square(real_sum) + square(imaginary_sum));
  }
};

}  // namespace v0
}  // namespace fingerpad
