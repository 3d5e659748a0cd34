// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: the grid, one concept for images, depth maps, dot grids and taxel arrays.
// A grid has rows(), cols() and a cell at (row, column); x runs along columns, y along rows. What
// the cell is (a byte, a float, a dual number, a 2-vector) is up to the algorithm that reads it.
//
// A type is a grid in one of two ways: it has members rows(), cols() and operator()(row, col), or
// grid_traits is specialised for it (see adapt/, and examples/02_your_own_image_type.cpp).
// Algorithms work on views only: cheap values that neither own nor copy pixels.
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "fingerpad/core/check.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail {
template <class G> concept has_size_members = requires(const G& g) {
  g.rows();
  g.cols();
};
template <class G> concept has_call_operator = requires(G& g, Index i) {
  g(i, i);
};

// Types that look like grids and are not.
template <class G> concept has_cells_in_a_row = !has_size_members<G> && requires(const G& g) {
  g.data() + g.size();
  g[0];
};
template <class G> concept has_bits_in_a_row = !has_size_members<G> && requires(G & g) {
  g.flip();  // std::vector<bool>
  g[0];
};
template <class Cell> concept has_channels = requires(const Cell& cell) {
  cell[0];
};
template <class G> concept has_size_fields = requires(const G& g) {
  g.rows + g.cols;
};
}  // namespace detail

/// The one customisation point. Required: static rows(g), cols(g), at(g, row, col), where `at` of
/// a mutable grid returns something that can be assigned to. Optional, for grids in plain memory:
/// static data(g), row_stride(g), col_stride(g), strides counted in cells. The most common
/// mistakes get a one-line error message wherever a grid is expected.
template <class G>
struct grid_traits {
  static_assert(!detail::has_cells_in_a_row<G>,
                "a vector has no rows and columns: pass fingerpad::grid_of(vector, rows, cols)");
  static_assert(!detail::has_bits_in_a_row<G>,
                "a std::vector<bool> has no cells in memory: take a std::vector<unsigned char> and "
                "pass fingerpad::grid_of(vector, rows, cols)");
  static_assert(
      !detail::has_size_fields<G>,
      "the type of the pixels of a cv::Mat is not known: include fingerpad/adapt/opencv.hpp and "
      "pass cv::Mat_<T>(image), or fingerpad::channel<T>(image, c) of a colour image");

  static constexpr Index rows(const G& g) requires(detail::has_size_members<G>) {
    return static_cast<Index>(g.rows());
  }
  static constexpr Index cols(const G& g) requires(detail::has_size_members<G>) {
    return static_cast<Index>(g.cols());
  }
  template <detail::has_call_operator Self>
  static constexpr decltype(auto) at(Self& g, Index row, Index col) {
    return g(row, col);
  }
};

namespace detail {
template <class G>
using traits_of = grid_traits<std::remove_cvref_t<G>>;

template <class G> concept readable_grid = requires(const std::remove_cvref_t<G>& g, Index i) {
  { traits_of<G>::rows(g) } -> std::convertible_to<Index>;
  { traits_of<G>::cols(g) } -> std::convertible_to<Index>;
  traits_of<G>::at(g, i, i);
};

template <class G>
struct cell {  // void instead of an error if G is not a grid: the concept then reports G
  using type = void;
};
template <readable_grid G>
struct cell<G> {
  using type = std::remove_cvref_t<decltype(traits_of<G>::at(
      std::declval<const std::remove_cvref_t<G>&>(), Index(0), Index(0)))>;
};
}  // namespace detail

/// The type of the grid's cells, without reference or const; void if G is not a grid.
template <class G>
using cell_t = typename detail::cell<G>::type;

/// Anything with rows, columns and readable cells.
template <class G> concept grid = detail::readable_grid<G> && !std::is_void_v<cell_t<G>>;

/// A grid whose cells can be assigned from T.
template <class G, class T = cell_t<G>>
concept writable_grid = grid<G> && requires(std::remove_reference_t<G>& g, const T& cell, Index i) {
  // a cell returned by value is a copy: an assignment to it would be lost
  requires !std::same_as<decltype(detail::traits_of<G>::at(g, i, i)), cell_t<G>>;
  detail::traits_of<G>::at(g, i, i) = static_cast<cell_t<G>>(cell);
};

namespace detail {
template <class G>
inline constexpr bool always_false = false;  ///< of a template argument, for static_assert
/// Called by functions that write cells of type T, so that the first compile error says why G
/// cannot take them.
template <class G, class T = void>
constexpr void writes_to() {
  if constexpr (grid<G>) {
    static_assert(std::is_void_v<T> || std::is_enum_v<T> || !std::is_integral_v<cell_t<G>>,
                  "this grid is written to: whole numbers would cut off fractions and NaN; give it "
                  "cells of float or double");
    static_assert(writable_grid<G, std::conditional_t<std::is_void_v<T>, cell_t<G>, T>>,
                  "this grid is written to: its cells must be assignable, neither const nor "
                  "computed");
  } else {
    static_assert(always_false<G>, "this argument is written to: pass a grid");
  }
}
/// A grid to which cells of type T can be written, NaN included.
template <class G, class T>
concept takes_numbers = writable_grid<G, T> && !std::is_integral_v<cell_t<G>>;
}  // namespace detail

