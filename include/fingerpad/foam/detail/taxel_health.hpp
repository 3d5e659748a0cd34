// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which taxels of an array can be believed: not those that are missing, saturated or stuck, nor for
// a window after they were bad. Written as choices between numbers, without a branch and with
// columns that do not overlap, so that compilers treat many taxels at once.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <scalar S>
class TaxelHealth {
  using Real = scalar_real_t<S>;

 public:
  /// From what on a taxel is bad, and for how long.
  struct Limits {
    Real saturated_at;
    Real stuck_after;  // equal readings in a row; infinite: never
    Real window;       // samples
  };

  static constexpr Real infinite() { return (std::numeric_limits<Real>::infinity)(); }

  explicit TaxelHealth(Index taxels)
      : now_(static_cast<std::size_t>(taxels), S(0)),
        held_(now_),
        counts_(now_.size(), Real(0)),
        same_for_(counts_),
        bad_for_(counts_),
        floor_(counts_) {}

  std::size_t size() const { return now_.size(); }

  void forget() {
    std::fill(held_.begin(), held_.end(), S(0));
    std::fill(same_for_.begin(), same_for_.end(), Real(0));
    std::fill(bad_for_.begin(), bad_for_.end(), Real(0));
  }

  /// Where the readings of a sample go.
  S* incoming() { return now_.data(); }

  /// Judges them, with the `floor` of each taxel: infinite for a dead one.
  void judge(const Real* floor, const Limits& limits) {
    judge(size(), floor, limits, now_.data(), held_.data(), counts_.data(), same_for_.data(),
          bad_for_.data(), floor_.data());
  }

  /// The last good reading of each taxel.
  const S* held() const { return held_.data(); }
  /// What each presses with, 0 for those that do not count.
  const S* weights() const { return now_.data(); }
  /// The floors of those whose whole window is good, infinite for the others.
  const Real* floor() const { return floor_.data(); }
  /// 1 for each that counts now, 0 for the others.
  const Real* counts() const { return counts_.data(); }

 private:
  static void judge(std::size_t size,
                    const Real* __restrict floor,
                    const Limits& limits,
                    S* __restrict now,
                    S* __restrict held,
                    Real* __restrict counts,
                    Real* __restrict same_for,
                    Real* __restrict bad_for,
                    Real* __restrict floor_now) {
    const Real yes = Real(1), no = Real(0), none = infinite();
    const Real saturated_at = limits.saturated_at, stuck_after = limits.stuck_after;
    const Real window = limits.window;
    for (std::size_t k = 0; k < size; ++k) {
      const S reading = now[k], before = held[k];
      const Real x = value(reading), limit = floor[k];
      const Real finite = Real(x - x) == no ? yes : no;  // the difference of NaN is NaN
      const Real below = x < saturated_at ? yes : no;
      const Real good = finite * below;
      const Real equal = x == value(before) ? yes : no;
      const Real same = good * equal * Real(same_for[k] + yes);
      const Real one_less = bad_for[k] - yes;
      const Real left = one_less > no ? one_less : no;
      const Real bad = good > no ? left : window;
      const Real stands = same < stuck_after ? no : yes;
      const Real stuck = x == no ? no : stands;  // where 0 is read nothing presses
      const Real alive = limit < none ? yes : no;
      const Real counted = good * Real(yes - stuck) * alive;
      const Real positive = x > no ? yes : no;
      const Real presses = counted * positive, doubt = stuck + bad;
      held[k] = good > no ? reading : before;
      now[k] = presses > no ? reading : S(0);
      counts[k] = counted;
      same_for[k] = same;
      bad_for[k] = bad;
      floor_now[k] = doubt > no ? none : limit;
    }
  }

  std::vector<S> now_;
  std::vector<S> held_;
  std::vector<Real> counts_;    // 1 or 0
  std::vector<Real> same_for_;  // samples for which it did not change
  std::vector<Real> bad_for_;   // samples until it can vibrate again
  std::vector<Real> floor_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
