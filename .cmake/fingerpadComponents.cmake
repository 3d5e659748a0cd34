# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# The optional components and the libraries that they need. The build and the installed package both
# read this file.
set(fingerpad_COMPONENTS dot_finder eigen gel mdspan opencv xtensor)

# Finds the library of a component. Sets fingerpad_<name>_FOUND, fingerpad_<name>_LIBRARY to link,
# and fingerpad_<name>_NEEDS, the library's name for messages.
macro(fingerpad_find_component name)
  set(fingerpad_${name}_FOUND FALSE)
  set(fingerpad_${name}_LIBRARY "")
  set(fingerpad_${name}_NEEDS "")
  if("${name}" STREQUAL "dot_finder") # printed dots in frames
    find_package(OpenCV QUIET COMPONENTS core imgproc)
    set(fingerpad_dot_finder_FOUND ${OpenCV_FOUND})
    set(fingerpad_dot_finder_LIBRARY opencv_core opencv_imgproc)
    set(fingerpad_dot_finder_NEEDS "OpenCV")
  elseif("${name}" STREQUAL "eigen") # six-axis force, fingertip, fits; grids and dual numbers of Eigen
    find_package(Eigen3 3.4 QUIET NO_MODULE)
    set(fingerpad_eigen_FOUND ${Eigen3_FOUND})
    set(fingerpad_eigen_LIBRARY Eigen3::Eigen)
    set(fingerpad_eigen_NEEDS "Eigen 3.4")
  elseif("${name}" STREQUAL "gel") # contact of gel pads
    find_package(OpenCV QUIET COMPONENTS core imgproc)
    set(fingerpad_gel_FOUND ${OpenCV_FOUND})
    set(fingerpad_gel_LIBRARY opencv_core opencv_imgproc)
    set(fingerpad_gel_NEEDS "OpenCV")
  elseif("${name}" STREQUAL "mdspan")
    set(fingerpad_mdspan_FOUND TRUE) # any mdspan of the user: nothing is included
  elseif("${name}" STREQUAL "opencv")
    find_package(OpenCV QUIET COMPONENTS core)
    set(fingerpad_opencv_FOUND ${OpenCV_FOUND})
    set(fingerpad_opencv_LIBRARY opencv_core)
    set(fingerpad_opencv_NEEDS "OpenCV")
  elseif("${name}" STREQUAL "xtensor")
    find_package(xtensor QUIET)
    set(fingerpad_xtensor_FOUND ${xtensor_FOUND})
    set(fingerpad_xtensor_LIBRARY xtensor)
    set(fingerpad_xtensor_NEEDS "xtensor")
  endif()
endmacro()
