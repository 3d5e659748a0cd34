// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <pybind11/stl.h>

#include <array>
#include <string>
#include <vector>

#include "fingerpad/pipeline/foam_hand.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::FingerSample;
using fingerpad::PreslipRule;
using fingerpad::PreslipStatus;
using Taxels = fingerpad::TaxelOptions;
using Rules = fingerpad::PreslipOptions;
using Hand = fingerpad::FoamHand<>;

Hand make_hand(const Count& rows, const Count& cols, const Taxels& taxels, const Rules& rules) {
  const fingerpad::TaxelFeatures<> finger(count_of(rows, "rows"), count_of(cols, "cols"), taxels);
  return Hand({finger, finger}, rules);
}

/// Result of one sample of all fingers.
struct Felt {
  PreslipStatus status;
  std::vector<FingerSample<double>> fingers;
};

Felt feel(Hand& hand, const Array& readings, const Number& time_s) {
  if (!PySequence_Check(readings.ptr()) || py::len(readings) != 2) {
    throw py::type_error("readings must be the arrays of two fingers, (left, right)");
  }
  const py::object left = readings[py::int_(0)], right = readings[py::int_(1)];
  const PreslipStatus status =
      hand(std::array{view_of<double>(left, "readings[0]"), view_of<double>(right, "readings[1]")},
           number_of(time_s, "time_s"));
  return {status, {hand.fingers().begin(), hand.fingers().end()}};
}

}  // namespace

void bind_foam(py::module_& module) {
  bind_options<Taxels>(module, "TaxelOptions",
                       "Evaluation of the taxels; see docs/foam/preslip.md.")
      .def_readwrite("pitch_mm", &Taxels::pitch_mm)
      .def_readwrite("window", &Taxels::window)
      .def_readwrite("sample_period_s", &Taxels::sample_period_s)
      .def_readwrite("noise", &Taxels::noise)
      .def_readwrite("noise_factor", &Taxels::noise_factor)
      .def_readwrite("saturated_at", &Taxels::saturated_at);
  py::enum_<PreslipRule>(module, "PreslipRule", "Which rule; see docs/foam/preslip.md.")
      .value("grasp_lift", PreslipRule::grasp_lift)
      .value("grasp_optimise", PreslipRule::grasp_optimise)
      .value("printed_grasp_optimise", PreslipRule::printed_grasp_optimise);
  bind_options<Rules>(module, "PreslipOptions",
                      "Options of the pre-slip rules; see docs/foam/preslip.md.")
      .def_readwrite("rule", &Rules::rule)
      .def_readwrite("history", &Rules::history)
      .def_readwrite("min_waves", &Rules::min_waves)
      .def_readwrite("centroid_tolerance_mm", &Rules::centroid_tolerance_mm);
  py::enum_<PreslipStatus>(module, "PreslipStatus", "Whether the held object is about to slip.")
      .value("steady", PreslipStatus::steady)
      .value("preslip", PreslipStatus::preslip)
      .value("slipped", PreslipStatus::slipped)
      .value("cannot_tell", PreslipStatus::cannot_tell);
  py::class_<FingerSample<double>>(module, "FingerSample", "Result of one finger.")
      .def_property_readonly("status",
                             [](const FingerSample<double>& s) { return name_of(s.status); })
      .def_readonly("center_x_mm", &FingerSample<double>::center_x_mm)
      .def_readonly("center_y_mm", &FingerSample<double>::center_y_mm)
      .def_readonly("sum", &FingerSample<double>::sum)
      .def_readonly("location", &FingerSample<double>::location)
      .def_readonly("waves", &FingerSample<double>::waves)
      .def_readonly("frequency_hz", &FingerSample<double>::frequency_hz);
  py::class_<Felt>(module, "FoamHandResult", "Result of one sample of all fingers.")
      .def_property_readonly(
          "ok", [](const Felt& felt) { return felt.status != PreslipStatus::cannot_tell; })
      .def_readonly("status", &Felt::status)
      .def_readonly("fingers", &Felt::fingers);
  py::class_<Hand>(
      module, "FoamHand",
      "Two foam fingers; see docs/pipeline/foam_hand.md. It stores past samples: use one\n"
      "object for each hand and thread.")
      .def(py::init(&make_hand), py::arg("rows"), py::arg("cols"), py::arg("taxels") = Taxels(),
           py::arg("rules") = Rules())
      .def("__call__", &feel, py::arg("readings"), py::arg("time_s"),
           "felt = hand((left, right), time_s)\n\n"
           "left, right: float64 (rows, cols), NaN where missing.")
      .def("reset", &Hand::reset);
}

}  // namespace python
