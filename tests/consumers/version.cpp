// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Compiled with the version that CMakeLists.txt declares.
#include "fingerpad/core/scalar.hpp"

static_assert(FINGERPAD_VERSION_MAJOR == MAJOR);
static_assert(FINGERPAD_VERSION_MINOR == MINOR);
static_assert(FINGERPAD_VERSION_PATCH == PATCH);
static_assert(FINGERPAD_VERSION == 10000 * MAJOR + 100 * MINOR + PATCH);
