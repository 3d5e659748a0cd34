// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The history of samples for the pair rules, and which pairs of it stand. Samples are numbered 0,
// 1, 2, ... from the start.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/foam/pair_rules.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

inline constexpr std::int64_t no_sample = -1;

template <class Rule>
inline constexpr bool is_lift = false;
template <class Centroid, class Axes>
inline constexpr bool is_lift<GraspLift<Centroid, Axes>> = true;

/// How many pairs it takes: one, or one for each finger.
template <class Rule, std::size_t Fingers>
constexpr std::size_t tracks() {
  return std::is_same_v<Rule, GraspOptimise<AnyPair>> ? Fingers : 1;
}

/// The fingers that a pair of this track is about.
template <class Rule, std::size_t Fingers>
constexpr std::size_t first_finger(std::size_t track) {
  return tracks<Rule, Fingers>() > 1 ? track : 0;
}
template <class Rule, std::size_t Fingers>
constexpr std::size_t end_finger(std::size_t track) {
  return tracks<Rule, Fingers>() > 1 ? track + 1 : Fingers;
}

template <std::size_t Fingers>
using HandSides = std::array<PairSide, Fingers>;

template <class Rule, std::size_t Fingers, scalar S>
HandSides<Fingers> hand_sides(const std::array<FingerSample<S>, Fingers>& samples,
                              const PreslipOptions<S>& options) {
  HandSides<Fingers> sides;
  for (std::size_t f = 0; f < Fingers; ++f) {
    sides[f] = pair_side<typename Rule::Centroid>(samples[f], options);
  }
  return sides;
}

/// Whether two samples of the hand fulfil the rule.
template <class Rule, std::size_t Fingers>
bool holds(const HandSides<Fingers>& older,
           const HandSides<Fingers>& later,
           std::size_t track,
           double tolerance) {
  bool on_all = true, on_any = false;
  for (std::size_t f = first_finger<Rule, Fingers>(track); f < end_finger<Rule, Fingers>(track);
       ++f) {
    const bool on_this = Rule::holds(older[f], later[f], tolerance);
    on_all = on_all && on_this;
    on_any = on_any || on_this;
  }
  return is_lift<Rule> ? on_any : on_all;
}

/// False where no older sample can make a pair with this later one.
template <class Rule, std::size_t Fingers>
bool can_be_later(const HandSides<Fingers>& later, std::size_t track) {
  bool on_all = true, on_any = false;
  for (std::size_t f = first_finger<Rule, Fingers>(track); f < end_finger<Rule, Fingers>(track);
       ++f) {
    on_all = on_all && later[f].is_vibrating;
    on_any = on_any || later[f].is_vibrating;
  }
  return is_lift<Rule> ? on_any : on_all;
}

/// Of each track how many samples ago the latest older sample of a pair was, and whether the newest
/// sample is the later one of a pair.
template <std::size_t Tracks>
struct FoundPairs {
  std::array<std::int64_t, Tracks> samples_ago = filled();
  std::array<bool, Tracks> with_newest = {};

  void add(std::size_t track, std::int64_t ago, bool is_with_newest) {
    std::int64_t& latest = samples_ago[track];
    latest = latest == no_sample ? ago : (std::min)(latest, ago);
    with_newest[track] = with_newest[track] || is_with_newest;
  }

 private:
  static constexpr std::array<std::int64_t, Tracks> filled() {
    std::array<std::int64_t, Tracks> none{};
    none.fill(no_sample);
    return none;
  }
};

/// The pairs found with each newest sample in turn: which of them are still in the history.
template <std::size_t Tracks>
class StandingPairs {
 public:
  explicit StandingPairs(Index history) : history_(history) { clear(); }

  void clear() {
    count_ = 0;
    older_.fill(no_sample);
    fresh_.fill(false);
  }
  /// The number of the sample that now comes.
  std::int64_t begin_sample() {
    fresh_.fill(false);
    return count_++;
  }
  /// It makes a pair with the sample of this number, if that is still in the history.
  void add(std::size_t track, std::int64_t older) {
    fresh_[track] = older >= oldest() && older != no_sample;
    older_[track] = (std::max)(older_[track], older);
  }
  FoundPairs<Tracks> found() const {
    FoundPairs<Tracks> found;
    for (std::size_t track = 0; track < Tracks; ++track) {
      if (older_[track] != no_sample && older_[track] >= oldest()) {
        found.add(track, count_ - 1 - older_[track], fresh_[track]);
      }
    }
    return found;
  }

 private:
  std::int64_t oldest() const { return (std::max)(std::int64_t{0}, count_ - history_); }

  std::int64_t history_;
  std::int64_t count_ = 0;
  std::array<std::int64_t, Tracks> older_;
  std::array<bool, Tracks> fresh_;
};

/// The last samples of the hand.
template <std::size_t Fingers>
class SideHistory {
 public:
  explicit SideHistory(Index size) : sides_(static_cast<std::size_t>(size)) {}

  void clear() { count_ = 0; }
  std::int64_t newest() const { return count_ - 1; }
  std::int64_t oldest() const {
    return (std::max)(std::int64_t{0}, count_ - static_cast<std::int64_t>(sides_.size()));
  }
  const HandSides<Fingers>& operator[](std::int64_t number) const { return sides_[place(number)]; }
  /// In the place of the oldest, once there is no other.
  void add(const HandSides<Fingers>& sides) { sides_[place(count_++)] = sides; }
  bool is_full() const { return count_ >= static_cast<std::int64_t>(sides_.size()); }

 private:
  std::size_t place(std::int64_t number) const {
    return static_cast<std::size_t>(number) % sides_.size();
  }
  std::vector<HandSides<Fingers>> sides_;
  std::int64_t count_ = 0;
};

