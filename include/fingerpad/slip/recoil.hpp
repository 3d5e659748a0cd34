// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Whether an elastic pad springs back, from its dots alone: a gel that an object has dragged along
// falls back toward its free shape when the object slips or is lost. For pads of which nothing but
// dots is known; where the contact shows in the image, slip/contact_slide.hpp tells more and
// earlier. It cannot tell a slip from an object that is set down or let go: the load falls in all
// three.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"

namespace fingerpad {
inline namespace v0 {

/// What counts as recoil.
struct RecoilTest {
  double pitch_px = 40;     ///< between neighbouring dots, > 0
  double max_recoil = 0.1;  ///< alarm beyond so many pitches, > 0
  double quantile = 0.95;   ///< of the dots' displacements is followed, in (0, 1): most dots are
                            ///< beside the contact and hardly move
  Index min_dots = 5;       ///< >= 1: fewer say nothing
};
inline void expects_valid(const RecoilTest& test) {
  constexpr const char* owner = "RecoilTest";
  expects(is_finite(test.pitch_px) && test.pitch_px > 0, owner, "pitch_px", test.pitch_px,
          "finite and > 0");
  expects(is_finite(test.max_recoil) && test.max_recoil > 0, owner, "max_recoil", test.max_recoil,
          "finite and > 0");
  expects(test.quantile > 0 && test.quantile < 1, owner, "quantile", test.quantile, "in (0, 1)");
  expects(test.min_dots >= 1, owner, "min_dots", static_cast<long long>(test.min_dots), ">= 1");
}

template <scalar S = float>
struct [[nodiscard]] RecoilResult {
  FrameStatus status = FrameStatus::refused;
  Index dots = 0;      ///< found now and in the free pad
  S displaced = S(0);  ///< the quantile of their displacements, in pitches
  S recoil = S(0);     ///< by how much it has fallen since it was largest, in pitches
  bool alarm = false;  ///< recoil is beyond its threshold

  /// Whether there were enough dots; if not, all is as it was in the last frame that had them.
  bool ok() const { return status == FrameStatus::ok && enough; }
  bool enough = false;
};

/// Recoil of a pad, frame by frame. Const: threads may share one, each with a state of its own.
/// O(rows cols) and no allocation per frame.
template <scalar S = float>
class Recoil {
 public:
  /// From the free pad's dots (NaN: not found). Refuses bad parameters (parameter_error).
  template <dot_grid Dots>
  explicit Recoil(const Dots& free_px, const RecoilTest& test = {}) : test_(test) {
    expects_valid(test);
    const auto from = as_view(free_px);
    rows_ = from.rows();
    cols_ = from.cols();
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        free_.push_back(point(from(i, j)));
      }
    }
  }

  /// A value: copy it to go back to this frame later. All memory that frames need is in it.
  class State {
   public:
    explicit State(const Recoil& recoil) { lengths_.reserve(recoil.free_.size()); }
    /// What was before is forgotten.
    void reset() {
      result_ = {};
      largest_ = S(0);
    }

   private:
    friend class Recoil;
    std::vector<S> lengths_;
    S largest_ = S(0);
    RecoilResult<S> result_;
  };
  State start() const { return State(*this); }

  /// The recoil up to a frame with these dots (NaN: not found).
  template <dot_grid Dots>
  RecoilResult<S> operator()(const Dots& dots_px, State& state) const {
    const auto dots = as_view(dots_px);
    if (dots.rows() != rows_ || dots.cols() != cols_ || state.lengths_.capacity() < free_.size()) {
      return {};
    }
    state.lengths_.clear();
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const Point2<S> moved = point(dots(i, j)) - free_[static_cast<std::size_t>(i * cols_ + j)];
        if (is_finite(moved)) {
          state.lengths_.push_back(norm(moved));
        }
      }
    }
    RecoilResult<S>& result = state.result_;
    result.status = FrameStatus::ok;
    result.dots = static_cast<Index>(state.lengths_.size());
    result.enough = result.dots >= test_.min_dots;
    if (result.enough) {
      const double at = test_.quantile * static_cast<double>(result.dots - 1);
      const auto nth = state.lengths_.begin() + static_cast<std::ptrdiff_t>(at);
      std::nth_element(state.lengths_.begin(), nth, state.lengths_.end());
      result.displaced = S(*nth / S(test_.pitch_px));
      state.largest_ = state.largest_ < result.displaced ? result.displaced : state.largest_;
      result.recoil = S(state.largest_ - result.displaced);
      result.alarm = S(test_.max_recoil) < result.recoil;
    }
    return result;
  }

 private:
  template <class P>
  static Point2<S> point(const P& p) {
    return {S(point_traits<P>::x(p)), S(point_traits<P>::y(p))};
  }

  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<Point2<S>> free_;
  RecoilTest test_;
};

}  // namespace v0
}  // namespace fingerpad
