// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shared parts of the dot finder: a grid that owns its cells, a nearest-neighbour search among the
// spots of a frame, and interpolation of a dot from its neighbours.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

using Place = Point2<double>;

constexpr Place no_place() {
  return {not_a_number<double>(), not_a_number<double>()};
}

/// A grid that owns its cells.
template <class T>
class Table {
 public:
  Table() = default;
  Table(Index rows, Index cols, const T& value)
      : rows_(rows), cols_(cols), cells_(static_cast<std::size_t>(rows * cols), value) {}
  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  T& operator()(Index i, Index j) { return cells_[static_cast<std::size_t>(i * cols_ + j)]; }
  const T& operator()(Index i, Index j) const {
    return cells_[static_cast<std::size_t>(i * cols_ + j)];
  }
  bool contains(Index i, Index j) const { return i >= 0 && i < rows_ && j >= 0 && j < cols_; }
  std::vector<T>& cells() { return cells_; }
  const std::vector<T>& cells() const { return cells_; }
  StridedView<const T> view() const { return {cells_.data(), rows_, cols_, cols_}; }

 private:
  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<T> cells_;
};

using Places = Table<Place>;

/// Nearest-neighbour search among the spots of a frame, sorted by y. A query takes O(log spots +
/// spots in a strip of height 2 reach_px) time.
class SpotMap {
 public:
  explicit SpotMap(std::vector<Place> spots = {})
      : spots_(std::move(spots)), order_(spots_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
      return std::pair((*this)[a].y, (*this)[a].x) < std::pair((*this)[b].y, (*this)[b].x);
    });
  }

  struct Hit {
    int spot = -1;  ///< none within reach
    double distance_px = 0;
  };

  /// The nearest spot other than `but`.
  Hit nearest(const Place& place, double reach_px, int but = -1) const {
    Hit hit{-1, reach_px};
    const auto above = [&](int spot, double y) { return (*this)[spot].y < y; };
    for (auto k = std::lower_bound(order_.begin(), order_.end(), place.y - reach_px, above);
         k != order_.end() && (*this)[*k].y <= place.y + reach_px; ++k) {
      const Place off = (*this)[*k] - place;
      if (std::abs(off.x) <= hit.distance_px && *k != but && norm(off) <= hit.distance_px) {
        hit = {*k, norm(off)};
      }
    }
    return hit;
  }

  const Place& operator[](int spot) const { return spots_[static_cast<std::size_t>(spot)]; }
  int size() const { return static_cast<int>(spots_.size()); }

 private:
  std::vector<Place> spots_;
  std::vector<int> order_;
};

/// Rows and columns to each side of a dot whose dots say where it is.
constexpr Index neighbour_reach = 2;

/// Value at (row, col) of the plane through the values of the dots around it, near ones weigh more;
/// NaN if fewer than three are known. `value_at(i, j)` is NaN if unknown.
template <class ValueAt>
Place by_neighbours(Index rows, Index cols, Index row, Index col, const ValueAt& value_at) {
  constexpr Index reach = neighbour_reach;
  constexpr double hold = 0.05;  // on the slopes, for neighbours in one line
  double s = 0, r = 0, c = 0, rr = hold, rc = 0, cc = hold;
  Place b{0, 0}, br{0, 0}, bc{0, 0};
  int count = 0;
  for (Index i = (std::max)(row - reach, Index{0}); i <= (std::min)(row + reach, rows - 1); ++i) {
    for (Index j = (std::max)(col - reach, Index{0}); j <= (std::min)(col + reach, cols - 1); ++j) {
      const Place value = i == row && j == col ? no_place() : value_at(i, j);
      if (is_finite(value)) {
        const auto down = static_cast<double>(i - row), right = static_cast<double>(j - col);
        const double weight = 1 / (down * down + right * right);
        s += weight;
        r += weight * down;
        c += weight * right;
        rr += weight * down * down;
        rc += weight * down * right;
        cc += weight * right * right;
        b += weight * value;
        br += weight * down * value;
        bc += weight * right * value;
        ++count;
      }
    }
  }
  // the first row of the inverse of [s r c; r rr rc; c rc cc], by cofactors
  const double at_b = rr * cc - rc * rc, at_br = c * rc - r * cc, at_bc = r * rc - c * rr;
  const double det = s * at_b + r * at_br + c * at_bc;
  return count < 3 ? no_place() : (at_b * b + at_br * br + at_bc * bc) / det;
}

/// Distance of each dot to the nearest of its four neighbours; the mean of all where it has none.
inline Table<double> spacings_px(const Places& dots) {
  Table<double> spacing(dots.rows(), dots.cols(), 0.0);
  double sum = 0;
  int count = 0;
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j < dots.cols(); ++j) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [down, right] : {std::pair<Index, Index>{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (dots.contains(i + down, j + right)) {
          nearest = std::fmin(nearest, norm(dots(i + down, j + right) - dots(i, j)));
        }
      }
      if (is_finite(nearest) && nearest > 0) {
        spacing(i, j) = nearest;
        sum += nearest;
        ++count;
      }
    }
  }
  for (double& each : spacing.cells()) {
    each = each > 0 || count == 0 ? each : sum / count;
  }
  return spacing;
}

/// Median distance of a dot to the nearest of its neighbours; 0 if there are none.
inline double pitch_of(const Places& dots) {
  return dots.cells().empty() ? 0.0 : median(spacings_px(dots).cells());
}

/// The regular grid with the mean steps along rows and columns of `dots`, which must hold at least
/// one step of each.
inline Places flattened(const Places& dots) {
  Place right{0, 0}, down{0, 0}, first{0, 0};
  double rights = 0, downs = 0, all = 0;
  const auto add = [](const Place& step, Place& sum, double& count) {
    if (is_finite(step)) {
      sum += step;
      count += 1;
    }
  };
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j < dots.cols(); ++j) {
      add(j + 1 < dots.cols() ? dots(i, j + 1) - dots(i, j) : no_place(), right, rights);
      add(i + 1 < dots.rows() ? dots(i + 1, j) - dots(i, j) : no_place(), down, downs);
    }
  }
  right = right / rights;
  down = down / downs;
  const auto steps_to = [&](Index i, Index j) {
    return static_cast<double>(i) * down + static_cast<double>(j) * right;
  };
  Places flat = dots;
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j < dots.cols(); ++j) {
      add(dots(i, j) - steps_to(i, j), first, all);
    }
  }
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j < dots.cols(); ++j) {
      flat(i, j) = first / all + steps_to(i, j);
    }
  }
  return flat;
}

/// Fills in missing dots, outward from the known ones: their deviation from the regular grid
/// continues that of their neighbours.
inline Places completed(Places dots) {
  const Places base = flattened(dots);
  for (bool grown = true; grown;) {
    grown = false;
    const Places known = dots;
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        if (!is_finite(known(i, j))) {
          dots(i, j) = base(i, j) +
                       by_neighbours(dots.rows(), dots.cols(), i, j,
                                     [&](Index r, Index c) { return known(r, c) - base(r, c); });
          grown = grown || is_finite(dots(i, j));
        }
      }
    }
  }
  return dots;
}

/// The window of rows x cols from (top, left); `none` outside of the table.
template <class T>
Table<T> window_of(
    const Table<T>& all, Index top, Index left, Index rows, Index cols, const T& none) {
  Table<T> window(rows, cols, none);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      if (all.contains(top + i, left + j)) {
        window(i, j) = all(top + i, left + j);
      }
    }
  }
  return window;
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
