// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Splits the positions of dots in frames of a pad at rest into the place of each dot, the motion of
// the whole pattern in each frame, and a remainder, which is noise.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/stick_steps.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// The finite ones among the values first, first + step, ..., each less `taken(i)`.
template <scalar S, class Taken>
std::vector<S> numbers_of(const std::vector<S>& values,
                          std::size_t first,
                          std::size_t step,
                          std::size_t end,
                          const Taken& taken) {
  std::vector<S> numbers;
  for (std::size_t i = first; i < end; i += step) {
    if (is_finite(values[i])) {
      numbers.push_back(S(values[i] - taken(i)));
    }
  }
  return numbers;
}

struct MeanOf {
  template <scalar S>
  S operator()(const std::vector<S>& numbers) const {
    S sum = S(0);
    for (const S& x : numbers) {
      sum += x;
    }
    return numbers.empty() ? sum : S(sum / S(static_cast<double>(numbers.size())));
  }
};
struct MedianOf {
  template <scalar S>
  S operator()(std::vector<S> numbers) const {
    if (numbers.empty()) {
      return S(0);
    }
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
  }
};

/// Replaces the values of one axis (frame after frame, NaN for missing dots) by the remainder of
/// the split. With means this is the least-squares split; with medians outliers do not affect other
/// dots.
template <scalar S, class Middle>
void remove_places_and_motion(std::vector<S>& values,
                              std::vector<S>& places,
                              int passes,
                              const Middle& middle) {
  const std::size_t dots = places.size(), frames = values.size() / dots;
  std::vector<S> motion(frames, S(0));
  S largest_sq = S(0);
  for (const S& v : values) {
    largest_sq = largest_sq < square(v) ? S(square(v)) : largest_sq;
  }
  // with lost dots, places and motion depend on each other: iterate
  S change_sq = largest_sq;
  // 1e-13 of the largest, for double
  const S settled_sq = S(square(scalar_real_t<S>(450) * epsilon<S>())) * largest_sq;
  for (int pass = 0; pass < passes && settled_sq < change_sq; ++pass) {
    for (std::size_t k = 0; k < dots; ++k) {
      places[k] = middle(numbers_of(values, k, dots, values.size(),
                                    [&](std::size_t i) { return motion[i / dots]; }));
    }
    change_sq = S(0);
    for (std::size_t t = 0; t < frames; ++t) {
      const S moved = middle(numbers_of(values, t * dots, 1, (t + 1) * dots,
                                        [&](std::size_t i) { return places[i % dots]; }));
      const S step_sq = square(S(moved - motion[t]));
      change_sq = change_sq < step_sq ? step_sq : change_sq;
      motion[t] = moved;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= S(places[i % dots] + motion[i / dots]);
  }
}

/// A sum of squares over both axes, and the number of positions.
template <scalar S>
struct SumOfSquares {
  S sum = S(0);
  double count = 0;
  void add(const S& x, const S& y) {
    sum += S(S(x * x) + S(y * y));
    count += 1;
  }
};

template <scalar S>
class DotPositions {
 public:
  /// Positions of rows x cols dots, frame after frame, NaN where missing.
  DotPositions(Index rows_of_dots, Index cols_of_dots, std::vector<S> x, std::vector<S> y)
      : rows_(rows_of_dots),
        cols_(cols_of_dots),
        dots_(static_cast<std::size_t>(rows_ * cols_)),
        x_(std::move(x)),
        y_(std::move(y)),
        place_x_(dots_, S(0)),
        place_y_(dots_, S(0)) {
    drop_out_of_place();
    count();
    remove_places_and_motion(x_, place_x_, 200, MeanOf());
    remove_places_and_motion(y_, place_y_, 200, MeanOf());
  }

  double positions = 0, dots_found = 0, frames_found = 0;
  Index out_of_place = 0;  ///< positions dropped: not those of the dot

  /// Degrees of freedom: positions less those for places and motion.
  double freedom() const { return positions - dots_found - frames_found + 1; }

  SumOfSquares<S> rests() const {
    SumOfSquares<S> squares;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (is_there(i)) {
        squares.add(x_[i], y_[i]);
      }
    }
    return squares;
  }

  /// Squares of the differences between successive frames.
  SumOfSquares<S> steps() const {
    SumOfSquares<S> squares;
    for (std::size_t i = dots_; i < x_.size(); ++i) {
      if (is_there(i) && is_there(i - dots_)) {
        squares.add(S(x_[i] - x_[i - dots_]), S(y_[i] - y_[i - dots_]));
      }
    }
    return squares;
  }

  /// Squares of the weighted means of each dot and its neighbours found: for dots with all eight
  /// neighbours, or for all others.
  SumOfSquares<S> means(const DotWeights& weights, bool of_inner_dots) const {
    SumOfSquares<S> squares;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Index row = static_cast<Index>(i % dots_) / cols_;
      const Index col = static_cast<Index>(i % dots_) % cols_;
      S x = S(0), y = S(0), weight = S(0);
      int neighbours = -1;
      for (Index di = -1; di <= 1; ++di) {
        for (Index dj = -1; dj <= 1; ++dj) {
          const bool inside =
              row + di >= 0 && row + di < rows_ && col + dj >= 0 && col + dj < cols_;
          const Index at = static_cast<Index>(i) + di * cols_ + dj;
          if (inside && is_there(static_cast<std::size_t>(at))) {
            const S w = S(weight_of(weights, di, dj));
            x += S(w * x_[static_cast<std::size_t>(at)]);
            y += S(w * y_[static_cast<std::size_t>(at)]);
            weight += w;
            ++neighbours;
          }
        }
      }
      if (is_there(i) && (neighbours == 8) == of_inner_dots) {
        squares.add(S(x / weight), S(y / weight));
      }
    }
    return squares;
  }

  /// The largest standard deviation of a dot, both axes together. After subtracting places and
  /// motion, the sum of squares of an axis is (frames - 1) (1 - 1 / dots) variances.
  S largest_px() const {
    using std::sqrt;
    std::vector<S> squares(dots_, S(0));
    for (std::size_t i = 0; i < x_.size(); ++i) {
      squares[i % dots_] += is_there(i) ? S(S(x_[i] * x_[i]) + S(y_[i] * y_[i])) : S(0);
    }
    S largest = S(0);
    for (std::size_t k = 0; k < dots_; ++k) {
      const S of_dot = found_[k] > 0 ? S(squares[k] / S(2 * (found_[k] - 1))) : S(0);
      largest = largest < of_dot ? of_dot : largest;
    }
    return S(sqrt(S(largest * S(dots_found / (dots_found - 1)))));
  }

  /// The largest standard deviation, over dots and axes, of a position relative to the central dot.
  S relative_to_center_px() const {
    using std::sqrt;
    const std::size_t center = central_dot();
    S largest = S(0);
    for (std::size_t k = 0; k < dots_; ++k) {
      for (const std::vector<S>* axis : {&x_, &y_}) {
        double count = 0;
        S mean = S(0), squares = S(0);
        for (std::size_t t = 0; t < axis->size(); t += dots_) {
          const S off = (*axis)[t + k] - (*axis)[t + center];
          if (is_finite(off)) {
            count += 1;
            const S change = off - mean;
            mean += S(change / S(count));
            squares += S(change * S(off - mean));
          }
        }
        const S variance = count > 1 ? S(squares / S(count - 1)) : S(0);
        largest = largest < variance ? variance : largest;
      }
    }
    return value(largest) == 0 ? S(0) : S(sqrt(largest));
  }

 private:
  bool is_there(std::size_t i) const { return is_finite(x_[i]); }
  void drop(std::size_t i) { x_[i] = y_[i] = not_a_number<S>(); }
  static double weight_of(const DotWeights& weights, Index di, Index dj) {
    const Index steps = di * di + dj * dj;
    return steps == 0 ? weights.self : steps == 1 ? weights.side : weights.diagonal;
  }

  /// Drops dots found in a single frame, which carry no information, and counts the others.
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

  /// Drops positions more than a quarter of a pitch from the dot's place.
  void drop_out_of_place() {
    count();
    std::vector<S> off_x = x_, off_y = y_;
    remove_places_and_motion(off_x, place_x_, 3, MedianOf());
    remove_places_and_motion(off_y, place_y_, 3, MedianOf());
    const S near_sq = pitch_sq_px() / S(16);
    for (std::size_t i = 0; i < x_.size() && S(0) < near_sq; ++i) {
      if (near_sq < S(off_x[i] * off_x[i]) + S(off_y[i] * off_y[i])) {
        drop(i);
        ++out_of_place;
      }
    }
  }

  /// Square of the median distance between neighbours; 0 if there are none.
  S pitch_sq_px() const {
    const auto cols = static_cast<std::size_t>(cols_);
    std::vector<S> squares;
    const auto add = [&](std::size_t a, std::size_t b) {
      if (found_[a] > 0 && found_[b] > 0) {
        squares.push_back(
            S(square(S(place_x_[a] - place_x_[b])) + square(S(place_y_[a] - place_y_[b]))));
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
    return MedianOf()(std::move(squares));
  }

  /// The dot nearest to the mean place, among those found in more than half as many frames as the
  /// dot found most often.
  std::size_t central_dot() const {
    S mean_x = S(0), mean_y = S(0);
    for (std::size_t k = 0; k < dots_; ++k) {
      mean_x += found_[k] > 0 ? S(place_x_[k] / S(dots_found)) : S(0);
      mean_y += found_[k] > 0 ? S(place_y_[k] / S(dots_found)) : S(0);
    }
    const double most = *std::max_element(found_.begin(), found_.end());
    std::size_t center = 0;
    S nearest = S(-1);
    for (std::size_t k = 0; k < dots_; ++k) {
      const S away = square(S(place_x_[k] - mean_x)) + square(S(place_y_[k] - mean_y));
      if (2 * found_[k] > most && (nearest < S(0) || away < nearest)) {
        nearest = away;
        center = k;
      }
    }
    return center;
  }

  Index rows_, cols_;
  std::size_t dots_;
  std::vector<S> x_, y_, place_x_, place_y_;
  std::vector<double> found_;  ///< number of frames with each dot; 0 for dropped dots
};

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
