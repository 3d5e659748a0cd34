// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One rigid motion in space of the dots that stick, fitted to those that follow it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/math/detail/zeros.hpp"
#include "fingerpad/math/rotation.hpp"
#include "fingerpad/slip/detail/dot_frames.hpp"
#include "fingerpad/slip/detail/dot_surface.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// One dot of two frames, and the surface where it is now.
template <class S>
struct SpatialPair {
  Index cell = 0;
  std::size_t padded = 0;  ///< the cell in a grid with a border of one
  Point3<S> then = {S(0), S(0), S(0)};
  Point3<S> now = {S(0), S(0), S(0)};
  Point3<S> by_u, by_v;  ///< what a residual is multiplied by for its slip up the slope and level
  Point3<S> u, v;        ///< the axes, of the length of one standard deviation of a position
  S weight = S(0);       ///< in the fit of the motion
  Point3<S> carried = {S(0), S(0), S(0)};   ///< from `then` by the motion
  Point3<S> residual = {S(0), S(0), S(0)};  ///< now less carried
  S slip_u = S(0), slip_v = S(0);           ///< in standard deviations of one position
  S slip_sq = S(0);
  Point3<S> mean_slip = {S(0), S(0), S(0)};  ///< averaged over neighbours
  S mean_sq = S(0);                          ///< in variances of one position

  Point3<S> slip() const { return slip_u * u + slip_v * v; }
};

/// Of the noise of one dot, what the mean of it and its eight neighbours leaves (mean_around).
inline double neighbour_gain() {
  return std::sqrt(36.0 + 4 * 4 + 4 * 1) / 18;
}

/// A slip that counts in the mean of its neighbours', weight 1; or none, 0. And sums of these.
template <class S>
struct SmallSlip {
  Point3<S> slip = {S(0), S(0), S(0)};
  S weight = S(0);

  friend SmallSlip operator+(const SmallSlip& a, const SmallSlip& b) {
    return {a.slip + b.slip, S(a.weight + b.weight)};
  }
  friend SmallSlip operator*(const S& factor, const SmallSlip& a) {
    return {factor * a.slip, S(factor * a.weight)};
  }
};

/// The mean of a slip, which counts, and its eight neighbours, in a grid of `across` columns. It
/// has weight 6, those beside it 2, those across 1.
template <class S>
Point3<S> mean_around(const SmallSlip<S>* slips, Index across) {
  const SmallSlip<S> beside = slips[-across] + slips[-1] + slips[1] + slips[across];
  const SmallSlip<S> diagonal =
      slips[-across - 1] + slips[1 - across] + slips[across - 1] + slips[across + 1];
  const SmallSlip<S> sum = S(6) * *slips + S(2) * beside + diagonal;
  return S(S(1) / sum.weight) * sum.slip;
}

template <class S>
struct AxisNoise {
  S lateral_sd;
  S lateral_info;  ///< 1 / variance
  S depth_info;
};

/// The axes of a surface with this slope, u up it and v level: along these the noise of the axes is
/// independent. For a vector w = axis / variances, by = w / sqrt(axis w), whatever the axis'
/// length.
template <class S>
void set_axes(const AxisNoise<S>& noise, const Point2<S>& slope, SpatialPair<S>& p) {
  using std::sqrt;
  const S sq = squared_norm(slope);
  const S steepness = sq > S(0) ? S(sqrt(sq)) : S(0);
  const S inverse = steepness > S(0) ? S(S(1) / steepness) : S(0);
  const Point2<S> up = steepness > S(0) ? Point2<S>{S(inverse * slope.x), S(inverse * slope.y)}
                                        : Point2<S>{S(1), S(0)};
  const S sd_u = S(1) / S(sqrt(S(noise.lateral_info + noise.depth_info * sq)));
  p.u = {S(sd_u * up.x), S(sd_u * up.y), S(sd_u * steepness)};
  p.by_u = {S(noise.lateral_info * p.u.x), S(noise.lateral_info * p.u.y),
            S(noise.depth_info * p.u.z)};
  p.v = {S(-noise.lateral_sd * up.y), S(noise.lateral_sd * up.x), S(0)};
  p.by_v = noise.lateral_info * p.v;
}

/// Gives each pair the surface at its dot.
template <class S>
void set_surface(const AxisNoise<S>& noise, std::vector<SpatialPair<S>>& pairs) {
  const auto surface = quadric_through<S>([&](const auto& visit) {
    for (const SpatialPair<S>& p : pairs) {
      visit(p.now);
    }
  });
  for (SpatialPair<S>& p : pairs) {
    set_axes(noise, surface.slope(p.now), p);
  }
}

