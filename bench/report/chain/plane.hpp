// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Images that own their memory, and views of them for whole programs.
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"

namespace chain {

template <class T>
struct Plane {
  fingerpad::Index rows = 0;
  fingerpad::Index cols = 0;
  std::vector<T> cells;

  Plane(fingerpad::Index height, fingerpad::Index width, const T& cell = T())
      : rows(height), cols(width), cells(static_cast<std::size_t>(height * width), cell) {}

  fingerpad::StridedView<T> view() { return {cells.data(), rows, cols, cols}; }
  fingerpad::StridedView<const T> view() const { return {cells.data(), rows, cols, cols}; }
};

}  // namespace chain
