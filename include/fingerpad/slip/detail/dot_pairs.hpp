// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The dots found in both of two frames, in blocks, and fits to their positions.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/slip/detail/dot_surface.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Number of dots in a block. Compilers vectorise loops of fixed length over arrays, and sums kept
/// for each place of a block have a fixed order.
inline constexpr std::size_t block_dots = 8;

template <class S>
using Block = std::array<S, block_dots>;

template <class S>
S total(const Block<S>& b) {
  return S(S(b[0] + b[4]) + S(b[2] + b[6])) + S(S(b[1] + b[5]) + S(b[3] + b[7]));
}

/// exp(-x) of x >= 0, approximated by (1 + x / 4096)^-4096, which needs no calls and vectorises.
/// Too large by a share of x^2 / 8192.
template <class S>
S falling_exp(const S& x) {
  S power = S(1) / (S(1) + S(1.0 / 4096) * x);
  for (int doubling = 0; doubling < 12; ++doubling) {
    power = power * power;
  }
  return power;
}

template <class S>
struct PointBlock {
  Block<S> x, y, z;

  Point3<S> operator[](std::size_t k) const { return {x[k], y[k], z[k]}; }
  void set(std::size_t k, const Point3<S>& p) {
    x[k] = p.x;
    y[k] = p.y;
    z[k] = p.z;
  }
  void fill(const Point3<S>& p) {
    x.fill(p.x);
    y.fill(p.y);
    z.fill(p.z);
  }
};

/// Dots of two frames, and the surface at their present positions.
template <class S>
struct PairBlock {
  Block<Index> cell;
  Block<std::size_t> padded;  ///< the cell in a grid with a border of one
  Block<S> is_dot;            ///< 1; 0 for unused places of the last block
  PointBlock<S> then, now;
  PointBlock<S> by_u;       ///< factor of a residual that gives its slip up the slope
  Block<S> by_v_x, by_v_y;  ///< factor that gives its level slip
  Block<S> weight;          ///< in the fit of the motion
  PointBlock<S> residual;   ///< now - motion(then)
  Block<S> slip_u, slip_v;  ///< in standard deviations of one position
  Block<S> slip_sq;
  Block<S> counts;          ///< 1: counts in the mean of its neighbours; 0: slips too much
  PointBlock<S> mean_slip;  ///< averaged over neighbours
  Block<S> mean_sq;         ///< in variances of one position
  Block<S> total_weight;    ///< of the slips in that average
};

/// The dots found in both of two frames, in blocks.
template <class S>
class SpatialPairs {
 public:
  explicit SpatialPairs(std::size_t most = 0)
      : blocks_((most + block_dots - 1) / block_dots, PairBlock<S>{}) {}

  void clear() { size_ = 0; }
  Index size() const { return static_cast<Index>(size_); }
  /// Adds a dot. `spare` is a padded place without a dot, for the unused places of a block.
  void add(Index cell,
           std::size_t padded,
           std::size_t spare,
           const Point3<S>& then,
           const Point3<S>& now) {
    PairBlock<S>& b = blocks_[size_ / block_dots];
    const std::size_t k = size_ % block_dots;
    if (k == 0) {
      b.is_dot.fill(S(0));
      b.padded.fill(spare);
      b.then.fill(then);
      b.now.fill(now);
    }
    b.cell[k] = cell;
    b.padded[k] = padded;
    b.is_dot[k] = S(1);
    b.then.set(k, then);
    b.now.set(k, now);
    ++size_;
  }

  /// Calls visit(block, k) for each dot.
  template <class Visit>
  void for_each(const Visit& visit) {
    for (std::size_t i = 0; i < size_; ++i) {
      visit(blocks_[i / block_dots], i % block_dots);
    }
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < size_; ++i) {
      visit(blocks_[i / block_dots], i % block_dots);
    }
  }
  PairBlock<S>* begin() { return blocks_.data(); }
  PairBlock<S>* end() { return blocks_.data() + (size_ + block_dots - 1) / block_dots; }
  const PairBlock<S>* begin() const { return blocks_.data(); }
  const PairBlock<S>* end() const { return blocks_.data() + (size_ + block_dots - 1) / block_dots; }

 private:
  std::vector<PairBlock<S>> blocks_;
  std::size_t size_ = 0;
};

template <class S>
Point3<S> middle_of(const SpatialPairs<S>& pairs) {
  PointBlock<S> sum;
  sum.fill({S(0), S(0), S(0)});
  for (const PairBlock<S>& b : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      sum.set(k, sum[k] + b.is_dot[k] * b.now[k]);
    }
  }
  return Point3<S>{total(sum.x), total(sum.y), total(sum.z)} / S(static_cast<double>(pairs.size()));
}

