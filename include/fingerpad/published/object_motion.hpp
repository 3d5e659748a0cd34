// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The object's motion as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile information by
// vision-based tactile sensor for dexterous handling of robot hands", III.C, eqs. 14-19. A basis of
// its neighbours gives the rotation of the contact reference dot, and Euler angles are added up
// from frame to frame. The sum is wrong because rotations do not commute: docs/errata.md,
// E021-E024.
#include <cstddef>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

/// Eqs. 14-16: the columns n_1, n_2, n_3 around the middle one of 3 x 3 dots, where dots(row, col)
/// with row and col from 0 to 2. In a sheared neighbourhood they are not orthogonal (E023).
template <scalar S, class Dots>
Rotation<S> basis_around(const Dots& dots) {
  Point3<S> q_1 = {S(0), S(0), S(0)}, q_2 = q_1;
  for (Index k = 0; k < 3; ++k) {
    q_1 += dots(k, 2) - dots(k, 0);
    q_2 += dots(2, k) - dots(0, k);
  }
  const Point3<S> n_1 = normalized(q_1), n_2 = normalized(q_2), n_3 = cross(n_1, n_2);
  return {{{n_1.x, n_2.x, n_3.x}, {n_1.y, n_2.y, n_3.y}, {n_1.z, n_2.z, n_3.z}}};
}

/// Eq. 17: R = N_l N_k^-1. As printed, n_2 stands twice in the inverse (E021), and the vectors are
/// rows, which gives the rotation back (E022).
template <scalar S>
Rotation<S> rotation_between(const Rotation<S>& n_k, const Rotation<S>& n_l) {
  const auto column = [&](int c) { return Point3<S>{n_k.m[0][c], n_k.m[1][c], n_k.m[2][c]}; };
  const Point3<S> a = cross(column(1), column(2)), b = cross(column(2), column(0)),
                  c = cross(column(0), column(1));
  const S det = dot(a, column(0));
  return n_l * Rotation<S>{{{a.x / det, a.y / det, a.z / det},
                            {b.x / det, b.y / det, b.z / det},
                            {c.x / det, c.y / det, c.z / det}}};
}

template <scalar S = double>
struct [[nodiscard]] ObjectMotionResult {
  bool updated = false;     ///< false: no contact, or a dot missing around the reference dot
  bool begun = false;       ///< the object begins with this frame
  DotIndex reference = {};  ///< p_I,J of this frame; row -1: none
  Angles<S> angles = {};    ///< sums, eq. 19; they may exceed pi
  Point3<S> displacement_mm = {S(0), S(0), S(0)};  ///< sum of those of the reference dots
  Pose<S> pose = {};  ///< the rotation of these angles about the first reference dot, displaced

  bool ok() const { return updated; }
};

/// The motion of the object in contact, frame by frame. The object is the state: copy it to return
/// to a frame. O(rows cols) a frame, allocates nothing.
template <scalar S = double>
class ObjectMotion {
 public:
  /// `initial_mm` are the dots of the free pad. Refuses bad parameters (parameter_error).
  template <spatial_dot_grid Dots>
  explicit ObjectMotion(const Dots& initial_mm)
      : rows_(fingerpad::rows(initial_mm)), cols_(fingerpad::cols(initial_mm)) {
    expects_grid_size("published::ObjectMotion", rows_, cols_, 0);
    initial_.resize(static_cast<std::size_t>(rows_ * cols_));
    before_ = now_ = initial_;
    read(as_view(initial_mm), initial_);
  }

