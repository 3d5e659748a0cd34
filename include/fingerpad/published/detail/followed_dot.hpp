// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact reference dot, followed with its neighbours from frame to frame.
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fingerpad/math/rigid_fit.hpp"
#include "fingerpad/motion/detail/dot_frame.hpp"
#include "fingerpad/motion/motion_result.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::motion {

// Rotation of a dot with its eight neighbours between two frames k and l. Source: Ito, Kim, Nagai,
// Obinata 2011, eqs. 14-18. As printed, eq. 17 stacks the basis vectors as rows and is solved by
// [n2, n2, n3]^-T. The first vector must be n1 (E021), and with rows the result is the rotation
// seen from the rotated frame, transposed (E022). With columns:
//   N = [n1 n2 n3],  n1 = q1/|q1|,  n2 = q2/|q2|,  n3 = n1 x n2,   R = N_l N_k^-1
// In a sheared neighbourhood n1 and n2 are not orthogonal, and R is not a rotation (E023).

// The two directions from which the papers measure the rotation of a dot with its eight neighbours.
// Source: Ito, Kim, Nagai, Obinata 2011, eqs. 14 and 15:
//   q1 = sum over k of p(I+1, J+k) - p(I-1, J+k)     along the columns of the grid
//   q2 = sum over k of p(I+k, J+1) - p(I+k, J-1)     along its rows
// (I-th from the left, J-th from the top). These are the slopes of the affine map from the grid to
// space that fits the nine dots best. If dots are missing, the slopes of the map that fits the
// remaining ones are used instead.

/// Nine points of the grid, row by row, the middle one at index 4; NaN or inf: missing.
template <scalar S = double>
struct Neighbourhood {
  std::array<Point3<S>, 9> dot;
  std::array<bool, 9> found = {};
};

/// Which dots of two neighbourhoods are found in both.
struct CommonDots {
  std::array<bool, 9> found = {};
  Index count = 0;
};

template <scalar S>
CommonDots common_dots(const Neighbourhood<S>& a, const Neighbourhood<S>& b) {
  CommonDots common;
  for (std::size_t k = 0; k < 9; ++k) {
    common.found[k] = a.found[k] && b.found[k];
    common.count += common.found[k] ? 1 : 0;
  }
  return common;
}

/// q1 and q2 up to a common positive factor. Both are 0 if the dots lie on one line of the grid.
template <scalar S>
struct GridDirections {
  Point3<S> q1;
  Point3<S> q2;
};

/// The sums as printed, for nine dots.
template <scalar S>
GridDirections<S> directions_of_all(const std::array<Point3<S>, 9>& p) {
  const auto steps = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t by) {
    return p[a + by] - p[a] + p[b + by] - p[b] + p[c + by] - p[c];
  };
  return {steps(0, 3, 6, 2), steps(0, 1, 2, 6)};
}

/// The least-squares slopes over the dots found, times the positive determinant of the normal
/// equations, whose coefficients are integers.
template <scalar S>
GridDirections<S> directions_of_some(const std::array<Point3<S>, 9>& p,
                                     const std::array<bool, 9>& found) {
  int n = 0, su = 0, sv = 0, suu = 0, svv = 0, suv = 0;
  for (int k = 0; k < 9; ++k) {
    const int u = k % 3 - 1, v = k / 3 - 1;
    if (found[static_cast<std::size_t>(k)]) {
      ++n;
      su += u;
      sv += v;
      suu += u * u;
      svv += v * v;
      suv += u * v;
    }
  }
  const int cuu = n * suu - su * su, cvv = n * svv - sv * sv, cuv = n * suv - su * sv;
  GridDirections<S> q = {{S(0), S(0), S(0)}, {S(0), S(0), S(0)}};
  if (cuu * cvv == cuv * cuv) {
    return q;
  }
  std::size_t first = 0;
  while (!found[first]) {
    ++first;
  }
  for (int k = 0; k < 9; ++k) {
    const int u = n * (k % 3 - 1) - su, v = n * (k / 3 - 1) - sv;
    const auto at = static_cast<std::size_t>(k);
    if (found[at]) {
      const Point3<S> from_first = p[at] - p[first];  // exactly 0 if all dots coincide
      q.q1 = q.q1 + S(cvv * u - cuv * v) * from_first;
      q.q2 = q.q2 + S(cuu * v - cuv * u) * from_first;
    }
  }
  return q;
}

template <scalar S, class Frame>
Neighbourhood<S> neighbourhood(const Frame& frame, DotIndex d) {
  Neighbourhood<S> n;
  for (std::size_t k = 0; k < 9; ++k) {
    const Index i = d.row - 1 + static_cast<Index>(k / 3);
    const Index j = d.col - 1 + static_cast<Index>(k % 3);
    const bool inside = i >= 0 && j >= 0 && i < frame.rows() && j < frame.cols();
    n.dot[k] = inside ? frame.dot(i, j) : missing_point<S>();
    n.found[k] = is_plausible(n.dot[k]);
  }
  return n;
}

