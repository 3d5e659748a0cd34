// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The mean curvature that a ring measures at the edge of contact. HalfLevelEdge ends the contact
// region at this level.
//
// A membrane without stiffness leaves an object tangentially: at the edge its slope is that of the
// object, and its mean curvature jumps from the object's (inside) to the free membrane's (outside).
// All of the jump is in the section across the edge. At the distance s from a straight edge the gap
// between membrane and object is
//   gap(s) = (outside - inside) s^2
// A ring of radius r, centered at s >= 0 outside a straight edge, measures as the mean over all its
// sections
//   inside + q (outside - inside),  q = 1 + (2/pi) [(3/2) sigma sin(phi) - phi (1/2 + sigma^2)]
// with sigma = s / r, cos(phi) = sigma. q is 1/2 on the edge and 1 from sigma = 1 on. The edge of a
// round patch of radius R curves away from the ring, which adds 2 r / (9 pi R) to q, to first
// order.
#include <cmath>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// q: the share of the jump that a ring measures if its center lies `offset` ring radii outside a
/// straight edge. For a center inside, q(-offset) = 1 - q(offset).
template <scalar S>
S edge_share(const S& offset) {
  using std::acos;
  using std::sqrt;
  if (value(offset) < 0) {
    return S(S(1) - edge_share(S(-offset)));
  }
  if (!(value(offset) < 1)) {
    return S(1);
  }
  const S sine = sqrt(S(S(1) - offset * offset));
  const S angle = acos(offset);
  const S bracket = S(3) / S(2) * offset * sine - angle * (S(1) / S(2) + offset * offset);
  return S(S(1) + bracket * S(0.63661977236758134308));
}

/// The mean curvature in 1/mm at which the contact region ends. Membrane nearer than `gap_mm` to
/// the object then counts as contact. Needs outside > inside; radii of ring and patch in mm, > 0.
/// `spread_mm` is the distance between the pixels that SparseMean averages; 0: no averaging.
template <scalar S>
S edge_level(const S& inside_per_mm,
             const S& outside_per_mm,
             const S& gap_mm,
             const S& ring_mm,
             const S& patch_mm,
             const S& spread_mm = S(0)) {
  using std::sqrt;
  const S jump = outside_per_mm - inside_per_mm;
  const S ratio = gap_mm / jump;
  const S offset = value(ratio) > 0 ? S(sqrt(ratio)) : S(0);
  const S here = edge_share(S(offset / ring_mm));
  const S inward = edge_share(S((offset - spread_mm) / ring_mm));
  const S outward = edge_share(S((offset + spread_mm) / ring_mm));
  const S share = (here + inward + outward) / S(3);
  const S round = share + S(0.070735530263064590) * ring_mm / patch_mm;
  const S held = value(round) < 1 ? round : S(1);
  return S(inside_per_mm + held * jump);
}

}  // namespace v0
}  // namespace fingerpad
