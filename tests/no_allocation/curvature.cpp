// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/image/curvature.hpp"

#include <cmath>
#include <vector>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"

TEST_CASE("curvature: a frame allocates nothing") {
  using namespace fingerpad;
  std::vector<float> depth(48 * 64, 8.0F), out(48 * 64, 0.0F);
  depth[1000] = std::nanf("");
  const StridedView<float> view(depth.data(), 48, 64, 64), out_view(out.data(), 48, 64, 64);
  CurvatureMap<> map({}, 48, 64, {5});
  const long before = test::allocations();
  for (int frame = 0; frame < 3; ++frame) {
    (void)map(view, out_view);
    map.mean(3, 20, 2, 50, out_view);
  }
  const long after = test::allocations();
  CHECK(before > 0);
  CHECK(after == before);
}
