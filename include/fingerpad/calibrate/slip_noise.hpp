// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of dot positions, from frames of a pad at rest, and the thresholds of the stick ratio that
// follow from it. Source: "Method to decrease of data variation of dots" and "Selection of delta_0"
// of 003.
//
// Published: "standard deviation of relative dot position in reference to central dot". This
// includes the noise of two positions, sqrt(2) times that of one, and the noise of the central dot
// affects all dots. Here the mean motion of each frame is subtracted instead, which avoids both.
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/detail/slip_positions.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

/// Standard deviations of one position, per axis, in px or whatever unit the dots are in.
template <scalar S = double>
struct [[nodiscard]] DotNoise {
  const char* cause = nullptr;  ///< likely mistake
  S noise_px = S(0);            ///< root mean square over dots and axes
  S noise_error_px = S(0);      ///< its standard error, for noise independent between frames
  S largest_px = S(0);          ///< of a single dot, both axes together
  S inner_px = S(0);            ///< averaged with DotWeights: dots with eight neighbours; NaN: none
  S edge_px = S(0);             ///< averaged likewise: dots that lack neighbours; NaN: none
  S published_px = S(0);  ///< the largest sd, over dots and axes, of a position relative to the
                          ///< dot nearest to the center
  S slow_share = S(0);    ///< share of the variance that does not appear in the differences of
                          ///< successive frames: near 0 for noise, near 1 if the pad moved; 0 for
                          ///< two frames, which cannot show it
  Index dots = 0;         ///< used
  /// Positions left out because they are more than a quarter of a pitch from the dot's place.
  Index out_of_place = 0;
  int frames = 0;
  /// Standard error of edge_px. It has fewer dots than noise_px, and their averages share noise.
  S edge_error_px = S(0);

  bool ok() const { return cause == nullptr; }
  /// Measured share of the noise that remains after averaging. It equals denoising_gain() if
  /// neighbours are independent.
  S gain() const { return S(inner_px / noise_px); }
};

/// Share of independent noise that remains in the mean over a dot, `sides` of its four side
/// neighbours and `diagonals` of its four diagonal ones.
inline double denoising_gain(const DotWeights& weights, int sides = 4, int diagonals = 4) {
  expects_valid(weights, "denoising_gain");
  const double self = weights.self, side = weights.side, diagonal = weights.diagonal;
  return std::sqrt(self * self + sides * side * side + diagonals * diagonal * diagonal) /
         (self + sides * side + diagonals * diagonal);
}

namespace detail::stick {

/// Factor by which the mean square of the averages along an edge varies more than that of
/// independent numbers: the sum of the squared correlations of an average with itself and those
/// beside it.
inline double shared_along_edge(const DotWeights& w) {
  const double self = w.self, side = w.side, diagonal = w.diagonal;
  const double own = self * self + 3 * side * side + 2 * diagonal * diagonal;
  const double next = 2 * side * (self + diagonal) / own;
  const double after = (side * side + diagonal * diagonal) / own;
  return 1 + 2 * (next * next + after * after);
}

}  // namespace detail::stick

/// The noise for a known sigma of one position, if neighbours are independent.
template <scalar S = double>
DotNoise<S> independent_dot_noise(const std::type_identity_t<S>& noise_px,
                                  const DotWeights& weights = {}) {
  DotNoise<S> noise;
  noise.noise_px = noise.largest_px = noise_px;
  noise.inner_px = noise_px * S(denoising_gain(weights));
  noise.edge_px = noise_px * S(denoising_gain(weights, 3, 2));
  noise.published_px = noise_px * S(std::sqrt(2.0));
  return noise;
}

/// Collects frames of a pad at rest, 16 bytes per dot and frame. Lost dots and a shaking camera do
/// no harm: the motion of the whole pattern does not count as noise.
template <scalar S = double>
class DotNoiseCalibration {
 public:
  /// Refuses bad parameters (parameter_error). `weights`: those of the denoising.
  DotNoiseCalibration(Index rows, Index cols, const DotWeights& weights = {})
      : rows_(rows), cols_(cols), weights_(weights) {
    expects_grid_size("DotNoiseCalibration", rows, cols);
    expects_valid(weights, "DotNoiseCalibration");
  }

