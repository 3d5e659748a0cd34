// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A computed cell is a copy; an assignment to it would be lost silently.
// first error: this grid is written to: its cells must be assignable, neither const nor computed
#include "fingerpad/contact/contact_by_difference.hpp"
#include "support/foreign_image.hpp"

using namespace fingerpad;
using Frame = test::ForeignImage<float>;

static void find_in(auto&& mask) {
  const Frame frames[] = {Frame(8, 8)};
  const ContactByDifference<1> contact(frames);
  auto workspace = contact.workspace();
  (void)contact(frames[0], mask, workspace);
}

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  find_in(LazyView(8, 8, [](Index, Index) { return Touch::none; }));
}
#else
static void good_or_bad() {
  find_in(test::ForeignImage<Touch>(8, 8));
}
#endif
int main() {
  good_or_bad();
}
