// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// message: depths are no whole numbers: give the depth map first, then the mask
#include "fingerpad/contact/contact_region.hpp"
#include "support/foreign_image.hpp"

static void good_or_bad(fingerpad::ContactRegion<>& region) {
  test::ForeignImage<float> depth_mm(4, 4);
  test::ForeignImage<unsigned char> mask(4, 4);
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)region(mask, depth_mm);
#else
  (void)region(depth_mm, mask);
#endif
}
int main() {
  (void)&good_or_bad;
}
