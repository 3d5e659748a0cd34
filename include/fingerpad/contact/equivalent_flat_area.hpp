// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How large a flat contact would be that presses as hard: the area for a look-up of force that
// holds for objects of any shape (force/normal_force.hpp).
//
// The law of Young and Laplace holds on both sides of the contact's edge. Outside, the fluid's
// pressure p bends the membrane outward, p = T k_free with the tension T and the sum k of the two
// principal curvatures. Inside, the object holds the membrane at its own curvature and so presses
// with q = p - T k_contact. Hence
//
//   F_z = q S_c = p S_eq,   S_eq = S_c (1 - k_contact / k_free)                           (EA1)
//
// A plate, level or tilted, has k_contact = 0 and S_eq = S_c (eq. 2 of Ito, Kim and Obinata); a
// ball as round as the pad presses twice as hard as a plate of the same area. Both curvatures are
// in the depth map. (EA1) takes the tension to be the same on both sides; under a round object it
// is less, so that S_eq is somewhat too large: docs/force/normal_force.md has the error.
#include <cmath>
#include <type_traits>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Where curvature is measured: at every step-th pixel of every step-th row, from the eight
/// neighbours span_px away, all of them in contact or all of them free.
struct CurvatureSamples {
  Index span_px = 12;      ///< in [1, 1000]; noise of the depths counts as 1 / span^2
  Index step_px = 3;       ///< in [1, 1000]
  double max_slope = 1.0;  ///< of the membrane; steeper ones are left out; > 0
  Index min_samples = 10;  ///< of either kind, >= 1; with fewer there is no answer
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const CurvatureSamples& samples) {
  const auto refuse_if_not = [](bool held, const char* name, double value, const char* range) {
    expects(held, "CurvatureSamples", name, value, range);
  };
  refuse_if_not(samples.span_px >= 1 && samples.span_px <= 1000, "span_px",
                static_cast<double>(samples.span_px), "in [1, 1000]");
  refuse_if_not(samples.step_px >= 1 && samples.step_px <= 1000, "step_px",
                static_cast<double>(samples.step_px), "in [1, 1000]");
  refuse_if_not(samples.max_slope > 0, "max_slope", samples.max_slope, "> 0");
  refuse_if_not(samples.min_samples >= 1, "min_samples", static_cast<double>(samples.min_samples),
                ">= 1");
}

/// Curvatures are sums of the two principal ones, positive where the membrane bulges outward; NaN
/// where too little of it was seen.
template <scalar S>
struct [[nodiscard]] EquivalentFlatArea {
  S area_mm2 = not_a_number<S>();
  S contact_curvature_per_mm = not_a_number<S>();
  S free_curvature_per_mm = not_a_number<S>();
  Index contact_samples = 0;
  Index free_samples = 0;

  bool ok() const { return is_finite(area_mm2); }
};

namespace detail {

/// The sum of the principal curvatures of a surface r(u, v) from its points on a 3 x 3 lattice;
/// positive where it is a dome seen from +z. NaN where it is steeper than max_slope.
template <scalar S>
S curvature_sum(const Point3<S> (&r)[3][3], const S& max_slope) {
  using std::sqrt;
  const Point3<S> ru = (r[1][2] - r[1][0]) / S(2), rv = (r[2][1] - r[0][1]) / S(2);
  const Point3<S> ruu = r[1][2] - S(2) * r[1][1] + r[1][0];
  const Point3<S> rvv = r[2][1] - S(2) * r[1][1] + r[0][1];
  const Point3<S> ruv = (r[2][2] - r[2][0] - r[0][2] + r[0][0]) / S(4);
  const Point3<S> n = cross(ru, rv);
  const S level_sq = n.x * n.x + n.y * n.y;
  if (!(value(level_sq) <= value(S(max_slope * max_slope * n.z * n.z)))) {
    return not_a_number<S>();
  }
  const S metric = dot(n, n);  // E G - F^2
  const S sum =
      dot(ruu, n) * dot(rv, rv) - S(2) * dot(ruv, n) * dot(ru, rv) + dot(rvv, n) * dot(ru, ru);
  const S outward = value(n.z) > 0 ? S(-1) : S(1);
  return S(outward * sum / (metric * sqrt(metric)));
}

}  // namespace detail

/// (EA1) from a depth map, the mask of its contact and the contact's area (`area_mm2` of
/// ContactRegion or of contact_measures). Grids of different sizes, a contact too small for the
/// span, or a pad that is seen nowhere free give no answer: ok() is false. A membrane that is not
/// curved outward where it is free is none under pressure: no answer either. Pixels without depth
/// count for nothing. O(rows cols / step^2), takes no memory.
template <template <class> class CameraType, scalar S, contact_mask Mask, grid Depth>
EquivalentFlatArea<S> equivalent_flat_area(const CameraType<S>& camera,
                                           const Mask& contact,
                                           const Depth& depth_mm,
                                           const S& contact_area_mm2,
                                           const CurvatureSamples& samples = {}) {
  expects_valid(samples);
  EquivalentFlatArea<S> out;
  const auto mask = as_view(contact);
  const auto depth = as_view(depth_mm);
  if (!same_size(mask, depth)) {
    return out;
  }
  const auto touch_of = [](const auto& cell) {
    if constexpr (std::is_same_v<cell_t<Mask>, Touch>) {
      return cell;
    } else {
      return is_contact(cell) ? Touch::contact : Touch::none;
    }
  };
  S contact_sum = S(0), free_sum = S(0);
  const Index span = samples.span_px;
  for (Index i = span; i + span < depth.rows(); i += samples.step_px) {
    for (Index j = span; j + span < depth.cols(); j += samples.step_px) {
      const auto kind = touch_of(mask(i, j));
      Point3<S> r[3][3];
      bool alike = kind != Touch::unknown;
      for (Index a = 0; a < 3 && alike; ++a) {
        for (Index b = 0; b < 3 && alike; ++b) {
          const Index row = i + (a - 1) * span, col = j + (b - 1) * span;
          r[a][b] = point_at(camera, S(static_cast<double>(row)), S(static_cast<double>(col)),
                             S(depth(row, col)));
          alike = touch_of(mask(row, col)) == kind && is_finite(r[a][b].z);
        }
      }
      const S curvature =
          alike ? detail::curvature_sum(r, S(samples.max_slope)) : not_a_number<S>();
      if (!is_finite(curvature)) {
        continue;
      }
      if (kind == Touch::contact) {
        contact_sum = contact_sum + curvature;
        ++out.contact_samples;
      } else {
        free_sum = free_sum + curvature;
        ++out.free_samples;
      }
    }
  }
  if (out.contact_samples >= samples.min_samples) {
    out.contact_curvature_per_mm = contact_sum / S(static_cast<double>(out.contact_samples));
  }
  if (out.free_samples >= samples.min_samples) {
    out.free_curvature_per_mm = free_sum / S(static_cast<double>(out.free_samples));
  }
  if (value(out.free_curvature_per_mm) > 0) {
    out.area_mm2 =
        contact_area_mm2 * (S(1) - out.contact_curvature_per_mm / out.free_curvature_per_mm);
  }
  return out;
}

}  // namespace v0
}  // namespace fingerpad
