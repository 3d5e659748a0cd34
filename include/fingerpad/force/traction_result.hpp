// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a frame of the traction field says as a whole.
#include "fingerpad/core/detail/point_algebra.hpp"
#include "fingerpad/force/modulus.hpp"
#include "fingerpad/force/traction_status.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// `force_n` and `moment_n_mm` are finite where there is a force (see has_force). Any other number
/// that is not known is NaN.
template <scalar S = double>
struct TractionResult {
  bool accepted =
      false;  ///< false: a grid has another size than the stress-free dots; nothing done
  TractionStatus status = TractionStatus::too_few_dots;
  Point3<S> force_n = detail::missing_point<S>();      ///< that the object exerts on the pad
  Point3<S> moment_n_mm = detail::missing_point<S>();  ///< about the origin
  S mu_t_n_per_mm = not_a_number<S>();                 ///< that was used
  ModulusBalance<S> balance = {};           ///< what the free part says of mu t, whichever was used
  S free_load_rms_mpa = not_a_number<S>();  ///< of the loads on the free part, where there are
                                            ///< none: the error of a single dot's load
  Index dots_in_contact = 0;
  Index dots_summed = 0;    ///< whose loads make the force
  Index dots_left_out = 0;  ///< in contact or in the ring around it, but without a load
  Index dots_bridged = 0;   ///< not found, but put between their neighbours for the sums
  Index dots_loaded = 0;    ///< that have a load in the maps, if there is a modulus
  Index cells_refused = 0;  ///< folded, or stretched beyond measure
  Index cells_slack = 0;    ///< with a tension below 0
  S smallest_tension_n_per_mm = not_a_number<S>();  ///< of all cells

  bool ok() const { return status == TractionStatus::ok; }
  bool has_force() const {
    return ok() || status == TractionStatus::no_contact || status == TractionStatus::incomplete;
  }
};

}  // namespace v0
}  // namespace fingerpad
