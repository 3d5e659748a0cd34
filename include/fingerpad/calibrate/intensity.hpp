// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The law of a one-channel pad, from presses of a ball of known radius R. In contact, at the
// distance r from the ball's axis, the depth is d - R + sqrt(R^2 - r^2). The position and depth d
// of the ball are found together with the law, by Gauss-Newton steps on the depths. The start is in
// closed form: near the axis the logarithm is a paraboloid with curvature 1 / (R a). The law is
// only as accurate as the gel follows the ball, which it does not near the rim of the contact.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
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
inline namespace v0 {

/// A press of a ball, and the scale of the image.
template <scalar S = double>
struct BallPress {
  S ball_mm = S(4);             ///< radius of the ball; finite, > 0
  S mm_per_px = S(5) / S(100);  ///< finite, > 0
  double contact_share = 0.1;   ///< uses pixels where the ball is deeper than this share of its
                                ///< largest depth; the gel bridges near the rim; in [0, 1)
};
/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const BallPress<S>& press) {
  return check("BallPress",
               {{"ball_mm", press.ball_mm, positive},
                {"mm_per_px", press.mm_per_px, positive},
                {"contact_share", press.contact_share, {.min = 0, .max = 1, .below_max = true}}});
}

/// The law and its uncertainty.
template <scalar S = double>
struct [[nodiscard]] IntensityFit {
  const char* cause = cause::nothing_to_check;  ///< likely mistake
  IntensityLaw<S> law = {};
  /// Of linear_mm, square_mm and cube_mm, mm^2; 0 for constants not fitted. Errors of neighbouring
  /// pixels are correlated: a block of 16 x 16 pixels counts as one.
  detail::SmallMatrix<S, 3> covariance = detail::zero_matrix<S, 3>();
  S mean_error_mm = S(0);  ///< |depth by the law - depth of the ball|, over all presses
  S max_error_mm = S(0);
  S max_depth_mm = S(0);  ///< of the balls; beyond it the law is extrapolated
  Index pixels = 0;       ///< in contact with a ball

  bool ok() const { return cause == nullptr; }
};

/// Collects presses and fits the law to all of them. One press determines one constant; three
/// constants need presses of different depths, or a deep one. Use double or long double: in float,
/// sums over thousands of pixels keep only three digits.
template <scalar S = double>
class IntensityCalibration {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit IntensityCalibration(const IntensityOptions& options = {}) : options_(options) {
    require(options);
  }

  /// Adds a press: a frame of the free pad and one with the ball pressed in. False, and nothing
  /// added, if their sizes differ, if the light beside the ball is not that of the free pad, or if
  /// no ball is visible: a round darkest spot of at least 30 pixels.
  template <grid Free, grid Pressed>
  bool add(const Free& free, const Pressed& pressed, const BallPress<S>& ball) {
    require(ball);
    const auto from = as_view(free);
    IntensityDepth<S> log_ratio(from, {1, 0, 0}, options_);
    Press press(ball, from.cols());
    press.log.resize(static_cast<std::size_t>(from.rows() * from.cols()));
    const StridedView<S> to(press.log.data(), from.rows(), from.cols(), from.cols());
    if (!log_ratio(pressed, to).ok() || !start(press)) {
      return false;
    }
    presses_.push_back(std::move(press));
    return true;
  }

  /// The law a l (terms = 1), or with b l^2 and c l^3 (terms = 3). `depths_not_in_mm`: no ball is
  /// as deep as 0.05 mm. `colours_unexplained`: a ball would be deeper than its radius, or the mean
  /// error exceeds a thirtieth of the largest depth; a real gel leaves half of that. A ball of
  /// twice the radius, pressed half as deep, looks the same, so a diameter given as radius is not
  /// detected.
  IntensityFit<S> fit(int terms = 1) const {
    expects(terms == 1 || terms == 3, "IntensityCalibration", "terms",
            static_cast<long long>(terms), "1 or 3");
    IntensityFit<S> result;
    if (presses_.empty()) {
      return result;
    }
    std::vector<Press> presses = presses_;
    Law law = detail::zeros<S, 3>();
    for (const Press& press : presses) {
      law[0] += press.start_mm / S(static_cast<double>(presses.size()));
    }
    // one constant is fitted together with the contact, which stays fixed for three
    result.cause = solve(presses, law, 1);
    if (terms == 3 && result.ok()) {
      result.cause = solve(presses, law, 3);
    }
    if (!result.ok()) {
      return result;
    }
    result.law = {law[0], law[1], law[2]};
    judge(presses, law, static_cast<std::size_t>(terms), result);
    return result;
  }

