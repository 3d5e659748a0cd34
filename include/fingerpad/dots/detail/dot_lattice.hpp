// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds the rows and columns of a grid of spots without further knowledge of it. Rows are the
// direction closer to the rows of the frame. The grid may be rotated, sheared, and slightly bent
// from dot to dot, like a print on a dome.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "fingerpad/dots/detail/dot_labels.hpp"
#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

constexpr Index min_lattice_dots = 9;  // fewer may form a grid by chance
constexpr double steps_alike = 0.2;    // a spot to where its neighbour's step ends, in steps

/// Steps from a dot to the next one, along the rows and along the columns of a grid.
struct LatticeSteps {
  Place right{0, 0};
  Place down{0, 0};
};

/// The usual steps: medians over the spots of the step to the nearest one to the right, and of that
/// to the nearest one below. O(spots^2) time.
inline LatticeSteps lattice_steps(const std::vector<Place>& spots) {
  std::array<std::vector<double>, 4> all;  // of both steps, x and y
  for (const Place& from : spots) {
    std::array<Place, 2> nearest = {no_place(), no_place()};
    for (const Place& to : spots) {
      const Place step = to - from;
      const bool right = step.x > std::abs(step.y), down = step.y >= std::abs(step.x);
      Place& least = nearest[down ? 1 : 0];
      if (&to != &from && (right || down) && !(squared_norm(least) <= squared_norm(step))) {
        least = step;
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (is_finite(nearest[k / 2])) {
        all[k].push_back(k % 2 == 0 ? nearest[k / 2].x : nearest[k / 2].y);
      }
    }
  }
  std::array<double, 4> steps{};
  for (std::size_t k = 0; k < 4; ++k) {
    steps[k] = all[k].empty() ? 0 : median(all[k]);
  }
  return {{steps[0], steps[1]}, {steps[2], steps[3]}};
}

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

/// The window that holds the dots, without outer rows and columns of fewer than two dots: a single
/// dot may not belong to the grid.
inline Places trimmed(const Places& dots) {
  Index top = 0, left = 0, bottom = dots.rows(), right = dots.cols();
  const auto few = [&](Index i0, Index i1, Index j0, Index j1) {
    int count = 0;
    for (Index i = i0; i < i1; ++i) {
      for (Index j = j0; j < j1; ++j) {
        count += is_finite(dots(i, j)) ? 1 : 0;
      }
    }
    return count < 2;
  };
  while (top < bottom && left < right) {
    if (few(top, top + 1, left, right)) {
      ++top;
    } else if (few(bottom - 1, bottom, left, right)) {
      --bottom;
    } else if (few(top, bottom, left, left + 1)) {
      ++left;
    } else if (few(top, bottom, right - 1, right)) {
      --right;
    } else {
      break;
    }
  }
  return window_of(dots, top, left, bottom - top, right - left, no_place());
}

/// The spots that lie in rows and columns, at their row and column; empty if there is no such grid.
/// Spots between the rows are left out. O(spots^2) time.
inline Places lattice_of(const std::vector<Place>& spots) {
  constexpr std::size_t max_spots = 1200;  // more are image noise
  constexpr double max_extent = 100;       // rows or columns to each side
  if (spots.size() < static_cast<std::size_t>(min_lattice_dots) || spots.size() > max_spots) {
    return {};
  }
  const LatticeSteps steps = lattice_steps(spots);
  const SpotMap map(spots);
  const Place seed = map[lattice_seed(map, steps)];
  const auto& [right, down] = steps;
  const double area = right.x * down.y - right.y * down.x;
  if (!(area > 0)) {
    return {};
  }
  double rows = 0, cols = 0;  // to each side of the seed
  for (const Place& spot : spots) {
    const Place off = spot - seed;
    rows = (std::max)(rows, std::abs(right.x * off.y - right.y * off.x) / area);
    cols = (std::max)(cols, std::abs(off.x * down.y - off.y * down.x) / area);
  }
  // a bent grid reaches further
  const auto extent = [&](double side) {
    return static_cast<Index>((std::min)(1.25 * side + 2, max_extent));
  };
  const DotIndex first = {extent(rows), extent(cols)};
  Places regular(2 * first.row + 1, 2 * first.col + 1, no_place());
  for (Index i = 0; i < regular.rows(); ++i) {
    for (Index j = 0; j < regular.cols(); ++j) {
      regular(i, j) = seed + static_cast<double>(i - first.row) * down +
                      static_cast<double>(j - first.col) * right;
    }
  }
  const Places dots = trimmed(places_of(DotGrowth(regular, map).from(first, Place{0, 0}), map));
  const bool is_grid =
      dots.rows() > 1 && dots.cols() > 1 && count_present(dots) >= min_lattice_dots;
  return is_grid ? dots : Places();
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
