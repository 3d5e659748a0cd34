// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "python/look_up.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "fingerpad/calibrate/force.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::CurveOptions;
using fingerpad::FitOptions;
using fingerpad::Point2;
using Curve = fingerpad::PolynomialForce<3>;
using NormalFit = fingerpad::NormalForceFit<Curve>;
using NormalResult = fingerpad::NormalForceResult<double>;
using Sample = fingerpad::ForceSample<double>;
using Samples = std::vector<Sample>;
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
                           const Array& displacement_mm,
                           const Array& rotation_rad,
                           const CurveOptions& curve,
                           const FitOptions& options) {
  Samples samples = samples_of(measure);
  fill(samples, normal_force_n, "normal_force_n", 1,
       [](Sample& s, Cell x, Cell) { s.normal_force_n = *x; });
  if (!displacement_mm.is_none()) {
    fill(samples, displacement_mm, "displacement_mm", 2, [](Sample& s, Cell x, Cell y) {
      s.displacement_mm = {*x, *y};
    });
  }
  if (!rotation_rad.is_none()) {
    fill(samples, rotation_rad, "rotation_rad", 1,
         [](Sample& s, Cell x, Cell) { s.rotation_rad = *x; });
  }
  return without_lock(
      [&] { return fingerpad::fit_normal_force<3, double>(samples, curve, options); });
}

ShearFit fit_tangential_force(const Array& measure,
                              const Array& displacement_mm,
                              const Array& tangential_force_n,
                              const Number& reference,
                              const std::optional<double>& exponent,
                              const FitOptions& options) {
  Samples samples = samples_of(measure);
  fill(samples, displacement_mm, "displacement_mm", 2, [](Sample& s, Cell x, Cell y) {
    s.displacement_mm = {*x, *y};
  });
  fill(samples, tangential_force_n, "tangential_force_n", 2, [](Sample& s, Cell x, Cell y) {
    s.tangential_force_n = {*x, *y};
  });
  const double at = number_of(reference, "reference");
  return without_lock([&]() -> ShearFit {
    return {fingerpad::fit_tangential_force<1, double>(samples, at, exponent, options), at};
  });
}

ShearFit fit_moment(const Array& measure,
                    const Array& rotation_rad,
                    const Array& moment_n_mm,
                    const Number& reference,
                    const std::optional<double>& exponent,
                    const FitOptions& options) {
  Samples samples = samples_of(measure);
  fill(samples, rotation_rad, "rotation_rad", 1,
       [](Sample& s, Cell x, Cell) { s.rotation_rad = *x; });
  fill(samples, moment_n_mm, "moment_n_mm", 1, [](Sample& s, Cell x, Cell) { s.moment_n_mm = *x; });
  const double at = number_of(reference, "reference");
  return without_lock([&]() -> ShearFit {
    return {fingerpad::fit_moment<1, double>(samples, at, exponent, options), at};
  });
}

/// The curve of a fit in the type that Fingertip uses; the higher coefficients are 0.
NormalForce normal_force_of(const NormalFit& fit) {
  fingerpad::PolynomialForce<5> curve;
  curve.from = fit.curve.from;
  curve.to = fit.curve.to;
  NormalForce::Errors errors;
  errors.residual_sd_n = fit.errors.residual_sd_n;
  errors.measure_sd = fit.errors.measure_sd;
  for (std::size_t i = 0; i < Curve::parameters; ++i) {
    curve.coefficients[i] = fit.curve.coefficients[i];
    for (std::size_t j = 0; j < Curve::parameters; ++j) {
      errors.covariance[i][j] = fit.errors.covariance[i][j];
    }
  }
  return {curve, fit.compensation, errors};
}

Shear shear_of(const ShearFit& force, const ShearFit& moment) {
  if (force.reference < moment.reference || moment.reference < force.reference) {
    throw py::value_error("force and moment must be fitted with one reference, not " +
                          std::to_string(force.reference) + " and " +
                          std::to_string(moment.reference));
  }
  const auto widened = [](const auto& narrow) {
    fingerpad::detail::OddPolynomial<4> wide;
    wide.coefficients = {narrow.coefficients[0], 0, 0, 0};
    wide.to = narrow.to;
    return wide;
  };
  return {{force.reference, force.fit.exponent, moment.fit.exponent},
          {widened(force.fit.polynomial), widened(moment.fit.polynomial)}};
}

