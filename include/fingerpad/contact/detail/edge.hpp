// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The edge of a contact: where the mean curvature that a ring measures changes from that of the
// object to that of the free membrane.
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
//
// A sheared pad bulges more on one side of the object than on the other. To first order its free
// curvature is linear in the position: a plane, by least squares over the pixels around the
// contacts.
#include <algorithm>
#include <cmath>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// q: the share of the jump that a ring measures if its center lies `offset` ring radii outside a
/// straight edge. For a center inside, q(-offset) = 1 - q(offset).
template <scalar S>
S edge_share(const S& offset) {
  using std::acos;
  using std::sqrt;
  if (value(offset) < 0) {
    return S(1) - edge_share(-offset);
  }
  if (!(value(offset) < 1)) {
    return S(1);
  }
  const S sine = sqrt(S(1) - offset * offset);
  const S angle = acos(offset);
  const S bracket = S(3) / S(2) * offset * sine - angle * (S(1) / S(2) + offset * offset);
  return S(1) + bracket * S(0.63661977236758134308);
}

/// The share of the jump, > 0, at which the contact region ends. Membrane nearer than `gap_mm` to
/// the object then counts as contact. Radii of ring and patch in mm, > 0. `spread_mm` is the
/// distance between the pixels of mean_of_nine(); 0: no averaging.
template <scalar S>
S share_at_end(const S& jump_per_mm,
               const S& gap_mm,
               const S& ring_mm,
               const S& patch_mm,
               const S& spread_mm = S(0)) {
  using std::sqrt;
  const S ratio = gap_mm / jump_per_mm;
  const S offset = value(ratio) > 0 ? sqrt(ratio) : S(0);
  const S here = edge_share(offset / ring_mm);
  const S inward = edge_share((offset - spread_mm) / ring_mm);
  const S outward = edge_share((offset + spread_mm) / ring_mm);
  const S share = (here + inward + outward) / S(3);
  const S round = share + S(0.070735530263064590) * ring_mm / patch_mm;
  return value(round) < 1 ? round : S(1);
}

/// Mean of three values; the middle one if another is missing (NaN).
template <class V, class S>
[[gnu::always_inline]] inline V mean_of_three(const V& before, const V& middle, const V& after) {
  const V sum = before + middle + after;
  return sum == sum ? V(sum * S(1.0 / 3)) : middle;
}

/// Writes the mean of nine pixels (3 x 3), `rows` and `cols` apart: if the map's noise is smooth
/// over this distance, nearly as good as the mean over the whole window and several times cheaper.
/// The map has a border as wide, of NaN.
template <class S>
void mean_of_nine(const StridedView<S>& map, Index rows, Index cols, const StridedView<S>& out) {
  const Index down = rows * map.row_stride();
  for (Index i = 0; i < map.rows(); ++i) {
    const S* from = map.row(i);
    S* to = out.row(i);
    for_each_cell<S>(map.cols(), [=]<class V>(Index j) {
      const auto along = [=](const S* row) {
        return mean_of_three<V, S>(load_cells<V, S>(row - cols), load_cells<V, S>(row),
                                   load_cells<V, S>(row + cols));
      };
      const S* at = from + j;
      store_cells<S>(to + j, mean_of_three<V, S>(along(at - down), along(at), along(at + down)));
    });
  }
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
