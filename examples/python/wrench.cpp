// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/wrench.hpp"

#include <pybind11/stl.h>

#include <mutex>

#include "fingerpad/force/pad_heights.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using Options = fingerpad::WrenchOptions<double>;
using Result = fingerpad::WrenchResult<double>;

/// Six-axis force from depth maps, with all memory for a frame; calls from several threads are
/// serialised.
class WrenchOfDepth {
  using Method = fingerpad::Wrench<>;
  using Heights = fingerpad::PadHeights<>;

 public:
  WrenchOfDepth(const fingerpad::Camera<double>& camera,
                const Count& rows,
                const Count& cols,
                const Array& rim_mm,
                const Options& options)
      : heights_(
            count_of(rows, "rows"), count_of(cols, "cols"), camera, options.base_radius_mm + 1),
        map_(heights_.map()),
        wrench_(Dots(rim_mm, "rim_mm").view(), options) {}

  Result operator()(const Array& depth_mm,
                    const Array& mask,
                    const Array& side_dots_mm,
                    const Number& pressure) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const auto depth = view_of<float>(depth_mm, "depth_mm");
    const auto contact = mask_of(mask, "mask");
    const auto side_dots = dots_mm_of(side_dots_mm, "side_dots_mm");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return heights_(depth, contact, map_) ? wrench_(map_, side_dots, pressure_mpa) : Result();
  }

  Result by_modulus(const Array& side_dots_mm, const Number& pressure) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const auto side_dots = dots_mm_of(side_dots_mm, "side_dots_mm");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return wrench_.by_modulus(side_dots, pressure_mpa);
  }

 private:
  Heights heights_;
  Heights::Map map_;
  Method wrench_;
  std::mutex mutex_;
};

}  // namespace

void bind_wrench(py::module_& module) {
  bind_options<Options>(module, "WrenchOptions",
                        "Options of rim and membrane; see force/wrench.hpp.")
      .def_readwrite("base_radius_mm", &Options::base_radius_mm)
      .def_readwrite("side_dot_length_mm", &Options::side_dot_length_mm)
      .def_readwrite("stress_free_inclination_rad", &Options::stress_free_inclination_rad)
      .def_readwrite("mooney_share", &Options::mooney_share)
      .def_readwrite("modulus_n_per_mm", &Options::modulus_n_per_mm)
      .def_readwrite("line_step_mm", &Options::line_step_mm)
      .def_readwrite("blur_mm", &Options::blur_mm)
      .def_readwrite("reach_mm", &Options::reach_mm)
      .def_readwrite("max_pressure_mpa", &Options::max_pressure_mpa);
  py::class_<Result>(
      module, "WrenchResult",
      "Six-axis force and moment that the object exerts on the pad, the moment about\n"
      "the center of the base; a press has force_n[2] < 0. NaN unless ok.")
      .def_property_readonly("ok", &Result::ok)
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_property_readonly("force_n", [](const Result& r) { return as_tuple(r.force_n); })
      .def_property_readonly("moment_n_mm", [](const Result& r) { return as_tuple(r.moment_n_mm); })
      .def_readonly("pressure_mpa", &Result::pressure_mpa, "given, or found by the modulus")
      .def_readonly("modulus_n_per_mm", &Result::modulus_n_per_mm)
      .def_readonly("summit_area_mm2", &Result::summit_area_mm2)
      .def_readonly("by_modulus", &Result::by_modulus)
      .def_property_readonly(
          "missing", [](const Result& r) { return r.faults.missing; },
          "side dots that were not found")
      .def_property_readonly(
          "unstretched", [](const Result& r) { return r.faults.unstretched; },
          "side dots without a usable direction")
      .def_property_readonly(
          "misplaced", [](const Result& r) { return r.faults.misplaced; },
          "side dots below the base or near another border point");
  py::class_<WrenchOfDepth>(module, "Wrench",
                            "Six-axis force from depth map, side dots and pressure;\n"
                            "force/wrench.hpp.")
      .def(py::init<const fingerpad::Camera<double>&, const Count&, const Count&, const Array&,
                    const Options&>(),
           py::arg("camera"), py::arg("rows"), py::arg("cols"), py::arg("rim_mm"),
           py::arg("options") = Options(),
           "rows, cols: of the depth maps, px. rim_mm: float64 (1, n, 3), where the side dots are\n"
           "fixed, n >= 6.")
      .def("__call__", &WrenchOfDepth::operator(), py::arg("depth_mm"), py::arg("mask"),
           py::arg("side_dots_mm"), py::arg("pressure_mpa"),
           "result = wrench(depth_mm, mask, side_dots_mm, pressure_mpa)\n\n"
           "depth_mm: float32 (rows, cols), NaN where unknown. mask: uint8 or bool (rows, cols).\n"
           "side_dots_mm: float64 (1, n, 3), NaN where not found. pressure_mpa: MPa above the\n"
           "air pressure, NaN: found by modulus_n_per_mm. For arrays of another size the status is "
           "\"refused\".")
      .def("by_modulus", &WrenchOfDepth::by_modulus, py::arg("side_dots_mm"),
           py::arg("pressure_mpa"), "The same without a depth map, from modulus_n_per_mm.");
}

}  // namespace python
