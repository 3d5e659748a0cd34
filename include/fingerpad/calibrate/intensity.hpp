// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The law of a one-channel pad, from presses of a ball of known radius R. In contact, at the
// distance r from the ball's axis, the depth is d - R + sqrt(R^2 - r^2). The position and depth d
// of the ball are found together with the law, by Gauss-Newton steps on the depths. The start is in
// closed form: near the axis the logarithm is a paraboloid with curvature 1 / (R a). The law is
// only as accurate as the gel follows the ball, which it does not near the rim of the contact:
// where the ball is not as deep as a tenth of its largest depth, pixels are not used.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
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
  IntensityLaw<S> law = {};
  /// Of linear_mm, square_mm and cube_mm, mm^2; 0 for constants not fitted. Errors of neighbouring
  /// pixels are correlated: a block of 16 x 16 pixels counts as one.
  std::array<std::array<S, 3>, 3> covariance = detail::zero_matrix<S, 3>();
  S mean_error_mm = S(0);  ///< |depth by the law - depth of the ball|, over all presses
  S max_depth_mm = S(0);   ///< of the balls; beyond it the law is extrapolated

  bool ok() const { return cause == nullptr; }
};

namespace detail {

/// A press of the ball: its image, and the ball in it.
template <scalar S>
struct PressedBall {
  static constexpr std::size_t min_pixels = 30;  // more than there are unknowns

  S ball_mm, mm_per_px;  // radius of the ball, scale of the image
  Index cols;
  std::vector<S> log;                // ln(free / now), NaN: unknown
  Point2<S> axis_mm = {S(0), S(0)};  // from the first pixel
  S depth_mm = S(0);
  std::vector<std::size_t> used = {};  // pixels

  Point2<S> at(std::size_t k) const {
    const auto i = static_cast<Index>(k);
    return {mm_per_px * S(static_cast<double>(i % cols)),
            mm_per_px * S(static_cast<double>(i / cols))};
  }

  /// Uses the pixels where the ball is deeper than a tenth of its depth.
  void settle() {
    const S radius_sq = square(ball_mm) - square(ball_mm - S(0.9) * depth_mm);
    used.clear();
    for (std::size_t k = 0; k < log.size(); ++k) {
      if (is_finite(log[k]) && squared_norm(at(k) - axis_mm) < radius_sq) {
        used.push_back(k);
      }
    }
  }

  /// Finds the ball from a paraboloid l = q0 + q1 x + q2 y + q3 (x^2 + y^2), fitted to the pixels
  /// whose logarithm exceeds half of the largest. Returns the law's first constant, mm; 0 if there
  /// is no ball.
  S start() {
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
      return S(0);  // the middle is not the darkest part
    }
    const S bend = S(-2) * q[3];
    const S law_mm = S(1) / (ball_mm * bend);
    axis_mm = {q[1] / bend, q[2] / bend};
    depth_mm = law_mm * (q[0] - q[3] * squared_norm(axis_mm));
    settle();
    return S(0) < depth_mm && depth_mm < ball_mm ? law_mm : S(0);
  }

  /// Calls visit(k, row) for the pixels used: the derivatives by x, y and depth of the ball and by
  /// the three constants, and the depth by the law less that of the ball.
  template <class Visit>
  void for_contact(const std::array<S, 3>& law, const Visit& visit) const {
    using std::sqrt;
    for (const std::size_t k : used) {
      const Point2<S> p = at(k) - axis_mm;
      const S root_sq = square(ball_mm) - squared_norm(p);
      if (S(0) < root_sq) {
        const S root = sqrt(root_sq), l = log[k];
        const S by_law = pressed_depth_mm(IntensityLaw<S>{law[0], law[1], law[2]}, l);
        visit(k, std::array<S, 7>{-p.x / root, -p.y / root, S(-1), l, l * l, l * l * l,
                                  by_law - (depth_mm - ball_mm + root)});
      }
    }
  }
};

