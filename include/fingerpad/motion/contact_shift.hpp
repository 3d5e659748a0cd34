// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Displacement of a contact, and its rotation about the normal, from the dots: the input of
// force/look_up.hpp. Source: Ito, Kim and Obinata,
// "Acquisition of Contact Force and Slippage ...", figure 5, which takes the displacement of the
// central dot. That dot stays with the object while the contact slips from its edge inward, so it
// shows how far the object moved rather than the force. The whole force passes through the membrane
// along the contact's edge: figures in docs/force/shear.md.
//
// The angle is that of the rigid rotation that best fits the reference dots to the dots,
// theta = atan2(sum of cross products, sum of dot products) about the centers of both. It neither
// wraps nor averages angles.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v1 {

struct ShiftOptions {
  /// The dots on both sides of the contact's edge: dots in contact with one of eight neighbours
  /// that is not, and dots out of contact with one that is. false: all dots in contact, for the
  /// displacement of the object.
  bool edge_dots = true;
  /// Huber's M-estimate, repeated in [0, 100]: a dot whose residual is more than `threshold` times
  /// the noise gets less weight, so that up to about a third of stuck or mistaken dots bias the
  /// result little. The noise is estimated from the median residual, whose own derivative a dual
  /// number does not carry. 0: all dots have the same weight; 10 suffice.
  int robust_passes = 0;
  double threshold = 1.5;  ///< in standard deviations of the noise, > 0
};

/// The first parameter without meaning, or "".
inline std::string check(const ShiftOptions& o) {
  return fingerpad::check("ContactShift", {{"robust_passes", o.robust_passes, within(0, 100)},
                                           {"threshold", o.threshold, positive}});
}

enum class ShiftStatus : std::uint8_t {
  measured,        ///< displacement and angle are known
  one_place_only,  ///< displacement without angle: fewer than two dots, or all in one place
  no_dots,         ///< none of the chosen dots was found in both frames
  /// The rms residual from the best rigid shift exceeds 3/4 of a pitch, so no displacement is
  /// given: another order or unit than in the reference, or lost dots marked by a position?
  not_rigid,
  refused,  ///< a grid does not have the reference's size
};
inline constexpr std::array<const char*, 5> shift_status_names = {
    "measured", "one place only", "no dots", "not rigid", "refused"};
