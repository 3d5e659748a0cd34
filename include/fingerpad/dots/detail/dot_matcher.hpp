// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Assigns spots to printed dots from their approximate earlier positions. The membrane moves
// smoothly, so labels grow from reliable dots to their neighbours: the motion of labelled dots
// predicts the position of the dots beside them. Motions of several pitches are recognised as long
// as neighbours move nearly alike.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Index of the spot of each printed dot; -1: none.
using Labels = Table<int>;

inline int count_labels(const Labels& labels) {
  return static_cast<int>(std::count_if(labels.cells().begin(), labels.cells().end(),
                                        [](int label) { return label >= 0; }));
}

/// Positions of the labelled dots; NaN without a label.
inline Places places_of(const Labels& labels, const SpotMap& spots) {
  Places dots(labels.rows(), labels.cols(), no_place());
  for (Index i = 0; i < labels.rows(); ++i) {
    for (Index j = 0; j < labels.cols(); ++j) {
      dots(i, j) = labels(i, j) >= 0 ? spots[labels(i, j)] : no_place();
    }
  }
  return dots;
}

/// Labels the spots of one frame. The base holds the earlier positions of the dots (NaN: unknown).
/// Base, its spacings and the spots must outlive the matcher.
class DotMatcher {
 public:
  /// `max_strange`: largest deviation from the position predicted by the neighbours, as a fraction
  /// of the spacing. A spot with a larger deviation, and one much larger than usual in the frame,
  /// is a shadow or half a dot.
  DotMatcher(const Places& base,
             const Table<double>& spacing_px,
             const SpotMap& spots,
             double max_strange)
      : base_(base), spacing_px_(spacing_px), spots_(spots), max_strange_(max_strange) {}

  /// Labels the dots for which `is_seed(i, j)` holds, each assumed to have moved by about
  /// `move(i, j)`, and all dots reached from them.
  template <class IsSeed, class Move>
  Labels match(const IsSeed& is_seed, const Move& move) const {
    constexpr int max_rounds = 5;
    Labels labels = seeded(is_seed, move);
    drop_misfits(labels);
    // Dropped labels may grow again, and better, from the remaining ones.
    for (int round = 0; round < max_rounds && grow(labels); ++round) {
      drop_misfits(labels);
    }
    drop_strangers(labels);
    return labels;
  }

  /// Number of labels, less penalties for irregular and for large moves.
  double score(const Labels& labels) const {
    constexpr double cost_of_misfit = 0.5;
    constexpr double cost_of_move = 0.003;
    double sum = 0;
    for_each_label(labels, [&](Index i, Index j) {
      const double off = misfit(labels, i, j) / largest_misfit;
      const double move = norm(move_of(labels, i, j)) / spacing_px_(i, j);
      sum += 1 - cost_of_misfit * std::fmin(off * off, 1.0) -
             cost_of_move * std::fmin(move * move, 10.0);
    });
    return sum;
  }

 private:
  // As fractions of the spacing between dots:
  static constexpr double growth_gate = 0.35;    // spot to predicted position, while growing
  static constexpr double largest_misfit = 0.3;  // labelled dot to position predicted by neighbours

  template <class Visit>
  static void for_each_label(const Labels& labels, const Visit& visit) {
    for (Index i = 0; i < labels.rows(); ++i) {
      for (Index j = 0; j < labels.cols(); ++j) {
        if (labels(i, j) >= 0) {
          visit(i, j);
        }
      }
    }
  }

  Place move_of(const Labels& labels, Index row, Index col) const {
    return labels(row, col) >= 0 ? spots_[labels(row, col)] - base_(row, col) : no_place();
  }

  /// Position of a dot that moves like its neighbours.
  Place expected(const Labels& labels, Index row, Index col) const {
    return base_(row, col) + by_neighbours(labels.rows(), labels.cols(), row, col,
                                           spacing_px_(row, col),
                                           [&](Index i, Index j) { return move_of(labels, i, j); });
  }

  double misfit(const Labels& labels, Index row, Index col) const {
    const Place where = expected(labels, row, col);
    return is_finite(where) ? norm(spots_[labels(row, col)] - where) / spacing_px_(row, col)
                            : std::numeric_limits<double>::infinity();
  }