/// The surface through the present positions of the dots.
template <class S>
Quadric<S> quadric_through(const SpatialPairs<S>& pairs) {
  const Point3<S> middle = middle_of(pairs);
  const Block<S> none = zeros<S, block_dots>();
  Block<S> xx = none, xy = none, yy = none, xxx = none, xxy = none, xyy = none, yyy = none;
  Block<S> xxxx = none, xxxy = none, xxyy = none, xyyy = none, yyyy = none;
  Block<S> xz = none, yz = none, xxz = none, xyz = none, yyz = none;
  for (const PairBlock<S>& p : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S x = p.is_dot[k] * (p.now.x[k] - middle.x), y = p.is_dot[k] * (p.now.y[k] - middle.y);
      const S z = p.now.z[k] - middle.z, x2 = x * x, xy1 = x * y, y2 = y * y;
      xx[k] = xx[k] + x2;
      xy[k] = xy[k] + xy1;
      yy[k] = yy[k] + y2;
      xxx[k] = xxx[k] + x2 * x;
      xxy[k] = xxy[k] + x2 * y;
      xyy[k] = xyy[k] + x * y2;
      yyy[k] = yyy[k] + y2 * y;
      xxxx[k] = xxxx[k] + x2 * x2;
      xxxy[k] = xxxy[k] + x2 * xy1;
      xxyy[k] = xxyy[k] + x2 * y2;
      xyyy[k] = xyyy[k] + xy1 * y2;
      yyyy[k] = yyyy[k] + y2 * y2;
      xz[k] = xz[k] + x * z;
      yz[k] = yz[k] + y * z;
      xxz[k] = xxz[k] + x2 * z;
      xyz[k] = xyz[k] + xy1 * z;
      yyz[k] = yyz[k] + y2 * z;
    }
  }
  const S o = S(0), n = S(static_cast<double>(pairs.size()));
  const S sxx = total(xx), sxy = total(xy), syy = total(yy), sxxy = total(xxy), sxyy = total(xyy);
  const S sxxyy = total(xxyy);
  const SmallMatrix<S, 6> a = {{{n, o, o, o, o, o},  // x, y and z are relative to their means
                                {o, sxx, o, o, o, o},
                                {o, sxy, syy, o, o, o},
                                {sxx, total(xxx), sxxy, total(xxxx), o, o},
                                {sxy, sxxy, sxyy, total(xxxy), sxxyy, o},
                                {syy, sxyy, total(yyy), sxxyy, total(xyyy), total(yyyy)}}};
  const std::array<S, 6> b = {o, total(xz), total(yz), total(xxz), total(xyz), total(yyz)};
  Quadric<S> q = quadric_of(a, b);
  q.middle = middle;
  q.dots = pairs.size();
  return q;
}

/// d_max^2: the largest squared displacement of a dot; -1 without dots. Its depth component is that
/// of the plane through the depth displacements of all dots, which holds for a rigid motion,
/// because the depth of a single dot is too noisy.
template <class S>
S furthest_rigid_sq(const SpatialPairs<S>& pairs) {
  if (pairs.size() == 0) {
    return S(-1);
  }
  const Point3<S> middle = middle_of(pairs);
  const Block<S> none = zeros<S, block_dots>();
  Block<S> xx = none, xy = none, yy = none, z = none, xz = none, yz = none;
  for (const PairBlock<S>& p : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S x = p.is_dot[k] * (p.now.x[k] - middle.x), y = p.is_dot[k] * (p.now.y[k] - middle.y);
      const S deeper = p.is_dot[k] * (p.now.z[k] - p.then.z[k]);
      xx[k] = xx[k] + x * x;
      xy[k] = xy[k] + x * y;
      yy[k] = yy[k] + y * y;
      z[k] = z[k] + deeper;
      xz[k] = xz[k] + x * deeper;
      yz[k] = yz[k] + y * deeper;
    }
  }
  const S o = S(0), count = S(static_cast<double>(pairs.size()));
  const SmallMatrix<S, 3> a = {{{count, o, o},  // x and y are relative to their means
                                {o, total(xx), o},
                                {o, total(xy), total(yy)}}};
  const NormalEquations<S, 3> plane(a, 1e-6);
  const std::array<S, 3> level = {S(total(z) / count), o, o};
  const std::array<S, 3> c = plane.good ? plane.solve({total(z), total(xz), total(yz)}) : level;
  Block<S> furthest = none;
  for (const PairBlock<S>& p : pairs) {
    for (std::size_t k = 0; k < block_dots; ++k) {
      const S dx = p.now.x[k] - p.then.x[k], dy = p.now.y[k] - p.then.y[k];
      const S dz = c[0] + c[1] * (p.now.x[k] - middle.x) + c[2] * (p.now.y[k] - middle.y);
      const S sq = p.is_dot[k] * (dx * dx + dy * dy + dz * dz);
      furthest[k] = furthest[k] < sq ? sq : furthest[k];
    }
  }
  return *std::max_element(furthest.begin(), furthest.end());
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
