// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/look_up.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/force/look_up.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::Point2;
using NormalForce = fingerpad::NormalForce<>;
using NormalFit = fingerpad::NormalForceFit<>;
using ForceResult = fingerpad::ForceResult<double>;
using Sample = fingerpad::ForceSample<double>;
using Samples = std::vector<Sample>;
using Shear = fingerpad::Shear<>;
using ShearResult = fingerpad::ShearResult<double>;

/// A fit with the reference measure of its normalisation.
struct ShearFit {
  fingerpad::ShearFit<> fit;
  double reference;
};

/// Writes cell (i, k) of a column of shape (n,) or (n, 2) into sample i. Raises ValueError for
/// another shape.
template <class Write>
void fill(Samples& samples, const Array& given, const char* name, int width, const Write& write) {
  const auto column = numbers_of(given, name);
  const auto count = static_cast<py::ssize_t>(samples.size());
  const bool fits =
      width == 1 ? column.ndim() == 1 : column.ndim() == 2 && column.shape(1) == width;
  if (!fits || column.shape(0) != count) {
    throw py::value_error(std::string(name) + " must have the shape (" + std::to_string(count) +
                          (width == 1 ? ",)" : ", " + std::to_string(width) + ")") + ", not " +
                          std::string(py::str(column.attr("shape"))));
  }
  for (py::ssize_t i = 0; i < count; ++i) {
    Sample& sample = samples[static_cast<std::size_t>(i)];
    if (width == 1) {
      write(sample, column.data(i), column.data(i));
    } else {
      write(sample, column.data(i, 0), column.data(i, 1));
    }
  }
}

using Cell = const double*;

Samples samples_of(const Array& measure) {
  Samples samples(static_cast<std::size_t>(numbers_of(measure, "measure").size()));
  fill(samples, measure, "measure", 1, [](Sample& s, Cell x, Cell) { s.measure = *x; });
  return samples;
}

template <class Fit>
auto without_lock(const Fit& fit) {
  const py::gil_scoped_release release;
  return fit();
}

NormalFit fit_normal_force(const Array& measure,
                           const Array& normal_force_n,
                           int degree,
                           bool through_zero) {
  Samples samples = samples_of(measure);
  fill(samples, normal_force_n, "normal_force_n", 1,
       [](Sample& s, Cell x, Cell) { s.normal_force_n = *x; });
  return without_lock(
      [&] { return fingerpad::fit_normal_force<double>(samples, degree, through_zero); });
}

ShearFit fit_tangential_force(const Array& measure,
                              const Array& displacement_mm,
                              const Array& tangential_force_n,
                              const Number& reference,
                              const std::optional<double>& exponent) {
  Samples samples = samples_of(measure);
  fill(samples, displacement_mm, "displacement_mm", 2, [](Sample& s, Cell x, Cell y) {
    s.displacement_mm = {*x, *y};
  });
  fill(samples, tangential_force_n, "tangential_force_n", 2, [](Sample& s, Cell x, Cell y) {
    s.tangential_force_n = {*x, *y};
  });
  const double at = number_of(reference, "reference");
  return without_lock([&]() -> ShearFit {
    return {fingerpad::fit_tangential_force<double>(samples, at, exponent), at};
  });
}

ShearFit fit_moment(const Array& measure,
                    const Array& rotation_rad,
                    const Array& moment_n_mm,
                    const Number& reference,
                    const std::optional<double>& exponent) {
  Samples samples = samples_of(measure);
  fill(samples, rotation_rad, "rotation_rad", 1,
       [](Sample& s, Cell x, Cell) { s.rotation_rad = *x; });
  fill(samples, moment_n_mm, "moment_n_mm", 1, [](Sample& s, Cell x, Cell) { s.moment_n_mm = *x; });
  const double at = number_of(reference, "reference");
  return without_lock([&]() -> ShearFit {
    return {fingerpad::fit_moment<double>(samples, at, exponent), at};
  });
}

NormalForce normal_force_of(const NormalFit& fit) {
  return NormalForce(fit.curve);
}

Shear shear_of(const ShearFit& force, const ShearFit& moment) {
  if (force.reference < moment.reference || moment.reference < force.reference) {
    throw py::value_error("force and moment must be fitted with one reference, not " +
                          std::to_string(force.reference) + " and " +
                          std::to_string(moment.reference));
  }
  return Shear({force.reference, force.fit.law, moment.fit.law});
}

Point2<double> displacement_of(const Array& given) {
  const auto xy = numbers_of(given, "displacement_mm");
  if (xy.ndim() != 1 || xy.shape(0) != 2) {
    throw py::value_error("displacement_mm must be (x, y)");
  }
  return {xy.at(0), xy.at(1)};
}

void bind_results(py::module_& module) {
  py::class_<ForceResult>(module, "ForceResult", "A normal force; see docs/force/normal_force.md.")
      .def_property_readonly("ok", &ForceResult::ok, "whether the calibration vouches for it")
      .def_property_readonly("status", [](const ForceResult& r) { return name_of(r.status); })
      .def_readonly("force_n", &ForceResult::force_n, "pressing force, N, >= 0")
      .def_readonly("variance_n2", &ForceResult::variance_n2, "N^2")
      .def_readonly("disagreement", &ForceResult::disagreement,
                    "difference of the forces by area and by depth, in standard deviations");
  py::class_<ShearResult>(module, "ShearResult",
                          "Tangential force and moment; see docs/force/shear.md.")
      .def_property_readonly("ok", &ShearResult::ok)
      .def_property_readonly("status", [](const ShearResult& r) { return name_of(r.status); })
      .def_property_readonly("tangential_force_n",
                             [](const ShearResult& r) { return as_tuple(r.tangential_force_n); })
      .def_readonly("moment_n_mm", &ShearResult::moment_n_mm);
}

