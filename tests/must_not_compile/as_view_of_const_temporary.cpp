// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A constant temporary is a temporary too, though an ordinary reference would bind to it.
// message: deleted
#include "fingerpad/core/grid.hpp"
#include "support/foreign_image.hpp"

using Image = test::ForeignImage<double>;
static const Image make() {
  return Image(2, 2);
}

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)fingerpad::as_view(make());
#else
  const Image image = make();
  (void)fingerpad::as_view(image);
#endif
}
