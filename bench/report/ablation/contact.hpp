// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on the contact region in measured depth maps: many directions or one, the perspective of
// the camera, the placed edge and the cleaning. The threshold of every variant is half of the
// curvature that the variant itself measures on the free pad.
//
// Error of the region: misclassified pixels, relative to those that truly touch; on the free pad,
// to all its pixels. Error of the area: that of area_mm2, relative to the true one (on the free
// pad: to the pad's). The truth is known to half a node of the finite elements (0.37 mm), which is
// 9 to 21 % of these contacts: an error below 0.1 is as good as 0.
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "depth.hpp"
#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "membranes.hpp"

namespace bench::ablation {

/// A region with its mask.
class ContactVariant {
 public:
  template <class CameraType>
  ContactVariant(const CameraType& camera,
                 const std::vector<Image<float>>& free_mm,
                 Index min_region_px = fingerpad::ContactTest().min_region_px,
                 const fingerpad::CurvatureRing& ring = {},
                 bool places_edge = true)
      : region_(camera,
                free_mm.front().rows(),
                free_mm.front().cols(),
                {.threshold_per_mm = threshold(camera, free_mm, ring),
                 .ring = ring,
                 .min_region_px = min_region_px,
                 .places_edge = places_edge}),
        mask_(region_.rows(), region_.cols()) {}

  /// Errors of the region and of the area.
  struct Wrong {
    double region;
    double area;
  };
  Wrong operator()(const Seen& seen, const Image<float>& depth_mm) {
    const auto result = region_(depth_mm, mask_);
    double wrong = 0, all = 0, pad_px = 0;
    for (std::size_t k = 0; k < mask_.cells.size(); ++k) {
      const bool touches = seen.touches.cells[k] != 0;
      wrong += touches != (mask_.cells[k] != 0) ? 1 : 0;
      all += touches ? 1 : 0;
      pad_px += std::isnan(seen.depth_mm.cells[k]) ? 0 : 1;
    }
    const double pad_mm2 = std::numbers::pi * base_radius_mm * base_radius_mm;
    return {wrong / (all > 0 ? all : pad_px),
            (result.area_mm2 - seen.area_mm2) / (all > 0 ? seen.area_mm2 : pad_mm2)};
  }

  /// Processes one frame, for timing.
  void run(const Image<float>& depth_mm) { (void)region_(depth_mm, mask_); }

 private:
  template <class CameraType>
  static double threshold(const CameraType& camera,
                          const std::vector<Image<float>>& free_mm,
                          const fingerpad::CurvatureRing& ring) {
    return fit_contact_threshold(camera, free_mm, ring).median_per_mm / 2;
  }

  fingerpad::ContactRegion<> region_;
  Image<std::uint8_t> mask_;
};

class ContactEffects {
 public:
  ContactEffects(const test::Pad& pad,
                 const Image<double>& free_mm,
                 fingerpad::DepthEstimator<>& estimator)
      : pad_(pad), estimator_(estimator), free_(free_frames(free_mm)) {}

  /// `depth_mm` is of one frame; a second one is made here.
  void add(const Seen& seen, const Image<float>& depth_mm) {
    add_frame(seen, depth_mm);
    add_frame(seen, measured(seen.depth_mm, seen.seed + 50, seen.of.noise));
  }

  std::vector<Effect> effects(const Seen& press) {
    const auto depth = measured(press.depth_mm, press.seed, press.of.noise);
    const auto cost = [&](auto& without) {
      return cost_us([&] { all_.run(depth); }, [&] { without.run(depth); });
    };
    directions_.cost_us = cost(one_direction_);
    perspective_.cost_us = perspective_area_.cost_us = cost(orthographic_);
    edge_.cost_us = cost(at_threshold_);
    cleaning_.cost_us = cost(uncleaned_);
    return {directions_, perspective_, perspective_area_, edge_, cleaning_};
  }

 private:
  void add_frame(const Seen& seen, const Image<float>& depth) {
    const auto all = all_(seen, depth);
    note(directions_, seen, all.region, one_direction_(seen, depth).region);
    const auto flat = orthographic_(seen, depth);
    note(perspective_, seen, all.region, flat.region);
    note(perspective_area_, seen, all.area, flat.area);
    note(edge_, seen, all.region, at_threshold_(seen, depth).region);
    note(cleaning_, seen, all.region, uncleaned_(seen, depth).region);
  }

  Image<float> measured(const Image<double>& depth_mm, std::uint64_t seed, double noise) const {
    return DepthEffects::measured(estimator_, frame_of(pad_, depth_mm, seed, noise));
  }
  std::vector<Image<float>> free_frames(const Image<double>& free_mm) const {
    std::vector<Image<float>> frames;
    for (std::uint64_t seed = 201; seed <= 204; ++seed) {
      frames.push_back(measured(free_mm, seed, 1));
    }
    return frames;
  }
  static void note(Effect& effect, const Seen& seen, double with, double without) {
    effect.with_in(seen.of.scene).add(with);
    effect.without_in(seen.of.scene).add(without);
  }

  test::Pad pad_;
  fingerpad::DepthEstimator<>& estimator_;
  std::vector<Image<float>> free_;
  fingerpad::OrthographicCamera<double> from_afar_{pad_.camera.center_x_px, pad_.camera.center_y_px,
                                                   pad_.camera.pitch_mm};

  ContactVariant all_{pad_.camera, free_};
  ContactVariant one_direction_{
      pad_.camera, free_, fingerpad::ContactTest().min_region_px, {.directions = 1}};
  ContactVariant orthographic_{from_afar_, free_};
  ContactVariant at_threshold_{
      pad_.camera, free_, fingerpad::ContactTest().min_region_px, {}, false};
  ContactVariant uncleaned_{pad_.camera, free_, 1};

  static constexpr const char* of_region = "contact region";
  static constexpr const char* share = "share";
  Effect directions_{.name = "direction averaging",
                     .quantity = of_region,
                     .unit = share,
                     .on = "`CurvatureRing{.directions = 18}`",
                     .off = "1"};
  Effect perspective_{.name = "perspective",
                      .quantity = of_region,
                      .unit = share,
                      .on = "`ContactRegion` of a `Camera`",
                      .off = "of an `OrthographicCamera`"};
  Effect perspective_area_{.name = "perspective",
                           .quantity = "contact area",
                           .unit = share,
                           .on = "`ContactRegion` of a `Camera`",
                           .off = "of an `OrthographicCamera`"};
  Effect edge_{.name = "placed edge",
               .quantity = of_region,
               .unit = share,
               .on = "`ContactTest::places_edge`",
               .off = "false"};
  Effect cleaning_{.name = "cleaning",
                   .quantity = of_region,
                   .unit = share,
                   .on = "`min_region_px` 200",
                   .off = "`min_region_px` 1"};
};

}  // namespace bench::ablation
