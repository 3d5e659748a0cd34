// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/core/grid.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/contact/surface.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;
using test::ForeignImage;
using View = StridedView<int>;

namespace {

/// Not a grid: it has no cells.
struct OnlySizes {
  int rows() const { return 1; }
  int cols() const { return 1; }
};
/// A grid by its members alone, with a proxy as cell, as in bit sets.
struct MemberGrid {
  std::vector<bool> bits = std::vector<bool>(6);
  int rows() const { return 2; }
  int cols() const { return 3; }
  bool operator()(Index i, Index j) const { return bits[static_cast<std::size_t>(3 * i + j)]; }
  auto operator()(Index i, Index j) { return bits[static_cast<std::size_t>(3 * i + j)]; }
};

int ten_rows_and_col(Index i, Index j) {
  return static_cast<int>(10 * i + j);
}
using LazyInts = LazyView<int (*)(Index, Index)>;
using LazyPoints = LazyView<Point2<double> (*)(Index, Index)>;

/// Memory with a random strided view: strides of both signs, gaps between rows and columns.
struct RandomView {
  std::vector<int> memory;
  View view;

  RandomView() {
    const Index rows = test::whole(1, 6);
    const Index cols = test::whole(1, 6);
    const Index col_step = test::whole(1, 3);
    const Index row_step = cols * col_step + test::whole(0, 3);
    memory.resize(static_cast<std::size_t>(rows * row_step));
    for (std::size_t i = 0; i < memory.size(); ++i) {
      memory[i] = static_cast<int>(i);  // every cell is identified by its number
    }
    const bool up = test::whole(0, 1) == 1;
    const bool left = test::whole(0, 1) == 1;
    int* first =
        memory.data() + (up ? (rows - 1) * row_step : 0) + (left ? (cols - 1) * col_step : 0);
    view = View(first, rows, cols, up ? -row_step : row_step, left ? -col_step : col_step);
  }
};

/// Checks that each cell of `derived` is the cell of `v` at `place` itself, not a copy.
template <class Place>
void check_cells(View derived, View v, Index rows, Index cols, const Place& place) {
  RC_ASSERT(derived.rows() == rows);
  RC_ASSERT(derived.cols() == cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const auto [row, col] = place(i, j);
      RC_ASSERT(&derived(i, j) == v.data() + row * v.row_stride() + col * v.col_stride());
    }
    RC_ASSERT(derived.row(i) == &derived(i, 0));
  }
}

}  // namespace

static_assert(grid<ForeignImage<double>> && grid<const ForeignImage<double>&>);
static_assert(grid<View> && grid<LazyInts> && grid<MemberGrid> && grid<StridedView<const int>>);
static_assert(!grid<int> && !grid<OnlySizes> && !grid<void>);
static_assert(std::is_void_v<cell_t<OnlySizes>> && std::same_as<cell_t<const View&>, int>);
static_assert(std::same_as<cell_t<StridedView<const float>>, float>);

static_assert(writable_grid<ForeignImage<double>> && !writable_grid<const ForeignImage<double>>);
static_assert(writable_grid<View> && writable_grid<const View> && writable_grid<MemberGrid>);
static_assert(!writable_grid<StridedView<const int>> && !writable_grid<const MemberGrid>);
static_assert(writable_grid<View, std::uint8_t> && !writable_grid<View, Point2<float>>);
// A computed cell is not writable, even if its type is assignable.
static_assert(!writable_grid<LazyInts>);

static_assert(strided_grid<View> && !strided_grid<ForeignImage<int>> && !strided_grid<LazyInts>);
static_assert(std::convertible_to<View, StridedView<const int>>);
static_assert(!std::convertible_to<StridedView<const int>, View>);

TEST_CASE("computed cells of class type cannot be written", "[grid]") {
  STATIC_REQUIRE(grid<LazyPoints>);
  CHECK_FALSE(writable_grid<LazyPoints>);
  CHECK_FALSE(writable_grid<LazyView<test::Digits50 (*)(Index, Index)>>);
}

