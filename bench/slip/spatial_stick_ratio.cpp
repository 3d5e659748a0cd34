// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratio in space of 21 x 21 dots with 113 in contact, and the friction limit; "ns/pixel" is
// per frame.
// Timed: a curved patch of dots is dragged, rolled and rotated while its stick disc shrinks and
// grows. Error: of the ratio in frames whose reference is the previous frame, against the dots that
// did not slip in that step, with 0.005 mm of noise in the plane and 0.025 mm in depth.
// On finite-element membranes: tests/figures/spatial_stick_ratio.cpp.
#include <memory>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/slipping_patch.hpp"

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

}  // namespace

int main(int argc, char** argv) {
  add_frame<double>("frame of 21x21 dots in space/StickRatio, double, the default");
  add_frame<float>("frame of 21x21 dots in space/StickRatio, float");
  add_limit();
  bench::add_streaming("frame of 21x21 dots in space");
  return bench::run(argc, argv);
}
