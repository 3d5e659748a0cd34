// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What is read-only is refused where cells are written.
// message: (satisfaction of|does not satisfy) 'writable_grid
#include "fingerpad/core/grid.hpp"
#include "support/foreign_image.hpp"

template <fingerpad::writable_grid G>
void clear(G& g) {
  fingerpad::as_view(g)(0, 0) = 0;
}
static test::ForeignImage<double> image(2, 2);

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  const auto& read_only = image;
  clear(read_only);
}
#else
static void good_or_bad() {
  clear(image);
}
#endif
int main() {
  good_or_bad();
}