/// The slip of a dot against a motion, by generalised least squares: what of its residual lies
/// along the normal is noise, and depth, which is known worse, counts only where the surface is
/// inclined.
template <class S>
void set_slip(const Pose<S>& motion, SpatialPair<S>& p) {
  p.carried = motion(p.then);
  p.residual = p.now - p.carried;
  p.slip_u = dot(p.by_u, p.residual);
  p.slip_v = dot(p.by_v, p.residual);
  p.slip_sq = p.slip_u * p.slip_u + p.slip_v * p.slip_v;
}

/// The square of a slip at a dot, in variances of one position.
template <class S>
S in_variances(const Point3<S>& slip, const SpatialPair<S>& p) {
  const S u = dot(p.by_u, slip), v = dot(p.by_v, slip);
  return u * u + v * v;
}

template <class S>
Point3<S> middle_of(const std::vector<SpatialPair<S>>& pairs) {
  Point3<S> sum = {S(0), S(0), S(0)};
  for (const SpatialPair<S>& p : pairs) {
    sum += p.now;
  }
  return sum / S(static_cast<double>(pairs.size()));
}

/// Weights of a bell 4/3 pitches wide around a place; all alike where there is no pitch.
template <class S>
void weigh_around(const Point3<S>& from, const S& pitch_sq, std::vector<SpatialPair<S>>& pairs) {
  using std::exp;
  for (SpatialPair<S>& p : pairs) {
    const S d = S(0) < pitch_sq ? S(squared_norm(p.now - from) / pitch_sq) : S(0);
    p.weight = d < S(100) ? S(exp(S(S(-9.0 / 32) * d))) : S(0);
  }
}

template <class S>
void set_slips(const Pose<S>& motion, std::vector<SpatialPair<S>>& pairs) {
  for (SpatialPair<S>& p : pairs) {
    set_slip(motion, p);
  }
}

/// Weight 1 for the dots whose slip is within the limit; how many they are.
template <class S>
Index weigh_followers(const S& limit, std::vector<SpatialPair<S>>& pairs) {
  Index followers = 0;
  for (SpatialPair<S>& p : pairs) {
    const bool follows = p.slip_sq < limit;
    p.weight = S(follows ? 1 : 0);
    followers += follows ? 1 : 0;
  }
  return followers;
}

/// Weights of a bell as wide as the slip of the dot that is `rank` from the least; `sorted` is room
/// to work in.
template <class S>
void weigh_nearest(Index rank, std::vector<S>& sorted, std::vector<SpatialPair<S>>& pairs) {
  using std::exp;
  std::size_t count = 0;
  for (const SpatialPair<S>& p : pairs) {
    sorted[count++] = p.slip_sq;
  }
  const auto middle = sorted.begin() + rank;
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<Index>(count));
  const S width = *middle > S(0) ? *middle : S(1);
  for (SpatialPair<S>& p : pairs) {
    const S ratio = p.slip_sq / width;
    p.weight = ratio < S(100) ? S(exp(S(ratio / S(-2)))) : S(0);
  }
}

/// d_max^2: the largest displacement of a dot that both frames have, -1 if there is none. Its depth
/// is that of the plane through the depth displacements of all, which a rigid motion follows: one
/// dot's depth is known too badly.
template <class S>
S furthest_rigid_sq(const std::vector<Index>& touching,
                    const Point3<S>* now,
                    const Point3<S>* then) {
  S count = S(0);
  Point3<S> middle = {S(0), S(0), S(0)};
  for (const Index k : touching) {
    if (is_finite(then[k]) && is_finite(now[k])) {
      middle += now[k];
      count = count + S(1);
    }
  }
  if (!(count > S(0))) {
    return S(-1);
  }
  middle = middle / count;
  SmallMatrix<S, 3> a = zero_matrix<S, 3>();
  std::array<S, 3> b = detail::zeros<S, 3>();
  for (const Index k : touching) {
    const S x = now[k].x - middle.x, y = now[k].y - middle.y, z = now[k].z - then[k].z;
    if (is_finite(z)) {
      a[1][1] = a[1][1] + x * x;
      a[2][1] = a[2][1] + x * y;
      a[2][2] = a[2][2] + y * y;
      b = {S(b[0] + z), S(b[1] + x * z), S(b[2] + y * z)};
    }
  }
  a[0][0] = count;  // x and y are counted from their middles
  const NormalEquations<S, 3> plane(a, 1e-6);
  const std::array<S, 3> c =
      plane.good ? plane.solve(b) : std::array<S, 3>{S(b[0] / count), S(0), S(0)};
  S furthest = S(-1);
  for (const Index k : touching) {
    const Point3<S> d = now[k] - then[k];
    const S z = c[0] + c[1] * (now[k].x - middle.x) + c[2] * (now[k].y - middle.y);
    const S sq = d.x * d.x + d.y * d.y + z * z;
    furthest = furthest < sq ? sq : furthest;
  }
  return furthest;
}

