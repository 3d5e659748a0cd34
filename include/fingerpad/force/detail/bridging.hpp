// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A dot that was not found, put where its neighbours say. No load is told from it; but the sum of
// the loads over a patch is the pull across the patch's border and the pressure on whatever surface
// spans it, wherever the dots inside are: there a bridged dot serves as well as a found one.
#include <array>
#include <cstddef>

#include "fingerpad/core/detail/point_algebra.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::traction {

/// Where dot (row, col) would lie. With all eight neighbours the surface of degree two through
/// them, else the mean of those that lie opposite to each other; missing where no two do.
/// found(row, col) tells whether a dot of the frame is there, also for places outside of the grid;
/// at(row, col) is its place.
template <scalar S, class Found, class At>
Point3<S> bridged_dot(Index row, Index col, const Found& found, const At& at) {
  constexpr Index step[4][2] = {{0, 1}, {1, 0}, {1, 1}, {1, -1}};
  const Point3<S> none = {S(0), S(0), S(0)};
  std::array<Point3<S>, 2> sums = {none, none};  // of the pairs beside, and of those at the corners
  std::array<int, 2> pairs = {0, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    const Index i = step[k][0], j = step[k][1];
    if (found(row + i, col + j) && found(row - i, col - j)) {
      sums[k / 2] = sum(sums[k / 2], sum(at(row + i, col + j), at(row - i, col - j)));
      ++pairs[k / 2];
    }
  }
  if (pairs[0] == 2 && pairs[1] == 2) {
    return moved(scaled(S(0.5), sums[0]), S(-0.25), sums[1]);
  }
  const std::size_t use = pairs[0] > 0 ? 0 : 1;
  return pairs[use] == 0 ? missing_point<S>() : scaled(S(S(0.5) / S(pairs[use])), sums[use]);
}

}  // namespace detail::traction
}  // namespace v0
}  // namespace fingerpad