// The history of samples column by column, so that one sample is compared with many at once.

/// What can be no older sample of a pair is stored with a number of waves that fits none.
template <class Rule, std::size_t Fingers>
class SideColumns {
 public:
  template <scalar S>
  explicit SideColumns(const PreslipOptions<S>& o) : size_(o.history) {
    for (Columns& c : fingers_) {
      c.location.assign(static_cast<std::size_t>(size_), 0);
      c.waves = c.location;
      c.centroid.resize(c.location.size());
    }
    clear();
  }

  void clear() {
    for (Columns& c : fingers_) {
      std::fill(c.waves.begin(), c.waves.end(), fits_none);
    }
  }

  void add(const HandSides<Fingers>& sides, std::int64_t number) {
    const std::size_t at = static_cast<std::size_t>(number % size_);
    for (std::size_t f = 0; f < Fingers; ++f) {
      const PairSide& side = sides[f];
      const bool can_be_older = is_lift<Rule> ? side.is_pressed : side.is_vibrating;
      fingers_[f].location[at] = side.location;
      fingers_[f].waves[at] = can_be_older ? side.waves : fits_none;
      fingers_[f].centroid[at] = {side.x, side.y};
    }
  }

  /// The latest sample before `number` that makes a pair with `later`, of those in the history that
  /// ends with `number`.
  std::int64_t latest(const HandSides<Fingers>& later,
                      std::int64_t number,
                      std::size_t track,
                      double tolerance) const {
    // place of the sample `number`: it still holds the one that leaves the history
    const std::int64_t here = number % size_;
    const std::int64_t before = latest_in(0, here, later, track, tolerance);
    if (before != no_sample) {
      return number - here + before;
    }
    const std::int64_t behind = latest_in(here + 1, size_, later, track, tolerance);
    return behind != no_sample ? number - here - size_ + behind : no_sample;
  }

 private:
  struct Centroid {
    double x = 0, y = 0;
  };
  struct Columns {
    std::vector<std::int32_t> location, waves;
    std::vector<Centroid> centroid;
  };
  using Hits = std::array<std::int32_t, 64>;
  static constexpr std::int64_t run = std::tuple_size_v<Hits>;
  static constexpr std::int32_t fits_none =
      is_lift<Rule> ? (std::numeric_limits<std::int32_t>::max)() : std::int32_t{-1};

  /// The last place in [begin, end) that fits.
  std::int64_t latest_in(std::int64_t begin,
                         std::int64_t end,
                         const HandSides<Fingers>& later,
                         std::size_t track,
                         double tolerance) const {
    for (std::int64_t last = end; last > begin; last -= run) {
      const std::int64_t first = (std::max)(begin, last - run);
      const std::int64_t found = latest_in_run(first, last - first, later, track, tolerance);
      if (found != no_sample) {
        return first + found;
      }
    }
    return no_sample;
  }

  std::int64_t latest_in_run(std::int64_t first,
                             std::int64_t count,
                             const HandSides<Fingers>& later,
                             std::size_t track,
                             double tolerance) const {
    Hits hits;
    hits.fill(is_lift<Rule> ? 0 : 1);
    for (std::size_t f = first_finger<Rule, Fingers>(track); f < end_finger<Rule, Fingers>(track);
         ++f) {
      if constexpr (is_lift<Rule>) {
        add_lift(fingers_[f], later[f], first, count, tolerance, hits);
      } else {
        keep_alike(fingers_[f], later[f], first, count, hits);
      }
    }
    return last_of(hits, count);
  }

  /// Grasp-optimise: keeps the samples with as many waves elsewhere.
  static void keep_alike(const Columns& older,
                         const PairSide& later,
                         std::int64_t first,
                         std::int64_t count,
                         Hits& hits) {
    const std::int32_t* const location = older.location.data() + first;
    const std::int32_t* const waves = older.waves.data() + first;
    for (std::int64_t i = 0; i < count; ++i) {
      hits[static_cast<std::size_t>(i)] &= static_cast<int>(waves[i] == later.waves) &
                                           static_cast<int>(location[i] != later.location);
    }
  }

  /// Grasp-lift: adds the samples with fewer waves elsewhere whose centroid differs; few of them
  /// are left when it comes to centroids.
  static void add_lift(const Columns& older,
                       const PairSide& later,
                       std::int64_t first,
                       std::int64_t count,
                       double tolerance,
                       Hits& hits) {
    if (!later.is_pressed || !later.is_vibrating) {
      return;
    }
    const std::int32_t* const location = older.location.data() + first;
    const std::int32_t* const waves = older.waves.data() + first;
    Hits rises;
    for (std::int64_t i = 0; i < count; ++i) {
      rises[static_cast<std::size_t>(i)] = static_cast<int>(waves[i] < later.waves) &
                                           static_cast<int>(location[i] != later.location);
    }
    for (std::int64_t i = last_of(rises, count); i != no_sample; i = last_of(rises, i)) {
      const Centroid& c = older.centroid[static_cast<std::size_t>(first + i)];
      if (centroids_differ<typename Rule::Axes>(c.x - later.x, c.y - later.y, tolerance)) {
        hits[static_cast<std::size_t>(i)] = 1;
        return;  // earlier ones of this finger cannot be the latest
      }
    }
  }

  static std::int64_t last_of(const Hits& hits, std::int64_t count) {
    std::int32_t any = 0;
    for (std::int64_t i = 0; i < count; ++i) {
      any |= hits[static_cast<std::size_t>(i)];
    }
    for (std::int64_t i = any != 0 ? count : 0; i-- > 0;) {
      if (hits[static_cast<std::size_t>(i)] != 0) {
        return i;
      }
    }
    return no_sample;
  }

  std::int64_t size_;
  std::array<Columns, Fingers> fingers_;
};

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
