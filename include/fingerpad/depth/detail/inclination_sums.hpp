// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over a disc of how much the membrane's inclination changed since a reference:
//   psi_sum(x, y) = sum over the disc of [psi(t) - psi(t0)],  psi = atan|grad depth|, rad
// from a summed-area table, see disc_sums.hpp.
//
// Gradients are central differences, one-sided where one neighbour is missing; psi is missing where
// both are, along either axis. Missing pixels of the frame that the reference has stand for
// membrane that was not seen: they are taken to have changed as the mean of the disc's others.
// Pixels that the reference does not have are no membrane and add nothing.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/disc_sums.hpp"
#include "fingerpad/image/detail/quick_math.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The engine: what the reference fixes, and the passes over one frame.
template <class Disc, scalar S>
class InclinationSums {
  using Total = InclinationTotal<S>;
  using T = typename Total::type;

 public:
  /// Memory of one frame at a time.
  struct Workspace {
    Workspace(Index rows, Index cols, Index radius_px)
        : change(rows, cols),
          missing(rows, cols),
          change_row(cols, radius_px),
          missing_row(cols, radius_px),
          lost(static_cast<std::size_t>(rows * cols), 0),
          psi(static_cast<std::size_t>(cols), T(0)),
          present(static_cast<std::size_t>(cols), 0),
          sum(static_cast<std::size_t>(cols), S(0)),
          row_mm(static_cast<std::size_t>(cols), S(0)) {
      for (Line& line : lines) {
        line = {std::vector<S>(static_cast<std::size_t>(cols + 2), S(0)),
                std::vector<S>(static_cast<std::size_t>(cols + 2), S(0))};
      }
    }
    struct Line {
      std::vector<S> depth, weight;  ///< 0, 0 where missing, and one column beyond each side
    };
    SummedArea<T> change;
    SummedArea<std::uint32_t> missing;
    DiscRow<T> change_row;
    DiscRow<std::uint32_t> missing_row;
    std::vector<std::uint8_t> lost;  ///< 1 where the reference has psi and the frame has not
    std::vector<T> psi;
    std::vector<std::uint8_t> present;
    std::vector<S> sum;     ///< the row that sum_row made, rad
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
        psi_(size(), T(0)),
        present_(size(), 0),
        count_(size(), S(0)) {
    Workspace s = workspace();
    each_row(reference, s, [&](Index i) {
      for (Index j = 0; j < cols_; ++j) {
        psi_[at(i, j)] = s.psi[static_cast<std::size_t>(j)];
        present_[at(i, j)] = s.present[static_cast<std::size_t>(j)];
      }
      s.missing.set_row(i, s.present.data());
    });
    for (Index i = 0; i < rows_; ++i) {
      s.missing_row.sum(s.missing, shape_, radius_, i);
      for (Index j = 0; j < cols_; ++j) {
        count_[at(i, j)] = count(s.missing_row, j);
      }
    }
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  Workspace workspace() const { return Workspace(rows_, cols_, radius_); }

  /// Whether this workspace was made for this reference and radius.
  bool fits(const Workspace& s) const {
    return s.lost.size() == size() && s.sum.size() == static_cast<std::size_t>(cols_) &&
           s.change_row.band.size() == static_cast<std::size_t>(cols_ + 1 + 2 * radius_);
  }

  /// Reads the frame into the workspace tables; s.lost_px says how many pixels were not seen.
  template <class View>
  void scan(const View& depth, Workspace& s) const {
    s.lost_px = 0;
    each_row(depth, s, [&](Index i) {
      const Index first = i * cols_;
      s.lost_px += compare(cols_, psi_.data() + first, present_.data() + first, s.present.data(),
                           s.psi.data(), s.lost.data() + first);
      s.change.set_row(i, s.psi.data());
    });
    for (Index i = 0; s.lost_px > 0 && i < rows_; ++i) {
      s.missing.set_row(i, s.lost.data() + i * cols_);
    }
  }

  /// s.sum = psi_sum of one row, rad, of the frame scanned last.
  void sum_row(Index row, Workspace& s) const {
    s.change_row.sum(s.change, shape_, radius_, row);
    const S stairs = S(shape_.staircase_weight) / unit_;
    const S square = S(shape_.square_weight) / unit_;
    for (std::size_t j = 0; j < s.sum.size(); ++j) {
      const S all = stairs * Total::to(s.change_row.stairs[j]);
      s.sum[j] = S(all + square * Total::to(s.change_row.square[j]));
    }
    if (s.lost_px == 0) {
      return;
    }
    s.missing_row.sum(s.missing, shape_, radius_, row);
    for (Index j = 0; j < cols_; ++j) {
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
    const auto k = static_cast<std::size_t>(j);
    const S stairs = S(shape_.staircase_weight) * S(static_cast<int>(row.stairs[k]));
    return S(stairs + S(shape_.square_weight) * S(static_cast<int>(row.square[k])));
  }

  /// Calls visit(i) for each row, with s.psi and s.present of that row.
  template <class View, class Visit>
  void each_row(const View& depth, Workspace& s, const Visit& visit) const {
    clear(s.lines[2]);
    load(depth, 0, s.lines[0]);
    for (Index i = 0; i < rows_; ++i) {
      load(depth, i + 1, s.lines[(i + 1) % 3]);
      find_psi(s.lines[(i + 2) % 3], s.lines[i % 3], s.lines[(i + 1) % 3], s);
      visit(i);
    }
  }

  /// psi becomes the change of psi, 0 where either is missing. Returns how many pixels are lost.
  static Index compare(Index cols,
                       const T* psi0,
                       const std::uint8_t* present0,
                       const std::uint8_t* present,
                       T* __restrict psi,
                       std::uint8_t* __restrict lost) {
    std::uint32_t count = 0;
    for (Index j = 0; j < cols; ++j) {
      const T change = T(psi[j] - psi0[j]);
      psi[j] = (present[j] & present0[j]) != 0 ? change : T(0);
      lost[j] = static_cast<std::uint8_t>(present0[j] & (present[j] ^ 1));
      count += lost[j];
    }
    return static_cast<Index>(count);
  }

  static void clear(Line& line) {
    for (std::size_t j = 0; j < line.depth.size(); ++j) {
      line.depth[j] = line.weight[j] = S(0);
    }
  }

  template <class View>
  void load(const View& depth, Index row, Line& to) const {
    if (row >= rows_) {
      clear(to);
      return;
    }
    S* l = to.depth.data() + 1;
    for (Index j = 0; j < cols_; ++j) {
      l[j] = S(depth(row, j));
    }
    weigh(cols_, l, to.weight.data() + 1);
  }
  static void weigh(Index cols, S* __restrict l, S* __restrict weight) {
    for (Index j = 0; j < cols; ++j) {
      const bool good = is_finite(l[j]);
      l[j] = good ? l[j] : S(0);
      weight[j] = good ? S(1) : S(0);
    }
  }

  void find_psi(const Line& up, const Line& here, const Line& down, Workspace& s) const {
    find_psi(cols_, per_mm_, unit_, here.depth.data() + 1, here.weight.data() + 1,
             up.depth.data() + 1, up.weight.data() + 1, down.depth.data() + 1,
             down.weight.data() + 1, s.psi.data(), s.present.data());
  }
  static void find_psi(Index cols,
                       const S per_mm,
                       const S unit,
                       const S* l,
                       const S* w,
                       const S* l_up,
                       const S* w_up,
                       const S* l_down,
                       const S* w_down,
                       T* __restrict psi,
                       std::uint8_t* __restrict present) {
    const S half_per_mm = per_mm / S(2);
    for (Index j = 0; j < cols; ++j) {
      const S gx = S(w[j + 1] * S(l[j + 1] - l[j])) + S(w[j - 1] * S(l[j] - l[j - 1]));
      const S gy = S(w_down[j] * S(l_down[j] - l[j])) + S(w_up[j] * S(l[j] - l_up[j]));
      const S nx = w[j + 1] + w[j - 1];
      const S ny = w_down[j] + w_up[j];
      const S sx = gx * (nx > S(1) ? half_per_mm : per_mm);
      const S sy = gy * (ny > S(1) ? half_per_mm : per_mm);
      psi[j] = Total::from(S(inclination(S(sx * sx + sy * sy)) * unit));
      present[j] = static_cast<std::uint8_t>(S(w[j] * S(nx * ny)) > S(0));
    }
  }

  Index rows_, cols_, radius_;
  DiscShape shape_;
  S unit_, per_mm_;
  std::vector<T> psi_;                 // of the reference
  std::vector<std::uint8_t> present_;  // where it is known
  std::vector<S> count_;               // how many such pixels each disc holds
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
