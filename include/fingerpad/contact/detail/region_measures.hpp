// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Area, center and depth of a region of the image, in mm. Each pixel is weighted with the area that
// it sees, projected on the plate.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/regions.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A sum of numbers that are added one at a time or a vector at a time.
class LaneSum {
 public:
  template <class V>
  [[gnu::always_inline]] void add(const V& v) {
    store_cells<double>(lane_, V(load_cells<V, double>(lane_) + v));
  }
  double total() const { return std::accumulate(std::begin(lane_), std::end(lane_), 0.0); }

 private:
  double lane_[static_cast<std::size_t>(row_lanes<double>)] = {};
};

/// Sums over the pixels of a region, in double because there may be a million of them. The area of
/// a pixel on the plate follows from the differences between its neighbours. An unknown neighbour
/// counts as being as deep as the pixel. If the surface would be seen from behind, which no camera
/// can do, all neighbours count as being as deep. The area is linear in the differences along each
/// axis, so that noise does not add up.
template <class Depth, class Rays>
class RegionMeasures {
 public:
  RegionMeasures(const StridedView<Mark>& marks, const Depth& depth_mm, const Rays& rays)
      : marks_(marks), depth_mm_(depth_mm), rays_(rays) {
    for (int k = 0; k < row_lanes<double>; ++k) {
      ramp_[k] = k;
    }
    for (Index i = 0; i < marks.rows(); ++i) {
      const Mark* row = marks.row(i);
      const Mark* end = row + marks.cols();
      for (const Mark* at = find_mark(row, end, Mark::contact); at != end;
           at = find_mark(at, end, Mark::contact)) {
        const Mark* first = at;
        at = std::find_if(at, end, [](Mark mark) { return mark != Mark::contact; });
        add_run(i, first - row, at - row);
      }
    }
  }

  Index pixels() const { return pixels_; }
  double area_mm2() const { return area_.total(); }
  /// NaN where there is no area.
  Point3<double> center_mm() const {
    return {x_.total() / area_mm2(), y_.total() / area_mm2(), z_.total() / area_mm2()};
  }

 private:
  /// Adjacent pixels of a row, and the distances of the neighbours from which their area is
  /// computed: 0 at the image's edge, else 1.
  struct Run {
    Index row;
    Index left, right, up, down;
    double per_span = 1.0 / static_cast<double>((left + right) * (up + down));
  };

  void add_run(Index row, Index first, Index last) {
    pixels_ += last - first;
    const Index up = row > 0 ? 1 : 0;
    const Index down = row + 1 < marks_.rows() ? 1 : 0;
    const Index inner_first = (std::max)(first, Index(1));
    const Index inner_last = (std::min)(last, marks_.cols() - 1);
    if (first < inner_first) {
      add<double>({row, 0, 1, up, down}, first);
    }
    for_each_cell<double>(inner_last - inner_first, [&]<class V>(Index k) {
      add<V>({row, 1, 1, up, down}, inner_first + k);
    });
    if (inner_last < last) {
      add<double>({row, 1, 0, up, down}, inner_last);
    }
  }

  template <class V>
  [[gnu::always_inline]] void add(const Run& run, Index j) {
    const Index i = run.row;
    const V depth = depth_at<V>(i, j);
    const auto scale = [&](Index row, Index col) __attribute__((always_inline)) {
      const V mark = load_cells<V, double>(bytes_of(marks_.row(row) + col));
      const auto unknown = mark == V{} + static_cast<double>(Mark::unknown);
      return rays_.template mm_per_px<V>(row, col, V(unknown ? depth : depth_at<V>(row, col)));
    };
    const V x = load_cells<V, double>(ramp_) + rays_.x_px(j);
    const double y = rays_.y_px(i);
    const V left = scale(i, j - run.left);
    const V right = scale(i, j + run.right);
    const V up = scale(i - run.up, j);
    const V down = scale(i + run.down, j);
    const double to_left = static_cast<double>(run.left);
    const double to_right = static_cast<double>(run.right);
    const double to_up = static_cast<double>(run.up) * rays_.aspect();
    const double to_down = static_cast<double>(run.down) * rays_.aspect();
    const V across_x = (x + to_right) * right - (x - to_left) * left;
    const V across_y = y * (right - left);
    const V down_x = x * (down - up);
    const V down_y = (y + to_down) * down - (y - to_up) * up;
    const V seen = (across_x * down_y - across_y * down_x) * run.per_span;
    const V mm_per_px = rays_.template mm_per_px<V>(i, j, depth);
    const V area = seen > V{} ? seen : V(mm_per_px * mm_per_px * rays_.aspect());
    const V moment = area * mm_per_px;
    area_.add(area);
    x_.add(V(x * moment));
    y_.add(V(y * moment));
    z_.add(V(depth * area));
  }

  /// The depth in double, with the same bits for every kind of grid.
  template <class V>
  [[gnu::always_inline]] V depth_at(Index row, Index col) const {
    if constexpr (plain_rows<Depth, float> || plain_rows<Depth, double>) {
      if (depth_mm_.col_stride() == 1) {
        return load_cells<V, double>(depth_mm_.row(row) + col);
      }
    }
    constexpr auto count = static_cast<Index>(sizeof(V) / sizeof(double));
    double cells[static_cast<std::size_t>(count)];
    for (Index k = 0; k < count; ++k) {
      cells[k] = static_cast<double>(depth_mm_(row, col + k));
    }
    return load_cells<V, double>(cells);
  }

  const StridedView<Mark>& marks_;
  const Depth& depth_mm_;
  const Rays& rays_;
  double ramp_[static_cast<std::size_t>(row_lanes<double>)];
  Index pixels_ = 0;
  LaneSum area_;
  LaneSum x_, y_, z_;  ///< moments, mm^3
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
