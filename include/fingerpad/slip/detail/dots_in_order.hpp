// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Whether the whole pattern has been labelled otherwise than before, for example shifted by a
// pitch.
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rigid_fit.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Whether the labels of the dots have changed and not their places: all dots found, in contact or
/// not, are further than half a pitch (rms) from any rigid motion since `then`, or turned as in a
/// mirror, or each stands within a third of a pitch (rms) of where the same neighbour stood. An
/// object that carries the dots in contact by a pitch leaves the others.
template <scalar S>
bool is_renumbered(const FrameOfDots<S>& now, const Bordered<Point3<S>>& then, const S& pitch_sq) {
  const Index count = size_of(then), w = now.width;
  const auto is_known = [&](Index k) { return is_finite(now.found[k]) && is_finite(then[k]); };
  const auto at = [&](const Bordered<Point3<S>>& dots, Index k) {
    return is_known(k) ? dots[k] : Point3<S>{S(0), S(0), S(0)};
  };
  const auto fit = fit_rigid<S>(
      count, [&](Index k) { return at(then, k); }, [&](Index k) { return at(now.found, k); },
      [&](Index k) { return S(is_known(k) ? 1 : 0); });
  // mean square distance from where they are expected, in pitches; NaN: fewer than half are known
  const auto off_sq = [&](const auto& expected) {
    S sum = S(0);
    Index known = 0;
    for (Index k = w + 1; k < count - w - 1; ++k) {  // within the border
      const Point3<S> off = now.found[k] - expected(k);
      const S sq = off.x * off.x + off.y * off.y;
      sum = is_finite(sq) ? sum + sq : sum;
      known += is_finite(sq) ? 1 : 0;
    }
    return 2 * known > now.count ? value(S(sum / (number<S>(known) * pitch_sq)))
                                 : not_a_number<scalar_real_t<S>>();
  };
  const auto moved = [&](Index k) { return (*fit)(then[k]); };
  bool renumbered = fit && (4 * off_sq(moved) > 1 || 2 * value(fit->rotation.m[2][2]) < 1);
  for (const Index to : {1 - w, Index(-1), -w - 1, -w, w - 1, Index(1), w + 1, w}) {
    renumbered = renumbered || 9 * off_sq([&](Index k) { return then[k + to]; }) < 1;
  }
  return renumbered;
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
