// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One rigid motion in space of the sticking dots, fitted to the dots that follow it. The loops over
// dots take parameters by value, so that compilers know that writing to a dot does not change them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/math/rotation.hpp"
#include "fingerpad/slip/detail/dot_pairs.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Share of the noise of one dot that remains in its mean with eight neighbours (sum_around).
inline double neighbour_gain() {
  return std::sqrt(36.0 + 4 * 4 + 4 * 1) / 18;
}

/// x, y, z and weight 1 of a slip that counts in the mean of its neighbours; all 0 for one that
/// does not. Also sums of these.
template <class S>
using SmallSlip = std::array<S, 4>;

/// The weighted sum of a slip (6), its side neighbours (2) and its diagonal neighbours (1), in a
/// grid of `across` columns.
template <class S>
SmallSlip<S> sum_around(const SmallSlip<S>* slips, Index across) {
  const SmallSlip<S>* const above = slips - across;
  const SmallSlip<S>* const below = slips + across;
  SmallSlip<S> sum;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const S beside = above[0][i] + slips[-1][i] + slips[1][i] + below[0][i];
    const S diagonal = above[-1][i] + above[1][i] + below[-1][i] + below[1][i];
    sum[i] = S(6) * slips[0][i] + S(2) * beside + diagonal;
  }
  return sum;
}

template <class S>
struct AxisNoise {
  S lateral_info;  ///< 1 / variance
  S depth_info;
};

/// Computes by_u and by_v for the axes of the surface at each dot: u up its slope and v level. The
/// noise along these axes is independent. With w = axis / variances, by = w / sqrt(axis . w), for
/// any length of the axis.
template <class S>
void set_surface(AxisNoise<S> noise, SpatialPairs<S>& pairs) {
  using std::sqrt;
  const Quadric<S> surface = quadric_through(pairs);
  const S lateral_by = S(sqrt(noise.lateral_info));
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const Point2<S> slope = surface.slope(b.now[k]);
      const S sq = squared_norm(slope);
      const bool inclined = sq > S(0);
      const S steepness = S(sqrt(inclined ? sq : S(1)));
      const S up_x = inclined ? S(slope.x / steepness) : S(1);
      const S up_y = inclined ? S(slope.y / steepness) : S(0);
      const S by = S(1) / S(sqrt(S(noise.lateral_info + noise.depth_info * sq)));
      b.by_u.x[k] = noise.lateral_info * by * up_x;
      b.by_u.y[k] = noise.lateral_info * by * up_y;
      b.by_u.z[k] = inclined ? S(noise.depth_info * by * steepness) : S(0);
      b.by_v_x[k] = S(-lateral_by * up_y);
      b.by_v_y[k] = lateral_by * up_x;
    }
  }
}

/// Gaussian weights around a place with a standard deviation of 4/3 pitches; equal weights without
/// a pitch.
template <class S>
void weigh_around(Point3<S> middle, const S& pitch_sq, SpatialPairs<S>& pairs) {
  const S scale = S(0) < pitch_sq ? S(S(9.0 / 32) / pitch_sq) : S(0);
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      b.weight[k] = b.is_dot[k] * falling_exp(S(scale * squared_norm(b.now[k] - middle)));
    }
  }
}

/// The slip of each dot relative to a motion, by generalised least squares. The part of the
/// residual along the normal is noise. Depth, which is less certain, counts only where the surface
/// is inclined.
template <class S>
void set_slips(Pose<S> motion, SpatialPairs<S>& pairs) {
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const Point3<S> residual = b.now[k] - motion(b.then[k]);
      b.residual.set(k, residual);
      const S u = dot(b.by_u[k], residual);
      const S v = b.by_v_x[k] * residual.x + b.by_v_y[k] * residual.y;
      b.slip_u[k] = u;
      b.slip_v[k] = v;
      b.slip_sq[k] = u * u + v * v;
    }
  }
}

/// Sets weight 1 for the dots whose slip is within the limit, else 0. Returns their number.
template <class S>
S weigh_followers(S limit_sq, SpatialPairs<S>& pairs) {
  Block<S> followers = zeros<S, block_dots>();
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S weight = (b.slip_sq[k] < limit_sq ? S(1) : S(0)) * b.is_dot[k];
      b.weight[k] = weight;
      followers[k] = followers[k] + weight;
    }
  }
  return total(followers);
}

