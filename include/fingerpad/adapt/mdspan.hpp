// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// mdspan of rank two as a grid, from any library (std, std::experimental, Kokkos). It is recognised
// by its members, so no mdspan header is included. Cells are read through accessor and mapping, so
// both [] and () as index operator work.
#include <concepts>
#include <type_traits>

#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail {
template <class G> concept mdspan_2d = G::rank()
== 2 && requires(const G& g) {
  typename G::accessor_type;
  typename G::mapping_type;
  g.accessor().access(g.data_handle(), g.mapping()(0, 0));
  g.extent(0);
};
}  // namespace detail

template <detail::mdspan_2d G>
struct grid_traits<G> {
  using Extent = typename G::index_type;
  static constexpr Index rows(const G& g) { return static_cast<Index>(g.extent(0)); }
  static constexpr Index cols(const G& g) { return static_cast<Index>(g.extent(1)); }
  static constexpr decltype(auto) at(const G& g, Index row, Index col) {
    const auto offset = g.mapping()(static_cast<Extent>(row), static_cast<Extent>(col));
    return g.accessor().access(g.data_handle(), offset);
  }
  // Only if the accessor returns a reference into memory, not a computed value.
  static constexpr auto* data(const G& g) requires
      std::is_same_v<typename G::data_handle_type, typename G::element_type*> &&
      std::is_same_v<typename G::reference, typename G::element_type&> &&
      (G::mapping_type::is_always_strided()) {
    return g.data_handle();
  }
  static constexpr Index row_stride(const G& g) requires(G::mapping_type::is_always_strided()) {
    return static_cast<Index>(g.stride(0));
  }
  static constexpr Index col_stride(const G& g) requires(G::mapping_type::is_always_strided()) {
    return static_cast<Index>(g.stride(1));
  }
};

}  // namespace v1
}  // namespace fingerpad
