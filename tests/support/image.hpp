// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"

namespace test {

using fingerpad::Index;

/// An image that owns its memory.
template <class T>
struct Image {
  Index height = 0;
  Index width = 0;
  std::vector<T> cells;

  Image() = default;
  Image(Index rows, Index cols, const T& cell = T())
      : height(rows), width(cols), cells(static_cast<std::size_t>(rows * cols), cell) {}
  Index rows() const { return height; }
  Index cols() const { return width; }
  T& operator()(Index i, Index j) { return cells[static_cast<std::size_t>(i * width + j)]; }
  const T& operator()(Index i, Index j) const {
    return cells[static_cast<std::size_t>(i * width + j)];
  }
  fingerpad::StridedView<T> view() { return {cells.data(), height, width, width}; }
  fingerpad::StridedView<const T> view() const { return {cells.data(), height, width, width}; }
};

/// Fills a grid cell by cell through the grid functions.
template <class Grid, class T>
void fill_from(Grid&& grid, const Image<T>& from) {
  const auto view = fingerpad::as_view(grid);
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j) {
      view(i, j) = static_cast<fingerpad::cell_t<Grid>>(from(i, j));
    }
  }
}

/// The same points in another number type.
template <class S>
Image<fingerpad::Point3<S>> as(const Image<fingerpad::Point3<double>>& from) {
  Image<fingerpad::Point3<S>> to(from.rows(), from.cols(), {S(0), S(0), S(0)});
  for (std::size_t k = 0; k < from.cells.size(); ++k) {
    to.cells[k] = {S(from.cells[k].x), S(from.cells[k].y), S(from.cells[k].z)};
  }
  return to;
}

}  // namespace test

template <class T>
struct fingerpad::grid_traits<test::Image<T>> {
  using Image = test::Image<T>;
  static Index rows(const Image& g) { return g.height; }
  static Index cols(const Image& g) { return g.width; }
  static const T& at(const Image& g, Index row, Index col) { return g(row, col); }
  static T& at(Image& g, Index row, Index col) { return g(row, col); }
  static const T* data(const Image& g) { return g.cells.data(); }
  static T* data(Image& g) { return g.cells.data(); }
  static Index row_stride(const Image& g) { return g.width; }
  static Index col_stride(const Image&) { return 1; }
};
