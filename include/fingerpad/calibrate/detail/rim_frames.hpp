// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames of the free pad, averaged by pressure. See calibrate/rim.hpp.
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/rim.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Border points, their tangents and their shares of the rim, by column of the border.
template <scalar S>
class CalibratedRim {
 public:
  template <spatial_dot_grid Border>
  CalibratedRim(const Border& border_mm, const S& radius_mm) : radius_mm_(radius_mm) {
    expects(is_finite(radius_mm) && value(radius_mm) > 0, "RimCalibration", "base_radius_mm",
            radius_mm, "finite and > 0");
    const Rim<S> rim(
        border_mm, [](Index) { return S(1); }, radius_mm, 8);
    columns_.resize(static_cast<std::size_t>(rim.size()));
    S total = S(0);
    for (Index k = 0; k < rim.size(); ++k) {
      columns_[static_cast<std::size_t>(rim.column(k))] = {rim.border(k), rim.tangent(k),
                                                           rim.share_mm(k)};
      total = total + rim.share_mm(k);
    }
    for (Column& column : columns_) {
      column.weight = column.weight / total;
    }
  }

  struct Column {
    Point3<S> border;
    Point3<S> tangent;
    S weight;  ///< share of the rim
  };
  Index size() const { return static_cast<Index>(columns_.size()); }
  const S& radius_mm() const { return radius_mm_; }
  const Column& operator[](std::size_t column) const { return columns_[column]; }

 private:
  S radius_mm_;
  std::vector<Column> columns_;
};

/// Averages over the frames of one pressure level: pressure, apex height and side dots.
template <scalar S>
struct RimLevel {
  RimLevel(Index rows, Index columns)
      : dot_mm(static_cast<std::size_t>(rows * columns), Point3<S>{S(0), S(0), S(0)}),
        count(static_cast<std::size_t>(columns), 0) {}

  /// Adds a frame. A column counts only if all its `Row::rows` dots are found.
  template <class Row, class Dots>
  void add(const Dots& dots, const S& pressure, const S& apex) {
    ++frames;
    if (is_plausible(apex)) {
      ++apex_frames;
      apex_mm = apex_mm + (apex - apex_mm) / S(apex_frames);
    }
    pressure_mpa = pressure_mpa + (pressure - pressure_mpa) / S(frames);
    for (std::size_t j = 0; j < count.size(); ++j) {
      Point3<S> dot[Row::rows];
      bool found = true;
      for (Index r = 0; r < Row::rows; ++r) {
        dot[r] = spatial_dot<S>(dots(r, static_cast<Index>(j)));
        found = found && is_finite(dot[r]);
      }
      count[j] += found ? 1 : 0;
      for (std::size_t r = 0; found && r < static_cast<std::size_t>(Row::rows); ++r) {
        Point3<S>& mean = dot_mm[j * static_cast<std::size_t>(Row::rows) + r];
        mean = mean + S(S(1) / S(count[j])) * (dot[r] - mean);
      }
    }
  }

  bool sees(std::size_t column) const { return count[column] > 0; }

  S pressure_mpa = S(0);
  S apex_mm = S(0);
  int frames = 0;
  int apex_frames = 0;            ///< frames with an apex height
  std::vector<Point3<S>> dot_mm;  ///< mean positions; the dots of a column are adjacent
  std::vector<int> count;         ///< frames with the column's dots
};

template <class Rim, class Levels>
Index seen_in_all(const Rim& rim, const Levels& levels) {
  Index seen = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(rim.size()); ++j) {
    bool all = true;
    for (const auto& level : levels) {
      all = all && level.sees(j);
    }
    seen += all ? 1 : 0;
  }
  return seen;
}
template <class Rim, class Levels>
Index seen_in_any(const Rim& rim, const Levels& levels) {
  Index seen = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(rim.size()); ++j) {
    bool any = false;
    for (const auto& level : levels) {
      any = any || level.sees(j);
    }
    seen += any ? 1 : 0;
  }
  return seen;
}

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
