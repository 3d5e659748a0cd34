// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/neighbour_light.hpp"

#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include "support/catch.hpp"

namespace {
long allocations = 0;
}

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // GCC 12 inlines only one of the two
#endif

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) {
    return p;
  }
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

TEST_CASE("neighbour light: a frame allocates nothing") {
  using namespace fingerpad;
  std::vector<float> reference(48 * 64, 1.0F), depth(48 * 64, 2.0F);
  depth[1000] = std::nanf("");
  const StridedView<float> reference_view(reference.data(), 48, 64, 64);
  const StridedView<float> view(depth.data(), 48, 64, 64);
  const NeighbourLightCompensation<> stepped({}, 0.1F, reference_view);
  const NeighbourLightCompensation<ExactDisc> exact({}, 0.1F, reference_view);
  auto workspace = stepped.workspace();
  auto exact_workspace = exact.workspace();
  const long before = allocations;
  for (int frame = 0; frame < 3; ++frame) {
    stepped(view, view, workspace);
    exact(view, view, exact_workspace);
  }
  const long after = allocations;
  CHECK(before > 0);
  CHECK(after == before);
}
