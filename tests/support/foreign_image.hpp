// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// An image type that the library does not know: rows allocated one by one, with its own names. It
// is connected by grid_traits alone.
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"

namespace test {

template <class T>
struct ForeignImage {
  std::vector<std::vector<T>> lines;

  ForeignImage(std::ptrdiff_t height, std::ptrdiff_t width)
      : lines(static_cast<std::size_t>(height), std::vector<T>(static_cast<std::size_t>(width))) {}
};

}  // namespace test

template <class T>
struct fingerpad::grid_traits<test::ForeignImage<T>> {
  using Image = test::ForeignImage<T>;
  static Index rows(const Image& g) { return static_cast<Index>(g.lines.size()); }
  static Index cols(const Image& g) {
    return g.lines.empty() ? 0 : static_cast<Index>(g.lines.front().size());
  }
  static const T& at(const Image& g, Index row, Index col) {
    return g.lines[static_cast<std::size_t>(row)][static_cast<std::size_t>(col)];
  }
  static T& at(Image& g, Index row, Index col) {
    return g.lines[static_cast<std::size_t>(row)][static_cast<std::size_t>(col)];
  }
};