TEST_CASE("as_view picks the strongest view and keeps const", "[grid]") {
  ForeignImage<double> image(2, 3);
  const ForeignImage<double>& read_only = image;
  using ImageView = decltype(as_view(image));
  STATIC_REQUIRE(!std::same_as<ImageView, decltype(as_view(read_only))>);
  STATIC_REQUIRE(writable_grid<decltype(as_view(image))>);
  STATIC_REQUIRE(!writable_grid<decltype(as_view(read_only))>);
  as_view(image)(1, 2) = 5;
  CHECK(&as_view(read_only)(1, 2) == &image.lines[1][2]);
  CHECK(rows(as_view(read_only)) == 2);
  CHECK(cols(as_view(read_only)) == 3);

  // Views are passed by value, from lvalues, constants and temporaries alike.
  const View view(nullptr, 0, 0, 0);
  STATIC_REQUIRE(std::same_as<decltype(as_view(view)), View>);
  STATIC_REQUIRE(std::same_as<decltype(as_view(View())), View>);
  STATIC_REQUIRE(std::same_as<decltype(as_view(as_view(image))), ImageView>);
  CHECK(as_view(LazyView(3, 4, ten_rows_and_col))(2, 3) == 23);

  MemberGrid bits;
  as_view(bits)(1, 2) = true;
  CHECK(bits.bits[5]);
}

TEST_CASE("strided views", "[grid]") {
  rc::prop("are direct indexing", [] {
    RandomView r;
    const View v = r.view;
    check_cells(v, v, v.rows(), v.cols(), [](Index i, Index j) { return std::pair(i, j); });
    for (Index i = 0; i < v.rows(); ++i) {  // and no two cells share an address
      for (Index j = 0; j < v.cols(); ++j) {
        RC_ASSERT(&v(i, j) == r.memory.data() + v(i, j));
        v(i, j) = -1;
      }
    }
    RC_ASSERT(std::count(r.memory.begin(), r.memory.end(), -1) == v.rows() * v.cols());
  });
  rc::prop("of a region begin at its first cell", [] {
    RandomView r;
    const View v = r.view;
    const Index row = test::whole(0, v.rows() - 1);
    const Index col = test::whole(0, v.cols() - 1);
    const Index rows = test::whole(0, v.rows() - row);
    const Index cols = test::whole(1, v.cols() - col);
    check_cells(region(v, row, col, rows, cols), v, rows, cols,
                [&](Index i, Index j) { return std::pair(row + i, col + j); });
  });
  rc::prop("are transposed, and back again", [] {
    RandomView r;
    const View v = r.view;
    check_cells(transpose(v), v, v.cols(), v.rows(),
                [](Index i, Index j) { return std::pair(j, i); });
    check_cells(transpose(transpose(v)), v, v.rows(), v.cols(),
                [](Index i, Index j) { return std::pair(i, j); });
  });
  rc::prop("of one interleaved channel skip the others", [] {
    const Index rows = test::whole(1, 5);
    const Index cols = test::whole(1, 5);
    const Index channels = test::whole(1, 4);
    const Index c = test::whole(0, channels - 1);
    const Index row_stride = channels * cols + test::whole(0, 3);
    std::vector<std::uint16_t> image(static_cast<std::size_t>(rows * row_stride));
    const auto v = interleaved_channel(image.data(), rows, cols, channels, c, row_stride);
    RC_ASSERT(v.rows() == rows);
    RC_ASSERT(v.cols() == cols);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        RC_ASSERT(&v(i, j) == image.data() + i * row_stride + channels * j + c);
      }
    }
  });
}

TEST_CASE("views of nothing stay views of nothing", "[grid]") {
  const View none;
  for (const View& v : {transpose(none), region(none, 0, 0, 0, 0)}) {
    CHECK(v.rows() == 0);
    CHECK(v.cols() == 0);
  }
}

TEST_CASE("same_size compares rows with rows", "[grid]") {
  const LazyView a(2, 3, ten_rows_and_col);
  CHECK(same_size(a, ForeignImage<double>(2, 3)));
  CHECK_FALSE(same_size(a, ForeignImage<double>(3, 2)));
  CHECK_FALSE(same_size(a, ForeignImage<double>(2, 4)));
  CHECK_FALSE(same_size(a, ForeignImage<double>(1, 3)));
}

TEST_CASE("one sum on every kind of grid, to the last bit", "[grid]") {
  const double expected = test::pattern_sum(7, 5);
  ForeignImage<double> image(7, 5);
  test::fill_with_pattern(image);
  CHECK(test::weighted_sum(image) == expected);

  std::vector<double> memory(7 * 11);
  StridedView<double> view(memory.data() + 6 * 11 + 1, 7, 5, -11, 2);
  test::fill_with_pattern(view);
  CHECK(test::weighted_sum(view) == expected);
  CHECK(test::weighted_sum(transpose(transpose(view))) == expected);
  CHECK(test::weighted_sum(StridedView<const double>(view)) == expected);
  CHECK(test::weighted_sum(transpose(view)) != expected);

  // Bytes are summed in double; another working scalar can be selected.
  const LazyView bytes(7, 5, [](Index i, Index j) { return static_cast<std::uint8_t>(9 * i + j); });
  const LazyView reals(7, 5, [](Index i, Index j) { return static_cast<double>(9 * i + j); });
  STATIC_REQUIRE(std::same_as<decltype(test::weighted_sum(bytes)), double>);
  CHECK(test::weighted_sum(bytes) == test::weighted_sum(reals));
}

