// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A read-only grid is refused as an output.
// first error: this grid is written to: its cells must be assignable, neither const nor computed
#include "fingerpad/contact/contact_region.hpp"
#include "support/foreign_image.hpp"

using namespace fingerpad;
static test::ForeignImage<float> depths(64, 64);
static test::ForeignImage<Touch> mask(64, 64);

static void find_in(auto& to) {
  ContactRegion<> contact({}, 64, 64);
  (void)contact(depths, to);
}

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  const auto& read_only = mask;
  find_in(read_only);
#else
  find_in(mask);
#endif
}
