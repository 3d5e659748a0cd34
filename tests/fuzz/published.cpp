// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The printed forms on any input: what they tell is finite, and the same frame gives the same bits.
#include <cmath>
#include <cstdint>

#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/depth.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "fingerpad/published/stick_ratio.hpp"
#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::any_contact;
using fuzz::any_dots;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

void try_depth(Input& in) {
  using Pixel = std::uint8_t;
  const Index rows = in.side(1, 40), cols = in.side(1, 40);
  published::DepthOptions<double> options;
  options.camera.h1_mm = in.number(10, 200);
  options.camera.n = in.number(1, 2);
  options.camera.center_row_px = in.number(0, static_cast<double>(rows));
  options.camera.center_col_px = in.number(0, static_cast<double>(cols));
  options.camera.pitch_mm = in.number(0.01, 1);
  options.fluid.c_R = in.number(0.001, 0.1);
  options.fluid.c_G = in.number(0.001, 0.2);
  options.window_px = 1 + 2 * static_cast<int>(in.whole(0, 8));
  const Grid<Pixel> pad_red(in, rows, cols, 0, 260), pad_green(in, rows, cols, 0, 260);
  const Grid<float> shape(in, rows, cols, 0, 15);
  published::DepthEstimator<> estimate(options, pad_red.view(), pad_green.view(), shape.view());
  const Grid<Pixel> red(in, rows, cols, 0, 260), green(in, rows, cols, 0, 260);
  Grid<float> depth(rows, cols), again(rows, cols);
  for (Grid<float>* to : {&depth, &again}) {
    const bool done = fuzz::frame([&] { return estimate(red.view(), green.view(), to->view()); });
    require(done, "a frame of the right size is accepted");
  }
  require(depth == again, "the same frame gives the same bits");
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double l = static_cast<double>(depth.view()(i, j));
      require(std::isnan(l) || (l >= 0 && l <= options.max_depth_mm * 1.000001),
              "a depth is in range, or NaN");
    }
  }
}

void try_contact(Input& in) {
  const Index rows = in.side(0, 50), cols = in.side(0, 50);
  const Grid<float> depth(in, rows, cols, 0, 15);
  Grid<std::uint8_t> mask(rows, cols);
  published::SlidesContactOptions options;
  options.clamps = in.flag();
  options.every_direction = in.flag();
  options.threshold_per_mm = in.number(-0.1, 0.1);
  options.directions = static_cast<int>(in.whole(0, 40));
  options.radius_px = in.number(1, 30);
  options.pitch_mm = in.number(0.01, 1);
  options.step_px = static_cast<int>(in.whole(0, 60));
  const double area_mm2 = published::contact_by_slides(depth.view(), mask.view(), options);
  require(is_finite(area_mm2) && area_mm2 >= 0, "an area is finite and not negative");
}

void try_stick_ratio(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  published::StickRatioOptions options;
  options.U = in.number(0, 5);
  options.U_min = in.number(0, 2);
  options.delta_0 = in.number(0.01, 1);
  options.S2 = in.number(0, 3);
  options.updates = in.flag();
  options.cancels_rotation = in.flag();
  options.wraps = in.flag();
  options.scale = static_cast<published::StickScale>(in.whole(0, 2));
  options.delta_grows = in.flag();
  options.follows_stick = in.flag();
  options.moves_with_stick = in.flag();
  options.capacity = in.whole(0, 8);
  published::StickRatio<> estimate(rows, cols, options);
  for (Index frames = in.whole(1, 6); frames > 0; --frames) {
    const auto dots = any_dots<Point2<double>>(in, rows, cols);
    const auto contact = any_contact(in, rows, cols);
    auto copy = estimate;
    const auto seen = fuzz::frame([&] { return estimate(dots.view(), contact.view()); });
    require(seen.stick_ratio >= 0 && seen.stick_ratio <= 1, "a ratio is in [0, 1]");
    require(!seen.ok() || (is_finite(seen.angle_rad) && is_finite(seen.furthest_px)),
            "the values of an ok result are finite");
    require(fuzz::same_bits(seen.stick_ratio, copy(dots.view(), contact.view()).stick_ratio),
            "a copy gives the same bits");
  }
}

void try_motion(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  const auto free = any_dots<Point3<double>>(in, rows, cols);
  published::ObjectMotion motion(free.view());
  for (Index frames = in.whole(1, 4); frames > 0; --frames) {
    const auto dots = fuzz::moved_dots(in, free);
    const auto contact = any_contact(in, rows, cols);
    auto copy = motion;
    const auto seen = fuzz::frame([&] { return motion(dots.view(), contact.view()); });
    const auto same = copy(dots.view(), contact.view());
    require(seen.updated == same.updated && fuzz::same_bits(seen.angles.z_rad, same.angles.z_rad),
            "a copy gives the same bits");
  }
}

void try_friction(Input& in) {
  published::FrictionRatio<> estimate;
  for (Index frames = in.whole(1, 20); frames > 0; --frames) {
    const double tangential_n = in.number(-10, 10), normal_n = in.number(-20, 20);
    const bool slips = in.flag();
    const double margin = fuzz::frame([&] { return estimate(tangential_n, normal_n, slips); });
    require(!(margin > 1), "a margin is at most 1");
    require(std::isnan(estimate.mu_0()) || estimate.mu_0() > 0, "a stored ratio is positive");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    switch (in.whole(0, 4)) {
      case 0:
        return try_depth(in);
      case 1:
        return try_contact(in);
      case 2:
        return try_stick_ratio(in);
      case 3:
        return try_motion(in);
      default:
        return try_friction(in);
    }
  });
}
