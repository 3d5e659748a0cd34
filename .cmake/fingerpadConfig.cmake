# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# find_package(fingerpad 0.1 COMPONENTS opencv xtensor): fingerpad::fingerpad, and for each component
# a target fingerpad::<component> that brings the other library along.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
include("${CMAKE_CURRENT_LIST_DIR}/fingerpadTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/fingerpadAdapters.cmake")

foreach(component IN LISTS fingerpad_FIND_COMPONENTS)
  fingerpad_find_adapter(${component})
  if(fingerpad_${component}_FOUND)
    if(NOT TARGET fingerpad::${component})
      add_library(fingerpad::${component} INTERFACE IMPORTED)
      target_link_libraries(fingerpad::${component}
                            INTERFACE fingerpad::fingerpad ${fingerpad_${component}_LIBRARY})
    endif()
  elseif(fingerpad_FIND_REQUIRED_${component})
    set(fingerpad_FOUND FALSE)
    set(fingerpad_NOT_FOUND_MESSAGE
        "fingerpad: component ${component}: no such component, or its library is not installed")
  endif()
endforeach()
