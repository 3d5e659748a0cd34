// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Counts the waves of vibration that one taxel shows in its window: the paper's "number of sensed
// vibrating waves", which it calls frequency. They are counted per window of samples, so that a gap
// of the clock does not reduce their number. There are two methods, policies of TaxelFeatures.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Time from the oldest sample to one period beyond the newest.
inline double span_s(const double* time_s, Index length) {
  const double length_s = time_s[length - 1] - time_s[0];
  return length_s / static_cast<double>(length - 1) * static_cast<double>(length);
}

/// One taxel in its window, oldest sample first.
template <scalar S>
struct WaveWindow {
  const S* residual;     // readings without the straight line
  const double* time_s;  // by the clock, gaps shortened
  Index length;
  S rms;  // of the residual, > 0
};

}  // namespace detail

/// Counts how often the signal crosses its straight line, twice per wave. Use it by default: a
/// step, as of a taxel that lets go, counts as one wave that has begun, and it takes O(window). A
/// crossing counts when the signal exceeds `hysteresis` times its rms on the other side, so that
/// noise on a slow wave does not count. Some waves shorter than three samples are missed.
struct ZeroCrossings {
  double hysteresis = 0.5;  ///< in [0, 1)

  void check() const {
    expects(hysteresis >= 0 && hysteresis < 1, "ZeroCrossings", "hysteresis", hysteresis,
            "in [0, 1)");
  }

  /// Needs no memory.
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
    return (crossings + 1) / 2;
  }
};

/// Counts the waves of the strongest line of the spectrum in a Hann window. Use it when the clock
/// is uneven or waves are shorter than three samples: it uses the actual times. O(window^2) for each
/// taxel.
struct SpectralPeak {
  void check() const {}

  template <scalar S>
  struct Scratch {
    explicit Scratch(Index length)
        : real(static_cast<std::size_t>(length), S(0)), imaginary(real), cosine(real), sine(real) {}
    // residual times window times the k-th power of the rotation
    std::vector<S> real, imaginary;
    std::vector<S> cosine, sine;  // the rotation by one wave per window
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
    const double span = detail::span_s(window.time_s, window.length);
    const double middle = (window.time_s[0] + window.time_s[window.length - 1]) / 2;
    for (std::size_t u = 0; u < static_cast<std::size_t>(window.length); ++u) {
      const S phase = S(S(2) * pi) * S((window.time_s[u] - middle) / span);
      scratch.cosine[u] = S(cos(phase));
      scratch.sine[u] = S(sin(phase));
      const bool inside = value(phase) > -value(pi) && value(phase) < value(pi);
      scratch.real[u] = inside ? S(window.residual[u] * S(S(1) + scratch.cosine[u])) : S(0);
      scratch.imaginary[u] = S(0);
    }
  }

  /// Rotates every term by one more wave and returns the power of their sum.
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
