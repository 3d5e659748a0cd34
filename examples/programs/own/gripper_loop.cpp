// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Runs the control loop of a gripper on a recording in real time: each frame arrives at its
// recorded time, and the grip force is computed before the next. A rod is pressed in, then dragged
// until it slides. Usage: gripper_loop [RECORDING]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "fingerpad/slip/grip_control.hpp"
#include "replay/dots/dots.hpp"
#include "replay/steps/fingertip_options.hpp"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const std::filesystem::path folder = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  replay::Recording recording = replay::open_recording(folder);
  if (const auto lacking = replay::lacking_for_wrench(recording); !lacking.empty()) {
    std::fprintf(stderr, "no six-axis force: %s\n", lacking.c_str());
    return 1;
  }
  replay::DotSource dots(folder, recording.sensor, recording.reference, recording.reference_depth,
                         recording.frames.size());
  const auto settings = replay::fingertip_settings(recording, dots.initial());
  replay::RecordedFingertip fingertip(settings.options);
  fingerpad::GripControl<> control({}, 3);  // N

  double last_s = 0, worst_ms = 0, raised_n = 0;
  const auto begin = Clock::now();
  for (int k = 0; k < recording.frames.size(); ++k) {
    const double time_s = std::atof(recording.signals.time_s(k).c_str());
    const cv::Mat frame = recording.frames.next();
    std::this_thread::sleep_until(begin + std::chrono::duration<double>(time_s));

    const auto came = Clock::now();
    const auto seen = dots.of(k, frame);
    const auto touch =
        fingertip(frame, seen, recording.signals.pressure_mpa(k), time_s, dots.side());
    // Recorded forces do not react to the grip, so only the stick ratio is used here. On a real
    // hand pass touch.slip itself; the grip force then follows the load.
    const auto answer = control(touch.slip.stick_ratio, touch.slip.update, time_s - last_s);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - came).count();

    std::printf("%.1f s  stick ratio %4.2f  grip %5.2f N  computed in %5.1f ms\n", time_s,
                touch.slip.stick_ratio, answer.force_n, ms);
    raised_n = touch.slip.stick_ratio < 0.5 ? answer.force_n : raised_n;
    worst_ms = (std::max)(worst_ms, ms);
    last_s = time_s;
  }
  std::printf("the slowest frame took %.1f ms; the grip force rose to %.1f N during the slide\n",
              worst_ms, raised_n);
  return raised_n > 4 ? 0 : 1;
}
