// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on depth: refraction, smoothing, light from the neighbouring membrane. Errors are of
// single pixels whose true point is within 17.5 mm of the axis. Pixels without an answer (without
// smoothing: colours of no depth) are left out.
//
// Neighbouring light, whose cost is that of samples of 3 x 3 pixels: frames are rendered as if the
// membrane were where that light makes it appear, by the law of neighbour_light.hpp with its
// published numbers. The row therefore shows how well the law is undone, not how well it describes
// a pad.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "membranes.hpp"

namespace bench::ablation {

class DepthEffects {
 public:
  explicit DepthEffects(const test::Pad& pad, const Image<double>& free_mm)
      : pad_(pad),
        free_mm_(free_mm),
        estimator_(pad.camera, pad.fluid, reference_of(pad, pad.camera, free_mm, free_mm)) {
    straight_.refractive_index = 1;
    straight_.plate_index = 1;
    const test::Pad straight_pad = [&] {
      test::Pad p = pad;
      p.camera = straight_;
      return p;
    }();
    const auto known_mm = depths(straight_pad, Membrane("free"));
    straight_estimator_ = std::make_unique<fingerpad::DepthEstimator<>>(
        straight_, pad.fluid, reference_of(pad, straight_, free_mm, known_mm));
    const auto reference = reference_of(pad, pad.camera, free_mm, free_mm);
    raw_ = std::make_unique<fingerpad::DepthEstimator<>>(pad.camera, pad.fluid, reference,
                                                         fingerpad::DepthOptions{.window_px = 1});
    const auto free = measured(estimator_, frame_of(pad, free_mm, 98, 0.25));
    light_ = std::make_unique<fingerpad::NeighbourLightCompensation<>>(
        fingerpad::NeighbourLight<float>(), float(pitch_mm()), free);
    true_light_ = std::make_unique<fingerpad::NeighbourLightCompensation<>>(
        fingerpad::NeighbourLight<float>(), float(pitch_mm()), free_mm);
  }

  fingerpad::DepthEstimator<>& estimator() { return estimator_; }

  static Image<float> measured(fingerpad::DepthEstimator<>& estimator,
                               const test::Frame<std::uint8_t>& frame) {
    return test::estimate(estimator, frame).depth_mm;
  }

  /// Returns the depths as measured with all effects on.
  Image<float> add(const Seen& seen) {
    const auto frame = frame_of(pad_, seen.depth_mm, seen.seed, seen.of.noise);
    const auto by_default = measured(estimator_, frame);
    place_.with_in(seen.of.scene).add(place_errors(seen, pad_.camera, by_default));
    place_.without_in(seen.of.scene)
        .add(place_errors(seen, straight_, measured(*straight_estimator_, frame)));
    smoothing_.with_in(seen.of.scene).add(depth_errors(seen, by_default));
    smoothing_.without_in(seen.of.scene).add(depth_errors(seen, measured(*raw_, frame)));
    const auto lit = frame_of(pad_, lit_depths(seen.depth_mm), seen.seed, seen.of.noise);
    auto depth = measured(estimator_, lit);
    neighbours_.without_in(seen.of.scene).add(depth_errors(seen, depth));
    (void)(*light_)(depth, depth);
    neighbours_.with_in(seen.of.scene).add(depth_errors(seen, depth));
    return by_default;
  }

