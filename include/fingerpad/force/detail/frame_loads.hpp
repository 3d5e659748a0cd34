// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The loads of a frame, from the pull of the cells on their dots, the pressure and mu t.
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/dot_cell.hpp"
#include "fingerpad/force/detail/traction_memory.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::traction {

// Dots that were not found are bridged: placed by their neighbours. A bridged dot has no load of
// its own. The sum of the loads over a patch, however, depends only on the pull across the border
// of the patch and the pressure on any surface that spans it. For this sum a bridged dot is as good
// as a found one.

/// Expected position of dot (row, col): on the surface of degree two through all eight neighbours
/// or, if some are missing, the mean of opposite pairs; missing if there is no pair.
/// found(row, col) says whether a dot was found, and accepts indices outside of the grid.
/// at(row, col) is its position.
template <scalar S, class Found, class At>
Point3<S> bridged_dot(Index row, Index col, const Found& found, const At& at) {
  constexpr Index step[4][2] = {{0, 1}, {1, 0}, {1, 1}, {1, -1}};
  const Point3<S> none = {S(0), S(0), S(0)};
  std::array<Point3<S>, 2> sums = {none, none};  // of pairs at the sides, and at the corners
  std::array<int, 2> pairs = {0, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    const Index i = step[k][0], j = step[k][1];
    if (found(row + i, col + j) && found(row - i, col - j)) {
      sums[k / 2] = sums[k / 2] + at(row + i, col + j) + at(row - i, col - j);
      ++pairs[k / 2];
    }
  }
  if (pairs[0] == 2 && pairs[1] == 2) {
    return S(0.5) * sums[0] + S(-0.25) * sums[1];
  }
  const std::size_t use = pairs[0] > 0 ? 0 : 1;
  return pairs[use] == 0 ? missing_point<S>() : (S(S(0.5) / S(pairs[use])) * sums[use]);
}

// The geometry of a frame: positions of the dots, distance to the contact, and the pull of the
// cells for mu t = 1 N/mm. Pressure and modulus are used further below.

template <scalar S, class Dots>
void read_dots(const Dots& dots, FrameMemory<S>& frame) {
  for (Index i = 0; i < frame.rows; ++i) {
    for (Index j = 0; j < frame.cols; ++j) {
      const std::size_t k = frame.dot_at(i, j);
      frame.place[k] = spatial_dot<S>(cell_t<Dots>(dots(i, j)));
      frame.flags[k] = 0;
      if (is_finite(frame.place[k])) {
        frame.set(k, found);
      }
    }
  }
}

template <scalar S, class Result>
void bridge_dots(FrameMemory<S>& frame, Result& result) {
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
      if (is_finite(frame.place[k])) {
        frame.set(k, bridged);
        ++result.dots_bridged;
      }
    }
  }
}

