// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The Python module `fingerpad`: the methods on NumPy arrays, without copies and with results
// identical to C++. Slow functions release the GIL.
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "python/parts.hpp"

namespace {

namespace py = pybind11;

/// Names of a class's properties, in the order in which they were bound.
std::vector<std::string> properties_of(const py::handle& of_class) {
  std::vector<std::string> names;
  const auto members = py::reinterpret_borrow<py::object>(of_class.attr("__dict__"));
  for (const auto& name : py::list(members)) {
    if (PyObject_TypeCheck(py::object(members[name]).ptr(), &PyProperty_Type)) {
      names.push_back(name.cast<std::string>());
    }
  }
  return names;
}

/// Results print their numbers; help() of settings lists keywords with their defaults.
void describe(const py::handle& of_class) {
  const auto names = properties_of(of_class);
  const py::object members = of_class.attr("__dict__");
  if (members.contains("__setattr__")) {
    const auto inspect = py::module_::import("inspect");
    const py::object defaults = of_class();
    const py::object keyword = inspect.attr("Parameter").attr("KEYWORD_ONLY");
    py::list keywords;
    for (const std::string& name : names) {
      keywords.append(inspect.attr("Parameter")(name, keyword,
                                                py::arg("default") = defaults.attr(name.c_str())));
    }
    py::setattr(of_class, "__signature__", inspect.attr("Signature")(keywords));
  } else if (!members.contains("__repr__") && !members.contains("__call__")) {
    const auto print = [names](const py::object& self) {
      std::string text;
      for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name + "=";
        text += py::repr(self.attr(name.c_str())).cast<std::string>();
      }
      return py::type::of(self).attr("__name__").cast<std::string>() + "(" + text + ")";
    };
    py::setattr(of_class, "__repr__", py::cpp_function(print, py::is_method(of_class)));
  }
}

}  // namespace

PYBIND11_MODULE(fingerpad, module) {
  module.doc() =
      "Touch from camera frames: depth, contact, motion, slip and force of soft fingertips.\n"
      "Units: mm, N, N mm, rad, MPa, px, s. Images are arrays (rows, cols).";
  py::register_exception<fingerpad::parameter_error>(module, "ParameterError", PyExc_ValueError);
  python::bind_depth(module);
  python::bind_contact(module);
  python::bind_slip(module);
  python::bind_look_up(module);
  python::bind_wrench(module);
  python::bind_foam(module);
  python::bind_fingertip(module);
  for (const auto& [name, of_class] : py::dict(module.attr("__dict__"))) {
    if (PyType_Check(of_class.ptr()) && py::hasattr(of_class, "__module__") &&
        !PyExceptionClass_Check(of_class.ptr())) {
      describe(of_class);
    }
  }
}
