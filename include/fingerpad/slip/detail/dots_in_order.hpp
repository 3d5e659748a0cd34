// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Whether the whole pattern has been labelled otherwise than before, for example shifted by a
// pitch.
#include <vector>

#include "fingerpad/core/detail/dot_frame.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rigid_fit.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Whether the labels of the dots in these cells have changed and not their places: they are
/// further than half a pitch (rms) from any rigid motion since `then`, or turned as in a mirror, or
/// each stands within a third of a pitch (rms) of where the same neighbour stood.
template <scalar S>
bool is_renumbered(const std::vector<Index>& cells,
                   const Point3<S>* now,
                   const Point3<S>* then,
                   Index width,
                   const S& pitch_sq) {
  const auto at = [&](const Point3<S>* dots, Index i) {
    const Index k = cells.data()[i];
    return is_finite(now[k]) && is_finite(then[k]) ? dots[k] : Point3<S>{S(0), S(0), S(0)};
  };
  const auto known = [&](Index i) {
    const Index k = cells.data()[i];
    return S(is_finite(now[k]) && is_finite(then[k]) ? 1 : 0);
  };
  const auto fit = fit_rigid<S>(
      size_of(cells), [&](Index i) { return at(then, i); }, [&](Index i) { return at(now, i); },
      known);
  // mean square distance from where they are expected, in pitches; NaN: fewer than half are known
  const auto off_sq = [&](const auto& expected) {
    S sum = S(0);
    Index count = 0;
    for (const Index k : cells) {
      const Point3<S> off = now[k] - expected(k);
      const S sq = off.x * off.x + off.y * off.y;
      sum = is_finite(sq) ? sum + sq : sum;
      count += is_finite(sq) ? 1 : 0;
    }
    return 2 * count > size_of(cells) ? value(S(sum / (number<S>(count) * pitch_sq)))
                                      : not_a_number<scalar_real_t<S>>();
  };
  const auto moved = [&](Index k) { return (*fit)(then[k]); };
  bool renumbered = fit && (4 * off_sq(moved) > 1 || 2 * value(fit->rotation.m[2][2]) < 1);
  for (const Index to :
       {1 - width, Index(-1), -width - 1, -width, width - 1, Index(1), width + 1, width}) {
    renumbered = renumbered || 9 * off_sq([&](Index k) { return then[k + to]; }) < 1;
  }
  return renumbered;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
