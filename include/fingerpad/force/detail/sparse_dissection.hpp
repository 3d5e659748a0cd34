// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// In which order the borders of a ring of n x m segments are eliminated. Equations couple only the
// four borders of one segment, so a line of borders separates the segments on both sides: nested
// dissection (George 1973). The ring is cut into two halves, each again along its shorter side,
// down to single segments; going back up, where two pieces meet, the borders between them go.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Numbers of the borders of segments: first those around, (i, j) at j * columns + i, then those
/// upward.
struct BorderNumbers {
  std::size_t columns;
  std::size_t rows;

  std::size_t around(std::size_t i, std::size_t j) const { return j * columns + i; }
  std::size_t upward(std::size_t i, std::size_t j) const {
    return columns * (rows + 1) + j * columns + (i == columns ? 0 : i);
  }
  std::size_t count() const { return columns * (2 * rows + 1); }
};

/// A piece of the ring: the borders eliminated with it, then those it keeps for later, all in the
/// order of elimination.
struct Front {
  bool is_segment;
  std::size_t first;       ///< the two pieces it is made of; of a segment: its column
  std::size_t second;      ///< and its row
  std::size_t eliminated;  ///< how many borders
  std::size_t kept;
  std::size_t borders;      ///< where its list of borders begins
  std::size_t kept_places;  ///< where the places of its kept borders in the whole begin
  std::size_t own_places;   ///< of a segment: where the places of its four borders begin
};

/// The pieces, each after those it is made of.
class Dissection {
 public:
  /// At least 3 columns and 1 row.
  Dissection(Index columns, Index rows)
      : numbers_{static_cast<std::size_t>(columns), static_cast<std::size_t>(rows)},
        rank_(numbers_.count()) {
    const std::size_t half = numbers_.columns / 2;
    const std::size_t first = divide({0, half, 0, numbers_.rows});
    const std::size_t second = divide({half, numbers_.columns, 0, numbers_.rows});
    join({0, numbers_.columns, 0, numbers_.rows}, first, second);
    sort_kept();
    find_places();
  }

  const BorderNumbers& numbers() const { return numbers_; }
  const std::vector<Front>& fronts() const { return fronts_; }
  const std::size_t* borders(const Front& front) const { return &borders_[front.borders]; }
  /// Places of its kept borders in the list of the piece that it becomes part of.
  const std::size_t* kept_places(const Front& front) const {
    return places_.data() + front.kept_places;
  }
  /// Places of the borders below, above, left and right of a segment in its own list.
  const std::size_t* own_places(const Front& segment) const {
    return places_.data() + segment.own_places;
  }

 private:
  struct Piece {
    std::size_t left, right, bottom, top;

    bool holds(std::size_t i, std::size_t j) const {
      return i >= left && i < right && j >= bottom && j < top;
    }
  };

  std::size_t divide(const Piece& piece) {
    const std::size_t wide = piece.right - piece.left;
    const std::size_t high = piece.top - piece.bottom;
    if (wide == 1 && high == 1) {
      const Front segment{true, piece.left, piece.bottom, 0, 0, 0, 0, 0};
      const std::array<std::size_t, 4> own = borders_of(segment);
      return add(segment, piece, {own.begin(), own.end()});
    }
    Piece one = piece;
    Piece other = piece;
    if (wide >= high) {
      one.right = other.left = piece.left + wide / 2;
    } else {
      one.top = other.bottom = piece.bottom + high / 2;
    }
    const std::size_t first = divide(one);
    return join(piece, first, divide(other));
  }

  std::size_t join(const Piece& piece, std::size_t first, std::size_t second) {
    std::vector<std::size_t> open;
    for (const std::size_t part : {first, second}) {
      const Front& front = fronts_[part];
      const std::size_t* kept = borders(front) + front.eliminated;
      open.insert(open.end(), kept, kept + front.kept);
    }
    std::sort(open.begin(), open.end());
    open.erase(std::unique(open.begin(), open.end()), open.end());
    return add({false, first, second, 0, 0, 0, 0, 0}, piece, open);
  }

  /// Adds a piece whose borders that are not eliminated yet are `open`.
  std::size_t add(Front front, const Piece& piece, std::vector<std::size_t> open) {
    const auto kept = std::stable_partition(
        open.begin(), open.end(), [&](std::size_t border) { return !reaches_out(piece, border); });
    front.eliminated = static_cast<std::size_t>(kept - open.begin());
    front.kept = open.size() - front.eliminated;
    front.borders = borders_.size();
    for (std::size_t k = 0; k < front.eliminated; ++k) {
      rank_[open[k]] = eliminated_++;
    }
    borders_.insert(borders_.end(), open.begin(), open.end());
    fronts_.push_back(front);
    return fronts_.size() - 1;
  }

  /// Whether a border of a piece is one of a segment outside it too.
  bool reaches_out(const Piece& piece, std::size_t border) const {
    const std::size_t n = numbers_.columns;
    const std::size_t around = n * (numbers_.rows + 1);
    if (border < around) {
      const std::size_t i = border % n;
      const std::size_t j = border / n;
      return j > 0 && j < numbers_.rows && !(piece.holds(i, j) && piece.holds(i, j - 1));
    }
    const std::size_t i = (border - around) % n;
    const std::size_t j = (border - around) / n;
    return !(piece.holds(i, j) && piece.holds(i == 0 ? n - 1 : i - 1, j));
  }

  std::array<std::size_t, 4> borders_of(const Front& segment) const {
    const std::size_t i = segment.first;
    const std::size_t j = segment.second;
    return {numbers_.around(i, j), numbers_.around(i, j + 1), numbers_.upward(i, j),
            numbers_.upward(i + 1, j)};
  }

  void sort_kept() {
    for (const Front& front : fronts_) {
      std::size_t* kept = &borders_[front.borders] + front.eliminated;
      std::sort(kept, kept + front.kept,
                [this](std::size_t a, std::size_t b) { return rank_[a] < rank_[b]; });
    }
  }

  void find_places() {
    for (Front& front : fronts_) {
      if (front.is_segment) {
        front.own_places = places_.size();
        for (const std::size_t border : borders_of(front)) {
          places_.push_back(place_in(front, border));
        }
      } else {
        for (const std::size_t part : {front.first, front.second}) {
          find_places_of(fronts_[part], front);
        }
      }
    }
  }

  /// Of the borders that `part` keeps.
  void find_places_of(Front& part, const Front& whole) {
    const std::size_t* kept = borders(part) + part.eliminated;
    part.kept_places = places_.size();
    for (std::size_t k = 0; k < part.kept; ++k) {
      places_.push_back(place_in(whole, kept[k]));
    }
  }

  std::size_t place_in(const Front& front, std::size_t border) const {
    const std::size_t* own = borders(front);
    return static_cast<std::size_t>(std::find(own, own + front.eliminated + front.kept, border) -
                                    own);
  }

  BorderNumbers numbers_;
  std::size_t eliminated_ = 0;
  std::vector<std::size_t> rank_;  // of a border in the order of elimination
  std::vector<Front> fronts_;
  std::vector<std::size_t> borders_;
  std::vector<std::size_t> places_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
