// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A computed cell is a copy; what is assigned to it would be lost in silence.
// message: (satisfaction of|does not satisfy) 'writable_grid
#include "fingerpad/core/dots.hpp"

using Point = fingerpad::Point2<double>;
template <fingerpad::writable_grid G>
void clear(const G& g) {
  g(0, 0) = Point{0, 0};
}

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  clear(fingerpad::LazyView(2, 2, [](fingerpad::Index, fingerpad::Index) { return Point{1, 1}; }));
}
#else
static void good_or_bad() {
  Point memory[4] = {};
  clear(fingerpad::StridedView<Point>(memory, 2, 2, 2));
}
#endif
int main() {
  good_or_bad();
}
