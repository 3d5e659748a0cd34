// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A read-only view does not convert to a writable one.
// first error: a read-only view cannot become a writable view
#include "fingerpad/core/grid.hpp"

using fingerpad::StridedView;

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)StridedView<int>(StridedView<const int>());
#else
  (void)StridedView<const int>(StridedView<int>());
#endif
}
