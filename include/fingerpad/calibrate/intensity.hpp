// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The constant of a one-channel pad, depth = a ln(free / now), from presses of a ball of known
// radius R. In contact, at the distance r from the ball's axis, the depth is d - R + sqrt(R^2 -
// r^2). Position and depth d of the ball are found together with a, by Gauss-Newton steps on the
// depths of each press; presses count by their information on a. The start is in closed form: near
// the axis the logarithm is a paraboloid with curvature 1 / (R a). The law is only as accurate as
// the gel follows the ball, which it does not near the rim of the contact: where the ball is not as
// deep as a tenth of its largest depth, pixels are not used.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {

/// The law and its uncertainty.
template <scalar S = double>
struct [[nodiscard]] IntensityFit {
  const char* cause = nullptr;  ///< likely mistake
  IntensityLaw<S> law = {};     ///< its first constant
  S variance_mm2 = S(0);   ///< of the constant. Errors of neighbouring pixels are correlated: a
                           ///< block of 16 x 16 pixels counts as one
  S mean_error_mm = S(0);  ///< |depth by the law - depth of the ball|, over all presses
  S max_depth_mm = S(0);   ///< of the balls; beyond it the law is extrapolated

  bool ok() const { return cause == nullptr; }
};

namespace detail {

/// A press of the ball: its image, the ball in it, and the constant that follows.
template <scalar S>
struct PressedBall {
  static constexpr std::size_t min_pixels = 30;  // more than there are unknowns

  S ball_mm, mm_per_px;  // radius of the ball, scale of the image
  Index cols;
  std::vector<S> log;                     // ln(free / now), NaN: unknown
  std::array<S, 4> ball = zeros<S, 4>();  // axis x and y from the first pixel, depth, a; mm
  SmallMatrix<S, 4> cofactor = {};        // inverse of the normal equations

  Point2<S> at(std::size_t k) const {
    const auto i = static_cast<Index>(k);
    return {mm_per_px * S(static_cast<double>(i % cols)),
            mm_per_px * S(static_cast<double>(i / cols))};
  }

  /// Finds the ball from a paraboloid l = q0 + q1 x + q2 y + q3 (x^2 + y^2), fitted to the pixels
  /// whose logarithm exceeds half of the largest; false if there is no ball.
  bool start() {
    S largest = S(0);
    for (const S& l : log) {
      largest = largest < l ? l : largest;
    }
    ProductSums<S, 5> sums;  // of 1, x, y, x^2 + y^2, l
    std::size_t count = 0;
    for (std::size_t k = 0; k < log.size(); ++k) {
      if (largest < S(2) * log[k]) {
        const Point2<S> p = at(k);
        sums.add({S(1), p.x, p.y, squared_norm(p), log[k]});
        ++count;
      }
    }
    const NormalEquations<S, 4> equations(sums.template corner<4>(), 1e-12);
    const auto q = equations.solve(sums.template column<4>(4));
    if (count < min_pixels || !equations.good || !(q[3] < S(0))) {
      return false;  // the middle is not the darkest part
    }
    const S bend = S(-2) * q[3], law_mm = S(1) / (ball_mm * bend);
    const Point2<S> axis_mm = {q[1] / bend, q[2] / bend};
    ball = {axis_mm.x, axis_mm.y, law_mm * (q[0] - q[3] * squared_norm(axis_mm)), law_mm};
    return S(0) < ball[2] && ball[2] < ball_mm;
  }

  /// Calls visit(k, row) for the pixels where `contact` is deeper than a tenth of its depth: the
  /// derivatives by `ball`, and the depth by the law less that of the ball.
  template <class Visit>
  void for_contact(const std::array<S, 4>& contact, const Visit& visit) const {
    using std::sqrt;
    const S radius_sq = square(ball_mm) - square(ball_mm - S(0.9) * contact[2]);
    for (std::size_t k = 0; k < log.size(); ++k) {
      const Point2<S> p = at(k) - Point2<S>{ball[0], ball[1]};
      const S root_sq = square(ball_mm) - squared_norm(p);
      const bool touches = squared_norm(at(k) - Point2<S>{contact[0], contact[1]}) < radius_sq;
      if (is_finite(log[k]) && touches && S(0) < root_sq) {
        const S root = sqrt(root_sq), depth_mm = ball[2] - ball_mm + root;
        visit(k, std::array<S, 5>{-p.x / root, -p.y / root, S(-1), log[k],
                                  ball[3] * log[k] - depth_mm});
      }
    }
  }

