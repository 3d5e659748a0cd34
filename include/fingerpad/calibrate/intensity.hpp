// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The law of a one-channel pad, from presses of a ball of known radius. Where the ball touches, the
// depth is d - R + sqrt(R^2 - r^2), r from the ball's axis; its place and depth d are found
// together with the law, by Gauss-Newton steps on the depths. The start is in closed form: near the
// axis the logarithm is a paraboloid, whose curvature is 1 / (R a). Accuracy: the law is as good as
// the gel follows the ball, which it does not near the rim of the contact.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

/// A ball and the camera that sees it pressed.
struct BallPress {
  double ball_mm = 4;          ///< its radius; finite, > 0
  double mm_per_px = 0.05;     ///< finite, > 0
  double contact_share = 0.1;  ///< pixels count where the ball is deeper than this share of its
                               ///< depth: nearer to the rim the gel bridges; in [0, 1)
};
inline void expects_valid(const BallPress& press) {
  constexpr const char* owner = "BallPress";
  expects(is_finite(press.ball_mm) && press.ball_mm > 0, owner, "ball_mm", press.ball_mm,
          "finite and > 0");
  expects(is_finite(press.mm_per_px) && press.mm_per_px > 0, owner, "mm_per_px", press.mm_per_px,
          "finite and > 0");
  expects(press.contact_share >= 0 && press.contact_share < 1, owner, "contact_share",
          press.contact_share, "in [0, 1)");
}

/// The law, and how well it is known.
struct [[nodiscard]] IntensityFit {
  FitStatus status = FitStatus::nothing_to_check;
  IntensityLaw law = {};
  /// Of linear_mm, square_mm and cube_mm, mm^2; 0 for what was not fitted. Neighbouring pixels err
  /// alike: they count as one in blocks of 16 x 16.
  std::array<std::array<double, 3>, 3> covariance = {};
  double mean_error_mm = 0;  ///< |depth by the law - depth of the ball|, over all presses
  double max_error_mm = 0;
  double max_depth_mm = 0;  ///< of the balls: beyond it the law is a guess
  Index pixels = 0;         ///< in contact with a ball

  bool ok() const { return status == FitStatus::ok; }
};

/// Collects presses and fits the law to all of them. One press tells one constant; three take
/// presses that differ in depth, or one that is deep.
class IntensityCalibration {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit IntensityCalibration(const IntensityOptions& options = {}) : options_(options) {
    expects_valid(options);
  }

  /// Adds a press: a frame of the free pad and one with the ball in it. False, and nothing added,
  /// where their sizes differ, where the light beside the ball is not that of the free pad, or
  /// where no ball shows: a darkest spot that is round and tells 30 pixels.
  template <grid Free, grid Pressed>
  bool add(const Free& free, const Pressed& pressed, const BallPress& ball) {
    expects_valid(ball);
    const auto from = as_view(free);
    const IntensityDepth<double> log_ratio(from, {1, 0, 0}, options_);
    auto workspace = log_ratio.workspace();
    Press press{ball, {}, {}, 0, 0, from.cols()};
    press.log.resize(static_cast<std::size_t>(from.rows() * from.cols()));
    const StridedView<double> to(press.log.data(), from.rows(), from.cols(), from.cols());
    if (!log_ratio(pressed, to, workspace).ok() || !begin(press)) {
      return false;
    }
    presses_.push_back(std::move(press));
    return true;
  }

  /// The law a l (terms = 1), or with b l^2 and c l^3 (terms = 3). `depths_not_in_mm` where no ball
  /// is as deep as 0.05 mm; `colours_unexplained` where a ball would be deeper than its radius, or
  /// the mean error is more than a thirtieth of the depth: a real gel leaves half of that. A ball
  /// of twice the radius, pressed half as deep, looks the same: nothing tells a diameter for a
  /// radius.
  IntensityFit fit(int terms = 1) const {
    expects(terms == 1 || terms == 3, "IntensityCalibration", "terms",
            static_cast<long long>(terms), "1 or 3");
    IntensityFit result;
    if (presses_.empty()) {
      return result;
    }
    std::vector<Press> presses = presses_;
    Law law = {start_mm(), 0, 0};
    // with one constant the contact is found as well; with three it stands
    result.status = solve(presses, law, 1);
    if (terms == 3 && result.ok()) {
      result.status = solve(presses, law, 3);
    }
    if (!result.ok()) {
      return result;
    }
    result.law = {law[0], law[1], law[2]};
    judge(presses, law, terms, result);
    return result;
  }

 private:
  using Law = std::array<double, 3>;
  using Pose = std::array<double, 3>;  // x and y of the axis, depth
  static constexpr int max_steps = 50;
  static constexpr int settling_steps = 10;  // in which the contact may change
  static constexpr double converged_mm = 1e-7;
  static constexpr Index min_pixels = 30;
  static constexpr Index block_px = 16;

