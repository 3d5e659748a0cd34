// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Assigns the spots of each frame to the printed dots. This is the part of the dot finder that
// needs no image, for callers with their own spot detection. Several guesses of the dots' motion
// are grown into labels, and the guess with the most and the most regular labels is taken. If
// another guess scores nearly as well, the dots on which the two disagree count as lost.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/dots/detail/dot_matcher.hpp"
#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v0 {

enum class DotStatus : std::uint8_t {
  ok,
  lost,     ///< too few dots were recognised to trust any of them: all are NaN
  refused,  ///< frame or grid of another size or type: nothing was written
};

/// "ok", "lost" or "refused".
constexpr const char* name_of(DotStatus status) {
  constexpr std::array<const char*, 3> names = {"ok", "lost", "refused"};
  return names[static_cast<std::size_t>(status)];
}

struct [[nodiscard]] DotResult {
  DotStatus status = DotStatus::refused;
  Index found = 0;     ///< dots located in this frame, also some that the free pad did not show
  Index expected = 0;  ///< dots seen on the free pad
  Index spots = 0;     ///< spots in this frame, whether they are dots or not

  bool ok() const { return status == DotStatus::ok; }
};

struct DotTrackerOptions {
  /// Deviation of a dot from the position predicted by its neighbours beyond which it may count as
  /// lost, as a fraction of the pitch, > 0. Use 0.1 for a membrane over a fluid, which moves
  /// smoothly, and 0.3 for dots behind an elastic pad, where a contact moves dots while those
  /// beside it stay still.
  double max_off = 0.1;
};

/// Tracks the dots of a pad. Const: all memory of a pad is in its State. Memory: O(dots).
class DotTracker {
  using Place = detail::Place;
  using Places = detail::Places;

 public:
  /// Positions and velocities of the dots of one pad in the last frame. A value: copy it to try
  /// something, assign start() to reset it.
  class State {
    friend DotTracker;
    Places last, velocity;  // px, px per frame; unknown: NaN, 0
  };

  /// `free_px` are the dots of the free pad in px, NaN for a dot that was not seen. `places_px`, of
  /// the same size, gives the expected positions of the dots not seen; NaN: there is no dot. A dot
  /// farther out than 1e6 px counts as NaN.
  /// Refuses grids of different sizes, fewer than 9 dots and bad options (parameter_error).
  template <dot_grid Dots, dot_grid AllDots>
  DotTracker(const Dots& free_px, const AllDots& places_px, const DotTrackerOptions& options = {})
      : max_off_(options.max_off) {
    expects(options.max_off > 0, "DotTracker", "max_off", options.max_off, "> 0");
    expects(same_size(free_px, places_px), "DotTracker", "places_px",
            static_cast<long long>(fingerpad::rows(places_px)), "of the same size as free_px");
    const Places found = copied(free_px);
    count_ = count_present(found);
    expects(count_ >= 9, "DotTracker", "free_px", static_cast<long long>(count_),
            "a grid with at least 9 found dots");
    free_ = filled(found, copied(places_px), copied(places_px));
    spacing_px_ = detail::spacings_px(free_);
    border_ = border_of(found);
    find_middle(found);
  }
  /// The same without `places_px`: dots that were not seen are extrapolated from their neighbours.
  template <dot_grid Dots>
  explicit DotTracker(const Dots& free_px, const DotTrackerOptions& options = {})
      : DotTracker(free_px, detail::extrapolated(copied(free_px)), options) {}

  Index rows() const { return free_.rows(); }
  Index cols() const { return free_.cols(); }
  /// Every dot on the free pad: its position where it was seen, else the expected one.
  StridedView<const Point2<double>> places_px() const { return free_.view(); }

  State start() const {
    State state;
    state.last = free_;
    state.velocity = Places(rows(), cols(), Place{0, 0});
    return state;
  }

