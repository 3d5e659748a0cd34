// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio by reference update as printed: Ito, Kim, Obinata, "Robust slippage degree
// estimation based on reference update of vision-based tactile sensor", with its backup slides. The
// object's motion is the displacement of the reference dot, the rotation of its four neighbours and
// the scale of all neighbours. The reference is the newest stored frame beyond U, and positions are
// averaged over neighbours. docs/errata.md, E032-E038.
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The object is displaced like the reference dot, rotated like its four neighbours about it, and
/// scaled like all neighbours in contact. The noise of those dots affects the answer for every dot.
/// alpha is the ratio of two sums of absolute distances between neighbouring dots, taken
/// perpendicular to their motion. Without motion there is no direction and alpha is 1 (E036).
template <Freedom Free = Freedom::similarity>
struct ReferenceDotMotion {};

/// The conventional method, with which the slides compare reference update: the reference is always
/// the first frame with contact. It tells stick from slip until the object first slips as a whole,
/// reverses its motion, or is pressed harder.
struct FirstReference {
  static constexpr Index capacity = 1;
};

/// Averages positions before all other steps; dots at the edge of the pattern stay as they are. Two
/// opposite neighbours are used only together, because one alone would pull the mean toward itself.
/// The source does not print the weights.
struct DotMean {
  DotWeights weights = {};
};

template <Freedom Free>
void expects_valid(const ReferenceDotMotion<Free>&) {}
inline void expects_valid(const FirstReference&) {}
inline void expects_valid(const DotMean& mean) {
  fingerpad::expects_valid(mean.weights, "DotMean");
}

// Quality of a sequence of stick ratios. Source: "Two measures for U" of 003:
//   S = sum of phi_i                              smaller the earlier the ratio falls
//   D = sum of phi_(i-1) - phi_i over its falls   "regarded as the level of estimation error"
// D includes the true fall: D = (phi_1 - phi_n) + sum of the rises (E038). The error is therefore
// D' = D - (phi_1 - phi_n), the sum of the rises. It is 0 for a ratio that only falls, but also for
// one that never changes, so D' is meaningful only together with S.

struct RatioMeasures {
  double sum = 0;        ///< S
  double decreases = 0;  ///< D
  double rises = 0;      ///< D', summed directly: >= 0, and exactly 0 without rises
  Index steps = 0;       ///< number of finite ratios

  double sum_per_step() const { return per_step(sum); }
  double decreases_per_step() const { return per_step(decreases); }
  double rises_per_step() const { return per_step(rises); }

 private:
  double per_step(double of) const {
    return steps > 0 ? of / static_cast<double>(steps) : not_a_number<double>();
  }
};

/// Measures of the ratios of all frames in order. A frame without a new answer counts as a step
/// with the last ratio. It adds to S, because slip not yet detected is late, and nothing to D and
/// D'. NaN (no contact) is no step, and the ratios before and after it are not compared. O(steps).
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

/// The printed values, for dots in px. U_min (`store`) is not printed.
inline constexpr StickTest stick_test_px = {.reference = 2, .store = 0.5, .slip = 0.24, .pitch = 1};

template <scalar S = float>
using StickRatio = fingerpad::StickRatio<ReferenceDotMotion<>, UpdatedReference, DotMean, S>;

/// For a grid of rows x cols dots. Refuses bad parameters (parameter_error).
template <scalar S = float>
StickRatio<S> stick_ratio(Index rows, Index cols, const StickTest& test = stick_test_px) {
  return StickRatio<S>(rows, cols, test);
}

}  // namespace published

namespace detail::stick {

// ---- reference

template <class P, class S>
Choice<S> choose_reference(const published::FirstReference&,
                           const std::vector<Index>& touching,
                           const P* now,
                           const Repository<P>& stored,
                           const S& reference_sq,
                           const S&) {
  Choice<S> choice;
  if (stored.size() > 0) {
    choice.furthest_sq = furthest_sq(touching, now, stored.dots(0));
    choice.age = reference_sq < choice.furthest_sq ? 0 : -1;
  }
  return choice;
}
template <class P>
bool is_stored(const published::FirstReference&, const Repository<P>& stored) {
  return stored.size() == 0;
}

// ---- motion

/// Sums of distances between neighbours perpendicular to their motion, in the reference frame and
/// now.
template <class S>
struct ScaleSums {
  S then = S(0), now = S(0);
  S all = S(0);  ///< sum of |x| + |y| of the distances then: scale for roundoff

