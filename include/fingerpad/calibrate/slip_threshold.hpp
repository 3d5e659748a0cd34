// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The threshold of slip from the noise of the dots, and the probability that it is wrong.
// Source: "Selection of delta_0" of 003, corrected (docs/errata.md, E037).
//
// A dot is tested by the difference of its positions in two frames. With Gaussian noise of standard
// deviation sigma per axis in each, both axes of the difference have sigma sqrt(2), and its length
// r is Rayleigh distributed:
//   p = P(r > delta_0) = exp(-delta_0^2 / (4 sigma^2)).
// The published delta_0 = 4 sigma, said to hold 95.44 %, holds 1 - exp(-4) = 98.17 %: 1.83 % of the
// sticking dots are taken for slipping.
#include <cmath>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// p: that of a sticking dot which seems to move by more than `slip_px` between two frames; 0 for
/// noise 0. noise_px >= 0: sigma of one position, per axis, as it is compared: after denoising.
/// With x = slip^2 / (4 noise^2) the relative error is at most (4 x + 2) epsilon, as much as 2
/// epsilon in an argument make.
template <scalar S>
S false_slip_probability(const S& slip_px, const S& noise_px) {
  using std::exp;
  const S ratio = slip_px / noise_px;
  const S exponent = ratio * ratio / S(-4);
  return S(exp(exponent));
}

/// delta_0 that a sticking dot passes with this probability, in (0, 1]; NaN where it is > 1. The
/// relative error is a few epsilon, however small the probability.
template <scalar S>
S slip_threshold_for(const S& noise_px, const S& probability) {
  using std::log;
  using std::sqrt;
  const S nats = S(0) - S(log(probability));  // not -0 for probability 1
  const S root = sqrt(nats);
  return S(S(2) * noise_px * root);
}

/// That of at least one in `dots` independent dots, each of which has `probability`, in [0, 1).
template <scalar S>
S false_slip_among(const S& probability, Index dots) {
  using std::expm1;
  using std::log1p;
  const S minus = S(0) - probability;
  const S nats = S(static_cast<double>(dots)) * S(log1p(minus));
  return S(S(0) - S(expm1(nats)));
}

/// The probability of each of `dots` for which that of at least one is `among`, in [0, 1).
template <scalar S>
S false_slip_of_each(const S& among, Index dots) {
  using std::expm1;
  using std::log1p;
  const S minus = S(0) - among;
  const S nats = S(log1p(minus)) / S(static_cast<double>(dots));
  return S(S(0) - S(expm1(nats)));
}

/// The largest displacement that noise alone makes among `dots` dots of two frames, root mean
/// square: 2 sigma sqrt(1 + 1/2 + ... + 1/dots). For r^2 / (4 sigma^2) is exponentially distributed
/// with mean 1, and of N such numbers the smallest has the mean 1/N, the next is 1/(N-1) larger in
/// the mean, and so on. The mean of the largest displacement is less by 7 % for 2 dots, 1 % for
/// 100. O(dots).
template <scalar S>
S furthest_noise_px(const S& noise_px, Index dots) {
  using std::sqrt;
  S harmonic = S(0);
  for (Index k = dots; k > 0; --k) {
    harmonic = harmonic + S(1) / S(static_cast<double>(k));
  }
  const S root = sqrt(harmonic);
  return S(S(2) * noise_px * root);
}

}  // namespace v0
}  // namespace fingerpad