Point2<double> displacement_of(const Array& given) {
  const auto xy = numbers_of(given, "displacement_mm");
  if (xy.ndim() != 1 || xy.shape(0) != 2) {
    throw py::value_error("displacement_mm must be (x, y)");
  }
  return {xy.at(0), xy.at(1)};
}

void bind_results(py::module_& module) {
  py::class_<NormalResult>(module, "NormalForceResult", "A normal force; force/normal_force.hpp.")
      .def_property_readonly("ok", &NormalResult::ok, "whether the calibration vouches for it")
      .def_property_readonly("status", [](const NormalResult& r) { return name_of(r.status); })
      .def_readonly("force_n", &NormalResult::force_n, "pressing force, N, >= 0")
      .def_readonly("variance_n2", &NormalResult::variance_n2, "N^2");
  py::class_<fingerpad::FusedForce<double>>(module, "FusedForce",
                                            "Normal force from area and depth together.")
      .def_property_readonly("ok", &fingerpad::FusedForce<double>::ok)
      .def_property_readonly(
          "status", [](const fingerpad::FusedForce<double>& r) { return name_of(r.status); })
      .def_readonly("force_n", &fingerpad::FusedForce<double>::force_n)
      .def_readonly("variance_n2", &fingerpad::FusedForce<double>::variance_n2)
      .def_readonly("disagreement", &fingerpad::FusedForce<double>::disagreement,
                    "difference of the two forces, in standard deviations");
  py::class_<ShearResult>(module, "ShearResult", "Tangential force and moment; force/shear.hpp.")
      .def_property_readonly("ok", &ShearResult::ok)
      .def_property_readonly("force_status",
                             [](const ShearResult& r) { return name_of(r.force_status); })
      .def_property_readonly("moment_status",
                             [](const ShearResult& r) { return name_of(r.moment_status); })
      .def_property_readonly("tangential_force_n",
                             [](const ShearResult& r) { return as_tuple(r.tangential_force_n); })
      .def_readonly("moment_n_mm", &ShearResult::moment_n_mm);
}

void bind_normal_force_fit(py::module_& module) {
  bind_options<FitOptions>(module, "FitOptions", "Options of force fits; see calibrate/fit.hpp.")
      .def_readwrite("robust", &FitOptions::robust)
      .def_readwrite("min_explained", &FitOptions::min_explained);
  bind_options<CurveOptions>(module, "CurveOptions",
                             "What fit_normal_force fits; see calibrate/force.hpp.")
      .def_readwrite("through_zero", &CurveOptions::through_zero)
      .def_readwrite("rising", &CurveOptions::rising)
      .def_readwrite("displaced", &CurveOptions::displaced)
      .def_readwrite("rotated", &CurveOptions::rotated);
  py::class_<NormalFit>(module, "NormalForceFit", "A fitted curve; NormalForce(fit) looks it up.")
      .def_property_readonly("ok", &NormalFit::ok)
      .def_property_readonly("status", [](const NormalFit& f) { return text_of(f); })
      .def_property_readonly(
          "coefficients", [](const NormalFit& f) { return f.curve.coefficients; },
          "c_0 to c_3 of c_0 + c_1 m + ..., N over the measure's unit to the k-th")
      .def_property_readonly(
          "covariance", [](const NormalFit& f) { return f.errors.covariance; },
          "4 x 4 covariance of the coefficients")
      .def_property_readonly(
          "range",
          [](const NormalFit& f) {
            return std::array{f.curve.from, f.curve.to};
          },
          "smallest and largest measure")
      .def_property_readonly("residual_sd_n",
                             [](const NormalFit& f) { return f.errors.residual_sd_n; })
      .def_property_readonly("per_mm_sq",
                             [](const NormalFit& f) { return f.compensation.per_mm_sq; })
      .def_property_readonly("per_rad_sq",
                             [](const NormalFit& f) { return f.compensation.per_rad_sq; })
      .def_readonly("explained", &NormalFit::explained, "explained share of the variance");
}

