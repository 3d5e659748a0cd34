// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Optics in integers would lose everything to rounding.
// message: (satisfaction of|does not satisfy) 'scalar
#include "fingerpad/optics/camera.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  (void)fingerpad::Camera<int>();
}
#else
static void good_or_bad() {
  (void)fingerpad::Camera<float>();
}
#endif
int main() {
  good_or_bad();
}
