// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Standard deviation that noise gives a stick ratio. If noise were drawn again, each dot near the
// limit could get the other answer, its neighbours with it, since their means share noise, and all
// dots together, since the fitted motion would be another one.
//
// The true slip of a dot is not known, only its mean m over neighbours, with a standard deviation s
// along x and y. It is taken to be 0 (the dot sticks) or any slip with equal probability. The odds
// of both follow from all dots of the frame.
#include <cmath>
#include <numbers>
#include <vector>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/detail/dots_in_order.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <scalar S>
class StickDoubts {
 public:
  /// For grids of `cells` dots in rows of `width`, with a border.
  StickDoubts(std::size_t cells, Index width) : width_(width), own_(cells, S(0)) {}

  /// Standard deviation of the ratio of these dots, at least one: k, now, weight in the fit, mean
  /// slip, its variance along an axis, and limit_sq. `sd`: of a position along an axis.
  template <class Pairs>
  S operator()(const Pairs& pairs, const S& sd, bool in_image) {
    using std::exp;
    using std::sqrt;
    const Fit fit = fit_of(pairs, sd, in_image);
    const Odds odds = odds_of(pairs);
    Effect all;
    std::fill(own_.begin(), own_.end(), S(0));
    for (const auto& p : pairs) {
      const S m = sqrt(squared_norm(p.mean)), limit = sqrt(p.limit_sq);
      const S off_sq = (m - limit) * (m - limit), over_sq = (m + limit) * (m + limit);
      const S noise = odds.sticking * m / p.variance * exp(-m * m / (S(2) * p.variance));
      const S slips = odds.per_slip / (noise + odds.per_slip);
      // variance p (1 - p) of the answer: of a dot that sticks, and the mean over the slips that
      // noise may have brought to m, 1/6 at the limit with an area of s / sqrt(pi)
      const S chance = exp(-p.limit_sq / (S(2) * p.variance));
      const S at_limit = exp(S(-pi * pi / 36) * off_sq / p.variance) / S(6);
      own_[p.k] = S(sqrt((S(1) - slips) * chance * (S(1) - chance) + slips * at_limit));
      // m is uncertain, a new answer again, and both by the motion. A slip of -limit is at the
      // limit too: a motion that is uncertain by more takes dots past it on both sides.
      const Effect of = fit.effect_on(p, m);
      const S width = S(2) * (S(2) * p.variance + fit.variance(of));
      const S density =
          slips * (exp(-off_sq / width) - exp(-over_sq / width)) / sqrt(S(pi) * width);
      all.shift += density * of.shift;
      all.turn = all.turn + density * of.turn;
      all.growth = all.growth + density * of.growth;
    }
    S sum = fit.variance(all);
    for (const auto& p : pairs) {
      sum = sum + own_[p.k] * shared(&own_[p.k]);
    }
    return S(sqrt(sum)) / number<S>(size_of(pairs));
  }

 private:
  static constexpr double pi = std::numbers::pi;

  /// Change of a slip, or of the number of sticking dots, by the motion.
  struct Effect {
    Point2<S> shift = {S(0), S(0)};
    S turn = S(0), growth = S(0);
  };
  /// Variances of the fitted motion about the center of its dots. A dot of weight w enters with 1/w
  /// of the noise: the less it follows, the more doubtful it is that it belongs to the object.
  struct Fit {
    Point3<S> center = {S(0), S(0), S(0)};
    S of_shift = S(0), of_turn = S(0), of_growth = S(0);

    template <class Pair>
    Effect effect_on(const Pair& p, const S& m) const {
      const Point2<S> along = value(m) > 0 ? p.mean / m : Point2<S>{S(0), S(0)};
      const Point2<S> arm = {p.now.x - center.x, p.now.y - center.y};
      return {along, arm.x * along.y - arm.y * along.x, dot(arm, along)};
    }
    S variance(const Effect& of) const {
      return of_shift * squared_norm(of.shift) + of_turn * of.turn * of.turn +
             of_growth * of.growth * of.growth;
    }
  };
  template <class Pairs>
  static Fit fit_of(const Pairs& pairs, const S& sd, bool in_image) {
    Fit fit;
    S mass = S(0), spread = S(0);
    for (const auto& p : pairs) {
      mass = mass + p.weight;
      fit.center += p.weight * p.now;
    }
    fit.center = fit.center / mass;
    for (const auto& p : pairs) {
      const Point3<S> arm = p.now - fit.center;
      spread = spread + p.weight * (arm.x * arm.x + arm.y * arm.y);
    }
    const S noise = S(2) * sd * sd;  // of a displacement
    fit.of_shift = noise / mass;
    fit.of_turn = value(spread) > 0 ? noise / spread : S(0);
    fit.of_growth = in_image ? fit.of_turn : S(0);
    return fit;
  }

  struct Odds {
    S sticking;  ///< dots with slip 0
    S per_slip;  ///< dots that slip, per unit of slip around the limit
  };
  /// Slipping dots are counted between the limit and three times the limit, less those that noise
  /// takes there. Half a dot is added: the mean of a rate after no event (Jeffreys' prior), without
  /// which a single dot at the limit would be certain.
  template <class Pairs>
  static Odds odds_of(const Pairs& pairs) {
    using std::exp;
    using std::sqrt;
    S within = S(0), beyond = S(0), limits = S(0);
    for (const auto& p : pairs) {
      const S sq = squared_norm(p.mean);
      limits = limits + S(sqrt(p.limit_sq));
      if (value(sq) < value(p.limit_sq)) {
        within = within + S(1);
        beyond = beyond - S(exp(-p.limit_sq / (S(2) * p.variance)));
      } else if (value(sq) < 9 * value(p.limit_sq)) {
        beyond = beyond + S(1);
      }
    }
    const S slipping = (value(beyond) > 0 ? beyond : S(0)) + S(0.5);
    const S sticking = within - slipping / S(2);
    return {value(sticking) > 0 ? sticking : S(0),
            slipping * number<S>(size_of(pairs)) / (S(2) * limits)};
  }

  /// Sum of the doubts around a dot, each times its correlation with that of the dot. Means of
  /// side and diagonal neighbours by weights 6, 2, 1 have correlations r of 32/56 and 20/56,
  /// answers near the limit (2 / pi) asin(r) (Sheppard 1899). Dots two apart have at most 1/15,
  /// which is neglected.
  S shared(const S* d) const {
    const Index w = width_;
    const S beside = d[-w] + d[-1] + d[1] + d[w];
    const S diagonal = d[-w - 1] + d[1 - w] + d[w - 1] + d[w + 1];
    return *d + S(0.387) * beside + S(0.2325) * diagonal;
  }

  Index width_;
  Bordered<S> own_;  // doubt of each dot, sqrt(p (1 - p))
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