  /// Adds all dots of a frame; false, and nothing changed, if it has another size.
  template <dot_grid Dots>
  bool add(const Dots& dots_px) {
    return add(dots_px, LazyView(rows_, cols_, [](Index, Index) { return true; }));
  }
  /// Adds the dots in contact: a dot can jitter more where it is not held.
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
        const S x = S(point_traits<Point>::x(p));
        const S y = S(point_traits<Point>::y(p));
        const bool there =
            is_contact(cell_t<Contact>(touch(i, j))) && is_plausible(x) && is_plausible(y);
        x_.push_back(there ? x : not_a_number<S>());
        y_.push_back(there ? y : not_a_number<S>());
      }
    }
    ++frames_;
    return true;
  }

  /// Refuses fewer than two frames, dots in too few frames, and identical frames, as in a recording
  /// that repeats frames (parameter_error). O(frames rows cols) for each of a few passes, with more
  /// passes the more dots are lost.
  DotNoise<S> fit() const {
    using std::sqrt;
    const char* const owner = "DotNoiseCalibration";
    expects(frames_ >= 2, owner, "frames", static_cast<long long>(frames_), ">= 2");
    const detail::stick::DotPositions<S> rest(rows_, cols_, x_, y_);
    DotNoise<S> noise;
    noise.frames = frames_;
    noise.dots = static_cast<Index>(rest.dots_found);
    noise.out_of_place = rest.out_of_place;
    expects(noise.dots >= 2, owner, "dots", static_cast<long long>(noise.dots),
            ">= 2, each found in two frames or more");
    const double freedom = rest.freedom();
    expects(freedom >= 1, owner, "degrees of freedom of the positions", freedom,
            ">= 1: more dots must be found in the same frames");
    const S variance = rest.rests().sum / S(2 * freedom);
    noise.noise_px = sqrt(variance);
    noise.noise_error_px = noise.noise_px / S(2 * std::sqrt(freedom));
    expects(S(0) < noise.noise_px, owner, "noise_px", noise.noise_px,
            "> 0: the frames are identical");
    noise.largest_px = rest.largest_px();
    noise.published_px = rest.relative_to_center_px();

    // subtracting the motion leaves 1 - 1 / dots of the variance of differences
    const detail::stick::SumOfSquares<S> steps = rest.steps();
    const S kept = variance * S(4 * steps.count * (1 - 1 / rest.dots_found));
    noise.slow_share = S(1) - S(steps.sum / kept);
    noise.cause = S(0.5) < noise.slow_share
                      ? "the dots move slowly, unlike noise: check that the pad is at rest"
                      : nullptr;
    // subtracting places and motion leaves means with (1 - 1 / frames) (gain^2 - 1 / dots) of the
    // variance of a position
    const double frames_of_dot = rest.positions / rest.dots_found;
    const double dots_of_frame = rest.positions / rest.frames_found;
    const auto averaged = [&](const detail::stick::SumOfSquares<S>& means) {
      const S left = means.sum / S(2 * means.count * (1 - 1 / frames_of_dot));
      return S(sqrt(S(left + variance / S(dots_of_frame))));
    };
    noise.inner_px = averaged(rest.means(weights_, true));
    const detail::stick::SumOfSquares<S> edge = rest.means(weights_, false);
    noise.edge_px = averaged(edge);
    noise.edge_error_px =
        noise.edge_px * S(std::sqrt(detail::stick::shared_along_edge(weights_) / edge.count) / 2);
    return noise;
  }

 private:
  Index rows_, cols_;
  DotWeights weights_;
  std::vector<S> x_, y_;
  int frames_ = 0;
};

// The threshold of slip from the noise of the dots, and the probability that it is wrong.
// Source: "Selection of delta_0" of 003, corrected (docs/errata.md, E037).
//
// A dot is tested by the difference of its positions in two frames. With Gaussian noise of standard
// deviation sigma per axis in each, both axes of the difference have sigma sqrt(2), and its length
// r is Rayleigh distributed:
//   p = P(r > delta_0) = exp(-delta_0^2 / (4 sigma^2)).
// The published delta_0 = 4 sigma is said to hold 95.44 % of the dots. In fact it holds
// 1 - exp(-4) = 98.17 %: 1.83 % of the sticking dots are taken for slipping.

/// p: probability that a sticking dot seems to move by more than `slip_px` between two frames; 0
/// for noise 0. noise_px >= 0 is sigma of one position, per axis, after denoising. With
/// x = slip^2 / (4 noise^2) the relative error is at most (4 x + 2) epsilon, the effect of 2
/// epsilon in an argument.
template <scalar S>
S false_slip_probability(const S& slip_px, const S& noise_px) {
  using std::exp;
  const S ratio = slip_px / noise_px;
  const S exponent = ratio * ratio / S(-4);
  return S(exp(exponent));
}

/// delta_0 that a sticking dot exceeds with this probability, in (0, 1]; NaN for a probability > 1.
/// The relative error is a few epsilon for any probability.
template <scalar S>
S slip_threshold_for(const S& noise_px, const S& probability) {
  using std::log;
  using std::sqrt;
  const S nats = S(0) - S(log(probability));  // not -0 for probability 1
  const S root = sqrt(nats);
  return S(S(2) * noise_px * root);
}

