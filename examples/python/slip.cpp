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
using fingerpad::StickTest;
using Result = fingerpad::StickRatioResult<float>;

/// A stick ratio with its state; calls from several threads are serialised.
class Ratio {
  using Method = fingerpad::StickRatio<>;

 public:
  Ratio(const Count& rows, const Count& cols, const StickTest& test)
      : ratio_(count_of(rows, "rows"), count_of(cols, "cols"), test), state_(ratio_.start()) {}

  py::tuple operator()(const Array& dots_px, const Array& in_contact, const Number& time) {
    const double time_s = number_of(time, "time_s");
    auto [states, view] = new_array<std::uint8_t>(ratio_.rows(), ratio_.cols());
    fingerpad::StridedView<DotState> to(reinterpret_cast<DotState*>(view.row(0)), ratio_.rows(),
                                        ratio_.cols(), ratio_.cols());
    const auto dots = dots_px_of(dots_px, "dots_px");
    const auto touching = mask_of(in_contact, "in_contact");
    const Result result = [&] {
      const py::gil_scoped_release release;
      const std::scoped_lock lock(mutex_);
      return ratio_(dots, touching, to, state_, time_s);
    }();
    if (!result.accepted()) {
      throw py::value_error("dots_px and in_contact must have " + std::to_string(ratio_.rows()) +
                            " x " + std::to_string(ratio_.cols()) + " dots");
    }
    return py::make_tuple(states, result);
  }

  void reset() {
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    state_ = ratio_.start();
  }

 private:
  Method ratio_;
  Method::State state_;
  std::mutex mutex_;
};

}  // namespace

void bind_slip(py::module_& module) {
  bind_options<StickTest>(
      module, "StickTest",
      "Thresholds for comparing dots and detecting slip; see slip/stick_ratio.hpp.")
      .def_readwrite("reference", &StickTest::reference, "U, pitches, > 0")
      .def_readwrite("store", &StickTest::store, "U_min, pitches, in [0, reference]")
      .def_readwrite("slip", &StickTest::slip, "delta_0, pitches, > 0")
      .def_readwrite("pitch", &StickTest::pitch,
                     "distance of neighbouring dots; 0: measured; 1: the three values above are in "
                     "the unit of the dots")
      .def_readwrite("min_dots", &StickTest::min_dots, ">= 1")
      .def_readwrite("free_frames", &StickTest::free_frames,
                     "frames of the free pad in which the noise is measured; 0: none")
      .def_readwrite("hold_s", &StickTest::hold_s, "s, >= 0")
      .def_readwrite("covers_pattern", &StickTest::covers_pattern,
                     "whether the object is larger than the dot pattern; if not, there is no ratio "
                     "while all dots count as in contact and some do not follow");
  py::enum_<DotState>(module, "DotState", "State of a dot.")
      .value("none", DotState::none)
      .value("unknown", DotState::unknown)
      .value("slip", DotState::slip)
      .value("stick", DotState::stick);
  py::class_<Result>(module, "StickRatioResult",
                     "Stick and slip of a frame; slip/stick_result.hpp.")
      .def_property_readonly("ok", &Result::ok, "whether the ratio may be used")
      .def_property_readonly("updated", &Result::updated, "whether the ratio is of this frame")
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_readonly("stick", &Result::stick, "dots in contact that stick")
      .def_readonly("slip", &Result::slip, "dots in contact that slip")
      .def_readonly("unknown", &Result::unknown, "dots in contact of unknown state")
      .def_readonly("out_of_place", &Result::out_of_place)
      .def_readonly("furthest_px", &Result::furthest_px)
      .def_readonly("stick_ratio", &Result::stick_ratio, "in [0, 1]; NaN if not known yet")
      .def_readonly("ratio_sd", &Result::ratio_sd,
                    "standard deviation of stick_ratio from the noise of the dots")
      .def_readonly("reference_age", &Result::reference_age, "frames")
      .def_readonly("angle_rad", &Result::angle_rad, "rotation of the object since the reference")
      .def_readonly("scale", &Result::scale);
  py::class_<Ratio>(module, "StickRatio",
                    "Computes the share of the contact that sticks from printed dots; see\n"
                    "slip/stick_ratio.hpp. It stores past frames: use one object for each pad.")
      .def(py::init<const Count&, const Count&, const StickTest&>(), py::arg("rows"),
           py::arg("cols"), py::arg("test") = StickTest())
      .def("__call__", &Ratio::operator(), py::arg("dots_px"), py::arg("in_contact"),
           py::arg("time_s") = py::float_(fingerpad::not_a_number<double>()),
           "states, result = ratio(dots_px, in_contact, time_s)\n\n"
           "dots_px: float64 (rows, cols, 2), x and y in px, NaN where not found.\n"
           "in_contact: uint8 or bool (rows, cols). time_s: s; NaN: not known.\n"
           "states: uint8 (rows, cols), a DotState each.")
      .def("reset", &Ratio::reset, "Forgets all frames.");
}

}  // namespace python
