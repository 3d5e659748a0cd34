# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
include(CMakeFindDependencyMacro)
find_dependency(fingerpad 0.2)
include("${CMAKE_CURRENT_LIST_DIR}/touchTargets.cmake")
