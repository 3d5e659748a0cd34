# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT

# fingerpad_programs(KIND PACKAGE...): declares the option FINGERPAD_BUILD_<KIND>. It is on by
# default at the top level if all packages are found. If it is requested without them, configuration
# fails. It is a macro, because the results of find_package() are needed where the programs are
# built.
macro(fingerpad_programs kind)
  set(fingerpad_missing "")
  if(PROJECT_IS_TOP_LEVEL OR FINGERPAD_BUILD_${kind})
    foreach(package IN ITEMS ${ARGN})
      find_package(${package} QUIET)
      if(NOT ${package}_FOUND)
        list(APPEND fingerpad_missing ${package})
      endif()
    endforeach()
  endif()
  if(fingerpad_missing AND FINGERPAD_BUILD_${kind})
    message(FATAL_ERROR "fingerpad: FINGERPAD_BUILD_${kind} needs ${fingerpad_missing}.")
  elseif(fingerpad_missing AND NOT DEFINED FINGERPAD_BUILD_${kind})
    message(STATUS "fingerpad: FINGERPAD_BUILD_${kind} is off, not found: ${fingerpad_missing}")
  elseif(NOT fingerpad_missing)
    option(FINGERPAD_BUILD_${kind} "Build these programs of fingerpad" ${PROJECT_IS_TOP_LEVEL})
  endif()
endmacro()

# Without optimisation a frame takes some fifty times longer.
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  message(STATUS "fingerpad: no build type was given; taking Release")
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
endif()
