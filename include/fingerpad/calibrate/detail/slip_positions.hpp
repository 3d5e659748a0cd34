// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Positions of dots in the frames of a standing pad, split into the place of each dot, the motion
// of the pattern as a whole in each frame, and a rest, which is noise.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/stick_steps.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// What of the values first, first + step, ... are numbers, less what `taken` says.
template <class Taken>
std::vector<double> numbers_of(const std::vector<double>& values,
                               std::size_t first,
                               std::size_t step,
                               std::size_t end,
                               const Taken& taken) {
  std::vector<double> numbers;
  for (std::size_t i = first; i < end; i += step) {
    if (is_finite(values[i])) {
      numbers.push_back(values[i] - taken(i));
    }
  }
  return numbers;
}

struct MeanOf {
  double operator()(const std::vector<double>& numbers) const {
    const double count = static_cast<double>(numbers.size());
    return count > 0 ? std::accumulate(numbers.begin(), numbers.end(), 0.0) / count : 0;
  }
};
struct MedianOf {
  double operator()(std::vector<double> numbers) const {
    if (numbers.empty()) {
      return 0;
    }
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
  }
};

/// One axis, frame after frame, NaN where a dot is missing, becomes the rest of the split. With
/// means it has the least squares; with medians wild positions do not show in others.
template <class Middle>
void remove_places_and_motion(std::vector<double>& values,
                              std::vector<double>& places,
                              int passes,
                              const Middle& middle) {
  const std::size_t dots = places.size(), frames = values.size() / dots;
  std::vector<double> motion(frames, 0);
  double largest = 0;
  for (const double v : values) {
    largest = is_finite(v) ? (std::max)(largest, std::abs(v)) : largest;
  }
  // where dots are lost the middles are of different frames, and have to be found together
  double change = largest;
  for (int pass = 0; pass < passes && change > 1e-13 * largest; ++pass) {
    for (std::size_t k = 0; k < dots; ++k) {
      places[k] = middle(numbers_of(values, k, dots, values.size(),
                                    [&](std::size_t i) { return motion[i / dots]; }));
    }
    change = 0;
    for (std::size_t t = 0; t < frames; ++t) {
      const double moved = middle(numbers_of(values, t * dots, 1, (t + 1) * dots,
                                             [&](std::size_t i) { return places[i % dots]; }));
      change = (std::max)(change, std::abs(moved - motion[t]));
      motion[t] = moved;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= places[i % dots] + motion[i / dots];
  }
}

/// A sum of squares over both axes, and over how many positions.
struct SumOfSquares {
  double sum = 0, count = 0;
  void add(double x, double y) { sum += x * x + y * y, count += 1; }
};

class DotPositions {
 public:
  /// Positions of rows x cols dots, frame after frame, NaN where missing.
  DotPositions(Index rows_of_dots, Index cols_of_dots, std::vector<double> x, std::vector<double> y)
      : rows_(rows_of_dots),
        cols_(cols_of_dots),
        dots_(static_cast<std::size_t>(rows_ * cols_)),
        x_(std::move(x)),
        y_(std::move(y)),
        place_x_(dots_, 0),
        place_y_(dots_, 0) {
    drop_out_of_place();
    count();
    remove_places_and_motion(x_, place_x_, 200, MeanOf());
    remove_places_and_motion(y_, place_y_, 200, MeanOf());
  }

  double positions = 0, dots_found = 0, frames_found = 0;
  Index out_of_place = 0;  ///< dropped: another dot was found there, or none

  /// Positions beyond those that places and motion account for.
  double freedom() const { return positions - dots_found - frames_found + 1; }

  SumOfSquares rests() const {
    SumOfSquares squares;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (is_there(i)) {
        squares.add(x_[i], y_[i]);
      }
    }
    return squares;
  }

  /// Of differences between one frame and the next.
  SumOfSquares steps() const {
    SumOfSquares squares;
    for (std::size_t i = dots_; i < x_.size(); ++i) {
      if (is_there(i) && is_there(i - dots_)) {
        squares.add(x_[i] - x_[i - dots_], y_[i] - y_[i - dots_]);
      }
    }
    return squares;
  }

  /// Of the weighted means of the dots and their neighbours that are there: of dots with all eight,
  /// or of all others.
  SumOfSquares means(const DotWeights& weights, bool of_inner_dots) const {
    SumOfSquares squares;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Index row = static_cast<Index>(i % dots_) / cols_;
      const Index col = static_cast<Index>(i % dots_) % cols_;
      double x = 0, y = 0, weight = 0;
      int neighbours = -1;
      for (Index di = -1; di <= 1; ++di) {
        for (Index dj = -1; dj <= 1; ++dj) {
          const bool inside =
              row + di >= 0 && row + di < rows_ && col + dj >= 0 && col + dj < cols_;
          const Index at = static_cast<Index>(i) + di * cols_ + dj;
          if (inside && is_there(static_cast<std::size_t>(at))) {
            const double w = weight_of(weights, di, dj);
            x += w * x_[static_cast<std::size_t>(at)];
            y += w * y_[static_cast<std::size_t>(at)];
            weight += w;
            ++neighbours;
          }
        }
      }
      if (is_there(i) && (neighbours == 8) == of_inner_dots) {
        squares.add(x / weight, y / weight);
      }
    }
    return squares;
  }

  /// The largest standard deviation of a dot, both axes together. Without places and motion a dot
  /// has (frames - 1) (1 - 1 / dots) of its variance.
  double largest_px() const {
    std::vector<double> squares(dots_, 0);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      squares[i % dots_] += is_there(i) ? x_[i] * x_[i] + y_[i] * y_[i] : 0;
    }
    double largest = 0;
    for (std::size_t k = 0; k < dots_; ++k) {
      largest = found_[k] > 0 ? (std::max)(largest, squares[k] / (2 * (found_[k] - 1))) : largest;
    }
    return std::sqrt(largest * dots_found / (dots_found - 1));
  }

  /// The largest standard deviation, over dots and axes, of a position relative to the central dot.
  double relative_to_center_px() const {
    const std::size_t center = central_dot();
    double largest = 0;
    for (std::size_t k = 0; k < dots_; ++k) {
      for (const std::vector<double>* axis : {&x_, &y_}) {
        double count = 0, mean = 0, squares = 0;
        for (std::size_t t = 0; t < axis->size(); t += dots_) {
          const double off = (*axis)[t + k] - (*axis)[t + center];
          if (is_finite(off)) {
            count += 1;
            const double change = off - mean;
            mean += change / count;
            squares += change * (off - mean);
          }
        }
        largest = count > 1 ? (std::max)(largest, squares / (count - 1)) : largest;
      }
    }
    return std::sqrt(largest);
  }

 private:
  bool is_there(std::size_t i) const { return is_finite(x_[i]); }
  void drop(std::size_t i) { x_[i] = y_[i] = not_a_number<double>(); }
  static double weight_of(const DotWeights& weights, Index di, Index dj) {
    const Index steps = di * di + dj * dj;
    return steps == 0 ? weights.self : steps == 1 ? weights.side : weights.diagonal;
  }

  /// Drops dots that are in one frame alone, which say nothing, and counts the others.
  void count() {
    found_.assign(dots_, 0);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      found_[i % dots_] += is_there(i) ? 1 : 0;
    }
    positions = dots_found = frames_found = 0;
    double before = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (found_[i % dots_] < 2) {
        drop(i);
      }
      positions += is_there(i) ? 1 : 0;
      if ((i + 1) % dots_ == 0) {
        frames_found += positions > before ? 1 : 0;
        before = positions;
      }
    }
    for (double& f : found_) {
      f = f < 2 ? 0 : f;
      dots_found += f > 0 ? 1 : 0;
    }
  }

  /// Drops what is further than a quarter of a pitch from its place.
  void drop_out_of_place() {
    count();
    std::vector<double> off_x = x_, off_y = y_;
    remove_places_and_motion(off_x, place_x_, 3, MedianOf());
    remove_places_and_motion(off_y, place_y_, 3, MedianOf());
    const double near = pitch_px() / 4;
    for (std::size_t i = 0; i < x_.size() && near > 0; ++i) {
      if (std::hypot(off_x[i], off_y[i]) > near) {
        drop(i);
        ++out_of_place;
      }
    }
  }

  /// The median distance between neighbours; 0 if there are none.
  double pitch_px() const {
    const auto cols = static_cast<std::size_t>(cols_);
    std::vector<double> distances;
    const auto add = [&](std::size_t a, std::size_t b) {
      if (found_[a] > 0 && found_[b] > 0) {
        distances.push_back(std::hypot(place_x_[a] - place_x_[b], place_y_[a] - place_y_[b]));
      }
    };
    for (std::size_t k = 0; k < dots_; ++k) {
      if ((k + 1) % cols != 0) {
        add(k, k + 1);
      }
      if (k + cols < dots_) {
        add(k, k + cols);
      }
    }
    return MedianOf()(std::move(distances));
  }

  /// The dot nearest to the mean place that is found in more than half of the frames in which the
  /// best is.
  std::size_t central_dot() const {
    double mean_x = 0, mean_y = 0;
    for (std::size_t k = 0; k < dots_; ++k) {
      mean_x += found_[k] > 0 ? place_x_[k] / dots_found : 0;
      mean_y += found_[k] > 0 ? place_y_[k] / dots_found : 0;
    }
    const double most = *std::max_element(found_.begin(), found_.end());
    std::size_t center = 0;
    double nearest = -1;
    for (std::size_t k = 0; k < dots_; ++k) {
      const double away = std::hypot(place_x_[k] - mean_x, place_y_[k] - mean_y);
      if (2 * found_[k] > most && (nearest < 0 || away < nearest)) {
        nearest = away;
        center = k;
      }
    }
    return center;
  }

  Index rows_, cols_;
  std::size_t dots_;
  std::vector<double> x_, y_, place_x_, place_y_;
  std::vector<double> found_;  ///< in how many frames each dot is; 0 for what was dropped
};

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
