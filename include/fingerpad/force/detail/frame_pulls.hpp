// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The geometry of a frame: where the dots are, which belong to the contact, and what the cells pull
// them with for mu t = 1 N/mm. Pressure and modulus come later, in frame_loads.hpp.
#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/detail/point_algebra.hpp"
#include "fingerpad/force/detail/bridging.hpp"
#include "fingerpad/force/dot_cell.hpp"
#include "fingerpad/force/traction_maps.hpp"
#include "fingerpad/force/traction_result.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::traction {

/// NaN where a coordinate is not finite, or the dot further than 10^6 mm away: powers of such would
/// overflow.
template <scalar S, class P>
Point3<S> dot_of(const P& p) {
  using Traits = point_traits<P>;
  const Point3<S> dot = {S(Traits::x(p)), S(Traits::y(p)), S(Traits::z(p))};
  const bool placed = is_finite_point(dot) && length_sq(dot) < S(1e12);
  return placed ? dot : missing_point<S>();
}

/// A point of the caller's type.
template <class P, scalar S>
P point_as(const Point3<S>& p) {
  P out = P();
  if constexpr (requires { out.x = out.y = out.z; }) {
    using C = std::remove_cvref_t<decltype(out.x)>;
    out.x = static_cast<C>(p.x);
    out.y = static_cast<C>(p.y);
    out.z = static_cast<C>(p.z);
  } else {
    using C = std::remove_cvref_t<decltype(out[0])>;
    out[0] = static_cast<C>(p.x);
    out[1] = static_cast<C>(p.y);
    out[2] = static_cast<C>(p.z);
  }
  return out;
}

template <scalar S, class Dots>
void read_dots(const Dots& dots, FrameMemory<S>& frame) {
  for (Index i = 0; i < frame.rows; ++i) {
    for (Index j = 0; j < frame.cols; ++j) {
      const std::size_t k = frame.dot_at(i, j);
      frame.place[k] = dot_of<S, std::remove_cvref_t<decltype(dots(i, j))>>(dots(i, j));
      frame.flags[k] = 0;
      if (is_finite_point(frame.place[k])) {
        frame.set(k, found);
      }
    }
  }
}

template <scalar S>
void bridge_dots(FrameMemory<S>& frame, TractionResult<S>& result) {
  const auto is_found = [&](Index i, Index j) {
    return frame.inside(i, j) && frame.has(frame.dot_at(i, j), found);
  };
  const auto at = [&](Index i, Index j) { return frame.place[frame.dot_at(i, j)]; };
  for (Index i = 0; i < frame.rows; ++i) {
    for (Index j = 0; j < frame.cols; ++j) {
      const std::size_t k = frame.dot_at(i, j);
      if (frame.has(k, found)) {
        continue;
      }
      frame.place[k] = bridged_dot<S>(i, j, is_found, at);
      if (is_finite_point(frame.place[k])) {
        frame.set(k, bridged);
        ++result.dots_bridged;
      }
    }
  }
}

/// Steps from each dot to the nearest in contact, where a step leads to any of the eight
/// neighbours: what the four before it know, in the order of rows, and then the four after it.
template <scalar S, class Touch>
void count_steps(const Touch& touch, FrameMemory<S>& frame, TractionResult<S>& result) {
  const auto look = [&](Index i, Index j, Index way) {
    const std::size_t k = frame.dot_at(i, j);
    constexpr Index before[4][2] = {{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}};
    for (const auto& [di, dj] : before) {
      const Index r = i + way * di, c = j + way * dj;
      if (frame.inside(r, c) && frame.steps[frame.dot_at(r, c)] + 1 < frame.steps[k]) {
        frame.steps[k] = static_cast<std::uint8_t>(frame.steps[frame.dot_at(r, c)] + 1);
      }
    }
  };
  for (Index i = 0; i < frame.rows; ++i) {
    for (Index j = 0; j < frame.cols; ++j) {
      const bool touches = is_contact(std::remove_cvref_t<decltype(touch(i, j))>(touch(i, j)));
      frame.steps[frame.dot_at(i, j)] = touches ? 0 : far_away;
      result.dots_in_contact += touches ? 1 : 0;
      look(i, j, 1);
    }
  }
  for (Index i = frame.rows; i-- > 0;) {
    for (Index j = frame.cols; j-- > 0;) {
      look(i, j, -1);
    }
  }
}