/// Steps from each dot to the nearest dot in contact, where a step leads to any of the eight
/// neighbours. Two passes: forward over the four preceding neighbours, then backward over the four
/// following ones.
template <scalar S, class Touch, class Result>
void count_steps(const Touch& touch, FrameMemory<S>& frame, Result& result) {
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

/// Adds the pull and area of one cell to its corners.
template <scalar S, class Result>
void pull_cell(const StressFreeCell<S>& free,
               Index i,
               Index j,
               const StretchLimits<S>& limits,
               const S& outward,
               FrameMemory<S>& frame,
               Result& result) {
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
  ++result.cells_taken;
  frame.cell[cell] = all_found ? CellState::found : CellState::bridged;
  frame.cell_area[cell] = outward * pull.whole_area;
  for (std::size_t c = 0; c < 4; ++c) {
    frame.pull[k[c]] = frame.pull[k[c]] + pull.force[c];
    frame.area[k[c]] = frame.area[k[c]] + outward * pull.area[c];
  }
  if (all_found) {
    frame.tension[cell] = cell_tension(free, x);
  }
}

template <scalar S, class Result>
void pull_cells(const std::vector<StressFreeCell<S>>& cells,
                const StretchLimits<S>& limits,
                const S& outward,
                FrameMemory<S>& frame,
                Result& result) {
  for (std::size_t k = 0; k < frame.pull.size(); ++k) {
    frame.pull[k] = frame.area[k] = {S(0), S(0), S(0)};
  }
  for (Index i = 0; i + 1 < frame.rows; ++i) {
    for (Index j = 0; j + 1 < frame.cols; ++j) {
      pull_cell(cells[frame.cell_at(i, j)], i, j, limits, outward, frame, result);
    }
  }
}

/// Marks the dots with a load: the four cells around are known and face the same side. Otherwise
/// the membrane would be folded there.
template <scalar S, class Result>
void settle_dots(FrameMemory<S>& frame, Result& result) {
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

/// Whether a dot has a load and lies beyond the ring around the contact.
template <scalar S>
bool is_free(const FrameMemory<S>& frame, std::size_t dot, Index ring) {
  return frame.has(dot, loaded) && frame.steps[dot] > ring;
}

/// Both sides of the balance of the free part (ModulusBalance).
template <scalar S>
ModulusBalance<S> balance_of(const S& pressure_mpa, Index ring, const FrameMemory<S>& frame) {
  ModulusBalance<S> balance;
  for (std::size_t k = 0; k < frame.flags.size(); ++k) {
    if (is_free(frame, k, ring)) {
      ++balance.dots;
      balance.pressing_mpa = balance.pressing_mpa + pressure_mpa;
      balance.holding_per_mm =
          balance.holding_per_mm - dot(frame.pull[k], frame.area[k]) / squared_norm(frame.area[k]);
    }
  }
  return balance;
}

/// Writes the tensions for `mu_t` (NaN: unknown), the smallest one, and the number of slack cells.
template <scalar S, class Result>
void write_tensions(const S& mu_t, FrameMemory<S>& frame, Result& result) {
  for (std::size_t k = 0; k < frame.tension.size(); ++k) {
    CellTension<S>& tension = frame.tension[k];
    if (frame.cell[k] != CellState::found || !is_finite(mu_t)) {
      tension = {};
      continue;
    }
    tension.larger = mu_t * tension.larger;
    tension.smaller = mu_t * tension.smaller;
    result.cells_slack += value(tension.smaller) < 0 ? 1 : 0;
    if (!is_finite(result.smallest_tension_n_per_mm) ||
        tension.smaller < result.smallest_tension_n_per_mm) {
      result.smallest_tension_n_per_mm = tension.smaller;
    }
  }
}

/// Force of the object on the dot's share of the membrane, N, which balances pressure and tension.
template <scalar S>
Point3<S> force_on(const S& pressure_mpa, const S& mu_t, const FrameMemory<S>& f, std::size_t k) {
  const S push = -pressure_mpa;
  const S pull = -mu_t;
  return push * f.area[k] + pull * f.pull[k];
}

/// Writes the load of one dot, and its parts along the normal and along the membrane.
template <scalar S>
void write_load(const S& pressure_mpa, const S& mu_t, std::size_t k, FrameMemory<S>& frame) {
  using std::sqrt;
  const S per_area = S(1) / S(sqrt(squared_norm(frame.area[k])));
  const Point3<S> normal = per_area * frame.area[k];
  const Point3<S> load = per_area * force_on(pressure_mpa, mu_t, frame, k);
  const S pressing = -dot(load, normal);
  frame.load[k] = load;
  frame.pressure[k] = pressing;
  frame.shear[k] = load + pressing * normal;
}

/// Writes all loads; none without a modulus.
template <scalar S, class Result>
void write_loads(
    const S& pressure_mpa, const S& mu_t, Index ring, FrameMemory<S>& frame, Result& result) {
  using std::sqrt;
  S sum_sq = S(0);
  Point3<S> sum = {S(0), S(0), S(0)};
  for (std::size_t k = 0; k < frame.flags.size(); ++k) {
    frame.load[k] = frame.shear[k] = missing_point<S>();
    frame.pressure[k] = not_a_number<S>();
    if (is_finite(mu_t) && frame.has(k, loaded)) {
      write_load(pressure_mpa, mu_t, k, frame);
      if (is_free(frame, k, ring)) {
        sum_sq = sum_sq + squared_norm(frame.load[k]);
        sum += frame.load[k];
      }
    }
  }
  if (is_finite(mu_t) && result.balance.dots > 0) {
    result.free_load_mpa = sum / S(static_cast<double>(result.balance.dots));
    const S mean_sq = sum_sq / S(static_cast<double>(result.balance.dots));
    result.free_load_rms_mpa = value(mean_sq) > 0 ? S(sqrt(mean_sq)) : S(0);
  }
}

/// Force and moment: the sum of the loads of the dots in contact and in the ring around it, and
/// with decreasing weight of `fade` more dots. Bridged dots are included.
template <scalar S, class Result>
void sum_loads(const S& pressure_mpa,
               const S& mu_t,
               Index ring,
               Index fade,
               const FrameMemory<S>& frame,
               Result& result) {
  result.force_n = result.moment_n_mm = {S(0), S(0), S(0)};
  for (std::size_t k = 0; k < frame.flags.size(); ++k) {
    const Index beyond = frame.steps[k] > ring ? frame.steps[k] - ring : 0;
    if (beyond > fade) {
      continue;
    }
    if (!frame.has(k, summed)) {
      result.dots_left_out += beyond == 0 ? 1 : 0;
      continue;
    }
    ++result.dots_summed;
    const S weight = S(static_cast<double>(fade + 1 - beyond)) / S(static_cast<double>(fade + 1));
    const Point3<S> force = weight * force_on(pressure_mpa, mu_t, frame, k);
    result.force_n += force;
    result.moment_n_mm += cross(frame.place[k], force);
  }
}

}  // namespace detail::traction

}  // namespace v0
}  // namespace fingerpad