  /// Labels of the seeds that have a spot within reach. Seeds that claim the same spot get none.
  template <class IsSeed, class Move>
  Labels seeded(const IsSeed& is_seed, const Move& move) const {
    Labels labels(base_.rows(), base_.cols(), -1);
    std::vector<int> claims(static_cast<std::size_t>(spots_.size()), 0);
    for (Index i = 0; i < base_.rows(); ++i) {
      for (Index j = 0; j < base_.cols(); ++j) {
        if (is_seed(i, j)) {
          labels(i, j) =
              spots_.nearest(base_(i, j) + move(i, j), growth_gate * spacing_px_(i, j)).spot;
          if (labels(i, j) >= 0) {
            ++claims[static_cast<std::size_t>(labels(i, j))];
          }
        }
      }
    }
    for (int& label : labels.cells()) {
      label = label >= 0 && claims[static_cast<std::size_t>(label)] == 1 ? label : -1;
    }
    return labels;
  }

  /// Adds labels, first for dots with many labelled neighbours: these are predicted best. False if
  /// nothing was added.
  bool grow(Labels& labels) const {
    constexpr int most = 5;
    constexpr int least = 2;
    bool any = false;
    for (int wanted = most; wanted >= least;) {
      const bool grown = grow_once(labels, wanted);
      any = any || grown;
      wanted = grown ? most : wanted - 1;
    }
    return any;
  }

  bool may_grow(const Labels& labels, Index row, Index col, int wanted) const {
    if (labels(row, col) >= 0 || !is_finite(base_(row, col))) {
      return false;
    }
    int count = 0;
    for (Index i = row - 1; i <= row + 1; ++i) {
      for (Index j = col - 1; j <= col + 1; ++j) {
        count += labels.contains(i, j) && labels(i, j) >= 0 ? 1 : 0;
      }
    }
    return count >= wanted;
  }

  bool grow_once(Labels& labels, int wanted) const {
    struct Claim {
      double distance_px;
      Index row, col;
      int spot;
    };
    std::vector<Claim> claims;
    for (Index i = 0; i < labels.rows(); ++i) {
      for (Index j = 0; j < labels.cols(); ++j) {
        if (may_grow(labels, i, j, wanted)) {
          const auto hit = spots_.nearest(expected(labels, i, j), growth_gate * spacing_px_(i, j));
          if (hit.spot >= 0) {
            claims.push_back({hit.distance_px, i, j, hit.spot});
          }
        }
      }
    }
    if (claims.empty()) {
      return false;
    }
    std::vector<char> taken(static_cast<std::size_t>(spots_.size()), 0);
    for_each_label(labels,
                   [&](Index i, Index j) { taken[static_cast<std::size_t>(labels(i, j))] = 1; });
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

  Table<double> misfits_of(const Labels& labels) const {
    Table<double> misfits(labels.rows(), labels.cols(), 0.0);
    for_each_label(labels, [&](Index i, Index j) { misfits(i, j) = misfit(labels, i, j); });
    return misfits;
  }

  /// Removes labels, the worst first, until no misfit exceeds `largest_misfit`.
  void drop_misfits(Labels& labels) const {
    constexpr Index reach = Neighbours::reach;
    Table<double> misfits = misfits_of(labels);
    while (!misfits.cells().empty()) {
      const auto worst = std::max_element(misfits.cells().begin(), misfits.cells().end());
      if (*worst <= largest_misfit) {
        return;
      }
      const Index at = worst - misfits.cells().begin();
      const Index row = at / labels.cols();
      const Index col = at % labels.cols();
      labels(row, col) = -1;
      for (Index i = row - reach; i <= row + reach; ++i) {
        for (Index j = col - reach; j <= col + reach; ++j) {
          if (labels.contains(i, j)) {
            misfits(i, j) = labels(i, j) >= 0 ? misfit(labels, i, j) : 0.0;
          }
        }
      }
    }
  }

  /// Removes labels that fit much worse than most: half a dot beside a shadow, or the shadow
  /// itself.
  void drop_strangers(Labels& labels) const {
    constexpr double strange = 8;  // times the median misfit
    const Table<double> misfits = misfits_of(labels);
    std::vector<double> sorted;
    for_each_label(labels, [&](Index i, Index j) { sorted.push_back(misfits(i, j)); });
    if (sorted.empty()) {
      return;
    }
    const double limit = std::fmax(max_strange_, strange * median_of(sorted.begin(), sorted.end()));
    for_each_label(labels, [&](Index i, Index j) {
      labels(i, j) = misfits(i, j) > limit ? -1 : labels(i, j);
    });
  }

  const Places& base_;
  const Table<double>& spacing_px_;
  const SpotMap& spots_;
  double max_strange_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