/// "measured", "one place only", ...
constexpr const char* name_of(ShiftStatus status) {
  return shift_status_names[static_cast<std::size_t>(status)];
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

/// Shift of the dots since the reference frame. Dots are in mm on the plate or in px; of dots in
/// space only x and y are used. It holds the memory that a frame needs: one object a thread. A
/// frame allocates nothing and takes O(rows cols) time, times the robust passes.
template <scalar S = double>
class ContactShift {
 public:
  /// `reference` are the dots of the free pad, or of any frame that counts as not displaced.
  /// Refuses bad parameters (parameter_error).
  template <dot_grid Grid>
  explicit ContactShift(const Grid& reference, const ShiftOptions& options = {}) : o_(options) {
    require(options);
    const auto from = as_view(reference);
    expects_grid_size("ContactShift", from.rows(), from.cols(), 0);
    reference_ = detail::FrameOfDots<S>{from.rows(), from.cols()};
    frame_ = reference_;
    reference_.read(from, true);
    std::vector<Index> cells(reference_.found.size() - static_cast<std::size_t>(frame_.width));
    std::iota(cells.begin(), cells.end(), Index(0));
    pitch_sq_ = detail::mean_pitch_sq(cells, reference_.found.data(), frame_.width);
    side_.resize(frame_.found.size(), 0);
    pairs_.resize(frame_.found.size());
    residuals_.resize(frame_.found.size());
  }

  Index rows() const { return frame_.rows; }
  Index cols() const { return frame_.cols; }

  /// The shift in a frame with these `dots`, of which those with a true `contact` touch the object.
  template <dot_grid Grid, contact_mask Contact>
  ShiftResult<S> operator()(const Grid& dots, const Contact& contact) {
    const auto to = as_view(dots);
    const auto flags = as_view(contact);
    ShiftResult<S> result;
    if (to.rows() != rows() || to.cols() != cols() || !same_size(to, flags)) {
      return result;
    }
    frame_.read(to, true);
    collect(flags);
    result.status = ShiftStatus::no_dots;
    if (count_ == 0) {
      return result;
    }
    Rigid shift = fit();
    const Point2<S> middle = shift.from;  // of all dots with equal weights
    for (int pass = 0; pass < o_.robust_passes; ++pass) {
      reweigh(shift);
      shift = fit();
    }
    using std::atan2;
    using std::sqrt;
    S sum = S(0);
    for (std::size_t k = 0; k < count_; ++k) {
      sum = sum + pairs_[k].weight * shift.residual_sq(pairs_[k]);
    }
    const S mean_sq = sum / shift.weight;
    result.dots = static_cast<Index>(count_);
    result.residual_rms = S(0) < mean_sq ? sqrt(mean_sq) : S(0);
    result.status = shift.turns ? ShiftStatus::measured : ShiftStatus::one_place_only;
    if (shift.turns && S(0) < pitch_sq_ && S(9) * pitch_sq_ < S(16) * mean_sq) {
      result.status = ShiftStatus::not_rigid;
      return result;
    }
    result.displacement = shift(middle) - middle;
    result.rotation_rad = shift.turns ? atan2(shift.sine, shift.cosine) : not_a_number<S>();
    return result;
  }

 private:
  /// A dot in the reference and in the frame.
  struct Pair {
    Point2<S> from = {S(0), S(0)}, to = {S(0), S(0)};
    S weight = S(1);
  };
  /// The rigid motion that maps one centroid to the other.
  struct Rigid {
    Point2<S> from = {S(0), S(0)}, to = {S(0), S(0)};
    S weight = S(0), cosine = S(1), sine = S(0);
    bool turns = false;  ///< false: a single dot, or all in one place

    Point2<S> operator()(const Point2<S>& p) const {
      const Point2<S> e = p - from;
      return to + Point2<S>{cosine * e.x - sine * e.y, sine * e.x + cosine * e.y};
    }
    S residual_sq(const Pair& p) const { return squared_norm(p.to - (*this)(p.from)); }
  };

  static Point2<S> planar(const Point3<S>& p) { return {p.x, p.y}; }

  /// Lists the chosen dots. A dot is beside the edge if a neighbour is on the other side of it;
  /// missing and unknown dots have no side.
  template <class Flags>
  void collect(const Flags& flags) {
    count_ = 0;
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0, k = frame_.cell(i, 0); j < cols(); ++j, ++k) {
        const cell_t<Flags> flag = flags(i, j);
        bool has_side = is_finite(frame_.found[k]);
        if constexpr (std::is_same_v<cell_t<Flags>, Touch>) {
          has_side = has_side && flag != Touch::unknown;
        }
        side_[k] = !has_side ? 0 : is_contact(flag) ? 1 : -1;
      }
    }
    const Index w = frame_.width;
    for (Index k = w + 1; k + w + 1 < detail::size_of(side_); ++k) {  // within the border
      bool chosen = side_[k] > 0;
      if (o_.edge_dots) {
        chosen = false;
        for (const Index by : {-w - 1, -w, 1 - w, Index(-1), Index(1), w - 1, w, w + 1}) {
          chosen = chosen || side_[k] * side_[k + by] < 0;
        }
      }
      if (chosen && is_finite(reference_.found[k])) {
        pairs_[count_++] = {planar(reference_.found[k]), planar(frame_.found[k]), S(1)};
      }
    }
  }

  Rigid fit() const {
    using std::sqrt;
    Rigid r;
    // The second pass removes the roundoff of summing positions far from the origin. It also makes
    // the centroid of coinciding dots exact.
    for (int pass = 0; pass < 2; ++pass) {
      Point2<S> from = {S(0), S(0)}, to = from;
      r.weight = S(0);
      for (std::size_t k = 0; k < count_; ++k) {
        const Pair& p = pairs_[k];
        from += p.weight * (p.from - r.from);
        to += p.weight * (p.to - r.to);
        r.weight = r.weight + p.weight;
      }
      r.from += from / r.weight;
      r.to += to / r.weight;
    }
    S cross = S(0), along = S(0);
    for (std::size_t k = 0; k < count_; ++k) {
      const Point2<S> a = pairs_[k].from - r.from, b = pairs_[k].to - r.to;
      cross = cross + pairs_[k].weight * (a.x * b.y - a.y * b.x);
      along = along + pairs_[k].weight * dot(a, b);
    }
    const S size_sq = cross * cross + along * along;
    r.turns = S(0) < size_sq;
    if (r.turns) {
      const S size = sqrt(size_sq);
      r.cosine = along / size;
      r.sine = cross / size;
    }
    return r;
  }

  void reweigh(const Rigid& shift) {
    using std::sqrt;
    using Real = scalar_real_t<S>;
    for (std::size_t k = 0; k < count_; ++k) {
      residuals_[k] = value(shift.residual_sq(pairs_[k]));
    }
    const auto middle = residuals_.begin() + static_cast<Index>(count_ / 2);
    std::nth_element(residuals_.begin(), middle, residuals_.begin() + static_cast<Index>(count_));
    // the median distance of noise in the plane is sqrt(2 ln 2) standard deviations of a coordinate
    const S limit_sq = S(Real(*middle * Real(o_.threshold * o_.threshold / 1.3862943611198906)));
    for (std::size_t k = 0; k < count_; ++k) {
      const S residual_sq = shift.residual_sq(pairs_[k]);
      pairs_[k].weight = limit_sq < residual_sq ? sqrt(limit_sq / residual_sq) : S(1);
    }
  }

  ShiftOptions o_;
  detail::FrameOfDots<S> reference_{0, 0}, frame_{0, 0};
  S pitch_sq_ = S(0);  ///< mean square distance of neighbours in the reference; 0: there are none
  detail::Bordered<int> side_;  ///< 1: touches, -1: does not, 0: not known
  std::vector<Pair> pairs_;     ///< of this frame, `count_` of them
  std::size_t count_ = 0;
  std::vector<scalar_real_t<S>> residuals_;
};

template <dot_grid Grid>
ContactShift(const Grid&, const ShiftOptions& = {}) -> ContactShift<double>;

}  // namespace v1
}  // namespace fingerpad