  /// Returns the effects, after measuring their cost on the frame of a press.
  std::vector<Effect> effects(const Seen& press) {
    const auto frame = frame_of(pad_, press.depth_mm, press.seed, press.of.noise);
    Image<float> out(pad_.rows, pad_.cols);
    const auto work = [&](auto& estimator) {
      return [&] { (void)estimator(frame.red, frame.green, out); };
    };
    place_.cost_us = cost_us(work(estimator_), work(*straight_estimator_));
    smoothing_.cost_us = cost_us(work(estimator_), work(*raw_));
    const auto samples = [](const Image<float>& from) {  // as a fingertip has them
      Image<float> to(from.rows() / 3, from.cols() / 3);
      for (Index i = 0; i < to.rows(); ++i) {
        for (Index j = 0; j < to.cols(); ++j) {
          to(i, j) = from(3 * i, 3 * j);
        }
      }
      return to;
    };
    auto depth = samples(measured(estimator_, frame));
    fingerpad::NeighbourLightCompensation<> light(
        sampled(fingerpad::NeighbourLight<float>(), 3), 3 * float(pitch_mm()),
        samples(measured(estimator_, frame_of(pad_, free_mm_, 98, 0.25))));
    const auto pressed = depth;
    neighbours_.cost_us = cost_us([&] { (void)light(pressed, depth); }, [] {});
    return {place_, neighbours_, smoothing_};
  }

 private:
  double pitch_mm() const { return 1.1 * pad_.camera.pitch_mm; }

  /// Depths with neighbouring light: l with l - m psi_sum(l) = the truth.
  Image<double> lit_depths(const Image<double>& truth_mm) const {
    Image<double> lit = truth_mm;
    Image<float> seen(truth_mm.rows(), truth_mm.cols());
    Image<float> out = seen;
    for (int pass = 0; pass < 6; ++pass) {
      std::transform(lit.cells.begin(), lit.cells.end(), seen.cells.begin(),
                     [](double l) { return static_cast<float>(l); });
      (void)(*true_light_)(seen, out);
      for (std::size_t k = 0; k < lit.cells.size(); ++k) {
        const double light = static_cast<double>(seen.cells[k]) - static_cast<double>(out.cells[k]);
        lit.cells[k] = (std::max)(truth_mm.cells[k] + light, 0.01 * truth_mm.cells[k]);
      }
    }
    return lit;
  }

  template <class Error>
  Errors errors_inside(const Seen& seen, const Error& error) const {
    Errors errors;
    for (Index i = 0; i < pad_.rows; ++i) {
      for (Index j = 0; j < pad_.cols; ++j) {
        const auto& p = seen.point_mm(i, j);
        if (std::hypot(p.x, p.y) < 17.5) {
          errors.add(error(i, j, p));
        }
      }
    }
    return errors;
  }
  Errors depth_errors(const Seen& seen, const Image<float>& depth_mm) const {
    return errors_inside(seen, [&](Index i, Index j, const auto& p) {
      return static_cast<double>(depth_mm(i, j)) - p.z;
    });
  }
  Errors place_errors(const Seen& seen,
                      const Camera<double>& camera,
                      const Image<float>& depth_mm) const {
    return errors_inside(seen, [&](Index i, Index j, const auto& p) {
      const auto found = point_at(camera, static_cast<double>(i), static_cast<double>(j),
                                  static_cast<double>(depth_mm(i, j)));
      return std::hypot(found.x - p.x, found.y - p.y, found.z - p.z);
    });
  }

  test::Pad pad_;
  Camera<double> straight_ = pad_.camera;
  Image<double> free_mm_;
  fingerpad::DepthEstimator<> estimator_;
  std::unique_ptr<fingerpad::DepthEstimator<>> straight_estimator_;
  std::unique_ptr<fingerpad::DepthEstimator<>> raw_;
  std::unique_ptr<fingerpad::NeighbourLightCompensation<>> light_;
  std::unique_ptr<fingerpad::NeighbourLightCompensation<>> true_light_;  // from true depths

  Effect place_{.name = "refraction",
                .quantity = "place of a pixel's point",
                .unit = "mm",
                .on = "`Camera` with its refractive indices",
                .off = "`Camera` with refractive indices of 1"};
  Effect neighbours_{.name = "neighbour light",
                     .quantity = "depth in frames with such light",
                     .unit = "mm",
                     .on = "`NeighbourLightCompensation<>`",
                     .off = "not called"};
  Effect smoothing_{.name = "smoothing",
                    .quantity = "depth",
                    .unit = "mm",
                    .on = "`DepthOptions` as they are",
                    .off = "`window_px = 1`"};
};

}  // namespace bench::ablation
