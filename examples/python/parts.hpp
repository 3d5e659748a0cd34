// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The module's parts, one file each, and the binding of option structs as Python classes.
#include <pybind11/pybind11.h>

#include <string>

#include "python/arrays.hpp"

namespace python {

void bind_depth(pybind11::module_& module);
void bind_contact(pybind11::module_& module);
void bind_slip(pybind11::module_& module);
void bind_look_up(pybind11::module_& module);
void bind_wrench(pybind11::module_& module);
void bind_foam(pybind11::module_& module);
void bind_fingertip(pybind11::module_& module);

/// Raises TypeError if a setting gets a value of another kind, such as a bool for a number.
inline void check_kind(const char* owner,
                       const pybind11::str& field,
                       const pybind11::object& before,
                       const pybind11::object& value) {
  const std::string name = std::string(owner) + ": " + std::string(field);
  if (PyFloat_Check(before.ptr()) || (before.is_none() && !value.is_none())) {
    number_of(value, name.c_str());
  } else if (PyLong_Check(before.ptr()) && !PyBool_Check(before.ptr())) {
    count_of(value, name.c_str());
  } else if (PyBool_Check(before.ptr()) && type_name(value).rfind("bool", 0) != 0) {
    throw pybind11::type_error(name + " must be True or False, not " + type_name(value));
  }
}

/// Raises ParameterError if the settings have no meaning together; not every struct can say so.
template <class Options>
void refuse_bad(const Options& options) {
  if constexpr (requires { std::string(check(options)); }) {
    require(options);
  }
}

/// Binds a struct of settings as a class with keyword arguments, e.g. Camera(pitch_mm=0.1). Unknown
/// names are refused.
template <class Options>
pybind11::class_<Options> bind_options(pybind11::module_& module,
                                       const char* name,
                                       const char* doc) {
  namespace py = pybind11;
  return py::class_<Options>(module, name, doc)
      .def(py::init([name](const py::kwargs& given) {
        py::object options = py::cast(Options());
        for (const auto& [field, value] : given) {
          if (!py::hasattr(options, field)) {
            throw py::type_error(std::string(name) + " has no " + std::string(py::str(field)) +
                                 "; it is " + std::string(py::repr(options)));
          }
          py::setattr(options, field, value);
        }
        auto made = options.cast<Options>();
        if (!given.empty()) {
          refuse_bad(made);
        }
        return made;
      }))
      .def("__setattr__",
           [name](const py::object& self, const py::str& field, const py::object& value) {
             check_kind(name, field, self.attr(field), value);
             if (PyObject_GenericSetAttr(self.ptr(), field.ptr(), value.ptr()) != 0) {
               throw py::error_already_set();
             }
           })
      .def("__repr__", [name](const py::object& self) {
        py::list fields;
        for (const auto& field : self.attr("__dir__")()) {
          const auto text = field.cast<std::string>();
          if (text.front() != '_') {
            fields.append(text + "=" + std::string(py::repr(self.attr(field))));
          }
        }
        return std::string(name) + "(" + py::str(", ").attr("join")(fields).cast<std::string>() +
               ")";
      });
}

}  // namespace python
