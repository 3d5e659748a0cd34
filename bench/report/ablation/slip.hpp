// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Worth of space and friction to the stick ratio: dots of finite-element membranes in space
// (tests/data) with 0.005 mm of noise in the plane (0.06 px) and 0.025 mm in depth, forces known to
// 1.5 %, moments to 2 %.
//   press                flat plate
//   drag                 flat plate, dragged to slip and back
//   reversal             flat plate that slides, deeper and rotated meanwhile, and back
//   twist                flat plate, rotated to slip
//   normal force change  drag, rotation and depth at once
//   rolling              a ball that rolls
//   wedge                cylinder, dragged until it slides
//   tilted               tilted plate, dragged
//   noisy                the drag with twice the noise
//   dots lost            the drag with a fifth of the dots missing, different ones in each frame
// Error: of the ratio, in all frames in contact, against the dots that slipped relative to the
// known pose of the object since the reference. A kept answer counts as an answer, a missing one as
// a ratio of 1.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/spatial_scene.hpp"
#include "table.hpp"

namespace bench::ablation {

using fingerpad::Index;

struct SpatialRecording {
  std::vector<test::DotsMm> dots;
  std::vector<fingerpad::ContactLoad<double>> loads;
};

struct SpatialRecordings {
  Scene scene;
  test::SpatialScene truth;
  double noise = 1;  ///< factor
  std::vector<SpatialRecording> recordings;

  SpatialRecordings(Scene of, const std::string& name, double times = 1, double lost_share = 0)
      : scene(of), truth(name), noise(times) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      test::Random random(seed);
      SpatialRecording recording;
      for (Index k = 0; k < truth.size(); ++k) {
        const test::SpatialStep& step = truth[k];
        test::DotsMm dots = step.dots;
        for (auto& p : dots.cells) {
          const double x = random.normal(), y = random.normal(), z = random.normal();
          p = {p.x + times * 0.005 * x, p.y + times * 0.005 * y, p.z + times * 0.025 * z};
          if (lost_share > 0 && random.uniform() < lost_share) {
            p = {test::nan, test::nan, test::nan};
          }
        }
        recording.loads.push_back(fingerpad::contact_load(
            test::noisy(step.force_n, 0.015, random), test::noisy(step.moment_n_mm, 0.02, random),
            dots, step.contact));
        recording.dots.push_back(dots);
      }
      recordings.push_back(recording);
    }
  }
};

inline std::vector<SpatialRecordings> spatial_recordings() {
  return {{Scene::press, "press"},
          {Scene::drag, "drag"},
          {Scene::reversal, "slide"},
          {Scene::twist, "twist"},
          {Scene::normal_force_change, "mix"},
          {Scene::rolling, "roll"},
          {Scene::wedge, "cylinder"},
          {Scene::tilted, "tilt"},
          {Scene::noisy, "drag", 2},
          {Scene::dots_lost, "drag", 1, 0.2}};
}

/// Stick ratio of dots in space.
class InSpace {
 public:
  explicit InSpace(const SpatialRecordings& of)
      : stick_(of.truth.dots_across(), of.truth.dots_across(), {.noise = of.noise * 0.005}) {}
  fingerpad::StickResult<> operator()(const test::DotsMm& dots,
                                      const test::SpatialFlags& contact,
                                      const fingerpad::ContactLoad<double>&) {
    return stick_(dots, contact);
  }

 private:
  fingerpad::StickRatio<> stick_;
};

/// Stick ratio in the image of a camera straight above.
class InImage {
 public:
  explicit InImage(const SpatialRecordings& of)
      : stick_(of.truth.dots_across(), of.truth.dots_across(), {.noise = of.noise * 0.005}),
        seen_(stick_.rows(), stick_.cols()) {}
  fingerpad::StickResult<> operator()(const test::DotsMm& dots,
                                      const test::SpatialFlags& contact,
                                      const fingerpad::ContactLoad<double>&) {
    for (std::size_t k = 0; k < dots.cells.size(); ++k) {
      seen_.cells[k] = {dots.cells[k].x, dots.cells[k].y};
    }
    return stick_(seen_, contact);
  }

 private:
  fingerpad::StickRatio<> stick_;
  test::Image<fingerpad::Point2<double>> seen_;
};

/// One of the two above with the friction limit.
template <class Dots>
class WithFriction {
 public:
  explicit WithFriction(const SpatialRecordings& of) : dots_(of) {}
  auto operator()(const test::DotsMm& dots,
                  const test::SpatialFlags& contact,
                  const fingerpad::ContactLoad<double>& load) {
    auto seen = dots_(dots, contact, load);
    const auto fused = limit_(load, seen);
    seen.stick_ratio = static_cast<decltype(seen.stick_ratio)>(fused.stick_ratio);
    return seen;
  }

 private:
  Dots dots_;
  fingerpad::FrictionLimit<double> limit_;
};

template <class Way>
Errors slip_errors(const SpatialRecordings& of) {
  Errors errors;
  for (const SpatialRecording& recording : of.recordings) {
    Way way(of);
    for (Index k = 0; k < of.truth.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      const auto r = way(recording.dots[at], of.truth[k].contact, recording.loads[at]);
      if (k >= 2 && test::dots_of_both(of.truth[k], of.truth[k]) >= 6) {
        const double ratio = r.ok() ? static_cast<double>(r.stick_ratio) : 1;
        errors.add(ratio - test::spatial_truth(of.truth, k, r));
      }
    }
  }
  return errors;
}

template <class With, class Without>
Effect slip_effect(const std::vector<SpatialRecordings>& all,
                   const std::string& name,
                   const std::string& on,
                   const std::string& off) {
  Effect effect{.name = name, .quantity = "stick ratio", .unit = "1", .on = on, .off = off};
  for (const SpatialRecordings& recordings : all) {
    effect.with_in(recordings.scene).add(slip_errors<With>(recordings));
    effect.without_in(recordings.scene).add(slip_errors<Without>(recordings));
  }
  const SpatialRecordings& drag = all[1];
  const auto run = [&](auto way) {
    return [&drag, way]() mutable {
      for (Index k = 0; k < drag.truth.size(); ++k) {
        const auto at = static_cast<std::size_t>(k);
        (void)way(drag.recordings[0].dots[at], drag.truth[k].contact, drag.recordings[0].loads[at]);
      }
    };
  };
  auto with = run(With(drag));
  auto without = run(Without(drag));
  effect.cost_us =
      cost_us([&] { with(); }, [&] { without(); }, static_cast<double>(drag.truth.size()));
  return effect;
}

inline std::vector<Effect> slip_effects() {
  const auto all = spatial_recordings();
  return {slip_effect<InSpace, InImage>(all, "space", "dots in space", "dots in the image"),
          slip_effect<WithFriction<InSpace>, InSpace>(all, "friction in space", "`FrictionLimit`",
                                                      "`StickRatio` alone"),
          slip_effect<WithFriction<InImage>, InImage>(all, "friction in the image",
                                                      "`FrictionLimit`", "`StickRatio` alone")};
}

}  // namespace bench::ablation
