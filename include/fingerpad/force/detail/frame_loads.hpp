// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The loads of a frame, from what the cells pull their dots with, the pressure and mu t.
#include <cmath>
#include <cstddef>

#include "fingerpad/core/detail/point_algebra.hpp"
#include "fingerpad/force/traction_maps.hpp"
#include "fingerpad/force/traction_result.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::traction {

/// Has a load, and lies beyond the ring around the contact.
template <scalar S>
bool is_free(const FrameMemory<S>& frame, std::size_t dot, Index ring) {
  return frame.has(dot, loaded) && frame.steps[dot] > ring;
}

/// The free part's two sides of the balance; see modulus.hpp.
template <scalar S>
ModulusBalance<S> balance_of(const S& pressure_mpa, Index ring, const FrameMemory<S>& frame) {
  ModulusBalance<S> balance;
  for (std::size_t k = 0; k < frame.flags.size(); ++k) {
    if (is_free(frame, k, ring)) {
      ++balance.dots;
      balance.pressing_mpa = balance.pressing_mpa + pressure_mpa;
      balance.holding_per_mm =
          balance.holding_per_mm - dot(frame.pull[k], frame.area[k]) / length_sq(frame.area[k]);
    }
  }
  return balance;
}

/// The tensions for `mu_t` (NaN: unknown), and what stands out among them.
template <scalar S>
void write_tensions(const S& mu_t, FrameMemory<S>& frame, TractionResult<S>& result) {
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

/// Force of the object on the dot's share of the membrane, N: what pressure and tension leave over.
template <scalar S>
Point3<S> force_on(const S& pressure_mpa, const S& mu_t, const FrameMemory<S>& f, std::size_t k) {
  const S push = -pressure_mpa;
  const S pull = -mu_t;
  return moved(scaled(push, f.area[k]), pull, f.pull[k]);
}

/// The load of one dot, in a part along its normal and one along the membrane.
template <scalar S>
void write_load(const S& pressure_mpa, const S& mu_t, std::size_t k, FrameMemory<S>& frame) {
  using std::sqrt;
  const S per_area = S(1) / S(sqrt(length_sq(frame.area[k])));
  const Point3<S> normal = scaled(per_area, frame.area[k]);
  const Point3<S> load = scaled(per_area, force_on(pressure_mpa, mu_t, frame, k));
  const S pressing = -dot(load, normal);
  frame.load[k] = load;
  frame.pressure[k] = pressing;
  frame.shear[k] = moved(load, pressing, normal);
}

/// All loads; none without a modulus.
template <scalar S>
void write_loads(const S& pressure_mpa,
                 const S& mu_t,
                 Index ring,
                 FrameMemory<S>& frame,
                 TractionResult<S>& result) {
  using std::sqrt;
  S sum_sq = S(0);
  for (std::size_t k = 0; k < frame.flags.size(); ++k) {
    frame.load[k] = frame.shear[k] = missing_point<S>();
    frame.pressure[k] = not_a_number<S>();
    if (is_finite(mu_t) && frame.has(k, loaded)) {
      write_load(pressure_mpa, mu_t, k, frame);
      sum_sq = is_free(frame, k, ring) ? S(sum_sq + length_sq(frame.load[k])) : sum_sq;
    }
  }
  if (is_finite(mu_t) && result.balance.dots > 0) {
    const S mean_sq = sum_sq / S(static_cast<double>(result.balance.dots));
    result.free_load_rms_mpa = value(mean_sq) > 0 ? S(sqrt(mean_sq)) : S(0);
  }
}

/// Force and moment: the loads of the dots in contact and of the ring around it, and with less and
/// less weight those of `fade` dots more, bridged dots included.
template <scalar S>
void sum_loads(const S& pressure_mpa,
               const S& mu_t,
               Index ring,
               Index fade,
               const FrameMemory<S>& frame,
               TractionResult<S>& result) {
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
    const Point3<S> force = scaled(weight, force_on(pressure_mpa, mu_t, frame, k));
    result.force_n = sum(result.force_n, force);
    result.moment_n_mm = sum(result.moment_n_mm, cross(frame.place[k], force));
  }
}

}  // namespace detail::traction
}  // namespace v0
}  // namespace fingerpad
