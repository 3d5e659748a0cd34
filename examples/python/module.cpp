// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The Python module `fingerpad`: the methods on NumPy arrays, without copies and with results
// identical to C++. Slow functions release the GIL.
#include <pybind11/pybind11.h>

#include "fingerpad/core/check.hpp"
#include "python/parts.hpp"

PYBIND11_MODULE(fingerpad, module) {
  namespace py = pybind11;
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
}
