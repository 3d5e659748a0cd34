// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The version of the library, as numbers and as one comparable integer (10000 major + 100 minor +
// patch). A test checks that it equals the version that CMakeLists.txt declares. Language standards
// before C++20 are refused here with one error instead of thousands of lines.
#if !defined(_MSVC_LANG) && __cplusplus < 202002L
#error "fingerpad needs C++20: compile with -std=c++20"
#include "compile_with_-std=c++20"  // no such file: compilation ends here
#endif

#define FINGERPAD_VERSION_MAJOR 0
#define FINGERPAD_VERSION_MINOR 1
#define FINGERPAD_VERSION_PATCH 0
#define FINGERPAD_VERSION \
  (FINGERPAD_VERSION_MAJOR * 10000 + FINGERPAD_VERSION_MINOR * 100 + FINGERPAD_VERSION_PATCH)
