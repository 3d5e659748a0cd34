// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What each rule must remember of its samples to find the latest that makes a pair with a newer
// one, without going through them.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/foam/detail/pair_history.hpp"
#include "fingerpad/foam/pair_rules.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// "Which was the latest sample that differs from this one in every coordinate?", in O(1) and with
// 2, 5 or 16 samples remembered of any number (1, 2 or 3 coordinates).
//
// Why so few are enough. The latest sample of all answers each question but those that share a
// coordinate with it. For the questions that share its coordinate d, the latest sample that differs
// there answers, but for those that share one more coordinate with it, and so on: at most one
// sample for each way to fix coordinates one after the other. A new sample answers first wherever
// it can; where it cannot, a sample remembered before does, so no other need be kept.

template <std::size_t Coordinates>
class LatestDiffering {
  static_assert(Coordinates >= 1 && Coordinates <= 3, "at most three coordinates");

 public:
  using Point = std::array<std::int64_t, Coordinates>;
  static constexpr std::int64_t none = -1;

  void clear() { count_ = 0; }

  /// The number of the latest sample that differs from `point` in every coordinate.
  std::int64_t operator()(const Point& point) const {
    const std::size_t found = first(entries_, count_, point, all);
    return found < count_ ? entries_[found].number : none;
  }

  /// Samples come in the order of their numbers.
  void add(const Point& point, std::int64_t number) {
    Selection selection;
    selection.candidates[0] = {point, number};
    for (std::size_t i = 0; i < count_; ++i) {
      selection.candidates[i + 1] = entries_[i];
    }
    selection.count = count_ + 1;
    select({}, 0, selection);
    count_ = 0;
    for (std::size_t i = 0; i < selection.count; ++i) {
      if (selection.is_kept[i]) {
        entries_[count_++] = selection.candidates[i];
      }
    }
  }

 private:
  struct Entry {
    Point point = {};
    std::int64_t number = none;
  };
  static constexpr std::size_t most = Coordinates == 1 ? 2 : Coordinates == 2 ? 5 : 16;
  static constexpr unsigned all = (1U << Coordinates) - 1U;

  struct Selection {
    std::array<Entry, most + 1> candidates;  // latest first
    std::array<bool, most + 1> is_kept = {};
    std::size_t count = 0;
  };

  /// The first of `entries` that differs from `point` in the coordinates of the set `fixed`.
  template <std::size_t N>
  static std::size_t first(const std::array<Entry, N>& entries,
                           std::size_t count,
                           const Point& point,
                           unsigned fixed) {
    for (std::size_t i = 0; i < count; ++i) {
      bool differs = true;
      for (std::size_t d = 0; d < Coordinates; ++d) {
        differs = differs && ((fixed >> d & 1U) == 0 || entries[i].point[d] != point[d]);
      }
      if (differs) {
        return i;
      }
    }
    return count;
  }

  /// Keeps what answers the questions that have the `fixed` coordinates in common with `point`.
  static void select(const Point& point, unsigned fixed, Selection& selection) {
    const std::size_t found = first(selection.candidates, selection.count, point, fixed);
    if (found == selection.count) {
      return;
    }
    selection.is_kept[found] = true;
    for (std::size_t d = 0; d < Coordinates; ++d) {
      if ((fixed >> d & 1U) == 0) {
        Point next = point;
        next[d] = selection.candidates[found].point[d];
        select(next, fixed | 1U << d, selection);
      }
    }
  }

  std::array<Entry, most> entries_;  // latest first
  std::size_t count_ = 0;
};

// A table from the waves of all fingers to what is remembered of the samples that had them. Open
// addressing of fixed size with at most half of the places taken; a key is removed with its last
// sample, and those behind it move up, so that a look-up never gets longer with time.

template <std::size_t Fingers, class Memory>
class WaveTable {
 public:
  using Key = std::array<std::int64_t, Fingers>;

