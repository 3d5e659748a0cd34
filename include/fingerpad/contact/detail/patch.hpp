// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over the points of a patch. The points are collected in blocks, so that the sums do not
// depend on the image's type and run in vectors. The sums are moved to the patch's centroid, so
// that they keep their digits.
#include <array>
#include <cstddef>
#include <utility>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// a or -a, whichever points toward the object (z >= 0).
template <scalar S>
Point3<S> toward_object(const Point3<S>& a) {
  return value(a.z) < 0 ? -a : a;
}
/// A right-handed frame whose third axis is the unit vector n; u lies in the plane of n and the x
/// axis, or the y axis if n is within 45 degrees of x.
template <scalar S>
struct SurfaceFrame {
  Point3<S> u;
  Point3<S> v;
  Point3<S> n;

  static SurfaceFrame around(const Point3<S>& n) {
    // an axis at 45 degrees or more from n keeps the cross product away from 0
    const bool steep = value(n.x * n.x) > 0.5;
    const Point3<S> along = steep ? Point3<S>{S(0), S(1), S(0)} : Point3<S>{S(1), S(0), S(0)};
    const Point3<S> v = normalized(cross(n, along));
    return {cross(v, n), v, n};
  }
  Point3<S> to_frame(const Point3<S>& p) const { return {dot(u, p), dot(v, p), dot(n, p)}; }
  Point3<S> from_frame(const Point3<S>& p) const { return p.x * u + p.y * v + p.z * n; }
};

/// A block of points, stored coordinate by coordinate.
template <scalar S>
struct PointBlock {
  static constexpr Index capacity = 512;
  S x[capacity];
  S y[capacity];
  S z[capacity];
  Index count = 0;

  void add(const Point3<S>& p) {
    x[count] = p.x;
    y[count] = p.y;
    z[count] = p.z;
    ++count;
  }
  bool full() const { return count == capacity; }
};

/// What one point, or a vector of them, adds to K sums.
template <class V, std::size_t K>
struct Terms {
  V term[K];
};

template <class V, std::size_t K, std::size_t... I>
[[gnu::always_inline]] inline void add_terms(Terms<V, K>& sums,
                                             const Terms<V, K>& terms,
                                             std::index_sequence<I...>) {
  ((sums.term[I] = sums.term[I] + terms.term[I]), ...);
}

/// Adds the terms of the block's points to `sums`. kernel.terms<V>(x, y, z) returns Terms<V, K>,
/// where V is a vector of S, or S itself for the points that do not fill a vector.
template <std::size_t K, scalar S, class Kernel>
void add_block(const PointBlock<S>& block, const Kernel& kernel, std::array<S, K>& sums) {
  constexpr auto order = std::make_index_sequence<K>{};
  constexpr int n = row_lanes<S>;
  Index j = 0;
  if constexpr (n > 1) {
    using V = lanes<S, n>;
    Terms<V, K> total{};
    for (; j + n <= block.count; j += n) {
      add_terms(
          total,
          kernel.template terms<V>(load_cells<V, S>(block.x + j), load_cells<V, S>(block.y + j),
                                   load_cells<V, S>(block.z + j)),
          order);
    }
    for (std::size_t k = 0; k < K; ++k) {
      for (int lane = 0; lane < n; ++lane) {
        sums[k] = sums[k] + total.term[k][lane];
      }
    }
  }
  for (; j < block.count; ++j) {
    const Terms<S, K> one = kernel.template terms<S>(block.x[j], block.y[j], block.z[j]);
    for (std::size_t k = 0; k < K; ++k) {
      sums[k] = sums[k] + one.term[k];
    }
  }
}

/// First and second moments; with Fourth also q x, q y, q z and q^2 of q = x^2 + y^2 + z^2, which
/// is all that a sphere fit needs.
template <scalar S, bool Fourth>
struct MomentKernel {
  static constexpr std::size_t sums = Fourth ? 13 : 9;