void bind_normal_force_fit(py::module_& module) {
  py::class_<NormalFit>(module, "NormalForceFit", "A fitted curve; NormalForce(fit) looks it up.")
      .def_property_readonly("ok", &NormalFit::ok)
      .def_property_readonly("status", [](const NormalFit& f) { return text_of(f); })
      .def_property_readonly(
          "coefficients", [](const NormalFit& f) { return f.curve.coefficients; },
          "c_0 to c_3 of c_0 + c_1 m + ..., N over the measure's unit to the k-th")
      .def_property_readonly(
          "covariance", [](const NormalFit& f) { return f.curve.covariance; },
          "4 x 4 covariance of the coefficients")
      .def_property_readonly(
          "range",
          [](const NormalFit& f) {
            return std::array{f.curve.from, f.curve.to};
          },
          "smallest and largest measure")
      .def_property_readonly("residual_sd_n",
                             [](const NormalFit& f) { return f.curve.residual_sd_n; })
      .def_readonly("explained", &NormalFit::explained, "explained share of the variance");
}

void bind_shear_fit(py::module_& module) {
  py::class_<ShearFit>(module, "ShearFit", "A fitted stiffness; Shear(force, moment) looks it up.")
      .def_property_readonly("ok", [](const ShearFit& f) { return f.fit.ok(); })
      .def_property_readonly("status", [](const ShearFit& f) { return text_of(f.fit); })
      .def_property_readonly(
          "stiffness", [](const ShearFit& f) { return f.fit.law.slope; }, "N/mm, or N mm/rad")
      .def_property_readonly("stiffness_sd",
                             [](const ShearFit& f) { return std::sqrt(f.fit.covariance[0][0]); })
      .def_property_readonly(
          "to", [](const ShearFit& f) { return f.fit.law.to; }, "mm, or rad")
      .def_property_readonly("exponent", [](const ShearFit& f) { return f.fit.law.exponent; })
      .def_property_readonly("exponent_sd",
                             [](const ShearFit& f) { return std::sqrt(f.fit.covariance[1][1]); })
      .def_property_readonly("residual_sd", [](const ShearFit& f) { return f.fit.residual_sd; })
      .def_property_readonly("explained", [](const ShearFit& f) { return f.fit.explained; });
}

void bind_fits(py::module_& module) {
  module.def(
      "fit_normal_force", &fit_normal_force, py::arg("measure"), py::arg("normal_force_n"),
      py::arg("degree") = 2, py::arg("through_zero") = true,
      "Fits a curve to n contacts with forces of a gauge; see docs/calibrate/calibration.md.\n\n"
      "measure: (n,), area in mm^2 or depth in mm. normal_force_n: (n,), N, > 0 for a press.\n"
      "NaN: not measured.");
  module.def("fit_tangential_force", &fit_tangential_force, py::arg("measure"),
             py::arg("displacement_mm"), py::arg("tangential_force_n"), py::arg("reference"),
             py::arg("exponent") = py::none(),
             "Force along the plate, proportional to (measure / reference)^exponent d.\n\n"
             "measure: (n,). displacement_mm: (n, 2). tangential_force_n: (n, 2), N.\n"
             "exponent: fitted if None.");
  module.def("fit_moment", &fit_moment, py::arg("measure"), py::arg("rotation_rad"),
             py::arg("moment_n_mm"), py::arg("reference"), py::arg("exponent") = py::none(),
             "Moment about the contact's normal, likewise. All (n,); rad, N mm.");
}

}  // namespace

void bind_look_up(py::module_& module) {
  bind_results(module);
  bind_normal_force_fit(module);
  bind_shear_fit(module);
  bind_fits(module);
  py::class_<NormalForce>(
      module, "NormalForce",
      "Normal force by one measure of the contact; see docs/force/normal_force.md.")
      .def(py::init(&normal_force_of), py::arg("fit"))
      .def(
          "__call__",
          [](const NormalForce& force, const Number& measure) {
            return force(number_of(measure, "measure"));
          },
          py::arg("measure"), "result = force(measure)\n\nmeasure: mm^2 or mm, as in the fit.");
  py::class_<Shear>(module, "Shear",
                    "Tangential force and moment by look-up; see docs/force/shear.md.")
      .def(py::init(&shear_of), py::arg("force"), py::arg("moment"),
           "force, moment: results of fit_tangential_force and fit_moment with the same reference.")
      .def(
          "__call__",
          [](const Shear& shear, const Number& measure, const Array& displacement_mm,
             const Number& rotation_rad) {
            return shear(number_of(measure, "measure"), displacement_of(displacement_mm),
                         number_of(rotation_rad, "rotation_rad"));
          },
          py::arg("measure"), py::arg("displacement_mm"), py::arg("rotation_rad"),
          "result = shear(measure, displacement_mm, rotation_rad)");
}

}  // namespace python
