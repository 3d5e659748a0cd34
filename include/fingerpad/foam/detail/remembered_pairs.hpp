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

#include "fingerpad/foam/detail/latest_differing.hpp"
#include "fingerpad/foam/detail/pair_history.hpp"
#include "fingerpad/foam/pair_rules.hpp"
#include "fingerpad/foam/detail/wave_table.hpp"
#include "fingerpad/core/expects.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

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