/// Probability that a dot is mistaken, if that of at least one of `dots` independent dots is
/// `among`, in [0, 1).
template <scalar S>
S false_slip_of_each(const S& among, Index dots) {
  using std::expm1;
  using std::log1p;
  const S minus = S(0) - among;
  const S nats = S(log1p(minus)) / S(static_cast<double>(dots));
  return S(S(0) - S(expm1(nats)));
}

/// Allowed probabilities of errors due to noise, and the range of U.
struct StickTestOptions {
  double false_slip = 0.02;    ///< in (0, 1): probability that a sticking dot that lacks neighbours
                               ///< is taken for slipping; less for others. Published: 0.0183
  double false_motion = 0.01;  ///< in (0, 1): probability that a pad at rest is taken for moving,
                               ///< for U_min
  double smallest_px = 0.5;    ///< U, > 0
  double largest_px = 8;       ///< > smallest_px
  int candidates = 13;         ///< 2 to 1000, in equal ratios; by default three per octave
  bool covers_pattern = false;  ///< of StickTest
};
inline void expects_valid(const StickTestOptions& options) {
  const char* const owner = "StickTestOptions";
  const auto in_unit = [&](double share, const char* name) {
    expects(share > 0 && share < 1, owner, name, share, "in (0, 1)");
  };
  in_unit(options.false_slip, "false_slip");
  in_unit(options.false_motion, "false_motion");
  expects(is_finite(options.smallest_px) && options.smallest_px > 0, owner, "smallest_px",
          options.smallest_px, "finite and > 0");
  expects(is_finite(options.largest_px) && options.largest_px > options.smallest_px, owner,
          "largest_px", options.largest_px, "finite and > smallest_px");
  expects(options.candidates >= 2 && options.candidates <= 1000, owner, "candidates",
          static_cast<long long>(options.candidates), "in [2, 1000]");
}

namespace detail::stick {

/// sigma of a position in the difference that is compared with delta_0. With averaging it is the
/// larger one of inner and edge dots.
template <scalar S>
S compared_noise_px(const NoDenoising&, const DotNoise<S>& noise) {
  return noise.noise_px;
}
template <scalar S>
S compared_noise_px(const ResidualMean&, const DotNoise<S>& noise) {
  return noise.inner_px < noise.edge_px || !is_finite(noise.inner_px) ? noise.edge_px
                                                                      : noise.inner_px;
}
/// sigma of a position in d_max.
template <scalar S>
S placed_noise_px(const NoDenoising&, const DotNoise<S>& noise) {
  return noise.noise_px;
}
template <scalar S>
S placed_noise_px(const ResidualMean&, const DotNoise<S>& noise) {
  return noise.noise_px;
}

/// Factor by which the object's motion increases the noise of a dot. Motion from many dots adds
/// hardly any.
template <Freedom Free>
double motion_noise_factor(const StickConsensus<Free>&) {
  return 1;
}

}  // namespace detail::stick

/// delta_0 and U_min for a sensor with this noise and a given U, by default the published one. All
/// three are in the unit of the noise, and double, without derivatives, because they are
/// thresholds. Refuses noise that makes U too small (parameter_error).
template <class Motion = StickConsensus<>, class Denoising = ResidualMean, scalar S = double>
StickTest stick_test_for(Index dots,
                         const DotNoise<S>& noise,
                         double reference_px = 2,
                         const StickTestOptions& options = {},
                         const Motion& motion = {},
                         const Denoising& denoising = {}) {
  const char* const owner = "stick_test_for";
  expects_valid(options);
  expects(dots >= 1, owner, "dots", static_cast<long long>(dots), ">= 1");
  using detail::stick::compared_noise_px;  // published policies have their own
  using detail::stick::motion_noise_factor;
  using detail::stick::placed_noise_px;
  const auto compared_px = static_cast<double>(value(compared_noise_px(denoising, noise)));
  const auto placed_px = static_cast<double>(value(placed_noise_px(denoising, noise)));
  expects(is_finite(placed_px) && placed_px > 0, owner, "noise of a dot", placed_px,
          "finite and > 0");
  expects(is_finite(compared_px) && compared_px > 0, owner, "noise of an averaged dot", compared_px,
          "finite and > 0");
  StickTest test;
  test.pitch = 1;
  test.free_frames = 0;  // the noise is already known
  test.covers_pattern = options.covers_pattern;
  test.reference = reference_px;
  test.slip = slip_threshold_for(compared_px * motion_noise_factor(motion), options.false_slip);
  test.store = slip_threshold_for(placed_px, false_slip_of_each(options.false_motion, dots));
  expects(is_finite(reference_px) && reference_px > (std::max)(test.slip, test.store), owner,
          "reference_px", reference_px, "finite and > slip and store, which noise sets");
  expects_valid(test);
  return test;
}

}  // namespace v0
}  // namespace fingerpad
