// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// NumPy arrays as grids: views of the array's own memory, with any strides.
#include <pybind11/numpy.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/math/rotation.hpp"

namespace python {

namespace py = pybind11;
using fingerpad::Index;

/// Arguments for arrays and numbers. They accept any object, so that an error can name its type.
class Array : public py::object {
  PYBIND11_OBJECT_DEFAULT(Array, py::object, is_any)
  static bool is_any(PyObject*) { return true; }
};
class Number : public py::object {
  PYBIND11_OBJECT_DEFAULT(Number, py::object, is_any)
  static bool is_any(PyObject*) { return true; }
};
class Count : public py::object {
  PYBIND11_OBJECT_DEFAULT(Count, py::object, is_any)
  static bool is_any(PyObject*) { return true; }
};

inline std::string type_name(const py::handle& given) {
  return py::str(py::type::of(given).attr("__name__"));
}

/// Whether an object is an instance of a class of the module `numbers`, like NumPy scalars, but not
/// bool.
inline bool is_of_numbers(const py::handle& given, const char* kind) {
  return !PyBool_Check(given.ptr()) &&
         py::isinstance(given, py::module_::import("numbers").attr(kind));
}

/// Returns the number. Raises TypeError for bool, complex numbers, arrays, text and None.
inline double number_of(const py::object& given, const char* name) {
  if (!PyFloat_Check(given.ptr()) && !is_of_numbers(given, "Real")) {
    throw py::type_error(std::string(name) + " must be a real number, not " + type_name(given));
  }
  return given.cast<double>();
}

/// Returns the integer. Raises TypeError for bool and for anything that is not an integer.
template <class T = Index>
T count_of(const py::object& given, const char* name) {
  if (!is_of_numbers(given, "Integral")) {
    throw py::type_error(std::string(name) + " must be an int, not " + type_name(given));
  }
  return given.cast<T>();
}

/// Raises TypeError for a masked array, because the mask would be lost.
inline void refuse_masked(const py::handle& given, const char* name) {
  if (py::module_::import("numpy.ma").attr("isMaskedArray")(given).cast<bool>()) {
    throw py::type_error(std::string(name) +
                         " is a masked array, whose mask would be lost: "
                         "pass a plain array, with NaN where there is no value");
  }
}

/// Returns the array itself. Raises TypeError for a list, None or text, and for a masked array.
inline py::array array_of(const py::object& given, const char* name) {
  if (!py::isinstance<py::array>(given)) {
    throw py::type_error(std::string(name) + " must be a NumPy array, not " + type_name(given) +
                         ": convert it with np.asarray(" + name + ", dtype)");
  }
  refuse_masked(given, name);
  return py::reinterpret_borrow<py::array>(given);
}

/// Returns numbers of any shape from an array or a list; copies them unless they are doubles.
/// Raises TypeError for complex numbers, bool, text, dates and objects.
inline py::array_t<double> numbers_of(const py::object& given, const char* name) {
  refuse_masked(given, name);
  const py::array array = py::module_::import("numpy").attr("asarray")(given);
  if (std::string("fiu").find(array.dtype().kind()) == std::string::npos) {
    throw py::type_error(std::string(name) +
                         " must contain real numbers, with NaN where there is none, not " +
                         std::string(py::str(array.dtype())));
  }
  return array;
}

/// Raises TypeError that names the expected and the given array.
[[noreturn]] inline void refuse_array(const py::array& array,
                                      const char* name,
                                      const std::string& shape,
                                      const std::string& type) {
  throw py::type_error(std::string(name) + " must have the shape " + shape + " and the type " +
                       type + ", not " + std::string(py::str(array.attr("shape"))) + " and " +
                       std::string(py::str(array.dtype())));
}

/// Returns a view of a two-dimensional array of type T. Raises TypeError for another shape or type.
template <class T>
fingerpad::StridedView<const T> view_of(const py::object& given, const char* name) {
  const py::array array = array_of(given, name);
  if (array.ndim() != 2 || !py::isinstance<py::array_t<T>>(array)) {
    refuse_array(array, name, "(rows, cols)", py::str(py::dtype::of<T>()));
  }
  constexpr auto size = static_cast<py::ssize_t>(sizeof(T));
  if (array.strides(0) % size != 0 || array.strides(1) % size != 0 ||
      reinterpret_cast<std::uintptr_t>(array.data()) % alignof(T) != 0) {
    throw py::type_error(std::string(name) +
                         " is not aligned in memory: pass np.ascontiguousarray(" + name + ")");
  }
  return {static_cast<const T*>(array.data()), array.shape(0), array.shape(1),
          array.strides(0) / size, array.strides(1) / size};
}

/// Returns a view of a mask: uint8 or bool, nonzero in contact.
inline fingerpad::StridedView<const std::uint8_t> mask_of(const py::object& given,
                                                          const char* name) {
  const py::array array = array_of(given, name);
  const bool flags = py::isinstance<py::array_t<bool>>(array);
  return view_of<std::uint8_t>(flags ? py::array(array.attr("view")("uint8")) : array, name);
}

/// Returns a new array of rows x cols elements T, and a view to write to it.
template <class T>
std::pair<py::array_t<T>, fingerpad::StridedView<T>> new_array(Index rows, Index cols) {
  py::array_t<T> array({rows, cols});
  return {array, {array.mutable_data(), rows, cols, cols}};
}

/// Returns `given`, or a new array if it is None, and a view to write rows x cols elements T to it.
/// Raises TypeError or ValueError for another type or shape, or for a read-only array.
template <class T>
std::pair<py::array, fingerpad::StridedView<T>> array_to_write(const py::object& given,
                                                               Index rows,
                                                               Index cols,
                                                               const char* name) {
  if (given.is_none()) {
    return new_array<T>(rows, cols);
  }
  const auto view = view_of<T>(given, name);
  if (view.rows() != rows || view.cols() != cols) {
    throw py::value_error(std::string(name) + " must have the shape (" + std::to_string(rows) +
                          ", " + std::to_string(cols) + ")");
  }
  py::array array = array_of(given, name);
  return {
      array,
      {static_cast<T*>(array.mutable_data()), rows, cols, view.row_stride(), view.col_stride()}};
}

/// Calls `call(T())` with the type of a camera channel: uint8, uint16, float32 or float64.
template <class Call>
auto with_pixel_of(const py::object& given, const char* name, const Call& call) {
  const py::array channel = array_of(given, name);
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
  throw py::type_error(std::string(name) + " must be of uint8, uint16, float32 or float64, not " +
                       std::string(py::str(channel.dtype())));
}

/// Dots from an array (rows, cols, 2) or (rows, cols, 3) of float32 or float64, px or mm; NaN if
/// missing.
template <class Point, std::size_t Coordinates>
auto dots_of(const py::object& given, const char* name) {
  const py::array array = array_of(given, name);
  const bool single = py::isinstance<py::array_t<float>>(array);
  if (array.ndim() != 3 || array.shape(2) != static_cast<py::ssize_t>(Coordinates) ||
      (!single && !py::isinstance<py::array_t<double>>(array))) {
    refuse_array(array, name, "(rows, cols, " + std::to_string(Coordinates) + ")",
                 "float32 or float64");
  }
  const auto* bytes = static_cast<const char*>(array.data());
  const py::ssize_t row = array.strides(0), col = array.strides(1), coordinate = array.strides(2);
  return fingerpad::LazyView(array.shape(0), array.shape(1), [=](Index i, Index j) {
    const auto at = [&](py::ssize_t k) {
      const char* cell = bytes + i * row + j * col + k * coordinate;
      return single ? static_cast<double>(*reinterpret_cast<const float*>(cell))
                    : *reinterpret_cast<const double*>(cell);
    };
    if constexpr (Coordinates == 2) {
      return Point{at(0), at(1)};
    } else {
      return Point{at(0), at(1), at(2)};
    }
  });
}

inline auto dots_px_of(const py::object& array, const char* name) {
  return dots_of<fingerpad::Point2<double>, 2>(array, name);
}
inline auto dots_mm_of(const py::object& array, const char* name) {
  return dots_of<fingerpad::Point3<double>, 3>(array, name);
}

/// A copy of the dots of an array, for options that need them in memory of their own.
struct Dots {
  Index rows, cols;
  std::vector<fingerpad::Point3<double>> cells;

