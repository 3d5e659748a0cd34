// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/adapt/xtensor.hpp"

#include <array>
#include <vector>

#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xadapt.hpp>
#include <xtensor/containers/xarray.hpp>
#include <xtensor/containers/xtensor.hpp>
#include <xtensor/views/xview.hpp>
#else
#include <xtensor/xadapt.hpp>
#include <xtensor/xarray.hpp>
#include <xtensor/xtensor.hpp>
#include <xtensor/xview.hpp>
#endif

#include "support/catch.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;
using Tensor = xt::xtensor<double, 2>;
using ColumnMajor = xt::xtensor<double, 2, xt::layout_type::column_major>;

namespace {

const double expected = test::pattern_sum(6, 4);

/// Plain memory: the view points into it and gives the same sum as every other grid.
template <class G>
void check_strided(G& g) {
  STATIC_REQUIRE(strided_grid<G>);
  STATIC_REQUIRE(std::same_as<decltype(as_view(g)), StridedView<double>>);
  test::fill_with_pattern(g);
  CHECK(test::weighted_sum(g) == expected);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const auto row = static_cast<Index>(i), col = static_cast<Index>(j);
      CHECK(&as_view(g)(row, col) == &g(i, j));
      CHECK(&grid_traits<G>::at(g, row, col) == &g(i, j));
    }
  }
}

}  // namespace

TEST_CASE("xtensor's containers are strided grids", "[xtensor]") {
  Tensor tensor({6, 4});
  ColumnMajor column_major({6, 4});
  xt::xarray<double> array = xt::xarray<double>::from_shape({6, 4});
  check_strided(tensor);
  check_strided(column_major);
  check_strided(array);
  CHECK(as_view(tensor).row_stride() == 4);
  CHECK(as_view(column_major).row_stride() == 1);
}

TEST_CASE("xtensor's adaptors and views share memory", "[xtensor]") {
  std::vector<double> memory(24);
  auto adaptor = xt::adapt(memory, std::array<std::size_t, 2>{6, 4});
  check_strided(adaptor);
  CHECK(as_view(adaptor).data() == memory.data());

  Tensor tensor({9, 13});
  auto region = xt::view(tensor, xt::range(2, 8), xt::range(3, 7));
  check_strided(region);
  auto every_second = xt::view(tensor, xt::range(3, 9), xt::range(1, 9, 2));
  check_strided(every_second);
  xt::xtensor<double, 3> stack({2, 6, 4});
  auto one_of_stack = xt::view(stack, 1, xt::all(), xt::all());
  check_strided(one_of_stack);
  CHECK(as_view(one_of_stack).data() == &stack(1, 0, 0));

  xt::xtensor<double, 3> colours({6, 4, 3});
  auto green = xt::view(colours, xt::all(), xt::all(), 1);
  STATIC_REQUIRE(strided_grid<decltype(green)>);
  CHECK(as_view(green).data() == &colours(0, 0, 1));
  CHECK(&as_view(green)(5, 3) == &colours(5, 3, 1));
}

TEST_CASE("xtensor arrays of another rank are grids without cells", "[xtensor]") {
  using Array = xt::xarray<double>;
  const std::vector<Array> others = {Array::from_shape({24}), Array::from_shape({6, 4, 3}),
                                     Array(3.0)};
  for (const Array& other : others) {
    CHECK(rows(other) == 0);
    CHECK(cols(other) == 0);
    const auto view = as_view(other);
    CHECK((view.rows() == 0 && view.cols() == 0 && view.row_stride() == 0));
    CHECK_FALSE(same_size(other, Array::from_shape({6, 4})));
  }
}

TEST_CASE("xtensor grids of one row or one column", "[xtensor]") {
  Tensor row({1, 4});
  Tensor column({6, 1});
  test::fill_with_pattern(row);
  test::fill_with_pattern(column);
  CHECK(test::weighted_sum(row) == test::pattern_sum(1, 4));
  CHECK(test::weighted_sum(column) == test::pattern_sum(6, 1));
}

TEST_CASE("xtensor's constants stay constant", "[xtensor]") {
  Tensor tensor({6, 4});
  test::fill_with_pattern(tensor);
  const Tensor& constant = tensor;
  auto view = xt::view(constant, xt::all(), xt::all());
  STATIC_REQUIRE(std::same_as<decltype(as_view(constant)), StridedView<const double>>);
  STATIC_REQUIRE(writable_grid<Tensor> && !writable_grid<const Tensor>);
  STATIC_REQUIRE(!writable_grid<decltype(view)>);
  CHECK(test::weighted_sum(constant) == expected);
  CHECK(test::weighted_sum(view) == expected);
}

TEST_CASE("xtensor's expressions are read cell by cell", "[xtensor]") {
  Tensor tensor({6, 4});
  test::fill_with_pattern(tensor);
  const auto sum = tensor + tensor;
  STATIC_REQUIRE(grid<decltype(sum)> && !strided_grid<decltype(sum)>);
  STATIC_REQUIRE(!writable_grid<decltype(sum)>);
  CHECK(test::weighted_sum(sum) == 2 * expected);

  const auto some_rows = xt::view(tensor, xt::keep(5, 0, 2), xt::all());
  CHECK(as_view(some_rows)(0, 3) == tensor(5, 3));
  CHECK(as_view(some_rows)(2, 1) == tensor(2, 1));
}
