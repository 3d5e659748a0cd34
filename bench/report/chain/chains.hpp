// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The three chains that the report compares, and the inputs of a frame.
#include <array>
#include <cstdint>

#include "crew.hpp"
#include "fingerpad/pipeline/fingertip.hpp"

namespace chain {

using fingerpad::FingertipResult;
using fingerpad::FingertipStage;
using fingerpad::Point2;
using fingerpad::Point3;

constexpr std::array<const char*, 7> stage_names = {
    "smoothing, depth", "contact region",  "object motion", "stick ratio",
    "look-up forces",   "heights in plan", "wrench"};

struct ByDefault : fingerpad::FingertipMethods {};
/// The cheapest methods for a flat contact on a pad with dark dots, whose edge is not placed.
struct Lean : ByDefault {
  static constexpr int sampling = 4;
};
/// The same in samples of Step x Step pixels.
template <class Methods, int Step>
struct InSamples : Methods {
  static constexpr int sampling = Step;
};
/// The same with two threads.
template <class Methods>
struct Shared : Methods {
  using Executor = TwoThreads;
};

/// Data of a camera, a dot finder and a pressure gauge for one frame.
struct Inputs {
  fingerpad::ColorFrame<fingerpad::StridedView<const std::uint8_t>,
                        fingerpad::StridedView<const std::uint8_t>>
      image;
  fingerpad::StridedView<const Point2<double>> dots_px;
  fingerpad::StridedView<const Point3<double>> side_dots_mm;
  double pressure_mpa = 0;
};

template <class Fingertip, class... Watch>
FingertipResult touch_of(Fingertip& fingertip, const Inputs& in, Watch&&... watch) {
  return fingertip(in.image, in.dots_px, in.side_dots_mm, in.pressure_mpa,
                   fingerpad::not_a_number<double>(), watch...);
}

}  // namespace chain
