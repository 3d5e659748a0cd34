// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Motion of an object in contact, from the dots of the membrane in space. Source: Ito, Kim, Nagai,
// Obinata, "Acquisition of tactile information by vision-based tactile sensor for dexterous
// handling of robot hands", III.C, eqs. 13-19; published and corrected forms in docs/errata.md,
// E019-E024.
//
// While nothing slips, the dots in contact move with the object. The published method follows the
// one that has moved furthest, with its eight neighbours; the default uses all of them. Dots in
// space come from spatial_dots(), contact flags from contact_at_dots() (motion/spatial_dots.hpp).
// Dots cannot show that an object slides as a whole, or that it is exchanged for another.
#include <concepts>
#include <cstddef>
#include <utility>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/motion/contact_map.hpp"
#include "fingerpad/motion/detail/dot_frame.hpp"
#include "fingerpad/motion/motion_result.hpp"
#include "fingerpad/motion/spatial_dots.hpp"

namespace fingerpad {
inline namespace v0 {

template <scalar S = double>
struct ObjectMotionOptions {
  /// The contact reference dot is kept until another dot has moved further than it by more than
  /// this, mm, >= 0. 0 as published; noise may then make it flicker between neighbours.
  S reference_margin_mm = S(0);
};

/// Pose of the object in contact, frame by frame.
///   Way   ContactMap  all dots that stick, with the least noise
/// The printed forms are ways too: published/object_motion.hpp. Threads may share one estimator,
/// each with its own state. A frame allocates nothing, throws nothing, and takes O(rows cols) time.
///
/// An object begins with the first frame with enough contact, and ends when no dot is in contact;
/// the next contact is a new object. A frame with contact but without a pose keeps the last pose
/// and gives the reason as its status. The object is found again as soon as enough of the known
/// dots are back in contact.
template <class Way = ContactMap, scalar S = double>
class ObjectMotion {
  static_assert(!scalar<Way>, "the scalar comes last: ObjectMotion<ContactMap, double>");

 public:
  /// A value: copy it to return to this frame later.
  class State {
   public:
    bool has_object() const { return has_object_; }

   private:
    friend class ObjectMotion;
    explicit State(typename Way::template Track<S> track, Index rows, Index cols)
        : track_(std::move(track)), rows_(rows), cols_(cols) {}

    typename Way::template Track<S> track_;
    DotIndex reference_ = {};
    bool has_object_ = false;
    bool has_slid_ = false;  // and no object has begun since
    Index rows_;
    Index cols_;
  };

  /// `initial_mm` are the dots of the free pad; a missing one is never the reference dot. Refuses
  /// bad parameters, and dots that are probably not in mm (parameter_error).
  template <spatial_dot_grid Dots>
  explicit ObjectMotion(const Dots& initial_mm,
                        const ObjectMotionOptions<S>& options = {},
                        const Way& way = {})
      : options_(options), way_(way) {
    expects(is_finite(options.reference_margin_mm) && value(options.reference_margin_mm) >= 0,
            "ObjectMotion", "reference_margin_mm", options.reference_margin_mm, "finite and >= 0");
    const auto from = as_view(initial_mm);
    initial_.rows = from.rows();
    initial_.cols = from.cols();
    expects_grid_size("ObjectMotion", rows(), cols(), 0);
    for (Index i = 0; i < initial_.rows; ++i) {
      for (Index j = 0; j < initial_.cols; ++j) {
        initial_.dots.push_back(detail::motion::spatial<S>(cell_t<Dots>(from(i, j))));
      }
    }
    detail::motion::expects_in_mm(initial_);
    way_.template track<S>(0, 0);  // refuses bad parameters
  }

  Index rows() const { return initial_.rows; }
  Index cols() const { return initial_.cols; }

  /// The state before any contact, with all the memory that frames will need.
  State start() const { return State(way_.template track<S>(rows(), cols()), rows(), cols()); }

  /// Processes a frame with the dots `dots_mm` (NaN: not found), of which those with a true
  /// `contact` touch the object.
  template <spatial_dot_grid Dots, contact_mask Contact>
  ObjectMotionResult<S> operator()(const Dots& dots_mm,
                                   const Contact& contact,
                                   State& state) const {
    const auto dots = as_view(dots_mm);
    const auto flags = as_view(contact);
    if (dots.rows() != rows() || dots.cols() != cols() || !same_size(dots, flags) ||
        state.rows_ != rows() || state.cols_ != cols()) {
      return {};
    }
    return follow(detail::motion::DotFrame<S, decltype(dots), decltype(flags)>(dots, flags), state);
  }

  /// The same if it is known which dots slip, for instance from the stick ratio. Slipping dots
  /// would bias the pose, so they are left out, and entered again where they stick again. If fewer
  /// than a fifth stick, the status is `slipping` and the pose is kept. A new object begins
  /// afterwards, because it is not known how far the first one slid. It begins once more than half
  /// stick: an object that stops sliding sticks with most of its contact at once, so a smaller part
  /// that seems to stick is more likely carried along by a slide.
  template <spatial_dot_grid Dots, contact_mask Contact, contact_mask Slips>
  ObjectMotionResult<S> operator()(const Dots& dots_mm,
                                   const Contact& contact,
                                   const Slips& slips,
                                   State& state) const {
    const auto dots = as_view(dots_mm);
    const auto flags = as_view(contact);
    const auto slipping = as_view(slips);
    if (dots.rows() != rows() || dots.cols() != cols() || !same_size(dots, flags) ||
        !same_size(dots, slipping) || state.rows_ != rows() || state.cols_ != cols()) {
      return {};
    }
    using Frame = detail::motion::DotFrame<S, decltype(dots), decltype(flags)>;
    const detail::motion::SteadyFrame<Frame, decltype(slipping)> frame(Frame(dots, flags),
                                                                       slipping);
    if (frame.slides() || (state.has_slid_ && !frame.holds_most())) {
      ObjectMotionResult<S> result;
      result.status = MotionStatus::slipping;
      fill(state, result);
      forget(state);
      state.has_slid_ = true;
      return result;
    }
    return follow(frame, state);
  }

 private:
  template <class Frame>
  ObjectMotionResult<S> follow(const Frame& frame, State& state) const {
    ObjectMotionResult<S> result;
    result.status = MotionStatus::no_contact;
    if (!frame.any_flagged()) {
      return without_contact(frame.any_found(), state, result);
    }
    result.reference = detail::motion::reference_dot(frame, initial_, state.reference_,
                                                     options_.reference_margin_mm);
    result.reference_changed = state.reference_.exists() && result.reference.exists() &&
                               result.reference != state.reference_;
    state.reference_ = result.reference.exists() ? result.reference : state.reference_;
    if (state.has_object_) {
      result.status = way_.advance(frame, result.reference, state.track_);
    } else {
      result.status = way_.begin(frame, result.reference, state.track_);
      result.begun = state.has_object_ = result.ok();
      state.has_slid_ = state.has_slid_ && !result.begun;
    }
    fill(state, result);
    return result;
  }

  ObjectMotionResult<S> without_contact(bool any_found,
                                        State& state,
                                        ObjectMotionResult<S>& result) const {
    if (any_found || !state.has_object_) {
      forget(state);
    }
    state.has_slid_ = state.has_slid_ && !any_found;
    result.status = any_found ? MotionStatus::no_contact : MotionStatus::no_dots;
    fill(state, result);
    return result;
  }

  /// Forgets the object but keeps the memory, because begin() writes whatever it reads.
  static void forget(State& state) {
    static_cast<detail::motion::Track<S>&>(state.track_) = {};
    state.reference_ = {};
    state.has_object_ = false;
  }

  static void fill(const State& state, ObjectMotionResult<S>& result) {
    const auto& track = state.track_;
    result.dots_used = result.ok() ? track.dots_used : 0;
    result.pose = track.pose;
    result.angles = track.angles;
    result.residual_rms_mm = track.residual_rms_mm;
    if (state.has_object_) {
      result.position_mm = track.pose(track.start_mm);
      result.displacement_mm = result.position_mm - track.start_mm;
    }
  }

  ObjectMotionOptions<S> options_;
  Way way_;
  detail::motion::InitialDots<S> initial_;
};

}  // namespace v0
}  // namespace fingerpad