  Dots(const py::object& array, const char* name) {
    const auto dots = dots_mm_of(array, name);
    rows = dots.rows();
    cols = dots.cols();
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        cells.push_back(dots(i, j));
      }
    }
  }
  fingerpad::StridedView<const fingerpad::Point3<double>> view() const {
    return {cells.data(), rows, cols, cols};
  }
};

template <class S>
py::tuple as_tuple(const fingerpad::Point2<S>& p) {
  return py::make_tuple(p.x, p.y);
}
template <class S>
py::tuple as_tuple(const fingerpad::Point3<S>& p) {
  return py::make_tuple(p.x, p.y, p.z);
}

/// A rotation matrix, row by row, and a translation in mm.
inline py::tuple pose_tuple(const fingerpad::Pose<double>& pose) {
  const auto& r = pose.rotation;
  py::tuple rows(3);
  for (int i = 0; i < 3; ++i) {
    rows[static_cast<std::size_t>(i)] = py::make_tuple(r(i, 0), r(i, 1), r(i, 2));
  }
  return py::make_tuple(rows, as_tuple(pose.translation_mm));
}

}  // namespace python

namespace pybind11::detail {
template <>
struct handle_type_name<python::Array> {
  static constexpr auto name = const_name("numpy.ndarray");
};
template <>
struct handle_type_name<python::Number> {
  static constexpr auto name = const_name("float");
};
template <>
struct handle_type_name<python::Count> {
  static constexpr auto name = const_name("int");
};
}  // namespace pybind11::detail
