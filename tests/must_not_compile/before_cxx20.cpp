// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// An older dialect is refused in one line, not in thousands.
// first error: fingerpad needs C\+\+20: compile with -std=c\+\+20
// flags: -std=c++17
#include "fingerpad/slip/stick_ratio.hpp"

int main() {
#ifndef FINGERPAD_MUST_NOT_COMPILE
  (void)fingerpad::StickRatio<>(9, 9);
#endif
}
