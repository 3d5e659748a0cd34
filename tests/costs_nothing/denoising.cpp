// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Denoising of dots in the stick ratio: a dot is judged by itself.
#include "fingerpad/slip/stick_ratio.hpp"

using namespace fingerpad;
using namespace fingerpad::detail;
using namespace fingerpad::detail::stick;

extern "C" void switched_off(const FramePair<float>& pair,
                             const ObjectShift<float>& shift,
                             float slip_sq,
                             Residuals<float>& residuals,
                             aligned_vector<float>& marks) {
  mark_dots(NoDenoising(), pair, shift, slip_sq, residuals, marks);
}

extern "C" void without_effect(const FramePair<float>& pair,
                               const ObjectShift<float>& shift,
                               float slip_sq,
                               Residuals<float>&,
                               aligned_vector<float>& marks) {
  using V = run_vector<float>;
  const V none = V{} + 1.0F, slips = V{} + 2.0F, sticks = V{} + 3.0F;
  for (Index k = pair.run.begin; k < pair.run.end; k += run_step<float>) {
    V x, y;
    shift.residual(load_cells<V, float>(pair.now.x + k), load_cells<V, float>(pair.now.y + k),
                   load_cells<V, float>(pair.then.x + k), load_cells<V, float>(pair.then.y + k), x,
                   y);
    const V length_sq = x * x + y * y;
    const V known = choose(length_sq < slip_sq, sticks, slips);
    store_cells<float>(marks.data() + k,
                       V(choose(length_sq < no_distance_sq<float>(), known, none)));
  }
}
