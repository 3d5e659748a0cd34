// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Masks made larger or smaller by a disc of any radius, in a time that does not depend on it.
#include <algorithm>
#include <cmath>

#include "fingerpad/image/detail/mask_distance.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {

/// Grows (by_px > 0) or shrinks (by_px < 0) masks of one size. What lies beyond the image neither
/// adds nor takes away. O(rows cols), no allocation.
class MaskGrowth {
 public:
  /// rows, cols >= 1 (parameter_error).
  MaskGrowth(Index rows, Index cols) : rows_(rows), cols_(cols) {
    expects(rows >= 1, "MaskGrowth", "rows", static_cast<long long>(rows), ">= 1");
    expects(cols >= 1, "MaskGrowth", "cols", static_cast<long long>(cols), ">= 1");
  }

  using Workspace = detail::MaskDistance;
  Workspace workspace() const { return Workspace(rows_, cols_); }

  /// Writes 255 (true) to `out` in the changed mask and 0 elsewhere; it may be `mask` itself.
  /// False, and nothing written, where a size differs or by_px is not finite.
  template <grid Mask, class Out>
    requires(writable_grid<Out>)
  bool operator()(const Mask& mask, double by_px, Out&& out, Workspace& distance) const {
    const auto from = as_view(mask);
    const auto to = as_view(out);
    if (!has_size(from) || !has_size(to) || !has_size(distance) || !is_finite(by_px)) {
      return false;
    }
    const bool grows = by_px >= 0;
    // what is in no mask is farther than this
    const double reach = (std::min)(std::abs(by_px), static_cast<double>(rows_ + cols_ - 1));
    distance.measure(
        [&](Index i, Index j) { return is_contact(cell_t<Mask>(from(i, j))) == grows; });
    for (Index i = 0; i < rows_; ++i) {
      distance.row(i, [&](Index j, double squared_px) {
        const bool near = squared_px <= reach * reach;
        to(i, j) = static_cast<cell_t<Out>>(near == grows ? 255 : 0);
      });
    }
    return true;
  }

 private:
  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == rows_ && g.cols() == cols_;
  }
  Index rows_;
  Index cols_;
};

}  // namespace v0
}  // namespace fingerpad
