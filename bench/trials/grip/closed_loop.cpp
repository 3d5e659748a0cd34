// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Controls the grip force on a cup that is filled while a fingertip holds it by friction. Its
// weight and the friction are unknown. With the grip force from the stick ratio of the dots the cup
// is held; with a constant force it drops. Usage: closed_loop_grip [CHART.png], which also draws
// both runs.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "bench/trials/grip/camera.hpp"
#include "bench/trials/grip/grip_chart.hpp"
#include "bench/trials/grip/slipping_load.hpp"
#include "fingerpad/slip/grip_control.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace {

constexpr int n = 21;  // dots in each direction
constexpr double frame_s = 1.0 / 30;
constexpr double dropped_mm = 20;
const fingerpad::GripOptions<> options{.raise_gain_n_per_s =
                                           20};  // low, because the cup fills slowly

/// Load on the fingertip, N: the cup is filled for 13 s, then held.
double load_at(double time_s) {
  return 0.4 + 0.2 * std::clamp(time_s - 1, 0.0, 13.0);
}

grip::Run run(bool controlled) {
  fingerpad::StickRatio stick_ratio(n, n);       // once
  fingerpad::GripControl control(options, 1.5);  // N, when the cup was grasped

  double force_n = control.force_n();
  grip::SlippingLoad load({.dots = n}, load_at(0), force_n);
  grip::Camera camera(n);
  grip::Run record;
  for (int frame = 0; frame < 480 && load.slip_mm() < dropped_mm; ++frame) {
    const double time_s = frame * frame_s;
    load.advance(load_at(time_s), force_n, frame_s);
    camera.look_at(load);
    const auto stick = stick_ratio(camera.dots(), camera.touch());
    const double ratio = stick.stick_ratio;
    const auto grip = control(stick, frame_s);
    record.push_back(
        {time_s, load_at(time_s), load.friction_limit_n(), force_n, ratio, load.slip_mm()});
    if (controlled) {
      force_n = grip.force_n;
    }
  }
  return record;
}

void print(const char* name, const grip::Run& record) {
  std::printf("%s\n  time s   load N   grip N   stick ratio   slip mm\n", name);
  for (std::size_t k = 0; k < record.size(); k += 60) {
    const auto& m = record[k];
    std::printf("%8.1f %8.2f %8.2f %13.2f %9.3f\n", m.time_s, m.load_n, m.force_n, m.stick_ratio,
                m.slip_mm);
  }
  const auto& last = record.back();
  std::printf("%8.1f %8.2f %8.2f %13.2f %9.3f  %s\n\n", last.time_s, last.load_n, last.force_n,
              last.stick_ratio, last.slip_mm, last.slip_mm < dropped_mm ? "held" : "dropped");
}

}  // namespace

int main(int count, char** words) {
  const auto with = run(true);
  const auto without = run(false);
  print("grip force from the stick ratio", with);
  print("constant grip force", without);
  if (count > 1 && !cv::imwrite(words[1], grip::grip_chart(with, without, options.set_point))) {
    std::fprintf(stderr, "%s: cannot be written\n", words[1]);
    return 1;
  }
  const bool held = with.back().slip_mm < 0.5;
  const bool dropped = without.back().slip_mm >= dropped_mm;
  return held && dropped ? 0 : 1;
}
