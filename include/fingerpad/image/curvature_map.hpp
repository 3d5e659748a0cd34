// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Converts a depth map to a curvature map, which tells contact from free membrane: a membrane under
// pressure bulges outward wherever nothing touches it.
// Source: Ito et al. 2011, III.B (eqs. 1-12), and the slides, contact region; E012-E017.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/image/detail/curvature_rows.hpp"
#include "fingerpad/image/detail/depth_units.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

struct [[nodiscard]] CurvatureResult {
  FrameStatus status = FrameStatus::refused;
  Index known_px = 0;    ///< pixels that got a curvature
  Index unknown_px = 0;  ///< the others, which got NaN

  bool ok() const { return status == FrameStatus::ok; }
};

/// Curvature statistics of depth maps of one size, computed in the scalar S: by vectors in float
/// and double, pixel by pixel in any other.
///   Statistic   ClampedMean<>       take this for any object, saddles of the free pad included
///               RingStencil<>       take this when time counts and contacts are flat
///   CameraType  Camera<double>      take this for depth maps along a camera's rays
///               OrthographicCamera  take this for height maps
///
/// A pixel gets NaN if its depth is missing (not finite) or too few of its sections are complete,
/// else the statistic of the complete sections. A missing depth affects no pixel beyond the ring's
/// radius.
///
/// Rounding: in double about 1e-15 per mm. In float, sections by vectors have a relative error of
/// 2.1e-5. An error of one unit in the last place e in a depth (through a camera, in zeta) changes
/// a curvature by up to 4 e / r^2.
///
/// Const: threads may share one map, each with its own workspace and band of rows. Bounded time and
/// no allocation per frame.
template <class Statistic = ClampedMean<>, class CameraType = Camera<double>, scalar S = float>
class CurvatureMap {
 public:
  /// Memory for one frame at a time, allocated up front.
  struct Workspace {
    detail::aligned_vector<S> cells;  ///< zeta, with a margin of NaN on every side
    detail::aligned_vector<S> segment;
    Index stride = 0;
  };

  /// rows, cols in [1, 1e6], at most 1e8 pixels. Depths of magnitude `too_deep_mm` (> 0) or more
  /// count as missing. Refuses bad parameters (parameter_error).
  CurvatureMap(const CameraType& camera,
               Index rows,
               Index cols,
               const CurvatureRing& ring = {},
               double too_deep_mm = std::numeric_limits<double>::infinity())
      : units_(detail::pixel_pitch(camera), checked(too_deep_mm)),
        rows_(checked(ring, rows, cols)),
        cols_(cols),
        margin_((std::min)(static_cast<Index>(std::ceil(ring.radius_px)), (std::max)(rows, cols))),
        stride_(stride_of(margin_, cols)),
        least_((std::max)(
            1,
            static_cast<int>(std::ceil(ring.min_direction_share * Statistic::directions - 1e-9)))),
        kernel_(detail::ring_offsets((std::min)(ring.radius_px, static_cast<double>(margin_)),
                                     Statistic::directions),
                stride_,
                units_.pitch,
                units_.per_mm) {}

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  Workspace workspace() const {
    return {detail::aligned_vector<S>(size(), not_a_number<S>()),
            detail::aligned_vector<S>(static_cast<std::size_t>(Strip::columns), not_a_number<S>()),
            stride_};
  }

  /// Writes curvatures in 1/mm to `out`, which may be the depth map itself.
  template <grid Depth, class Out>
  CurvatureResult operator()(const Depth& depth_mm, Out&& out, Workspace& workspace) const {
    return band(0, rows_, depth_mm, out, workspace);
  }

  /// Computes only rows [first, last) of the output, with the same bits as in the whole image. Both
  /// grids have the size of the image. Rows of the depth map up to the ring's radius beyond the
  /// band are read.
  template <grid Depth, class Out>
  CurvatureResult band(
      Index first, Index last, const Depth& depth_mm, Out&& out, Workspace& workspace) const {
    return box({first, last, 0, cols_}, depth_mm, out, workspace);
  }

