// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Displacement of a contact, and its rotation about the normal, from the dots. Source: Ito, Kim and
// Obinata, "Acquisition of Contact Force and Slippage ...", figure 5: the displacement of the
// central dot and the rotation angle of the contact surface. They are the input of force/shear.hpp
// and of the compensations of force/normal_force.hpp.
//
// The angle is that of the rigid rotation that best fits the reference dots to the dots,
// theta = atan2(sum of cross products, sum of dot products) about the centers of both. It neither
// wraps nor averages angles.
//
// The choice of dots matters. The central dot stays with the object while the contact slips from
// its edge inward, so its displacement shows how far the object moved rather than the force, most
// of all after a reversal. The whole force passes through the membrane along the contact's edge;
// therefore EdgeDots is the default. Measured figures are in docs/force/shear.md.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/motion/detail/rigid_shift.hpp"

namespace fingerpad {
inline namespace v0 {

/// All dots in contact.
struct ContactDots {};
/// The dots on both sides of the contact's edge: dots in contact with a neighbour that is not, and
/// dots out of contact with a neighbour that is, among the eight neighbours.
struct EdgeDots {};

/// Least squares: all dots have the same weight.
struct PlainMean {
  static constexpr bool is_robust = false;
};
/// Huber's M-estimate: a dot whose residual is more than `threshold` times the noise gets less
/// weight, so that up to about a third of stuck or mistaken dots bias the result little. The noise
/// is estimated from the median residual, whose own derivative a dual number does not carry.
struct HuberMean {
  static constexpr bool is_robust = true;
  double threshold = 1.5;  ///< in standard deviations of the noise, > 0
  int passes = 10;         ///< repetitions of weighting and fit, in [1, 100]
};

enum class ShiftStatus : std::uint8_t {
  measured,        ///< displacement and angle are known
  one_place_only,  ///< displacement without angle: fewer than two dots, or all in one place
  no_dots,         ///< none of the chosen dots was found in both frames
  /// The rms residual from the best rigid shift exceeds 3/4 of a pitch, so no displacement is
  /// given: another order or unit than in the reference, or lost dots marked by a position?
  not_rigid,
  refused,  ///< a grid or the workspace does not have the reference's size
};

/// "measured", "one place only", ...
constexpr const char* name_of(ShiftStatus status) {
  switch (status) {
    case ShiftStatus::measured:
      return "measured";
    case ShiftStatus::one_place_only:
      return "one place only";
    case ShiftStatus::no_dots:
      return "no dots";
    case ShiftStatus::not_rigid:
      return "not rigid";
    case ShiftStatus::refused:
      return "refused";
  }
  return "unknown";
}

template <scalar S = double>
struct [[nodiscard]] ShiftResult {
  ShiftStatus status = ShiftStatus::refused;
  Index dots = 0;  ///< dots from which the shift was computed
  Point2<S> displacement = {not_a_number<S>(), not_a_number<S>()};  ///< in the unit of the dots
  S rotation_rad = not_a_number<S>();  ///< from x toward y, in [-pi, pi]
  S residual_rms = not_a_number<S>();  ///< rms distance of the dots from the rigid shift

  bool ok() const { return status == ShiftStatus::measured; }
  bool has_displacement() const {
    return status == ShiftStatus::measured || status == ShiftStatus::one_place_only;
  }
};

namespace detail {
/// A choice that names a dot, as published::OneDot does.
template <class Dots> concept names_one_dot = requires(const Dots& dots) {
  dots.dot.row;
};
}  // namespace detail

/// Shift of chosen dots since the reference frame. Dots are in mm on the plate or in px; of dots in
/// space only x and y are used.
///   Dots  EdgeDots     use it for force/shear.hpp: the whole force passes through them
///         ContactDots  use it for the displacement of the object
///   Mean  PlainMean    use it if no dot is stuck or mistaken for another
///         HuberMean    use it if some are
/// A frame allocates nothing and takes O(rows cols) time, times the passes of HuberMean.
template <class Dots = EdgeDots, class Mean = PlainMean, scalar S = double>
class ContactShift {
  static_assert(!scalar<Dots>, "the scalar comes last: ContactShift<EdgeDots, PlainMean, double>");

 public:
  /// Scratch memory for a frame; one per thread.
  class Workspace {
    friend class ContactShift;
    detail::ReservedVector<detail::DotPair<S>> pairs_;
    detail::ReservedVector<scalar_real_t<S>> residuals_;
  };

  /// `reference` are the dots of the free pad, or of any frame that counts as not displaced.
  /// Refuses bad parameters (parameter_error).
  template <dot_grid Grid>
  explicit ContactShift(const Grid& reference, const Dots& dots = {}, const Mean& mean = {})
      : dots_(dots), mean_(mean) {
    const auto from = as_view(reference);
    rows_ = from.rows();
    cols_ = from.cols();
    expects_grid_size("ContactShift", rows_, cols_, 0);
    reference_.reserve(static_cast<std::size_t>(rows_ * cols_));
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        reference_.push_back(planar(from(i, j)));
      }
    }
    leave_out(S(0));
    leave_out(S(-1));
    pitch_sq_ = mean_pitch_sq();
    check_choice();
    if constexpr (Mean::is_robust) {
      expects(mean.threshold > 0, "HuberMean", "threshold", mean.threshold, "> 0");
      expects(mean.passes >= 1 && mean.passes <= 100, "HuberMean", "passes",
              static_cast<long long>(mean.passes), "in [1, 100]");
    }
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  Workspace workspace() const {
    Workspace w;
    w.pairs_.reserve(reference_.size());
    w.residuals_.reserve(reference_.size());
    return w;
  }

  /// The shift in a frame with these `dots`, of which those with a true `contact` touch the object.
  template <dot_grid Grid, contact_mask Contact>
  ShiftResult<S> operator()(const Grid& dots, const Contact& contact, Workspace& w) const {
    const auto to = as_view(dots);
    const auto flags = as_view(contact);
    ShiftResult<S> result;
    if (to.rows() != rows_ || to.cols() != cols_ || !same_size(to, flags) ||
        w.pairs_.capacity() < reference_.size()) {
      return result;
    }
    if constexpr (detail::names_one_dot<Dots>) {
      return shift_of_one(to, flags, w);
    } else {
      collect(to, flags, w);
      return shift_of_pairs(w);
    }
  }

 private:
  using Pair = detail::DotPair<S>;
  using Rigid = detail::RigidShift<S>;

  template <planar_point P>
  static Point2<S> planar(const P& p) {
    return {S(point_traits<P>::x(p)), S(point_traits<P>::y(p))};
  }
  /// Removes dots of the reference at a position that marks lost dots in other software, if several
  /// dots share it.
  void leave_out(const S& mark) {
    const auto is_mark = [&](const Point2<S>& p) {
      return value(p.x) == value(mark) && value(p.y) == value(mark);
    };
    if (std::count_if(reference_.begin(), reference_.end(), is_mark) > 1) {
      std::replace_if(reference_.begin(), reference_.end(), is_mark,
                      Point2<S>{not_a_number<S>(), not_a_number<S>()});
    }
  }
  /// Mean square distance of neighbours in the reference; infinite if there are none.
  S mean_pitch_sq() const {
    S sum = S(0);
    int count = 0;
    const auto add = [&](const Point2<S>& a, const Point2<S>& b) {
      if (is_plausible(a) && is_plausible(b)) {
        sum = sum + squared_norm(b - a);
        ++count;
      }
    };
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        if (j + 1 < cols_) {
          add(from_at(i, j), from_at(i, j + 1));
        }
        if (i + 1 < rows_) {
          add(from_at(i, j), from_at(i + 1, j));
        }
      }
    }
    return count > 0 ? S(sum / S(count)) : S(std::numeric_limits<scalar_real_t<S>>::infinity());
  }
  const Point2<S>& from_at(Index i, Index j) const {
    return reference_[static_cast<std::size_t>(i * cols_ + j)];
  }

  void check_choice() const {
    if constexpr (detail::names_one_dot<Dots>) {
      expects(dots_.dot.row >= 0 && dots_.dot.row < rows_, "OneDot", "row",
              static_cast<long long>(dots_.dot.row), "in [0, rows)");
      expects(dots_.dot.col >= 0 && dots_.dot.col < cols_, "OneDot", "col",
              static_cast<long long>(dots_.dot.col), "in [0, cols)");
    }
  }

  template <class View, class Flags>
  void collect(const View& to, const Flags& flags, Workspace& w) const {
    w.pairs_.clear();
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const Point2<S> dot = planar(to(i, j));
        if (is_plausible(dot) && is_plausible(from_at(i, j)) && is_chosen(to, flags, i, j)) {
          w.pairs_.push_back({from_at(i, j), dot, S(1)});
        }
      }
    }
  }

  template <class Flags>
  static bool touches(const Flags& flags, Index i, Index j) {
    return is_contact(cell_t<Flags>(flags(i, j)));
  }
  template <class Flags>
  static bool is_unknown(const Flags& flags, Index i, Index j) {
    if constexpr (std::is_same_v<cell_t<Flags>, Touch>) {
      return flags(i, j) == Touch::unknown;
    } else {
      return false;
    }
  }

  template <class View, class Flags>
  bool is_chosen(const View& to, const Flags& flags, Index i, Index j) const {
    if constexpr (std::is_same_v<Dots, EdgeDots>) {
      return !is_unknown(flags, i, j) && is_beside_edge(to, flags, i, j);
    } else {
      return touches(flags, i, j);
    }
  }
  /// Whether a neighbour is on the other side of the edge. Missing and unknown neighbours do not
  /// count.
  template <class View, class Flags>
  bool is_beside_edge(const View& to, const Flags& flags, Index i, Index j) const {
    const bool inside = touches(flags, i, j);
    for (Index k = (std::max)(i - 1, Index(0)); k < (std::min)(i + 2, rows_); ++k) {
      for (Index l = (std::max)(j - 1, Index(0)); l < (std::min)(j + 2, cols_); ++l) {
        if (touches(flags, k, l) != inside && !is_unknown(flags, k, l) &&
            is_plausible(planar(to(k, l)))) {
          return true;
        }
      }
    }
    return false;
  }

  template <class View, class Flags>
  ShiftResult<S> shift_of_one(const View& to, const Flags& flags, Workspace& w) const {
    collect(to, flags, w);
    ShiftResult<S> result = shift_of_pairs(w);
    const Point2<S>& from = from_at(dots_.dot.row, dots_.dot.col);
    const Point2<S> dot = planar(to(dots_.dot.row, dots_.dot.col));
    if (result.status == ShiftStatus::not_rigid) {
      return result;
    }
    if (!is_plausible(from) || !is_plausible(dot)) {
      result.status = ShiftStatus::no_dots;
      result.displacement = {not_a_number<S>(), not_a_number<S>()};
      return result;
    }
    if (result.status == ShiftStatus::no_dots) {
      result.status = ShiftStatus::one_place_only;
    }
    result.displacement = {S(dot.x - from.x), S(dot.y - from.y)};
    return result;
  }

  ShiftResult<S> shift_of_pairs(Workspace& w) const {
    ShiftResult<S> result;
    result.status = ShiftStatus::no_dots;
    if (w.pairs_.empty()) {
      return result;
    }
    Rigid shift(w.pairs_);
    const Point2<S> middle = shift.from();  // of all dots with equal weights
    if constexpr (Mean::is_robust) {
      for (int pass = 0; pass < mean_.passes; ++pass) {
        reweigh(shift, w);
        shift = Rigid(w.pairs_);
      }
    }
    result.dots = static_cast<Index>(w.pairs_.size());
    result.displacement = shift.carried(middle);
    result.status = shift.turns() ? ShiftStatus::measured : ShiftStatus::one_place_only;
    result.rotation_rad = shift.angle_rad();
    result.residual_rms = rms_of(shift, w);
    const S residual_sq = S(result.residual_rms * result.residual_rms);
    if (result.ok() && 9 * value(pitch_sq_) < 16 * value(residual_sq)) {
      result.status = ShiftStatus::not_rigid;
      result.displacement = {not_a_number<S>(), not_a_number<S>()};
      result.rotation_rad = not_a_number<S>();
    }
    return result;
  }

  static S rms_of(const Rigid& shift, const Workspace& w) {
    using std::sqrt;
    S sum = S(0);
    for (const Pair& p : w.pairs_) {
      sum = sum + S(p.weight * shift.residual_sq(p));
    }
    const S mean_sq = sum / shift.weight();
    return value(mean_sq) > 0 ? S(sqrt(mean_sq)) : S(0);
  }

  void reweigh(const Rigid& shift, Workspace& w) const {
    using std::sqrt;
    using Real = scalar_real_t<S>;
    w.residuals_.clear();
    for (const Pair& p : w.pairs_) {
      w.residuals_.push_back(value(shift.residual_sq(p)));
    }
    const auto middle = w.residuals_.begin() + static_cast<Index>(w.residuals_.size() / 2);
    std::nth_element(w.residuals_.begin(), middle, w.residuals_.end());
    // the median distance of noise in the plane is sqrt(2 ln 2) standard deviations of a coordinate
    const Real limit_sq = *middle * Real(mean_.threshold * mean_.threshold / 1.3862943611198906);
    for (Pair& p : w.pairs_) {
      const S residual = shift.residual_sq(p);
      const bool far = value(residual) > limit_sq;
      p.weight = far ? S(sqrt(S(S(limit_sq) / residual))) : S(1);
    }
  }

  Dots dots_;
  Mean mean_;
  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<Point2<S>> reference_;
  S pitch_sq_ = S(0);
};

}  // namespace v0
}  // namespace fingerpad
