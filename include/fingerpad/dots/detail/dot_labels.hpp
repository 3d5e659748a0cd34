// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Gives the spots of a frame the rows and columns of a print. Labels grow from a block of 3 x 3
// dots to their neighbours: the motion of labelled dots predicts that of the dots beside them. What
// has grown from one block is a piece of one grid, but its rows and columns may be off by a whole
// number, so growth continues beyond the border of the print. Spots where nothing is printed, and
// printed dots without a spot, tell that the labels are off.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Index of the spot of each dot; -1: none.
using Labels = Table<int>;

inline Index number_of(const Labels& labels) {
  return static_cast<Index>(std::count_if(labels.cells().begin(), labels.cells().end(),
                                          [](int label) { return label >= 0; }));
}

/// Positions of the labelled dots; NaN without a label.
inline Places places_of(const Labels& labels, const SpotMap& spots) {
  Places dots(labels.rows(), labels.cols(), no_place());
  for (std::size_t k = 0; k < labels.cells().size(); ++k) {
    const int label = labels.cells()[k];
    dots.cells()[k] = label >= 0 ? spots[label] : no_place();
  }
  return dots;
}

/// Labels spots from the approximate places of dots, NaN where a dot cannot be. Places and spots
/// must outlive it.
class DotGrowth {
 public:
  DotGrowth(const Places& base, const SpotMap& spots)
      : base_(base), spacing_px_(spacings_px(base)), spots_(spots) {}

  /// Labels of the block around `seed` moved by `move`, and of all dots reached from it.
  Labels from(DotIndex seed, const Place& move) const {
    Labels labels(base_.rows(), base_.cols(), -1);
    for (Index i = seed.row - 1; i <= seed.row + 1; ++i) {
      for (Index j = seed.col - 1; j <= seed.col + 1; ++j) {
        if (base_.contains(i, j)) {
          labels(i, j) = spots_.nearest(base_(i, j) + move, gate * spacing_px_(i, j)).spot;
        }
      }
    }
    settle(labels);
    return labels;
  }

  /// Drops labels that do not fit their neighbours and grows the others.
  void settle(Labels& labels) const {
    drop_misfits(labels, largest_misfit);
    // dropped labels may grow again, and better, from the remaining ones
    while (claim(labels)) {
    }
    drop_misfits(labels, largest_misfit);
  }

  /// Median distance of labelled spots from where their neighbours put them, in spacings.
  double usual_misfit(const Labels& labels) const {
    std::vector<double> misfits = misfits_of(labels).cells();
    std::erase(misfits, 0.0);
    return misfits.empty() ? 0 : median(misfits);
  }

  /// Removes labels, the worst first, until none is off the position predicted by its neighbours by
  /// more than `max_misfit` of the spacing.
  void drop_misfits(Labels& labels, double max_misfit) const {
    constexpr Index reach = neighbour_reach;
    Table<double> misfits = misfits_of(labels);
    while (true) {
      const auto worst = std::max_element(misfits.cells().begin(), misfits.cells().end());
      if (worst == misfits.cells().end() || *worst <= max_misfit) {
        return;
      }
      const Index at = worst - misfits.cells().begin();
      const Index row = at / labels.cols();
      const Index col = at % labels.cols();
      labels(row, col) = -1;
      for (Index i = row - reach; i <= row + reach; ++i) {
        for (Index j = col - reach; j <= col + reach; ++j) {
          if (labels.contains(i, j)) {
            misfits(i, j) = misfit(labels, i, j);
          }
        }
      }
    }
  }

 private:
  static constexpr int least_neighbours = 2;
  // As fractions of the spacing between dots:
  static constexpr double gate = 0.35;           // spot to predicted position, while growing
  static constexpr double largest_misfit = 0.3;  // spot to predicted position, when grown

  /// Position of a dot that moves like its neighbours, or like those in other rows or columns.
  Place expected(const Labels& labels, Index row, Index col, bool by_row, bool by_col) const {
    return base_(row, col) +
           by_neighbours(labels.rows(), labels.cols(), row, col, [&](Index i, Index j) {
             return labels(i, j) >= 0 && (by_row || i != row) && (by_col || j != col)
                        ? spots_[labels(i, j)] - base_(i, j)
                        : no_place();
           });
  }

