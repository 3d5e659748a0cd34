// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One frame of dots and contact flags, and the contact reference dot. Source: Ito, Kim, Nagai,
// Obinata 2011, III.C: "the dot which displacement from the initial position is biggest", among the
// dots in contact whose eight neighbours are found.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::motion {

/// Converts any spatial point to the scalar S.
template <scalar S, spatial_point P>
constexpr Point3<S> spatial(const P& p) {
  using Traits = point_traits<P>;
  return {S(Traits::x(p)), S(Traits::y(p)), S(Traits::z(p))};
}

template <scalar S, class Dots, class Contact>
class DotFrame {
 public:
  DotFrame(const Dots& dots_mm, const Contact& contact) : dots_(dots_mm), contact_(contact) {}

  Index rows() const { return dots_.rows(); }
  Index cols() const { return dots_.cols(); }
  Point3<S> dot(Index row, Index col) const { return spatial<S>(cell_t<Dots>(dots_(row, col))); }
  bool flagged(Index row, Index col) const {
    return is_contact(cell_t<Contact>(contact_(row, col)));
  }
  /// (0, 0, 0) counts as lost: no membrane is there, and some software marks lost dots in this way.
  bool found(Index row, Index col) const {
    const Point3<S> p = dot(row, col);
    return is_plausible(p) && !(value(p.x) == 0 && value(p.y) == 0 && value(p.z) == 0);
  }
  bool in_contact(DotIndex d) const { return flagged(d.row, d.col) && found(d.row, d.col); }

  bool any_flagged() const {
    return any([this](Index i, Index j) { return flagged(i, j); });
  }
  bool any_found() const {
    return any([this](Index i, Index j) { return found(i, j); });
  }

 private:
  template <class Test>
  bool any(const Test& test) const {
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0; j < cols(); ++j) {
        if (test(i, j)) {
          return true;
        }
      }
    }
    return false;
  }

  Dots dots_;
  Contact contact_;
};

/// A frame in which only dots that do not slip count as in contact.
template <class Frame, class Slips>
class SteadyFrame : public Frame {
 public:
  SteadyFrame(const Frame& frame, const Slips& slips) : Frame(frame), slips_(slips) {
    for (Index i = 0; i < this->rows(); ++i) {
      for (Index j = 0; j < this->cols(); ++j) {
        const bool touches = Frame::flagged(i, j) && this->found(i, j);
        touching_ += touches ? 1 : 0;
        steady_ += touches && flagged(i, j) ? 1 : 0;
      }
    }
  }

  bool flagged(Index row, Index col) const {
    return Frame::flagged(row, col) && !is_contact(cell_t<Slips>(slips_(row, col)));
  }
  /// Whether fewer than a fifth of the dots in contact hold the object. The motion of the dots is
  /// then not that of the object.
  bool slides() const { return 5 * steady_ < touching_; }
  /// Whether more than half of the dots in contact hold the object; also without contact.
  bool holds_most() const { return 2 * steady_ > touching_ || touching_ == 0; }

 private:
  Slips slips_;
  Index touching_ = 0;
  Index steady_ = 0;
};

/// The dots of the free pad, rows x cols; NaN for a dot not found.
template <scalar S>
struct InitialDots {
  std::vector<Point3<S>> dots;
  Index rows = 0;
  Index cols = 0;

  const Point3<S>& operator()(Index row, Index col) const {
    return dots[static_cast<std::size_t>(row * cols + col)];
  }
};

/// Refuses dots whose median distance of neighbours no pad has, for example in m or um.
template <scalar S>
void expects_in_mm(const InitialDots<S>& initial) {
  std::vector<double> steps_mm;
  for (Index i = 0; i < initial.rows; ++i) {
    for (Index j = 0; j + 1 < initial.cols; ++j) {
      if (is_plausible(initial(i, j)) && is_plausible(initial(i, j + 1))) {
        const S sq = squared_norm(initial(i, j + 1) - initial(i, j));
        steps_mm.push_back(std::sqrt(static_cast<double>(value(sq))));
      }
    }
  }
  if (steps_mm.empty()) {
    return;
  }
  const auto middle = steps_mm.begin() + static_cast<std::ptrdiff_t>(steps_mm.size() / 2);
  std::nth_element(steps_mm.begin(), middle, steps_mm.end());
  const bool one_place = !(*middle > 0);  // no real dots, which every frame reports
  expects(one_place || (*middle > 0.05 && *middle < 50), "ObjectMotion",
          "distance of neighbouring dots, mm", *middle,
          "in (0.05, 50): give the dots of the free pad in mm, and NaN for lost dots");
}

/// Whether the dot and its eight neighbours are found, now and initially.
template <scalar S, class Frame>
bool is_complete(const Frame& frame, const InitialDots<S>& initial, DotIndex d) {
  if (d.row < 1 || d.col < 1 || d.row > frame.rows() - 2 || d.col > frame.cols() - 2) {
    return false;
  }
  for (Index i = d.row - 1; i <= d.row + 1; ++i) {
    for (Index j = d.col - 1; j <= d.col + 1; ++j) {
      if (!frame.found(i, j) || !is_plausible(initial(i, j))) {
        return false;
      }
    }
  }
  return true;
}

/// Whether the dot and its eight neighbours are flagged as in contact; d must not lie on the
/// border.
template <class Frame>
bool is_within_contact(const Frame& frame, DotIndex d) {
  for (Index i = d.row - 1; i <= d.row + 1; ++i) {
    for (Index j = d.col - 1; j <= d.col + 1; ++j) {
      if (!frame.flagged(i, j)) {
        return false;
      }
    }
  }
  return true;
}

/// The contact reference dot; of equal displacements, the first in row order. The dot `before`
/// stays as long as the largest displacement exceeds its own by at most `margin_mm`, and its
/// neighbourhood is complete and in contact. Neighbours are examined only for a dot in contact that
/// has moved further than the best.
template <scalar S, class Frame>
DotIndex reference_dot(const Frame& frame,
                       const InitialDots<S>& initial,
                       DotIndex before,
                       const S& margin_mm) {
  using std::sqrt;
  DotIndex best;
  S best_sq = S(-1);
  const auto moved_sq = [&](Index i, Index j) {
    return squared_norm(frame.dot(i, j) - initial(i, j));
  };
  for (Index i = 1; i < frame.rows() - 1; ++i) {
    for (Index j = 1; j < frame.cols() - 1; ++j) {
      if (!frame.flagged(i, j)) {
        continue;
      }
      const S sq = moved_sq(i, j);
      if (value(sq) > value(best_sq) && is_complete(frame, initial, {i, j})) {
        best = {i, j};
        best_sq = sq;
      }
    }
  }
  if (value(margin_mm) > 0 && before.exists() && is_complete(frame, initial, before) &&
      is_within_contact(frame, before)) {
    const S kept = sqrt(moved_sq(before.row, before.col)) + margin_mm;
    return value(S(kept * kept)) < value(best_sq) ? best : before;
  }
  return best;
}

/// State common to all policies of accumulation.
template <scalar S>
struct Track {
  Pose<S> pose = {};
  Angles<S> angles = {};
  Point3<S> start_mm = {S(0), S(0), S(0)};  ///< initial position of the reported point
  Index dots_used = 0;
  S residual_rms_mm = S(0);
};

}  // namespace detail::motion

}  // namespace v0
}  // namespace fingerpad
