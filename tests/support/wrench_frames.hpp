// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finite-element membranes under known force and moment (tests/data/wrench_*): shapes, exact side
// dots, and the truth.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "finite_elements.hpp"
#include "height_map.hpp"

namespace test {

using fingerpad::Point3;

constexpr Index side_dots = 72;

/// A step of a scene; see tests/data/README.md.
struct WrenchFrame {
  std::string name, heights, scene;
  std::uint64_t number = 0;
  double pressure_mpa = 0;
  Point3<double> force_n{}, moment_n_mm{};
  double largest_fxy = 0, largest_fz = 0, largest_mxy = 0, largest_mz = 0;  ///< of the scene
  Image<Point3<double>> dots{3, side_dots, {0, 0, 0}};  ///< of one row; of two rows
};

inline std::vector<WrenchFrame> read_wrench_frames() {
  std::vector<WrenchFrame> frames;
  auto file = open_data("wrench_frames.csv", "frame,heights,scene,step,");
  auto dots = open_data("wrench_side_dots.csv", "frame,row,");
  std::string line, cell;
  std::getline(file, line);
  std::getline(dots, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    WrenchFrame f;
    std::getline(cells, f.name, ',');
    std::getline(cells, f.heights, ',');
    std::getline(cells, f.scene, ',');
    std::getline(cells, cell, ',');
    for (double* number : {&f.pressure_mpa, &f.force_n.x, &f.force_n.y, &f.force_n.z,
                           &f.moment_n_mm.x, &f.moment_n_mm.y, &f.moment_n_mm.z, &f.largest_fxy,
                           &f.largest_fz, &f.largest_mxy, &f.largest_mz}) {
      std::getline(cells, cell, ',');
      *number = std::stod(cell);
    }
    for (Index row = 0; row < 3; ++row) {
      std::getline(dots, line);
      std::istringstream numbers(line);
      std::getline(numbers, cell, ',');
      require_data(cell == f.name, "wrench_side_dots.csv has another frame than " + f.name);
      std::getline(numbers, cell, ',');
      require_data(std::stoi(cell) == row + 1, "wrench_side_dots.csv lacks a row");
      for (Index k = 0; k < side_dots; ++k) {
        for (double* number : {&f.dots(row, k).x, &f.dots(row, k).y, &f.dots(row, k).z}) {
          std::getline(numbers, cell, ',');
          *number = std::stod(cell);
        }
      }
    }
    f.number = frames.size();
    frames.push_back(f);
  }
  require_data(frames.size() == 15, "wrench_frames.csv has not 15 frames");
  return frames;
}

inline const std::vector<WrenchFrame>& wrench_frames() {
  static const std::vector<WrenchFrame> all = read_wrench_frames();
  return all;
}

/// Border where the membrane is fixed, one point per side dot.
inline Image<Point3<double>> rim_border() {
  Image<Point3<double>> points(1, side_dots, {0, 0, 0});
  for (Index k = 0; k < side_dots; ++k) {
    const double at = 2 * std::numbers::pi * static_cast<double>(k) / side_dots;
    points(0, k) = {base_radius_mm * std::cos(at), base_radius_mm * std::sin(at), 0};
  }
  return points;
}

/// Side dots of a frame measured in one row, or in two.
inline Image<Point3<double>> rows_of(const Image<Point3<double>>& dots, Index rows) {
  Image<Point3<double>> out(rows, side_dots, {0, 0, 0});
  const auto from = dots.cells.begin() + (rows == 1 ? 0 : side_dots);
  std::copy(from, from + rows * side_dots, out.cells.begin());
  return out;
}

/// Exact shapes of the finite-element membranes.
inline const HeightMap<>& exact_heights(const std::string& name) {
  static std::map<std::string, HeightMap<>> all;
  const auto found = all.find(name);
  if (found != all.end()) {
    return found->second;
  }
  const Membrane membrane(name);
  const TrueContact contact(name);
  HeightMap<> map(19.5, 0.5);
  map.fill(
      [&](Index i, Index j) {
        const double x = map.position_mm(j), y = map.position_mm(i);
        return std::hypot(x, y) > base_radius_mm ? nan : membrane(x, y);
      },
      [&](Index i, Index j, const auto&...) {
        // share of the node's surroundings in contact
        double share = 0;
        for (const double down : {-0.125, 0.125}) {
          for (const double right : {-0.125, 0.125}) {
            share += contact(map.position_mm(j) + right, map.position_mm(i) + down) ? 0.25 : 0;
          }
        }
        return share;
      });
  return all.emplace(name, map).first->second;
}

}  // namespace test
