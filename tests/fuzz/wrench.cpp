// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six-axis force from any depth map, side dots and pressure: what is told is finite, what is not is
// NaN, and the same frame gives the same bits after any other.
#include "fingerpad/force/wrench.hpp"

#include <cstdint>
#include <numbers>

#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;
using SideDots = Grid<Point3<double>>;

namespace {

constexpr double radius_mm = 18.735;

SideDots around(Input& in, Index rows, Index count, double out_mm, double up_mm) {
  SideDots dots(rows, count);
  for (Index i = 0; i < rows; ++i) {
    for (Index k = 0; k < count; ++k) {
      const double at = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
      const double times = static_cast<double>(i + 1);
      const double r = radius_mm - times * out_mm;
      dots.view()(i, k) = {r * std::cos(at), r * std::sin(at), times * up_mm};
    }
  }
  for (Index k = in.whole(0, 8); k > 0 && count > 0; --k) {
    Point3<double>& dot = dots.view()(in.whole(0, rows - 1), in.whole(0, count - 1));
    dot = {dot.x + in.number(-0.3, 0.3), dot.y + in.number(-0.3, 0.3), in.number(0, 2)};
  }
  return dots;
}

/// A dome with a level summit, as a camera sees it from below, and strange pixels in it.
Grid<float> any_depth(Input& in, Index rows, Index cols) {
  Grid<float> depth(rows, cols);
  const double top = in.number(2, 12), steep = in.number(0, 0.3);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double r =
          std::hypot(static_cast<double>(i - rows / 2), static_cast<double>(j - cols / 2));
      depth.view()(i, j) =
          static_cast<float>((std::max)(top - steep * (std::max)(r - 3, 0.0), 0.0));
    }
  }
  for (Index k = in.whole(0, 8); k > 0; --k) {
    const float odd = in.cell<float>(0, 15);
    const Index row = in.whole(0, rows - 1), col = in.whole(0, cols - 1);
    for (Index j = col; j < (std::min)(cols, col + 4); ++j) {
      depth.view()(row, j) = odd;
    }
  }
  return depth;
}

/// `make(in, border)` gives the estimator.
template <class Make>
void try_wrench(Input& in, const Make& make) {
  const Index count = in.whole(4, 40);
  auto used = make(in, around(in, 1, count, 0, 0)), fresh = used;
  const Index rows = in.side(2, 40), cols = in.side(2, 40);
  Camera<double> camera;
  camera.center_x_px = in.number(0, static_cast<double>(cols));
  camera.center_y_px = in.number(0, static_cast<double>(rows));
  camera.pitch_mm = in.number(0.5, 2);
  const PadHeights<> heights(rows, cols, camera, radius_mm + 1, in.number(1, 4));
  auto map = heights.map();
  for (int frame = 0; frame < 2; ++frame) {
    const Grid<float> depth = any_depth(in, rows, cols);
    Grid<std::uint8_t> contact(rows, cols);
    const Index reach = in.whole(0, 10);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        contact.view()(i, j) =
            std::abs(i - rows / 2) < reach && std::abs(j - cols / 2) < reach ? 1 : 0;
      }
    }
    const SideDots dots = around(in, 1, count, in.number(0.1, 0.5), in.number(0.5, 1.5));
    const double pressure_mpa = in.number(0, 0.05);
    require(fuzz::frame([&] { return heights(depth.view(), contact.view(), map); }),
            "a frame of the right size is accepted");
    const auto r = fuzz::frame([&] { return used(map, dots.view(), pressure_mpa); });
    auto other = fresh;
    const auto again = other(map, dots.view(), pressure_mpa);
    require(r.status == again.status && fuzz::same_bits(r.force_n, again.force_n) &&
                fuzz::same_bits(r.moment_n_mm, again.moment_n_mm),
            "the same frame gives the same bits, whatever came before");
    require(r.ok() ? is_finite(r.force_n) && is_finite(r.moment_n_mm)
                   : is_finite(r.force_n) == is_finite(r.moment_n_mm),
            "a force is finite, or NaN");
  }
}

Wrench<> any_wrench(Input& in, const SideDots& border) {
  WrenchOptions<double> options;
  options.line_step_mm = in.number(0.5, 1.5);
  options.blur_mm = in.number(0, 2);
  options.reach_mm = in.number(6, 8);
  options.side_dot_length_mm = in.number(0.5, 2);
  if (in.whole(0, 1) == 1) {
    options.stress_free_inclination_rad = in.number(0, 1.5);
    options.modulus_n_per_mm = in.number(0.1, 1);
  }
  return Wrench<>(border.view(), options);
}

published::SegmentEquilibrium<> any_published(Input& in, const SideDots& border) {
  published::SegmentEquilibriumOptions<double> options;
  options.delta_z_mm = in.number(0.1, 2);
  options.contours = in.whole(2, 8);
  options.step_mm = in.number(0.5, 1.5);
  options.inside_mm = in.number(0, 2);
  return published::SegmentEquilibrium<>(border.view(), options);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    return (in.byte() & 1) != 0 ? try_wrench(in, any_wrench) : try_wrench(in, any_published);
  });
}