/// A grid in plain memory: cell (i, j) is data[i * row_stride + j * col_stride].
template <class G> concept strided_grid = grid<G> && requires(const std::remove_cvref_t<G>& g) {
  { *detail::traits_of<G>::data(g) } -> std::convertible_to<cell_t<G>>;
  { detail::traits_of<G>::row_stride(g) } -> std::convertible_to<Index>;
  { detail::traits_of<G>::col_stride(g) } -> std::convertible_to<Index>;
};

template <grid G>
constexpr Index rows(const G& g) {
  return detail::traits_of<G>::rows(g);
}
template <grid G>
constexpr Index cols(const G& g) {
  return detail::traits_of<G>::cols(g);
}

/// Gives types that are not grids a readable compile error.
template <class G>
  requires(!grid<G>)
constexpr Index rows(const G&) {
  static_assert(
      detail::always_false<G>,
      "this type is not a grid: give it rows(), cols() and a const operator()(row, col), or "
      "specialise fingerpad::grid_traits for it");
  return 0;
}
template <class G>
  requires(!grid<G>)
constexpr Index cols(const G& g) {
  return rows(g);
}

/// True when the two grids have the same number of rows and of columns.
template <grid A, grid B>
constexpr bool same_size(const A& a, const B& b) {
  return rows(a) == rows(b) && cols(a) == cols(b);
}

/// Cells in plain memory with signed strides; T is const for a view that only reads. Region,
/// transpose, flip, every n-th row, one channel of an interleaved image: all are this view with
/// another start and other strides.
template <class T>
class StridedView {
 public:
  constexpr StridedView() = default;
  constexpr StridedView(T* data, Index rows, Index cols, Index row_stride, Index col_stride = 1)
      : data_(data), rows_(rows), cols_(cols), row_stride_(row_stride), col_stride_(col_stride) {}
  /// Gives the conversion from a read-only to a writable view a readable compile error.
  template <class Other>
    requires(!std::is_const_v<T> && std::same_as<Other, const T>)
  constexpr explicit StridedView(const StridedView<Other>&) {
    static_assert(detail::always_false<Other>,
                  "a read-only view cannot become a writable view: take "
                  "StridedView<const T>, or make the view from cells that are not const");
  }
  /// A read-only view from a writable one.
  constexpr operator StridedView<const T>() const requires(!std::is_const_v<T>) {
    return {data_, rows_, cols_, row_stride_, col_stride_};
  }

  constexpr Index rows() const { return rows_; }
  constexpr Index cols() const { return cols_; }
  constexpr Index row_stride() const { return row_stride_; }
  constexpr Index col_stride() const { return col_stride_; }
  constexpr T* data() const { return data_; }
  constexpr T* row(Index i) const { return data_ + i * row_stride_; }
  constexpr T& operator()(Index i, Index j) const {
    return data_[i * row_stride_ + j * col_stride_];
  }

 private:
  T* data_ = nullptr;
  Index rows_ = 0;
  Index cols_ = 0;
  Index row_stride_ = 0;
  Index col_stride_ = 1;
};

/// Cells found on demand by a function of (row, col): a conversion, a synthetic image, the cells of
/// a grid that offers no more than access to them.
template <class F>
class LazyView {
 public:
  constexpr LazyView(Index rows, Index cols, F function)
      : rows_(rows), cols_(cols), function_(std::move(function)) {}
  constexpr Index rows() const { return rows_; }
  constexpr Index cols() const { return cols_; }
  constexpr decltype(auto) operator()(Index i, Index j) const { return function_(i, j); }

 private:
  Index rows_;
  Index cols_;
  F function_;
};
template <class F>
LazyView(Index, Index, F) -> LazyView<F>;

template <class T>
struct grid_traits<StridedView<T>> {
  using View = StridedView<T>;
  static constexpr Index rows(const View& v) { return v.rows(); }
  static constexpr Index cols(const View& v) { return v.cols(); }
  static constexpr T& at(const View& v, Index row, Index col) { return v(row, col); }
  static constexpr T* data(const View& v) { return v.data(); }
  static constexpr Index row_stride(const View& v) { return v.row_stride(); }
  static constexpr Index col_stride(const View& v) { return v.col_stride(); }
};

namespace detail {
template <class G>
inline constexpr bool is_view = false;
template <class T>
inline constexpr bool is_view<StridedView<T>> = true;
template <class F>
inline constexpr bool is_view<LazyView<F>> = true;
}  // namespace detail