void bind_shear_fit(py::module_& module) {
  py::class_<ShearFit>(module, "ShearFit", "A fitted stiffness; Shear(force, moment) looks it up.")
      .def_property_readonly("ok", [](const ShearFit& f) { return f.fit.ok(); })
      .def_property_readonly("status", [](const ShearFit& f) { return text_of(f.fit); })
      .def_property_readonly(
          "stiffness", [](const ShearFit& f) { return f.fit.polynomial.coefficients[0]; },
          "N/mm, or N mm/rad")
      .def_property_readonly("stiffness_sd",
                             [](const ShearFit& f) { return f.fit.standard_errors[0]; })
      .def_property_readonly(
          "to", [](const ShearFit& f) { return f.fit.polynomial.to; }, "mm, or rad")
      .def_property_readonly("exponent", [](const ShearFit& f) { return f.fit.exponent; })
      .def_property_readonly("exponent_sd", [](const ShearFit& f) { return f.fit.exponent_sd; })
      .def_property_readonly("residual_sd", [](const ShearFit& f) { return f.fit.residual_sd; })
      .def_property_readonly("explained", [](const ShearFit& f) { return f.fit.explained; });
}

void bind_fits(py::module_& module) {
  module.def(
      "fit_normal_force", &fit_normal_force, py::arg("measure"), py::arg("normal_force_n"),
      py::arg("displacement_mm") = py::none(), py::arg("rotation_rad") = py::none(),
      py::arg("curve") = CurveOptions(), py::arg("options") = FitOptions(),
      "Fits a cubic curve to n contacts with forces of a gauge; see calibrate/force.hpp.\n\n"
      "measure: (n,), area in mm^2 or depth in mm. normal_force_n: (n,), N, > 0 for a press.\n"
      "displacement_mm: (n, 2), rotation_rad: (n,), for CurveOptions(displaced=True,\n"
      "rotated=True). NaN: not measured.");
  module.def("fit_tangential_force", &fit_tangential_force, py::arg("measure"),
             py::arg("displacement_mm"), py::arg("tangential_force_n"), py::arg("reference"),
             py::arg("exponent") = py::none(), py::arg("options") = FitOptions(),
             "Force along the plate, proportional to (measure / reference)^exponent d.\n\n"
             "measure: (n,). displacement_mm: (n, 2). tangential_force_n: (n, 2), N.\n"
             "exponent: fitted if None.");
  module.def("fit_moment", &fit_moment, py::arg("measure"), py::arg("rotation_rad"),
             py::arg("moment_n_mm"), py::arg("reference"), py::arg("exponent") = py::none(),
             py::arg("options") = FitOptions(),
             "Moment about the contact's normal, likewise. All (n,); rad, N mm.");
}

}  // namespace

void bind_look_up(py::module_& module) {
  bind_results(module);
  bind_normal_force_fit(module);
  bind_shear_fit(module);
  bind_fits(module);
  py::class_<NormalForce>(module, "NormalForce",
                          "Normal force by one measure of the contact; force/normal_force.hpp.")
      .def(py::init(&normal_force_of), py::arg("fit"))
      .def(
          "__call__",
          [](const NormalForce& force, const Number& measure, const Array& displacement_mm,
             const Number& rotation_rad) {
            return force(number_of(measure, "measure"), displacement_of(displacement_mm),
                         number_of(rotation_rad, "rotation_rad"));
          },
          py::arg("measure"), py::arg("displacement_mm") = py::make_tuple(0.0, 0.0),
          py::arg("rotation_rad") = py::float_(0.0),
          "result = force(measure, displacement_mm, rotation_rad)\n\n"
          "measure: mm^2 or mm, as in the fit. displacement_mm: (x, y).");
  py::class_<Shear>(module, "Shear", "Tangential force and moment by look-up; force/shear.hpp.")
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
