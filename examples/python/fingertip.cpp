// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/pipeline/fingertip.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::FingertipResult;
using fingerpad::StickOptions;
using Reference = fingerpad::DepthReference<float>;
using Options = fingerpad::FingertipOptions;
using fingerpad::WrenchOptions;

/// A fingertip; calls from several threads are serialised.
class Fingertip {
 public:
  explicit Fingertip(const Options& options) : fingertip_(options) {}

  FingertipResult operator()(const Array& red,
                             const Array& green,
                             const std::optional<Array>& dots_px,
                             const Number& pressure,
                             const Number& time) {
    const double pressure_mpa = number_of(pressure, "pressure_mpa");
    const double time_s = number_of(time, "time_s");
    const auto red_view = view_of<std::uint8_t>(red, "red");
    const auto green_view = view_of<std::uint8_t>(green, "green");
    const auto measure = [&](const auto& dots) {
      const py::gil_scoped_release release;
      const std::scoped_lock lock(mutex_);
      return fingertip_(red_view, green_view, dots, pressure_mpa, time_s);
    };
    return dots_px ? measure(dots_px_of(*dots_px, "dots_px"))
                   : measure(fingerpad::StridedView<const fingerpad::Point2<double>>());
  }

  /// A copy of the view that `show` returns for the last frame.
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

  py::array_t<double> found_dots() {
    const std::scoped_lock lock(mutex_);
    const auto dots = fingertip_.dots_px();
    py::array_t<double> array({dots.rows(), dots.cols(), Index(2)});
    auto cells = array.mutable_unchecked<3>();
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        cells(i, j, 0) = dots(i, j).x;
        cells(i, j, 1) = dots(i, j).y;
      }
    }
    return array;
  }

  void reset() {
    const std::scoped_lock lock(mutex_);
    fingertip_.reset();
  }

 private:
  fingerpad::Fingertip fingertip_;
  std::mutex mutex_;
};

std::unique_ptr<Fingertip> make(const fingerpad::Camera<double>& camera,
                                const fingerpad::Absorption<double>& fluid,
                                const Reference& reference,
                                const Array& free_dots_mm,
                                const fingerpad::ContactTest& contact,
                                const StickOptions& stick,
                                const std::optional<WrenchOptions>& wrench,
                                const std::optional<fingerpad::NormalForce<>>& force_of_area,
                                const std::optional<fingerpad::NormalForce<>>& force_of_depth,
                                const std::optional<fingerpad::Shear<>>& shear,
                                bool shear_by_depth,
                                const Count& smoothing_px,
                                const Number& dot_radius_px,
                                const std::optional<Array>& free_red,
                                const std::optional<Array>& free_green,
                                const std::optional<Array>& free_dots_px) {
  Options options{camera, fluid, reference};
  options.sampling = 1;      // depth at every pixel, because Python reads whole arrays
  options.flat_area = true;  // also without a curve
  const Dots dots(free_dots_mm, "free_dots_mm");
  options.free_dots_mm = dots.view();
  options.contact = contact;
  options.stick = stick;
  options.wrench = wrench;
  options.force_of_area = force_of_area;
  options.force_of_depth = force_of_depth;
  options.shear = shear;
  options.shear_by_depth = shear_by_depth;
  options.smoothing_px = count_of<int>(smoothing_px, "smoothing_px");
  options.dot_radius_px = number_of(dot_radius_px, "dot_radius_px");
  if (free_red && free_green && free_dots_px) {
    const auto light = fingerpad::mean_light(view_of<std::uint8_t>(*free_red, "free_red"),
                                             view_of<std::uint8_t>(*free_green, "free_green"));
    options.dot_follower.emplace(light, dots_px_of(*free_dots_px, "free_dots_px"),
                                 fingerpad::DotFollowerOptions{.radius_px = options.dot_radius_px});
  } else if (free_red || free_green || free_dots_px) {
    throw py::value_error("free_red, free_green and free_dots_px are given together");
  }
  return std::make_unique<Fingertip>(options);
}

