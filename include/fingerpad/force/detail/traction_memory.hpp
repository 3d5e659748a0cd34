// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Working memory of a frame.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/dot_cell.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::traction {

/// Whether x is a possible pressure (MPa) or mu t (N/mm). Squares of larger values might overflow.
template <scalar S>
bool is_measure(const S& x) {
  return value(x) > 0 && !(S(1e6) < x);  // false for NaN
}

/// The two sides of the balance. Those of several frames, for example of the free pad, add up.
template <scalar S>
struct ModulusBalance {
  Index dots = 0;           ///< of the free part
  S pressing_mpa = S(0);    ///< sum p
  S holding_per_mm = S(0);  ///< -sum f . n / A, MPa for mu t = 1 N/mm

  /// NaN if the membrane does not balance the pressure.
  S mu_t_n_per_mm() const {
    return value(holding_per_mm) > 0 && value(pressing_mpa) > 0 ? S(pressing_mpa / holding_per_mm)
                                                                : not_a_number<S>();
  }
  ModulusBalance& operator+=(const ModulusBalance& other) {
    dots += other.dots;
    pressing_mpa = pressing_mpa + other.pressing_mpa;
    holding_per_mm += other.holding_per_mm;
    return *this;
  }
};

/// State of a dot in a frame.
enum DotFlag : std::uint8_t {
  found = 1,
  bridged = 2,  ///< not found, but placed by its neighbours
  summed = 4,   ///< has a load, possibly from bridged dots
  loaded = 8,   ///< has a load from found dots only
};

enum class CellState : std::uint8_t {
  unknown,  ///< or refused
  bridged,  ///< at least one corner is bridged
  found,
};

inline constexpr std::uint8_t far_away = 255;

/// Data of a frame, dot by dot and cell by cell, row by row.
template <scalar S>
struct FrameMemory {
  Index rows;
  Index cols;
  std::vector<std::uint8_t> flags;
  std::vector<std::uint8_t> steps;  ///< to the nearest dot in contact, at most far_away
  std::vector<Point3<S>> place, pull, area, load, shear;
  std::vector<S> pressure;
  std::vector<CellState> cell;
  std::vector<Point3<S>> cell_area;
  std::vector<CellTension<S>> tension;

  FrameMemory(Index row_count, Index col_count) : rows(row_count), cols(col_count) {
    const auto dots = static_cast<std::size_t>(rows * cols);
    const auto cells = static_cast<std::size_t>((rows - 1) * (cols - 1));
    flags.assign(dots, 0);
    steps.assign(dots, far_away);
    for (auto* points : {&place, &pull, &area, &load, &shear}) {
      points->assign(dots, missing_point<S>());
    }
    pressure.assign(dots, not_a_number<S>());
    cell.assign(cells, CellState::unknown);
    cell_area.assign(cells, missing_point<S>());
    tension.assign(cells, CellTension<S>());
  }

  bool inside(Index i, Index j) const { return i >= 0 && j >= 0 && i < rows && j < cols; }
  std::size_t dot_at(Index i, Index j) const { return static_cast<std::size_t>(i * cols + j); }
  /// The cell between dots (i, j) and (i + 1, j + 1).
  std::size_t cell_at(Index i, Index j) const {
    return static_cast<std::size_t>(i * (cols - 1) + j);
  }
  bool has(std::size_t dot, DotFlag flag) const { return (flags[dot] & flag) != 0; }
  void set(std::size_t dot, DotFlag flag) {
    flags[dot] = static_cast<std::uint8_t>(flags[dot] | flag);
  }
};

}  // namespace detail::traction
}  // namespace v0
}  // namespace fingerpad
