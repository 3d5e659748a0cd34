// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of dot positions, from frames of a pad on which nothing moves. Source: "Method to decrease
// of data variation of dots" of 003.
//
// Published: "standard deviation of relative dot position in reference to central dot". That holds
// the noise of two positions, sqrt(2) times that of one, and the central dot's is in all of them.
// Here each frame's mean motion is taken out instead, which holds the noise of none.
#include <cmath>
#include <vector>

#include "fingerpad/calibrate/detail/slip_positions.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/slip/stick_steps.hpp"

namespace fingerpad {
inline namespace v0 {

/// Standard deviations of one position, per axis, in px or whatever unit the dots are in.
struct DotNoise {
  double noise_px = 0;        ///< root mean square over dots and axes
  double noise_error_px = 0;  ///< its standard error, of noise that differs from frame to frame
  double largest_px = 0;      ///< of a single dot, both axes together
  double inner_px = 0;  ///< after averaging with DotWeights: dots with eight neighbours; NaN: none
  double edge_px = 0;   ///< dots that lack neighbours, averaged with those there are; NaN: none
  double published_px = 0;  ///< the largest sd, over dots and axes, of a position relative to the
                            ///< dot nearest to the center
  double slow_share = 0;    ///< of the variance, what frames next to each other do not differ by:
                            ///< near 0 for noise, near 1 if the pad did not stand still; 0 from two
                            ///< frames, which cannot tell
  Index dots = 0;           ///< that took part
  Index out_of_place =
      0;  ///< positions left out as further than a quarter of a pitch from the mean
  int frames = 0;

  /// Of the noise, what averaging leaves, as measured; denoising_gain() if neighbours are
  /// independent.
  double gain() const { return inner_px / noise_px; }
};

/// Of independent noise, what a mean over a dot, `sides` of its four and `diagonals` of its other
/// four neighbours leaves.
inline double denoising_gain(const DotWeights& weights, int sides = 4, int diagonals = 4) {
  expects_valid(weights, "denoising_gain");
  const double self = weights.self, side = weights.side, diagonal = weights.diagonal;
  return std::sqrt(self * self + sides * side * side + diagonals * diagonal * diagonal) /
         (self + sides * side + diagonals * diagonal);
}

/// The noise of which only sigma of one position is known, if that of neighbours is independent.
inline DotNoise independent_dot_noise(double noise_px, const DotWeights& weights = {}) {
  DotNoise noise;
  noise.noise_px = noise.largest_px = noise_px;
  noise.inner_px = noise_px * denoising_gain(weights);
  noise.edge_px = noise_px * denoising_gain(weights, 3, 2);
  noise.published_px = noise_px * std::sqrt(2.0);
  return noise;
}

/// Collects frames of a standing pad, 16 bytes per dot and frame. Lost dots do no harm, neither
/// does a camera that shakes: the motion of the pattern as a whole is no noise.
class DotNoiseCalibration {
 public:
  /// Refuses bad parameters (parameter_error). `weights`: those of the denoising.
  DotNoiseCalibration(Index rows, Index cols, const DotWeights& weights = {})
      : rows_(rows), cols_(cols), weights_(weights) {
    expects(rows >= 1, "DotNoiseCalibration", "rows", static_cast<long long>(rows), ">= 1");
    expects(cols >= 1, "DotNoiseCalibration", "cols", static_cast<long long>(cols), ">= 1");
    expects_valid(weights, "DotNoiseCalibration");
  }

  /// Adds all dots of a frame; false, and nothing changed, if it has another size.
  template <dot_grid Dots>
  bool add(const Dots& dots_px) {
    return add(dots_px, LazyView(rows_, cols_, [](Index, Index) { return true; }));
  }
  /// Adds those in contact: a dot can jitter more where it is not held.
  template <dot_grid Dots, contact_mask Contact>
  bool add(const Dots& dots_px, const Contact& contact) {
    const auto dots = as_view(dots_px);
    const auto touch = as_view(contact);
    if (dots.rows() != rows_ || dots.cols() != cols_ || !same_size(dots, touch)) {
      return false;
    }
    using Point = cell_t<Dots>;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const Point p = dots(i, j);
        const double x = static_cast<double>(value(point_traits<Point>::x(p)));
        const double y = static_cast<double>(value(point_traits<Point>::y(p)));
        const bool there = is_contact(cell_t<Contact>(touch(i, j))) && is_finite(x + y);
        x_.push_back(there ? x : not_a_number<double>());
        y_.push_back(there ? y : not_a_number<double>());
      }
    }
    ++frames_;
    return true;
  }

  /// Refuses fewer than two frames, dots in too few of them, and frames that are all the same, as a
  /// recording has that repeats its frames (parameter_error). O(frames rows cols) for each of a few
  /// passes, more the more dots are lost.
  DotNoise fit() const {
    const char* const owner = "DotNoiseCalibration";
    expects(frames_ >= 2, owner, "frames", static_cast<long long>(frames_), ">= 2");
    const detail::stick::DotPositions rest(rows_, cols_, x_, y_);
    DotNoise noise;
    noise.frames = frames_;
    noise.dots = static_cast<Index>(rest.dots_found);
    noise.out_of_place = rest.out_of_place;
    expects(noise.dots >= 2, owner, "dots", static_cast<long long>(noise.dots),
            ">= 2, each found in two frames or more");
    const double freedom = rest.freedom();
    expects(freedom >= 1, owner, "positions beyond those for places and motion", freedom,
            ">= 1: more dots have to be in the same frames");
    const double variance = rest.rests().sum / (2 * freedom);
    noise.noise_px = std::sqrt(variance);
    noise.noise_error_px = noise.noise_px / (2 * std::sqrt(freedom));
    expects(noise.noise_px > 0, owner, "noise_px", noise.noise_px, "> 0: the frames are the same");
    noise.largest_px = rest.largest_px();
    noise.published_px = rest.relative_to_center_px();

    // without motion, differences keep 1 - 1 / dots of their variance
    const detail::stick::SumOfSquares steps = rest.steps();
    noise.slow_share = 1 - steps.sum / (4 * steps.count * variance * (1 - 1 / rest.dots_found));
    // places and motion take (1 - 1 / frames) (gain^2 - 1 / dots) of the variance of means
    const double frames_of_dot = rest.positions / rest.dots_found;
    const double dots_of_frame = rest.positions / rest.frames_found;
    const auto averaged = [&](const detail::stick::SumOfSquares& means) {
      const double left = means.sum / (2 * means.count) / (1 - 1 / frames_of_dot);
      return std::sqrt(left + variance / dots_of_frame);
    };
    noise.inner_px = averaged(rest.means(weights_, true));
    noise.edge_px = averaged(rest.means(weights_, false));
    return noise;
  }

 private:
  Index rows_, cols_;
  DotWeights weights_;
  std::vector<double> x_, y_;
  int frames_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