TEST_CASE("vectors, arrays and spans as grids", "[grid]") {
  std::vector<int> cells = {1, 2, 3, 4, 5, 6, 7};
  const auto grid = grid_of(cells, 2, 3);
  STATIC_REQUIRE(std::same_as<decltype(grid), const StridedView<int>>);
  CHECK(rows(grid) == 2);
  CHECK(grid(1, 0) == 4);
  grid(1, 2) = 60;
  CHECK(cells[5] == 60);
  const std::array<double, 4> fixed = {1, 2, 3, 4};
  STATIC_REQUIRE(std::same_as<decltype(grid_of(fixed, 2, 2)), StridedView<const double>>);
  CHECK(grid_of(fixed, 2, 2)(1, 1) == 4);
  CHECK(grid_of(cells, 0, 5).rows() == 0);
  CHECK(test::refusal([&] { (void)grid_of(cells, 3, 3); }) ==
        "grid_of: number of cells = 7, must be >= rows * cols");
  CHECK(test::refusal([&] { (void)grid_of(cells, -1, 3); }) ==
        "grid_of: rows = -1, must be in [0, 1000000]");
}

TEST_CASE("sizes of which memory would run out are refused", "[grid]") {
  const auto said = [](Index rows, Index cols, Index copies = 1) {
    return test::refusal([=] { expects_grid_size("A", rows, cols, 2, copies); });
  };
  constexpr Index huge = Index(1) << (8 * sizeof(Index) - 2);
  CHECK(said(2, 1000000) == "accepted");
  CHECK(said(huge, 4) == "A: rows = " + std::to_string(huge) + ", must be in [2, 1000000]");
  CHECK(said(4, huge) == "A: cols = " + std::to_string(huge) + ", must be in [2, 1000000]");
  CHECK(said(4, 1) == "A: cols = 1, must be in [2, 1000000]");
  CHECK(said(10000, 10001) == "A: rows times cols = 100010000, must be <= 100000000");
  CHECK(said(1000, 1000, 100) == "accepted");
  CHECK(said(1000, 1000, 101) == "A: cells in memory = 101000000, must be <= 100000000");
}

// Contact masks, which every method reads in the same way.

using test::Image;

static_assert(contact_mask<Image<unsigned char>> && contact_mask<Image<float>> &&
              contact_mask<Image<Touch>>);
static_assert(!contact_mask<Image<std::string>> && !contact_mask<int>);

TEST_CASE("a cell says contact by being anything but nothing") {
  CHECK(is_contact(255));
  CHECK(is_contact(true));
  CHECK(is_contact(static_cast<signed char>(-1)));
  CHECK(is_contact(-0.5F));
  CHECK_FALSE(is_contact(0));
  CHECK_FALSE(is_contact(false));
  CHECK_FALSE(is_contact(-0.0));
  CHECK_FALSE(is_contact(std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("what is unknown is no contact, for any method") {
  CHECK(is_contact(Touch::contact));
  CHECK_FALSE(is_contact(Touch::unknown));
  CHECK_FALSE(is_contact(Touch::none));

  // Three pixels in a row: contact, unknown, none.
  Image<Touch> mask(1, 3, Touch::none);
  mask(0, 0) = Touch::contact;
  mask(0, 1) = Touch::unknown;
  Image<Point2<double>> dots(1, 3);
  for (Index j = 0; j < 3; ++j) {
    dots(0, j) = {static_cast<double>(j), 0};
  }
  Image<unsigned char> in_contact(1, 3, 7);
  REQUIRE(contact_at_dots(dots, mask, in_contact));
  CHECK(in_contact.cells == std::vector<unsigned char>{1, 0, 0});

  Image<Touch> patch(20, 30, Touch::unknown);
  for (Index i = 4; i < 16; ++i) {
    for (Index j = 5; j < 20; ++j) {
      patch(i, j) = Touch::contact;
    }
  }
  const Image<float> depth(20, 30, 9.0F);
  CHECK(fit_surface(OrthographicCamera<double>(), depth, patch).pixels == 12 * 15);
}
