// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds the rows and columns of a grid of spots without further knowledge of it. Rows are the
// direction closer to the rows of the frame. The grid may be rotated, sheared, and slightly bent
// from dot to dot, like a print on a dome.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

constexpr Index min_lattice_dots = 9;  // fewer may form a grid by chance

/// Steps from a dot to the next one, along the rows and along the columns of a grid.
struct LatticeSteps {
  Place right{0, 0};
  Place down{0, 0};
};

/// Steps from each spot to its nearest ones, reversed where needed to point right or down.
inline std::vector<Place> steps_between(const std::vector<Place>& spots) {
  constexpr std::size_t nearest = 6;
  std::vector<Place> steps, around;
  for (const Place& from : spots) {
    around.clear();
    for (const Place& to : spots) {
      if (&to != &from) {
        around.push_back(to - from);
      }
    }
    const auto last =
        around.begin() + static_cast<std::ptrdiff_t>((std::min)(nearest, around.size()));
    std::partial_sort(around.begin(), last, around.end(), [](const Place& a, const Place& b) {
      return squared_norm(a) < squared_norm(b);
    });
    std::for_each(around.begin(), last, [&](const Place& step) {
      steps.push_back(step.x + step.y > 0 ? step : -1 * step);
    });
  }
  return steps;
}

/// Mean and number of similar steps, opposite ones included.
struct CommonStep {
  Place step{0, 0};
  int count = 0;
};

constexpr double steps_alike = 0.2;  // as a fraction of their length

/// The most frequent step among those that `allowed` accepts. Only some hundreds of candidates are
/// tried: the steps of a grid are so frequent that one of them is among these.
template <class Allowed>
CommonStep most_common(const std::vector<Place>& steps, const Allowed& allowed) {
  constexpr std::size_t max_tried = 500;
  CommonStep best;
  for (std::size_t k = 0; k < steps.size(); k += 1 + steps.size() / max_tried) {
    const Place& one = steps[k];
    if (!allowed(one)) {
      continue;
    }
    const double near_sq = steps_alike * steps_alike * squared_norm(one);
    CommonStep alike;
    for (const Place& other : steps) {
      const Place same_way = dot(other, one) < 0 ? -1 * other : other;
      if (squared_norm(same_way - one) < near_sq) {
        alike.step += same_way;
        ++alike.count;
      }
    }
    if (alike.count > best.count) {
      best = {alike.step / alike.count, alike.count};
    }
  }
  return best;
}

inline std::optional<LatticeSteps> lattice_steps(const std::vector<Place>& spots) {
  const std::vector<Place> all = steps_between(spots);
  const CommonStep first = most_common(all, [](const Place&) { return true; });
  const CommonStep second = most_common(all, [&](const Place& step) {
    return std::abs(dot(step, first.step)) < 0.5 * norm(step) * norm(first.step) &&
           norm(step) < 2 * norm(first.step);
  });
  if (second.count < 2) {
    return std::nullopt;
  }
  const bool first_is_right =
      std::abs(first.step.x) * norm(second.step) >= std::abs(second.step.x) * norm(first.step);
  LatticeSteps steps = first_is_right ? LatticeSteps{first.step, second.step}
                                      : LatticeSteps{second.step, first.step};
  steps.right = (steps.right.x < 0 ? -1 : 1) * steps.right;
  const double area = steps.right.x * steps.down.y - steps.right.y * steps.down.x;
  steps.down = (area < 0 ? -1 : 1) * steps.down;
  return steps;
}

/// Assigns rows and columns to spots from a seed outward, the best fit first. The steps adapt to
/// the bending of the grid.
class LatticeGrowth {
 public:
  using At = std::pair<int, int>;  // row and column from the seed

  LatticeGrowth(const SpotMap& spots, const LatticeSteps& steps)
      : spots_(spots), steps_(steps), taken_(static_cast<std::size_t>(spots.size()), 0) {}

  /// The spot at each row and column, counted from the seed.
  const std::map<At, int>& from(int seed) {
    name({{0, 0}, seed, steps_, 0});
    while (!open_.empty()) {
      const Claim best = open_.top();
      open_.pop();
      if (named_.count(best.at) == 0 && taken_[static_cast<std::size_t>(best.spot)] == 0) {
        name(best);
      }
    }
    return named_;
  }

