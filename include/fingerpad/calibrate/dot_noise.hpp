// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of dot positions, from frames of a pad at rest, for StickOptions::noise. Source: "Method to
// decrease of data variation of dots" and "Selection of delta_0" of 003.
// Published is the noise relative to the central dot, which is that of two positions; here the mean
// motion between two frames is subtracted instead (docs/errata.md, E037).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// Noise of one position along one axis, in px or whatever unit the dots are in.
template <scalar S = double>
struct [[nodiscard]] DotNoise {
  const char* cause = nullptr;  ///< likely mistake
  S noise_px = S(0);            ///< standard deviation, root mean square over the dots
  S noise_error_px = S(0);      ///< its standard error, for noise independent between frames
  /// Share of the variance that does not appear between successive frames: near 0 for noise, near 1
  /// if the pad moved; NaN if no two have dots in common.
  S slow_share = S(0);
  Index dots = 0;  ///< found in one frame or more

  bool ok() const { return cause == nullptr; }
};

/// Frames in a row, such as std::vector<cv::Mat_<cv::Vec2d>>.
template <class F> concept dot_frames = requires(const F& frames) {
  { *(std::begin(frames) + 1) } -> dot_grid;
  std::size(frames);
};

/// The noise in `frames_px`, dot grids of one size, of a pad at rest. The motion of the whole
/// pattern does not count, so a shaking camera does no harm, nor do lost dots. Steps longer than a
/// quarter of a pitch are no noise but exchanged dots. Refuses fewer than two frames, frames of
/// different sizes, dots in too few frames, and identical frames, as in a recording that repeats
/// them (parameter_error). O(frames rows cols), up to 31 times.
template <scalar S = double, dot_frames Frames>
DotNoise<S> dot_noise(const Frames& frames_px) {
  using std::sqrt;
  using P = cell_t<decltype(*std::begin(frames_px))>;
  const char* const owner = "dot_noise";
  const auto frames = static_cast<Index>(std::size(frames_px));
  expects(frames >= 2, owner, "frames", static_cast<long long>(frames), ">= 2");
  const auto frame = [&](Index t) { return as_view(*(std::begin(frames_px) + t)); };
  const Index rows = frame(0).rows(), cols = frame(0).cols();
  expects_grid_size(owner, rows, cols);
  for (Index t = 0; t < frames; ++t) {
    expects(same_size(frame(t), frame(0)), owner, "rows", static_cast<long long>(frame(t).rows()),
            "those of the first frame, as cols");
  }
  const auto dot = [&](Index t, Index i, Index j) {
    Point2<S> at = {not_a_number<S>(), not_a_number<S>()};
    if (i < rows && j < cols) {
      const P p = frame(t)(i, j);
      at = is_present(p) ? Point2<S>{S(point_traits<P>::x(p)), S(point_traits<P>::y(p))} : at;
    }
    return at;
  };
  std::vector<Point2<S>> steps;
  const auto add = [&](const Point2<S>& from, const Point2<S>& to) {
    if (is_finite(from.x) && is_finite(to.x)) {
      steps.push_back(to - from);
    }
  };
  const auto median = [&](const auto& number_of) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end(),
                     [&](const auto& a, const auto& b) { return number_of(a) < number_of(b); });
    return steps.empty() ? S(0) : S(number_of(*middle));
  };

  DotNoise<S> noise;
  double freedom = 1 - static_cast<double>(frames);  // positions less those for places and motion
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      Index found = 0;
      for (Index t = 0; t < frames; ++t) {
        found += is_finite(dot(t, i, j).x) ? 1 : 0;
        add(dot(t, i, j), dot(t, i, j + 1));
        add(dot(t, i, j), dot(t, i + 1, j));
      }
      noise.dots += found > 0 ? 1 : 0;
      freedom += static_cast<double>((std::max)(found - 1, Index(0)));
    }
  }
  expects(noise.dots >= 2, owner, "dots", static_cast<long long>(noise.dots), ">= 2");
  const S limit_sq = median([](const auto& p) { return squared_norm(p); }) / S(16);

  // a step has twice the variance of a position; their mean takes one of n degrees of freedom
  S squares = S(0), squares_of_next = S(0);
  double count = 0, count_of_next = 0;
  for (Index lag = 1; lag < frames; lag += (std::max)(frames / 16, Index(1))) {
    for (Index t = 0; t + lag < frames; ++t) {
      steps.clear();
      for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < cols; ++j) {
          add(dot(t, i, j), dot(t + lag, i, j));
        }
      }
      const Point2<S> usual = {median([](const auto& p) { return p.x; }),
                               median([](const auto& p) { return p.y; })};
      std::erase_if(steps, [&](const auto& p) {
        return S(0) < limit_sq && limit_sq < squared_norm(p - usual);
      });
      Point2<S> sum = {S(0), S(0)};
      for (const Point2<S>& p : steps) {
        sum = sum + p;
      }
      const double n = static_cast<double>(steps.size());
      for (const Point2<S>& p : steps) {
        squares += squared_norm(p - sum / S(n));
      }
      count += (std::max)(n - 1, 0.0);
    }
    squares_of_next = lag == 1 ? squares : squares_of_next;
    count_of_next = lag == 1 ? count : count_of_next;
  }
  expects(freedom >= 1 && count >= 1, owner, "degrees of freedom of the positions", freedom,
          ">= 1: more dots must be found in the same frames");
  expects(S(0) < squares, owner, "noise_px", squares, "> 0: the frames are identical");
  noise.noise_px = sqrt(squares / S(4 * count));
  noise.noise_error_px = noise.noise_px / S(2 * std::sqrt(freedom));
  noise.slow_share = S(1) - squares_of_next / squares * S(count / count_of_next);
  noise.cause = S(0.5) < noise.slow_share
                    ? "the dots move slowly, unlike noise: check that the pad is at rest"
                    : nullptr;
  return noise;
}

}  // namespace v1
}  // namespace fingerpad