  struct Press {
    BallPress ball;
    std::vector<double> log;  // ln(free / now), NaN: unknown
    Point2<double> axis_mm;   // from the first pixel
    double depth_mm;
    double start_mm;  // the constant that this press alone suggests
    Index cols = 0;
    Point2<double> contact_mm = {0, 0};  // the contact that counts: its middle and
    double contact_radius_mm = 0;

    void settle() {
      const double root = ball.ball_mm - depth_mm * (1 - ball.contact_share);
      contact_mm = axis_mm;
      contact_radius_mm = std::sqrt((std::max)(0.0, ball.ball_mm * ball.ball_mm - root * root));
    }
    Point2<double> at(Index k) const {
      return {ball.mm_per_px * static_cast<double>(k % cols),
              ball.mm_per_px * static_cast<double>(k / cols)};
    }
    /// Calls visit(k, l, p, root) for the pixels in contact: l the logarithm, p from the axis,
    /// root = sqrt(R^2 - r^2).
    template <class Visit>
    void for_contact(const Visit& visit) const {
      const double radius_sq = contact_radius_mm * contact_radius_mm;
      for (std::size_t k = 0; k < log.size(); ++k) {
        const Point2<double> here = at(static_cast<Index>(k));
        const Point2<double> p = here - axis_mm;
        const double root_sq = ball.ball_mm * ball.ball_mm - squared_norm(p);
        if (squared_norm(Point2<double>(here - contact_mm)) < radius_sq && root_sq > 0 &&
            is_finite(log[k])) {
          visit(static_cast<Index>(k), log[k], p, std::sqrt(root_sq));
        }
      }
    }
  };

