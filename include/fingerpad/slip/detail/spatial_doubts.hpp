// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Uncertainty of the number of sticking dots in space due to noise. If noise were drawn again, each
// dot near the limit could get the other answer on its own, and all dots together could, because
// the fitted motion would be another one.
//
// Slips are in standard deviations of a position, s is that of an averaged slip along one axis. The
// true slip of a dot is not known, only the averaged slip m, which contains noise. It is taken to
// be 0 (the dot sticks) or any slip with equal probability (it slips). The shares of both follow
// from all dots of the frame.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/slip/detail/dot_doubts.hpp"
#include "fingerpad/slip/detail/dot_pairs.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Quantities of the dots of a block that do not depend on the motion.
template <class S>
struct SlipNoise {
  Block<S> m;           ///< magnitude of the averaged slip
  Block<S> variance;    ///< s^2
  Block<S> false_slip;  ///< probability that noise takes a dot that sticks beyond the limit
};

/// At the edge of the contact neighbours are missing in the mean and more noise remains. The sum of
/// squared weights of the neighbours is 5/3 of their sum, exactly if all are there, otherwise to
/// within 5 %.
template <class S>
SlipNoise<S> noise_of_slips(const PairBlock<S>& b, S limit_sq) {
  using std::sqrt;
  SlipNoise<S> noise;
  for (std::size_t k = 0; k < block_dots; ++k) {
    const S weight = b.total_weight[k];
    const S variance = (S(52) + S(10.0 / 3) * weight) / (weight * weight);
    noise.variance[k] = variance;
    noise.false_slip[k] = falling_exp(S(limit_sq / (S(2) * variance)));
  }
  for (std::size_t k = 0; k < block_dots; ++k) {
    noise.m[k] = S(sqrt(b.mean_sq[k]));
  }
  return noise;
}

/// Numbers of dots by their true slip.
template <class S>
struct TrueSlips {
  S sticking;  ///< with slip 0
  S per_slip;  ///< dots that slip, per unit of slip around the limit
};

/// The slipping dots are counted between the limit and three times the limit, less those that noise
/// takes there. Half a dot is added: the mean of a rate after no event (Jeffreys' prior), without
/// which a single dot at the limit would be certain.
template <class S>
TrueSlips<S> true_slips(const SpatialPairs<S>& pairs, S limit_sq) {
  using std::sqrt;
  Block<S> within = zeros<S, block_dots>(), beyond = zeros<S, block_dots>();
  for (const PairBlock<S>& b : pairs) {
    const SlipNoise<S> noise = noise_of_slips(b, limit_sq);
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S sq = b.mean_sq[k];
      const S sticks = sq < limit_sq ? b.is_dot[k] : S(0);
      const S near = sq < S(9) * limit_sq ? b.is_dot[k] : S(0);
      within[k] = within[k] + sticks;
      beyond[k] = beyond[k] + (near - sticks) - sticks * noise.false_slip[k];
    }
  }
  const S seen = total(beyond);
  const S slipping = (S(0) < seen ? seen : S(0)) + S(0.5);
  const S sticking = total(within) - slipping / S(2);
  return {S(0) < sticking ? sticking : S(0), slipping / (S(2) * S(sqrt(limit_sq)))};
}

/// How the averaged slips of a block depend on the motion (rotation about the center, shift).
template <class S>
struct MotionEffect {
  std::array<Block<S>, 6> by;  ///< derivatives of the magnitudes
  Block<S> variance;           ///< of the magnitudes, by the covariance of the motion
};