  template <class V>
  [[gnu::always_inline]] Terms<V, sums> terms(const V& x, const V& y, const V& z) const {
    const V xx = x * x;
    const V yy = y * y;
    const V zz = z * z;
    const V xy = x * y;
    const V xz = x * z;
    const V yz = y * z;
    if constexpr (Fourth) {
      const V q = xx + yy + zz;
      const V qx = q * x;
      const V qy = q * y;
      const V qz = q * z;
      const V qq = q * q;
      return {{x, y, z, xx, yy, zz, xy, xz, yz, qx, qy, qz, qq}};
    } else {
      return {{x, y, z, xx, yy, zz, xy, xz, yz}};
    }
  }
};

/// Mean moments of a patch about its centroid, along the sensor's axes.
template <scalar S>
struct PatchMoments {
  Index pixels = 0;
  S count = S(0);
  Point3<S> centroid = {S(0), S(0), S(0)};
  SmallMatrix<S, 3> second = zero_matrix<S, 3>();
  Point3<S> third = {S(0), S(0), S(0)};  ///< mean of q (x, y, z)
  S fourth = S(0);                       ///< mean of q^2
};

template <scalar S>
Point3<S> times(const SmallMatrix<S, 3>& a, const Point3<S>& p) {
  return {S(a[0][0] * p.x + a[0][1] * p.y + a[0][2] * p.z),
          S(a[1][0] * p.x + a[1][1] * p.y + a[1][2] * p.z),
          S(a[2][0] * p.x + a[2][1] * p.y + a[2][2] * p.z)};
}

/// Converts sums about `origin` to means about the centroid.
template <scalar S, std::size_t K>
PatchMoments<S> centered(Index pixels, const Point3<S>& origin, std::array<S, K> sums) {
  PatchMoments<S> out;
  out.pixels = pixels;
  out.count = S(static_cast<double>(pixels));
  for (S& sum : sums) {
    sum = sum / out.count;
  }
  const Point3<S> m = {sums[0], sums[1], sums[2]};
  const SmallMatrix<S, 3> raw = {
      {{sums[3], sums[6], sums[7]}, {sums[6], sums[4], sums[8]}, {sums[7], sums[8], sums[5]}}};
  out.centroid = origin + m;
  const std::array<S, 3> mean = {m.x, m.y, m.z};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      out.second[i][j] = raw[i][j] - mean[i] * mean[j];
    }
  }
  if constexpr (K > 9) {
    const Point3<S> t = {sums[9], sums[10], sums[11]};
    const S m_sq = dot(m, m);
    const S trace = raw[0][0] + raw[1][1] + raw[2][2];
    const Point3<S> raw_m = times(raw, m);
    const S shift = S(2) * m_sq - trace;
    out.third = t + S(-2) * raw_m + shift * m;
    out.fourth = sums[12] - S(4) * dot(m, t) + S(4) * dot(m, raw_m) + S(2) * m_sq * trace -
                 S(3) * m_sq * m_sq;
  }
  return out;
}

/// The spread of the pixels in the image, from sums of integers: pixels in one line are detected
/// exactly.
struct PixelSpread {
  double n = 0, i = 0, j = 0, ii = 0, ij = 0, jj = 0;

  /// `count` pixels of row `row`, whose columns sum to j and their squares to jj.
  void add_row(Index row, Index count, Index sum_j, Index sum_jj) {
    const double r = static_cast<double>(row);
    const double c = static_cast<double>(count);
    n += c;
    i += c * r;
    j += static_cast<double>(sum_j);
    ii += c * r * r;
    ij += r * static_cast<double>(sum_j);
    jj += static_cast<double>(sum_jj);
  }
  /// True if the spread across a line is below a thousandth of the spread along it.
  bool is_line() const {
    const double rows = n * ii - i * i;
    const double cols = n * jj - j * j;
    const double both = n * ij - i * j;
    const double trace = rows + cols;
    return !(rows * cols - both * both > 1e-6 * trace * trace);
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