  /// Gauss-Newton steps; false if they do not converge or the pixels do not determine the ball.
  bool fit() {
    constexpr int max_steps = 50, settling_steps = 10;  // in which the contact may change
    const S settled_mm =
        S((std::max)(scalar_real_t<S>(1e-7), scalar_real_t<S>(1000) * epsilon<S>()));
    std::array<S, 4> contact = ball;
    for (int step = 0; step < max_steps; ++step) {
      contact = step <= settling_steps ? ball : contact;
      ProductSums<S, 5> sums;
      std::size_t count = 0;
      for_contact(contact, [&](std::size_t, const std::array<S, 5>& row) {
        sums.add(row);
        ++count;
      });
      const NormalEquations<S, 4> equations(sums.template corner<4>(),
                                            (std::max)(1e-12, static_cast<double>(epsilon<S>())));
      if (count < min_pixels || !equations.good) {
        return false;
      }
      const std::array<S, 4> change = equations.solve(sums.template column<4>(4));
      bool settled = true;
      for (std::size_t k = 0; k < 4; ++k) {
        settled = settled && -settled_mm < change[k] && change[k] < settled_mm;
        ball[k] -= change[k];
      }
      if (settled) {
        cofactor = equations.inverse();
        return true;
      }
    }
    return false;
  }
};

}  // namespace detail

/// The law a l from a frame of the free pad and a container of frames, each with the ball pressed
/// in. ball_mm: radius of the ball, > 0. Refuses bad parameters and, by its number, from 0, a press
/// that has another size, another light beside the ball than the free pad, or no ball: a round
/// darkest spot of at least 30 pixels (parameter_error). Not ok: no ball is as deep as 0.05 mm; a
/// ball would be deeper than its radius; or the mean error exceeds a thirtieth of the largest
/// depth, while a real gel leaves half of that. A ball of twice the radius, pressed half as deep,
/// looks the same, so a diameter given as radius is not detected. Use double or long double: in
/// float, sums over thousands of pixels keep only three digits. Allocates; O(50 presses pixels).
template <scalar S = double, grid Free, class Frames>
IntensityFit<S> fit_intensity(const Free& free,
                              const Frames& pressed,
                              const std::type_identity_t<S>& ball_mm,
                              const std::type_identity_t<S>& mm_per_px,
                              const IntensityOptions& options = {}) {
  const char* const owner = "fit_intensity";
  require(owner, {{"ball_mm", ball_mm, positive}, {"mm_per_px", mm_per_px, positive}});
  IntensityDepth<S> log_ratio(free, IntensityLaw<S>{S(1), S(0), S(0)}, options);
  const Index rows = log_ratio.rows(), cols = log_ratio.cols();
  std::vector<detail::PressedBall<S>> presses;
  for (const auto& frame : pressed) {
    presses.push_back(
        {ball_mm, mm_per_px, cols, std::vector<S>(static_cast<std::size_t>(rows * cols))});
    const StridedView<S> log(presses.back().log.data(), rows, cols, cols);
    expects(log_ratio(frame, log) == FrameStatus::ok && presses.back().start(), owner, "press",
            static_cast<long long>(presses.size()) - 1,
            "of a ball: a round darkest spot, and beside it as bright as the free pad");
  }
  expects(!presses.empty(), owner, "number of presses", 0LL, ">= 1");

  IntensityFit<S> fit;
  S information = S(0), law_mm = S(0), blocks_sq = S(0), pixels = S(0);
  for (detail::PressedBall<S>& press : presses) {
    if (!press.fit()) {
      fit.cause = cause::not_converged;
      return fit;
    }
    information += S(1) / press.cofactor[3][3];
    law_mm += press.ball[3] / press.cofactor[3][3];
  }
  law_mm /= information;
  fit.law = {law_mm, S(0), S(0)};
  bool too_deep = false;
  for (detail::PressedBall<S>& press : presses) {
    const std::array<S, 4> contact = press.ball;
    const S change_mm = law_mm - press.ball[3];
    for (std::size_t k = 0; k < 4; ++k) {  // the best ball for the common constant
      press.ball[k] += change_mm * press.cofactor[3][k] / press.cofactor[3][3];
    }
    constexpr Index block_px = 16;
    const Index block_cols = cols / block_px + 1;
    std::vector<S> blocks(static_cast<std::size_t>((rows / block_px + 1) * block_cols), S(0));
    press.for_contact(contact, [&](std::size_t k, const std::array<S, 5>& row) {
      const S error = row[4], size = error < S(0) ? -error : error;
      fit.mean_error_mm += size;
      pixels += S(1);
      const Index i = static_cast<Index>(k) / cols, j = static_cast<Index>(k) % cols;
      blocks[static_cast<std::size_t>(i / block_px * block_cols + j / block_px)] += error;
    });
    for (const S& sum : blocks) {
      blocks_sq += square(sum);
    }
    too_deep = too_deep || !(press.ball[2] < ball_mm);
    fit.max_depth_mm = (std::max)(fit.max_depth_mm, press.ball[2]);
  }
  fit.mean_error_mm /= pixels;
  fit.variance_mm2 = blocks_sq / pixels / information;
  if (fit.max_depth_mm < S(0.05)) {
    fit.cause = cause::depths_not_in_mm;
  } else if (too_deep || fit.max_depth_mm < S(30) * fit.mean_error_mm) {
    fit.cause = cause::colours_unexplained;
  }
  return fit;
}

}  // namespace v1
}  // namespace fingerpad
