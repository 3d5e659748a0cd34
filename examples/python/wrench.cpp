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

using fingerpad::OneRow;
using Noise = fingerpad::WrenchNoise<double>;
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
                const Options& options,
                const OneRow& side_dots)
      : heights_(
            count_of(rows, "rows"), count_of(cols, "cols"), camera, options.base_radius_mm + 1),
        map_(heights_.map()),
        wrench_(Dots(rim_mm, "rim_mm").view(), options, {}, side_dots),
        work_(wrench_.workspace()) {}

  Result operator()(const Array& depth_mm,
                    const Array& mask,
                    const Array& side_dots_mm,
                    const Number& pressure,
                    const Noise& noise) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const auto depth = view_of<float>(depth_mm, "depth_mm");
    const auto contact = mask_of(mask, "mask");
    const auto side_dots = dots_mm_of(side_dots_mm, "side_dots_mm");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return heights_(depth, contact, map_) ? wrench_(map_, side_dots, pressure_mpa, work_, noise)
                                          : Result();
  }

  Result by_modulus(const Array& side_dots_mm, const Number& pressure, const Noise& noise) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const auto side_dots = dots_mm_of(side_dots_mm, "side_dots_mm");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return wrench_.by_modulus(side_dots, pressure_mpa, work_, noise);
  }

 private:
  Heights heights_;
  Heights::Map map_;
  Method wrench_;
  Method::Workspace work_;
  std::mutex mutex_;
};

}  // namespace

void bind_wrench(py::module_& module) {
  bind_options<Options>(module, "WrenchOptions",
                        "Options of the rim and the mesh; see force/wrench_options.hpp.")
      .def_readwrite("base_radius_mm", &Options::base_radius_mm)
      .def_readwrite("side_dot_length_mm", &Options::side_dot_length_mm)
      .def_readwrite("columns", &Options::columns)
      .def_readwrite("rows", &Options::rows)
      .def_readwrite("line_step_mm", &Options::line_step_mm)
      .def_readwrite("blur_mm", &Options::blur_mm)
      .def_readwrite("reach_mm", &Options::reach_mm)
      .def_readwrite("max_pressure_mpa", &Options::max_pressure_mpa)
      .def_readwrite("max_residual", &Options::max_residual)
      .def_readwrite("calibrated_modulus_n_per_mm", &Options::calibrated_modulus_n_per_mm)
      .def_readwrite("falls_back_on_modulus", &Options::falls_back_on_modulus);
  bind_options<OneRow>(module, "OneRow", "One row of side dots; see force/rim_traction.hpp.")
      .def_readwrite("stress_free_inclination_rad", &OneRow::stress_free_inclination_rad);
  bind_options<Noise>(module, "WrenchNoise", "Standard deviations of the inputs of a wrench.")
      .def_readwrite("side_dot_mm", &Noise::side_dot_mm)
      .def_readwrite("edge_mm", &Noise::edge_mm)
      .def_readwrite("pressure_mpa", &Noise::pressure_mpa);
  py::class_<Result>(
      module, "WrenchResult",
      "Six-axis force and moment that the object exerts on the pad, the moment about\n"
      "the center of the base; a press has force_n[2] < 0. NaN unless ok.")
      .def_property_readonly("ok", &Result::ok)
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_property_readonly("force_n", [](const Result& r) { return as_tuple(r.force_n); })
      .def_property_readonly("moment_n_mm", [](const Result& r) { return as_tuple(r.moment_n_mm); })
      .def_readonly("covariance", &Result::covariance,
                    "6 x 6, of force and moment, N and N mm; 0 without WrenchNoise")
      .def_readonly("summit_area_mm2", &Result::summit_area_mm2)
      .def_readonly("modulus_n_per_mm", &Result::modulus_n_per_mm)
      .def_readonly("residual", &Result::residual)
      .def_readonly("by_modulus", &Result::by_modulus)
      .def_readonly("missing", &Result::missing, "side dots that were not found")
      .def_readonly("unstretched", &Result::unstretched, "side dots without a usable direction")
      .def_readonly("broken_lines", &Result::broken_lines)
      .def_readonly("level_lines", &Result::level_lines);
  py::class_<WrenchOfDepth>(module, "Wrench",
                            "Six-axis force from depth map, side dots and pressure;\n"
                            "force/wrench.hpp.")
      .def(py::init<const fingerpad::Camera<double>&, const Count&, const Count&, const Array&,
                    const Options&, const OneRow&>(),
           py::arg("camera"), py::arg("rows"), py::arg("cols"), py::arg("rim_mm"),
           py::arg("options") = Options(), py::arg("side_dots") = OneRow(),
           "rows, cols: of the depth maps, px. rim_mm: float64 (1, n, 3), where the side dots are\n"
           "fixed, n >= 6.")
      .def("__call__", &WrenchOfDepth::operator(), py::arg("depth_mm"), py::arg("mask"),
           py::arg("side_dots_mm"), py::arg("pressure_mpa"), py::arg("noise") = Noise(),
           "result = wrench(depth_mm, mask, side_dots_mm, pressure_mpa)\n\n"
           "depth_mm: float32 (rows, cols), NaN where unknown. mask: uint8 or bool (rows, cols).\n"
           "side_dots_mm: float64 (1, n, 3), NaN where not found. pressure_mpa: MPa above the\n"
           "air pressure. For arrays of another size the status is \"refused\".")
      .def("by_modulus", &WrenchOfDepth::by_modulus, py::arg("side_dots_mm"),
           py::arg("pressure_mpa"), py::arg("noise") = Noise(),
           "The same without a depth map, from calibrated_modulus_n_per_mm.");
}

}  // namespace python