/// Gaussian weights whose standard deviation is the slip of rank `rank`, from the smallest.
/// `sorted` is working memory.
template <class S>
void weigh_nearest(Index rank, std::vector<S>& sorted, SpatialPairs<S>& pairs) {
  using std::exp;
  std::size_t count = 0;
  pairs.for_each([&](const PairBlock<S>& b, std::size_t k) { sorted[count++] = b.slip_sq[k]; });
  const auto middle = sorted.begin() + rank;
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<Index>(count));
  const S width = *middle > S(0) ? *middle : S(1);
  pairs.for_each([&](PairBlock<S>& b, std::size_t k) {
    const S ratio = b.slip_sq[k] / width;
    b.weight[k] = ratio < S(100) ? S(exp(S(ratio / S(-2)))) : S(0);
  });
}

/// Weights that fall with the averaged slip: 1/4 where its square is `quarter_sq`.
template <class S>
void weigh_by_mean(S quarter_sq, SpatialPairs<S>& pairs) {
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S ratio = quarter_sq / (quarter_sq + b.mean_sq[k]);
      b.weight[k] = b.is_dot[k] * ratio * ratio;
    }
  }
}

/// Averages slips over neighbours. Slips beyond the gate do not count, and stay as they are.
/// `room`: a grid of `across` columns with a border of one cell; cells without a pair must be 0.
template <class S>
void average_slips(S gate_sq,
                   AxisNoise<S> noise,
                   Index across,
                   std::vector<SmallSlip<S>>& room,
                   SpatialPairs<S>& pairs) {
  const S lateral = S(1) / noise.lateral_info, deep = S(1) / noise.depth_info;
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S u = b.slip_u[k], v = b.slip_v[k];
      b.mean_slip.x[k] = lateral * (u * b.by_u.x[k] + v * b.by_v_x[k]);
      b.mean_slip.y[k] = lateral * (u * b.by_u.y[k] + v * b.by_v_y[k]);
      b.mean_slip.z[k] = deep * u * b.by_u.z[k];
      b.counts[k] = (b.slip_sq[k] < gate_sq ? S(1) : S(0)) * b.is_dot[k];
    }
  }
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S c = b.counts[k];
      room[b.padded[k]] = {S(c * b.mean_slip.x[k]), S(c * b.mean_slip.y[k]),
                           S(c * b.mean_slip.z[k]), c};
    }
  }
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const SmallSlip<S> sum = sum_around(&room[b.padded[k]], across);
      if (b.counts[k] > S(0)) {
        const S share = S(1) / sum[3];
        b.mean_slip.set(k, {S(share * sum[0]), S(share * sum[1]), S(share * sum[2])});
      }
    }
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S x = b.mean_slip.x[k], y = b.mean_slip.y[k], z = b.mean_slip.z[k];
      const S u = b.by_u.x[k] * x + b.by_u.y[k] * y + b.by_u.z[k] * z;
      const S v = b.by_v_x[k] * x + b.by_v_y[k] * y;
      b.mean_sq[k] = u * u + v * v;
    }
  }
}

/// Sets the total weights of the averages that average_slips() made in `room`. A function of its
/// own because only the last averages need them.
template <class S>
void set_total_weights(const std::vector<SmallSlip<S>>& room,
                       Index across,
                       SpatialPairs<S>& pairs) {
  for (PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const SmallSlip<S>* const row = &room[b.padded[k]];
      const SmallSlip<S>*const above = row - across, *const below = row + across;
      const S beside = above[0][3] + row[-1][3] + row[1][3] + below[0][3];
      const S diagonal = above[-1][3] + above[1][3] + below[-1][3] + below[1][3];
      b.total_weight[k] = b.counts[k] > S(0) ? S(S(6) + S(2) * beside + diagonal) : S(6);
    }
  }
}

/// Weighted sums over pairs, of their positions q and residuals r.
template <class T>
struct PairMoments {
  T weight, x, y, z, xx, yy, zz, xy, xz, yz;
  T rx, ry, rz, turn_z;  ///< the last of q x r
  T yrz, xrz, zry, zrx;
};

