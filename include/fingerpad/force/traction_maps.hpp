// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The maps of a frame, and the memory that frames need.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/dot_cell.hpp"

namespace fingerpad {
inline namespace v0 {

template <class Modulus, scalar S>
class TractionField;

namespace detail::traction {

/// What is known of a dot in a frame.
enum DotFlag : std::uint8_t {
  found = 1,
  bridged = 2,  ///< not found, but put between its neighbours
  summed = 4,   ///< has a load, be it from bridged dots
  loaded = 8,   ///< has a load of its own, from found dots only
};

enum class CellState : std::uint8_t {
  unknown,  ///< or refused
  bridged,  ///< a corner was not found, but bridged
  found,
};

inline constexpr std::uint8_t far_away = 255;

/// Everything of a frame, dot by dot and cell by cell, in the order of rows.
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
  /// Between dots (i, j) and (i + 1, j + 1).
  std::size_t cell_at(Index i, Index j) const {
    return static_cast<std::size_t>(i * (cols - 1) + j);
  }
  bool has(std::size_t dot, DotFlag flag) const { return (flags[dot] & flag) != 0; }
  void set(std::size_t dot, DotFlag flag) {
    flags[dot] = static_cast<std::uint8_t>(flags[dot] | flag);
  }
};

}  // namespace detail::traction

/// What the last frame said of each dot and of each cell; NaN where it said nothing. A value, of
/// which each thread needs one of its own. Views hold as long as the maps do.
template <scalar S = double>
class TractionMaps {
 public:
  Index rows() const { return memory_.rows; }
  Index cols() const { return memory_.cols; }

  /// What the object exerts on the pad, MPa: per area as it is now.
  StridedView<const Point3<S>> load_mpa() const { return dots(memory_.load); }
  /// How hard it presses into the pad: -load . n, with n out of the pad.
  StridedView<const S> pressure_mpa() const { return dots(memory_.pressure); }
  /// The part of the load along the membrane.
  StridedView<const Point3<S>> shear_mpa() const { return dots(memory_.shear); }
  /// Area that belongs to the dot, along n, mm^2; a load times its length is a force.
  StridedView<const Point3<S>> area_mm2() const { return dots(memory_.area); }
  /// Principal tensions of the cell between dots (i, j) and (i + 1, j + 1), N/mm; one row and one
  /// column less than there are dots.
  StridedView<const CellTension<S>> tension_n_per_mm() const {
    return {memory_.tension.data(), rows() - 1, cols() - 1, cols() - 1};
  }

 private:
  template <class Modulus, scalar T>
  friend class TractionField;

  TractionMaps(Index rows, Index cols) : memory_(rows, cols) {}
  template <class T>
  StridedView<const T> dots(const std::vector<T>& values) const {
    return {values.data(), rows(), cols(), cols()};
  }

  detail::traction::FrameMemory<S> memory_;
};

}  // namespace v0
}  // namespace fingerpad
