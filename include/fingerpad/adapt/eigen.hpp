// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Eigen matrices, arrays, maps, references and blocks as grids in memory, row- or column-major.
// Expressions without memory (a + b) need no adapter: they have rows(), cols() and (i, j).
// Dual numbers as scalars of matrices.
#include <Eigen/Core>
#include <cstddef>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail {
template <class G>
concept eigen_in_memory = std::derived_from<G, Eigen::DenseBase<G>> &&
                          (Eigen::internal::traits<G>::Flags& Eigen::DirectAccessBit) != 0;
template <class G> concept eigen_writable = requires(G& g, Index i) {
  g.coeffRef(i, i);
};
}  // namespace detail

template <detail::eigen_in_memory G>
struct grid_traits<G> {
  static Index rows(const G& g) { return g.rows(); }
  static Index cols(const G& g) { return g.cols(); }
  static decltype(auto) at(const G& g, Index row, Index col) { return g.coeff(row, col); }
  static decltype(auto) at(G& g, Index row, Index col) requires(detail::eigen_writable<G>) {
    return g.coeffRef(row, col);
  }
  static auto* data(const G& g) { return g.data(); }
  static auto* data(G& g) { return g.data(); }
  static Index row_stride(const G& g) { return G::IsRowMajor ? g.outerStride() : g.innerStride(); }
  static Index col_stride(const G& g) { return G::IsRowMajor ? g.innerStride() : g.outerStride(); }
};

}  // namespace v1
}  // namespace fingerpad

template <std::size_t N, class Value>
struct Eigen::NumTraits<fingerpad::Dual<N, Value>> : Eigen::NumTraits<Value> {
  using Real = fingerpad::Dual<N, Value>;
  using NonInteger = Real;
  using Nested = Real;
  enum {
    RequireInitialization = 1,
    AddCost = static_cast<int>(N) + 1,
    MulCost = 3 * static_cast<int>(N) + 1
  };
};