template <class S>
PairMoments<S> moments_of(const SpatialPairs<S>& pairs, Point3<S> center) {
  const Block<S> none = zeros<S, block_dots>();
  PairMoments<Block<S>> sum = {none, none, none, none, none, none, none, none, none,
                               none, none, none, none, none, none, none, none, none};
  for (const PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S w = b.weight[k];
      const S rx = b.residual.x[k], ry = b.residual.y[k], rz = b.residual.z[k];
      const S x = b.now.x[k] - rx - center.x, y = b.now.y[k] - ry - center.y;
      const S z = b.now.z[k] - rz - center.z;
      const S wx = w * x, wy = w * y, wz = w * z;
      sum.weight[k] = sum.weight[k] + w;
      sum.x[k] = sum.x[k] + wx;
      sum.y[k] = sum.y[k] + wy;
      sum.z[k] = sum.z[k] + wz;
      sum.xx[k] = sum.xx[k] + wx * x;
      sum.yy[k] = sum.yy[k] + wy * y;
      sum.zz[k] = sum.zz[k] + wz * z;
      sum.xy[k] = sum.xy[k] + wx * y;
      sum.xz[k] = sum.xz[k] + wx * z;
      sum.yz[k] = sum.yz[k] + wy * z;
      sum.rx[k] = sum.rx[k] + w * rx;
      sum.ry[k] = sum.ry[k] + w * ry;
      sum.rz[k] = sum.rz[k] + w * rz;
      sum.turn_z[k] = sum.turn_z[k] + (wx * ry - wy * rx);
      sum.yrz[k] = sum.yrz[k] + wy * rz;
      sum.xrz[k] = sum.xrz[k] + wx * rz;
      sum.zry[k] = sum.zry[k] + wz * ry;
      sum.zrx[k] = sum.zrx[k] + wz * rx;
    }
  }
  return {total(sum.weight), total(sum.x),   total(sum.y),  total(sum.z),      total(sum.xx),
          total(sum.yy),     total(sum.zz),  total(sum.xy), total(sum.xz),     total(sum.yz),
          total(sum.rx),     total(sum.ry),  total(sum.rz), total(sum.turn_z), total(sum.yrz),
          total(sum.xrz),    total(sum.zry), total(sum.zrx)};
}

/// One Gauss-Newton step toward the rigid motion that fits the weighted pairs best, from the motion
/// of their residuals. Returns its normal equations, which are not good if the pairs do not
/// determine it. `center`: any position among them.
template <class S>
NormalEquations<S, 6> refine_motion(const SpatialPairs<S>& pairs,
                                    const AxisNoise<S>& noise,
                                    const Point3<S>& center,
                                    Pose<S>& motion) {
  const PairMoments<S> m = moments_of(pairs, center);
  // rows: x: (0, qz, -qy | 1 0 0), y: (-qz, 0, qx | 0 1 0), z: (qy, -qx, 0 | 0 0 1)
  const S l = noise.lateral_info, d = noise.depth_info, o = S(0);
  const SmallMatrix<S, 6> a = {{{S(l * m.zz + d * m.yy), o, o, o, o, o},
                                {S(-d * m.xy), S(l * m.zz + d * m.xx), o, o, o, o},
                                {S(-l * m.xz), S(-l * m.yz), S(l * (m.xx + m.yy)), o, o, o},
                                {o, S(l * m.z), S(-l * m.y), S(l * m.weight), o, o},
                                {S(-l * m.z), o, S(l * m.x), o, S(l * m.weight), o},
                                {S(d * m.y), S(-d * m.x), o, o, o, S(d * m.weight)}}};
  const std::array<S, 6> b = {S(d * m.yrz - l * m.zry),
                              S(l * m.zrx - d * m.xrz),
                              S(l * m.turn_z),
                              S(l * m.rx),
                              S(l * m.ry),
                              S(d * m.rz)};
  const NormalEquations<S, 6> normal(a, 1e-6);
  if (!normal.good) {
    return normal;
  }
  const auto x = normal.solve(b);
  // the rotation of the quaternion (1, w / 2); its error is of third order in w
  const S hx = x[0] / S(2), hy = x[1] / S(2), hz = x[2] / S(2);
  const S n = S(1) + hx * hx + hy * hy + hz * hz, two = S(2) / n;
  const Rotation<S> turn = {
      {{S(S(1) - two * (hy * hy + hz * hz)), S(two * (hx * hy - hz)), S(two * (hx * hz + hy))},
       {S(two * (hx * hy + hz)), S(S(1) - two * (hx * hx + hz * hz)), S(two * (hy * hz - hx))},
       {S(two * (hx * hz - hy)), S(two * (hy * hz + hx)), S(S(1) - two * (hx * hx + hy * hy))}}};
  const Pose<S> step = {turn, center + Point3<S>{x[3], x[4], x[5]} - turn(center)};
  motion = step * motion;
  return normal;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
