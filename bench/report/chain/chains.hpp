// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The chains that the report compares, and the inputs of a frame.
#include <cstdint>

#include "fingerpad/pipeline/fingertip.hpp"

namespace chain {

using fingerpad::Fingertip;
using fingerpad::FingertipOptions;
using fingerpad::FingertipResult;
using fingerpad::Index;
using fingerpad::Point2;

/// The cheapest chain for a flat contact on a pad with dark dots, whose edge is not placed.
inline FingertipOptions lean(FingertipOptions options) {
  options.sampling = 4;
  options.contact.places_edge = false;
  return options;
}
/// The same in samples of `step` x `step` pixels.
inline FingertipOptions in_samples(FingertipOptions options, int step) {
  options.sampling = step;
  return options;
}

/// Data of a camera, a dot finder and a pressure gauge for one frame.
struct Inputs {
  fingerpad::StridedView<const std::uint8_t> red, green;
  fingerpad::StridedView<const Point2<double>> dots_px;
  double pressure_mpa = 0;
};

inline FingertipResult touch_of(Fingertip& fingertip, const Inputs& in) {
  return fingertip(in.red, in.green, in.dots_px, in.pressure_mpa);
}

}  // namespace chain
