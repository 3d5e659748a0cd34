# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# The optional adapters and the libraries that they need; read by the build and by the installed
# package alike.
set(fingerpad_ADAPTERS mdspan opencv xtensor)

# Looks for what adapter `name` needs: fingerpad_<name>_FOUND, and fingerpad_<name>_LIBRARY to link.
macro(fingerpad_find_adapter name)
  set(fingerpad_${name}_FOUND FALSE)
  set(fingerpad_${name}_LIBRARY "")
  if("${name}" STREQUAL "mdspan")
    set(fingerpad_mdspan_FOUND TRUE) # whichever mdspan the user has: nothing is included
  elseif("${name}" STREQUAL "opencv")
    find_package(OpenCV QUIET COMPONENTS core)
    set(fingerpad_opencv_FOUND ${OpenCV_FOUND})
    set(fingerpad_opencv_LIBRARY opencv_core)
  elseif("${name}" STREQUAL "xtensor")
    find_package(xtensor QUIET)
    set(fingerpad_xtensor_FOUND ${xtensor_FOUND})
    set(fingerpad_xtensor_LIBRARY xtensor)
  endif()
endmacro()
