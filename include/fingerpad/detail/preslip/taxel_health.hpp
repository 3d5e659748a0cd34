// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which taxels of an array can be believed: not those that are missing, saturated or stuck, nor for
// a window after they were bad. Written as choices between numbers over whole columns, without a
// branch and a few columns at a time, so that compilers treat many taxels at once.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "fingerpad/grid.hpp"
#include "fingerpad/scalar.hpp"

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
        good_(now_.size(), Real(0)),
        same_for_(good_),
        bad_for_(good_),
        floor_(good_) {}

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
    hold(limits.saturated_at);
    count_bad(limits.window);
    find_counting(floor, limits.stuck_after);
    find_floors(floor, limits.stuck_after);
    weigh();
  }

  /// The last good reading of each taxel.
  const S* held() const { return held_.data(); }
  /// What each presses with, 0 for those that do not count.
  const S* weights() const { return now_.data(); }
  /// The floors of those whose whole window is good, infinite for the others.
  const Real* floor() const { return floor_.data(); }
  /// 1 for each that counts now, 0 for the others.
  const Real* counts() const { return good_.data(); }

 private:
  void hold(const Real& saturated_at) {
    const S* const now = now_.data();
    S* const held = held_.data();
    Real* const good = good_.data();
    Real* const same_for = same_for_.data();
    const Real yes = Real(1), no = Real(0);
    for (std::size_t k = 0; k < size(); ++k) {
      const S reading = now[k], before = held[k];
      const Real x = value(reading);
      const Real finite = Real(x - x) == no ? yes : no;  // the difference of NaN is NaN
      const Real below = x < saturated_at ? yes : no;
      const Real equal = x == value(before) ? yes : no;
      const Real usable = finite * below;
      const Real once_more = same_for[k] + yes;
      held[k] = usable > no ? reading : before;
      good[k] = usable;
      same_for[k] = usable * equal * once_more;
    }
  }

  void count_bad(const Real& window) {
    const Real* const good = good_.data();
    Real* const bad_for = bad_for_.data();
    const Real no = Real(0);
    for (std::size_t k = 0; k < size(); ++k) {
      const Real one_less = bad_for[k] - Real(1);
      const Real left = one_less > no ? one_less : no;
      bad_for[k] = good[k] > no ? left : window;
    }
  }

  /// 1 where a reading has not changed for long; where 0 is read, nothing presses and nothing
  /// moves.
  static Real is_stuck(const Real& x, const Real& same_for, const Real& stuck_after) {
    const Real yes = Real(1), no = Real(0);
    const Real stands = same_for < stuck_after ? no : yes;
    return x == no ? no : stands;
  }

  void find_counting(const Real* floor, const Real& stuck_after) {
    const S* const now = now_.data();
    const Real* const same_for = same_for_.data();
    Real* const good = good_.data();
    const Real yes = Real(1), no = Real(0), none = infinite();
    for (std::size_t k = 0; k < size(); ++k) {
      const Real stuck = is_stuck(value(now[k]), same_for[k], stuck_after);
      const Real alive = floor[k] < none ? yes : no;
      good[k] = good[k] * (yes - stuck) * alive;
    }
  }

  void find_floors(const Real* floor, const Real& stuck_after) {
    const S* const now = now_.data();
    const Real* const same_for = same_for_.data();
    const Real* const bad_for = bad_for_.data();
    Real* const floor_now = floor_.data();
    const Real no = Real(0), none = infinite();
    for (std::size_t k = 0; k < size(); ++k) {
      const Real doubt = is_stuck(value(now[k]), same_for[k], stuck_after) + bad_for[k];
      const Real limit = floor[k];
      floor_now[k] = doubt > no ? none : limit;
    }
  }

  void weigh() {
    S* const now = now_.data();
    const Real* const good = good_.data();
    const Real no = Real(0);
    for (std::size_t k = 0; k < size(); ++k) {
      const S reading = now[k];
      const Real positive = value(reading) > no ? good[k] : no;
      now[k] = positive > no ? reading : S(0);
    }
  }

  std::vector<S> now_;
  std::vector<S> held_;
  std::vector<Real> good_;      // 1 or 0: counts now
  std::vector<Real> same_for_;  // samples for which it did not change
  std::vector<Real> bad_for_;   // samples until it can vibrate again
  std::vector<Real> floor_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
