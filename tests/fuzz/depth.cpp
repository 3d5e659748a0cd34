// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Depth from any reference and any frame: valid depths are in range, the others NaN; a pixel that
// changes leaves those beyond the window as they were.
#include "fingerpad/depth/depth.hpp"

#include <cstdint>

#include "fingerpad/depth/fit_reference.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

Camera<double> any_camera(Input& in, Index rows, Index cols) {
  Camera<double> camera;
  camera.plate_distance_mm = in.number(10, 200);
  camera.refractive_index = in.number(1, 2);
  camera.center_x_px = in.number(0, static_cast<double>(cols));
  camera.center_y_px = in.number(0, static_cast<double>(rows));
  camera.pitch_mm = in.number(0.01, 1);
  return camera;
}

Absorption<double> any_fluid(Input& in) {
  Absorption<double> fluid;
  fluid.c_red_per_mm = in.number(0.001, 0.1);
  fluid.c_green_per_mm = in.number(0.001, 0.2);
  fluid.kappa = in.number(0.5, 2);
  fluid.max_depth_mm = in.number(1, 30);
  return fluid;
}

template <class Pixel>
void try_depth(Input& in) {
  const Index rows = in.side(0, 40), cols = in.side(0, 40);
  const Camera<double> camera = any_camera(in, rows, cols);
  const Absorption<double> fluid = any_fluid(in);
  const Grid<Pixel> pad_red(in, rows, cols, 0, 260), pad_green(in, rows, cols, 0, 260);
  const Grid<float> shape(in, rows, cols, 0, 15);
  const int window_px = 1 + 2 * static_cast<int>(in.whole(0, 9));
  auto reference = fit_reference(camera, fluid, pad_red.view(), pad_green.view(), shape.view());
  for (Index k = in.flag() ? rows * cols : 0; k > 0; --k) {
    reference.red_gain.push_back(static_cast<float>(in.is_empty() ? 1 : in.number(0.5, 2)));
  }
  DepthEstimator<> estimate(camera, fluid, reference, {.window_px = window_px});

  Grid<Pixel> red(in, rows, cols, 0, 260), green(in, rows, cols, 0, 260);
  Grid<float> depth(rows, cols), again(rows, cols);
  Grid<PixelStatus> status(rows, cols), status_again(rows, cols);
  const auto look = [&](Grid<float>& to, Grid<PixelStatus>& why) {
    const auto result =
        fuzz::frame([&] { return estimate(red.view(), green.view(), to.view(), why.view()); });
    require(result.status != FrameStatus::refused, "a frame of the right size is accepted");
  };
  look(depth, status);
  look(again, status_again);
  require(depth == again && status == status_again, "the same frame gives the same bits");
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const float l = depth.view()(i, j);
      const bool ok = status.view()(i, j) == PixelStatus::ok;
      require(
          ok ? l >= 0 && static_cast<double>(l) <= fluid.max_depth_mm * 1.000001 : std::isnan(l),
          "ok is a depth in range, anything else is NaN");
    }
  }
  if (rows == 0 || cols == 0) {
    return;
  }
  const Index reach = window_px == 1 ? 0 : detail::two_windows(window_px, 1)[1] / 2;
  const Index row = in.whole(0, rows - 1), col = in.whole(0, cols - 1);
  red.view()(row, col) = in.cell<Pixel>(0, 260);
  green.view()(row, col) = in.cell<Pixel>(0, 260);
  look(again, status_again);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const bool is_near = std::abs(i - row) <= reach && std::abs(j - col) <= reach;
      require(is_near || (fuzz::same_bits(depth.view()(i, j), again.view()(i, j)) &&
                          status.view()(i, j) == status_again.view()(i, j)),
              "pixels beyond the window are unchanged");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    switch (in.whole(0, 2)) {
      case 0:
        return try_depth<std::uint8_t>(in);
      case 1:
        return try_depth<std::uint16_t>(in);
      default:
        return try_depth<float>(in);
    }
  });
}