/// One cell's share of what pulls its corners.
template <scalar S>
void pull_cell(const StressFreeCell<S>& free,
               Index i,
               Index j,
               const StretchLimits<S>& limits,
               const S& outward,
               FrameMemory<S>& frame,
               TractionResult<S>& result) {
  const std::size_t cell = frame.cell_at(i, j);
  frame.cell[cell] = CellState::unknown;
  frame.tension[cell] = {};
  const std::array<std::size_t, 4> k = {frame.dot_at(i, j), frame.dot_at(i, j + 1),
                                        frame.dot_at(i + 1, j + 1), frame.dot_at(i + 1, j)};
  bool all_there = free.usable, all_found = true;
  for (const std::size_t dot : k) {
    all_there = all_there && (frame.has(dot, found) || frame.has(dot, bridged));
    all_found = all_found && frame.has(dot, found);
  }
  if (!all_there) {
    return;
  }
  const Corners<S> x = {frame.place[k[0]], frame.place[k[1]], frame.place[k[2]], frame.place[k[3]]};
  const CellPull<S> pull = cell_pull(free, x, limits);
  if (!pull.sound) {
    ++result.cells_refused;
    return;
  }
  frame.cell[cell] = all_found ? CellState::found : CellState::bridged;
  frame.cell_area[cell] = scaled(outward, pull.whole_area);
  for (std::size_t c = 0; c < 4; ++c) {
    frame.pull[k[c]] = sum(frame.pull[k[c]], pull.force[c]);
    frame.area[k[c]] = moved(frame.area[k[c]], outward, pull.area[c]);
  }
  if (all_found) {
    frame.tension[cell] = cell_tension(free, x);
  }
}

template <scalar S>
void pull_cells(const std::vector<StressFreeCell<S>>& cells,
                const StretchLimits<S>& limits,
                const S& outward,
                FrameMemory<S>& frame,
                TractionResult<S>& result) {
  for (std::size_t k = 0; k < frame.pull.size(); ++k) {
    frame.pull[k] = frame.area[k] = {S(0), S(0), S(0)};
  }
  for (Index i = 0; i + 1 < frame.rows; ++i) {
    for (Index j = 0; j + 1 < frame.cols; ++j) {
      pull_cell(cells[frame.cell_at(i, j)], i, j, limits, outward, frame, result);
    }
  }
}

/// A dot has a load when the four cells around it are known and all look to the same side: else the
/// membrane would be folded there.
template <scalar S>
void settle_dots(FrameMemory<S>& frame, TractionResult<S>& result) {
  for (Index i = 1; i + 1 < frame.rows; ++i) {
    for (Index j = 1; j + 1 < frame.cols; ++j) {
      const std::size_t k = frame.dot_at(i, j);
      bool whole = true, all_found = true;
      for (Index r = i - 1; r <= i; ++r) {
        for (Index c = j - 1; c <= j; ++c) {
          const std::size_t cell = frame.cell_at(r, c);
          whole = whole && frame.cell[cell] != CellState::unknown &&
                  value(dot(frame.cell_area[cell], frame.area[k])) > 0;
          all_found = all_found && frame.cell[cell] == CellState::found;
        }
      }
      if (whole) {
        frame.set(k, summed);
      }
      if (whole && all_found) {
        frame.set(k, loaded);
        ++result.dots_loaded;
      }
    }
  }
}

}  // namespace detail::traction
}  // namespace v0
}  // namespace fingerpad
