// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects that an elastic pad springs back, from its dots alone. A gel that an object has dragged
// along returns toward its free shape when the object slips or is lost. Use it if only the dots are
// available; if the contact is visible in the image, slip/contact_slide.hpp gives more information,
// and earlier. Recoil cannot distinguish a slip from an object that is set down or let go: the load
// falls in all three cases.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/slip/detail/dots_in_order.hpp"

namespace fingerpad {
inline namespace v0 {

/// Thresholds of recoil.
struct RecoilTest {
  double pitch_px = 40;     ///< distance of neighbouring dots, in [1e-6, 1e6)
  double max_recoil = 0.1;  ///< pitches; the alarm threshold, > 0
  /// The quantile of the dots' displacements that is followed, in (0, 1). Most dots are beside the
  /// contact and hardly move.
  double quantile = 0.95;
  Index min_dots = 5;  ///< fewer dots give no answer, >= 1
};
inline void expects_valid(const RecoilTest& test) {
  constexpr const char* owner = "RecoilTest";
  expects(is_plausible(test.pitch_px) && test.pitch_px >= 1e-6, owner, "pitch_px", test.pitch_px,
          ">= 1e-6 and less than a million");
  expects(is_finite(test.max_recoil) && test.max_recoil > 0, owner, "max_recoil", test.max_recoil,
          "finite and > 0");
  expects(test.quantile > 0 && test.quantile < 1, owner, "quantile", test.quantile, "in (0, 1)");
  expects(test.min_dots >= 1, owner, "min_dots", static_cast<long long>(test.min_dots), ">= 1");
}

template <scalar S = float>
struct [[nodiscard]] RecoilResult {
  FrameStatus status = FrameStatus::refused;
  Index dots = 0;      ///< found both now and in the free pad
  S displaced = S(0);  ///< that quantile of their displacements, in pitches
  S recoil = S(0);     ///< how far `displaced` is below its largest value so far, in pitches
  S evidence = S(0);   ///< for slip: recoil / max_recoil
  bool alarm = false;  ///< evidence > 1

  /// 1 without evidence for slip, falling to 0 at the alarm, as in SlideResult.
  S held() const { return evidence < S(1) ? S(S(1) - evidence) : S(0); }
  /// Whether there were enough dots. If not, displacement, recoil and evidence are those of the
  /// last frame that had them.
  bool ok() const { return status == FrameStatus::ok && enough; }
  bool touches() const { return true; }  ///< dots cannot show that contact is lost
  bool enough = false;                   ///< at least min_dots were found, labelled as before
};

/// Recoil of a pad, frame by frame. Const: threads may share one object, each with its own state. A
/// frame takes O(rows cols) time and allocates nothing.
template <scalar S = float>
class Recoil {
 public:
  /// `free_px` are the dots of the free pad (NaN: not found). Refuses bad parameters, and a
  /// pitch_px that differs from the pitch of these dots by more than a factor of three
  /// (parameter_error).
  template <dot_grid Dots>
  explicit Recoil(const Dots& free_px, const RecoilTest& test = {}) : test_(test) {
    expects_valid(test);
    const auto from = as_view(free_px);
    expects_grid_size("Recoil", from.rows(), from.cols(), 0);
    free_ = {from.rows(), from.cols()};
    free_.read(from);
    for (Index i = 0; i < free_.rows; ++i) {
      for (Index j = 0; j < free_.cols; ++j) {
        cells_.push_back(free_.cell(i, j));
      }
    }
    using std::sqrt;
    free_pitch_sq_ = detail::mean_pitch_sq(cells_, free_.found.data(), free_.width);
    const S found = sqrt(free_pitch_sq_);
    const double ratio = static_cast<double>(value(found)) / test.pitch_px;
    expects(
        !(ratio > 0) || (ratio > 1.0 / 3 && ratio < 3), "RecoilTest", "pitch_px", test.pitch_px,
        "within a factor of three of the dot distance in the free pad: check the unit of the dots");
  }

  /// A value: copy it to return to this frame later. It holds all memory that frames need.
  class State {
   public:
    explicit State(const Recoil& recoil)
        : given_{recoil.free_.rows, recoil.free_.cols},
          before_(given_.found),
          lengths_(recoil.cells_.size()) {}
    /// Returns to the state before the first frame.
    void reset() {
      result_ = {};
      largest_ = S(0);
      std::fill(before_.begin(), before_.end(), detail::missing_point<S>());
    }

   private:
    friend class Recoil;
    detail::FrameOfDots<S> given_;
    detail::Bordered<Point3<S>> before_;  // of the last frame with enough of them
    detail::ReservedVector<S> lengths_;
    S largest_ = S(0);
    RecoilResult<S> result_;
  };
  State start() const { return State(*this); }

  /// Processes a frame with these dots (NaN: not found).
  template <dot_grid Dots>
  RecoilResult<S> operator()(const Dots& dots_px, State& state) const {
    const auto dots = as_view(dots_px);
    if (dots.rows() != free_.rows || dots.cols() != free_.cols ||
        state.before_.size() != free_.found.size()) {
      return {};
    }
    state.given_.read(dots);
    const detail::Bordered<Point3<S>>& now = state.given_.found;
    const bool renamed = detail::is_renumbered(cells_, now.data(), state.before_.data(),
                                               free_.width, free_pitch_sq_);
    state.lengths_.clear();
    for (const Index k : cells_) {
      const Point3<S> moved = now[k] - free_.found[k];
      const S sq = moved.x * moved.x + moved.y * moved.y;
      if (!renamed && is_finite(sq)) {
        using std::sqrt;
        state.lengths_.push_back(S(sqrt(sq) / S(test_.pitch_px)));
      }
    }
    RecoilResult<S>& result = state.result_;
    result.status = FrameStatus::ok;
    result.dots = static_cast<Index>(state.lengths_.size());
    result.enough = result.dots >= test_.min_dots;
    if (result.enough) {
      std::copy(now.begin(), now.end(), state.before_.begin());
      const double at = test_.quantile * static_cast<double>(result.dots - 1);
      const auto nth = state.lengths_.begin() + static_cast<std::ptrdiff_t>(at);
      std::nth_element(state.lengths_.begin(), nth, state.lengths_.end());
      result.displaced = *nth;
      state.largest_ = state.largest_ < result.displaced ? result.displaced : state.largest_;
      result.recoil = S(state.largest_ - result.displaced);
      result.evidence = S(result.recoil / S(test_.max_recoil));
      result.alarm = S(1) < result.evidence;
    }
    return result;
  }

 private:
  detail::FrameOfDots<S> free_ = {0, 0};
  std::vector<Index> cells_;
  S free_pitch_sq_ = S(0);
  RecoilTest test_;
};

}  // namespace v0
}  // namespace fingerpad
