// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Trials of the calibrations of slip thresholds. Whole recordings are drawn, because their frames
// are correlated.
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/preslip.hpp"
#include "fingerpad/calibrate/slip.hpp"
#include "fingerpad/calibrate/slip_noise.hpp"
#include "trial_parts.hpp"

namespace replay_many {

namespace {

/// Frames of 7 x 7 dots with 0.06 px of noise: twenty at rest, and six drags in which slip begins
/// at the edge.
struct DotRecordings {
  using Frame = cv::Mat_<cv::Vec2d>;
  static constexpr int size = 7;

  std::vector<Frame> rest;
  std::vector<std::vector<Frame>> drags;

  static DotRecordings of(Chance& chance) {
    Frame still(size, size);
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        still(i, j) = {20.0 * j, 20.0 * i};
      }
    }
    DotRecordings all;
    for (int k = 0; k < 20; ++k) {
      all.rest.push_back(seen(still, chance));
    }
    for (int k = 0; k < 6; ++k) {
      all.drags.emplace_back();
      Frame at = still.clone();
      for (int t = 0; t < 15; ++t) {
        drag(at, 1.2 + 0.1 * k, 95.0 - 5 * t);
        all.drags.back().push_back(seen(at, chance));
      }
    }
    return all;
  }

 private:
  /// Dots outside the radius `holds_px` move half as far as the object.
  static void drag(Frame& dots, double moved_px, double holds_px) {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        const bool sticks = 20 * std::hypot(i - 3, j - 3) < holds_px;
        dots(i, j)[0] += sticks ? moved_px : moved_px / 2;
      }
    }
  }
  static Frame seen(const Frame& dots, Chance& chance) {
    Frame noisy = dots.clone();
    for (cv::Vec2d& dot : noisy) {
      dot += 0.06 * cv::Vec2d(chance.normal(), chance.normal());
    }
    return noisy;
  }
};

}  // namespace

/// The dots' noise, then a choice among five candidates U instead of thirteen.
Trial stick_test() {
  using Data = DotRecordings;
  constexpr int size = Data::size;
  const auto draw = [](const Data& data, Chance& chance) {
    return Data{chance.drawn_from(data.rest), chance.drawn_from(data.drags)};
  };
  const auto fit = [](const Data& data) {
    fingerpad::DotNoiseCalibration at_rest(size, size);
    for (const auto& frame : data.rest) {
      (void)at_rest.add(frame);
    }
    const auto noise = at_rest.fit();
    fingerpad::StickTestCalibration<> calibration(size, size, noise,
                                                  {.candidates = 5, .covers_pattern = true});
    const cv::Mat_<unsigned char> touches(size, size, 255), lifted(size, size, uchar(0));
    double time_s = 0;
    for (const auto& drag : data.drags) {
      for (const auto& frame : drag) {
        (void)calibration.add(frame, touches, time_s += 1.0 / 30);
      }
      (void)calibration.add(drag.back(), lifted, time_s += 1);
      time_s += 1;
    }
    const auto found = calibration.fit().test;
    const double relative = noise.noise_error_px / noise.noise_px;
    return Estimate{
        {found.reference, found.slip, found.store},
        diagonal({none, found.slip * noise.edge_error_px / noise.edge_px, found.store * relative})};
  };
  return trial({"reference_px", "slip_px", "store_px"}, {none, none, none}, 3, Data::of, draw, fit);
}

/// Eight lifts by a trembling hand, with three marked slips each.
Trial preslip() {
  struct Marked {
    std::array<fingerpad::FingerSample<double>, 2> fingers;
    bool slips;
  };
  using Lift = std::vector<Marked>;
  const auto finger = [](double x_mm, fingerpad::Index waves, fingerpad::Index taxel) {
    fingerpad::FingerSample<double> sample;
    sample.status = waves > 0 ? fingerpad::TaxelStatus::vibrating : fingerpad::TaxelStatus::quiet;
    sample.center_x_mm = x_mm;
    sample.center_y_mm = 10;
    sample.waves = waves;
    if (waves > 0) {
      sample.location = taxel;
      sample.add_vibration({waves, taxel, false});
    }
    return sample;
  };
  const auto measure = [=](Chance& chance) {
    std::vector<Lift> lifts(8);
    for (Lift& lift : lifts) {
      for (int k = 0; k < 60; ++k) {
        const bool slips = k % 20 >= 16;
        const double x = 20 + 0.15 * chance.normal() + (slips ? 0.6 : 0.0);
        const auto trembles = static_cast<fingerpad::Index>(chance.uniform() < 0.1 ? 2 : 0);
        const auto waves = slips ? static_cast<fingerpad::Index>(2 + chance.below(3)) : trembles;
        lift.push_back(
            {{finger(x, waves, static_cast<fingerpad::Index>(chance.below(9))), finger(20, 0, 0)},
             slips});
      }
    }
    return lifts;
  };
  const auto fit = [](const std::vector<Lift>& lifts) {
    fingerpad::PreslipCalibration<> calibration(10);
    for (const Lift& lift : lifts) {
      calibration.begin_recording();
      for (const Marked& sample : lift) {
        calibration.add(sample.fingers, sample.slips);
      }
    }
    const auto found = calibration.fit();
    return Estimate{{static_cast<double>(found.options.min_waves),
                     found.options.centroid_tolerance_mm, found.recall()},
                    diagonal({none, none, none})};
  };
  return trial({"min_waves", "centroid_tolerance_mm", "recall"}, {none, none, none}, 6, measure,
               draw_samples, fit);
}

}  // namespace replay_many