  /// Gauss-Newton steps on the law and the poses.
  static FitStatus solve(std::vector<Press>& presses, Law& law, int terms) {
    for (int step = 0; step < max_steps; ++step) {
      const Equations sums(presses, law, terms);
      if (!sums.good) {
        return FitStatus::not_converged;
      }
      const Law change = sums.solve_law();
      double moved = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        law[k] -= change[k];
        moved = (std::max)(moved, std::abs(change[k]));
      }
      for (std::size_t p = 0; p < presses.size(); ++p) {
        const Pose pose = sums.solve_pose(p, change);
        presses[p].axis_mm = presses[p].axis_mm - Point2<double>{pose[0], pose[1]};
        presses[p].depth_mm -= pose[2];
        moved = (std::max)({moved, std::abs(pose[0]), std::abs(pose[1]), std::abs(pose[2])});
        if (terms == 1 && step < settling_steps) {
          presses[p].settle();
        }
      }
      if (moved < converged_mm) {
        return FitStatus::ok;
      }
    }
    return FitStatus::not_converged;
  }

  static Law powers(double l, int terms) {
    return {l, terms == 3 ? l * l : 0, terms == 3 ? l * l * l : 0};
  }
  static double depth_of(const Law& law, double l) {
    return l * (law[0] + l * (law[1] + l * law[2]));
  }

  /// Where the ball is and what it suggests, from the paraboloid l = q0 + q1 x + q2 y + q3 (x^2 +
  /// y^2) fitted to where the logarithm is above half its largest.
  static bool begin(Press& press) {
    double largest = 0;
    for (const double l : press.log) {
      largest = l > largest ? l : largest;
    }
    detail::SmallMatrix<double, 4> matrix{};
    std::array<double, 4> right{};
    Index count = 0;
    for (std::size_t k = 0; k < press.log.size(); ++k) {
      if (press.log[k] > largest / 2) {
        const Point2<double> p = press.at(static_cast<Index>(k));
        const std::array<double, 4> row = {1, p.x, p.y, squared_norm(p)};
        for (std::size_t i = 0; i < 4; ++i) {
          for (std::size_t j = 0; j < 4; ++j) {
            matrix[i][j] += row[i] * row[j];
          }
          right[i] += row[i] * press.log[k];
        }
        ++count;
      }
    }
    const detail::NormalEquations<double, 4> equations(matrix, 1e-12);
    if (count < min_pixels || !equations.good) {
      return false;
    }
    const std::array<double, 4> q = equations.solve(right);
    if (!(q[3] < 0)) {
      return false;  // not darkest in the middle
    }
    press.axis_mm = {-q[1] / (2 * q[3]), -q[2] / (2 * q[3])};
    press.start_mm = -1 / (2 * press.ball.ball_mm * q[3]);
    press.depth_mm = press.start_mm * (q[0] - q[3] * squared_norm(press.axis_mm));
    press.settle();
    return press.depth_mm > 0 && press.depth_mm < press.ball.ball_mm;
  }

  double start_mm() const {
    double sum = 0;
    for (const Press& press : presses_) {
      sum += press.start_mm;
    }
    return sum / static_cast<double>(presses_.size());
  }

  /// Normal equations of law and poses; the poses, which do not meet each other, are eliminated.
  struct Equations {
    struct OfPose {
      detail::SmallMatrix<double, 3> pose{};
      detail::SmallMatrix<double, 3> with_law{};  // pose x law
      Pose right{};
    };
    std::vector<OfPose> poses;
    detail::SmallMatrix<double, 3> law{};
    Law right{};
    bool good = true;

    Equations(const std::vector<Press>& presses, const Law& at, int terms) {
      for (const Press& press : presses) {
        OfPose& of = poses.emplace_back();
        Index count = 0;
        press.for_contact([&](Index, double l, const Point2<double>& p, double root) {
          const double ball = press.depth_mm - press.ball.ball_mm + root;
          const double error = depth_of(at, l) - ball;
          const Law dl = powers(l, terms);
          const Pose dp = {-p.x / root, -p.y / root, -1};
          for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
              law[i][j] += dl[i] * dl[j];
              of.pose[i][j] += dp[i] * dp[j];
              of.with_law[i][j] += dp[i] * dl[j];
            }
            right[i] += dl[i] * error;
            of.right[i] += dp[i] * error;
          }
          ++count;
        });
        good = good && count >= min_pixels;
      }
      for (std::size_t k = static_cast<std::size_t>(terms); k < 3; ++k) {
        law[k][k] = 1;  // not fitted: no change
      }
      eliminate();
    }

    void eliminate() {
      for (const OfPose& of : poses) {
        const detail::NormalEquations<double, 3> own(of.pose);
        good = good && own.good;
        for (std::size_t j = 0; good && j < 3; ++j) {
          const auto x = own.solve({of.with_law[0][j], of.with_law[1][j], of.with_law[2][j]});
          for (std::size_t k = 0; k < 3; ++k) {
            right[j] -= x[k] * of.right[k];
            for (std::size_t i = 0; i < 3; ++i) {
              law[i][j] -= of.with_law[k][i] * x[k];
            }
          }
        }
      }
      good = good && detail::NormalEquations<double, 3>(law).good;
    }

    Law solve_law() const { return detail::NormalEquations<double, 3>(law).solve(right); }
    Pose solve_pose(std::size_t p, const Law& change) const {
      Pose rest = poses[p].right;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          rest[i] -= poses[p].with_law[i][j] * change[j];
        }
      }
      return detail::NormalEquations<double, 3>(poses[p].pose).solve(rest);
    }
  };

  static void judge(const std::vector<Press>& presses,
                    const Law& law,
                    int terms,
                    IntensityFit& result) {
    double blocks_sq = 0;
    bool too_deep = false;
    for (const Press& press : presses) {
      too_deep = too_deep || press.depth_mm >= press.ball.ball_mm;
      const Index block_cols = press.cols / block_px + 1;
      std::vector<double> blocks(press.log.size() / std::size_t(block_px) + std::size_t(block_cols),
                                 0);
      result.max_depth_mm = (std::max)(result.max_depth_mm, press.depth_mm);
      press.for_contact([&](Index k, double l, const Point2<double>&, double root) {
        const double error = depth_of(law, l) - (press.depth_mm - press.ball.ball_mm + root);
        result.mean_error_mm += std::abs(error);
        result.max_error_mm = (std::max)(result.max_error_mm, std::abs(error));
        ++result.pixels;
        const Index block = k / press.cols / block_px * block_cols + k % press.cols / block_px;
        blocks[static_cast<std::size_t>(block)] += error;
      });
      for (const double sum : blocks) {
        blocks_sq += sum * sum;
      }
    }
    result.mean_error_mm /= static_cast<double>(result.pixels);
    if (result.max_depth_mm < 0.05) {
      result.status = FitStatus::depths_not_in_mm;
    } else if (too_deep || 30 * result.mean_error_mm > result.max_depth_mm) {
      result.status = FitStatus::colours_unexplained;
    }
    const Equations sums(presses, law, terms);
    if (!sums.good || result.pixels <= 3 * static_cast<Index>(presses.size()) + terms) {
      result.status = FitStatus::nothing_to_check;
      return;
    }
    const detail::NormalEquations<double, 3> equations(sums.law);
    const double variance = blocks_sq / static_cast<double>(result.pixels);
    for (std::size_t j = 0; j < static_cast<std::size_t>(terms); ++j) {
      Law unit{};
      unit[j] = 1;
      const Law column = equations.solve(unit);
      for (std::size_t i = 0; i < static_cast<std::size_t>(terms); ++i) {
        result.covariance[i][j] = variance * column[i];
      }
    }
  }

  IntensityOptions options_;
  std::vector<Press> presses_;
};

}  // namespace v0
}  // namespace fingerpad
