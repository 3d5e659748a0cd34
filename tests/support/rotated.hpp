// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rotated and mirrored images, for tests of symmetry.
#include <algorithm>

#include "support/pad.hpp"

namespace test {

template <class T>
Image<T> transposed(const Image<T>& image) {
  Image<T> out(image.cols(), image.rows());
  for (Index i = 0; i < image.rows(); ++i) {
    for (Index j = 0; j < image.cols(); ++j) {
      out(j, i) = image(i, j);
    }
  }
  return out;
}

/// Rotated by half a turn.
template <class T>
Image<T> rotated(const Image<T>& image) {
  Image<T> out = image;
  std::reverse(out.cells.begin(), out.cells.end());
  return out;
}

/// Last column first.
template <class T>
Image<T> mirrored(const Image<T>& image) {
  Image<T> out(image.rows(), image.cols());
  for (Index i = 0; i < image.rows(); ++i) {
    for (Index j = 0; j < image.cols(); ++j) {
      out(i, image.cols() - 1 - j) = image(i, j);
    }
  }
  return out;
}

}  // namespace test