/// Weighted sums over pairs, of their places q and residuals r.
template <class S>
struct PairMoments {
  S weight = S(0), xx = S(0), yy = S(0), zz = S(0), xy = S(0), xz = S(0), yz = S(0);
  Point3<S> q = {S(0), S(0), S(0)}, r = {S(0), S(0), S(0)};
  S turn_z = S(0);  ///< of q x r
  S yrz = S(0), xrz = S(0), zry = S(0), zrx = S(0);

  void add(const S& w, const Point3<S>& place, const Point3<S>& residual) {
    const Point3<S> m = w * place;
    weight = weight + w;
    q += m;
    r += w * residual;
    xx = xx + m.x * place.x;
    yy = yy + m.y * place.y;
    zz = zz + m.z * place.z;
    xy = xy + m.x * place.y;
    xz = xz + m.x * place.z;
    yz = yz + m.y * place.z;
    turn_z = turn_z + (m.x * residual.y - m.y * residual.x);
    yrz = yrz + m.y * residual.z;
    xrz = xrz + m.x * residual.z;
    zry = zry + m.z * residual.y;
    zrx = zrx + m.z * residual.x;
  }
};

/// One step of Gauss and Newton, from where the pairs are `carried`, toward the rigid motion that
/// fits the weighted pairs best; false where they do not determine it. `center`: any place among
/// them.
template <class S>
bool refine_motion(const std::vector<SpatialPair<S>>& pairs,
                   const AxisNoise<S>& noise,
                   const Point3<S>& center,
                   Pose<S>& motion) {
  PairMoments<S> m;
  for (const SpatialPair<S>& p : pairs) {
    if (p.weight > S(0)) {
      m.add(p.weight, p.carried - center, p.residual);
    }
  }
  // rows: x: (0, qz, -qy | 1 0 0), y: (-qz, 0, qx | 0 1 0), z: (qy, -qx, 0 | 0 0 1)
  const S l = noise.lateral_info, d = noise.depth_info, o = S(0);
  const SmallMatrix<S, 6> a = {{{S(l * m.zz + d * m.yy), o, o, o, o, o},
                                {S(-d * m.xy), S(l * m.zz + d * m.xx), o, o, o, o},
                                {S(-l * m.xz), S(-l * m.yz), S(l * (m.xx + m.yy)), o, o, o},
                                {o, S(l * m.q.z), S(-l * m.q.y), S(l * m.weight), o, o},
                                {S(-l * m.q.z), o, S(l * m.q.x), o, S(l * m.weight), o},
                                {S(d * m.q.y), S(-d * m.q.x), o, o, o, S(d * m.weight)}}};
  const std::array<S, 6> b = {S(d * m.yrz - l * m.zry),
                              S(l * m.zrx - d * m.xrz),
                              S(l * m.turn_z),
                              S(l * m.r.x),
                              S(l * m.r.y),
                              S(d * m.r.z)};
  const NormalEquations<S, 6> normal(a, 1e-6);
  if (!normal.good) {
    return false;
  }
  const auto x = normal.solve(b);
  // the rotation of a quaternion (1, w / 2): right to the third order of w
  const S hx = x[0] / S(2), hy = x[1] / S(2), hz = x[2] / S(2);
  const S n = S(1) + hx * hx + hy * hy + hz * hz, two = S(2) / n;
  const Rotation<S> turn = {
      {{S(S(1) - two * (hy * hy + hz * hz)), S(two * (hx * hy - hz)), S(two * (hx * hz + hy))},
       {S(two * (hx * hy + hz)), S(S(1) - two * (hx * hx + hz * hz)), S(two * (hy * hz - hx))},
       {S(two * (hx * hz - hy)), S(two * (hy * hz + hx)), S(S(1) - two * (hx * hx + hy * hy))}}};
  const Pose<S> step = {turn, center + Point3<S>{x[3], x[4], x[5]} - turn(center)};
  motion = step * motion;
  return true;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
