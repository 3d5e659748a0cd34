// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/object_surface.hpp"

#include <vector>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"

TEST_CASE("object surface: a frame allocates nothing") {
  using namespace fingerpad;
  std::vector<float> depth(48 * 64), residual(48 * 64);
  std::vector<unsigned char> contact(48 * 64, 1);
  for (std::size_t k = 0; k < depth.size(); ++k) {
    depth[k] = 9.0F + 1e-3F * static_cast<float>(k % 64 * (k % 64));
  }
  const StridedView<float> view(depth.data(), 48, 64, 64), out(residual.data(), 48, 64, 64);
  const StridedView<unsigned char> mask(contact.data(), 48, 64, 64);
  const SurfaceFit<Plane<>> plane(48, 64, Camera<double>(), {.border_px = 2});
  const SurfaceFit<Sphere<>> sphere(48, 64, Camera<double>());
  const SurfaceFit<Quadric<>, OrthographicCamera<double>> quadric(48, 64, {});
  const long before = test::allocations();
  bool good = true;
  for (int frame = 0; frame < 3; ++frame) {
    good = good && plane(view, mask).ok() && plane(view, mask, out).ok();
    good = good && sphere(view, mask).ok() && sphere(view, mask, out).ok();
    good = good && quadric(view, mask).ok() && quadric(view, mask, out).ok();
    const auto points = surface_points(Camera<double>(), view, mask);
    good = good && is_present(points(7, 9));
  }
  const long after = test::allocations();
  CHECK(good);
  CHECK(before > 0);
  CHECK(after == before);
}
