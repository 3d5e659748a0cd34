// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Adapts an image type that fingerpad does not know: a specialisation of grid_traits is enough.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"

// The image type of a camera driver: lines of pixels, each with red and green in a 32-bit word.
struct PackedFrame {
  int width = 0;
  std::vector<std::vector<std::uint32_t>> lines;
};

// One channel of a PackedFrame as a grid. This is the whole adapter.
struct PackedChannel {
  const PackedFrame* frame;
  int shift;
};
template <>
struct fingerpad::grid_traits<PackedChannel> {
  static Index rows(const PackedChannel& c) { return static_cast<Index>(c.frame->lines.size()); }
  static Index cols(const PackedChannel& c) { return c.frame->width; }
  static std::uint8_t at(const PackedChannel& c, Index row, Index col) {
    const auto& line = c.frame->lines[static_cast<std::size_t>(row)];
    return static_cast<std::uint8_t>(line[static_cast<std::size_t>(col)] >> c.shift);
  }
};
namespace {
constexpr int rows = 120, cols = 160;
const fingerpad::Camera<double> camera{.center_x_px = 79.5, .center_y_px = 59.5, .pitch_mm = 0.32};
const fingerpad::Absorption<double> fluid;

/// Depth of a spherical cap, 13 mm high, flattened by a plate at `lid_mm`; NaN outside.
double depth_of_pad(fingerpad::Index row, fingerpad::Index col, double lid_mm) {
  const double x = (static_cast<double>(col) - 79.5) * 0.32;
  const double y = (static_cast<double>(row) - 59.5) * 0.32;
  const double depth = std::sqrt(400 - x * x - y * y) - 7;
  return depth > 0 ? (std::min)(depth, lid_mm) : fingerpad::not_a_number<double>();
}

PackedFrame photograph(double lid_mm) {
  PackedFrame frame{cols, {rows, std::vector<std::uint32_t>(cols)}};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      const double depth = depth_of_pad(i, j, lid_mm);
      const auto ray = fingerpad::ray_at_pixel(camera, double(i), double(j));
      const auto colour = fingerpad::colour_at_depth(fluid, ray, 57.0, 0.0163, depth);
      if (depth > 0) {
        frame.lines[std::size_t(i)][std::size_t(j)] =
            std::uint32_t(colour.red + 0.5) << 16 | std::uint32_t(colour.green + 0.5) << 8;
      }
    }
  }
  return frame;
}

}  // namespace

int main() {
  const PackedFrame free_pad = photograph(100);
  const PackedFrame frame = photograph(9);
  // The known shape is a function of the pixel; it needs no array.
  const fingerpad::LazyView shape(
      rows, cols, [](fingerpad::Index i, fingerpad::Index j) { return depth_of_pad(i, j, 100); });

  const auto reference = fingerpad::fit_reference(camera, fluid, PackedChannel{&free_pad, 16},
                                                  PackedChannel{&free_pad, 8}, shape);
  fingerpad::DepthEstimator estimate(camera, fluid, reference, {.window_px = 7});
  std::vector<float> depth_mm(rows * cols);
  (void)estimate(PackedChannel{&frame, 16}, PackedChannel{&frame, 8},
                 fingerpad::StridedView<float>(depth_mm.data(), rows, cols, cols));

  const double center = static_cast<double>(depth_mm[60 * cols + 80]);
  std::printf("a plate 9 mm above the base is measured at %.2f mm\n", center);
  return center > 8.8 && center < 9.2 ? 0 : 1;
}