  /// Adds a pair of dots. `moved` is the sum of their displacements without the object's rotation.
  void add(const Point2<S>& e_then, const Point2<S>& e_now, const Point2<S>& moved) {
    using std::sqrt;
    const S moved_sq = squared_norm(moved);
    // 1e-12: a smaller motion has no direction
    if (S(1e-12) < moved_sq && is_distance_sq(moved_sq)) {
      const S size = sqrt(moved_sq);
      all = all + absolute(e_then.x) + absolute(e_then.y);
      then = then + absolute(S((e_then.x * moved.y - e_then.y * moved.x) / size));
      now = now + absolute(S((e_now.x * moved.y - e_now.y * moved.x) / size));
    }
  }
  static S absolute(const S& s) { return s < S(0) ? S(-s) : s; }
};

/// alpha between the two frames. `rotated` is the object's motion without scaling. 1 if the pairs
/// do not determine alpha, or its value is not plausible.
template <class S>
S scale_between(const FramePair<S>& pair, const Similarity<S>& rotated) {
  const Point2<S> object = rotated.now_at - rotated.then_at;
  const auto moved = [&](const Point2<S>& now, const Point2<S>& then) {
    return rotated.residual(now, then);
  };
  constexpr std::array<std::pair<int, int>, 4> steps = {{{0, 1}, {1, -1}, {1, 0}, {1, 1}}};
  ScaleSums<S> sums;
  for (const Index k : pair.touching) {
    const Point2<S> a = moved(pair.now[k], pair.then[k]);
    for (const auto& [down, right] : steps) {
      const Point2<S> then = beside(pair.then, pair.layout, k, down, right);
      const Point2<S> b = moved(beside(pair.now, pair.layout, k, down, right), then);
      const Point2<S> e_then = pair.then[k] - then;
      sums.add(e_then, e_then + a - b, a + b + S(2) * object);
    }
  }
  const S roundoff = S(1000 * epsilon<S>()) * sums.all;
  if (!(roundoff < sums.then)) {
    return S(1);  // all pairs lie along the motion
  }
  const S alpha = sums.then / sums.now;
  return is_plausible_scale(alpha) ? alpha : S(1);
}

template <Freedom Free, class S>
Similarity<S> motion_between(const published::ReferenceDotMotion<Free>&,
                             const FramePair<S>& pair,
                             Index reference,
                             const S&,
                             bool) {
  using std::sqrt;
  Similarity<S> map = {S(1), S(0), pair.now[reference], pair.then[reference]};
  if constexpr (may_rotate(Free)) {
    PairSums<S> sums;
    constexpr std::array<std::pair<int, int>, 4> steps = {{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}};
    for (const auto& [down, right] : steps) {
      const Point2<S> now = beside(pair.now, pair.layout, reference, down, right) - map.now_at;
      const Point2<S> then = beside(pair.then, pair.layout, reference, down, right) - map.then_at;
      if (is_distance_sq(S(squared_norm(now) + squared_norm(then)))) {
        sums.add(S(1), now, then);
      }
    }
    // theta_0 about the dot itself, not about the centroid of its neighbours. The angle of the
    // summed products is the mean of four small angles and does not wrap (E034).
    const S size_sq = sums.along * sums.along + sums.across * sums.across;
    if (S(0) < size_sq) {
      const S size = sqrt(size_sq);
      map.cosine = sums.along / size;
      map.sine = sums.across / size;
    }
  }
  if constexpr (may_scale(Free)) {
    const S alpha = scale_between(pair, map);
    map.cosine = alpha * map.cosine;
    map.sine = alpha * map.sine;
  }
  return map;
}

// ---- denoising

template <class S>
void denoise_positions(const published::DotMean& mean,
                       const GivenDots<Point2<S>>& given,
                       const DotLayout& layout,
                       Dots<Point2<S>>& now) {
  const auto placed = [&](const DotIndex& d, Index down, Index right) {
    const Index k = (d.row + down) * layout.cols + d.col + right;
    return is_out_of_place(given.found.data(), layout, layout.dot_at(k)) ? no_dot<Point2<S>>()
                                                                         : at(given.found, k);
  };
  constexpr std::array<std::pair<int, int>, 4> steps = {{{0, 1}, {1, 0}, {1, -1}, {1, 1}}};
  for (const Index k : given.touching) {
    const DotIndex d = layout.dot_at(k);
    const bool inner = d.row > 0 && d.col > 0 && d.row + 1 < layout.rows && d.col + 1 < layout.cols;
    if (!inner || !is_finite(at(now, k))) {
      continue;
    }
    Point2<S> sum = {S(0), S(0)};
    double weight = mean.weights.self;
    for (const auto& [down, right] : steps) {
      const Point2<S> off =
          placed(d, down, right) + placed(d, -down, -right) - S(2) * at(given.found, k);
      if (is_distance_sq(squared_norm(off))) {
        const double w = down == 0 || right == 0 ? mean.weights.side : mean.weights.diagonal;
        sum += S(w) * off;
        weight += 2 * w;
      }
    }
    at(now, k) += sum / S(weight);
  }
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
