// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Each kind of grid that the library reads and writes: of Eigen, OpenCV, xtensor and mdspan, of a
// type that the library does not know, by rows, by columns, backward, and as part of a larger one.
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <type_traits>
#include <utility>
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xarray.hpp>
#include <xtensor/containers/xtensor.hpp>
#include <xtensor/views/xview.hpp>
#else
#include <xtensor/xarray.hpp>
#include <xtensor/xtensor.hpp>
#include <xtensor/xview.hpp>
#endif

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/mdspan.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "support/foreign_image.hpp"
#include "support/image.hpp"
#include "support/test_mdspan.hpp"

namespace test {

template <class T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <class T>
using ColMajor = Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic>;

/// Calls use(grid) with a grid of cells T of each kind. Their cells hold anything.
template <class T, class Use>
void on_every_grid(Index rows, Index cols, const Use& use) {
  use(RowMajor<T>(rows, cols));
  use(ColMajor<T>(rows, cols));
  ColMajor<T> larger(rows + 3, cols + 2);
  use(larger.block(2, 1, rows, cols));
  if constexpr (!std::is_same_v<T, bool>) {  // which it would keep as bits
    use(ForeignImage<T>(rows, cols));
  }
  const auto size = [](Index n) { return static_cast<std::size_t>(n); };
  const std::array<std::size_t, 2> shape = {size(rows), size(cols)};
  use(xt::xtensor<T, 2>(shape));
  use(xt::xtensor<T, 2, xt::layout_type::column_major>(shape));
  const std::array<std::size_t, 2> wide = {size(rows + 2), size(cols + 5)};
  xt::xtensor<T, 2> around(wide);
  use(xt::view(around, xt::range(1, rows + 1), xt::range(3, cols + 3)));

  const auto cells = std::make_unique<T[]>(size(4 * rows * cols));
  const auto r = static_cast<MdIndex>(rows), c = static_cast<MdIndex>(cols);
  use(TestMdspan<T>(cells.get(), LayoutStride::right(r, c)));
  use(TestMdspan<T>(cells.get(), LayoutStride::left(r, c)));
  T* const last = cells.get() + 4 * rows * cols - 1;
  use(fingerpad::StridedView<T>(last, rows, cols, -4 * cols, -2));  // with gaps
  use(fingerpad::LazyView(rows, cols,
                          [&](Index i, Index j) -> T& { return cells[size(i * cols + j)]; }));

  if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
    const int height = static_cast<int>(rows), width = static_cast<int>(cols);
    use(cv::Mat_<T>(height, width));
    for (const int channels : {3, 4}) {  // rows that do not follow each other in memory
      cv::Mat image(height, width + 5, CV_MAKETYPE(cv::DataType<T>::depth, channels));
      cv::Mat part = image(cv::Rect(3, 0, width, height));
      use(fingerpad::channel<T>(part, 1));
    }
  }
}

/// Calls use(grid) with the cells of `from`, as T, in each kind of grid, and in grids that can only
/// be read.
template <class T, class From, class Use>
void from_every_grid(const From& from, const Use& use) {
  const Index rows = from.rows(), cols = from.cols();
  on_every_grid<T>(rows, cols, [&](auto&& grid) {
    fill_from(grid, from);
    use(std::as_const(grid));
  });
  ColMajor<T> columns(rows, cols);
  fill_from(columns, from);
  use(Eigen::Map<const ColMajor<T>>(columns.data(), rows, cols));
  use(fingerpad::LazyView(rows, cols, [&](Index i, Index j) { return T(from(i, j)); }));
}

}  // namespace test