 private:
  using Law = std::array<S, 3>;
  static constexpr int max_steps = 50;
  static constexpr int settling_steps = 10;  // in which the contact may change
  static constexpr Index min_pixels = 30;    // of a press: more than there are unknowns
  static constexpr Index block_px = 16;

  struct Press {
    Press(const BallPress<S>& of, Index columns) : ball(of), cols(columns) {}
    BallPress<S> ball;
    Index cols;
    std::vector<S> log = {};           // ln(free / now), NaN: unknown
    Point2<S> axis_mm = {S(0), S(0)};  // from the first pixel
    S depth_mm = S(0);
    S start_mm = S(0);                    // initial constant from this press alone
    Point2<S> contact_mm = {S(0), S(0)};  // center of the pixels used
    S contact_radius_sq = S(0);

    void settle() {
      const S root = ball.ball_mm - depth_mm * S(1 - ball.contact_share);
      const S radius_sq = square(ball.ball_mm) - square(root);
      contact_mm = axis_mm;
      contact_radius_sq = S(0) < radius_sq ? radius_sq : S(0);
    }
    Point2<S> at(Index k) const {
      return {ball.mm_per_px * S(static_cast<double>(k % cols)),
              ball.mm_per_px * S(static_cast<double>(k / cols))};
    }
    /// Calls visit(k, l, by, error) for the pixels in contact: l is the logarithm, `error` the
    /// depth by the law less that of the ball, `by` its derivatives by x, y and depth of the ball.
    template <class Visit>
    void for_contact(const Law& law, const Visit& visit) const {
      using std::sqrt;
      for (std::size_t k = 0; k < log.size(); ++k) {
        const Point2<S> here = at(static_cast<Index>(k));
        const Point2<S> p = here - axis_mm;
        const S root_sq = square(ball.ball_mm) - squared_norm(p);
        if (squared_norm(here - contact_mm) < contact_radius_sq && S(0) < root_sq &&
            is_finite(log[k])) {
          const S root = sqrt(root_sq);
          const S by_law = pressed_depth_mm(IntensityLaw<S>{law[0], law[1], law[2]}, log[k]);
          visit(static_cast<Index>(k), log[k], std::array<S, 3>{-p.x / root, -p.y / root, S(-1)},
                by_law - (depth_mm - ball.ball_mm + root));
        }
      }
    }
  };

  /// Normal equations of a step, solved by elimination without pivoting. The unknowns are x, y and
  /// depth of each press, then the constants of the law.
  struct Equations {
    std::size_t size;
    std::vector<std::vector<S>> row;  // left sides, right side, unit columns of the law
    bool good = true;  // enough pixels, and no column is a combination of those before it

    Equations(const std::vector<Press>& presses, const Law& law, std::size_t terms)
        : size(3 * presses.size() + terms), row(size, std::vector<S>(size + 1 + terms, S(0))) {
      for (std::size_t p = 0; p < presses.size(); ++p) {
        const auto at = [&](std::size_t i) { return 3 * (i < 3 ? p : presses.size() - 1) + i; };
        Index count = 0;
        auto sums = detail::zero_matrix<S, 7>();  // lower half
        presses[p].for_contact(law, [&](Index, const S& l, const auto& pose, const S& error) {
          const std::array<S, 7> by = {pose[0], pose[1], pose[2], l, l * l, l * l * l, error};
          for (std::size_t i = 0; i < 7; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
              sums[i][j] += by[i] * by[j];
            }
          }
          ++count;
        });
        for (std::size_t i = 0; i < 3 + terms; ++i) {
          for (std::size_t j = 0; j < 3 + terms; ++j) {
            row[at(i)][at(j)] += sums[(std::max)(i, j)][(std::min)(i, j)];
          }
          row[at(i)][size] += sums[6][i];
        }
        good = good && count >= min_pixels;
      }
      for (std::size_t k = 0; k < terms; ++k) {
        row[size - terms + k][size + 1 + k] = S(1);
      }
      eliminate();
    }

