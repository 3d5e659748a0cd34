// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Optics in integers would lose everything to rounding.
// message: (satisfaction of|does not satisfy) 'scalar
#include "fingerpad/optics/camera.hpp"

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)fingerpad::Camera<int>();
#else
  (void)fingerpad::Camera<float>();
#endif
}