void bind_motion_result(py::module_& module) {
  using Motion = fingerpad::ObjectMotionResult<double>;
  py::class_<Motion>(module, "ObjectMotionResult",
                     "Motion of the object; see docs/motion/object_motion.md.")
      .def_property_readonly("ok", &Motion::ok)
      .def_property_readonly("status", [](const Motion& r) { return name_of(r.status); })
      .def_property_readonly("has_pose", &Motion::has_pose)
      .def_readonly("object", &Motion::object,
                    "1 for the first object, one more with each that begins; 0: none yet")
      .def_readonly("begun", &Motion::begun)
      .def_readonly("dots_used", &Motion::dots_used)
      .def_property_readonly(
          "pose", [](const Motion& r) { return pose_tuple(r.pose); },
          "(R, t): x_now = R x_first + t, R in rows, t in mm")
      .def_property_readonly(
          "angles",
          [](const Motion& r) {
            return py::make_tuple(r.angles.z_rad, r.angles.y_rad, r.angles.x_rad);
          },
          "rotations about z, y and x, rad")
      .def_property_readonly("position_mm", [](const Motion& r) { return as_tuple(r.position_mm); })
      .def_property_readonly("displacement_mm",
                             [](const Motion& r) { return as_tuple(r.displacement_mm); })
      .def_readonly("residual_rms_mm", &Motion::residual_rms_mm)
      .def_readonly("position_sd_mm", &Motion::position_sd_mm)
      .def_readonly("rotation_sd_rad", &Motion::rotation_sd_rad);
}

void bind_slip_result(py::module_& module) {
  using fingerpad::RatioUpdate, fingerpad::SlipEvidence;
  py::enum_<RatioUpdate>(module, "RatioUpdate", "Whether a stick ratio is new.")
      .value("fresh", RatioUpdate::fresh)
      .value("unmoved", RatioUpdate::unmoved)
      .value("missing", RatioUpdate::missing)
      .value("no_contact", RatioUpdate::no_contact);
  py::enum_<SlipEvidence>(module, "SlipEvidence", "Evidence on which the stick ratio is based.")
      .value("none", SlipEvidence::none)
      .value("dots", SlipEvidence::dots)
      .value("imprint", SlipEvidence::imprint)
      .value("friction", SlipEvidence::friction)
      .value("both", SlipEvidence::both);
  using Slip = fingerpad::SlipResult<double>;
  py::class_<Slip>(module, "SlipResult",
                   "Slip from dots and forces; see docs/slip/spatial_stick_ratio.md.")
      .def_property_readonly("ok", &Slip::ok)
      .def_property_readonly("status", [](const Slip& r) { return name_of(r.status); })
      .def_readonly("evidence", &Slip::evidence)
      .def_readonly("stick_ratio", &Slip::stick_ratio, "in [0, 1]; NaN if unknown")
      .def_readonly("ratio_sd", &Slip::ratio_sd, "standard deviation of stick_ratio")
      .def_readonly("update", &Slip::update, "whether the ratio is new")
      .def_readonly("dots_ratio", &Slip::dots_ratio, "stick ratio from the dots alone")
      .def_readonly("reference_age", &Slip::reference_age, "frames; 0 if unknown")
      .def_readonly("falls_back", &Slip::falls_back)
      .def_readonly("may_slide", &Slip::may_slide, "no dot is sure to move with the object")
      .def_readonly("in_doubt", &Slip::in_doubt, "the ratio may be off by more than 0.3")
      .def_readonly("normal_n", &Slip::normal_n)
      .def_readonly("friction", &Slip::friction)
      .def_readonly("limit", &Slip::limit, "at the last slide")
      .def_readonly("margin", &Slip::margin);
}

void bind_shift_dots_and_area(py::module_& module) {
  using Shift = fingerpad::ShiftResult<double>;
  py::class_<Shift>(module, "ShiftResult",
                    "Displacement and rotation of a contact; see docs/force/shear.md.")
      .def_property_readonly("ok", &Shift::ok)
      .def_property_readonly("status", [](const Shift& r) { return name_of(r.status); })
      .def_readonly("dots", &Shift::dots, "that took part")
      .def_property_readonly(
          "displacement", [](const Shift& r) { return as_tuple(r.displacement); },
          "(x, y) in the unit of the dots; mm for a Fingertip")
      .def_readonly("rotation_rad", &Shift::rotation_rad)
      .def_readonly("residual_rms", &Shift::residual_rms);
  using Dots = fingerpad::DotFollowerResult;
  py::class_<Dots>(module, "DotFollowerResult",
                   "Printed dots found in a frame; see docs/dots/dot_follower.md.")
      .def_property_readonly("ok", &Dots::ok)
      .def_property_readonly("status", [](const Dots& r) { return name_of(r.status); })
      .def_readonly("found", &Dots::found)
      .def_readonly("expected", &Dots::expected);
  using FlatArea = fingerpad::FlatAreaResult<double>;
  py::class_<FlatArea>(
      module, "FlatAreaResult",
      "Flat plate that presses with the same force; see docs/force/normal_force.md.")
      .def_property_readonly("ok", &FlatArea::ok)
      .def_readonly("area_mm2", &FlatArea::area_mm2)
      .def_readonly("variance_mm4", &FlatArea::variance_mm4);
}