/// Center of the common dots.
template <scalar S>
Point3<S> center(const Neighbourhood<S>& n, const CommonDots& common) {
  Point3<S> c = {S(0), S(0), S(0)};
  for (std::size_t k = 0; k < 9; ++k) {
    c = common.found[k] ? (c + n.dot[k]) : c;
  }
  return S(S(1) / S(static_cast<double>(common.count))) * c;
}

/// q1 and q2 over the dots of `common`.
template <scalar S>
GridDirections<S> grid_directions(const Neighbourhood<S>& n, const CommonDots& common) {
  return common.count == 9 ? directions_of_all(n.dot) : directions_of_some(n.dot, common.found);
}

/// Three vectors as the columns of a matrix.
template <scalar S>
struct Basis {
  Point3<S> n1;
  Point3<S> n2;
  Point3<S> n3;
  bool determined = false;  ///< false: n1 or n2 is missing, or they are parallel
};

/// Rotation of a neighbourhood between two frames.
template <scalar S>
struct LocalRotation {
  Rotation<S> rotation = {};
  MotionStatus status = MotionStatus::too_few_dots;
};

/// Eqs. 14-16.
template <scalar S>
Basis<S> published_basis(const GridDirections<S>& q) {
  const S sq1 = squared_norm(q.q1);
  const S sq2 = squared_norm(q.q2);
  const Point3<S> n3 = cross(q.q1, q.q2);
  const S limit = S(collinear_spread_sq) * sq1 * sq2;
  if (!(value(squared_norm(n3)) > value(limit))) {
    return {};
  }
  const Point3<S> n1 = normalized(q.q1);
  const Point3<S> n2 = normalized(q.q2);
  return {n1, n2, cross(n1, n2), true};
}

/// The orthonormal frame nearest to n1 and n2, which both deviate from it by the same angle:
///   n3 = normalized(n1 x n2),  s = normalized(n1 + n2),  t = n3 x s,
///   n1' = (s - t)/sqrt 2,  n2' = (s + t)/sqrt 2
/// A shear of the neighbourhood turns n1 and n2 in opposite directions and leaves the frame as it
/// is.
template <scalar S>
Basis<S> symmetric_frame(const GridDirections<S>& q) {
  using std::sqrt;
  const S sq1 = squared_norm(q.q1);
  const S sq2 = squared_norm(q.q2);
  const Point3<S> normal = cross(q.q1, q.q2);
  const S limit = S(collinear_spread_sq) * sq1 * sq2;
  if (!(value(squared_norm(normal)) > value(limit))) {
    return {};
  }
  const Point3<S> n3 = normalized(normal);
  // n1 + n2 up to a factor: q2 is scaled to the length of q1
  const S stretch = sqrt(S(sq1 / sq2));
  const Point3<S> s = normalized(q.q1 + stretch * q.q2);
  const Point3<S> t = cross(n3, s);
  const S half = sqrt(S(S(1) / S(2)));
  return {half * (s - t), half * (s + t), n3, true};
}

/// N_l N_k^T.
template <scalar S>
Rotation<S> turn_between(const Basis<S>& k, const Basis<S>& l) {
  const auto row = [](const S& a, const S& b, const S& c, const Basis<S>& n) {
    return a * n.n1 + b * n.n2 + c * n.n3;
  };
  const Point3<S> x = row(l.n1.x, l.n2.x, l.n3.x, k);
  const Point3<S> y = row(l.n1.y, l.n2.y, l.n3.y, k);
  const Point3<S> z = row(l.n1.z, l.n2.z, l.n3.z, k);
  return {{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}}};
}

/// N^-T as a basis: its vectors are the rows of N^-1, so N_l N^-1 = N_l (N^-T)^T.
template <scalar S>
Basis<S> inverse_transposed(const Basis<S>& n) {
  const Point3<S> c = cross(n.n1, n.n2);
  const S inv = S(1) / dot(c, n.n3);
  return {inv * cross(n.n2, n.n3), inv * cross(n.n3, n.n1), inv * c, true};
}

template <scalar S, class MakeBasis, class Between>
LocalRotation<S> turn_of_bases(const Neighbourhood<S>& k,
                               const Neighbourhood<S>& l,
                               const MakeBasis& basis_of,
                               const Between& between) {
  const CommonDots common = common_dots(k, l);
  if (common.count < 3) {
    return {};
  }
  const Basis<S> before = basis_of(grid_directions(k, common));
  const Basis<S> after = basis_of(grid_directions(l, common));
  if (!before.determined || !after.determined) {
    return {{}, MotionStatus::collinear};
  }
  return {between(before, after), MotionStatus::ok};
}

/// A dot with its neighbours in an earlier frame, its anchor frame.
template <scalar S>
struct FollowedDot {
  DotIndex index = {};
  Neighbourhood<S> anchor = {};
  std::array<bool, 9> touching = {};  ///< the dots of the anchor that were in contact
  bool has_left = false;              ///< when last found, the dot was out of contact
};

/// How a followed dot has moved since its anchor.
template <scalar S>
struct DotStep {
  MotionStatus status = MotionStatus::too_few_dots;
  Pose<S> pose = {};
  Neighbourhood<S> now = {};
  Index dots_used = 0;
  S residual_rms_mm = S(0);
};

