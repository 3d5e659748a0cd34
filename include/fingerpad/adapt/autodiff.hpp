// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Eigen::AutoDiffScalar as a scalar: every kernel then also yields exact derivatives with respect
// to whatever the caller seeds (colours, calibration, camera).
#include <Eigen/Core>  // AutoDiff does not include it
#include <unsupported/Eigen/AutoDiff>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

template <class Derivatives>
struct scalar_traits<Eigen::AutoDiffScalar<Derivatives>> {
  using real = typename Derivatives::Scalar;
  static constexpr real epsilon() { return (std::numeric_limits<real>::epsilon)(); }
  static const real& value(const Eigen::AutoDiffScalar<Derivatives>& x) { return x.value(); }
};

}  // namespace v0
}  // namespace fingerpad