 private:
  struct Claim {
    At at;
    int spot;
    LatticeSteps steps;
    double misfit;
    bool operator<(const Claim& other) const { return misfit > other.misfit; }
  };

  void name(const Claim& claim) {
    named_[claim.at] = claim.spot;
    taken_[static_cast<std::size_t>(claim.spot)] = 1;
    for (const int sign : {1, -1}) {
      look(claim, sign, &LatticeSteps::right, {claim.at.first, claim.at.second + sign});
      look(claim, sign, &LatticeSteps::down, {claim.at.first + sign, claim.at.second});
    }
  }

  void look(const Claim& from, int sign, Place LatticeSteps::*way, const At& at) {
    constexpr double reach = 0.42;  // largest distance from the predicted position, in steps
    LatticeSteps steps = from.steps;
    Place& step = steps.*way;
    const double length = norm(step);
    const auto hit = spots_.nearest(spots_[from.spot] + sign * step, reach * length);
    if (hit.spot >= 0) {
      step = 0.5 * step + 0.5 * sign * (spots_[hit.spot] - spots_[from.spot]);
      open_.push({at, hit.spot, steps, hit.distance_px / length});
    }
  }

  const SpotMap& spots_;
  LatticeSteps steps_;
  std::vector<char> taken_;
  std::map<At, int> named_;
  std::priority_queue<Claim> open_;
};

/// The spot with the most neighbours on its four sides; of several, the one nearest to the middle.
inline int lattice_seed(const SpotMap& spots, const LatticeSteps& steps) {
  Place middle{0, 0};
  for (int k = 0; k < spots.size(); ++k) {
    middle += spots[k] / spots.size();
  }
  int best = 0;
  double best_score = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < spots.size(); ++k) {
    double score = -1e-4 * norm(spots[k] - middle);
    for (const Place& step : {steps.right, steps.down, -1 * steps.right, -1 * steps.down}) {
      score += spots.nearest(spots[k] + step, steps_alike * norm(step)).spot >= 0 ? 1 : 0;
    }
    if (score > best_score) {
      best = k;
      best_score = score;
    }
  }
  return best;
}

/// The window of `size_rows` x `size_cols` from (top, left); NaN outside of the grid.
inline Places window_of(
    const Places& dots, Index top, Index left, Index size_rows, Index size_cols) {
  Places window(size_rows, size_cols, no_place());
  for (Index i = 0; i < size_rows; ++i) {
    for (Index j = 0; j < size_cols; ++j) {
      if (dots.contains(top + i, left + j)) {
        window(i, j) = dots(top + i, left + j);
      }
    }
  }
  return window;
}

/// Removes outer rows and columns with fewer than two dots: a single dot may not belong to the
/// grid.
inline Places without_single_dots(Places dots) {
  for (bool cut = true; cut && dots.rows() > 0 && dots.cols() > 0;) {
    cut = false;
    const Index r = dots.rows();
    const Index c = dots.cols();
    for (const Places& smaller :
         {window_of(dots, 1, 0, r - 1, c), window_of(dots, 0, 0, r - 1, c),
          window_of(dots, 0, 1, r, c - 1), window_of(dots, 0, 0, r, c - 1)}) {
      if (count_present(dots) - count_present(smaller) < 2) {
        dots = smaller;
        cut = true;
        break;
      }
    }
  }
  return dots;
}

/// Median distance of neighbours in a row or column; 0 if there are none.
inline double pitch_of(const Places& dots) {
  std::vector<double> lengths;
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j < dots.cols(); ++j) {
      for_each_neighbour<4>(dots, i, j, [&](Index, Index, const Place& other) {
        const double length = norm(other - dots(i, j));
        if (is_finite(length)) {
          lengths.push_back(length);
        }
      });
    }
  }
  return lengths.empty() ? 0 : median_of(lengths.begin(), lengths.end());
}

