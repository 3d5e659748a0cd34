// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// First-order propagation of the noise of side dots, line A_g and pressure into force and moment.
#include <array>
#include <cstddef>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/rim.hpp"
#include "fingerpad/force/rim_balance.hpp"
#include "fingerpad/force/wrench_options.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Covariance of force and moment, summed over independent errors.
template <scalar S>
class CovarianceSum {
 public:
  void add(const Point3<S>& force, const Point3<S>& moment) {
    const std::array<S, 6> g = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        sum_[i][j] = sum_[i][j] + g[i] * g[j];
      }
    }
  }
  const std::array<std::array<S, 6>, 6>& get() const { return sum_; }

 private:
  std::array<std::array<S, 6>, 6> sum_ = detail::zero_matrix<S, 6>();
};

/// The quantities from which a frame's forces were computed.
template <scalar S>
struct RimSolution {
  Point3<S> force_n;  ///< of the rim alone
  Point3<S> moment_n_mm;
  S modulus_n_per_mm;  ///< tension / pull
  S base_area_mm2;
  S summit_area_mm2;
  S edge_moment_mm2;  ///< change of that area per mm of error of the lines, root sum of squares
  S pressure_mpa;
};

/// Adds the effect on force and moment of an error `change` of the pull at point k, per mm of rim.
template <Magnitude Fixed, scalar S>
void add_dot(const Rim<S>& rim,
             Index k,
             const Point3<S>& pull,
             const Point3<S>& change,
             const RimSolution<S>& found,
             CovarianceSum<S>& sum) {
  const S weight = found.modulus_n_per_mm * rim.share_mm(k);
  Point3<S> force = weight * change;
  if constexpr (Fixed == Magnitude::of_column) {
    // the vertical component is fixed
    force = force + S(-weight * change.z / pull.z) * pull;
  }
  Point3<S> moment = cross(rim.border(k), force);
  if constexpr (Fixed == Magnitude::of_all) {
    const S rescaled = -force.z / found.force_n.z;
    force = force + rescaled * found.force_n;
    moment = moment + rescaled * found.moment_n_mm;
  }
  sum.add(force, moment);
}

template <Magnitude Fixed, class Row, class Law, scalar S>
std::array<std::array<S, 6>, 6> covariance_of(const Rim<S>& rim,
                                              const RimPulls<S>& pulls,
                                              const Law& law,
                                              const RimSolution<S>& found,
                                              const WrenchNoise<S>& noise) {
  CovarianceSum<S> sum;
  for (Index k = 0; k < rim.size(); ++k) {
    const RimPull<S>& dot = pulls.dots[static_cast<std::size_t>(k)];
    if (dot.status != RimPullStatus::ok || value(noise.side_dot_mm) == 0) {
      continue;
    }
    const Point3<S>& along = pulls.along[static_cast<std::size_t>(k)];
    const S d = S(Row::noise_gain) * noise.side_dot_mm / rim.length_mm(k);
    for (const Point3<S>& axis : {Point3<S>{d, S(0), S(0)}, {S(0), d, S(0)}, {S(0), S(0), d}}) {
      add_dot<Fixed>(rim, k, dot.pull, law.change_of_pull(along, rim.tangent(k), axis), found, sum);
    }
  }
  const Point3<S> none = {S(0), S(0), S(0)};
  if constexpr (Fixed == Magnitude::given) {
    sum.add({S(0), S(0), S(-found.base_area_mm2 * noise.pressure_mpa)}, none);
  } else {
    const S per = noise.pressure_mpa / found.pressure_mpa;
    const Point3<S> base = {S(0), S(0), S(-found.pressure_mpa * found.base_area_mm2)};
    sum.add(per * (found.force_n + base), per * found.moment_n_mm);
    const S lost =
        -found.edge_moment_mm2 * noise.edge_mm / (found.base_area_mm2 - found.summit_area_mm2);
    sum.add(lost * found.force_n, lost * found.moment_n_mm);
  }
  return sum.get();
}

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