  explicit WaveTable(std::size_t samples) {
    std::size_t places = 4;
    while (places < 2 * samples) {
      places *= 2;
    }
    places_.resize(places);
  }

  void clear() {
    for (Place& place : places_) {
      place.samples = 0;
    }
  }

  /// What is remembered for this key; null: no sample has it.
  const Memory* find(const Key& key) const {
    const Place& place = places_[place_of(key)];
    return place.samples > 0 ? &place.memory : nullptr;
  }

  /// The memory of a key that gets one sample more.
  Memory& add(const Key& key) {
    Place& place = places_[place_of(key)];
    if (place.samples == 0) {
      place.key = key;
      place.memory.clear();
    }
    ++place.samples;
    return place.memory;
  }

  /// One sample of the key, added before, is gone.
  void remove(const Key& key) {
    std::size_t hole = place_of(key);
    if (--places_[hole].samples > 0) {
      return;
    }
    for (std::size_t i = next(hole); places_[i].samples > 0; i = next(i)) {
      const std::size_t from_home = (i - home(places_[i].key)) & mask();
      const std::size_t from_hole = (i - hole) & mask();
      if (from_home >= from_hole) {  // its search would stop at the hole
        places_[hole] = places_[i];
        places_[i].samples = 0;
        hole = i;
      }
    }
  }

 private:
  struct Place {
    Key key = {};
    std::int64_t samples = 0;
    Memory memory;
  };

  std::size_t mask() const { return places_.size() - 1; }
  std::size_t next(std::size_t i) const { return (i + 1) & mask(); }

  std::size_t home(const Key& key) const {
    std::uint64_t mixed = 0;
    for (const std::int64_t waves : key) {
      mixed = (mixed ^ static_cast<std::uint64_t>(waves)) * 0x9E3779B97F4A7C15U;  // 2^64 / golden
      mixed ^= mixed >> 32;
    }
    return static_cast<std::size_t>(mixed) & mask();
  }

  /// Where the key is, or where it would go.
  std::size_t place_of(const Key& key) const {
    std::size_t i = home(key);
    while (places_[i].samples > 0 && places_[i].key != key) {
      i = next(i);
    }
    return i;
  }

  std::vector<Place> places_;
};

template <class Rule, std::size_t Fingers>
class RememberedPairs {
  static_assert(!is_lift<Rule>,
                "ConstantTime takes GraspLift with MovedToOtherCell: centroids within a tolerance "
                "cannot be told apart in constant time");
};

/// Equal waves on all fingers, other locations on all: the waves are the key, the locations differ.
template <std::size_t Fingers>
class RememberedPairs<GraspOptimise<SamePair>, Fingers> {
  using Locations = LatestDiffering<Fingers>;

 public:
  template <scalar S>
  explicit RememberedPairs(const PreslipOptions<S>& o)
      : history_(o.history), table_(static_cast<std::size_t>(o.history)) {}

  void clear() {
    history_.clear();
    table_.clear();
  }

  std::int64_t latest(const HandSides<Fingers>& later, std::int64_t, std::size_t, double) const {
    const Locations* const locations = table_.find(waves_of(later));
    return locations != nullptr ? (*locations)(locations_of(later)) : no_sample;
  }

  void add(const HandSides<Fingers>& sides, std::int64_t number) {
    if (history_.is_full() && is_kept(history_[history_.oldest()])) {
      table_.remove(waves_of(history_[history_.oldest()]));
    }
    history_.add(sides);
    if (is_kept(sides)) {
      table_.add(waves_of(sides)).add(locations_of(sides), number);
    }
  }

