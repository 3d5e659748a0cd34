// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over a disc of the change of the membrane's inclination since a reference:
//   psi_sum(x, y) = sum over the disc of [psi(t) - psi(t0)],  psi = atan|grad depth|, rad
// from a summed-area table, see disc_sums.hpp.
//
// Gradients are central differences, one-sided where one neighbour is missing; psi is missing where
// both are, along either axis. A pixel that is missing in the frame but not in the reference is
// membrane that was not seen: it counts with the mean change of the disc's other pixels. A pixel
// that is missing in the reference is not membrane and adds nothing.
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/disc_sums.hpp"
#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The quantities that the reference fixes, and the passes over one frame.
template <class Disc, scalar S>
class InclinationSums {
  using Total = InclinationTotal<S>;
  using T = typename Total::type;

 public:
  /// Bytes of a vector; 0 unless inclination() has a vector form for S.
  static constexpr int bytes = std::same_as<S, float> ? native_vector_bytes : 0;
  /// Columns [first, last).
  struct Span {
    Index first, last;
  };

  /// Memory of one frame at a time.
  struct Workspace {
    Workspace(Index rows, Index cols, Index radius_px, const DiscShape& shape)
        : change(rows, cols),
          missing(rows, cols),
          change_row(cols, radius_px, shape),
          missing_row(cols, radius_px, shape),
          lost(static_cast<std::size_t>(rows * cols), 0),
          psi(static_cast<std::size_t>(cols), T(0)),
          present(static_cast<std::size_t>(cols), 0),
          sum(static_cast<std::size_t>(cols), S(0)),
          row_mm(static_cast<std::size_t>(cols), S(0)) {
      for (Line& line : lines) {
        line.assign(static_cast<std::size_t>(cols + 2), not_a_number<S>());
      }
    }
    using Line = std::vector<S>;  ///< depths, NaN where missing, and one column beyond each side
    SummedArea<T> change;
    SummedArea<std::uint32_t> missing;
    DiscRow<T> change_row;
    DiscRow<std::uint32_t> missing_row;
    std::vector<std::uint8_t> lost;  ///< 1 where the reference has psi and the frame has not
    std::vector<T> psi;
    std::vector<std::uint8_t> present;
    std::vector<S> sum;     ///< the row that sum_row computed, rad
    std::vector<S> row_mm;  ///< a row of depths
    Line lines[3];
    Index lost_px = 0;
  };

