// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/contact_region.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;

namespace {

template <class Edge, class Cleaning>
struct Policies {
  using edge = Edge;
  using cleaning = Cleaning;
};

}  // namespace

TEMPLATE_TEST_CASE("contact region: a frame allocates nothing",
                   "[contact_region]",
                   (Policies<HalfLevelEdge, WithoutSpecks>),
                   (Policies<HalfLevelEdge, Hysteresis>),
                   (Policies<WidenedByRing, LargestRegion>),
                   (Policies<AtThreshold, NoCleaning>)) {
  const auto camera = test::height_map(60, 64, 0.32);
  auto depth = test::depths_of<float>(camera, test::RoundFilm({}), 60, 64);
  depth(3, 3) = static_cast<float>(test::nan);
  ContactTest contact_test;
  contact_test.ring.radius_px = 5;
  const ContactRegion<ClampedMean<>, typename TestType::edge, typename TestType::cleaning,
                      OrthographicCamera<double>>
      region(camera, 60, 64, contact_test);
  auto workspace = region.workspace();
  test::Image<Touch> mask(60, 64);
  const long before = test::allocations();
  Index found = 0;
  for (int frame = 0; frame < 3; ++frame) {
    found += region(depth, mask, workspace).contact_px;
  }
  const long after = test::allocations();
  CHECK(before > 0);
  CHECK(found > 1000);
  CHECK(after == before);
}

TEST_CASE("mask growth: a frame allocates nothing", "[contact_region]") {
  test::Image<std::uint8_t> mask(60, 64);
  mask(30, 30) = 1;
  const MaskGrowth growth(60, 64);
  auto workspace = growth.workspace();
  const long before = test::allocations();
  const bool grown = growth(mask, 9.5, mask, workspace);
  const bool shrunk = growth(mask, -3.0, mask, workspace);
  const long after = test::allocations();
  CHECK(grown);
  CHECK(shrunk);
  CHECK(mask(30, 36) != 0);
  CHECK(after == before);
}
