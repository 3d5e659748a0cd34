# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# find_package(fingerpad 0.2 COMPONENTS eigen opencv) defines fingerpad::fingerpad and, for each
# component, a target fingerpad::<component> that links the other library as well.
include("${CMAKE_CURRENT_LIST_DIR}/fingerpadTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/fingerpadComponents.cmake")

foreach(component IN LISTS fingerpad_FIND_COMPONENTS)
  fingerpad_find_component(${component})
  if(fingerpad_${component}_FOUND)
    if(NOT TARGET fingerpad::${component})
      add_library(fingerpad::${component} INTERFACE IMPORTED)
      target_link_libraries(fingerpad::${component}
                            INTERFACE fingerpad::fingerpad ${fingerpad_${component}_LIBRARY})
    endif()
    set(fingerpad_${component}_FOUND TRUE)
  elseif(fingerpad_FIND_REQUIRED_${component})
    set(fingerpad_FOUND FALSE)
    if(fingerpad_${component}_NEEDS)
      set(fingerpad_NOT_FOUND_MESSAGE
          "fingerpad: component ${component} needs ${fingerpad_${component}_NEEDS}, which was not found")
    else()
      string(REPLACE ";" ", " fingerpad_known "${fingerpad_COMPONENTS}")
      set(fingerpad_NOT_FOUND_MESSAGE
          "fingerpad: there is no component ${component}; there are: ${fingerpad_known}")
    endif()
  endif()
endforeach()

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND NOT fingerpad_FIND_QUIETLY)
  message(STATUS "fingerpad: without optimisation a frame takes some fifty times longer; "
                 "-DCMAKE_BUILD_TYPE=Release")
endif()
