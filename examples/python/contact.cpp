// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <pybind11/stl.h>

#include <cstdint>
#include <mutex>
#include <optional>

#include "fingerpad/contact/contact_region.hpp"
#include "python/arrays.hpp"
#include "python/parts.hpp"

namespace python {
namespace {

using fingerpad::ContactResult;
using fingerpad::ContactTest;

/// A contact region; calls from several threads are serialised.
class Region {
 public:
  Region(const fingerpad::Camera<double>& camera,
         const Count& rows,
         const Count& cols,
         const ContactTest& test)
      : region_(camera, count_of(rows, "rows"), count_of(cols, "cols"), test) {}

  py::tuple operator()(const Array& depth_mm, const Array& out) {
    auto [mask, mask_view] =
        array_to_write<std::uint8_t>(out, region_.rows(), region_.cols(), "out");
    const auto depth = view_of<float>(depth_mm, "depth_mm");
    const ContactResult result = [&, to = mask_view] {
      const py::gil_scoped_release release;
      const std::scoped_lock lock(mutex_);
      return region_(depth, to);
    }();
    if (!result.accepted()) {
      throw py::value_error("depth_mm must have the shape (" + std::to_string(region_.rows()) +
                            ", " + std::to_string(region_.cols()) + ")");
    }
    return py::make_tuple(mask, result);
  }

 private:
  fingerpad::ContactRegion<> region_;
  std::mutex mutex_;
};

}  // namespace

void bind_contact(py::module_& module) {
  bind_options<ContactTest>(module, "ContactTest",
                            "The test for contact; see docs/contact/contact_region.md.")
      .def_readwrite("threshold_per_mm", &ContactTest::threshold_per_mm)
      .def_readwrite("faint_per_mm", &ContactTest::faint_per_mm)
      .def_readwrite("free_apex_mm", &ContactTest::free_apex_mm)
      .def_readwrite("min_region_px", &ContactTest::min_region_px)
      .def_readwrite("places_edge", &ContactTest::places_edge)
      .def_readwrite("touching_gap_mm", &ContactTest::touching_gap_mm);
  py::class_<ContactResult>(module, "ContactResult", "The contact of a frame.")
      .def_property_readonly("ok", &ContactResult::ok)
      .def_property_readonly("status",
                             [](const ContactResult& contact) { return name_of(contact.status); })
      .def_property_readonly("in_contact", &ContactResult::in_contact)
      .def_readonly("contact_px", &ContactResult::contact_px)
      .def_readonly("unknown_px", &ContactResult::unknown_px)
      .def_readonly("regions", &ContactResult::regions)
      .def_readonly("area_mm2", &ContactResult::area_mm2)
      .def_readonly("area_sd_mm2", &ContactResult::area_sd_mm2)
      .def_readonly("pressed_mm2", &ContactResult::pressed_mm2)
      .def_readonly("depth_mm", &ContactResult::depth_mm)
      .def_property_readonly(
          "center_mm", [](const ContactResult& contact) { return as_tuple(contact.center_mm); });
  py::class_<Region>(module, "ContactRegion",
                     "Computes the contact region; see docs/contact/contact_region.md.")
      .def(py::init<const fingerpad::Camera<double>&, const Count&, const Count&,
                    const ContactTest&>(),
           py::arg("camera"), py::arg("rows"), py::arg("cols"), py::arg("test") = ContactTest())
      .def("__call__", &Region::operator(), py::arg("depth_mm"), py::arg("out") = py::none(),
           "mask, contact = region(depth_mm, out=mask)\n\n"
           "depth_mm: float32 (rows, cols), NaN where unknown.\n"
           "mask: uint8 (rows, cols), 255 in contact, else 0. Without out it is a new array.");
}

}  // namespace python
