// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/wrench.hpp"

#include <pybind11/stl.h>

#include <array>
#include <mutex>
#include <vector>

#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using Options = fingerpad::WrenchOptions;
using Result = fingerpad::WrenchResult;

/// Six-axis force from dots in the picture; calls from several threads are serialised.
class WrenchOfDots {
 public:
  WrenchOfDots(const fingerpad::Camera<double>& camera, const Options& options)
      : wrench_(camera, options) {}

  /// Learns where the dots lie on the membrane; returns how many are near enough to the rim.
  Index learn(const Array& free_dots_px, const Number& pressure) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const auto dots = dots_px_of(free_dots_px, "free_dots_px");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    places_.clear();
    if (!wrench_.begin(pressure_mpa)) {
      return 0;
    }
    Index found = 0;
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const auto mark = wrench_.place_in_free_picture(dots(i, j));
        places_.push_back(mark.value_or(fingerpad::Mark{}));
        found += mark ? 1 : 0;
      }
    }
    return found;
  }

  Result operator()(const Array& dots_px, const Number& pressure, const Number& sd) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const double sd_px = number_of(sd, "sd_px");
    const auto dots = dots_px_of(dots_px, "dots_px");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    marks_.clear();
    for (Index k = 0; k < dots.rows() * dots.cols(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (at < places_.size() && places_[at].arc_mm > 0) {
        marks_.push_back({places_[at].arc_mm, places_[at].azimuth_rad,
                          dots(k / dots.cols(), k % dots.cols()), sd_px});
      }
    }
    return wrench_(marks_, pressure_mpa);
  }

 private:
  fingerpad::Wrench<> wrench_;
  std::vector<fingerpad::Mark> places_, marks_;
  std::mutex mutex_;
};

}  // namespace

void bind_wrench(py::module_& module) {
  bind_options<Options>(module, "WrenchOptions",
                        "Six axes from printed dots near the rim; see docs/force/wrench.md.")
      .def_property(
          "base_radius_mm", [](const Options& o) { return o.cap.base_radius_mm; },
          [](Options& o, double mm) { o.cap.base_radius_mm = mm; })
      .def_property(
          "stress_free_height_mm", [](const Options& o) { return o.cap.height_mm; },
          [](Options& o, double mm) { o.cap.height_mm = mm; })
      .def_property(
          "mooney_share", [](const Options& o) { return o.cap.mooney_share; },
          [](Options& o, double share) { o.cap.mooney_share = share; })
      .def_readwrite("modulus_n_per_mm", &Options::modulus_n_per_mm)
      .def_readwrite("modulus_sd_share", &Options::modulus_sd_share)
      .def_readwrite("pressure_sd_share", &Options::pressure_sd_share)
      .def_readwrite("reach_share", &Options::reach_share)
      .def_readwrite("loose_rim", &Options::loose_rim)
      .def_readwrite("thickness_mm", &Options::thickness_mm)
      .def_readwrite("full_scale_n", &Options::full_scale_n);
  py::class_<Result>(
      module, "WrenchResult",
      "Six-axis force and moment that the object exerts on the pad, the moment about\n"
      "the center of the base; a press has force_n[2] < 0. NaN where refused.")
      .def_property_readonly("ok", &Result::ok)
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_property_readonly("force_n", [](const Result& r) { return as_tuple(r.force_n); })
      .def_property_readonly("moment_n_mm", [](const Result& r) { return as_tuple(r.moment_n_mm); })
      .def_property_readonly(
          "covariance",
          [](const Result& r) {
            std::array<std::array<double, 6>, 6> rows;
            for (Eigen::Index i = 0; i < 36; ++i) {
              rows[static_cast<std::size_t>(i / 6)][static_cast<std::size_t>(i % 6)] =
                  r.covariance(i / 6, i % 6);
            }
            return rows;
          },
          "6 x 6, of force in N and moment in N mm")
      .def_readonly("pressure_mpa", &Result::pressure_mpa, "by gauge and dots together")
      .def_readonly("pressure_sd_mpa", &Result::pressure_sd_mpa)
      .def_readonly("misfit", &Result::misfit)
      .def_readonly("marks", &Result::marks, "dots used");
  py::class_<WrenchOfDots>(module, "Wrench",
                           "Six-axis force from the pixels of printed dots and the pressure;\n"
                           "see docs/force/wrench.md.")
      .def(py::init<const fingerpad::Camera<double>&, const Options&>(), py::arg("camera"),
           py::arg("options") = Options())
      .def("learn", &WrenchOfDots::learn, py::arg("free_dots_px"), py::arg("pressure_mpa"),
           "Takes the dots of the free pad, float32 or float64 (rows, cols, 2), NaN where not "
           "found; returns\n"
           "how many of them are near the rim.")
      .def("__call__", &WrenchOfDots::operator(), py::arg("dots_px"), py::arg("pressure_mpa"),
           py::arg("sd_px") = py::float_(0.06),
           "result = wrench(dots_px, pressure_mpa, sd_px)\n\n"
           "dots_px: float32 or float64 (rows, cols, 2) as in learn, NaN where not found or "
           "touched.\n"
           "pressure_mpa: MPa above the air pressure. sd_px: noise of a dot.");
}

}  // namespace python
