// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/pipeline/fingertip.hpp"

#include <cstdint>
#include <vector>

#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::FingertipResult;
using fingerpad::Point3;
using fingerpad::SpatialStickTest;
using Reference = fingerpad::DepthReference<float>;
/// Every pixel, as arrays are read; forces by look-up need curves that are fitted in C++.
struct Methods : fingerpad::FingertipMethods {
  static constexpr int sampling = 1;
  static constexpr bool has_look_up = false;
};
using Fingertip = fingerpad::Fingertip<Reference, Methods>;
using Options = fingerpad::FingertipOptions<Reference>;
using WrenchOptions = fingerpad::WrenchOptions<double>;

/// Dots of an array in memory of their own, as the options want them.
struct Dots {
  Index rows, cols;
  std::vector<Point3<double>> cells;

  Dots(const py::array& array, const char* name) {
    const auto dots = dots_mm_of(array, name);
    rows = dots.rows();
    cols = dots.cols();
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        cells.push_back(dots(i, j));
      }
    }
  }
  fingerpad::StridedView<const Point3<double>> view() const {
    return {cells.data(), rows, cols, cols};
  }
};

Fingertip make(const fingerpad::Camera<double>& camera,
               const fingerpad::Absorption<double>& fluid,
               const Reference& reference,
               const py::array& free_dots_mm,
               const py::array& rim_mm,
               const fingerpad::ContactTest& contact,
               const SpatialStickTest& stick,
               const WrenchOptions& wrench) {
  Options options{camera, fluid, reference, reference.rows, reference.cols};
  const Dots dots(free_dots_mm, "free_dots_mm"), rim(rim_mm, "rim_mm");
  options.free_dots_mm = dots.view();
  options.rim_mm = rim.view();
  options.contact = contact;
  options.stick = stick;
  options.wrench = wrench;
  return Fingertip(options);
}

FingertipResult look(Fingertip& fingertip,
                     const py::array& red,
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
  return fingertip(frame, dots, side_dots, pressure_mpa, time_s);
}

/// A copy of what a fingertip shows of its last frame.
template <class T, class View>
py::array_t<T> copied(const View& view) {
  auto [array, cells] = new_array<T>(view.rows(), view.cols());
  for (Index i = 0; i < view.rows(); ++i) {
    for (Index j = 0; j < view.cols(); ++j) {
      cells(i, j) = static_cast<T>(view(i, j));
    }
  }
  return array;
}

py::tuple as_tuple(const Point3<double>& p) {
  return py::make_tuple(p.x, p.y, p.z);
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
  bind_options<WrenchOptions>(module, "WrenchOptions", "The rim; see force/wrench_options.hpp.")
      .def_readwrite("base_radius_mm", &WrenchOptions::base_radius_mm)
      .def_readwrite("side_dot_length_mm", &WrenchOptions::side_dot_length_mm);
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
      .def_property_readonly("wrench_status",
                             [](const Result& r) { return name_of(r.wrench.status); })
      .def_property_readonly("force_n", [](const Result& r) { return as_tuple(r.wrench.force_n); })
      .def_property_readonly("moment_n_mm",
                             [](const Result& r) { return as_tuple(r.wrench.moment_n_mm); });
  py::class_<Fingertip>(module, "Fingertip",
                        "Frames, dots and pressure in, touch out; see pipeline/fingertip.hpp. It\n"
                        "remembers frames, so one object serves one pad and one thread.")
      .def(py::init(&make), py::arg("camera"), py::arg("fluid"), py::arg("reference"),
           py::arg("free_dots_mm"), py::arg("rim_mm"),
           py::arg("contact") = fingerpad::ContactTest(), py::arg("stick") = SpatialStickTest(),
           py::arg("wrench") = WrenchOptions(),
           "free_dots_mm: float64 (rows, cols, 3), the printed dots of the free pad, NaN: none.\n"
           "rim_mm: float64 (1, n, 3), where the side dots are fixed.")
      .def(
          "__call__", &look, py::arg("red"), py::arg("green"), py::arg("dots_px"),
          py::arg("side_dots_mm"), py::arg("pressure_mpa"),
          py::arg("time_s") = fingerpad::not_a_number<double>(),
          "touch = fingertip(red, green, dots_px, side_dots_mm, pressure_mpa, time_s)\n\n"
          "red, green: uint8 (rows, cols). dots_px: float64 (rows, cols, 2), NaN where not found.\n"
          "side_dots_mm: float64 (1, n, 3). pressure_mpa: over the surrounding air.")
      .def_property_readonly("depth_mm",
                             [](Fingertip& f) { return copied<float>(f.depth_mm()); })
      .def_property_readonly(
          "contact_mask", [](Fingertip& f) { return copied<std::uint8_t>(f.contact_mask()); })
      .def("reset", &Fingertip::reset);
}

}  // namespace python
