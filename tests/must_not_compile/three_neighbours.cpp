// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dots have 4 or 8 neighbours.
// first error: a dot has 4 or 8 neighbours: for_each_neighbour<4> or for_each_neighbour<8>
#include "fingerpad/dots/dot_tracker.hpp"
#include "support/foreign_image.hpp"

const test::ForeignImage<fingerpad::Point2<double>> dots(2, 2);
constexpr auto nothing = [](auto, auto, auto) {};

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  (void)fingerpad::detail::for_each_neighbour<3>(dots, 0, 0, nothing);
}
#else
static void good_or_bad() {
  (void)fingerpad::detail::for_each_neighbour<4>(dots, 0, 0, nothing);
}
#endif
int main() {
  good_or_bad();
}