/// The normal equations of a step as a triangle. The unknowns are x, y and depth of each press,
/// then the constants of the law; the right sides are the residuals and the unit vectors of the
/// constants, of which the solutions are the changes and the last columns of the inverse.
template <scalar S>
Triangle<S> step_equations(const std::vector<PressedBall<S>>& presses,
                           const std::array<S, 3>& law,
                           std::size_t terms) {
  const std::size_t poses = 3 * presses.size(), size = poses + terms, cols = size + 1 + terms;
  std::vector<S> rows(size * cols, S(0));
  for (std::size_t p = 0; p < presses.size(); ++p) {
    ProductSums<S, 7> sums;
    presses[p].for_contact(law, [&](std::size_t, const auto& equation) { sums.add(equation); });
    const auto place = [&](std::size_t i) { return i < 3 ? 3 * p + i : poses + i - 3; };
    for (std::size_t i = 0; i < 3 + terms; ++i) {
      for (std::size_t j = 0; j < 3 + terms; ++j) {
        rows[place(i) * cols + place(j)] += sums(i, j);
      }
      rows[place(i) * cols + size] += sums(i, 6);
    }
  }
  for (std::size_t k = 0; k < terms; ++k) {
    rows[(poses + k) * cols + size + 1 + k] = S(1);
  }
  return Triangle<S>(std::move(rows), cols);
}

/// Whether no press has too few pixels and no unknown depends on those before it.
template <scalar S>
bool are_determined(const std::vector<PressedBall<S>>& presses,
                    const Triangle<S>& step,
                    std::size_t terms) {
  const S least = S((std::max)(1e-12, static_cast<double>(epsilon<S>())));
  bool all = true;
  for (std::size_t j = 0; j < 3 * presses.size() + terms; ++j) {
    all = all && least < step.independent_share(j);
  }
  for (const PressedBall<S>& press : presses) {
    all = all && press.used.size() >= PressedBall<S>::min_pixels;
  }
  return all;
}

/// Gauss-Newton steps on the law and the balls; false if they do not converge.
template <scalar S>
bool fit_law(std::vector<PressedBall<S>>& presses, std::array<S, 3>& law, std::size_t terms) {
  constexpr int max_steps = 50, settling_steps = 10;  // in which the contact may change
  const S settled_mm = S((std::max)(scalar_real_t<S>(1e-7), scalar_real_t<S>(1000) * epsilon<S>()));
  for (int step = 0; step < max_steps; ++step) {
    const Triangle<S> equations = step_equations(presses, law, terms);
    if (!are_determined(presses, equations, terms)) {
      return false;
    }
    const std::size_t size = 3 * presses.size() + terms;
    const std::vector<S> changes = equations.solve(size, size);
    bool settled = true;
    auto next = changes.begin();
    const auto move = [&](S& x) {
      const S change = *next++;
      settled = settled && -settled_mm < change && change < settled_mm;
      x -= change;
    };
    for (PressedBall<S>& press : presses) {
      move(press.axis_mm.x);
      move(press.axis_mm.y);
      move(press.depth_mm);
      if (terms == 1 && step < settling_steps) {
        press.settle();
      }
    }
    for (std::size_t k = 0; k < terms; ++k) {
      move(law[k]);
    }
    if (settled) {
      return true;
    }
  }
  return false;
}

}  // namespace detail

