// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Eigen::AutoDiffScalar as a scalar: every kernel then also yields exact derivatives with respect
// to whatever the caller seeds (colours, calibration, camera). With the covariance of a calibration
// they give the variance of a result due to calibration errors.
#include <Eigen/Core>  // AutoDiff does not include it
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <unsupported/Eigen/AutoDiff>

#include "fingerpad/core/scalar.hpp"

// Functions that kernels need and AutoDiffScalar lacks. They are in Eigen's namespace for ADL.
namespace Eigen {

template <class Derivatives>
auto with_slope(const AutoDiffScalar<Derivatives>& x,
                const typename Derivatives::Scalar& result,
                const typename Derivatives::Scalar& slope) {
  using Plain = typename Derivatives::PlainObject;
  return AutoDiffScalar<Plain>(result, Plain(x.derivatives() * slope));
}
template <class Derivatives>
auto atan(const AutoDiffScalar<Derivatives>& x) {
  using std::atan;
  return with_slope(x, atan(x.value()), 1 / (1 + x.value() * x.value()));
}
template <class Derivatives>
auto expm1(const AutoDiffScalar<Derivatives>& x) {
  using std::expm1;
  return with_slope(x, expm1(x.value()), expm1(x.value()) + 1);
}
template <class Derivatives>
auto log1p(const AutoDiffScalar<Derivatives>& x) {
  using std::log1p;
  return with_slope(x, log1p(x.value()), 1 / (1 + x.value()));
}

}  // namespace Eigen

namespace fingerpad {
inline namespace v0 {

template <class Derivatives>
struct scalar_traits<Eigen::AutoDiffScalar<Derivatives>> {
  using real = typename Derivatives::Scalar;
  static constexpr real epsilon() { return (std::numeric_limits<real>::epsilon)(); }
  static const real& value(const Eigen::AutoDiffScalar<Derivatives>& x) { return x.value(); }
};

/// N parameters as dual numbers: derivative k is 1 for parameter k and 0 for the others.
template <scalar S, std::size_t N>
auto seeded(const std::array<S, N>& parameters) {
  using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<S, static_cast<int>(N), 1>>;
  std::array<Dual, N> duals;
  for (std::size_t k = 0; k < N; ++k) {
    duals[k] = Dual(parameters[k], static_cast<int>(N), static_cast<int>(k));
  }
  return duals;
}

/// First-order variance J C J^T of a result, where C is the N x N covariance of the seeded
/// parameters. O(N^2).
template <class Derivatives, class Covariance>
auto carried_variance(const Eigen::AutoDiffScalar<Derivatives>& result,
                      const Eigen::MatrixBase<Covariance>& covariance) {
  return result.derivatives().dot(covariance * result.derivatives());
}

}  // namespace v0
}  // namespace fingerpad
