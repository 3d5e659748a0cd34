// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A computed cell is a copy; an assignment to it would be lost silently.
// first error: this grid is written to: its cells must be assignable, neither const nor computed
#include "fingerpad/contact/contact_region.hpp"
#include "support/foreign_image.hpp"

using namespace fingerpad;
static test::ForeignImage<float> depths(64, 64);

static void find_in(auto&& mask) {
  ContactRegion<> contact({}, 64, 64);
  (void)contact(depths, mask);
}

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  find_in(LazyView(64, 64, [](Index, Index) { return Touch::none; }));
#else
  find_in(test::ForeignImage<Touch>(64, 64));
#endif
}
