// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/neighbour_light.hpp"

#include <cmath>
#include <vector>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"

TEST_CASE("neighbour light: a frame allocates nothing") {
  using namespace fingerpad;
  std::vector<float> reference(48 * 64, 1.0F), depth(48 * 64, 2.0F);
  depth[1000] = std::nanf("");
  const StridedView<float> reference_view(reference.data(), 48, 64, 64);
  const StridedView<float> view(depth.data(), 48, 64, 64);
  NeighbourLightCompensation<> compensation({}, 0.1F, reference_view);
  const long before = test::allocations();
  for (int frame = 0; frame < 3; ++frame) {
    (void)compensation(view, view);
  }
  const long after = test::allocations();
  CHECK(before > 0);
  CHECK(after == before);
}
