// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The version of the library, as numbers and as one comparable integer (10000 major + 100 minor +
// patch). A test holds it equal to the version that CMakeLists.txt declares.

#define FINGERPAD_VERSION_MAJOR 0
#define FINGERPAD_VERSION_MINOR 1
#define FINGERPAD_VERSION_PATCH 0
#define FINGERPAD_VERSION \
  (FINGERPAD_VERSION_MAJOR * 10000 + FINGERPAD_VERSION_MINOR * 100 + FINGERPAD_VERSION_PATCH)