  /// A line of strange spots beside the print agrees with itself: labels at the border are judged
  /// by the lines within.
  double misfit(const Labels& labels, Index row, Index col) const {
    if (labels(row, col) < 0) {
      return 0;
    }
    const auto inside = [&](Index down, Index right) {
      return has(labels, row + down, col + right) && has(labels, row - down, col - right);
    };
    Place where = expected(labels, row, col, inside(1, 0), inside(0, 1));
    where = is_finite(where) ? where : expected(labels, row, col, true, true);
    return is_finite(where) ? norm(spots_[labels(row, col)] - where) / spacing_px_(row, col)
                            : std::numeric_limits<double>::infinity();
  }

  Table<double> misfits_of(const Labels& labels) const {
    Table<double> misfits(labels.rows(), labels.cols(), 0.0);
    for (Index i = 0; i < labels.rows(); ++i) {
      for (Index j = 0; j < labels.cols(); ++j) {
        misfits(i, j) = misfit(labels, i, j);
      }
    }
    return misfits;
  }

  /// Labels dots that have none but enough labelled neighbours, the best predicted first. False if
  /// no label was given.
  bool claim(Labels& labels) const {
    struct Claim {
      double distance_px;
      Index row, col;
      int spot;
    };
    std::vector<Claim> claims;
    std::vector<char> taken(static_cast<std::size_t>(spots_.size()), 0);
    for (const int label : labels.cells()) {
      if (label >= 0) {
        taken[static_cast<std::size_t>(label)] = 1;
      }
    }
    for (Index i = 0; i < labels.rows(); ++i) {
      for (Index j = 0; j < labels.cols(); ++j) {
        if (labels(i, j) < 0 && is_finite(base_(i, j)) &&
            neighbours(labels, i, j) >= least_neighbours) {
          const auto hit =
              spots_.nearest(expected(labels, i, j, true, true), gate * spacing_px_(i, j));
          if (hit.spot >= 0) {
            claims.push_back({hit.distance_px, i, j, hit.spot});
          }
        }
      }
    }
    std::sort(claims.begin(), claims.end(),
              [](const Claim& a, const Claim& b) { return a.distance_px < b.distance_px; });
    bool grown = false;
    for (const Claim& claim : claims) {
      char& is_taken = taken[static_cast<std::size_t>(claim.spot)];
      if (is_taken == 0) {
        labels(claim.row, claim.col) = claim.spot;
        is_taken = 1;
        grown = true;
      }
    }
    return grown;
  }

  static bool has(const Labels& labels, Index row, Index col) {
    return labels.contains(row, col) && labels(row, col) >= 0;
  }
  static int neighbours(const Labels& labels, Index row, Index col) {
    int count = 0;
    for (Index i = row - 1; i <= row + 1; ++i) {
      for (Index j = col - 1; j <= col + 1; ++j) {
        count += has(labels, i, j) ? 1 : 0;
      }
    }
    return count;
  }

  const Places& base_;
  Table<double> spacing_px_;
  const SpotMap& spots_;
};

/// A print in view, and the places around it.
class DotPrint {
 public:
  static constexpr Index beyond = 3;  ///< rows and columns of places on each side of the print
  using InView = std::function<bool(const Place&)>;

  /// `free_px`: the dots of the free pad, NaN where none was seen. `in_view`: whether a dot at this
  /// place would be seen.
  DotPrint(const Places& free_px, const InView& in_view)
      : in_view_(in_view),
        free_(completed(window_of(free_px,
                                  -beyond,
                                  -beyond,
                                  free_px.rows() + 2 * beyond,
                                  free_px.cols() + 2 * beyond,
                                  no_place()))),
        kind_(free_.rows(), free_.cols(), printed) {
    Place middle{0, 0};
    for (Index i = 0; i < free_.rows(); ++i) {
      for (Index j = 0; j < free_.cols(); ++j) {
        if (free_px.contains(i - beyond, j - beyond) &&
            is_finite(free_px(i - beyond, j - beyond))) {
          ++count_;
          middle += free_(i, j);
        } else {
          kind_(i, j) = in_view(free_(i, j)) ? blank : unknown;
        }
      }
    }
    choose_seeds(middle / static_cast<double>(count_));
    known_ = free_;
    for (std::size_t k = 0; k < known_.cells().size(); ++k) {
      known_.cells()[k] = kind_.cells()[k] == blank ? no_place() : known_.cells()[k];
    }
    for (Index down = -beyond; down <= beyond; ++down) {
      for (Index right = -beyond; right <= beyond; ++right) {
        shifts_.push_back({down, right});
      }
    }
    std::sort(shifts_.begin(), shifts_.end(), [](const DotIndex& a, const DotIndex& b) {
      return a.row * a.row + a.col * a.col < b.row * b.row + b.col * b.col;
    });
    bordered_ = std::all_of(shifts_.begin() + 1, shifts_.end(),
                            [&](const DotIndex& shift) { return exposed(shift) >= evidence; });
  }

