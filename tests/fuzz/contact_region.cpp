// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Contact in any depth map: measures are finite, and those of the mask.
#include "fingerpad/contact/contact_region.hpp"

#include <cstdint>

#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

void try_contact(Input& in) {
  const Index rows = in.side(0, 60), cols = in.side(0, 60);
  Camera<double> camera;
  camera.plate_distance_mm = in.number(10, 200);
  camera.center_x_px = in.number(0, static_cast<double>(cols));
  camera.center_y_px = in.number(0, static_cast<double>(rows));
  camera.pitch_mm = in.number(0.01, 1);
  ContactTest test;
  test.threshold_per_mm = in.number(0.001, 0.2);
  test.free_apex_mm = in.number(0, 20);
  test.ring_px = static_cast<int>(in.whole(0, 25));
  test.min_region_px = in.whole(0, 300);
  ContactRegion<> find(camera, rows, cols, test);

  const Grid<float> depth(in, rows, cols, 0, 15);
  Grid<std::uint8_t> mask(rows, cols), again(rows, cols);
  const ContactResult contact = fuzz::frame([&] { return find(depth.view(), mask.view()); });
  const ContactResult same = fuzz::frame([&] { return find(depth.view(), again.view()); });
  require(contact.accepted(), "a frame of the right size is accepted");
  require(mask == again && fuzz::same_bits(contact.area_mm2, same.area_mm2),
          "the same frame gives the same bits");
  Index count = 0;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      count += mask.view()(i, j) != 0 ? 1 : 0;
    }
  }
  require(count == contact.contact_px, "contact_px is the number of pixels in the mask");
  require(contact.contact_px + contact.unknown_px <= rows * cols, "no pixel counts twice");
  require(is_finite(contact.area_mm2) && contact.area_mm2 >= 0,
          "an area is finite and not negative");
  require(!contact.in_contact() || is_finite(contact.center_mm), "a contact has a finite center");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, try_contact);
}
