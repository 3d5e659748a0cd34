// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties of a stick ratio in space for every motion and every slip.
#include "fingerpad/slip/spatial_stick_ratio.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;
using test::SlippingPatch;

namespace {

using Dots = test::Image<Point3<double>>;
using Flags = test::Image<std::uint8_t>;
using States = test::Image<DotState>;

/// An object is dragged, rolled, rotated and pressed at random while its stick disc changes at
/// random.
std::vector<Dots> any_recording(SlippingPatch& patch) {
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  std::vector<Dots> frames;
  const auto small = [&](double size) { return random.uniform(-size, size); };
  for (int k = 0; k < 8; ++k) {
    frames.push_back(noisy(patch.dots, 0.005, 0.025, random));
    patch.step(test::moved_by({small(0.01), small(0.01), small(0.02)}, {small(3), small(3), 28},
                              {small(0.2), small(0.2), small(0.1)}),
               random.uniform(0.3, 1.3));
  }
  return frames;
}

struct Said {
  std::vector<SpatialStickResult<double>> results;
  std::vector<States> states;
};

Said follow(const std::vector<Dots>& frames, const Flags& contact) {
  const SpatialStickRatio<double> ratio(contact.rows(), contact.cols());
  auto state = ratio.start();
  Said said;
  States states(contact.rows(), contact.cols());
  for (const Dots& dots : frames) {
    said.results.push_back(ratio(dots, contact, states, state));
    said.states.push_back(states);
  }
  return said;
}

}  // namespace

TEST_CASE("in space, stick and slip do not depend on where the pad is seen from its axis",
          "[spatial_stick][law]") {
  rc::prop("shifted, rotated about z, mirrored", [] {
    SlippingPatch patch;
    const auto frames = any_recording(patch);
    const Said said = follow(frames, patch.contact);
    const double angle = test::uniform(-3, 3), x = test::uniform(-30, 30),
                 y = test::uniform(-30, 30), z = test::uniform(-5, 5);
    const bool mirror = test::whole(0, 1) == 1;
    std::vector<Dots> seen = frames;
    for (Dots& dots : seen) {
      for (auto& p : dots.cells) {
        const double px = mirror ? -p.x : p.x;
        p = {std::cos(angle) * px - std::sin(angle) * p.y + x,
             std::sin(angle) * px + std::cos(angle) * p.y + y, p.z + z};
      }
    }
    const Said other = follow(seen, patch.contact);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const auto &a = said.results[k], &b = other.results[k];
      RC_ASSERT(a.status == b.status);
      RC_ASSERT(a.reference_age == b.reference_age);
      RC_ASSERT((a.stick == b.stick && a.slip == b.slip && a.unknown == b.unknown));
      RC_ASSERT(said.states[k].cells == other.states[k].cells);
      RC_ASSERT(std::abs(a.furthest_mm - b.furthest_mm) < 1e-9);
    }
  });
}

TEST_CASE("in space, a state is a value, and results are within their ranges",
          "[spatial_stick][law]") {
  rc::prop("whatever is lost", [] {
    SlippingPatch patch;
    auto frames = any_recording(patch);
    const double lost = test::uniform(0, 0.7);
    const double infinity = std::numeric_limits<double>::infinity();
    for (Dots& dots : frames) {
      for (auto& p : dots.cells) {
        if (test::uniform(0, 1) < lost) {
          p.x = *rc::gen::element(std::nan(""), infinity, 1e300, 0.0);
        }
      }
    }
    const SpatialStickRatio<double> ratio(21, 21);
    auto state = ratio.start();
    States states(21, 21), other(21, 21);
    for (const Dots& dots : frames) {
      auto copy = state;
      const auto r = ratio(dots, patch.contact, states, state);
      const auto s = ratio(dots, patch.contact, other, copy);
      RC_ASSERT((r.status == s.status && test::same_bits(r.stick_ratio, s.stick_ratio)));
      RC_ASSERT(states.cells == other.cells);
      RC_ASSERT(r.accepted());
      RC_ASSERT((std::isnan(r.stick_ratio) || (r.stick_ratio >= 0 && r.stick_ratio <= 1)));
      RC_ASSERT(r.stick + r.slip + r.unknown ==
                std::count(patch.contact.cells.begin(), patch.contact.cells.end(), 1));
      if (r.updated()) {
        RC_ASSERT(r.furthest_mm > ratio.reference_mm() * 0.999);
        RC_ASSERT(is_finite(r.ratio_sd));
        RC_ASSERT(is_finite(r.motion.translation_mm));
        for (Index i = 0; i < 21; ++i) {
          for (Index j = 0; j < 21; ++j) {
            const bool known = states(i, j) >= DotState::slip;
            RC_ASSERT(is_finite(state.slips()(i, j).slip_mm) <= known);
          }
        }
      }
    }
  });
}
