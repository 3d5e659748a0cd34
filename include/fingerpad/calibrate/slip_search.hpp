// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which U are tried on a recording and what is said of each; the thresholds that noise sets.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "fingerpad/calibrate/slip_noise.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

// How good a sequence of stick ratios is. Source: "Two measures for U" of 003:
//   S = sum of phi_i                            the earlier the ratio falls, the smaller
//   D = sum of phi_(i-1) - phi_i where it falls "regarded as the level of estimation error"
// D contains the fall that there is to measure: D = (phi_1 - phi_n) + sum of the rises (E038). The
// error is what is left without it, D' = D - (phi_1 - phi_n), the sum of the rises: 0 for a ratio
// that only falls. A ratio that never changes has D' = 0 too, so D' says nothing without S.

struct RatioMeasures {
  double sum = 0;        ///< S
  double decreases = 0;  ///< D
  double rises = 0;      ///< D'; added up as such, so it is >= 0 and exact where it is 0
  Index steps = 0;       ///< ratios that are numbers

  double sum_per_step() const { return per_step(sum); }
  double decreases_per_step() const { return per_step(decreases); }
  double rises_per_step() const { return per_step(rises); }

 private:
  double per_step(double of) const {
    return steps > 0 ? of / static_cast<double>(steps) : not_a_number<double>();
  }
};

/// Of the ratios of all frames in turn. A frame whose answer was kept counts as a step with the
/// last ratio: it adds to S, as slip that is not yet known is late, and nothing to D and D'. NaN
/// (no contact) is no step, and what comes after it is not compared with what was before. O(steps).
template <scalar S>
RatioMeasures measures_of(std::span<const S> ratios) {
  RatioMeasures m;
  double before = not_a_number<double>();
  for (const S& ratio : ratios) {
    const double now = static_cast<double>(value(ratio));
    if (is_finite(now)) {
      m.sum += now;
      m.decreases += now < before ? before - now : 0;
      m.rises += before < now ? now - before : 0;
      ++m.steps;
    }
    before = now;
  }
  return m;
}

// The threshold of slip from the noise of the dots, and the probability that it is wrong.
// Source: "Selection of delta_0" of 003, corrected (docs/errata.md, E037).
//
// A dot is tested by the difference of its positions in two frames. With Gaussian noise of standard
// deviation sigma per axis in each, both axes of the difference have sigma sqrt(2), and its length
// r is Rayleigh distributed:
//   p = P(r > delta_0) = exp(-delta_0^2 / (4 sigma^2)).
// The published delta_0 = 4 sigma, said to hold 95.44 %, holds 1 - exp(-4) = 98.17 %: 1.83 % of the
// sticking dots are taken for slipping.

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

/// Which U are tried, and what is asked of them.
///
/// Published: "desirable: U, S and D are small", and U = 2.0 px by eye. Here the best is the U with
/// the lowest S + D', in which a step counts 1 that has no answer of its own: slip is not seen
/// then, and an old answer that happens to be low is no merit. Of those that are not worse by more
/// than two standard errors, which the recording hardly tells apart, the smallest is taken, as it
/// answers soonest. D' alone would choose a U so small or so large that nothing is ever seen to
/// slip. Frames on which the pad stands still are no steps: how long it stands says nothing of U.
struct ReferenceSearch {
  double smallest_px = 0.5;    ///< > 0
  double largest_px = 8;       ///< > smallest_px
  int candidates = 13;         ///< 2 to 1000, in equal ratios; by default three to the octave
  double false_slip = 0.02;    ///< in (0, 1): probability that a sticking dot that lacks neighbours
                               ///< is taken for slipping; less for others. Published: 0.0183
  double false_motion = 0.01;  ///< in (0, 1): that a standing pad is taken for moving, for U_min
  double sampling_errors = 2;  ///< >= 0: how much worse than the best is as good
  Index min_steps = 20;        ///< >= 2: frames with contact and motion
  Index min_updates = 10;      ///< >= 1: frames with an answer of their own
  double stick_and_slip = 0.5;  ///< in (0, 1): with the best U some answers have to be above and
                                ///< some below, three each, since one may be wrong
  Index min_dots = 5;           ///< as in StickTest
};
inline void expects_valid(const ReferenceSearch& search) {
  const char* const owner = "ReferenceSearch";
  const auto in_unit = [&](const double& share, const char* name) {
    expects(share > 0 && share < 1, owner, name, share, "in (0, 1)");
  };
  expects(is_finite(search.smallest_px) && search.smallest_px > 0, owner, "smallest_px",
          search.smallest_px, "finite and > 0");
  expects(is_finite(search.largest_px) && search.largest_px > search.smallest_px, owner,
          "largest_px", search.largest_px, "finite and > smallest_px");
  expects(search.candidates >= 2 && search.candidates <= 1000, owner, "candidates",
          static_cast<long long>(search.candidates), "in [2, 1000]");
  in_unit(search.false_slip, "false_slip");
  in_unit(search.false_motion, "false_motion");
  expects(is_finite(search.sampling_errors) && search.sampling_errors >= 0, owner,
          "sampling_errors", search.sampling_errors, "finite and >= 0");
  expects(search.min_steps >= 2, owner, "min_steps", static_cast<long long>(search.min_steps),
          ">= 2");
  expects(search.min_updates >= 1, owner, "min_updates", static_cast<long long>(search.min_updates),
          ">= 1");
  in_unit(search.stick_and_slip, "stick_and_slip");
}

