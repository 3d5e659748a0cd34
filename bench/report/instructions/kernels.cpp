// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// "kernels NAME CALLS" calls a pixel kernel so many times on the same frame of 320 x 240 pixels.
// bench/report/instructions/count takes the difference between two numbers of calls.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/sampling.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

bool samples(const test::Frame<std::uint8_t>& frame, int step, int calls) {
  const Index rows = frame.red.rows() / step, cols = frame.red.cols() / step;
  test::Image<std::uint16_t> red(rows, cols), green(rows, cols);
  bool done = true;
  for (int k = 0; k < calls; ++k) {
    done &= sample_frame(frame.red, frame.green, step, as_view(red), as_view(green));
  }
  return done;
}

bool depth(const test::Pad& pad, const test::Frame<std::uint8_t>& frame, int calls) {
  auto estimate = pad.estimator<float>({.window_px = 15});
  test::Image<float> depth_mm(pad.rows, pad.cols);
  test::Image<PixelStatus> status(pad.rows, pad.cols);
  bool done = true;
  for (int k = 0; k < calls; ++k) {
    done &= estimate(frame.red, frame.green, depth_mm, status).ok();
  }
  return done;
}

bool contact(const test::Pad& pad, const test::Image<double>& pressed_mm, int calls) {
  test::Image<float> depth_mm(pad.rows, pad.cols);
  for (std::size_t k = 0; k < depth_mm.cells.size(); ++k) {
    depth_mm.cells[k] = static_cast<float>(pressed_mm.cells[k]);
  }
  ContactTest test;
  test.ring_px = 12;
  ContactRegion<> region(pad.camera, pad.rows, pad.cols, test);
  test::Image<std::uint8_t> mask(pad.rows, pad.cols);
  bool done = true;
  for (int k = 0; k < calls; ++k) {
    done &= region(depth_mm, mask).ok();
  }
  return done;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "";
  const int calls = argc > 2 ? std::atoi(argv[2]) : 1;
  const test::Pad pad = test::pad_of(240, 320, 0.1536);
  const auto pressed_mm = pad.pressed_depths(3);
  const auto frame = pad.frame<std::uint8_t>(pressed_mm);
  const bool done = name == "samples3"   ? samples(frame, 3, calls)
                    : name == "samples4" ? samples(frame, 4, calls)
                    : name == "depth"    ? depth(pad, frame, calls)
                    : name == "contact"  ? contact(pad, pressed_mm, calls)
                                         : false;
  return done ? 0 : 1;
}
