// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Denoising of dots in the stick ratio: without it, each dot is judged by itself.
#include "fingerpad/slip/stick_ratio.hpp"

using namespace fingerpad;
using namespace fingerpad::detail::stick;

extern "C" float switched_off(const FramePair<float>& pair,
                              const Similarity<float>& map,
                              float slip_sq,
                              float sd,
                              MarkingRoom<float>& room,
                              std::vector<DotState>& marks) {
  return mark_dots(NoDenoising(), pair, map, slip_sq, sd, room, marks);
}

extern "C" float without_effect(const FramePair<float>& pair,
                                const Similarity<float>& map,
                                float slip_sq,
                                float sd,
                                MarkingRoom<float>&,
                                std::vector<DotState>& marks) {
  float variance = 0;
  for (const Index k : pair.touching) {
    const Point2<float> r = map.residual(pair.now[k], pair.then[k]);
    const float length_sq = r.x * r.x + r.y * r.y;
    marks[static_cast<std::size_t>(k)] = !(length_sq < 1e18F)  ? DotState::unknown
                                         : length_sq < slip_sq ? DotState::stick
                                                               : DotState::slip;
    const float doubt = doubt_of(length_sq, slip_sq, sd);
    variance = variance + doubt * doubt;
  }
  return variance;
}
