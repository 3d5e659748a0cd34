// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/surface.hpp"

#include <vector>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"

TEST_CASE("surface: a frame allocates nothing") {
  using namespace fingerpad;
  std::vector<float> depth(48 * 64);
  std::vector<unsigned char> contact(48 * 64, 1);
  for (std::size_t k = 0; k < depth.size(); ++k) {
    depth[k] = 9.0F + 1e-3F * static_cast<float>(k % 64 * (k % 64));
  }
  const StridedView<float> view(depth.data(), 48, 64, 64);
  const StridedView<unsigned char> mask(contact.data(), 48, 64, 64);
  const long before = test::allocations();
  const bool good = fit_surface(Camera<double>(), view, mask).ok() &&
                    fit_surface(OrthographicCamera<double>(), view, mask).ok();
  const long after = test::allocations();
  CHECK(good);
  CHECK(before > 0);
  CHECK(after == before);
}
