// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Checks whether the force gauge is rotated against the image: the dots move along with the force.
#include <cmath>

#include "fingerpad/calibrate/look_up.hpp"
#include "replay/check/parts.hpp"
#include "replay/dots/dots.hpp"

namespace replay {
namespace {

using Sample = fingerpad::ForceSample<double>;

/// Mean displacement of the dots and tangential force for each frame with a known force. The means
/// over these frames are subtracted, because they contain the effect of the press alone.
std::vector<Sample> drags_of(const std::filesystem::path& folder, Recording& recording) {
  constexpr int most_frames = 300;  // at most this many are used
  DotSource source(folder, recording.sensor, recording.reference, recording.reference_depth,
                   recording.frames.size());
  std::vector<Sample> samples;
  if (!source.present()) {
    return samples;
  }
  const DotGrid free = source.initial();
  Sample mean{.displacement_mm = {0, 0}, .tangential_force_n = {0, 0}};
  DamagedFrames damaged;
  recording.frames.seek(0);
  for (int k = 0; k < (std::min)(recording.frames.size(), most_frames); ++k) {
    const cv::Mat frame = next_whole_frame(recording.frames, recording.reference.size(), damaged);
    if (frame.empty()) {
      continue;
    }
    const DotGrid dots = source.of(k, frame);
    const auto force = recording.true_forces.find(k);
    cv::Vec2d way(0, 0);
    int count = 0;
    for (int n = 0; n < static_cast<int>(dots.total()); ++n) {
      const cv::Vec2d by = dots(n / dots.cols, n % dots.cols) - free(n / dots.cols, n % dots.cols);
      if (is_present(by)) {
        way += by;
        ++count;
      }
    }
    if (force != recording.true_forces.end() && 2 * count > static_cast<int>(dots.total())) {
      const auto& f = force->second.force_n;
      samples.push_back({.measure = 1,  // not used
                         .displacement_mm = {way[0] / count, way[1] / count},
                         .tangential_force_n = {f.x, f.y}});
      mean.displacement_mm += samples.back().displacement_mm;
      mean.tangential_force_n += samples.back().tangential_force_n;
    }
  }
  const double share = 1 / static_cast<double>(samples.size());
  for (Sample& s : samples) {
    s.displacement_mm = s.displacement_mm - share * mean.displacement_mm;
    s.tangential_force_n = s.tangential_force_n - share * mean.tangential_force_n;
  }
  return samples;
}

}  // namespace

void check_gauge(const std::filesystem::path& folder, Recording& recording, Findings& findings) {
  double along_n = 0;
  for (const auto& [frame, truth] : recording.true_forces) {
    along_n = std::fmax(along_n, std::hypot(truth.force_n.x, truth.force_n.y));
  }
  if (along_n < 0.05) {
    return;
  }
  const std::string remedy = "Rotate the gauge, or rotate its columns x and y.";
  const std::vector<Sample> drags = drags_of(folder, recording);
  if (drags.size() < 3) {
    return;
  }
  try {
    const auto fit = fingerpad::fit_tangential_force(std::span<const Sample>(drags), 1, 0.0);
    constexpr double degrees = 180 / CV_PI;
    const double angle = degrees * fit.gauge_angle_rad, sd = degrees * fit.gauge_angle_sd_rad;
    constexpr double most = 6;  // the response of a pad is not quite linear
    if (!std::isfinite(sd)) {
      findings.push_back({"forces.csv",
                          "the dots move along one line, so a rotation of the gauge cannot be "
                          "detected",
                          "Drag in several directions.", false});
    } else if (std::abs(angle) > std::fmax(most, 3 * sd)) {
      findings.push_back({"forces.csv",
                          "the forces are rotated by " + short_number(std::round(angle)) + " +- " +
                              short_number(std::ceil(sd)) +
                              " degrees against the motion of the dots",
                          remedy});
    }
  } catch (const fingerpad::parameter_error& error) {
    findings.push_back({"forces.csv", error.what(), remedy});
  }
}

}  // namespace replay