  /// The dots of the next frame, by their printed row and column; NaN for a lost dot. Spots may be
  /// in any order; those that are not finite, or farther out than 1e6 px, are ignored. Takes
  /// O(dots + spots) time if dots move little between frames, up to 60 times that after a jump.
  /// Allocates a few buffers of the size of the dots.
  template <dot_grid Dots>
  DotResult operator()(const std::vector<Point2<double>>& spots,
                       Dots& dots_px,
                       State& state) const {
    DotResult result;
    if (fingerpad::rows(dots_px) != rows() || fingerpad::cols(dots_px) != cols() ||
        !same_size(state.last, free_)) {
      return result;
    }
    const std::vector<Place> good = usable(spots);
    const detail::SpotMap map(good);
    const Places found = track(map, state);
    result.spots = map.size();
    result.expected = count_;
    result.found = count_present(found);
    result.status = result.found > 0 ? DotStatus::ok : DotStatus::lost;
    remember(found, state);
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0; j < cols(); ++j) {
        using Cell = cell_t<Dots>;
        using Coordinate = std::remove_cvref_t<decltype(point_traits<Cell>::x(Cell()))>;
        grid_traits<Dots>::at(dots_px, i, j) =
            Cell{static_cast<Coordinate>(found(i, j).x), static_cast<Coordinate>(found(i, j).y)};
      }
    }
    return result;
  }

 private:
  // Shares of the dots that have a label:
  static constexpr double nearly_all = 0.99;    // the search stops
  static constexpr double max_of_all = 0.96;    // below this, jumps are tried
  static constexpr double min_explained = 0.9;  // below this, all dots are lost
  static constexpr double longest_leap = 3.5;   // pitches between two frames

  struct Guess {
    detail::Labels labels;
    int count = 0;
    double score = 0;

    bool explains(double share, int most) const {
      return count >= share * most && score >= 0.95 * count;
    }
  };

  template <dot_grid Dots>
  static Places copied(const Dots& dots) {
    Places all(fingerpad::rows(dots), fingerpad::cols(dots), detail::no_place());
    for (Index i = 0; i < all.rows(); ++i) {
      for (Index j = 0; j < all.cols(); ++j) {
        using Traits = point_traits<cell_t<Dots>>;
        const cell_t<Dots> dot = grid_traits<Dots>::at(dots, i, j);
        const Place place{static_cast<double>(Traits::x(dot)), static_cast<double>(Traits::y(dot))};
        all(i, j) = is_plausible(place) ? place : detail::no_place();
      }
    }
    return all;
  }

  static std::vector<Place> usable(const std::vector<Place>& spots) {
    std::vector<Place> good;
    good.reserve(spots.size());
    for (const Place& spot : spots) {
      if (is_plausible(spot)) {
        good.push_back(spot);
      }
    }
    return good;
  }

  /// `found` where it is known. Elsewhere `base`, moved like the neighbours of the dot, or
  /// `otherwise` if these do not determine the move.
  static Places filled(const Places& found, const Places& base, const Places& otherwise) {
    Places all = found;
    for (Index i = 0; i < found.rows(); ++i) {
      for (Index j = 0; j < found.cols(); ++j) {
        if (!is_finite(found(i, j))) {
          constexpr double scale_px = 10;
          const Place place = base(i, j) + detail::by_neighbours(found.rows(), found.cols(), i, j,
                                                                 scale_px, [&](Index r, Index c) {
                                                                   return found(r, c) - base(r, c);
                                                                 });
          all(i, j) = is_finite(place) ? place : otherwise(i, j);
        }
      }
    }
    return all;
  }

  /// Marks the dots that lack one of eight neighbours. They move little because the rim holds them.
  static detail::Table<char> border_of(const Places& dots) {
    detail::Table<char> border(dots.rows(), dots.cols(), 0);
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const auto nothing = [](Index, Index, const Place&) {};
        border(i, j) =
            is_finite(dots(i, j)) && detail::for_each_neighbour(dots, i, j, nothing) < 8 ? 1 : 0;
      }
    }
    return border;
  }

  void find_middle(const Places& dots) {
    Place sum{0, 0};
    for (const Place& dot : dots.cells()) {
      sum += is_finite(dot) ? dot : Place{0, 0};
    }
    const Place middle = sum / static_cast<double>(count_);
    double nearest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const double distance = norm(dots(i, j) - middle);
        if (distance < nearest) {
          nearest = distance;
          middle_ = {i, j};
        }
      }
    }
  }

  Places track(const detail::SpotMap& spots, const State& state) const {
    const detail::Table<double> last_spacing_px = detail::spacings_px(state.last);
    const detail::DotMatcher from_last(state.last, last_spacing_px, spots, max_off_);
    const detail::DotMatcher from_free(free_, spacing_px_, spots, max_off_);
    const int most = (std::min)(static_cast<int>(count_), spots.size());
    const auto everywhere = [](Index, Index) { return true; };
    const auto border = [this](Index i, Index j) { return border_(i, j) != 0; };
    const auto at_rest = [](Index, Index) { return Place{0, 0}; };
    std::vector<Guess> guesses;
    const auto explains_all = [&](const detail::DotMatcher& matcher, const auto& seeds,
                                  const auto& move) {
      Guess guess;
      guess.labels = matcher.match(seeds, move);
      guess.count = detail::count_labels(guess.labels);
      guess.score = from_free.score(guess.labels);
      guesses.push_back(guess);
      return guess.explains(nearly_all, most);
    };
    const auto best = [&] {
      return std::max_element(guesses.begin(), guesses.end(),
                              [](const Guess& a, const Guess& b) { return a.score < b.score; });
    };
    // Small motions first: they usually suffice.
    if (!explains_all(from_last, everywhere, at_rest) &&
        !explains_all(from_last, everywhere,
                      [&](Index i, Index j) { return state.velocity(i, j); })) {
      explains_all(from_last, border, at_rest);
      explains_all(from_free, everywhere, at_rest);
      explains_all(from_free, border, at_rest);
      if (!best()->explains(max_of_all, most)) {
        leap(spots, state, [&](const auto& seeds, const auto& move) {
          return explains_all(from_last, seeds, move);
        });
      }
    }
    Guess taken = *best();
    drop_doubtful(taken, guesses);
    // Too few labels: they are not trustworthy.
    return taken.count >= min_explained * most ? places_of(taken.labels, spots)
                                               : Places(rows(), cols(), detail::no_place());
  }

  /// Handles a jump: any spot within `longest_leap` may be the middle dot. Tries these spots, the
  /// nearest first, until `explains_all(seeds, move)`.
  template <class ExplainsAll>
  void leap(const detail::SpotMap& spots,
            const State& state,
            const ExplainsAll& explains_all) const {
    constexpr std::size_t max_tries = 50;
    const Place middle = state.last(middle_.row, middle_.col);
    const double reach_px = longest_leap * spacing_px_(middle_.row, middle_.col);
    std::vector<Place> near;
    for (int k = 0; k < spots.size(); ++k) {
      if (norm(spots[k] - middle) <= reach_px) {
        near.push_back(spots[k]);
      }
    }
    std::sort(near.begin(), near.end(),
              [&](const Place& a, const Place& b) { return norm(a - middle) < norm(b - middle); });
    near.resize((std::min)(near.size(), max_tries));
    const auto beside_middle = [&](Index i, Index j) {
      return std::abs(i - middle_.row) <= 1 && std::abs(j - middle_.col) <= 1;
    };
    for (const Place& spot : near) {
      if (explains_all(beside_middle, [&](Index, Index) { return spot - middle; })) {
        return;
      }
    }
  }

  /// Removes the labels on which another guess with nearly the same score disagrees.
  static void drop_doubtful(Guess& best, const std::vector<Guess>& guesses) {
    constexpr double nearly = 0.985;
    for (const Guess& other : guesses) {
      if (other.score < nearly * best.score) {
        continue;
      }
      for (std::size_t k = 0; k < best.labels.cells().size(); ++k) {
        int& label = best.labels.cells()[k];
        const int others = other.labels.cells()[k];
        label = label >= 0 && others >= 0 && label != others ? -1 : label;
      }
    }
  }

  void remember(const Places& found, State& state) const {
    const Places now = filled(found, free_, state.last);
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0; j < cols(); ++j) {
        const Place move = now(i, j) - state.last(i, j);
        state.velocity(i, j) = is_finite(move) ? move : Place{0, 0};
      }
    }
    state.last = now;
  }

  double max_off_;
  Places free_;  ///< every dot on the free pad, seen or expected
  detail::Table<double> spacing_px_;
  detail::Table<char> border_;
  DotIndex middle_;
  Index count_ = 0;  ///< dots seen on the free pad
};

}  // namespace v0
}  // namespace fingerpad
