// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratio in space of 21 x 21 dots with 113 in contact, and the friction limit; "ns/pixel" is
// per frame.
// Timed: a curved patch of dots is dragged, rolled and rotated while its stick disc shrinks and
// grows. Error: of the ratio in frames whose reference is the previous frame, against the dots that
// did not slip in that step, with 0.005 mm of noise in the plane and 0.025 mm in depth.
// "on scenes": all frames in contact of finite-element membranes (tests/data), with forces known to
// 1.5 % and moments to 2 %. Errors: of the ratio, where a kept answer counts as an answer and a
// missing one as 1; of the limit, relative to the coefficient of friction, where plates are
// dragged.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/slipping_patch.hpp"
#include "support/spatial_scene.hpp"

using namespace fingerpad;

namespace {

using Dots = test::Image<Point3<double>>;

struct Recording {
  std::vector<Dots> frames;
  std::vector<double> truth;  ///< of the step that leads to each frame
  test::Image<std::uint8_t> contact;

  Recording() {
    test::Random random(1);
    test::SlippingPatch patch(1.5, 9.05);
    contact = patch.contact;
    for (int k = 0; k < 128; ++k) {
      frames.push_back(noisy(patch.dots, 0.005, 0.025, random));
      truth.push_back(k > 0 ? patch.stick_ratio() : 1);
      const double way = k % 64 < 32 ? 1 : -1;
      patch.step(test::moved_by({0.001 * way, 0.003 * way, 0.004 * way}, {0, 0, 28},
                                {0.17 * way, 0.05 * way, 0}),
                 1.05 - 0.025 * (k % 32));
    }
  }
};

const Recording& recording() {
  static const Recording r;
  return r;
}

const StickOptions of_camera = {.noise = 0.005};

template <class S>
std::vector<double> errors_of() {
  std::vector<double> errors;
  StickRatio<S> stick(21, 21, of_camera);
  for (std::size_t k = 0; k < recording().frames.size(); ++k) {
    const auto r = stick(recording().frames[k], recording().contact);
    const bool one_step = r.updated() && r.reference_age == 1;
    errors.push_back(one_step ? static_cast<double>(r.stick_ratio) - recording().truth[k]
                              : test::nan);
  }
  return errors;
}

template <class S>
void add_frame(const std::string& name) {
  struct Running {
    StickRatio<S> stick{21, 21, of_camera};
    std::size_t k = 0;
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Running>();
  bench::add(
      name, 1, memory.bytes(),
      [d] {
        d->k = (d->k + 1) % recording().frames.size();
        benchmark::DoNotOptimize(d->stick(recording().frames[d->k], recording().contact));
      },
      [](auto& counters) { bench::note_errors(counters, "stick ratio", "of 1", errors_of<S>()); });
}

void add_limit() {
  struct Running {
    FrictionLimit<double> limit;
    std::size_t k = 0;
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Running>();
  bench::add(
      "frame of 21x21 dots in space/contact_load and FrictionLimit", 1, memory.bytes(),
      [d] {
        d->k = (d->k + 1) % recording().frames.size();
        const auto load = contact_load(Point3<double>{1, 0.5, -5}, Point3<double>{3, 2, 1},
                                       recording().frames[d->k], recording().contact);
        benchmark::DoNotOptimize(d->limit(load, 0.5, RatioUpdate::fresh));
      },
      [](auto&) {});
}

/// Errors of each method on the frames of the scenes.
struct OnScenes {
  std::vector<double> dots, fused;              ///< errors of the ratio
  std::vector<double> limit, remembered_ratio;  ///< errors of the limit, of plates
  static constexpr double friction_coefficient = 0.55;

  OnScenes() {
    for (const std::string name : {"drag", "slide", "twist", "mix", "tilt", "cylinder", "roll",
                                   "ball_slip", "rod_turn", "rubber"}) {
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        add(test::SpatialScene(name), name == "drag" || name == "slide", seed);
      }
    }
  }

 private:
  void add(const test::SpatialScene& scene, bool is_dragged_plate, std::uint64_t seed) {
    test::Random random(seed);
    const Index across = scene.dots_across();
    StickRatio<> stick(across, across, of_camera);
    FrictionLimit<double> friction;
    published::FrictionRatio<double> published;
    for (Index k = 0; k < scene.size(); ++k) {
      const Dots seen = noisy(scene[k].dots, 0.005, 0.025, random);
      const auto r = stick(seen, scene[k].contact);
      const auto load =
          contact_load(test::noisy(scene[k].force_n, 0.015, random),
                       test::noisy(scene[k].moment_n_mm, 0.02, random), seen, scene[k].contact);
      const auto slip = friction(load, r);
      const bool slides = r.updated() && r.stick_ratio < 0.1;
      (void)published(load.tangential_n, load.normal_n, slides);
      if (k < 2 || test::dots_of_both(scene[k], scene[k]) < 6) {
        continue;
      }
      const double truth = test::spatial_truth(scene, k, r);
      dots.push_back((r.ok() ? r.stick_ratio : 1) - truth);
      fused.push_back((is_finite(slip.stick_ratio) ? slip.stick_ratio : 1) - truth);
      if (is_dragged_plate) {
        limit.push_back(slip.limit / friction_coefficient - 1);
        remembered_ratio.push_back(published.mu_0() / friction_coefficient - 1);
      }
    }
  }
};
const OnScenes& on_scenes() {
  static const OnScenes errors;
  return errors;
}

/// Adds a row that times the ratio and `after`, which takes the ratio, for one frame. Its errors
/// are those on the scenes.
template <class After, class Note>
void add_on_scenes(const std::string& name, const After& after, const Note& note) {
  struct Running {
    After after;
    StickRatio<> stick{21, 21, of_camera};
    std::size_t k = 0;
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Running>(Running{after});
  bench::add(
      "on scenes/" + name, 1, memory.bytes(),
      [d] {
        d->k = (d->k + 1) % recording().frames.size();
        benchmark::DoNotOptimize(d->after(d->stick(recording().frames[d->k], recording().contact)));
      },
      note);
}

void add_scenes() {
  add_on_scenes(
      "StickRatio alone", [](const auto& r) { return r.stick_ratio; },
      [](auto& counters) {
        bench::note_errors(counters, "stick ratio", "of 1", on_scenes().dots);
      });
  add_on_scenes(
      "and FrictionLimit, the default",
      [friction = FrictionLimit<double>()](const auto& r) mutable {
        return friction({.normal_n = 5, .tangential_n = 1}, r);
      },
      [](auto& counters) {
        bench::note_errors(counters, "stick ratio", "of 1", on_scenes().fused);
        bench::note_errors(counters, "limit", "share", on_scenes().limit);
      });
  add_on_scenes(
      "and published: FrictionRatio",
      [friction = published::FrictionRatio<double>()](const auto& r) mutable {
        return friction(1.0, 5.0, r.updated() && r.stick_ratio < 0.1);
      },
      [](auto& counters) {
        bench::note_errors(counters, "limit", "share", on_scenes().remembered_ratio);
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_frame<double>("frame of 21x21 dots in space/StickRatio, double, the default");
  add_frame<float>("frame of 21x21 dots in space/StickRatio, float");
  add_limit();
  add_scenes();
  bench::add_streaming("frame of 21x21 dots in space");
  return bench::run(argc, argv);
}
