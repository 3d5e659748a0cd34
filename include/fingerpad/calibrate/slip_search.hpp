// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which U are tried on a recording and what is said of each; the thresholds that noise sets.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "fingerpad/calibrate/slip_measures.hpp"
#include "fingerpad/calibrate/slip_noise.hpp"
#include "fingerpad/calibrate/slip_threshold.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

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
  Index min_steps = 20;      ///< >= 2: frames with contact and motion
  Index min_updates = 10;    ///< >= 1: frames with an answer of their own
  double stick_and_slip = 0.5;  ///< in (0, 1): with the best U some answers have to be above and
                                ///< some below, three each, since one may be wrong
  Index min_dots = 5;         ///< as in StickTest
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
  expects(search.min_updates >= 1, owner, "min_updates",
          static_cast<long long>(search.min_updates), ">= 1");
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
inline double compared_noise_px(const DotMean&, const DotNoise& noise) {
  return noise.inner_px;  // dots at the edge of the pattern are not averaged
}
inline double compared_noise_px(const ResidualMean&, const DotNoise& noise) {
  return noise.edge_px > noise.inner_px || !is_finite(noise.inner_px) ? noise.edge_px
                                                                      : noise.inner_px;
}
/// sigma of a position in d_max.
template <class Denoising>
double placed_noise_px(const Denoising&, const DotNoise& noise) {
  return noise.noise_px;
}
inline double placed_noise_px(const DotMean&, const DotNoise& noise) {
  return noise.inner_px;
}

/// By how much the object's motion adds to a dot's noise: of many dots next to nothing, of one
/// reference dot as much again.
template <Freedom Free, class Dot>
double motion_noise_factor(const StickConsensus<Free, Dot>&) {
  return 1;
}
template <Freedom Free, class Scale, class Dot>
double motion_noise_factor(const ReferenceDotMotion<Free, Scale, Dot>&) {
  return 1.4142135623730951;
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
  const double compared_px = detail::stick::compared_noise_px(denoising, noise);
  const double placed_px = detail::stick::placed_noise_px(denoising, noise);
  expects(is_finite(placed_px) && placed_px > 0, owner, "noise of a dot", placed_px,
          "finite and > 0");
  expects(is_finite(compared_px) && compared_px > 0, owner, "noise of an averaged dot", compared_px,
          "finite and > 0");
  StickTest test;
  test.reference_px = reference_px;
  test.slip_px = slip_threshold_for(compared_px * detail::stick::motion_noise_factor(motion),
                                    search.false_slip);
  test.store_px = slip_threshold_for(placed_px, false_slip_of_each(search.false_motion, dots));
  test.min_dots = search.min_dots;
  expects(is_finite(reference_px) && reference_px > (std::max)(test.slip_px, test.store_px), owner,
          "reference_px", reference_px, "finite and > slip_px and store_px, which noise sets");
  expects_valid(test);
  return test;
}

}  // namespace v0
}  // namespace fingerpad
