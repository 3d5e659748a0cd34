// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A vector has no rows and columns: the first error says what to pass.
// first error: a vector has no rows and columns: pass fingerpad::grid_of\(vector, rows, cols\)
#include <vector>

#include "fingerpad/contact/contact_region.hpp"

fingerpad::ContactRegion<> contact_region(fingerpad::Camera<>(), 480, 640);
std::vector<float> depth_map(480 * 640);
std::vector<unsigned char> mask(480 * 640);

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)contact_region(depth_map, mask);
#else
  using fingerpad::grid_of;
  (void)contact_region(grid_of(depth_map, 480, 640), grid_of(mask, 480, 640));
#endif
}
