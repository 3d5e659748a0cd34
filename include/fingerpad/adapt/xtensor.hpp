// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// xtensor containers, adaptors and views of two dimensions as grids. Those in memory become strided
// views; other expressions are read cell by cell. Another number of dimensions does not compile. If
// it is known only at run time (xt::xarray), the grid has no rows and columns, and every method
// refuses it for its size. Both header layouts of xtensor (flat, as in 0.24, and in folders, from
// 0.26 on) are supported.
#if __has_include(<xtensor/core/xexpression.hpp>)
#include <xtensor/core/xexpression.hpp>
#else
#include <xtensor/xexpression.hpp>
#endif

#include <cstddef>
#include <type_traits>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail {
template <class G> concept xtensor_in_memory = requires(G& g) {
  g.data() + g.data_offset();
  g.strides();
};

/// Rank of an xtensor expression; 0: known only at run time.
template <class G>
inline constexpr std::size_t rank_when_compiling = 0;
template <class G>
  requires(G::rank < static_cast<std::size_t>(-1))
inline constexpr std::size_t rank_when_compiling<G> = G::rank;
}  // namespace detail

template <class G>
  requires(xt::is_xexpression<G>::value)
struct grid_traits<G> {
  static constexpr std::size_t rank = detail::rank_when_compiling<G>;
  static_assert(rank == 0 || rank == 2,
                "a grid has two dimensions: pass one plane of the tensor, xt::view(tensor, "
                "xt::all(), xt::all(), k)");
  static bool is_plane(const G& g) { return rank == 2 || g.dimension() == 2; }
  static Index rows(const G& g) { return is_plane(g) ? static_cast<Index>(g.shape()[0]) : 0; }
  static Index cols(const G& g) { return is_plane(g) ? static_cast<Index>(g.shape()[1]) : 0; }
  static decltype(auto) at(const G& g, Index row, Index col) { return cell(g, row, col); }
  static decltype(auto) at(G& g, Index row, Index col) { return cell(g, row, col); }
  static auto* data(const G& g) requires(detail::xtensor_in_memory<const G>) {
    return g.data() + g.data_offset();
  }
  static auto* data(G& g) requires(detail::xtensor_in_memory<G>) {
    return g.data() + g.data_offset();
  }
  static Index row_stride(const G& g) requires(detail::xtensor_in_memory<const G>) {
    return is_plane(g) ? static_cast<Index>(g.strides()[0]) : 0;
  }
  static Index col_stride(const G& g) requires(detail::xtensor_in_memory<const G>) {
    return is_plane(g) ? static_cast<Index>(g.strides()[1]) : 0;
  }

 private:
  template <class T>
  static decltype(auto) cell(T& g, Index row, Index col) {
    if constexpr (detail::xtensor_in_memory<T>) {  // g(row, col) of 0.24 fails for view(t, ., ., k)
      return *(data(g) + row * row_stride(g) + col * col_stride(g));
    } else {
      return g(static_cast<std::size_t>(row), static_cast<std::size_t>(col));
    }
  }
};

}  // namespace v1
}  // namespace fingerpad
