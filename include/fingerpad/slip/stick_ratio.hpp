// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fraction of the contact that sticks to the object, from the dots printed in the membrane: 1
// when nothing slips, 0 when the whole object slips. It falls before gross slip, because slip
// starts at the edge of the contact and spreads inward. Source: Ito, Kim, Obinata, "Robust slippage
// degree estimation based on reference update of vision-based tactile sensor", the talk with its
// backup slides; and "Acquisition of contact force and slippage using a vision-based tactile sensor
// with a fluid-type touchpad", eqs. 6-8. Published and corrected forms in docs/errata.md,
// E032-E038.
//
// A dot sticks if it has moved with the object since a reference frame. The reference is a stored
// frame from which the dots have moved far enough in one direction to decide. The steps are in
// stick_steps.hpp. Dots cannot show an object that slides as a whole while the membrane is at rest.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/slip/detail/stick_state.hpp"
#include "fingerpad/slip/stick_result.hpp"
#include "fingerpad/slip/stick_steps.hpp"

namespace fingerpad {
inline namespace v0 {

/// Thresholds of the stick ratio. Lengths are in pitches, so they hold for dots in mm, in m or in
/// px of any camera. The given values apply until the noise of the dots has been measured in frames
/// without contact. Then
///   delta_0  is the distance that a sticking dot exceeds with a probability of 1 %,
///   U        grows with delta_0, so that delta_0 / U does not grow,
///   U_min    is the largest displacement by noise alone, exceeded with a probability of 1 %.
/// U and U_min never fall below the given values.
struct StickTest {
  /// U, > 0. The reference is the newest stored frame from which a dot in contact has moved
  /// further. Published: 2 px of about 20.
  double reference = 0.1;
  /// U_min (not printed), in [0, reference]. A frame is stored when a dot has moved further from
  /// the newest stored one.
  double store = 0.025;
  /// delta_0, > 0. A dot slips if its residual from the object's motion is more than this times
  /// d_max / U. For dots with other noise than the published 0.06 px of 20 see
  /// calibrate/dot_noise.hpp.
  double slip = 0.012;
  /// Pitch in the unit of the dots, >= 0. 0: measured in the first frame of each contact; 1: the
  /// lengths above are in the unit of the dots, as they are where no neighbours are in contact.
  double pitch = 0;
  Index min_dots = 5;  ///< needed to compare two frames, >= 1; with fewer there is no ratio
  /// Free frames that measure the noise, >= 0; 0: the given thresholds always apply.
  Index free_frames = 8;
  /// A contact lost and found again within this time is the same one, and a clock may go back by as
  /// much. In s, >= 0.
  double hold_s = 0.2;
  /// Whether the object is known to be larger than the dot pattern. If not, a contact that contains
  /// all dots has no ratio once more than a tenth of them slip.
  bool covers_pattern = false;
};
inline void expects_valid(const StickTest& test) {
  expects(is_finite(test.reference) && test.reference > 0, "StickTest", "reference", test.reference,
          "finite and > 0");
  expects(is_finite(test.store) && test.store >= 0 && test.store <= test.reference, "StickTest",
          "store", test.store, "in [0, reference]");
  expects(is_finite(test.slip) && test.slip > 0, "StickTest", "slip", test.slip, "finite and > 0");
  expects(is_finite(test.pitch) && test.pitch >= 0, "StickTest", "pitch", test.pitch,
          "finite and >= 0");
  expects(is_finite(test.hold_s) && test.hold_s >= 0, "StickTest", "hold_s", test.hold_s,
          "finite and >= 0");
  expects(test.free_frames >= 0, "StickTest", "free_frames",
          static_cast<long long>(test.free_frames), ">= 0");
  expects(test.min_dots >= 1, "StickTest", "min_dots", static_cast<long long>(test.min_dots),
          ">= 1");
}

/// Stick ratio of a pad, frame by frame.
///   Motion     StickConsensus<>  the motion of all dots that stick together
///   Reference  UpdatedReference  a stored frame far enough back
///   Denoising  ResidualMean      use it for dots found by a camera
///              NoDenoising       use it when their noise is far below `slip`
/// Threads may share one estimator, each with its own state. A frame allocates nothing, throws
/// nothing, and takes O(rows cols) time, plus O(dots in contact) for each stored frame that it
/// examines; at most `capacity` frames are stored.
template <class Motion = StickConsensus<>,
          class Reference = UpdatedReference,
          class Denoising = ResidualMean,
          scalar S = float>
class StickRatio {
  static_assert(!scalar<Motion>,
                "the scalar comes last: StickRatio<StickConsensus<>, UpdatedReference, "
                "ResidualMean, double>");

 public:
  /// A value: copy it to return to this frame later. It holds all memory that frames need.
  using State = detail::stick::StickState<S>;

  /// For a grid of rows x cols dots. Refuses bad parameters (parameter_error).
  StickRatio(Index rows,
             Index cols,
             const StickTest& test = {},
             const Motion& motion = {},
             const Reference& reference = {},
             const Denoising& denoising = {})
      : test_(test), motion_(motion), reference_(reference), denoising_(denoising) {
    expects_grid_size("StickRatio", rows, cols, 1, reference.capacity);
    expects_valid(test);
    expects_valid(motion);
    expects_valid(reference);
    expects_valid(denoising);
    layout_ = {rows, cols};
  }

  Index rows() const { return layout_.rows; }
  Index cols() const { return layout_.cols; }

  /// The state before any frame.
  State start() const { return State(layout_, reference_.capacity); }

  /// Processes a frame with the dots `dots_px` (NaN: not found), of which those with a true
  /// `contact` touch the object. Writes the state of each dot to `states`.
  template <dot_grid Dots, contact_mask Contact, class States>
  StickRatioResult<S> operator()(const Dots& dots_px,
                                 const Contact& contact,
                                 States&& states,
                                 State& state) const {
    return (*this)(dots_px, contact, states, state, not_a_number<double>());
  }

  /// The same at a time in s. The time distinguishes a contact that flickers from a new one, and a
  /// new recording from a clock that goes back a little.
  template <dot_grid Dots, contact_mask Contact, class States>
  StickRatioResult<S> operator()(const Dots& dots_px,
                                 const Contact& contact,
                                 States&& states,
                                 State& state,
                                 double time_s) const {
    static_assert(writable_grid<States>,
                  "this grid of states is written to: its cells must be assignable");
    const auto dots = as_view(dots_px);
    const auto touch = as_view(contact);
    const auto to = as_view(states);
    const bool accepted = dots.rows() == rows() && dots.cols() == cols() &&
                          same_size(dots, touch) && same_size(dots, to) &&
                          state.layout == layout_ &&
                          state.repository.capacity() == reference_.capacity;
    if (!accepted) {
      return {};
    }
    const bool back = state.clock.goes_back(time_s, test_.hold_s);
    if (back) {
      state.forget();
      state.frame = 0;
    }
    ++state.frame;
    state.given.read(dots, touch);
    measure_noise(state);
    const StickStatus status = look(state);
    StickRatioResult<S>& result = state.result;
    result.status = back ? StickStatus::restarted : status;
    detail::stick::settle_marks(layout_, state.given.touching, state.marks, result, to);
    if (status == StickStatus::updated) {
      const bool outlined =
          test_.covers_pattern || !detail::stick::lacks_outline(result, layout_, state.given);
      result.status = outlined ? status : StickStatus::no_outline;
      result.stick_ratio = outlined ? S(S(static_cast<double>(result.stick)) /
                                        S(static_cast<double>(result.stick + result.slip)))
                                    : not_a_number<S>();
      result.ratio_sd = outlined ? result.ratio_sd : not_a_number<S>();
    }
    return result;
  }

 private:
  using Choice = detail::stick::Choice<S>;

  /// Measures the noise in frames without contact.
  void measure_noise(State& state) const {
    if (!state.given.touching.empty() || test_.free_frames == 0) {
      state.free_dots.interrupt();
    } else if (state.given.count > 0 && !state.clock.touched_within(test_.hold_s)) {
      state.free_dots.add(state.given.found);
      if (state.free_dots.frames() >= test_.free_frames) {
        state.noise_px = state.free_dots.lateral();
      }
    }
  }

  /// Noise in the free frames. It is at least a 2000th of a pitch, because no camera finds dots
  /// better and some files repeat them.
  static double noise_of(const State& state) {
    return (std::max)(state.noise_px, std::sqrt(static_cast<double>(value(state.pitch_sq))) / 2000);
  }

  /// The thresholds for the measured noise; those given if it is not known.
  detail::stick::StickLengths lengths_of(const State& state) const {
    using detail::stick::noise_left_by;
    const double pitch_px = std::sqrt(static_cast<double>(value(state.pitch_sq)));
    const double unit = test_.pitch > 0 ? test_.pitch : pitch_px > 0 ? pitch_px : 1;
    const detail::stick::StickLengths given = {unit * test_.reference, unit * test_.store,
                                               unit * test_.slip};
    const double left = noise_left_by(denoising_);
    if (!(state.noise_px > 0) || !(left > 0)) {
      return given;
    }
    const double noise_px = noise_of(state);
    const double dots = static_cast<double>(state.given.touching.size());
    detail::stick::StickLengths px;
    px.slip = 2 * left * noise_px * std::sqrt(std::log(100.0));
    px.reference = given.reference * (std::max)(1.0, px.slip / given.slip);
    px.store = (std::min)((std::max)(given.store, 2 * noise_px * std::sqrt(std::log(100 * dots))),
                          px.reference);
    return px;
  }

  /// Status of this frame. Fills all of the result but the counts.
  StickStatus look(State& state) const {
    using namespace detail::stick;
    StickRatioResult<S>& result = state.result;
    const auto& touching = state.given.touching;
    result.out_of_place = 0;
    if (touching.empty()) {
      return without_contact(state);
    }
    state.clock.touch();
    const PlacedDots placed = place_dots(state.given, layout_, state.now);
    denoise_positions(denoising_, state.given, layout_, state.now);
    result.out_of_place = placed.out_of_place;
    if (is_not_in_order(placed)) {
      return StickStatus::not_in_order;
    }
    if (placed.dots < test_.min_dots) {
      return state.given.count > 0 ? StickStatus::too_few_dots : StickStatus::no_dots;
    }
    const S pitch_sq = mean_pitch_sq(touching, state.now.data(), layout_);
    if (state.repository.size() == 0) {
      state.pitch_sq = pitch_sq;
    }
    const StickLengths px = lengths_of(state);
    if (is_wrong_scale(pitch_sq, px.reference, px.slip) || is_rescaled(pitch_sq, state.pitch_sq)) {
      state.repository.clear();  // frames in another unit are not comparable
      return StickStatus::wrong_scale;
    }
    const S reference_sq = S(square(px.reference));
    const Choice choice = choose_reference(reference_, touching, state.now.data(), state.repository,
                                           reference_sq, S(square(px.store)));
    result.furthest_px = length(choice.furthest_sq);
    if (choice.standing && choice.age < 0) {
      return StickStatus::standing;
    }
    const bool leap = S(4) * reference_sq < choice.newest_sq;
    if (leap && has_jumped(touching, state.now.data(), state.repository.dots(0), layout_)) {
      return StickStatus::jumped;
    }
    const StickStatus status =
        choice.age < 0 ? StickStatus::no_reference : answer(choice, px, state);
    if (!choice.standing && is_stored(reference_, state.repository)) {
      state.repository.store(state.now, state.frame);
    }
    return status;
  }

  StickStatus without_contact(State& state) const {
    if (state.given.count == 0) {
      return StickStatus::no_dots;
    }
    if (!state.clock.touched_within(test_.hold_s)) {
      state.forget();
      state.free = state.given.found;
    }
    return StickStatus::no_contact;
  }

  /// Compares the frame with the chosen reference.
  StickStatus answer(const Choice& choice,
                     const detail::stick::StickLengths& px,
                     State& state) const {
    using namespace detail::stick;
    const FramePair<S> pair{state.now.data(), state.repository.dots(choice.age),
                            state.given.touching, layout_, choice.furthest_sq};
    if (count_pairs(pair) < test_.min_dots) {
      return StickStatus::too_few_dots;
    }
    if (falls_back(pair.touching, pair.now, pair.then, state.free)) {
      return StickStatus::falls_back;
    }
    const Index reference = first_dot(pair, state);
    const S slip = S(px.slip / px.reference);
    const S slip_sq = slip * slip * choice.furthest_sq;
    const bool mostly_slipped = state.result.stick < state.result.slip;
    const Similarity<S> map = motion_between(motion_, pair, reference, slip_sq, mostly_slipped);
    const double left = noise_left_by(denoising_);
    // of a residual of two frames, for which delta_0 is exceeded with a probability of 1 %
    const double sd_px = px.slip / std::sqrt(2 * std::log(100.0));
    const S variance = mark_dots(denoising_, pair, map, slip_sq, S(sd_px), state.room, state.marks);
    state.stick_center = centroid(pair, state.marks, DotState::stick);
    StickRatioResult<S>& result = state.result;
    result.reference_age = static_cast<Index>(state.frame - state.repository.frame(choice.age));
    result.angle_rad = map.angle_rad();
    result.scale = map.scale();
    result.reference_dot = layout_.dot_at(reference);
    const S known = S(static_cast<double>(count_pairs(pair)));
    result.ratio_sd = left > 0 ? ratio_sd_of(variance, known) : not_a_number<S>();
    return StickStatus::updated;
  }

  static S length(const S& sq) {
    using std::sqrt;
    return S(0) < sq ? S(sqrt(sq)) : S(0);
  }

  StickTest test_;
  Motion motion_;
  Reference reference_;
  Denoising denoising_;
  detail::stick::DotLayout layout_;
};

}  // namespace v0
}  // namespace fingerpad
