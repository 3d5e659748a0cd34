// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Three ways to find out whether a history of samples holds a pair that fulfils a rule. All give
// the same answer: of the pairs found, the one whose older sample is the latest, for that pair
// stays in the history longest.
//
//   AllPairs      as published: both indices go through the whole history. O(history^2)
//   NewestPairs   pairs of earlier samples were looked at before; only those with the newest are
//                 new. O(history)
//   ConstantTime  remembers, for each number of waves, the few samples that can still be asked for.
//                 O(1), and for grasp-lift O(waves)
#include <cstddef>
#include <cstdint>

#include "fingerpad/foam/detail/pair_columns.hpp"
#include "fingerpad/foam/detail/pair_history.hpp"
#include "fingerpad/foam/pair_rules.hpp"
#include "fingerpad/foam/detail/remembered_pairs.hpp"

namespace fingerpad {
inline namespace v0 {

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

}  // namespace v0
}  // namespace fingerpad
