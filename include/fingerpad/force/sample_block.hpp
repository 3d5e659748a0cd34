// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Many frames at once: samples as the rows of a grid, one quantity a column. They are copied block
// by block into plain arrays, whatever their layout, so that the loop over a block can be a vector
// loop.
#include <algorithm>
#include <array>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"

namespace fingerpad {
inline namespace v0 {

/// What a call on many samples has to say of them.
struct SampleCounts {
  FrameStatus status = FrameStatus::refused;
  Index not_finite = 0;    ///< of the samples: no answer, NaN
  Index beyond_range = 0;  ///< of the others: the measure is larger than any identified

  bool ok() const { return status == FrameStatus::ok; }
};

namespace detail {

constexpr std::size_t block_samples = 64;

/// Some columns of a block of samples.
template <scalar S, std::size_t Columns>
struct SampleBlock {
  std::array<std::array<S, block_samples>, Columns> column;
  std::size_t size = 0;

  template <class View>
  void read(const View& samples, Index first) {
    const Index left = samples.rows() - first;
    size = (std::min)(block_samples, static_cast<std::size_t>(left));
    for (std::size_t j = 0; j < Columns; ++j) {
      for (std::size_t k = 0; k < size; ++k) {
        column[j][k] = S(samples(first + static_cast<Index>(k), static_cast<Index>(j)));
      }
    }
  }
  template <class View>
  void write(const View& results, Index first) const {
    using Cell = cell_t<View>;
    for (std::size_t j = 0; j < Columns; ++j) {
      for (std::size_t k = 0; k < size; ++k) {
        results(first + static_cast<Index>(k), static_cast<Index>(j)) =
            static_cast<Cell>(column[j][k]);
      }
    }
  }
};

/// Calls compute(in, out) for block after block of the samples.
template <scalar S, std::size_t In, std::size_t Out, class Samples, class Results, class Compute>
void for_each_block(const Samples& samples, const Results& results, const Compute& compute) {
  SampleBlock<S, In> in;
  SampleBlock<S, Out> out;
  for (Index first = 0; first < samples.rows(); first += static_cast<Index>(block_samples)) {
    in.read(samples, first);
    out.size = in.size;
    compute(in, out);
    out.write(results, first);
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
