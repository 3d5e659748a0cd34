// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The core as a program of this machine: plays the demo and checks what is measured against what is
// true. With --print it prints every number of each tenth frame, which docs/playground/test
// compares with WebAssembly's.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

#include "core.h"

namespace {

std::map<std::string, double> numbers() {
  std::map<std::string, double> all;
  std::istringstream names(pad_names());
  std::string name;
  for (int k = 0; std::getline(names, name, ','); ++k) {
    all[name] = pad_numbers()[k];
  }
  return all;
}

int failures = 0;

void expect(bool good, const char* what, int is_ball, int frame) {
  if (!good) {
    std::fprintf(stderr, "%s, frame %d: %s\n", is_ball ? "ball" : "plate", frame, what);
    ++failures;
  }
}

/// Bounds: shot noise of half a grey level over windows of 15 px leaves 0.02 mm of depth, gaps of
/// 20 um count as touching and widen the contact by 0.5 mm, and the normal force goes with its
/// area. Where dots at the contact's edge slip, the look-up finds less than the drag; its moment is
/// that of a plate.
void check(int is_ball, int frame) {
  auto n = numbers();
  const auto off = [&](const char* what) {
    return std::abs(n[what] - n[std::string("true_") + what]);
  };
  const auto require = [&](bool good, const char* what) { expect(good, what, is_ball, frame); };
  require(n["depth_error_mm"] < 0.04, "depth");
  if (frame >= 30 && frame < 216) {
    require(off("press_mm") < 0.1, "press");
    require(off("force_x_n") < 0.2 && off("force_y_n") < 0.2, "force along the pad");
    require(off("force_z_n") < 0.2 * -n["true_force_z_n"], "force along z");
    require(off("moment_z_n_mm") < (is_ball ? 1 : 0.3), "moment");
  }
  if (frame >= 30 && frame < 90) {
    require(off("turn_deg") < 1, "turn");
  }
}

/// Mean of the stick ratio from frame to frame, over which the noise of single dots evens out. Of a
/// plate: under the ball are few dots, and when it slides as a whole they stand still.
class MeanRatio {
 public:
  MeanRatio(int from, int to) : from_(from), to_(to) {}
  void add(int frame) {
    if (frame >= from_ && frame < to_) {
      sum_ += numbers()["stick_ratio"];
    }
  }
  double value() const { return sum_ / (to_ - from_); }

 private:
  int from_, to_;
  double sum_ = 0;
};

void print(int is_ball, int frame) {
  for (const auto& [name, value] : numbers()) {
    std::printf("%d %d %s %.17g\n", is_ball, frame, name.c_str(), value);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool prints = argc > 1 && std::strcmp(argv[1], "--print") == 0;
  for (const int is_ball : {0, 1}) {
    pad_start();
    pad_demo_frame(100, is_ball, 0.5);  // as when the demo is played again, the clock goes back
    MeanRatio held(30, 40), slid(120, 160);
    for (int frame = 0; frame < 240; ++frame) {
      pad_demo_frame(frame / 30.0, is_ball, 0.5);
      check(is_ball, frame);
      held.add(frame);
      slid.add(frame);
      if (prints && frame % 10 == 0) {
        print(is_ball, frame);
      }
    }
    expect(is_ball || held.value() > 0.85, "a plate that is held", is_ball, 40);
    expect(is_ball || slid.value() < 0.25, "a plate that slides", is_ball, 160);
  }
  return failures == 0 ? 0 : 1;
}
