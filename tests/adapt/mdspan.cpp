// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/adapt/mdspan.hpp"

#include <vector>

#include "support/catch.hpp"
#include "support/test_mdspan.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;
using test::Indexing;
using test::LayoutStride;
using test::LayoutSymmetric;
using test::TestMdspan;

namespace {

template <Indexing How>
struct Like {
  static constexpr Indexing how = How;
};

}  // namespace

TEMPLATE_TEST_CASE("mdspan of any strides is a strided grid, by () or by []",
                   "[mdspan]",
                   Like<Indexing::parentheses>,
                   Like<Indexing::brackets>) {
  using Span = TestMdspan<double, LayoutStride, TestType::how>;
  using ConstSpan = TestMdspan<const double, LayoutStride, TestType::how>;
  STATIC_REQUIRE(strided_grid<Span> && writable_grid<Span>);
  STATIC_REQUIRE(strided_grid<ConstSpan> && !writable_grid<ConstSpan>);

  std::vector<double> memory(200);
  const LayoutStride::mapping gaps{{6, 4}, {20, 3}};
  for (const auto& mapping : {LayoutStride::right(6, 4), LayoutStride::left(6, 4), gaps}) {
    Span span(memory.data(), mapping);
    STATIC_REQUIRE(std::same_as<decltype(as_view(span)), StridedView<double>>);
    test::fill_with_pattern(span);
    CHECK(test::weighted_sum(span) == test::pattern_sum(6, 4));
    CHECK(&as_view(span)(5, 2) == memory.data() + mapping(5, 2));
    ConstSpan constant(memory.data(), mapping);
    STATIC_REQUIRE(std::same_as<decltype(as_view(constant)), StridedView<const double>>);
    CHECK(test::weighted_sum(constant) == test::pattern_sum(6, 4));
  }
}

TEST_CASE("mdspan without strides is read cell by cell", "[mdspan]") {
  std::vector<double> triangle = {1, 2, 3, 4, 5, 6};
  const TestMdspan<double, LayoutSymmetric> span(triangle.data(), {{3, 3}});
  STATIC_REQUIRE(grid<decltype(span)> && !strided_grid<decltype(span)>);
  CHECK(as_view(span)(2, 0) == 4);
  CHECK(as_view(span)(0, 2) == 4);
  as_view(span)(1, 2) = 9;
  CHECK(triangle[4] == 9);
}

TEST_CASE("an accessor that computes is asked for every cell", "[mdspan]") {
  std::vector<double> memory(24);
  StridedView<double> plain(memory.data(), 6, 4, 4);
  test::fill_with_pattern(plain);
  const TestMdspan<double, LayoutStride, Indexing::parentheses, test::DoublingAccessor<double>>
      span(memory.data(), LayoutStride::right(6, 4));
  CHECK_FALSE(strided_grid<decltype(span)>);
  CHECK(test::weighted_sum(span) == 2 * test::pattern_sum(6, 4));
}