/// The most capable view of a grid: the grid itself if it is a view, a StridedView if it lies in
/// plain memory, else a LazyView that reads its cells. The grid must outlive the view; a temporary
/// that owns its cells is refused at compile time ("use of deleted function").
template <grid G>
constexpr auto as_view(G&& g) {
  using Traits = detail::traits_of<G>;
  if constexpr (detail::is_view<std::remove_cvref_t<G>>) {
    return g;
  } else if constexpr (strided_grid<G>) {
    return StridedView(Traits::data(g), Traits::rows(g), Traits::cols(g), Traits::row_stride(g),
                       Traits::col_stride(g));
  } else {
    // A grid may overload operator&, and std::addressof would bring <memory> into every header.
    return LazyView(Traits::rows(g), Traits::cols(g),
                    [g = __builtin_addressof(g)](Index i, Index j) -> decltype(auto) {
                      return Traits::at(*g, i, j);
                    });
  }
}
template <grid G>
  requires(!std::is_lvalue_reference_v<G> && !detail::is_view<std::remove_cvref_t<G>>)
constexpr auto as_view(G&& temporary) = delete;  // its view would dangle: give it a name

/// Refuses impossible sizes, for which memory would run out or overflow (parameter_error): rows and
/// cols must be in [`min`, 1e6], with at most 1e8 cells, each stored `copies` times.
inline void expects_grid_size(
    const char* owner, Index rows, Index cols, Index min = 1, Index copies = 1) {
  const Range side = within(static_cast<double>(min), 1e6), total = {.max = 1e8};
  require(owner, {{"rows", rows, side}, {"cols", cols, side}});
  const long long cells = static_cast<long long>(rows) * cols;
  require(owner, {{"rows times cols", cells, total}, {"cells in memory", cells * copies, total}});
}

/// The first rows x cols cells of a vector, array or span as a grid, row by row, without a copy.
/// Refuses fewer cells (parameter_error). The cells must outlive the view.
template <detail::has_cells_in_a_row Cells>
auto grid_of(Cells& cells, Index rows, Index cols) {
  expects_grid_size("grid_of", rows, cols, 0);
  expects(static_cast<Index>(cells.size()) >= rows * cols, "grid_of", "number of cells",
          static_cast<long long>(cells.size()), ">= rows * cols");
  using T = std::remove_pointer_t<decltype(cells.data())>;
  return StridedView<T>(cells.data(), rows, cols, cols);
}
template <detail::has_cells_in_a_row Cells>
  requires(!std::is_lvalue_reference_v<Cells>)
auto grid_of(Cells&& temporary, Index rows, Index cols) = delete;  // would dangle: name the cells
/// Gives std::vector<bool> a readable compile error.
template <class Bits>
  requires(detail::has_bits_in_a_row<std::remove_cvref_t<Bits>>)
StridedView<unsigned char> grid_of(Bits&&, Index, Index) {
  static_assert(detail::always_false<Bits>,
                "a std::vector<bool> has no cells in memory: take a std::vector<unsigned char>");
  return {};
}

/// The rectangle of `row_count` x `col_count` cells whose first cell is (row, col).
template <class T>
constexpr StridedView<T> region(
    StridedView<T> v, Index row, Index col, Index row_count, Index col_count) {
  return {v.data() + row * v.row_stride() + col * v.col_stride(), row_count, col_count,
          v.row_stride(), v.col_stride()};
}

/// Rows and columns exchanged.
template <class T>
constexpr StridedView<T> transpose(StridedView<T> v) {
  return {v.data(), v.cols(), v.rows(), v.col_stride(), v.row_stride()};
}

/// Channel `c` of an image whose `channels` values lie side by side in each pixel (BGRBGR...).
/// `row_stride` is counted in values, as in `channels * cols` for an image without padding.
template <class T>
constexpr StridedView<T> interleaved_channel(
    T* data, Index rows, Index cols, Index channels, Index c, Index row_stride) {
  return {data + c, rows, cols, row_stride, channels};
}

/// What became of a frame.
enum class FrameStatus : std::uint8_t {
  ok,
  not_of_this_pad,  ///< the result is unreliable: the sensor unit, lamp or layout is not that of
                    ///< the free pad, or the object is larger than the camera's view
  refused,          ///< a grid or the memory given with it has the wrong size: nothing was written
};

/// "ok", "not of this pad" or "refused".
constexpr const char* name_of(FrameStatus status) {
  return status == FrameStatus::ok                ? "ok"
         : status == FrameStatus::not_of_this_pad ? "not of this pad"
                                                  : "refused";
}

/// A pixel of a contact mask. As a number: black, grey and white of an 8-bit image.
enum class Touch : std::uint8_t { none = 0, unknown = 127, contact = 255 };

/// Whether a cell of a mask means contact: bytes, bools and numbers other than 0 and NaN, or
/// Touch::contact.
template <class Cell>
constexpr bool is_contact(const Cell& cell) {
  if constexpr (std::is_same_v<Cell, Touch>) {
    return cell == Touch::contact;
  } else if constexpr (std::is_floating_point_v<Cell>) {
    return cell < 0 || cell > 0;
  } else {
    return static_cast<bool>(cell);
  }
}

/// A contact mask: a grid whose cells convert to bool.
template <class G> concept contact_mask = grid<G> && requires(const cell_t<G>& cell) {
  static_cast<bool>(cell);
};

}  // namespace v1
}  // namespace fingerpad
