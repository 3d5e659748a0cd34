// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The frequency rules of the foam fingers as printed: the first experiment's (grasp_optimise) and
// the second's (grasp_lift), over all pairs of samples of the history. docs/foam/preslip.md.
#include <cstddef>

#include "fingerpad/foam/preslip.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// As printed: a later sample with fewer waves is not silent.
template <scalar S = double>
PreslipOptions<S> preslip_options() {
  PreslipOptions<S> options;
  options.min_waves = 0;
  return options;
}

template <std::size_t Fingers = 2, scalar S = double>
Preslip<GraspOptimise<>, Fingers, AllPairs, S> grasp_optimise(
    const PreslipOptions<S>& options = preslip_options<S>()) {
  return Preslip<GraspOptimise<>, Fingers, AllPairs, S>(options);
}
template <std::size_t Fingers = 2, scalar S = double>
Preslip<GraspLift<>, Fingers, AllPairs, S> grasp_lift(
    const PreslipOptions<S>& options = preslip_options<S>()) {
  return Preslip<GraspLift<>, Fingers, AllPairs, S>(options);
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
