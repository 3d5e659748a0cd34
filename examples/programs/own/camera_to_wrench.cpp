// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes six-axis force and moment from camera frames, and compares them with the true forces of
// the recording.
// Usage: camera_to_wrench [RECORDING], a folder with sensor.json as `calibrate` writes it.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "replay/dots/dots.hpp"
#include "replay/steps/fingertip_options.hpp"

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  replay::Recording recording = replay::open_recording(folder);
  if (const auto lacking = replay::lacking_for_wrench(recording); !lacking.empty()) {
    std::fprintf(stderr, "no six-axis force: %s\n", lacking.c_str());
    return 1;
  }

  // Once: dots of the free pad, and a fingertip as sensor.json describes it.
  replay::DotSource dots(folder, recording.sensor, recording.reference, recording.reference_depth,
                         recording.frames.size());
  const auto settings = replay::fingertip_settings(recording, dots.initial());
  replay::RecordedFingertip fingertip(settings.options);

  // Every frame.
  double worst_n = 0;
  std::printf("frame   force N                 moment N mm              true force N\n");
  for (int k = 0; k < recording.frames.size(); ++k) {
    const cv::Mat frame = recording.frames.next();
    const auto seen = dots.of(k, frame);
    const auto touch =
        fingertip(frame, seen, recording.signals.pressure_mpa(k), 0.1 * k, dots.side());
    const auto &f = touch.wrench.force_n, &m = touch.wrench.moment_n_mm;
    std::printf("%5d %7.3f %7.3f %7.3f %8.2f %7.2f %7.2f", k, f.x, f.y, f.z, m.x, m.y, m.z);
    if (const auto truth = recording.true_forces.find(k); truth != recording.true_forces.end()) {
      const auto& t = truth->second.force_n;
      std::printf(" %8.3f %7.3f %7.3f", t.x, t.y, t.z);
      worst_n = std::fmax(worst_n, norm(f - t));
    }
    std::printf("  %s\n", name_of(touch.wrench.status));
  }
  std::printf("largest error %.2f N\n", worst_n);
  return worst_n > 0 && worst_n < 0.3 ? 0 : 1;
}