  /// The same for a rectangle of the image.
  template <grid Depth, class Out>
  CurvatureResult box(const detail::PixelBox& part,
                      const Depth& depth_mm,
                      Out&& out,
                      Workspace& workspace) const {
    static_assert(detail::takes_numbers<Out, S>,
                  "this grid is written to: its cells must be assignable and able to hold NaN");
    const auto from = as_view(depth_mm);
    const auto to = as_view(out);
    if (from.rows() != rows_ || from.cols() != cols_ || to.rows() != rows_ || to.cols() != cols_ ||
        part.first_row < 0 || part.last_row < part.first_row || part.last_row > rows_ ||
        part.first_col < 0 || part.last_col < part.first_col || part.last_col > cols_ ||
        !fits(workspace)) {
      return {};
    }
    const detail::PixelBox read = part.grown(margin_, rows_, cols_);
    for (Index i = read.first_row; i < read.last_row; ++i) {
      load_row(from, i, read, cell(workspace, i, 0));
    }
    Index known = 0;
    S* segment = workspace.segment.data();
    for (Index j = part.first_col; j < part.last_col; j += Strip::columns) {
      const Index count = (std::min)(Strip::columns, part.last_col - j);
      Strip strip(kernel_, units_, least_);
      for (Index i = part.first_row; i < part.last_row; ++i) {
        const bool whole = strip.row(cell(workspace, i, j), count, segment);
        known += whole ? count : count_known(segment, count);
        store_segment(segment, count, to, i, j);
      }
    }
    const Index all = (part.last_row - part.first_row) * (part.last_col - part.first_col);
    return {FrameStatus::ok, known, all - known};
  }

 private:
  using Kernel = detail::CurvatureKernel<Statistic, S>;
  using Units = detail::DepthUnits<CameraType, S>;
  using Strip = detail::CurvatureStrip<Kernel, Units, S>;
  static constexpr Index line = 64 / static_cast<Index>(sizeof(float));

  static double checked(double too_deep_mm) {
    expects(too_deep_mm > 0, "CurvatureMap", "too_deep_mm", too_deep_mm, "> 0");
    return too_deep_mm;
  }
  static Index checked(const CurvatureRing& ring, Index rows, Index cols) {
    expects_valid(ring);
    expects_grid_size("CurvatureMap", rows, cols);
    return rows;
  }

  /// Row stride: the left margin fills whole cache lines, and the total number of lines is odd, so
  /// that rows spread over all sets of a cache instead of a few.
  static Index stride_of(Index margin, Index cols) {
    const Index lines = (left_of(margin) + cols + margin) / line + 2;
    return (lines + 1 - lines % 2) * line;
  }
  static Index left_of(Index margin) { return (margin + line - 1) / line * line; }

  std::size_t size() const {
    return static_cast<std::size_t>((rows_ + 2 * margin_) * stride_ + 2 * line);
  }
  bool fits(const Workspace& w) const {
    return w.cells.size() == size() && w.stride == stride_ &&
           w.segment.size() == static_cast<std::size_t>(Strip::columns);
  }

  S* cell(Workspace& workspace, Index row, Index col) const {
    return workspace.cells.data() + (row + margin_) * stride_ + left_of(margin_) + col;
  }

  template <class View>
  void load_row(const View& from, Index i, const detail::PixelBox& part, S* row) const {
    const S* cells = row;
    if constexpr (detail::plain_rows<View, S>) {
      cells = from.col_stride() == 1 ? from.row(i) : row;
    }
    for (Index j = part.first_col; cells == row && j < part.last_col; ++j) {
      row[j] = static_cast<S>(from(i, j));
    }
    detail::for_each_cell<S>(part.last_col - part.first_col, [&]<class V>(Index k) {
      const Index j = part.first_col + k;
      const V depth_mm = detail::load_cells<V, S>(cells + j);
      detail::store_cells<S>(row + j, units_.template flattened<V>(depth_mm));
    });
  }

  static Index count_known(const S* segment, Index count) {
    return std::count_if(segment, segment + count, [](const S& k) { return value(k) == value(k); });
  }

  template <class View>
  static void store_segment(const S* segment, Index count, const View& to, Index i, Index first) {
    if constexpr (detail::plain_rows<View, S>) {
      if (to.col_stride() == 1) {
        std::copy_n(segment, count, to.row(i) + first);
        return;
      }
    }
    for (Index j = 0; j < count; ++j) {
      to(i, first + j) = static_cast<cell_t<View>>(segment[j]);
    }
  }

  Units units_;
  Index rows_;
  Index cols_;
  Index margin_;  // the ring's radius, at most the image's size: larger rings are never complete
  Index stride_;
  int least_;
  Kernel kernel_;
};

}  // namespace v0
}  // namespace fingerpad