enum class ReferenceVerdict : std::uint8_t {
  chosen,
  as_good,         ///< as the best, to within the sampling error
  worse,           ///< than the best
  rarely_updated,  ///< the dots moved further than U too seldom
  below_noise,     ///< U is not larger than both thresholds: not tried
};

/// "chosen", "as good", ...
constexpr const char* name_of(ReferenceVerdict verdict) {
  switch (verdict) {
    case ReferenceVerdict::chosen:
      return "chosen";
    case ReferenceVerdict::as_good:
      return "as good";
    case ReferenceVerdict::worse:
      return "worse";
    case ReferenceVerdict::rarely_updated:
      return "rarely updated";
    case ReferenceVerdict::below_noise:
      return "below noise";
  }
  return "unknown";
}

/// A row of the table: what one U makes of the recording. The ratio is 1 in S as long as none is
/// known.
struct ReferenceCandidate {
  StickTest test;
  ReferenceVerdict verdict = ReferenceVerdict::below_noise;
  RatioMeasures ratios;                          ///< S, D, D'
  Index updates = 0;                             ///< frames with an answer of their own
  Index sticking = 0;                            ///< of them, those above stick_and_slip
  Index slipping = 0;                            ///< of them, those below
  double cost = not_a_number<double>();          ///< S + D' as the search counts it
  double behind = not_a_number<double>();        ///< cost less that of the best
  double behind_error = not_a_number<double>();  ///< its sampling error: the standard deviation of
                                                 ///< the sum of as many independent steps
};

struct StickTestChoice {
  StickTest test;                         ///< for StickRatio
  std::vector<ReferenceCandidate> table;  ///< from the smallest U to the largest
  Index steps = 0;                        ///< frames with contact and motion
  double furthest_px = 0;                 ///< the largest d_max of the smallest U that was tried
};

namespace detail::stick {

/// sigma of a position in the difference that is compared with delta_0: that of the dots with the
/// most noise of those that are averaged.
inline double compared_noise_px(const NoDenoising&, const DotNoise& noise) {
  return noise.noise_px;
}
inline double compared_noise_px(const ResidualMean&, const DotNoise& noise) {
  return noise.edge_px > noise.inner_px || !is_finite(noise.inner_px) ? noise.edge_px
                                                                      : noise.inner_px;
}
/// sigma of a position in d_max.
inline double placed_noise_px(const NoDenoising&, const DotNoise& noise) {
  return noise.noise_px;
}
inline double placed_noise_px(const ResidualMean&, const DotNoise& noise) {
  return noise.noise_px;
}

/// By how much the object's motion adds to a dot's noise: of many dots next to nothing.
template <Freedom Free>
double motion_noise_factor(const StickConsensus<Free>&) {
  return 1;
}

}  // namespace detail::stick

/// delta_0 and U_min for a sensor with this noise, U being given (by default the published one).
/// Refuses noise that makes U too small (parameter_error).
template <class Motion = StickConsensus<>, class Denoising = ResidualMean>
StickTest stick_test_for(Index dots,
                         const DotNoise& noise,
                         double reference_px = StickTest{}.reference_px,
                         const ReferenceSearch& search = {},
                         const Motion& motion = {},
                         const Denoising& denoising = {}) {
  const char* const owner = "stick_test_for";
  expects_valid(search);
  expects(dots >= 1, owner, "dots", static_cast<long long>(dots), ">= 1");
  using detail::stick::compared_noise_px;  // published policies bring their own
  using detail::stick::motion_noise_factor;
  using detail::stick::placed_noise_px;
  const double compared_px = compared_noise_px(denoising, noise);
  const double placed_px = placed_noise_px(denoising, noise);
  expects(is_finite(placed_px) && placed_px > 0, owner, "noise of a dot", placed_px,
          "finite and > 0");
  expects(is_finite(compared_px) && compared_px > 0, owner, "noise of an averaged dot", compared_px,
          "finite and > 0");
  StickTest test;
  test.reference_px = reference_px;
  test.slip_px = slip_threshold_for(compared_px * motion_noise_factor(motion), search.false_slip);
  test.store_px = slip_threshold_for(placed_px, false_slip_of_each(search.false_motion, dots));
  test.min_dots = search.min_dots;
  expects(is_finite(reference_px) && reference_px > (std::max)(test.slip_px, test.store_px), owner,
          "reference_px", reference_px, "finite and > slip_px and store_px, which noise sets");
  expects_valid(test);
  return test;
}

}  // namespace v0
}  // namespace fingerpad