template <class S>
void set_effect_of_motion(const PairBlock<S>& b,
                          const SmallMatrix<S, 6>& covariance,
                          Point3<S> center,
                          const SlipNoise<S>& noise,
                          MotionEffect<S>& of) {
  for (std::size_t k = 0; k < block_dots; ++k) {
    const S mx = b.mean_slip.x[k], my = b.mean_slip.y[k], mz = b.mean_slip.z[k];
    const S m = noise.m[k], scale = S(1) / (m > S(0) ? m : S(1));
    const S u = scale * (b.by_u.x[k] * mx + b.by_u.y[k] * my + b.by_u.z[k] * mz);
    const S v = scale * (b.by_v_x[k] * mx + b.by_v_y[k] * my);
    const S x = u * b.by_u.x[k] + v * b.by_v_x[k];
    const S y = u * b.by_u.y[k] + v * b.by_v_y[k];
    const S z = u * b.by_u.z[k];
    const S qx = b.now.x[k] - center.x, qy = b.now.y[k] - center.y, qz = b.now.z[k] - center.z;
    of.by[0][k] = qy * z - qz * y;
    of.by[1][k] = qz * x - qx * z;
    of.by[2][k] = qx * y - qy * x;
    of.by[3][k] = x;
    of.by[4][k] = y;
    of.by[5][k] = z;
  }
  const auto& c = covariance;
  for (std::size_t k = 0; k < block_dots; ++k) {
    const S a0 = of.by[0][k], a1 = of.by[1][k], a2 = of.by[2][k];
    const S a3 = of.by[3][k], a4 = of.by[4][k], a5 = of.by[5][k];
    const S c0 = c[0][0] * a0;
    const S c1 = c[1][1] * a1 + S(2) * (c[1][0] * a0);
    const S c2 = c[2][2] * a2 + S(2) * (c[2][0] * a0 + c[2][1] * a1);
    const S c3 = c[3][3] * a3 + S(2) * (c[3][0] * a0 + c[3][1] * a1 + c[3][2] * a2);
    const S c4 = c[4][4] * a4 + S(2) * (c[4][0] * a0 + c[4][1] * a1 + c[4][2] * a2 + c[4][3] * a3);
    const S c5 = c[5][5] * a5 +
                 S(2) * (c[5][0] * a0 + c[5][1] * a1 + c[5][2] * a2 + c[5][3] * a3 + c[5][4] * a4);
    of.variance[k] = c0 * a0 + c1 * a1 + c2 * a2 + c3 * a3 + c4 * a4 + c5 * a5;
  }
}

/// Variance of the number of sticking dots. `covariance`: of the fitted motion about `center`.
/// - Own doubt of a dot: the variance p (1 - p) of its answer. If it sticks, p is the probability
///   of a false slip. If it slips, p (1 - p) is averaged over all true slips that noise may have
///   brought to m: 1/6 at the limit, with an area of s / sqrt(pi), as a bell of the variance
///   18 s^2 / pi^2. Neighbours share noise, hence SharedDoubt.
/// - The motion: g^T C g with g the sum over dots of the change of p by the motion. m is uncertain
///   by s, a new answer by s again, and both by the motion. A slip of -limit is at the limit too:
///   a motion that is uncertain by more than the limit takes dots past it on both sides.
template <class S>
S stick_variance(const SpatialPairs<S>& pairs,
                 S limit_sq,
                 const SmallMatrix<S, 6>& covariance,
                 const Point3<S>& center,
                 DotDoubts<S>& doubts) {
  using std::sqrt;
  constexpr double pi = std::numbers::pi;
  const S limit = S(sqrt(limit_sq));
  const TrueSlips<S> slips = true_slips(pairs, limit_sq);
  std::array<Block<S>, 6> changes;
  changes.fill(zeros<S, block_dots>());
  MotionEffect<S> motion;
  Block<S> own, width_sq, density;
  doubts.clear();
  for (const PairBlock<S>& b : pairs) {
    const SlipNoise<S> noise = noise_of_slips(b, limit_sq);
    set_effect_of_motion(b, covariance, center, noise, motion);
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S m = noise.m[k], variance = noise.variance[k], p = noise.false_slip[k];
      const S off_sq = (m - limit) * (m - limit);
      const S width = S(2) * variance + motion.variance[k];
      const S near = slips.sticking * m / variance * falling_exp(S(m * m / (S(2) * variance)));
      const S slides = slips.per_slip / (near + slips.per_slip);
      const S at_limit = falling_exp(S(S(pi * pi / 36) * off_sq / variance)) / S(6);
      own[k] = (S(1) - slides) * p * (S(1) - p) + slides * at_limit;
      const S here = falling_exp(S(off_sq / (S(2) * width)));
      const S opposite = falling_exp(S((m + limit) * (m + limit) / (S(2) * width)));
      density[k] = b.is_dot[k] * slides * (here - opposite);
      width_sq[k] = width;
    }
    for (std::size_t k = 0; k < block_dots; ++k) {
      own[k] = S(sqrt(own[k]));
      density[k] = density[k] / S(sqrt(S(S(2 * pi) * width_sq[k])));
    }
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < block_dots; ++k) {
        changes[i][k] = changes[i][k] + density[k] * motion.by[i][k];
      }
    }
    for (std::size_t k = 0; k < block_dots && b.is_dot[k] > S(0); ++k) {
      doubts.set(b.padded[k], own[k]);
    }
  }
  S common = S(0);
  for (std::size_t i = 0; i < 6; ++i) {
    const S change = total(changes[i]);
    common = common + covariance[i][i] * change * change;
    for (std::size_t j = 0; j < i; ++j) {
      common = common + S(2) * covariance[i][j] * change * total(changes[j]);
    }
  }
  return doubts.variance({6, 2, 1}) + common;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
