// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six-axis force from any depth map, side dots and pressure: what is told is finite, what is not is
// NaN, and the same frame gives the same bits after any other.
#include "fingerpad/force/wrench.hpp"

#include <cstdint>
#include <numbers>

#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/published/wrench.hpp"
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

template <class W>
void try_wrench(Input& in) {
  WrenchOptions<double> options;
  options.columns = in.whole(8, 16);
  options.rows = in.whole(2, 8);
  options.line_step_mm = in.number(0.5, 1.5);
  options.blur_mm = in.number(0, 2);
  options.reach_mm = in.number(4, 8);
  options.side_dot_length_mm = in.number(0.5, 2);
  const Index count = in.whole(4, 40);
  const SideDots rim = around(in, 1, count, 0, 0);
  const W wrench(rim.view(), options);

  const Index rows = in.side(2, 40), cols = in.side(2, 40);
  Camera<double> camera;
  camera.center_x_px = in.number(0, static_cast<double>(cols));
  camera.center_y_px = in.number(0, static_cast<double>(rows));
  camera.pitch_mm = in.number(0.5, 2);
  const PadHeights<> heights(rows, cols, camera, radius_mm + 1, in.number(1, 4));
  auto map = heights.map();
  auto work = wrench.workspace(), fresh = wrench.workspace();
  const auto look = [&](auto& with) {
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
    const WrenchNoise<double> noise{in.number(0, 0.01), in.number(0, 0.1), in.number(0, 1e-4)};
    require(fuzz::frame([&] { return heights(depth.view(), contact.view(), map); }),
            "a frame of the right size is accepted");
    const auto r = fuzz::frame([&] { return wrench(map, dots.view(), pressure_mpa, with, noise); });
    const auto again = wrench(map, dots.view(), pressure_mpa, fresh, noise);
    require(r.status == again.status && fuzz::same_bits(r.force_n, again.force_n) &&
                fuzz::same_bits(r.moment_n_mm, again.moment_n_mm),
            "the same frame gives the same bits, whatever came before");
    require(r.ok() ? is_finite(r.force_n) && is_finite(r.moment_n_mm)
                   : std::isnan(r.force_n.x) && std::isnan(r.moment_n_mm.z),
            "a force is finite, or NaN");
    for (std::size_t k = 0; k < 6; ++k) {
      require(!r.ok() || r.covariance[k][k] >= 0, "a variance is not negative");
    }
    for (Index k = 0; k < with.rim_points(); ++k) {
      require(r.status != WrenchStatus::ok || is_finite(with.rim_tension(k)) || r.missing > 0,
              "the tension of a rim point is finite where its dot was found");
    }
  };
  look(work);
  look(work);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    const std::uint8_t kind = in.byte();
    return (kind & 1) != 0 ? try_wrench<Wrench<>>(in)
           : kind < 128    ? try_wrench<Wrench<BalancedRim>>(in)
                           : try_wrench<published::Wrench<>>(in);
  });
}
