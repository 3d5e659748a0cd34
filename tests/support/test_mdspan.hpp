// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A stand-in for mdspan of rank two, because neither compiler of the test machine has one. It has
// the standard's members, indexed by () or by [array] as the libraries differ, and layouts and
// accessors of every kind that matters to the adapter.
#include <array>
#include <cstddef>
#include <cstdint>

namespace test {

using MdIndex = std::uint32_t;

struct LayoutStride {  // also right and left, which differ only in the strides they allow
  struct mapping {
    std::array<MdIndex, 2> extents;
    std::array<MdIndex, 2> strides;
    MdIndex operator()(MdIndex i, MdIndex j) const { return i * strides[0] + j * strides[1]; }
    MdIndex stride(std::size_t r) const { return strides[r]; }
    static constexpr bool is_always_strided() { return true; }
  };
  static mapping right(MdIndex rows, MdIndex cols) { return {{rows, cols}, {cols, 1}}; }
  static mapping left(MdIndex rows, MdIndex cols) { return {{rows, cols}, {1, rows}}; }
};

/// The lower triangle is stored row by row and read symmetrically; no stride describes it.
struct LayoutSymmetric {
  struct mapping {
    std::array<MdIndex, 2> extents;
    MdIndex operator()(MdIndex i, MdIndex j) const {
      return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
    }
    static constexpr bool is_always_strided() { return false; }
  };
};

template <class T>
struct PlainAccessor {
  using data_handle_type = T*;
  using reference = T&;
  T& access(T* p, std::size_t i) const { return p[i]; }
};

/// Values computed from memory, as by std::linalg::scaled: the memory itself is not the grid.
template <class T>
struct DoublingAccessor {
  using data_handle_type = T*;
  using reference = T;
  T access(T* p, std::size_t i) const { return p[i] + p[i]; }
};

enum class Indexing { parentheses, brackets };

template <class T,
          class Layout = LayoutStride,
          Indexing How = Indexing::parentheses,
          class Accessor = PlainAccessor<T>>
class TestMdspan {
 public:
  using element_type = T;
  using index_type = MdIndex;
  using layout_type = Layout;
  using mapping_type = typename Layout::mapping;
  using accessor_type = Accessor;
  using data_handle_type = typename Accessor::data_handle_type;
  using reference = typename Accessor::reference;

  TestMdspan(T* data, mapping_type mapping) : data_(data), mapping_(mapping) {}

  static constexpr std::size_t rank() { return 2; }
  MdIndex extent(std::size_t r) const { return mapping_.extents[r]; }
  MdIndex stride(std::size_t r) const requires(mapping_type::is_always_strided()) {
    return mapping_.stride(r);
  }
  const mapping_type& mapping() const { return mapping_; }
  const accessor_type& accessor() const { return accessor_; }
  const data_handle_type& data_handle() const { return data_; }
  reference operator()(MdIndex i, MdIndex j) const requires(How == Indexing::parentheses) {
    return accessor_.access(data_, mapping_(i, j));
  }
  reference operator[](std::array<MdIndex, 2> ij) const requires(How == Indexing::brackets) {
    return accessor_.access(data_, mapping_(ij[0], ij[1]));
  }

 private:
  data_handle_type data_;
  mapping_type mapping_;
  accessor_type accessor_;
};

}  // namespace test
