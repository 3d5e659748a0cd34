// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Results and statuses of the stick ratio.
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

/// State of a dot.
enum class DotState : std::uint8_t {
  none = 0,  ///< not in contact
  unknown =
      1,      ///< in contact, but missing now, or it was missing or not in contact in the reference
  slip = 2,   ///< it has not moved with the object since the reference
  stick = 3,  ///< it has moved with the object
};

enum class StickStatus : std::uint8_t {
  updated,       ///< the ratio is that of this frame
  standing,      ///< the dots have hardly moved since the newest stored frame
  no_reference,  ///< no stored frame is far enough away in the direction of motion
  /// The dots move back toward their free positions by more than they move sideways. A pad that
  /// springs back moves as a whole, whether it sticks or not.
  falls_back,
  too_few_dots,  ///< fewer dots to compare than StickTest::min_dots
  no_contact,    ///< nothing touches; after hold_s all stored frames are dropped
  no_dots,       ///< no dot was found: nothing is known, and nothing is dropped
  /// U is more than half a pitch or less than a 200th of it, or a pitch is less than four delta_0,
  /// or more than twice or less than half what it was: another unit?
  wrong_scale,
  not_in_order,  ///< more than a fifth of the dots in contact are not between their neighbours
  /// The dots are labelled differently than before: all shifted by one place, rows and columns
  /// exchanged, or two halves exchanged. The frame is skipped.
  jumped,
  restarted,  ///< time went back by more than hold_s: everything before is dropped
  /// Every dot that was found is in contact, up to all sides of the pattern, and more than a tenth
  /// have not followed the object. Either they slip, or they lie outside of the contact on a gel
  /// that is dragged along around it. The ratio is NaN. Give the true contact, or set
  /// covers_pattern.
  no_outline,
  refused,  ///< a grid, state or workspace has another size: nothing was done
};

/// "updated", "standing", ...
constexpr const char* name_of(StickStatus status) {
  switch (status) {
    case StickStatus::updated:
      return "updated";
    case StickStatus::standing:
      return "standing";
    case StickStatus::no_reference:
      return "no reference";
    case StickStatus::falls_back:
      return "falls back";
    case StickStatus::too_few_dots:
      return "too few dots";
    case StickStatus::no_contact:
      return "no contact";
    case StickStatus::no_dots:
      return "no dots";
    case StickStatus::wrong_scale:
      return "wrong scale";
    case StickStatus::not_in_order:
      return "not in order";
    case StickStatus::jumped:
      return "jumped";
    case StickStatus::restarted:
      return "restarted";
    case StickStatus::no_outline:
      return "no outline of the contact";
    case StickStatus::refused:
      return "refused";
  }
  return "unknown";
}

/// Result of a frame. If the status is neither `updated` nor `no_outline`, stick_ratio and all
/// below it are those of the last frame with an answer.
template <scalar S = float>
struct [[nodiscard]] StickRatioResult {
  StickStatus status = StickStatus::refused;
  Index stick = 0, slip = 0, unknown = 0;  ///< dots in contact, as written to `states`
  Index out_of_place =
      0;  ///< dots in contact that are not between their neighbours; they count as missing
  /// d_max, the largest displacement from the reference; without one, from the newest stored frame.
  S furthest_px = S(0);
  S stick_ratio =
      not_a_number<S>();  ///< sticking dots / known dots, in [0, 1]; NaN: none known yet
  /// Standard deviation of stick_ratio due to the noise of the dots near the threshold. NaN with a
  /// printed denoising, for which it is not known.
  S ratio_sd = not_a_number<S>();
  Index reference_age = 0;  ///< frames from the reference to the answer
  S angle_rad = S(0);       ///< rotation of the object since the reference, from x to y
  S scale = S(1);           ///< alpha: the object appears 1 / scale as large as in the reference
  DotIndex reference_dot =
      {};  ///< dot at which the search for sticking dots began; row -1: there was none

  bool accepted() const { return status != StickStatus::refused; }
  /// Whether the ratio may be used: of this frame, or still that of the last answer.
  bool ok() const { return accepted() && is_finite(stick_ratio); }
  bool updated() const { return status == StickStatus::updated; }
  Index dots_in_contact() const { return stick + slip + unknown; }
};

/// Slip of a dot along the surface since the reference.
template <scalar S = double>
struct DotSlip {
  Point3<S> slip_mm = {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
  S sd_mm = not_a_number<S>();  ///< of one component along the surface, level; due to noise alone
};

/// Dots that move back toward their free positions. Either an object that reverses carries them, or
/// one that slides lets them go. The dots do not show which; the force does (friction_limit.hpp).
template <scalar S = double>
struct FallingBack {
  S stick_ratio = not_a_number<S>();  ///< if the object carries them; NaN: they do not fall back
  Index reference_age = 0;            ///< frames since the reference
};

/// Result of a frame. If the status is neither `updated` nor `no_outline`, all below `back` is that
/// of the last answer.
template <scalar S = double>
struct [[nodiscard]] SpatialStickResult {
  StickStatus status = StickStatus::refused;
  Index stick = 0, slip = 0, unknown = 0;  ///< dots in contact, as written to `states`
  Index out_of_place = 0;    ///< dots in contact that are not between their neighbours: left out
  FallingBack<S> back = {};  ///< if the status is falls_back
  S stick_ratio = not_a_number<S>();  ///< sticking dots / known dots, in [0, 1]; NaN: none yet
  /// Its standard deviation due to noise: of the dots near the threshold, and of the motion fitted
  /// to those that stick. An error of the model is not included.
  S ratio_sd = not_a_number<S>();
  S furthest_mm = S(0);     ///< d_max, the largest displacement from the reference
  Index reference_age = 0;  ///< frames from the reference to the answer
  Pose<S> motion = {};      ///< of the object since the reference, if anything sticks

  bool accepted() const { return status != StickStatus::refused; }
  /// Whether the ratio may be used: of this frame, or still that of the last answer.
  bool ok() const { return accepted() && is_finite(stick_ratio); }
  bool updated() const { return status == StickStatus::updated; }
  Index dots_in_contact() const { return stick + slip + unknown; }
};

}  // namespace v0
}  // namespace fingerpad