/// The law a l (terms = 1), or with b l^2 and c l^3 (terms = 3), from a frame of the free pad and a
/// container of frames, each with the ball pressed in. ball_mm: radius of the ball, > 0. One press
/// determines one constant; three need presses of different depths, or a deep one. Refuses bad
/// parameters and, by its number, from 0, a press that has another size, another light beside the
/// ball than the free pad, or no ball: a round darkest spot of at least 30 pixels
/// (parameter_error). Not ok: no ball is as deep as 0.05 mm; a ball would be deeper than its
/// radius; or the mean error exceeds a thirtieth of the largest depth, while a real gel leaves half
/// of that. A ball of twice the radius, pressed half as deep, looks the same, so a diameter given
/// as radius is not detected. Use double or long double: in float, sums over thousands of pixels
/// keep only three digits. Allocates; O(50 presses pixels).
template <scalar S = double, grid Free, class Frames>
IntensityFit<S> fit_intensity(const Free& free,
                              const Frames& pressed,
                              const std::type_identity_t<S>& ball_mm,
                              const std::type_identity_t<S>& mm_per_px,
                              int terms = 1,
                              const IntensityOptions& options = {}) {
  const char* const owner = "fit_intensity";
  expects(terms == 1 || terms == 3, owner, "terms", static_cast<long long>(terms), "1 or 3");
  require(owner, {{"ball_mm", ball_mm, positive}, {"mm_per_px", mm_per_px, positive}});
  IntensityDepth<S> log_ratio(free, IntensityLaw<S>{S(1), S(0), S(0)}, options);
  const Index rows = log_ratio.rows(), cols = log_ratio.cols();
  std::vector<detail::PressedBall<S>> presses;
  std::array<S, 3> law = detail::zeros<S, 3>();
  for (const auto& frame : pressed) {
    presses.push_back(
        {ball_mm, mm_per_px, cols, std::vector<S>(static_cast<std::size_t>(rows * cols))});
    const StridedView<S> log(presses.back().log.data(), rows, cols, cols);
    const S start_mm = log_ratio(frame, log) == FrameStatus::ok ? presses.back().start() : S(0);
    expects(S(0) < start_mm, owner, "press", static_cast<long long>(presses.size()) - 1,
            "of a ball: a round darkest spot, and beside it as bright as the free pad");
    law[0] += start_mm;
  }
  expects(!presses.empty(), owner, "number of presses", 0LL, ">= 1");
  law[0] /= S(static_cast<double>(presses.size()));

  IntensityFit<S> fit;
  const auto all = static_cast<std::size_t>(terms), unknowns = 3 * presses.size() + all;
  // one constant is fitted together with the contact, which stays fixed for three
  const bool converged = fit_law(presses, law, 1) && (all == 1 || fit_law(presses, law, all));
  const detail::Triangle<S> equations = step_equations(presses, law, all);
  if (!converged || !are_determined(presses, equations, all)) {
    fit.cause = cause::not_converged;
    return fit;
  }
  fit.law = {law[0], law[1], law[2]};
  S blocks_sq = S(0), pixels = S(0);
  bool too_deep = false;
  for (const detail::PressedBall<S>& press : presses) {
    constexpr Index block_px = 16;
    const Index block_cols = cols / block_px + 1;
    std::vector<S> blocks(static_cast<std::size_t>((rows / block_px + 1) * block_cols), S(0));
    press.for_contact(law, [&](std::size_t k, const std::array<S, 7>& equation) {
      const S error = equation[6], size = error < S(0) ? -error : error;
      fit.mean_error_mm += size;
      pixels += S(1);
      const Index i = static_cast<Index>(k) / cols, j = static_cast<Index>(k) % cols;
      blocks[static_cast<std::size_t>(i / block_px * block_cols + j / block_px)] += error;
    });
    for (const S& sum : blocks) {
      blocks_sq += square(sum);
    }
    too_deep = too_deep || !(press.depth_mm < ball_mm);
    fit.max_depth_mm = (std::max)(fit.max_depth_mm, press.depth_mm);
  }
  fit.mean_error_mm /= pixels;
  for (std::size_t j = 0; j < all; ++j) {
    const std::vector<S> column = equations.solve(unknowns, unknowns + 1 + j);
    for (std::size_t i = 0; i < all; ++i) {
      fit.covariance[i][j] = blocks_sq / pixels * column[unknowns - all + i];
    }
  }
  if (fit.max_depth_mm < S(0.05)) {
    fit.cause = cause::depths_not_in_mm;
  } else if (too_deep || fit.max_depth_mm < S(30) * fit.mean_error_mm) {
    fit.cause = cause::colours_unexplained;
  }
  return fit;
}

}  // namespace v1
}  // namespace fingerpad
