// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// xtensor containers, adaptors and views of two dimensions as grids. Those in plain memory become
// strided views; other expressions are read cell by cell. Both header layouts of xtensor (flat, as
// in 0.24, and in folders, as from 0.26 on) are found.
#if __has_include(<xtensor/core/xexpression.hpp>)
#include <xtensor/core/xexpression.hpp>
#else
#include <xtensor/xexpression.hpp>
#endif

#include <cstddef>

#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {
template <class G> concept xtensor_in_memory = requires(G& g) {
  g.data() + g.data_offset();
  g.strides();
};
}  // namespace detail

template <class G>
  requires(xt::is_xexpression<G>::value)
struct grid_traits<G> {
  static Index rows(const G& g) { return static_cast<Index>(g.shape()[0]); }
  static Index cols(const G& g) { return static_cast<Index>(g.shape()[1]); }
  static decltype(auto) at(const G& g, Index row, Index col) {
    return g(static_cast<std::size_t>(row), static_cast<std::size_t>(col));
  }
  static decltype(auto) at(G& g, Index row, Index col) {
    return g(static_cast<std::size_t>(row), static_cast<std::size_t>(col));
  }
  static auto* data(const G& g) requires(detail::xtensor_in_memory<const G>) {
    return g.data() + g.data_offset();
  }
  static auto* data(G& g) requires(detail::xtensor_in_memory<G>) {
    return g.data() + g.data_offset();
  }
  static Index row_stride(const G& g) requires(detail::xtensor_in_memory<const G>) {
    return static_cast<Index>(g.strides()[0]);
  }
  static Index col_stride(const G& g) requires(detail::xtensor_in_memory<const G>) {
    return static_cast<Index>(g.strides()[1]);
  }
};

}  // namespace v0
}  // namespace fingerpad
