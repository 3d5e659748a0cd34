// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finite-element membranes as the camera sees them and as the default chain measures them, for the
// errors on scenes. Only the depths and masks named "measured" come from a method under test. Each
// frame is made once: 640 x 480 pixels, 8 bit, one grey level of noise.
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/depth.hpp"
#include "support/finite_elements.hpp"

namespace bench {

/// Frame of one membrane.
struct SceneFrame {
  test::Image<double> truth_mm;  ///< along each pixel's ray
  test::Frame<std::uint8_t> frame;
  test::Image<float> measured_mm;      ///< by the default estimator
  test::Image<std::uint8_t> measured;  ///< contact therein, by the default region
};

class SceneFrames {
 public:
  static SceneFrames& instance() {
    static SceneFrames frames;
    return frames;
  }

  const test::Pad& pad() const { return scene_.pad(); }
  const test::Image<double>& free_mm() const { return free_mm_; }
  double contact_threshold_per_mm() const { return threshold_per_mm_; }

  /// Frame of a shape in tests/data. The same name and seed give the same frame.
  const SceneFrame& operator()(const std::string& heights, std::uint64_t seed = 1) {
    const auto key = std::pair{heights, seed};
    const auto found = made_.find(key);
    return found != made_.end() ? found->second
                                : made_.emplace(key, make(heights, seed)).first->second;
  }

 private:
  using Region = fingerpad::ContactRegion<>;

  SceneFrames() {
    std::vector<test::Image<float>> free_mm;
    for (std::uint64_t seed = 901; seed <= 904; ++seed) {
      free_mm.push_back(test::estimate<float>(estimator_, scene_.frame(free_mm_, seed)).depth_mm);
    }
    threshold_per_mm_ = fit_contact_threshold(pad().camera, free_mm).threshold_per_mm;
  }

  SceneFrame make(const std::string& heights, std::uint64_t seed) {
    const auto truth = scene_.depth(heights);
    const auto frame = scene_.frame(truth, seed);
    auto depth = test::estimate<float>(estimator_, frame).depth_mm;
    fingerpad::ContactTest test;
    test.threshold_per_mm = threshold_per_mm_;
    Region region(pad().camera, pad().rows, pad().cols, test);
    test::Image<std::uint8_t> mask(pad().rows, pad().cols);
    (void)region(depth, mask);
    return {truth, frame, std::move(depth), std::move(mask)};
  }

  test::Scene scene_;
  test::Image<double> free_mm_ = scene_.depth("free");
  fingerpad::DepthEstimator<> estimator_{scene_.pad().camera, scene_.pad().fluid,
                                         scene_.reference(free_mm_)};
  double threshold_per_mm_ = 0;
  std::map<std::pair<std::string, std::uint64_t>, SceneFrame> made_;
};

}  // namespace bench
