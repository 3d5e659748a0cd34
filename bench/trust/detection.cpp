// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// detection [FRAMES]: how often a free pad seems touched, and how small a dent is found, by noise.
// The published pad in samples of 3 x 3 pixels, as a fingertip has them; threshold from 16 free
// frames, window and ring wider where noise demands it, as `calibrate contact` chooses them. Prints
// the table of docs/detection_limits.md.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/depth/sampling.hpp"
#include "support/image.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr int step = 3;
constexpr double pressure_mpa = 0.004, infinite = std::numeric_limits<double>::infinity();

/// A dent by a ball of this radius (infinite: a plate; negative: hollow) that touches a disc of
/// this radius: of a shallow membrane with the tension that its pressure gives it.
struct Dent {
  double touches_mm = 0, ball_mm = infinite;

  double flattening(const test::Pad& pad) const {
    return 1 / pad.sphere_radius_mm + 1 / ball_mm;  // 1/mm
  }
  double depth_mm(const test::Pad& pad) const { return at(pad, 0); }
  double at(const test::Pad& pad, double r_mm) const {
    const double a = touches_mm, per = flattening(pad);
    return r_mm > a
               ? a * a * per * std::log(pad.base_radius_mm() / r_mm)
               : a * a * per * std::log(pad.base_radius_mm() / a) + (a * a - r_mm * r_mm) * per / 2;
  }
  double force_n(const test::Pad& pad) const {
    return pressure_mpa * std::numbers::pi * touches_mm * touches_mm *
           (1 + pad.sphere_radius_mm / ball_mm);
  }
};

/// A finger at one noise of the camera.
class Finger {
 public:
  Finger(double brightness, double noise) : noise_(std::sqrt(noise * noise + 1.0 / 12) / step) {
    pad_.rows = 160;
    pad_.cols = 213;
    pad_.camera.pitch_mm = 0.08 * step;
    pad_.camera.center_x_px = 106;
    pad_.camera.center_y_px = 79.5;
    pad_.scattering *= brightness / pad_.brightness;
    pad_.brightness = brightness;
    free_ = clean(pad_.free_depths());
    const auto mean = exposed(free_, noise_ / 4);
    const auto reference =
        fit_reference<float>(pad_.camera, pad_.fluid, mean.red, mean.green, pad_.free_depths());
    ContactTest test;
    test.min_region_px = 23;
    for (int wider = 0; wider <= 8 && test.threshold_per_mm < 0.4 * median_per_mm_; ++wider) {
      window_px = 29 + 6 * ((wider + 1) / 2);
      ring_px = 25 * square(1 + 6.0 * (wider / 2) / 29);
      estimator_.emplace(pad_.camera, pad_.fluid, reference,
                         DepthOptions{.window_px = window_px, .step = step});
      std::vector<Image<float>> frames;
      for (int k = 0; k < 16; ++k) {
        frames.push_back(depth_of(free_));
      }
      test.ring_px = ring_px / step;
      try {
        const auto fit = fit_contact_threshold(pad_.camera, frames, test.ring_px, test.directions,
                                               test.min_region_px);
        test.threshold_per_mm = fit.threshold_per_mm;
        test.faint_per_mm = fit.faint_per_mm;
        median_per_mm_ = fit.median_per_mm;
      } catch (const parameter_error&) {  // all noise
      }
    }
    threshold_per_mm = test.threshold_per_mm;
    faint_per_mm = test.faint_per_mm;
    region_.emplace(pad_.camera, pad_.rows, pad_.cols, test);
  }

  int window_px = 0;
  double ring_px = 0, threshold_per_mm = 0, faint_per_mm = 0;

  /// Share of `frames` in which something seems to touch.
  double touched(const test::Frame<double>& frame, int frames) {
    Image<std::uint8_t> mask(pad_.rows, pad_.cols);
    int count = 0;
    for (int k = 0; k < frames; ++k) {
      const auto depth_mm = depth_of(frame);
      count += (*region_)(depth_mm, mask).in_contact() ? 1 : 0;
    }
    return static_cast<double>(count) / frames;
  }
  double touched_free(int frames) { return touched(free_, frames); }

  /// Depth in mm and force in mN of the smallest dent that is found in 18 of 20 frames; its contact
  /// grows by a fifth each time, up to 10 mm.
  std::string smallest(double ball_mm) {
    for (Dent dent{0.5, ball_mm}; dent.touches_mm < 10; dent.touches_mm *= 1.2) {
      if (touched(clean(dented(dent)), 20) >= 0.9) {
        char text[32];
        std::snprintf(text, sizeof text, "%.2f; %.0f", dent.depth_mm(pad_),
                      1000 * dent.force_n(pad_));
        return text;
      }
    }
    return "none";
  }

 private:
  Image<double> dented(const Dent& dent) const {
    auto depth_mm = pad_.free_depths();
    for (Index i = 0; i < pad_.rows; ++i) {
      for (Index j = 0; j < pad_.cols; ++j) {
        const auto ray = pad_.ray(i, j);
        const double r = ray.plate_rho_mm + ray.tan_fluid * depth_mm(i, j);
        depth_mm(i, j) = (std::max)(depth_mm(i, j) - dent.at(pad_, r), 0.0);
      }
    }
    return depth_mm;
  }
  test::Frame<double> clean(const Image<double>& depth_mm) const {
    return pad_.frame<double>(depth_mm);
  }
  test::Frame<float> exposed(const test::Frame<double>& of, double sd) {
    test::Frame<float> out(pad_.rows, pad_.cols);
    for (std::size_t k = 0; k < of.red.cells.size(); ++k) {
      if (of.red.cells[k] > 0) {
        out.red.cells[k] = static_cast<float>(of.red.cells[k] + sd * random_.normal());
        out.green.cells[k] = static_cast<float>(of.green.cells[k] + sd * random_.normal());
      }
    }
    return out;
  }
  Image<float> depth_of(const test::Frame<double>& of) {
    return test::estimate(*estimator_, exposed(of, noise_)).depth_mm;
  }

  test::Pad pad_;
  double noise_;
  double median_per_mm_ = infinite;  // of the free pad
  test::Random random_{1};
  test::Frame<double> free_{0, 0};
  std::optional<DepthEstimator<float>> estimator_;
  std::optional<ContactRegion<>> region_;
};

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 10000;
  std::printf(
      "| brightness | noise, levels | window, ring, px | thresholds, 1/mm | free frames with "
      "contact, "
      "of %d | plate, mm; mN | ball of 5 mm, mm; mN | hollow by 30 mm, mm; mN |\n"
      "| --: | --: | --: | --: | --: | --: | --: | --: |\n",
      frames);
  for (const double brightness : {57.0, 180.0}) {
    for (const double noise : {0.3, 0.5, 1.0, 2.0, 3.0}) {
      Finger finger(brightness, noise);
      const double wrong = finger.touched_free(frames);
      const auto plate = finger.smallest(infinite), ball = finger.smallest(5);
      std::printf("| %g | %g | %d, %.0f | %.4f, %.4f | %.0f | %s | %s | %s |\n", brightness, noise,
                  finger.window_px, finger.ring_px, finger.threshold_per_mm, finger.faint_per_mm,
                  wrong * frames, plate.c_str(), ball.c_str(), finger.smallest(-30).c_str());
      std::fflush(stdout);
    }
  }
  return 0;
}