  /// Dots of the free pad.
  Index count() const { return count_; }

  struct Answer {
    Labels labels;           ///< of all places
    bool ambiguous = false;  ///< rows or columns may be off by a whole number
    Index score = 0;         ///< labels, less those where nothing is printed
  };

  /// Where the seeds are on the free pad.
  std::vector<Place> seeds_px() const {
    std::vector<Place> places;
    for (const DotIndex& seed : seeds_) {
      places.push_back(free_(seed.row, seed.col));
    }
    return places;
  }
  /// The border of a print tells its rows and columns wherever it is. One that reaches beyond the
  /// picture is followed: its seeds are then looked for where they were.
  void follow(const Places& found, std::vector<Place>& seeds_px) const {
    for (std::size_t k = 0; k < seeds_.size() && !bordered_; ++k) {
      const Place& seed = found(seeds_[k].row, seeds_[k].col);
      seeds_px[k] = is_finite(seed) ? seed : seeds_px[k];
    }
  }

  /// Labels of spots, with the seeds near `seeds_px`; without a score if too few fit.
  Answer labels_of(const SpotMap& spots, const std::vector<Place>& seeds_px, double max_off) const {
    const auto most = static_cast<double>((std::min)(count_, static_cast<Index>(spots.size())));
    const DotGrowth growth(free_, spots);
    Answer best;
    bool done = false;
    for (std::size_t k = 0; k < seeds_.size() && !done; ++k) {
      Answer guess = grown(growth, seeds_[k], seeds_px[k], spots);
      const bool decides = best.ambiguous && !guess.ambiguous && guess.score == best.score;
      const bool better = guess.score > best.score || decides;
      best = better ? std::move(guess) : best;
      done = !best.ambiguous &&
             static_cast<double>(best.score) >= (better ? nearly_all : min_explained) * most;
    }
    // half a dot beside a shadow, or the shadow itself
    growth.drop_misfits(best.labels, std::fmax(max_off, 8 * growth.usual_misfit(best.labels)));
    const bool enough =
        static_cast<double>(number_of(best.labels)) >= min_explained * most && best.score > 0;
    return enough ? best : Answer{};
  }

 private:
  enum Kind : std::uint8_t {
    printed,  ///< a dot of the free pad
    blank,    ///< nothing was there
    unknown,  ///< not in view
  };
  // Shares of the dots that have a label:
  static constexpr double nearly_all = 0.96;    // the first guess is taken
  static constexpr double min_explained = 0.9;  // below this, all dots are lost
  static constexpr Index evidence = 3;          // as many dots against it refute a labelling

  /// Middles of blocks that are mostly printed: the one nearest to the middle of the print, and
  /// those farthest from it to four sides.
  void choose_seeds(const Place& middle) {
    std::vector<DotIndex> blocks;
    for (Index i = 1; i + 1 < free_.rows(); ++i) {
      for (Index j = 1; j + 1 < free_.cols(); ++j) {
        Index full = 0;
        for (Index k = 0; k < 9; ++k) {
          full += kind_(i + k / 3 - 1, j + k % 3 - 1) == printed ? 1 : 0;
        }
        if (full >= 6 && kind_(i, j) == printed) {
          blocks.push_back({i, j});
        }
      }
    }
    const auto add_least = [&](const auto& score) {
      const auto least =
          std::min_element(blocks.begin(), blocks.end(), [&](const DotIndex& a, const DotIndex& b) {
            return score(free_(a.row, a.col) - middle) < score(free_(b.row, b.col) - middle);
          });
      if (least != blocks.end()) {
        seeds_.push_back(*least);
      }
    };
    add_least([](const Place& off) { return squared_norm(off); });
    for (const Place& way : {Place{1, 1}, Place{-1, -1}, Place{1, -1}, Place{-1, 1}}) {
      add_least([&](const Place& off) { return dot(way, off); });
    }
  }

