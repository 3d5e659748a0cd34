// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Whether a held object is about to slip, from what foam fingers feel and without a friction
// coefficient. Source: "Pre-Slip Sensing Using Tactile Sensor" (2007), the rule sets of its two
// experiments. The samples T_1, T_2, ... of all fingers lie in a stack; of any two of them, the
// older a (index 1) and the later b (index 2), there is pre-slip where
//
//   grasp-optimise  location(a) != location(b) and waves(a) == waves(b)      on all fingers
//   grasp-lift      centroid(a) != centroid(b) and location(a) != location(b)
//                   and waves(b) > waves(a)                                  on any finger
//
// "Index 2 decreased until the latest data is located" is read as: until it meets index 1, for each
// pair to be compared once (docs/errata.md, E042). What else the paper leaves open is a named
// choice: SamePair or AnyPair, MovedBeyond or MovedToOtherCell, AnyAxis or BothAxes, and
// PreslipOptions::min_waves.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/detail/pair_history.hpp"
#include "fingerpad/foam/detail/remembered_pairs.hpp"
#include "fingerpad/foam/finger_sample.hpp"
#include "fingerpad/foam/pair_rules.hpp"

namespace fingerpad {
inline namespace v0 {

// Three ways to find out whether a history of samples holds a pair that fulfils a rule. All give
// the same answer: of the pairs found, the one whose older sample is the latest, for that pair
// stays in the history longest.
//
//   AllPairs      as published: both indices go through the whole history. O(history^2)
//   NewestPairs   pairs of earlier samples were looked at before; only those with the newest are
//                 new. O(history)
//   ConstantTime  remembers, for each number of waves, the few samples that can still be asked for.
//                 O(1), and for grasp-lift O(waves)

/// As published: index 1 goes from the oldest sample on, and for each of its places index 2 from
/// the newest sample down to it.
struct AllPairs {
  template <class Rule, std::size_t Fingers>
  class Memory {
    static constexpr std::size_t tracks = detail::tracks<Rule, Fingers>();

   public:
    template <scalar S>
    explicit Memory(const PreslipOptions<S>& o) : history_(o.history) {}

    void clear() { history_.clear(); }

    detail::FoundPairs<tracks> operator()(const detail::HandSides<Fingers>& newest,
                                          double tolerance) {
      history_.add(newest);
      detail::FoundPairs<tracks> found;
      const std::int64_t last = history_.newest();
      for (std::size_t track = 0; track < tracks; ++track) {
        for (std::int64_t index_1 = history_.oldest(); index_1 < last; ++index_1) {
          for (std::int64_t index_2 = last; index_2 > index_1; --index_2) {
            if (detail::holds<Rule>(history_[index_1], history_[index_2], track, tolerance)) {
              found.add(track, last - index_1, index_2 == last);
            }
          }
        }
      }
      return found;
    }

   private:
    detail::SideHistory<Fingers> history_;
  };
};

namespace detail {

/// Pairs of the newest sample with what `Past` remembers of the earlier ones; pairs found before
/// stand as long as they are in the history.
template <class Rule, std::size_t Fingers, class Past>
class NewestAgainst {
  static constexpr std::size_t tracks = detail::tracks<Rule, Fingers>();

 public:
  template <scalar S>
  explicit NewestAgainst(const PreslipOptions<S>& o) : past_(o), standing_(o.history) {}

  void clear() {
    past_.clear();
    standing_.clear();
  }

  FoundPairs<tracks> operator()(const HandSides<Fingers>& newest, double tolerance) {
    const std::int64_t number = standing_.begin_sample();
    for (std::size_t track = 0; track < tracks; ++track) {
      if (can_be_later<Rule>(newest, track)) {
        standing_.add(track, past_.latest(newest, number, track, tolerance));
      }
    }
    past_.add(newest, number);
    return standing_.found();
  }

 private:
  Past past_;
  StandingPairs<tracks> standing_;
};

}  // namespace detail

/// The newest sample against the earlier ones, from the latest back to the first that fits.
struct NewestPairs {
  template <class Rule, std::size_t Fingers>
  using Memory = detail::NewestAgainst<Rule, Fingers, detail::SideColumns<Rule, Fingers>>;
};

/// Only what can still be asked for is remembered. Centroids must be rounded (MovedToOtherCell):
/// with a tolerance, any number of samples can each be the only answer to some question.
struct ConstantTime {
  template <class Rule, std::size_t Fingers>
  using Memory = detail::NewestAgainst<Rule, Fingers, detail::RememberedPairs<Rule, Fingers>>;
};

struct [[nodiscard]] PreslipResult {
  static constexpr std::int64_t none = -1;

  bool alarm = false;     ///< the history holds a pair that fulfils the rule
  bool is_fresh = false;  ///< the newest sample is the later one of such a pair
  std::int64_t samples_ago =
      none;  ///< when the older one was taken, of the pair that stays longest
};

/// Whether one older and one later sample of all fingers fulfil the rule: the predicate alone.
template <class Rule, std::size_t Fingers, scalar S>
bool is_preslip(const std::array<FingerSample<S>, Fingers>& older,
                const std::array<FingerSample<S>, Fingers>& later,
                const PreslipOptions<S>& options = {}) {
  const auto a = detail::hand_sides<Rule>(older, options);
  const auto b = detail::hand_sides<Rule>(later, options);
  const double apart = detail::apart_by<typename Rule::Centroid>(options);
  bool on_all_tracks = true;
  for (std::size_t track = 0; track < detail::tracks<Rule, Fingers>(); ++track) {
    on_all_tracks = on_all_tracks && detail::holds<Rule>(a, b, track, apart);
  }
  return on_all_tracks;
}

/// A rule over a history of samples. Rule: GraspOptimise or GraspLift; Search: AllPairs,
/// NewestPairs or ConstantTime, which all give the same answers. Const; each hand has a state of
/// its own. A sample allocates and throws nothing; its time is that of Search.
template <class Rule = GraspLift<>,
          std::size_t Fingers = 2,
          class Search = NewestPairs,
          scalar S = double>
class Preslip {
  static_assert(Fingers >= 1, "at least one finger");
  using Memory = typename Search::template Memory<Rule, Fingers>;

 public:
  /// The history. A value: copy it to go back to this sample later.
  class State {
   public:
    /// Forgets all samples.
    void reset() { memory_.clear(); }

   private:
    friend class Preslip;
    explicit State(const PreslipOptions<S>& options) : memory_(options) {}
    Memory memory_;
  };

  /// Refuses bad parameters (parameter_error).
  explicit Preslip(const PreslipOptions<S>& options = {}) : options_(options) {
    expects_valid(options);
    expects(!Rule::Centroid::is_rounded || value(options.centroid_tolerance_mm) > 0,
            "PreslipOptions", "centroid_tolerance_mm", options.centroid_tolerance_mm,
            "> 0 where centroids are rounded to it");
  }

  const PreslipOptions<S>& options() const { return options_; }

  /// Takes all memory.
  State start() const { return State(options_); }

  /// Adds the newest sample of all fingers to the history and says what the history then shows. A
  /// finger that does not vibrate, is not pressed, or whose sample could not be taken makes no pair
  /// beyond what that says; it never hides those of the others. A location of 2^31 or more is none.
  PreslipResult operator()(const std::array<FingerSample<S>, Fingers>& newest, State& state) const {
    const auto found = state.memory_(detail::hand_sides<Rule>(newest, options_),
                                     detail::apart_by<typename Rule::Centroid>(options_));
    PreslipResult result{true, false, 0};
    for (std::size_t track = 0; track < found.samples_ago.size(); ++track) {
      if (found.samples_ago[track] == detail::no_sample) {
        return {};
      }
      // where each finger has its own pair, the first to leave the history ends the alarm
      result.samples_ago = (std::max)(result.samples_ago, found.samples_ago[track]);
      result.is_fresh = result.is_fresh || found.with_newest[track];
    }
    return result;
  }

 private:
  PreslipOptions<S> options_;
};

}  // namespace v0
}  // namespace fingerpad
