// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/pipeline/fingertip.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "python/arrays.hpp"
#include "python/look_up.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::FingertipResult;
using fingerpad::OneRow;
using fingerpad::SpatialStickTest;
using Reference = fingerpad::DepthReference<float>;
/// Every pixel, as arrays are read.
struct Methods : fingerpad::FingertipMethods {
  static constexpr int sampling = 1;
};
using Options = fingerpad::FingertipOptions<Reference>;
using WrenchOptions = fingerpad::WrenchOptions<double>;

/// Frames of several threads take turns.
class Fingertip {
 public:
  explicit Fingertip(const Options& options) : fingertip_(options) {}

  FingertipResult operator()(const py::array& red,
                             const py::array& green,
                             const py::array& dots_px,
                             const py::array& side_dots_mm,
                             double pressure_mpa,
                             double time_s) {
    const fingerpad::ColorFrame frame(view_of<std::uint8_t>(red, "red"),
                                      view_of<std::uint8_t>(green, "green"));
    const auto dots = dots_px_of(dots_px, "dots_px");
    const auto side_dots = dots_mm_of(side_dots_mm, "side_dots_mm");
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return fingertip_(frame, dots, side_dots, pressure_mpa, time_s);
  }

  /// A copy of what `show` tells of the last frame.
  template <class T, class Show>
  py::array_t<T> copied(const Show& show) {
    const std::scoped_lock lock(mutex_);
    const auto view = show(fingertip_);
    auto [array, cells] = new_array<T>(view.rows(), view.cols());
    for (Index i = 0; i < view.rows(); ++i) {
      for (Index j = 0; j < view.cols(); ++j) {
        cells(i, j) = static_cast<T>(view(i, j));
      }
    }
    return array;
  }

  void reset() {
    const std::scoped_lock lock(mutex_);
    fingertip_.reset();
  }

 private:
  fingerpad::Fingertip<Reference, Methods> fingertip_;
  std::mutex mutex_;
};

std::unique_ptr<Fingertip> make(const fingerpad::Camera<double>& camera,
                                const fingerpad::Absorption<double>& fluid,
                                const Reference& reference,
                                const py::array& free_dots_mm,
                                const py::array& rim_mm,
                                const fingerpad::ContactTest& contact,
                                const SpatialStickTest& stick,
                                const WrenchOptions& wrench,
                                const OneRow& side_dots,
                                const std::optional<NormalForce>& force_of_area,
                                const std::optional<NormalForce>& force_of_depth,
                                const std::optional<Shear>& shear,
                                bool shear_by_depth,
                                int smoothing_px,
                                double dot_radius_px) {
  Options options{camera, fluid, reference, reference.rows, reference.cols};
  const Dots dots(free_dots_mm, "free_dots_mm"), rim(rim_mm, "rim_mm");
  options.free_dots_mm = dots.view();
  options.rim_mm = rim.view();
  options.contact = contact;
  options.stick = stick;
  options.wrench = wrench;
  options.side_dot_row = side_dots;
  options.force_of_area = force_of_area;
  options.force_of_depth = force_of_depth;
  options.shear = shear;
  options.shear_by_depth = shear_by_depth;
  options.smoothing_px = smoothing_px;
  options.dot_radius_px = dot_radius_px;
  return std::make_unique<Fingertip>(options);
}

}  // namespace

void bind_fingertip(py::module_& module) {
  bind_options<SpatialStickTest>(
      module, "SpatialStickTest",
      "Noise of the dots, and what is slip; slip/spatial_stick_ratio.hpp.")
      .def_readwrite("lateral_mm", &SpatialStickTest::lateral_mm)
      .def_readwrite("depth_mm", &SpatialStickTest::depth_mm)
      .def_readwrite("free_frames", &SpatialStickTest::free_frames)
      .def_readwrite("slip_share", &SpatialStickTest::slip_share)
      .def_readwrite("false_slip", &SpatialStickTest::false_slip)
      .def_readwrite("min_dots", &SpatialStickTest::min_dots);
  using Result = FingertipResult;
  py::class_<Result>(module, "FingertipResult",
                     "What a frame says; pipeline/fingertip_options.hpp.")
      .def_property_readonly("ok", &Result::ok)
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_readonly("depth", &Result::depth)
      .def_readonly("contact", &Result::contact)
      .def_property_readonly("motion_status",
                             [](const Result& r) { return name_of(r.motion.status); })
      .def_property_readonly("position_mm",
                             [](const Result& r) { return as_tuple(r.motion.position_mm); })
      .def_property_readonly("stick_status",
                             [](const Result& r) { return name_of(r.stick.status); })
      .def_property_readonly("stick_ratio", [](const Result& r) { return r.slip.stick_ratio; })
      .def_readonly("by_area", &Result::by_area)
      .def_readonly("by_depth", &Result::by_depth)
      .def_readonly("normal", &Result::normal, "by area and depth together")
      .def_readonly("shear", &Result::shear)
      .def_readonly("wrench", &Result::wrench);
  py::class_<Fingertip>(module, "Fingertip",
                        "Frames, dots and pressure in, touch out; pipeline/fingertip.hpp.\n"
                        "It remembers frames: one object serves one pad.")
      .def(py::init(&make), py::arg("camera"), py::arg("fluid"), py::arg("reference"),
           py::arg("free_dots_mm"), py::arg("rim_mm"),
           py::arg("contact") = fingerpad::ContactTest(), py::arg("stick") = SpatialStickTest(),
           py::arg("wrench") = WrenchOptions(), py::arg("side_dots") = OneRow(),
           py::arg("force_of_area") = py::none(), py::arg("force_of_depth") = py::none(),
           py::arg("shear") = py::none(), py::arg("shear_by_depth") = false,
           py::arg("smoothing_px") = 29, py::arg("dot_radius_px") = 0.0,
           "free_dots_mm: float64 (rows, cols, 3), the printed dots of the free pad, NaN: none;\n"
           "(0, 0, 3): no answer by dots. rim_mm: float64 (1, n, 3), where the side dots are\n"
           "fixed; (0, 0, 3): no six-axis force. force_of_area, force_of_depth: NormalForce;\n"
           "shear: Shear. Without them nothing is looked up.")
      .def(
          "__call__", &Fingertip::operator(), py::arg("red"), py::arg("green"), py::arg("dots_px"),
          py::arg("side_dots_mm"), py::arg("pressure_mpa"),
          py::arg("time_s") = fingerpad::not_a_number<double>(),
          "touch = fingertip(red, green, dots_px, side_dots_mm, pressure_mpa, time_s)\n\n"
          "red, green: uint8 (rows, cols). dots_px: float64 (rows, cols, 2), NaN where not found.\n"
          "side_dots_mm: float64 (1, n, 3). pressure_mpa: MPa above the air's. time_s: s.\n"
          "Another size: the status is \"refused\".")
      .def_property_readonly(
          "depth_mm",
          [](Fingertip& f) { return f.copied<float>([](auto& tip) { return tip.depth_mm(); }); },
          "float32 (rows, cols) of the last frame")
      .def_property_readonly(
          "contact_mask",
          [](Fingertip& f) {
            return f.copied<std::uint8_t>([](auto& tip) { return tip.contact_mask(); });
          },
          "uint8 (rows, cols) of the last frame, 255 in contact")
      .def_property_readonly(
          "dot_states",
          [](Fingertip& f) {
            return f.copied<std::uint8_t>([](auto& tip) { return tip.dot_states(); });
          },
          "uint8 (rows, cols), a DotState each, of the last frame")
      .def("reset", &Fingertip::reset);
}

}  // namespace python