  template <class View>
  InclinationSums(Index radius_px, const S& pitch_mm, const View& reference)
      : rows_(reference.rows()),
        cols_(reference.cols()),
        radius_(radius_px),
        shape_(Disc::shape(radius_px)),
        unit_(Total::unit(static_cast<double>((2 * radius_px + 1) * (2 * radius_px + 1)))),
        per_mm_(S(1) / pitch_mm),
        span_(static_cast<std::size_t>(rows_), Span{0, cols_}),
        psi_(size(), T(0)),
        present_(size(), 0),
        count_(size(), S(0)) {
    Workspace s = workspace();
    each_row(reference, s, [&](Index i) {
      std::copy_n(s.psi.data(), cols_, psi_.data() + i * cols_);
      std::copy_n(s.present.data(), cols_, present_.data() + i * cols_);
      s.missing.set_row(i, s.present.data());
      Span& span = span_[static_cast<std::size_t>(i)];
      const auto is_in_pad = [&](Index j) { return is_finite(S(reference(i, j))); };
      while (span.first < span.last && !is_in_pad(span.first)) {
        ++span.first;
      }
      while (span.first < span.last && !is_in_pad(span.last - 1)) {
        --span.last;
      }
    });
    for (Index i = 0; i < rows_; ++i) {
      const Span span = this->span(i);
      s.missing_row.sum(s.missing, shape_, i, span.first, span.last);
      for (Index j = span.first; j < span.last; ++j) {
        count_[at(i, j)] = count(s.missing_row, j);
      }
    }
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  /// The columns that the reference's pad spans in a row; outside them there is nothing to sum.
  Span span(Index row) const { return span_[static_cast<std::size_t>(row)]; }
  Workspace workspace() const { return Workspace(rows_, cols_, radius_, shape_); }

  /// Whether this workspace was made for this reference and radius.
  bool fits(const Workspace& s) const {
    return s.lost.size() == size() && s.change_row.fits(cols_, radius_);
  }

  /// Reads the frame into the workspace tables; s.lost_px says how many pixels were not seen.
  template <class View>
  void scan(const View& depth, Workspace& s) const {
    s.lost_px = 0;
    each_row(depth, s, [&](Index i) {
      s.lost_px += compare(i, s);
      s.change.set_row(i, s.psi.data());
    });
    for (Index i = 0; s.lost_px > 0 && i < rows_; ++i) {
      s.missing.set_row(i, s.lost.data() + i * cols_);
    }
  }

  /// s.sum = psi_sum of one row, rad, of the frame scanned last; 0 beyond the pad.
  void sum_row(Index row, Workspace& s) const {
    const Span span = this->span(row);
    const S stairs = S(shape_.staircase_weight) / unit_;
    const S square = S(shape_.square_weight) / unit_;
    s.change_row.sum(s.change, shape_, row, span.first, span.last);
    const T* in_stairs = s.change_row.stairs() + span.first;
    const T* in_square = s.change_row.square() + span.first;
    S* sum = s.sum.data() + span.first;
    for_each_cell<T, bytes>(span.last - span.first, [=]<class V>(Index j) {
      const auto all = Total::to(load_cells<V, T>(in_stairs + j));
      const auto of_square = Total::to(load_cells<V, T>(in_square + j));
      const std::remove_const_t<decltype(all)> both = stairs * all + square * of_square;
      store_cells<S>(sum + j, both);
    });
    clear_beyond(span, s.sum.data());
    if (s.lost_px == 0) {
      return;
    }
    s.missing_row.sum(s.missing, shape_, row, span.first, span.last);
    for (Index j = span.first; j < span.last; ++j) {
      const S& all = count_[at(row, j)];
      const S seen = all - count(s.missing_row, j);
      if (value(seen) > 0) {
        s.sum[static_cast<std::size_t>(j)] = S(s.sum[static_cast<std::size_t>(j)] * S(all / seen));
      }
    }
  }

 private:
  using Line = typename Workspace::Line;

  std::size_t size() const { return static_cast<std::size_t>(rows_ * cols_); }
  std::size_t at(Index i, Index j) const { return static_cast<std::size_t>(i * cols_ + j); }

  S count(const DiscRow<std::uint32_t>& row, Index j) const {
    const S stairs = S(shape_.staircase_weight) * S(static_cast<int>(row.stairs()[j]));
    return S(stairs + S(shape_.square_weight) * S(static_cast<int>(row.square()[j])));
  }

  template <class Cell>
  void clear_beyond(const Span& span, Cell* row) const {
    std::fill(row, row + span.first, Cell(0));
    std::fill(row + span.last, row + cols_, Cell(0));
  }

  /// Calls visit(i) for each row, with s.psi and s.present computed in its span.
  template <class View, class Visit>
  void each_row(const View& depth, Workspace& s, const Visit& visit) const {
    clear(s.lines[2]);
    load(depth, 0, s.lines[0]);
    for (Index i = 0; i < rows_; ++i) {
      load(depth, i + 1, s.lines[(i + 1) % 3]);
      find_psi(span(i), s.lines[(i + 2) % 3], s.lines[i % 3], s.lines[(i + 1) % 3], s);
      visit(i);
    }
  }

  static void clear(Line& line) { std::fill(line.begin(), line.end(), not_a_number<S>()); }

  template <class View>
  void load(const View& depth, Index row, Line& to) const {
    if (row >= rows_) {
      clear(to);
      return;
    }
    S* l = to.data() + 1;
    const S* from = row_of<S>(depth, row, l);
    for_each_cell<S>(cols_, [=]<class V>(Index j) {
      const V depth_mm = load_cells<V, S>(from + j);
      const V nothing = depth_mm - depth_mm;  // 0, or NaN if the depth is NaN or infinite
      store_cells<S>(l + j, V(depth_mm - nothing));
    });
  }

  /// Computes s.psi and s.present of a row from it and the rows above and below.
  void find_psi(
      const Span& span, const Line& up, const Line& here, const Line& down, Workspace& s) const {
    const Index first = span.first;
    const S* l = here.data() + 1 + first;
    const S* l_up = up.data() + 1 + first;
    const S* l_down = down.data() + 1 + first;
    T* psi = s.psi.data() + first;
    std::uint8_t* present = s.present.data() + first;
    const S per_mm = per_mm_, half_per_mm = per_mm_ / S(2), unit = unit_;
    for_each_cell<S, bytes>(
        span.last - first, [=]<class V>(Index j) __attribute__((always_inline)) {
          const auto at = [j](const S* row) { return load_cells<V, S>(row + j); };
          const V none = every_lane<V>(S(0));
          const V center = at(l);
          const V right = at(l + 1) - center, left = center - at(l - 1);
          const V below = at(l_down) - center, above = center - at(l_up);
          const auto has_right = known<V>(right), has_left = known<V>(left);
          const auto has_below = known<V>(below), has_above = known<V>(above);
          const auto slope = [&](const auto& has_a, const V& a, const auto& has_b, const V& b) {
            const V rise = V(has_a ? a : none) + V(has_b ? b : none);
            const auto both = has_a & has_b;
            const V per_step = both ? every_lane<V>(half_per_mm) : every_lane<V>(per_mm);
            return V(rise * per_step);
          };
          const V sx = slope(has_right, right, has_left, left);
          const V sy = slope(has_below, below, has_above, above);
          store_cells<T>(psi + j, Total::from(V(inclination(V(sx * sx + sy * sy)) * unit)));
          const auto is_here = (has_right | has_left) & (has_below | has_above);
          store_cells<S>(present + j, is_here ? every_lane<V>(S(1)) : none);
        });
  }

  /// Sets s.psi to the change of psi, 0 where either is missing, and marks the row's lost pixels in
  /// s.lost. Returns their number.
  Index compare(Index row, Workspace& s) const {
    const Span span = this->span(row);
    const Index count = span.last - span.first, begin = row * cols_ + span.first;
    const T* psi0 = psi_.data() + begin;
    const std::uint8_t* present0 = present_.data() + begin;
    T* psi = s.psi.data() + span.first;
    std::uint8_t* present = s.present.data() + span.first;
    std::uint8_t* lost = s.lost.data() + begin;
    Index lost_px = 0;
    for_each_cell<std::uint8_t>(count, [=, &lost_px]<class V>(Index j) {
      const V here = load_cells<V, std::uint8_t>(present + j);
      const V there = load_cells<V, std::uint8_t>(present0 + j);
      const V gone = there & ~here;
      store_cells<std::uint8_t>(present + j, V(here & there));  // from here on: present in both
      store_cells<std::uint8_t>(lost + j, gone);
      if (any_lane(gone != every_lane<V>(std::uint8_t(0)))) {
        lost_px += std::count(lost + j, lost + j + lanes_in<V, std::uint8_t>, 1);
      }
    });
    for_each_cell<T, bytes>(count, [=]<class V>(Index j) {
      const V change = load_cells<V, T>(psi + j) - load_cells<V, T>(psi0 + j);
      const V none = every_lane<V>(T(0));
      store_cells<T>(psi + j, none < load_cells<V, T>(present + j) ? change : none);
    });
    clear_beyond(span, s.psi.data());
    return lost_px;
  }

  Index rows_, cols_, radius_;
  DiscShape shape_;
  S unit_, per_mm_;
  std::vector<Span> span_;             // per row, the columns that the reference's pad spans
  std::vector<T> psi_;                 // of the reference
  std::vector<std::uint8_t> present_;  // where it is known
  std::vector<S> count_;               // weighted number of such pixels in each disc
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