  /// Looks at a frame of dots (NaN: not found), of which those with a true `contact` touch the
  /// object.
  template <spatial_dot_grid Dots, contact_mask Contact>
  ObjectMotionResult<S> operator()(const Dots& dots_mm, const Contact& contact) {
    const auto dots = as_view(dots_mm);
    const auto flags = as_view(contact);
    result_.updated = result_.begun = false;
    if (dots.rows() != rows_ || dots.cols() != cols_ || !same_size(dots, flags)) {
      return result_;
    }
    read(dots, now_);
    if (!any_contact(flags)) {
      result_.reference = {};  // the object is gone
      return result_;
    }
    const DotIndex reference = reference_dot(flags);
    if (!result_.reference.exists() && reference.exists()) {
      result_ = {.updated = true, .begun = true};
      start_mm_ = at(now_, reference);
    } else if (result_.reference.exists() && is_complete(now_, result_.reference)) {
      add_step();
    } else {
      return result_;  // wait until the nine dots are found
    }
    result_.reference = reference.exists() ? reference : result_.reference;
    before_.swap(now_);
    return result_;
  }

 private:
  using Points = std::vector<Point3<S>>;

  template <class Dots>
  static void read(const Dots& from, Points& to) {
    for (Index i = 0; i < from.rows(); ++i) {
      for (Index j = 0; j < from.cols(); ++j) {
        to[static_cast<std::size_t>(i * from.cols() + j)] =
            detail::spatial_dot<S>(cell_t<Dots>(from(i, j)));
      }
    }
  }
  template <class Contact>
  static bool any_contact(const Contact& contact) {
    bool any = false;
    for (Index i = 0; i < contact.rows(); ++i) {
      for (Index j = 0; j < contact.cols(); ++j) {
        any = any || is_contact(cell_t<Contact>(contact(i, j)));
      }
    }
    return any;
  }
  const Point3<S>& at(const Points& p, const DotIndex& d) const {
    return p[static_cast<std::size_t>(d.row * cols_ + d.col)];
  }
  /// The 3 x 3 dots around d.
  auto around(const Points& p, const DotIndex& d) const {
    return [&p, d, this](Index i, Index j) { return at(p, {d.row - 1 + i, d.col - 1 + j}); };
  }
  bool is_complete(const Points& p, const DotIndex& d) const {
    bool all = true;
    for (Index k = 0; k < 9; ++k) {
      all = all && is_finite(around(p, d)(k / 3, k % 3));
    }
    return all;
  }

  /// p_I,J: "the dot which displacement from the initial position is biggest", of those in contact
  /// with eight neighbours.
  template <class Contact>
  DotIndex reference_dot(const Contact& contact) const {
    DotIndex best;
    S most = S(-1);
    for (Index i = 1; i + 1 < rows_; ++i) {
      for (Index j = 1; j + 1 < cols_; ++j) {
        const S moved = squared_norm(at(now_, {i, j}) - at(initial_, {i, j}));
        if (is_contact(cell_t<Contact>(contact(i, j))) && most < moved &&
            is_complete(now_, {i, j})) {
          best = {i, j};
          most = moved;
        }
      }
    }
    return best;
  }

  /// The step since the frame before, of the reference dot of that frame; eqs. 18 and 19.
  void add_step() {
    const DotIndex& d = result_.reference;
    const Angles<S> step = zyx_angles(
        rotation_between(basis_around<S>(around(before_, d)), basis_around<S>(around(now_, d))));
    result_.angles = {result_.angles.x_rad + step.x_rad, result_.angles.y_rad + step.y_rad,
                      result_.angles.z_rad + step.z_rad};
    result_.displacement_mm += at(now_, d) - at(before_, d);
    result_.pose.rotation = rotation_of(result_.angles);
    result_.pose.translation_mm =
        start_mm_ + result_.displacement_mm - result_.pose.rotation(start_mm_);
    result_.updated = true;
  }

  Index rows_, cols_;
  Points initial_, before_, now_;
  Point3<S> start_mm_ = {S(0), S(0), S(0)};
  ObjectMotionResult<S> result_;
};

/// For the dots of the free pad.
template <spatial_dot_grid Dots>
ObjectMotion(const Dots&) -> ObjectMotion<double>;

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
