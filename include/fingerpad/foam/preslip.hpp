// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Warns before a held object slips, from the readings of foam fingers and without a friction
// coefficient. Source: "Pre-Slip Sensing Using Tactile Sensor" (2007), the rule sets of its two
// experiments. The samples T_1, T_2, ... of all fingers are kept in a stack. Two of them, the older
// a (index 1) and the later b (index 2), show pre-slip if
//
//   grasp-optimise  location(a) != location(b) and waves(a) == waves(b)      on all fingers
//   grasp-lift      centroid(a) != centroid(b) and location(a) != location(b)
//                   and waves(b) > waves(a)                                  on any finger
//
// "If there exist some tactile elements having the same frequency, then pre-slip can be
// recognized": location and waves are those of any element that vibrates; for grasp-optimise those
// of a may be on another finger. Each pair is compared once (docs/errata.md, E042): the newest
// sample with those before it. The scan of the whole stack as published, with the same answers, is
// in published/preslip.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/finger_sample.hpp"
#include "fingerpad/foam/preslip_status.hpp"

namespace fingerpad {
inline namespace v0 {

/// Thresholds of the rules. The paper prints no values.
template <scalar S = double>
struct PreslipOptions {
  Index history = 100;  ///< number of samples compared, in [2, 100000]
  /// A later sample with fewer waves counts as silent, >= 0. 0 as published: no waves in both
  /// samples are then an equal frequency.
  Index min_waves = 1;
  /// Noise of a centroid, >= 0: centroids differ if they are farther apart along an axis.
  S centroid_tolerance_mm = S(1) / S(10);
};

/// Refuses bad parameters (parameter_error).
template <scalar S>
void expects_valid(const PreslipOptions<S>& o) {
  expects(o.history >= 2 && o.history <= 100000, "PreslipOptions", "history",
          static_cast<long long>(o.history), "in [2, 100000]");
  expects(o.min_waves >= 0, "PreslipOptions", "min_waves", static_cast<long long>(o.min_waves),
          ">= 0");
  expects(is_finite(o.centroid_tolerance_mm) && value(o.centroid_tolerance_mm) >= 0,
          "PreslipOptions", "centroid_tolerance_mm", o.centroid_tolerance_mm, "finite and >= 0");
}

namespace detail {

/// A finger's sample as the rules use it.
struct PairSide {
  struct Vibration {
    Index location;
    std::int32_t waves;
    bool is_several;
    bool is_enough;  // at least min_waves, as a later sample must have
  };
  double x_mm = 0;
  double y_mm = 0;
  Index location = -1;  // of the strongest vibration, as are its waves
  Index waves = 0;
  bool is_pressed = false;
  // the strongest vibration has a location and at least min_waves
  bool is_vibrating = false;
  std::int32_t count = 0;
  std::array<Vibration, FingerSample<>::max_vibrations> vibrations = {};

  const Vibration* begin() const { return vibrations.data(); }
  const Vibration* end() const { return vibrations.data() + count; }
};

/// Whether the taxels of a and b include two different ones.
inline bool differ(const PairSide::Vibration& a, const PairSide::Vibration& b) {
  return a.is_several || b.is_several || a.location != b.location;
}

template <scalar S>
PairSide pair_side(const FingerSample<S>& s, const PreslipOptions<S>& o) {
  PairSide side;
  if (!s.can_tell()) {
    return side;
  }
  constexpr Index most = (std::numeric_limits<std::int32_t>::max)();
  const auto add = [&](Index location, Index waves, bool is_several) {
    if (location >= 0) {
      const auto counted = static_cast<std::int32_t>(std::clamp(waves, Index(0), most));
      side.vibrations[static_cast<std::size_t>(side.count++)] = {location, counted, is_several,
                                                                 waves >= o.min_waves};
    }
  };
  side.location = (std::max)(s.location, Index(-1));
  side.waves = (std::max)(s.waves, Index(0));
  side.is_vibrating = side.location >= 0 && s.waves >= o.min_waves;
  side.is_pressed = s.is_pressed();
  side.x_mm = static_cast<double>(value(s.center_x_mm));
  side.y_mm = static_cast<double>(value(s.center_y_mm));
  for (Index k = 0; k < s.vibration_count; ++k) {
    const auto& v = s.vibrations[static_cast<std::size_t>(k)];
    add(v.location, v.waves, v.is_several);
  }
  // no list: only the strongest vibration is known
  if (s.vibration_count == 0) {
    add(side.location, s.waves, false);
  }
  return side;
}

/// Whether the centroids differ by more than the tolerance along an axis.
inline bool has_moved(const PairSide& a, const PairSide& b, double tolerance_mm) {
  return a.is_pressed && b.is_pressed &&
         (std::fabs(a.x_mm - b.x_mm) > tolerance_mm || std::fabs(a.y_mm - b.y_mm) > tolerance_mm);
}

/// All fingers at one time.
template <std::size_t Fingers>
using HandSides = std::array<PairSide, Fingers>;

template <std::size_t Fingers, scalar S>
HandSides<Fingers> hand_sides(const std::array<FingerSample<S>, Fingers>& samples,
                              const PreslipOptions<S>& options) {
  HandSides<Fingers> sides;
  for (std::size_t f = 0; f < Fingers; ++f) {
    sides[f] = pair_side(samples[f], options);
  }
  return sides;
}

/// The last samples of the hand, numbered 0, 1, 2, ... from the start.
template <std::size_t Fingers>
class SideHistory {
 public:
  explicit SideHistory(Index size) : sides_(static_cast<std::size_t>(size)) {}

  void clear() { count_ = 0; }
  Index size() const { return static_cast<Index>(sides_.size()); }
  std::int64_t newest() const { return count_ - 1; }
  std::int64_t oldest() const { return (std::max)(std::int64_t{0}, count_ - size()); }
  const HandSides<Fingers>& operator[](std::int64_t number) const { return sides_[place(number)]; }
  /// Replaces the oldest sample once the history is full.
  void add(const HandSides<Fingers>& sides) { sides_[place(count_++)] = sides; }

 private:
  std::size_t place(std::int64_t number) const {
    return static_cast<std::size_t>(number) % sides_.size();
  }
  std::vector<HandSides<Fingers>> sides_;
  std::int64_t count_ = 0;
};

}  // namespace detail

/// Rule of the first experiment: on all fingers, a taxel vibrates with as many waves as another
/// taxel, of this or another finger, did at an earlier time. Use it when an object hangs between
/// fingers that press alike and the grip is loosened.
struct GraspOptimise {
  static constexpr const char* name = "grasp_optimise";

  template <std::size_t Fingers>
  static bool holds(const detail::HandSides<Fingers>& older,
                    const detail::HandSides<Fingers>& later,
                    double) {
    for (std::size_t f = 0; f < Fingers; ++f) {
      if (!is_alike(older, later[f], f)) {
        return false;
      }
    }
    return true;
  }

 private:
  template <std::size_t Fingers>
  static bool is_alike(const detail::HandSides<Fingers>& older,
                       const detail::PairSide& later,
                       std::size_t finger) {
    for (std::size_t g = 0; g < Fingers; ++g) {
      for (const auto& a : older[g]) {
        for (const auto& b : later) {
          if (a.waves == b.waves && b.is_enough && (g != finger || detail::differ(a, b))) {
            return true;
          }
        }
      }
    }
    return false;
  }
};

/// Rule of the second experiment: on any finger, the centroid of force has moved, and a taxel
/// vibrates with more waves than another taxel did before, or none did. Use it in all other cases.
struct GraspLift {
  static constexpr const char* name = "grasp_lift";

  template <std::size_t Fingers>
  static bool holds(const detail::HandSides<Fingers>& older,
                    const detail::HandSides<Fingers>& later,
                    double tolerance_mm) {
    for (std::size_t f = 0; f < Fingers; ++f) {
      if (detail::has_moved(older[f], later[f], tolerance_mm) && has_risen(older[f], later[f])) {
        return true;
      }
    }
    return false;
  }

 private:
  static bool has_risen(const detail::PairSide& older, const detail::PairSide& later) {
    for (const auto& b : later) {
      bool is_above = older.count == 0;
      for (const auto& a : older) {
        is_above = is_above || (a.waves < b.waves && detail::differ(a, b));
      }
      if (is_above && b.is_enough && b.waves > 0) {
        return true;
      }
    }
    return false;
  }
};

struct [[nodiscard]] PreslipResult {
  static constexpr std::int64_t none = -1;

  /// What to act on: `preslip` if the newest sample completes a pair.
  PreslipStatus status = PreslipStatus::cannot_tell;
  bool alarm = false;     ///< the history holds a pair that fulfils the rule
  bool is_fresh = false;  ///< the newest sample is the later one of such a pair
  std::int64_t samples_ago =
      none;  ///< age in samples of the older one of the pair that stays in the history longest

  /// Whether the fingers could be judged.
  bool ok() const { return status != PreslipStatus::cannot_tell; }
};

/// Whether one older and one later sample of all fingers fulfil the rule. This is the predicate
/// alone, without a history.
template <class Rule, std::size_t Fingers, scalar S>
bool is_preslip(const std::array<FingerSample<S>, Fingers>& older,
                const std::array<FingerSample<S>, Fingers>& later,
                const PreslipOptions<S>& options = {}) {
  return Rule::holds(detail::hand_sides(older, options), detail::hand_sides(later, options),
                     static_cast<double>(value(options.centroid_tolerance_mm)));
}

namespace detail {
/// Pre-slip if `is_fresh`; otherwise it depends on whether all fingers can be judged.
template <std::size_t Fingers, scalar S>
PreslipStatus preslip_status(const std::array<FingerSample<S>, Fingers>& newest, bool is_fresh) {
  const bool can_tell = std::all_of(newest.begin(), newest.end(),
                                    [](const FingerSample<S>& s) { return s.can_tell(); });
  return is_fresh   ? PreslipStatus::preslip
         : can_tell ? PreslipStatus::steady
                    : PreslipStatus::cannot_tell;
}
}  // namespace detail

/// Applies a rule to a history of samples. Rule: GraspLift or GraspOptimise; those as printed are
/// in published/preslip.hpp. Const; each hand has its own state. A sample takes O(history) time,
/// allocates nothing and throws nothing.
template <class Rule = GraspLift, std::size_t Fingers = 2, scalar S = double>
class Preslip {
  static_assert(Fingers >= 1, "at least one finger");

 public:
  /// The history. A value: copy it to return to this sample later.
  class State {
   public:
    /// Forgets all samples.
    void reset() {
      history_.clear();
      older_ = PreslipResult::none;
    }

   private:
    friend class Preslip;
    explicit State(Index history) : history_(history) {}
    detail::SideHistory<Fingers> history_;
    // the latest older sample of the pairs found
    std::int64_t older_ = PreslipResult::none;
  };

  /// Refuses bad parameters (parameter_error).
  explicit Preslip(const PreslipOptions<S>& options = {}) : options_(options) {
    expects_valid(options);
  }

  const PreslipOptions<S>& options() const { return options_; }

  /// The state before any sample, with all the memory that samples will need.
  State start() const { return State(options_.history); }

  /// Adds the newest sample of all fingers to the history and applies the rule. A finger that
  /// cannot be judged forms no pair, never hides the pairs of other fingers, and never counts as
  /// steady. The state of an estimator with another history is refused: nothing is done,
  /// `cannot_tell`.
  PreslipResult operator()(const std::array<FingerSample<S>, Fingers>& newest, State& state) const {
    PreslipResult result;
    auto& history = state.history_;
    if (history.size() != options_.history) {
      return result;
    }
    history.add(detail::hand_sides(newest, options_));
    const double tolerance = static_cast<double>(value(options_.centroid_tolerance_mm));
    const std::int64_t last = history.newest();
    const bool vibrates = std::any_of(history[last].begin(), history[last].end(),
                                      [](const detail::PairSide& side) { return side.count > 0; });
    const std::int64_t oldest = vibrates ? history.oldest() : last;  // otherwise there is no pair
    for (std::int64_t older = last - 1; older >= oldest && !result.is_fresh; --older) {
      result.is_fresh = Rule::holds(history[older], history[last], tolerance);
      state.older_ = result.is_fresh ? (std::max)(state.older_, older) : state.older_;
    }
    result.alarm = state.older_ != PreslipResult::none && state.older_ >= history.oldest();
    result.samples_ago = result.alarm ? last - state.older_ : PreslipResult::none;
    result.status = detail::preslip_status(newest, result.is_fresh);
    return result;
  }

 private:
  PreslipOptions<S> options_;
};

}  // namespace v0
}  // namespace fingerpad
