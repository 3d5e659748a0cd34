// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/adapt/eigen.hpp"

#include <vector>

#include "support/catch.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ColMajor = Eigen::MatrixXd;
using AnyStride = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;

namespace {

const double expected = test::pattern_sum(6, 4);

/// Plain memory: the view points into it and gives the same sum as every other grid.
template <class G>
void check_strided(G& g) {
  STATIC_REQUIRE(strided_grid<G>);
  STATIC_REQUIRE(std::same_as<decltype(as_view(g)), StridedView<double>>);
  test::fill_with_pattern(g);
  CHECK(test::weighted_sum(g) == expected);
  for (Index i = 0; i < g.rows(); ++i) {
    for (Index j = 0; j < g.cols(); ++j) {
      CHECK(&as_view(g)(i, j) == &g.coeffRef(i, j));
    }
  }
}

}  // namespace

TEST_CASE("Eigen's plain objects are strided grids", "[eigen]") {
  ColMajor col_major(6, 4);
  RowMajor row_major(6, 4);
  Eigen::ArrayXXd array(6, 4);
  Eigen::Matrix<double, 6, 4> fixed;
  check_strided(col_major);
  check_strided(row_major);
  check_strided(array);
  check_strided(fixed);
  CHECK(as_view(col_major).row_stride() == 1);
  CHECK(as_view(row_major).col_stride() == 1);
}

TEMPLATE_TEST_CASE("maps, blocks and references share memory", "[eigen]", RowMajor, ColMajor) {
  std::vector<double> memory(500);
  Eigen::Map<TestType> map(memory.data(), 6, 4);
  check_strided(map);
  Eigen::Map<TestType, 0, Eigen::OuterStride<>> padded(memory.data(), 6, 4,
                                                       Eigen::OuterStride<>(9));
  check_strided(padded);
  Eigen::Map<TestType, 0, AnyStride> scattered(memory.data(), 6, 4, AnyStride(40, 3));
  check_strided(scattered);

  TestType matrix(9, 8);
  auto block = matrix.block(2, 3, 6, 4);
  check_strided(block);
  Eigen::Ref<TestType> reference(matrix.block(1, 1, 6, 4));
  check_strided(reference);
  TestType other(4, 6);
  auto transposed = other.transpose();
  check_strided(transposed);
  CHECK(test::weighted_sum(other) != expected);
}

TEST_CASE("vectors are grids of one row or column", "[eigen]") {
  Eigen::VectorXd column = Eigen::VectorXd::LinSpaced(5, 1, 5);
  Eigen::RowVectorXd row = column.transpose();
  CHECK(&as_view(column)(3, 0) == &column(3));
  CHECK(&as_view(row)(0, 3) == &row(3));
  auto third = Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>>(column.data(), 2,
                                                                    Eigen::InnerStride<>(2));
  CHECK(as_view(third)(1, 0) == 3);
}

TEST_CASE("constants stay constant", "[eigen]") {
  ColMajor matrix(6, 4);
  test::fill_with_pattern(matrix);
  const ColMajor& constant = matrix;
  const Eigen::Map<const ColMajor> map(matrix.data(), 6, 4);
  const auto block = constant.topRows(6);
  STATIC_REQUIRE(std::same_as<decltype(as_view(constant)), StridedView<const double>>);
  STATIC_REQUIRE(std::same_as<decltype(as_view(map)), StridedView<const double>>);
  STATIC_REQUIRE(std::same_as<decltype(as_view(block)), StridedView<const double>>);
  STATIC_REQUIRE(writable_grid<ColMajor> && !writable_grid<const ColMajor>);
  STATIC_REQUIRE(!writable_grid<Eigen::Map<const ColMajor>>);
  CHECK(test::weighted_sum(constant) == expected);
  CHECK(test::weighted_sum(map) == expected);
  CHECK(test::weighted_sum(block) == expected);
}

TEST_CASE("expressions are read cell by cell", "[eigen]") {
  ColMajor matrix(6, 4);
  test::fill_with_pattern(matrix);
  const auto sum = matrix + matrix;
  const auto reversed = matrix.reverse();
  STATIC_REQUIRE(grid<decltype(sum)> && !strided_grid<decltype(sum)>);
  STATIC_REQUIRE(!writable_grid<decltype(sum)>);
  CHECK(test::weighted_sum(sum) == 2 * expected);
  CHECK(as_view(reversed)(0, 0) == matrix(5, 3));
}
