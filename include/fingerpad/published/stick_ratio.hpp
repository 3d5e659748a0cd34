// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio by reference update as printed: Ito, Kim, Obinata, "Robust slippage degree
// estimation based on reference update of vision-based tactile sensor", with its backup slides: the
// reference dot's motion, its four neighbours' rotation and the scale of all neighbours, the newest
// stored frame beyond U, positions averaged over neighbours. docs/errata.md, E032-E038.
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The object moves as the reference dot does, rotates as its four neighbours do about it, and
/// scales as all neighbours in contact do. The noise of those dots is in every dot's answer. alpha
/// is from the distances between neighbouring dots across the direction in which they move, sums of
/// absolute values. Where nothing moves there is no direction and alpha is 1 (E036).
template <Freedom Free = Freedom::similarity>
struct ReferenceDotMotion {};

/// The conventional way that reference update is compared with: the first frame with contact, for
/// good. It tells stick from slip until the object first slips as a whole, turns round, or is
/// pressed harder.
struct FirstReference {
  static constexpr Index capacity = 1;
};

/// Positions are averaged before anything else; dots at the edge of the pattern stay. Two opposite
/// neighbours count or miss together: one alone would pull the mean by its distance. The weights
/// are not printed.
struct DotMean {
  DotWeights weights = {};
};

template <Freedom Free>
void expects_valid(const ReferenceDotMotion<Free>&) {}
inline void expects_valid(const FirstReference&) {}
inline void expects_valid(const DotMean& mean) {
  fingerpad::expects_valid(mean.weights, "DotMean");
}

/// What calibrate/slip.hpp has to know of them: dots at the edge of the pattern are not averaged,
/// and one reference dot has as much noise as the dot that is judged.
template <class Noise>
auto compared_noise_px(const DotMean&, const Noise& noise) {
  return noise.inner_px;
}
template <class Noise>
auto placed_noise_px(const DotMean&, const Noise& noise) {
  return noise.inner_px;
}
template <Freedom Free>
double motion_noise_factor(const ReferenceDotMotion<Free>&) {
  return 1.4142135623730951;
}

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

/// As printed, for dots in px. U_min is not printed.
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

/// Sums of distances between neighbours across their motion: what they were, and what they are.
template <class S>
struct ScaleSums {
  S then = S(0), now = S(0);
  S all = S(0);  ///< what `then` would be if all lay across

  /// Two dots; `moved` is the sum of their displacements, the object's rotation taken out.
  void add(const Point2<S>& e_then, const Point2<S>& e_now, const Point2<S>& moved) {
    using std::sqrt;
    const S moved_sq = squared_norm(moved);
    // 1e-12: what moves less has no direction
    if (S(1e-12) < moved_sq && is_distance_sq(moved_sq)) {
      const S size = sqrt(moved_sq);
      all = all + absolute(e_then.x) + absolute(e_then.y);
      then = then + absolute(S((e_then.x * moved.y - e_then.y * moved.x) / size));
      now = now + absolute(S((e_now.x * moved.y - e_now.y * moved.x) / size));
    }
  }
  static S absolute(const S& s) { return s < S(0) ? S(-s) : s; }
};

/// alpha of the frames, `rotated` being the object's motion without it; 1 where the pairs determine
/// none or one that is not plausible.
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
    return S(1);  // they all lie along the motion
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
    // about the dot itself, not the centroid of its neighbours: theta_0 as the angle of summed
    // products, which is the mean of four small angles and does not wrap (E034)
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
