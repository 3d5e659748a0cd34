// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which dots must not count for the pose of the object (motion/object_motion.hpp): those that slip,
// and the whole contact where too little of it is sure to stick. A pose given during a slide is
// wrong from then on, but a frame without a pose costs only that frame. So doubt counts as slip.
#include <utility>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/grip_law.hpp"
#include "fingerpad/slip/stick_result.hpp"

namespace fingerpad {
inline namespace v0 {

/// Writes to `slips` which dots to leave out of the object's motion, from the results of this frame
/// and the dots' `states`:
///   - all, if the object slides by friction, or if the dots' ratio is not above a fifth by two of
///     its standard deviations;
///   - none, if the load shows that the object carries dots that fall back, and more than half
///     stick. `states` are then those from before the reversal; the few dots that slip since have
///     little weight in the fit of the motion.
///   - otherwise those whose state is `slip`.
/// Returns false and writes nothing if the grids differ in size. Allocates nothing.
template <scalar S, grid States, class Slips>
bool slipping_dots(const SpatialStickResult<S>& stick,
                   const SlipResult<S>& slip,
                   const States& states,
                   Slips&& slips) {
  static_assert(writable_grid<Slips, bool>,
                "this grid is written to: its cells must be assignable");
  const auto from = as_view(states);
  const auto to = as_view(std::forward<Slips>(slips));
  if (!same_size(from, to)) {
    return false;
  }
  const bool by_friction = slip.status == FrictionLimitStatus::sliding;
  const bool in_doubt =
      stick.updated() && !(stick.stick_ratio - S(2) * stick.ratio_sd > S(1) / S(5));
  const bool all = by_friction || in_doubt;
  const bool carried =
      slip.falls_back && slip.update == RatioUpdate::fresh && S(2) * slip.stick_ratio > S(1);
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j) {
      const bool slipped = from(i, j) == DotState::slip;
      to(i, j) = static_cast<cell_t<Slips>>(all || (slipped && !carried));
    }
  }
  return true;
}

/// The same without forces.
template <scalar S, grid States, class Slips>
bool slipping_dots(const SpatialStickResult<S>& stick, const States& states, Slips&& slips) {
  return slipping_dots(stick, SlipResult<S>{}, states, std::forward<Slips>(slips));
}

}  // namespace v0
}  // namespace fingerpad
