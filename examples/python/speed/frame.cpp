// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// frame ROWS COLS FILE: computes the same frame as speed.py, in C++. FILE has red and green of the
// free pad, its depth (float), then red and green of a frame. For each line on standard input the
// program computes depth and contact once, and prints the times in s: depth, contact, both.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"

namespace {

using fingerpad::Index;
using fingerpad::StridedView;

Index rows, cols;

template <class T>
StridedView<const T> grid_in(std::ifstream& file, std::vector<T>& cells) {
  cells.resize(static_cast<std::size_t>(rows * cols));
  file.read(reinterpret_cast<char*>(cells.data()),
            static_cast<std::streamsize>(cells.size() * sizeof(T)));
  return {cells.data(), rows, cols, cols};
}

template <class Call>
double seconds_of(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: frame ROWS COLS FILE\n");
    return 2;
  }
  rows = std::atoi(argv[1]);
  cols = std::atoi(argv[2]);
  std::ifstream file(argv[3], std::ios::binary);
  std::vector<std::uint8_t> cells[4];
  std::vector<float> shape_cells;
  const auto pad_red = grid_in(file, cells[0]), pad_green = grid_in(file, cells[1]);
  const auto shape = grid_in(file, shape_cells);
  const auto red = grid_in(file, cells[2]), green = grid_in(file, cells[3]);
  if (!file) {
    std::fprintf(stderr, "%s is too short\n", argv[3]);
    return 1;
  }
  const fingerpad::Camera<double> camera{.center_x_px = 0.5 * static_cast<double>(cols - 1),
                                         .center_y_px = 0.5 * static_cast<double>(rows - 1)};
  const fingerpad::Absorption<double> fluid;
  const auto reference = fit_reference(camera, fluid, pad_red, pad_green, shape);
  fingerpad::DepthEstimator<> estimate(camera, fluid, reference);
  fingerpad::ContactRegion<> region(camera, rows, cols, {.free_apex_mm = 13.03});
  std::vector<float> depth_cells(shape_cells.size());
  std::vector<fingerpad::PixelStatus> statuses(shape_cells.size());
  std::vector<std::uint8_t> mask_cells(shape_cells.size());
  const StridedView<float> depth(depth_cells.data(), rows, cols, cols);
  const StridedView<fingerpad::PixelStatus> status(statuses.data(), rows, cols, cols);
  const StridedView<std::uint8_t> mask(mask_cells.data(), rows, cols, cols);
  while (std::cin.get() == '\n') {
    const double depth_s = seconds_of([&] { (void)estimate(red, green, depth, status); });
    const double contact_s = seconds_of([&] { (void)region(depth, mask); });
    std::printf("%.9f %.9f %.9f\n", depth_s, contact_s, depth_s + contact_s);
    std::fflush(stdout);
  }
}