void bind_result(py::module_& module) {
  using Result = FingertipResult;
  py::class_<Result>(module, "FingertipResult",
                     "Result of a frame; see docs/pipeline/fingertip.md.")
      .def_property_readonly("ok", &Result::ok)
      .def_property_readonly("status", [](const Result& r) { return name_of(r.status); })
      .def_readonly("depth_in_doubt", &Result::depth_in_doubt,
                    "depth or free depth is of another pad, light or unit")
      .def_readonly("contact_in_doubt", &Result::contact_in_doubt)
      .def_readonly("lacks_motion", &Result::lacks_motion)
      .def_readonly("rotation_in_doubt", &Result::rotation_in_doubt)
      .def_readonly("lacks_stick_ratio", &Result::lacks_stick_ratio)
      .def_readonly("lacks_look_up", &Result::lacks_look_up)
      .def_readonly("lacks_wrench", &Result::lacks_wrench)
      .def_readonly("depth", &Result::depth)
      .def_readonly("depth_light_sd_mm", &Result::depth_light_sd_mm,
                    "by how much light that changes may have moved the depth, mm")
      .def_property_readonly("light_in_doubt", &Result::light_in_doubt)
      .def_property_readonly(
          "neighbour_light", [](const Result& r) { return name_of(r.neighbour_light); },
          "whether the depths suited the removal of neighbouring light")
      .def_readonly("dots", &Result::dots, "of the frame, if the fingertip finds them")
      .def_readonly("contact", &Result::contact)
      .def_readonly("motion", &Result::motion)
      .def_readonly("stick", &Result::stick, "by the dots")
      .def_readonly("slip", &Result::slip, "slip from dots and friction")
      .def_readonly("shift", &Result::shift,
                    "displacement of the dots on both sides of the contact's edge")
      .def_readonly("flat_area", &Result::flat_area,
                    "area of the flat plate that presses with the same force")
      .def_readonly("by_area", &Result::by_area)
      .def_readonly("by_depth", &Result::by_depth)
      .def_readonly("normal", &Result::normal, "by area and depth together")
      .def_readonly("shear", &Result::shear)
      .def_readonly("wrench", &Result::wrench);
}

}  // namespace

void bind_fingertip(py::module_& module) {
  bind_motion_result(module);
  bind_slip_result(module);
  bind_shift_dots_and_area(module);
  bind_result(module);
  py::class_<Fingertip>(
      module, "Fingertip",
      "Computes the touch from frames, dots and pressure; see docs/pipeline/fingertip.md.\n"
      "It stores past frames: use one object for each pad.")
      .def(py::init(&make), py::arg("camera"), py::arg("fluid"), py::arg("reference"),
           py::arg("free_dots_mm"), py::arg("contact") = fingerpad::ContactTest(),
           py::arg("stick") = StickOptions{}, py::arg("wrench") = py::none(),
           py::arg("force_of_area") = py::none(), py::arg("force_of_depth") = py::none(),
           py::arg("shear") = py::none(), py::arg("shear_by_depth") = false,
           py::arg("smoothing_px") = py::int_(29), py::arg("dot_radius_px") = py::float_(0.0),
           py::arg("free_red") = py::none(), py::arg("free_green") = py::none(),
           py::arg("free_dots_px") = py::none(),
           "free_dots_mm: float32 or float64 (rows, cols, 3), the printed dots of the free pad, "
           "NaN: none;\n"
           "(0, 0, 3): no results from dots. wrench: WrenchOptions; None: no six-axis force.\n"
           "force_of_area, force_of_depth: NormalForce; shear: Shear. Without them no forces are\n"
           "looked up. free_red, free_green, free_dots_px: the free pad; with them the fingertip\n"
           "finds the dots itself, of dot_radius_px.")
      .def("__call__", &Fingertip::operator(), py::arg("red"), py::arg("green"),
           py::arg("dots_px") = py::none(),
           py::arg("pressure_mpa") = py::float_(fingerpad::not_a_number<double>()),
           py::arg("time_s") = py::float_(fingerpad::not_a_number<double>()),
           "touch = fingertip(red, green, dots_px, pressure_mpa, time_s)\n\n"
           "red, green: uint8 (rows, cols). dots_px: float32 or float64 (rows, cols, 2), NaN where "
           "not found;\n"
           "None: found in the frame, or none.\n"
           "pressure_mpa: MPa above the air pressure. time_s: s.\n"
           "For arrays of another size the status is \"refused\".")
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
          "dots_px", [](Fingertip& f) { return f.found_dots(); },
          "float64 (rows, cols, 2): dots found in the last frame, NaN: lost")
      .def_property_readonly(
          "dot_states",
          [](Fingertip& f) {
            return f.copied<std::uint8_t>([](auto& tip) { return tip.dot_states(); });
          },
          "uint8 (rows, cols), a DotState each, of the last frame")
      .def("reset", &Fingertip::reset);
}

}  // namespace python
