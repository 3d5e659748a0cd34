// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// NumPy arrays as grids: views of the array's own memory, with whatever strides it has.
#include <pybind11/numpy.h>

#include <cstdint>
#include <string>
#include <utility>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"

namespace python {

namespace py = pybind11;
using fingerpad::Index;

/// The view of a two-dimensional array of cells T. Raises TypeError for another shape or type.
template <class T>
fingerpad::StridedView<const T> view_of(const py::array& array, const char* name) {
  constexpr auto size = static_cast<py::ssize_t>(sizeof(T));
  if (array.ndim() != 2 || !py::isinstance<py::array_t<T>>(array) || array.strides(0) % size != 0 ||
      array.strides(1) % size != 0) {
    throw py::type_error(std::string(name) + " must have the shape (rows, cols) and the type " +
                         std::string(py::str(py::dtype::of<T>())) + ", not " +
                         std::string(py::str(array.attr("shape"))) + " and " +
                         std::string(py::str(array.dtype())));
  }
  return {static_cast<const T*>(array.data()), array.shape(0), array.shape(1),
          array.strides(0) / size, array.strides(1) / size};
}

/// An array of rows x cols cells T of its own, and the view to write to it.
template <class T>
std::pair<py::array_t<T>, fingerpad::StridedView<T>> new_array(Index rows, Index cols) {
  py::array_t<T> array({rows, cols});
  return {array, {array.mutable_data(), rows, cols, cols}};
}

/// Calls `call(T())` with the cell type of a camera's channel: uint8, uint16, float32 or float64.
template <class Call>
auto with_pixel_of(const py::array& channel, const Call& call) {
  if (py::isinstance<py::array_t<std::uint8_t>>(channel)) {
    return call(std::uint8_t());
  }
  if (py::isinstance<py::array_t<std::uint16_t>>(channel)) {
    return call(std::uint16_t());
  }
  if (py::isinstance<py::array_t<float>>(channel)) {
    return call(float());
  }
  if (py::isinstance<py::array_t<double>>(channel)) {
    return call(double());
  }
  throw py::type_error("a channel must be of uint8, uint16, float32 or float64, not " +
                       std::string(py::str(channel.dtype())));
}

/// Dots from an array (rows, cols, 2) or (rows, cols, 3) of float64, in px or mm; NaN: not there.
template <class Point, std::size_t Coordinates>
auto dots_of(const py::array& array, const char* name) {
  if (array.ndim() != 3 || array.shape(2) != static_cast<py::ssize_t>(Coordinates) ||
      !py::isinstance<py::array_t<double>>(array)) {
    throw py::type_error(std::string(name) + " must have the shape (rows, cols, " +
                         std::to_string(Coordinates) + ") and the type float64, not " +
                         std::string(py::str(array.attr("shape"))) + " and " +
                         std::string(py::str(array.dtype())));
  }
  const auto* bytes = static_cast<const char*>(array.data());
  const py::ssize_t row = array.strides(0), col = array.strides(1), coordinate = array.strides(2);
  return fingerpad::LazyView(array.shape(0), array.shape(1), [=](Index i, Index j) {
    const auto at = [&](py::ssize_t k) {
      return *reinterpret_cast<const double*>(bytes + i * row + j * col + k * coordinate);
    };
    if constexpr (Coordinates == 2) {
      return Point{at(0), at(1)};
    } else {
      return Point{at(0), at(1), at(2)};
    }
  });
}
inline auto dots_px_of(const py::array& array, const char* name) {
  return dots_of<fingerpad::Point2<double>, 2>(array, name);
}
inline auto dots_mm_of(const py::array& array, const char* name) {
  return dots_of<fingerpad::Point3<double>, 3>(array, name);
}

}  // namespace python
