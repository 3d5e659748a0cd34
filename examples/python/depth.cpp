// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/depth.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "fingerpad/depth/fit_reference.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::Absorption;
using fingerpad::Camera;
using fingerpad::DepthResult;
using fingerpad::PixelStatus;
using Reference = fingerpad::DepthReference<float>;

Reference fit(const Camera<double>& camera,
              const Absorption<double>& fluid,
              const Array& red,
              const Array& green,
              const Array& depth_mm) {
  return with_pixel_of(red, "red", [&](auto pixel) {
    using Pixel = decltype(pixel);
    const auto r = view_of<Pixel>(red, "red"), g = view_of<Pixel>(green, "green");
    if (py::isinstance<py::array_t<float>>(depth_mm)) {
      return fit_reference(camera, fluid, r, g, view_of<float>(depth_mm, "depth_mm"));
    }
    return fit_reference(camera, fluid, r, g, view_of<double>(depth_mm, "depth_mm"));
  });
}

/// A depth estimator; calls from several threads are serialised.
class Estimator {
 public:
  Estimator(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const Reference& reference,
            const Count& smoothing_px)
      : estimate_(
            camera, fluid, reference, {.window_px = count_of<int>(smoothing_px, "smoothing_px")}) {}

  Index rows() const { return estimate_.rows(); }
  Index cols() const { return estimate_.cols(); }

  py::tuple operator()(const Array& red, const Array& green, const Array& out) {
    py::object to[] = {py::none(), py::none()};
    if (!out.is_none()) {
      if (!PyTuple_Check(out.ptr()) || py::len(out) != 2) {
        throw py::type_error("out must be the tuple (depth_mm, status) of two arrays");
      }
      to[0] = out[py::int_(0)];
      to[1] = out[py::int_(1)];
    }
    auto [depth, depth_view] = array_to_write<float>(to[0], rows(), cols(), "out[0]");
    auto [status, status_view] = array_to_write<std::uint8_t>(to[1], rows(), cols(), "out[1]");
    fingerpad::StridedView<PixelStatus> statuses(reinterpret_cast<PixelStatus*>(status_view.row(0)),
                                                 rows(), cols(), status_view.row_stride(),
                                                 status_view.col_stride());
    const DepthResult result = with_pixel_of(red, "red", [&, depths = depth_view](auto pixel) {
      using Pixel = decltype(pixel);
      const auto r = view_of<Pixel>(red, "red"), g = view_of<Pixel>(green, "green");
      const py::gil_scoped_release release;
      const std::scoped_lock lock(mutex_);
      return estimate_(r, g, depths, statuses);
    });
    if (result.status == fingerpad::FrameStatus::refused) {
      throw py::value_error("red and green must have the reference's size, " +
                            std::to_string(rows()) + " x " + std::to_string(cols()));
    }
    return py::make_tuple(depth, status, result);
  }

 private:
  fingerpad::DepthEstimator<float> estimate_;
  std::mutex mutex_;
};

}  // namespace

void bind_depth(py::module_& module) {
  bind_options<Camera<double>>(module, "Camera", "Camera and plate; see docs/optics/optics.md.")
      .def_readwrite("plate_distance_mm", &Camera<double>::plate_distance_mm)
      .def_readwrite("refractive_index", &Camera<double>::refractive_index)
      .def_readwrite("center_x_px", &Camera<double>::center_x_px)
      .def_readwrite("center_y_px", &Camera<double>::center_y_px)
      .def_readwrite("pitch_mm", &Camera<double>::pitch_mm)
      .def_readwrite("plate_thickness_mm", &Camera<double>::plate_thickness_mm)
      .def_readwrite("plate_index", &Camera<double>::plate_index)
      .def_readwrite("pixel_aspect", &Camera<double>::pixel_aspect)
      .def_readwrite("distortion_k1", &Camera<double>::distortion_k1)
      .def_readwrite("distortion_k2", &Camera<double>::distortion_k2);
  bind_options<Absorption<double>>(module, "Absorption", "The fluid; see docs/depth/depth.md.")
      .def_readwrite("c_red_per_mm", &Absorption<double>::c_red_per_mm)
      .def_readwrite("c_green_per_mm", &Absorption<double>::c_green_per_mm)
      .def_readwrite("kappa", &Absorption<double>::kappa)
      .def_readwrite("max_depth_mm", &Absorption<double>::max_depth_mm);

  py::enum_<PixelStatus>(module, "PixelStatus", "Why a pixel has no depth.")
      .value("ok", PixelStatus::ok)
      .value("below_range", PixelStatus::below_range)
      .value("above_range", PixelStatus::above_range)
      .value("not_a_number", PixelStatus::not_a_number)
      .value("dark", PixelStatus::dark)
      .value("saturated", PixelStatus::saturated)
      .value("outside_pad", PixelStatus::outside_pad);
  py::class_<DepthResult>(module, "DepthResult", "Numbers of pixels of the pad by status.")
      .def_property_readonly("ok", &DepthResult::ok)
      .def_property_readonly("status", [](const DepthResult& r) { return name_of(r.status); })
      .def_readonly("pad_pixels", &DepthResult::pad_pixels)
      .def_property_readonly("valid_pixels", &DepthResult::valid_pixels, "that have a depth")
      .def(
          "pixels",
          [](const DepthResult& result, PixelStatus status) {
            return result.count[static_cast<std::size_t>(status)];
          },
          py::arg("status"), "number of pixels of the pad with this status");
  py::class_<Reference>(module, "DepthReference", "Light of the free pad; see docs/depth/depth.md.")
      .def_readonly("residual_rms", &Reference::residual_rms)
      .def_readonly("pixels_used", &Reference::pixels_used);
  module.def("fit_reference", &fit, py::arg("camera"), py::arg("fluid"), py::arg("red"),
             py::arg("green"), py::arg("depth_mm"),
             "The reference from a frame of the free pad.\n\n"
             "red, green: (rows, cols), uint8, uint16, float32 or float64.\n"
             "depth_mm: (rows, cols), float32 or float64, along each pixel's ray; NaN outside.");
  py::class_<Estimator>(module, "DepthEstimator",
                        "Depth from red and green; see docs/depth/depth.md.")
      .def(py::init<const Camera<double>&, const Absorption<double>&, const Reference&,
                    const Count&>(),
           py::arg("camera"), py::arg("fluid"), py::arg("reference"),
           py::arg("smoothing_px") = py::int_(29))
      .def_property_readonly("rows", &Estimator::rows)
      .def_property_readonly("cols", &Estimator::cols)
      .def("__call__", &Estimator::operator(), py::arg("red"), py::arg("green"),
           py::arg("out") = py::none(),
           "depth_mm, status, result = estimate(red, green, out=(depth_mm, status))\n\n"
           "red, green: (rows, cols), both uint8, uint16, float32 or float64.\n"
           "depth_mm: float32 (rows, cols), mm along each pixel's ray, NaN where there is none.\n"
           "status: uint8 (rows, cols), a PixelStatus each. Without out these are new arrays.");
}

}  // namespace python
