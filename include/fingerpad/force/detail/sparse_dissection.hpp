// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Elimination order of the borders of a ring of n x m segments: nested dissection (George 1973).
// The ring is divided into halves, each again along its shorter side, down to single segments. On
// the way back up, borders shared by two pieces are eliminated where the pieces join.
#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <vector>

#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Indices of the borders of segments: first those around, (i, j) at j * columns + i, then those
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

/// A piece of the ring.
struct Front {
  bool is_segment;
  std::size_t first;                      ///< its two parts; for a segment its
  std::size_t second;                     ///< column and row
  std::size_t eliminated = 0;             ///< number of borders eliminated with it
  std::vector<std::size_t> borders = {};  ///< those eliminated with it, then those it keeps, all in
                                          ///< the order of elimination
  std::vector<std::size_t> places = {};   ///< of the borders it keeps, among those of the whole
  std::vector<std::size_t> segment = {};  ///< places of the borders below, above, left and right

  std::size_t kept() const { return borders.size() - eliminated; }
  /// Two unknowns per border, and two additional rows.
  std::size_t height() const { return 2 * borders.size() + 2; }
  std::size_t remainder() const { return (2 * kept() + 2) * 2 * kept(); }
};

/// The pieces, each after its parts.
class Dissection {
 public:
  /// For at least 3 columns and 1 row.
  Dissection(Index columns, Index rows)
      : numbers_{static_cast<std::size_t>(columns), static_cast<std::size_t>(rows)},
        rank_(numbers_.count()) {
    divide(0, numbers_.columns, 0, numbers_.rows);
    for (Front& front : fronts_) {
      std::sort(front.borders.begin() + static_cast<std::ptrdiff_t>(front.eliminated),
                front.borders.end(),
                [this](std::size_t a, std::size_t b) { return rank_[a] < rank_[b]; });
    }
    for (Front& front : fronts_) {
      if (front.is_segment) {
        for (const std::size_t border : borders_of(front.first, front.second)) {
          front.segment.push_back(place_in(front, border));
        }
        continue;
      }
      for (Front* part : {&fronts_[front.first], &fronts_[front.second]}) {
        for (std::size_t k = part->eliminated; k < part->borders.size(); ++k) {
          part->places.push_back(place_in(front, part->borders[k]));
        }
      }
    }
  }

  const BorderNumbers& numbers() const { return numbers_; }
  const std::vector<Front>& fronts() const { return fronts_; }

 private:
  using Borders = std::vector<std::size_t>;

  std::size_t divide(std::size_t left, std::size_t right, std::size_t bottom, std::size_t top) {
    const std::size_t wide = right - left, high = top - bottom;
    if (wide == 1 && high == 1) {
      const auto four = borders_of(left, bottom);
      Borders alone, shared;  // borders on the rim and on A_g belong to one segment only
      for (std::size_t k = 0; k < 4; ++k) {
        const bool outer = (k == 0 && bottom == 0) || (k == 1 && top == numbers_.rows);
        (outer ? alone : shared).push_back(four[k]);
      }
      return add({true, left, bottom}, alone, shared);
    }
    const std::size_t column = left + wide / 2, row = bottom + high / 2;
    const bool upright = wide >= high;
    const std::size_t first =
        upright ? divide(left, column, bottom, top) : divide(left, right, bottom, row);
    const std::size_t second =
        upright ? divide(column, right, bottom, top) : divide(left, right, row, top);
    const Borders a = kept_by(first), b = kept_by(second);
    Borders of_both, of_one;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(of_both));
    std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(),
                                  std::back_inserter(of_one));
    return add({false, first, second}, of_both, of_one);
  }

  std::size_t add(Front front, const Borders& eliminated, const Borders& kept) {
    front.eliminated = eliminated.size();
    for (const std::size_t border : eliminated) {
      rank_[border] = eliminated_++;
    }
    front.borders = eliminated;
    front.borders.insert(front.borders.end(), kept.begin(), kept.end());
    fronts_.push_back(front);
    return fronts_.size() - 1;
  }

  Borders kept_by(std::size_t front) const {
    const Front& f = fronts_[front];
    Borders kept(f.borders.begin() + static_cast<std::ptrdiff_t>(f.eliminated), f.borders.end());
    std::sort(kept.begin(), kept.end());
    return kept;
  }

  std::array<std::size_t, 4> borders_of(std::size_t i, std::size_t j) const {
    return {numbers_.around(i, j), numbers_.around(i, j + 1), numbers_.upward(i, j),
            numbers_.upward(i + 1, j)};
  }

  static std::size_t place_in(const Front& front, std::size_t border) {
    const auto found = std::find(front.borders.begin(), front.borders.end(), border);
    return static_cast<std::size_t>(found - front.borders.begin());
  }

  BorderNumbers numbers_;
  std::size_t eliminated_ = 0;
  std::vector<std::size_t> rank_;  // of each border in the order of elimination
  std::vector<Front> fronts_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
