// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Shift of a contact by any dots, the object's surface in any depth map:
// answers are finite, and the same frame gives the same bits.
#include <cstdint>

#include "fingerpad/contact/surface.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::any_contact;
using fuzz::any_dots;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

void try_shift(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  const auto reference = any_dots<Point2<double>>(in, rows, cols);
  const ShiftOptions options = {.edge_dots = in.flag(),
                                .robust_passes = static_cast<int>(in.whole(0, 10))};
  ContactShift shift(reference.view(), options);
  const ContactShift fresh = shift;
  for (int frame = 0; frame < 2; ++frame) {
    const auto dots = fuzz::moved_dots(in, reference);
    const auto contact = any_contact(in, rows, cols);
    const auto r = fuzz::frame([&] { return shift(dots.view(), contact.view()); });
    auto other = fresh;
    const auto again = other(dots.view(), contact.view());
    require(r.status == again.status && fuzz::same_bits(r.displacement, again.displacement) &&
                fuzz::same_bits(r.rotation_rad, again.rotation_rad),
            "the same frame gives the same bits, whatever came before");
    require(!r.has_displacement() || is_finite(r.displacement), "a displacement is finite");
    require(!r.ok() || (std::abs(r.rotation_rad) <= 3.1416 && r.residual_rms >= 0),
            "a rotation is within half a turn");
  }
}

void try_motion(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  const auto free = any_dots<Point3<double>>(in, rows, cols);
  ObjectMotion<> motion(rows, cols);
  Index object = 0;
  for (Index frames = in.whole(1, 6); frames > 0; --frames) {
    const auto dots = fuzz::moved_dots(in, free);
    const auto contact = any_contact(in, rows, cols), slips = any_contact(in, rows, cols);
    auto copy = motion;
    const double noise_mm = in.number(0, 0.1);
    const auto seen =
        fuzz::frame([&] { return motion(dots.view(), contact.view(), slips.view(), noise_mm); });
    const auto same = copy(dots.view(), contact.view(), slips.view(), noise_mm);
    require(seen.status == same.status &&
                fuzz::same_bits(seen.pose.translation_mm, same.pose.translation_mm),
            "a copy gives the same bits");
    require(!seen.has_pose() || is_finite(seen.pose.translation_mm), "a translation is finite");
    require(seen.object == object + (seen.begun ? 1 : 0), "each object has the next number");
    object = seen.object;
  }
}

void try_surface(Input& in) {
  const Index rows = in.side(0, 30), cols = in.side(0, 30);
  Camera<double> camera;
  camera.plate_distance_mm = in.number(10, 200);
  camera.center_x_px = in.number(0, static_cast<double>(cols));
  camera.center_y_px = in.number(0, static_cast<double>(rows));
  camera.pitch_mm = in.number(0.01, 1);
  const Grid<float> depth(in, rows, cols, 5, 12);
  const auto contact = any_contact(in, rows, cols);
  const auto r = fuzz::frame([&] { return fit_surface(camera, depth.view(), contact.view()); });
  const auto again = fit_surface(camera, depth.view(), contact.view());
  require(r.ok() == again.ok() && fuzz::same_bits(r.rms_mm, again.rms_mm),
          "the same frame gives the same bits");
  require(!r.ok() || (is_finite(r.rms_mm) && r.rms_mm >= 0), "the residual is finite");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    switch (in.whole(0, 2)) {
      case 0:
        return try_shift(in);
      case 1:
        return try_surface(in);
      default:
        return try_motion(in);
    }
  });
}
