// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cstdint>
#include <mutex>

#include "fingerpad/slip/stick_ratio.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::DotState;
using fingerpad::StickOptions;
using Result = fingerpad::StickResult<>;

/// A stick ratio; calls from several threads are serialised.
class Ratio {
  using Method = fingerpad::StickRatio<>;

 public:
  Ratio(const Count& rows, const Count& cols, const StickOptions& options)
      : stick_(count_of(rows, "rows"), count_of(cols, "cols"), options) {}

  py::tuple operator()(const Array& dots, const Array& in_contact, const Number& time) {
    const double time_s = number_of(time, "time_s");
    const py::array array = array_of(dots, "dots");
    const bool in_space = array.ndim() == 3 && array.shape(2) == 3;
    auto [states, to] = new_array<std::uint8_t>(stick_.rows(), stick_.cols());
    const auto touching = mask_of(in_contact, "in_contact");
    const auto look = [&](const auto& from) {
      const py::gil_scoped_release release;
      const std::scoped_lock lock(mutex_);
      const Result result = stick_(from, touching, time_s);
      for (fingerpad::Index i = 0; i < to.rows(); ++i) {
        for (fingerpad::Index j = 0; j < to.cols(); ++j) {
          to(i, j) = static_cast<std::uint8_t>(stick_.states()(i, j));
        }
      }
      return result;
    };
    const Result result =
        in_space ? look(dots_mm_of(dots, "dots")) : look(dots_px_of(dots, "dots"));
    if (!result.accepted()) {
      throw py::value_error("dots and in_contact must have " + std::to_string(stick_.rows()) +
                            " x " + std::to_string(stick_.cols()) + " dots");
    }
    return py::make_tuple(states, result);
  }

  void reset() {
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    stick_.reset();
  }

 private:
  Method stick_;
  std::mutex mutex_;
};

}  // namespace

void bind_slip(py::module_& module) {
  bind_options<StickOptions>(
      module, "StickOptions",
      "Noise of the dots, in their unit, and what counts as slip; see docs/slip/stick_ratio.md.")
      .def_readwrite("noise", &StickOptions::noise,
                     "standard deviation of a dot along x and along y; 0: measured")
      .def_readwrite("slip_share", &StickOptions::slip_share)
      .def_readwrite("covers_pattern", &StickOptions::covers_pattern,
                     "whether the object is larger than the dot pattern; if not, there is no ratio "
                     "while all dots count as in contact and some do not follow");
  py::enum_<DotState>(module, "DotState", "State of a dot.")
      .value("none", DotState::none)
      .value("unknown", DotState::unknown)
      .value("slip", DotState::slip)
      .value("stick", DotState::stick);
  py::class_<Result>(module, "StickResult",
                     "Stick and slip of a frame; see docs/slip/stick_ratio.md.")
      .def_property_readonly("ok", &Result::ok, "whether the ratio may be used")
      .def_property_readonly("updated", &Result::updated, "whether the ratio is of this frame")
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_readonly("stick", &Result::stick, "dots in contact that stick")
      .def_readonly("slip", &Result::slip, "dots in contact that slip")
      .def_readonly("unknown", &Result::unknown, "dots in contact of unknown state")
      .def_readonly("out_of_place", &Result::out_of_place)
      .def_readonly("far_apart", &Result::far_apart,
                    "whether a dot has moved by more than half a pitch since the frame before")
      .def_property_readonly(
          "back", [](const Result& r) { return py::make_tuple(r.back_ratio, r.back_age); },
          "stick ratio and age of its reference, if the dots fall back")
      .def_readonly("stick_ratio", &Result::stick_ratio, "in [0, 1]; NaN if not known yet")
      .def_readonly("ratio_sd", &Result::ratio_sd, "standard deviation of stick_ratio")
      .def_readonly("furthest", &Result::furthest)
      .def_readonly("reference_age", &Result::reference_age, "frames")
      .def_property_readonly(
          "motion", [](const Result& r) { return pose_tuple(r.motion); },
          "(R, t) of the object since the reference: x_now = scale R x_then + t")
      .def_readonly("scale", &Result::scale);
  py::class_<Ratio>(
      module, "StickRatio",
      "Computes the share of the contact that sticks from printed dots; see\n"
      "see docs/slip/stick_ratio.md. It stores past frames: use one object for each pad.")
      .def(py::init<const Count&, const Count&, const StickOptions&>(), py::arg("rows"),
           py::arg("cols"), py::arg("options") = StickOptions())
      .def(
          "__call__", &Ratio::operator(), py::arg("dots"), py::arg("in_contact"),
          py::arg("time_s") = py::float_(fingerpad::not_a_number<double>()),
          "states, result = ratio(dots, in_contact, time_s)\n\n"
          "dots: float64, (rows, cols, 2) in the image or (rows, cols, 3) in space, NaN where not\n"
          "found.\n"
          "in_contact: uint8 or bool (rows, cols). time_s: s; NaN: not known.\n"
          "states: uint8 (rows, cols), a DotState each.")
      .def("reset", &Ratio::reset, "Forgets all frames.");
}

}  // namespace python
