// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <vector>

#include "fingerpad/image/curvature_map.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"

TEMPLATE_TEST_CASE("curvature: a frame allocates nothing",
                   "",
                   fingerpad::ClampedMean<>,
                   fingerpad::RingStencil<>) {
  using namespace fingerpad;
  std::vector<float> depth(48 * 64, 8.0F), out(48 * 64, 0.0F);
  depth[1000] = std::nanf("");
  const StridedView<float> view(depth.data(), 48, 64, 64), out_view(out.data(), 48, 64, 64);
  const CurvatureMap<TestType> map({}, 48, 64, {5});
  auto workspace = map.workspace();
  const long before = test::allocations();
  for (int frame = 0; frame < 3; ++frame) {
    (void)map(view, out_view, workspace);
    (void)map.band(3, 20, view, out_view, workspace);
  }
  const long after = test::allocations();
  CHECK(before > 0);
  CHECK(after == before);
}
