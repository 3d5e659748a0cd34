// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/contact_region.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;

TEST_CASE("contact region: a frame allocates nothing", "[contact_region]") {
  const auto camera = test::height_map(60, 64, 0.32);
  auto depth = test::depths_of<float>(camera, test::RoundFilm({}), 60, 64);
  depth(3, 3) = static_cast<float>(test::nan);
  ContactTest contact_test;
  contact_test.ring.radius_px = 5;
  contact_test.places_edge = GENERATE(true, false);
  ContactRegion<> region(camera, 60, 64, contact_test);
  test::Image<Touch> mask(60, 64);
  const long before = test::allocations();
  Index found = 0;
  for (int frame = 0; frame < 3; ++frame) {
    found += region(depth, mask).contact_px;
  }
  const long after = test::allocations();
  CHECK(before > 0);
  CHECK(found > 1000);
  CHECK(after == before);
}