/// Median distance of a dot from the midpoint of its neighbours on both sides, in pitches. It
/// rejects random spots, which can be given rows and columns but are not regular.
inline double unevenness(const Places& dots) {
  std::vector<double> off;
  const auto add = [&](const Place& before, const Place& at, const Place& after) {
    const Place bend = before / 2 + after / 2 - at;
    if (is_finite(bend)) {
      off.push_back(norm(bend));
    }
  };
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j < dots.cols(); ++j) {
      if (dots.contains(i - 1, j) && dots.contains(i + 1, j)) {
        add(dots(i - 1, j), dots(i, j), dots(i + 1, j));
      }
      if (dots.contains(i, j - 1) && dots.contains(i, j + 1)) {
        add(dots(i, j - 1), dots(i, j), dots(i, j + 1));
      }
    }
  }
  return off.empty() ? 0.0 : median_of(off.begin(), off.end()) / pitch_of(dots);
}

/// The spots that lie in rows and columns, at their row and column; empty if there is no such grid.
/// Spots between the rows are left out. O(spots^2) time.
inline Places lattice_of(const std::vector<Place>& spots) {
  constexpr std::size_t max_spots = 1200;  // more are image noise
  constexpr double max_uneven = 0.15;
  if (spots.size() < static_cast<std::size_t>(min_lattice_dots) || spots.size() > max_spots) {
    return {};
  }
  const auto steps = lattice_steps(spots);
  if (!steps) {
    return {};
  }
  const SpotMap map(spots);
  LatticeGrowth growth(map, *steps);
  const auto& named = growth.from(lattice_seed(map, *steps));
  LatticeGrowth::At first(0, 0), last(0, 0);
  for (const auto& [at, spot] : named) {
    first = {(std::min)(first.first, at.first), (std::min)(first.second, at.second)};
    last = {(std::max)(last.first, at.first), (std::max)(last.second, at.second)};
  }
  Places dots(last.first - first.first + 1, last.second - first.second + 1, no_place());
  for (const auto& [at, spot] : named) {
    dots(at.first - first.first, at.second - first.second) = map[spot];
  }
  dots = without_single_dots(dots);
  const bool is_grid = dots.rows() > 1 && dots.cols() > 1 &&
                       count_present(dots) >= min_lattice_dots && unevenness(dots) <= max_uneven;
  return is_grid ? dots : Places();
}

/// The window of rows x cols that holds the most dots; it may extend beyond the grid. Of several
/// such windows, the one with the middle nearest to `middle_px` is taken or, if that is NaN, the
/// one nearest to the first row and column.
inline Places best_window(const Places& dots, Index rows, Index cols, const Place& middle_px) {
  const Places flat = flattened(dots);  // of at least two rows and columns
  const Place down = flat(1, 0) - flat(0, 0);
  const Place right = flat(0, 1) - flat(0, 0);
  const auto count_in = [&](Index top, Index left) {
    Index count = 0;
    for (Index i = (std::max)(top, Index{0}); i < (std::min)(top + rows, dots.rows()); ++i) {
      for (Index j = (std::max)(left, Index{0}); j < (std::min)(left + cols, dots.cols()); ++j) {
        count += is_finite(dots(i, j)) ? 1 : 0;
      }
    }
    return count;
  };
  const auto from_middle = [&](Index top, Index left) {
    const double row = static_cast<double>(top) + static_cast<double>(rows - 1) / 2;
    const double col = static_cast<double>(left) + static_cast<double>(cols - 1) / 2;
    return is_finite(middle_px) ? norm(flat(0, 0) + row * down + col * right - middle_px)
                                : static_cast<double>(std::abs(top) + std::abs(left));
  };
  DotIndex best;
  Index most = -1;
  double nearest = 0;
  const Index spare_rows = dots.rows() - rows;
  const Index spare_cols = dots.cols() - cols;
  for (Index top = (std::min)(Index{0}, spare_rows); top <= (std::max)(Index{0}, spare_rows);
       ++top) {
    for (Index left = (std::min)(Index{0}, spare_cols); left <= (std::max)(Index{0}, spare_cols);
         ++left) {
      const Index count = count_in(top, left);
      const double distance = from_middle(top, left);
      if (count > most || (count == most && distance < nearest)) {
        most = count;
        nearest = distance;
        best = {top, left};
      }
    }
  }
  return window_of(dots, best.row, best.col, rows, cols);
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