    void eliminate() {
      std::vector<S> whole;
      for (std::size_t j = 0; j < size; ++j) {
        whole.push_back(row[j][j]);
      }
      for (std::size_t j = 0; j < size && good; ++j) {
        good = S(pivot_least()) * whole[j] < row[j][j];
        const S pivot = row[j][j];
        for (S& x : row[j]) {
          x /= pivot;
        }
        for (std::size_t i = 0; i < size; ++i) {
          const S share = row[i][j];
          for (std::size_t k = j; k < row[i].size() && i != j; ++k) {
            row[i][k] -= share * row[j][k];
          }
        }
      }
    }
  };

  static S size_of(const S& x) { return x < S(0) ? -x : x; }
  static void raise(S& largest, const S& x) { largest = largest < x ? x : largest; }
  /// Smallest share of an independent column: 1e-12, or the roundoff of S.
  static double pivot_least() { return (std::max)(1e-12, static_cast<double>(epsilon<S>())); }

  /// Gauss-Newton steps on the law and the balls.
  static const char* solve(std::vector<Press>& presses, Law& law, std::size_t terms) {
    const S settled_mm =
        S((std::max)(scalar_real_t<S>(1e-7), scalar_real_t<S>(1000) * epsilon<S>()));
    for (int step = 0; step < max_steps; ++step) {
      const Equations equations(presses, law, terms);
      if (!equations.good) {
        return cause::not_converged;
      }
      S moved = S(0);
      std::size_t i = 0;
      const auto move = [&](S& x) {
        const S& change = equations.row[i++][equations.size];
        raise(moved, size_of(change));
        x -= change;
      };
      for (Press& press : presses) {
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
      if (moved < settled_mm) {
        return nullptr;
      }
    }
    return cause::not_converged;
  }

  /// Initial axis, depth and constant of a press, from a paraboloid
  ///   l = q0 + q1 x + q2 y + q3 (x^2 + y^2)
  /// fitted to the pixels whose logarithm exceeds half of the largest. False if there is no ball.
  static bool start(Press& press) {
    S largest = S(0);
    for (const S& l : press.log) {
      raise(largest, l);
    }
    auto matrix = detail::zero_matrix<S, 4>();
    auto right = detail::zeros<S, 4>();
    Index count = 0;
    for (std::size_t k = 0; k < press.log.size(); ++k) {
      if (largest < S(2) * press.log[k]) {
        const Point2<S> p = press.at(static_cast<Index>(k));
        const std::array<S, 4> row = {S(1), p.x, p.y, squared_norm(p)};
        for (std::size_t i = 0; i < 4; ++i) {
          for (std::size_t j = 0; j < 4; ++j) {
            matrix[i][j] += row[i] * row[j];
          }
          right[i] += row[i] * press.log[k];
        }
        ++count;
      }
    }
    const detail::NormalEquations<S, 4> equations(matrix, pivot_least());
    const std::array<S, 4> q = equations.solve(right);
    if (count < min_pixels || !equations.good || !(q[3] < S(0))) {
      return false;  // the middle is not the darkest part
    }
    const S twice = S(-2) * q[3];
    press.axis_mm = {q[1] / twice, q[2] / twice};
    press.start_mm = S(1) / (press.ball.ball_mm * twice);
    press.depth_mm = press.start_mm * (q[0] - q[3] * squared_norm(press.axis_mm));
    press.settle();
    return S(0) < press.depth_mm && press.depth_mm < press.ball.ball_mm;
  }

  static void judge(const std::vector<Press>& presses,
                    const Law& law,
                    std::size_t terms,
                    IntensityFit<S>& result) {
    S blocks_sq = S(0);
    bool too_deep = false;
    for (const Press& press : presses) {
      too_deep = too_deep || !(press.depth_mm < press.ball.ball_mm);
      raise(result.max_depth_mm, press.depth_mm);
      const Index block_cols = press.cols / block_px + 1;
      std::vector<S> blocks(press.log.size() / std::size_t(block_px) + std::size_t(block_cols),
                            S(0));
      press.for_contact(law, [&](Index k, const S&, const auto&, const S& error) {
        result.mean_error_mm += size_of(error);
        raise(result.max_error_mm, size_of(error));
        ++result.pixels;
        const Index block = k / press.cols / block_px * block_cols + k % press.cols / block_px;
        blocks[static_cast<std::size_t>(block)] += error;
      });
      for (const S& sum : blocks) {
        blocks_sq += square(sum);
      }
    }
    const S pixels = S(static_cast<double>(result.pixels));
    result.mean_error_mm /= pixels;
    if (result.max_depth_mm < S(0.05)) {
      result.cause = cause::depths_not_in_mm;
    } else if (too_deep || result.max_depth_mm < S(30) * result.mean_error_mm) {
      result.cause = cause::colours_unexplained;
    }
    const Equations equations(presses, law, terms);
    if (!equations.good) {
      result.cause = cause::nothing_to_check;
      return;
    }
    for (std::size_t i = 0; i < terms; ++i) {
      for (std::size_t j = 0; j < terms; ++j) {
        result.covariance[i][j] =
            blocks_sq / pixels * equations.row[3 * presses.size() + i][equations.size + 1 + j];
      }
    }
  }

  IntensityOptions options_;
  std::vector<Press> presses_;
};

}  // namespace v0
}  // namespace fingerpad