template <class Local, scalar S>
DotStep<S> step_between(const Neighbourhood<S>& anchor, const Neighbourhood<S>& now) {
  using std::sqrt;
  DotStep<S> step;
  const LocalRotation<S> turn = Local::turn(anchor, now);
  step.status = turn.status;
  step.now = now;
  if (turn.status != MotionStatus::ok) {
    return step;
  }
  const CommonDots common = common_dots(anchor, now);
  const Point3<S> before = center(anchor, common);
  const Point3<S> after = center(now, common);
  step.pose = {turn.rotation, after - turn.rotation(before)};
  step.dots_used = common.count;
  S sum_sq = S(0);
  for (std::size_t k = 0; k < 9; ++k) {
    if (common.found[k]) {
      sum_sq = sum_sq + squared_norm(now.dot[k] - step.pose(anchor.dot[k]));
    }
  }
  sum_sq = sum_sq / S(static_cast<double>(common.count));
  step.residual_rms_mm = value(sum_sq) > 0 ? S(sqrt(sum_sq)) : S(0);
  return step;
}

template <class Frame>
std::array<bool, 9> touching(const Frame& frame, DotIndex d) {
  std::array<bool, 9> flags = {};
  for (std::size_t k = 0; k < 9; ++k) {
    const Index i = d.row - 1 + static_cast<Index>(k / 3);
    const Index j = d.col - 1 + static_cast<Index>(k % 3);
    const bool inside = i >= 0 && j >= 0 && i < frame.rows() && j < frame.cols();
    flags[k] = inside && frame.flagged(i, j);
  }
  return flags;
}

template <scalar S, class Frame>
FollowedDot<S> follow(const Frame& frame, DotIndex index) {
  return {index, neighbourhood<S>(frame, index), touching(frame, index), false};
}

/// False if the dot is found out of contact for the second time in a row. The first time it is
/// still used, so that another dot can replace it without a gap. After that its motion is no longer
/// the object's.
template <scalar S, class Frame>
bool is_still_held(const Frame& frame, FollowedDot<S>& followed) {
  const bool found = frame.found(followed.index.row, followed.index.col);
  const bool out = found && !frame.flagged(followed.index.row, followed.index.col);
  const bool was_out = followed.has_left;
  followed.has_left = found ? out : was_out;
  return !(out && was_out);
}

/// The step of the dots in contact both then and now; of all dots if those give no rotation.
template <class Local, scalar S, class Frame>
DotStep<S> step_of(const Frame& frame, const FollowedDot<S>& followed) {
  const Neighbourhood<S> now = neighbourhood<S>(frame, followed.index);
  Neighbourhood<S> held = now;
  const std::array<bool, 9> flags = touching(frame, followed.index);
  for (std::size_t k = 0; k < 9; ++k) {
    held.found[k] = now.found[k] && flags[k] && followed.touching[k];
  }
  const DotStep<S> step = step_between<Local>(followed.anchor, held);
  return step.status == MotionStatus::ok ? step : step_between<Local>(followed.anchor, now);
}

/// Starts to follow the reference dot in the first frame of the object.
template <scalar S, class Frame, class FollowingTrack>
MotionStatus begin_following(const Frame& frame, DotIndex reference, FollowingTrack& t) {
  if (!reference.exists()) {
    return MotionStatus::no_reference_dot;
  }
  t = {};
  t.followed = follow<S>(frame, reference);
  t.start_mm = frame.dot(reference.row, reference.col);
  t.dots_used = 9;
  return MotionStatus::ok;
}

/// Whether the dots moved rigidly: the residual is at most a quarter of the pitch.
template <scalar S>
bool is_rigid(const Neighbourhood<S>& anchor, const S& residual_mm) {
  S least_sq = S(std::numeric_limits<scalar_real_t<S>>::infinity());
  for (std::size_t k = 1; k < 9; k += 2) {  // the four nearest neighbours
    if (anchor.found[k] && anchor.found[4]) {
      const S sq = squared_norm(anchor.dot[k] - anchor.dot[4]);
      least_sq = value(sq) < value(least_sq) ? sq : least_sq;
    }
  }
  return !(value(least_sq) < 16 * value(S(residual_mm * residual_mm)));
}

/// The step of a followed dot in the next frame, or why there is none.
template <class Local, scalar S, class Frame>
DotStep<S> next_step(const Frame& frame, DotIndex reference, FollowedDot<S>& followed) {
  DotStep<S> step;
  if (!is_still_held(frame, followed)) {
    step.status = MotionStatus::lost;
    return step;
  }
  step = step_of<Local>(frame, followed);
  if (step.status == MotionStatus::ok && followed.has_left && !reference.exists()) {
    step.status = MotionStatus::no_reference_dot;
  } else if (step.status == MotionStatus::ok && !is_rigid(followed.anchor, step.residual_rms_mm)) {
    step.status = MotionStatus::not_rigid;
  }
  return step;
}

}  // namespace detail::motion
}  // namespace v0
}  // namespace fingerpad
