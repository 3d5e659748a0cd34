// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Results and statuses of stick and slip.
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

/// State of a dot.
enum class DotState : std::uint8_t {
  none = 0,  ///< it does not touch the object
  unknown =
      1,      ///< it touches, but is missing now, or was missing or did not touch in the reference
  slip = 2,   ///< it has not moved with the object since the reference
  stick = 3,  ///< it has moved with the object
};

enum class StickStatus : std::uint8_t {
  updated,       ///< the ratio is that of this frame
  standing,      ///< the dots have hardly moved since the newest stored frame
  no_reference,  ///< no stored frame is far enough away in the direction of motion
  falls_back,    ///< the dots move back toward their free places by more than they move sideways:
                 ///< a pad that springs back moves as one, whether it sticks or not
  too_few_dots,  ///< fewer dots to compare than StickTest::min_dots
  no_contact,    ///< nothing touches: after hold_s what was stored is forgotten
  no_dots,       ///< no dot was found: nothing is known, and nothing is forgotten
  wrong_scale,   ///< U is more than half a pitch or less than a 200th of it, or a pitch less than
                 ///< four delta_0, or twice or half what it was: another unit?
  not_in_order,  ///< more than a fifth of the dots in contact are not between their neighbours
  jumped,        ///< the dots are numbered differently than before, all by one place, or with rows
                 ///< and columns or two halves exchanged: the frame is skipped
  restarted,     ///< time went back by more than hold_s: all that was before is forgotten
  no_outline,  ///< every dot that was found touches, up to all sides of the pattern, and more than
               ///< a tenth have not followed: they slip, or lie outside of the contact on a gel
               ///< that is dragged along around it; the ratio is NaN. Give the true contact, or
               ///< say covers_pattern
  refused,     ///< a grid, state or workspace has another size: nothing was done
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

/// Where the status is neither `updated` nor `no_outline`, stick_ratio and what follows
/// `furthest_px` are those of the last frame with an answer.
template <scalar S = float>
struct [[nodiscard]] StickRatioResult {
  StickStatus status = StickStatus::refused;
  Index stick = 0, slip = 0, unknown = 0;  ///< dots in contact, as written to `states`
  Index out_of_place =
      0;  ///< dots in contact that are not between their neighbours: taken as missing
  S furthest_px = S(0);  ///< d_max from the reference; without one from the newest stored frame
  S stick_ratio =
      not_a_number<S>();           ///< sticking dots / known dots, in [0, 1]; NaN: none known yet
  S ratio_sd = not_a_number<S>();  ///< of it, by the noise of the dots near the threshold; NaN with
                                   ///< a printed form, of which it is not known
  Index reference_age = 0;         ///< frames from the reference to the answer
  S angle_rad = S(0);  ///< by which the object has rotated since the reference, from x to y
  S scale = S(1);      ///< alpha: the object is seen 1 / scale as large as in the reference
  DotIndex reference_dot =
      {};  ///< where the search for sticking dots began; row -1: there was none

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
  S sd_mm = not_a_number<S>();  ///< of one component along the surface, level; by the noise alone
};

/// Dots that go back toward their free places: an object that turns round carries them, or one that
/// slides lets them go. The force tells which (friction_limit.hpp), the dots do not.
template <scalar S = double>
struct FallingBack {
  S stick_ratio = not_a_number<S>();  ///< if the object carries them; NaN: they do not fall back
  Index reference_age = 0;            ///< frames since the reference
};

/// Where the status is neither `updated` nor `no_outline`, what follows `back` is that of the
/// last answer.
template <scalar S = double>
struct [[nodiscard]] SpatialStickResult {
  StickStatus status = StickStatus::refused;
  Index stick = 0, slip = 0, unknown = 0;  ///< dots in contact, as written to `states`
  Index out_of_place = 0;    ///< dots in contact that are not between their neighbours: left out
  FallingBack<S> back = {};  ///< where the status is falls_back
  S stick_ratio = not_a_number<S>();  ///< sticking dots / known dots, in [0, 1]; NaN: none yet
  S ratio_sd = not_a_number<S>();     ///< of it, by the noise of the dots near the threshold
  S furthest_mm = S(0);               ///< d_max from the reference
  Index reference_age = 0;            ///< frames from the reference to the answer
  Pose<S> motion = {};                ///< of the object since the reference, if anything sticks

  bool accepted() const { return status != StickStatus::refused; }
  /// Whether the ratio may be used: of this frame, or still that of the last answer.
  bool ok() const { return accepted() && is_finite(stick_ratio); }
  bool updated() const { return status == StickStatus::updated; }
  Index dots_in_contact() const { return stick + slip + unknown; }
};

}  // namespace v0
}  // namespace fingerpad