  /// Labels grown from the spot nearest to a seed, with the rows and columns that leave the fewest
  /// spots where nothing is printed.
  Answer grown(const DotGrowth& growth,
               const DotIndex& seed,
               const Place& near,
               const SpotMap& spots) const {
    const auto hit = spots.nearest(near, std::numeric_limits<double>::infinity());
    Answer answer;
    if (hit.spot < 0) {
      return answer;
    }
    const Place move = spots[hit.spot] - free_(seed.row, seed.col);
    Labels& labels = answer.labels = growth.from(seed, move);
    Labels sure = labels;  // few specks lie so well where a dot would be
    growth.drop_misfits(sure, 0.15);
    // Dots where nothing is printed refute a shift, unless others miss more printed dots instead.
    const Table<char> unseen = unseen_of(labels, move);
    std::vector<Index> strange, wrong;
    for (const DotIndex& shift : shifts_) {
      strange.push_back(count(sure, blank, shift));
      wrong.push_back(strange.back() + missing(unseen, shift));
    }
    const Index least_strange = *std::min_element(strange.begin(), strange.end());
    const Index least_wrong = *std::min_element(wrong.begin(), wrong.end());
    std::optional<DotIndex> by;
    for (std::size_t k = 0; k < shifts_.size(); ++k) {
      if (strange[k] >= least_strange + evidence && wrong[k] >= least_wrong + evidence) {
        continue;
      }
      if (!by) {
        by = shifts_[k];
      } else {
        answer.ambiguous = answer.ambiguous || is_rival(shifts_[k], *by, unseen);
      }
    }
    answer.score = -count(sure, blank, *by);
    labels = window_of(labels, -by->row, -by->col, labels.rows(), labels.cols(), -1);
    bool changed = by->row != 0 || by->col != 0;
    for (std::size_t k = 0; k < labels.cells().size(); ++k) {
      if (kind_.cells()[k] == blank && labels.cells()[k] >= 0) {
        labels.cells()[k] = -1;
        changed = true;
      }
    }
    if (changed) {
      DotGrowth(known_, spots).settle(labels);
    }
    answer.score += number_of(labels);
    return answer;
  }

  /// Whether another shift is as possible as the smallest one: a jump of the print would have shown
  /// dots where nothing is printed, or the other shift misses fewer dots.
  bool is_rival(const DotIndex& other, const DotIndex& shift, const Table<char>& unseen) const {
    return exposed({other.row - shift.row, other.col - shift.col}) >= evidence ||
           missing(unseen, other) + evidence <= missing(unseen, shift);
  }

  /// Dots that would lie where nothing is printed if the print were moved by rows and columns.
  Index exposed(const DotIndex& by) const {
    return count([&](Index i, Index j) { return kind_(i, j) == printed; }, blank, by);
  }

  /// How many of some places fall on places of a kind if all are moved by rows and columns.
  template <class IsCounted>
  Index count(const IsCounted& is_counted, Kind kind, const DotIndex& by) const {
    Index number = 0;
    for (Index i = 0; i < kind_.rows(); ++i) {
      for (Index j = 0; j < kind_.cols(); ++j) {
        const Index row = std::clamp(i + by.row, Index{0}, kind_.rows() - 1);
        const Index col = std::clamp(j + by.col, Index{0}, kind_.cols() - 1);
        number += kind_(row, col) == kind && is_counted(i, j) ? 1 : 0;
      }
    }
    return number;
  }

  /// Places in view that have no label.
  Table<char> unseen_of(const Labels& labels, const Place& move) const {
    Table<char> unseen(labels.rows(), labels.cols(), 0);
    for (std::size_t k = 0; k < unseen.cells().size(); ++k) {
      const bool is_unseen = labels.cells()[k] < 0 && in_view_(free_.cells()[k] + move);
      unseen.cells()[k] = is_unseen ? 1 : 0;
    }
    return unseen;
  }
  /// How many printed dots are not seen then.
  Index missing(const Table<char>& unseen, const DotIndex& by) const {
    return count([&](Index i, Index j) { return unseen(i, j) != 0; }, printed, by);
  }

  Index count(const Labels& labels, Kind kind, const DotIndex& by) const {
    return count([&](Index i, Index j) { return labels(i, j) >= 0; }, kind, by);
  }

  InView in_view_;
  Places free_;   ///< dots of the free pad, and those that would lie around them
  Places known_;  ///< the same without those that would lie where nothing is printed
  Table<Kind> kind_;
  bool bordered_ = true;          ///< no shift hides all of the border
  std::vector<DotIndex> shifts_;  ///< of rows and columns, the smallest first
  Index count_ = 0;
  std::vector<DotIndex> seeds_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