 private:
  static bool is_kept(const HandSides<Fingers>& sides) {
    return can_be_later<GraspOptimise<SamePair>>(sides, 0);
  }
  static std::array<std::int64_t, Fingers> waves_of(const HandSides<Fingers>& sides) {
    std::array<std::int64_t, Fingers> waves{};
    std::transform(sides.begin(), sides.end(), waves.begin(),
                   [](const PairSide& side) { return side.waves; });
    return waves;
  }
  static std::array<std::int64_t, Fingers> locations_of(const HandSides<Fingers>& sides) {
    std::array<std::int64_t, Fingers> locations{};
    std::transform(sides.begin(), sides.end(), locations.begin(),
                   [](const PairSide& side) { return side.location; });
    return locations;
  }

  SideHistory<Fingers> history_;
  WaveTable<Fingers, Locations> table_;
};

/// Each finger for itself, by its number of waves.
template <std::size_t Fingers>
class RememberedPairs<GraspOptimise<AnyPair>, Fingers> {
 public:
  template <scalar S>
  explicit RememberedPairs(const PreslipOptions<S>& o) {
    by_waves_.fill(std::vector<LatestDiffering<1>>(static_cast<std::size_t>(o.max_waves + 1)));
  }

  void clear() {
    for (auto& finger : by_waves_) {
      std::for_each(finger.begin(), finger.end(), [](auto& memory) { memory.clear(); });
    }
  }

  std::int64_t latest(const HandSides<Fingers>& later,
                      std::int64_t,
                      std::size_t track,
                      double) const {
    const PairSide& side = later[track];
    return by_waves_[track][static_cast<std::size_t>(side.waves)]({side.location});
  }

  void add(const HandSides<Fingers>& sides, std::int64_t number) {
    for (std::size_t f = 0; f < Fingers; ++f) {
      if (sides[f].is_vibrating) {
        by_waves_[f][static_cast<std::size_t>(sides[f].waves)].add({sides[f].location}, number);
      }
    }
  }

 private:
  std::array<std::vector<LatestDiffering<1>>, Fingers> by_waves_;
};

/// Fewer waves at another location and centroid, on any finger.
template <class Axes, std::size_t Fingers>
class RememberedPairs<GraspLift<MovedToOtherCell, Axes>, Fingers> {
  static constexpr bool by_axis = std::is_same_v<Axes, BothAxes>;
  using Places = LatestDiffering<by_axis ? 3 : 2>;

 public:
  template <scalar S>
  explicit RememberedPairs(const PreslipOptions<S>& o) {
    by_waves_.fill(std::vector<Places>(static_cast<std::size_t>(o.max_waves + 1)));
  }

  void clear() {
    for (auto& finger : by_waves_) {
      std::for_each(finger.begin(), finger.end(), [](auto& memory) { memory.clear(); });
    }
  }

  std::int64_t latest(const HandSides<Fingers>& later, std::int64_t, std::size_t, double) const {
    std::int64_t found = no_sample;
    for (std::size_t f = 0; f < Fingers; ++f) {
      if (later[f].is_vibrating && later[f].is_pressed) {
        const auto point = point_of(later[f]);
        for (std::size_t waves = 0; waves < static_cast<std::size_t>(later[f].waves); ++waves) {
          found = (std::max)(found, by_waves_[f][waves](point));
        }
      }
    }
    return found;
  }

  void add(const HandSides<Fingers>& sides, std::int64_t number) {
    for (std::size_t f = 0; f < Fingers; ++f) {
      if (sides[f].is_pressed) {
        by_waves_[f][static_cast<std::size_t>(sides[f].waves)].add(point_of(sides[f]), number);
      }
    }
  }

 private:
  static typename Places::Point point_of(const PairSide& side) {
    const std::int64_t x = static_cast<std::int64_t>(side.x);
    const std::int64_t y = static_cast<std::int64_t>(side.y);
    if constexpr (by_axis) {
      return {x, y, side.location};
    } else {
      return {x * (std::int64_t{1} << 32) + y, side.location};  // |x|, |y| <= max_cells
    }
  }

  std::array<std::vector<Places>, Fingers> by_waves_;
};

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
