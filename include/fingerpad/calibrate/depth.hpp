// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Fits the optical properties of the fluid to colours at known depths: c_red, c_green (through
// their difference), kappa and g, by least squares on the depth equation F(l) = 0 of
// depth/absorption.hpp, with any number of samples. Source: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor" (slides), parameter identification, which solves three equations for
// three unknowns; printed error E005.
//
// The parameters are far less certain than the depth. With a noise of 0.034 grey levels in 4
// samples, c_red has an error of 73 % and even the sign of delta is unknown, while the errors
// compensate to microns of depth. The result therefore includes the covariance, from which the
// error of a depth is predicted.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/detail/absorption_fit.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/math/detail/householder_qr.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The mean colour of one place of the membrane with known depth. The reference frame gives such
/// samples, too.
template <scalar S = double>
struct DepthSample {
  Pencil<S> pencil;  ///< of the pixel
  S rho_sq_mm2;      ///< squared distance of the pixel from the axis on the plate
  S depth_mm;        ///< l along the ray, >= 0
  Colour<S> colour;  ///< grey levels, > 0
  S weight = S(1);   ///< 1 / (relative noise of the colour), > 0
};

/// The sample of pixel (row, col).
template <class Heights = AstigmaticHeights, scalar S>
DepthSample<S> depth_sample(const Camera<S>& camera,
                            const S& row,
                            const S& col,
                            const S& depth_mm,
                            const Colour<S>& colour,
                            const S& weight = S(1)) {
  const Ray<S> ray = ray_at_pixel(camera, row, col);
  return {pencil_of<Heights>(camera, ray), square(ray.plate_rho_mm), depth_mm, colour, weight};
}

/// The fluid and its uncertainty. Parameters are in the order c_red, delta, kappa, g_0, ...
template <scalar S = double, int Degree = 0>
struct [[nodiscard]] AbsorptionFit {
  static constexpr int parameters = 4 + Degree;
  using Covariance = Eigen::Matrix<S, parameters, parameters, Eigen::DontAlign>;

  const char* cause = cause::not_converged;  ///< likely mistake
  Absorption<S> fluid = {};
  RadialScattering<S, Degree> scattering = {};
  Covariance covariance = {};  ///< NaN with as many samples as parameters and no given grey_noise
  S condition = S(0);          ///< of dF / d ln(parameter); 6e3 for depths of 0.5, 4, 8 and 12 mm
  S residual_rms = S(0);       ///< of F, grey levels
  S grey_noise = S(0);         ///< sd of a colour of weight 1: as given, else from the residuals
  S explained = S(0);          ///< share of the variance that a fit without depths leaves, both per
                               ///< degree of freedom; NaN with as many samples as parameters
  bool delta_at_limit = false;  ///< the best delta would be < 0; it is held at 0

  bool ok() const { return cause == nullptr; }
};

/// sd in mm of the depth found from this sample's colours, due to the uncertainty of the fit alone:
/// the covariance propagated through F(l) = 0 at the sample's depth.
template <scalar S, int Degree>
S predicted_depth_sd(const AbsorptionFit<S, Degree>& fit, const DepthSample<S>& at) {
  using std::exp;
  using std::sqrt;
  const S delta = fit.fluid.c_green_per_mm - fit.fluid.c_red_per_mm;
  const S path = at.pencil.path_factor * at.depth_mm;
  const S g = fit.scattering.at(at.rho_sq_mm2);
  const S c_red = fit.fluid.c_red_per_mm;
  Eigen::Matrix<S, 4 + Degree, 1, Eigen::DontAlign> by;
  by(0) = g * detail::scattered_light_per_absorption(at.depth_mm, c_red, at.pencil);
  by(1) = at.colour.green * path * exp(S(delta * path));
  by(2) = -at.colour.red;
  by(3) = scattered_light(at.depth_mm, c_red, at.pencil);
  for (int j = 1; j <= Degree; ++j) {
    by(3 + j) = by(2 + j) * at.rho_sq_mm2 / square(fit.scattering.rho_max_mm);
  }
  const S slope = depth_equation(fit.fluid, at.pencil, g, at.colour, at.depth_mm).slope;
  const S variance = by.dot(fit.covariance * by);
  return S(sqrt(variance) / slope);
}

namespace detail {

/// Number of values, of at least one, that differ by more than a thousandth of the largest.
template <scalar S>
long long distinct_values(std::vector<S> values) {
  std::sort(values.begin(), values.end());
  long long distinct = 1;
  for (std::size_t i = 1; i < values.size(); ++i) {
    distinct += values[i] - values[i - 1] > values.back() / S(1000) ? 1 : 0;
  }
  return distinct;
}

/// Refuses samples that do not determine a fluid, and names what is missing. Returns the largest
/// rho^2.
template <scalar S>
S expects_valid(std::span<const DepthSample<S>> samples, int degree) {
  const char* const owner = "fit_absorption";
  std::vector<S> depths, radii;
  S rho_sq = S(0);
  for (const DepthSample<S>& s : samples) {
    expects(is_finite(s.depth_mm) && !(s.depth_mm < S(0)), owner, "depth_mm", s.depth_mm,
            "finite and >= 0");
    expects(is_finite(s.colour.red) && s.colour.red > S(0), owner, "colour.red", s.colour.red,
            "finite and > 0");
    expects(is_finite(s.colour.green) && s.colour.green > S(0), owner, "colour.green",
            s.colour.green, "finite and > 0");
    expects(is_finite(s.weight) && s.weight > S(0), owner, "weight", s.weight, "finite and > 0");
    expects(is_finite(s.rho_sq_mm2) && !(s.rho_sq_mm2 < S(0)), owner, "rho_sq_mm2", s.rho_sq_mm2,
            "finite and >= 0");
    expects(is_finite(s.pencil.path_factor) && !(s.pencil.path_factor < S(2)), owner,
            "pencil.path_factor", s.pencil.path_factor, "finite and >= 2");
    depths.push_back(s.depth_mm);
    radii.push_back(s.rho_sq_mm2);
    rho_sq = rho_sq < s.rho_sq_mm2 ? s.rho_sq_mm2 : rho_sq;
  }
  expects(static_cast<int>(samples.size()) >= 4 + degree, owner, "number of samples",
          static_cast<long long>(samples.size()),
          "at least the number of parameters, 4 + Degree: the reference and 3 known depths");
  const long long distinct = distinct_values(depths);
  expects(distinct >= 3, owner, "number of distinct depths", distinct,
          ">= 3, further apart than a thousandth of the largest");
  const long long rings = distinct_values(radii);
  expects(rings > degree, owner, "number of distinct rho_sq_mm2", rings,
          "> Degree, further apart than a thousandth of the largest");
  return rho_sq;
}

/// Scales of the parameters, for a condition number that does not depend on units. delta may be 0.
template <class Point>
auto sizes_of(const Point& p) {
  using S = std::remove_cvref_t<decltype(p.delta)>;
  Eigen::Matrix<S, Point::linear_size + 2, 1, Eigen::DontAlign> size;
  const S delta_size = p.delta * S(10) < p.c_red ? S(p.c_red / S(10)) : p.delta;
  size << p.c_red, delta_size, p.linear;
  size.template tail<Point::linear_size - 1>().setConstant(p.linear(1));
  return size.cwiseAbs().eval();
}

/// Share of the variance explained by depth. The comparison is a fit of kappa and g alone, without
/// absorption and with W = 1; both variances are per degree of freedom.
template <class Problem>
auto explained_by_depth(const Problem& problem, const typename Problem::Point& p) {
  using S = std::remove_cvref_t<decltype(p.cost)>;
  const Index left = problem.size() - Problem::Point::linear_size - 2;
  return left > 0 ? S(S(1) - S(p.cost / S(static_cast<double>(left))) /
                                 S(problem.left_without_depth() / S(static_cast<double>(left + 2))))
                  : not_a_number<S>();
}

/// rms of F, grey levels.
template <scalar S, int Degree>
S residual_rms(const AbsorptionFit<S, Degree>& fit, std::span<const DepthSample<S>> samples) {
  using std::sqrt;
  S sum = S(0);
  for (const DepthSample<S>& s : samples) {
    const S g = fit.scattering.at(s.rho_sq_mm2);
    sum += square(depth_equation(fit.fluid, s.pencil, g, s.colour, s.depth_mm).value);
  }
  return S(sqrt(S(sum / S(static_cast<double>(samples.size())))));
}

/// Likely mistake in the samples of a converged fit.
template <scalar S, int Degree>
const char* mistake_in(const AbsorptionFit<S, Degree>& fit,
                       std::span<const DepthSample<S>> samples) {
  S deepest = S(0), g_least = fit.scattering.at(S(0));
  for (const DepthSample<S>& s : samples) {
    deepest = s.depth_mm < deepest ? deepest : s.depth_mm;
    const S g = fit.scattering.at(s.rho_sq_mm2);
    g_least = g < g_least ? g : g_least;
  }
  if (deepest < S(0.1)) {
    return cause::depths_not_in_mm;
  }
  if (!(g_least > S(0))) {
    return "g is not positive everywhere: check whether red and green are exchanged";
  }
  if (!is_finite(fit.explained)) {
    return cause::nothing_to_check;
  }
  return fit.explained < S(0.9) ? cause::colours_unexplained : nullptr;
}

}  // namespace detail

/// Finds the fluid and g, a polynomial of degree `Degree` in rho^2, from at least 4 + Degree
/// samples at 3 or more depths. With only that many there can be two exact solutions (4 % of random
/// sensors); the one with the smaller delta is returned. One more depth avoids this. Refuses
/// samples that do not determine the parameters, and names what is missing (parameter_error).
/// `grey_noise`: sd of a colour of weight 1, grey levels; 0: from the residuals. Allocates;
/// O(samples) per iteration, after some 700 trial fluids.
template <int Degree = 0, scalar S = double>
AbsorptionFit<S, Degree> fit_absorption(std::span<const DepthSample<S>> samples,
                                        const std::type_identity_t<S>& grey_noise = S(0)) {
  using std::sqrt;
  using Equations = std::vector<detail::AbsorptionEquation<S>>;
  using Problem = detail::AbsorptionProblem<S, Degree + 2, Equations>;
  using Matrix = typename Problem::Matrix;
  const char* const owner = "fit_absorption";

  expects(is_finite(grey_noise) && !(grey_noise < S(0)), owner, "grey_noise", grey_noise,
          "finite and >= 0");
  const S rho_sq = detail::expects_valid(samples, Degree);
  const S rho_sq_max = rho_sq > S(0) ? rho_sq : S(1);
  Equations equations;
  for (const DepthSample<S>& s : samples) {
    equations.push_back({s.pencil, s.depth_mm, S(s.rho_sq_mm2 / rho_sq_max), s.colour, s.weight});
  }
  Problem problem(equations);
  auto p = detail::search_absorption(problem, 60);
  expects(is_finite(p.cost), owner, "residual", p.cost,
          "finite with kappa > 0 and g > 0: check whether red and green are exchanged");
  AbsorptionFit<S, Degree> fit;
  bool converged = false;
  for (int round = 0; round < 3; ++round) {  // the noise of F depends, weakly, on the fit
    problem.weigh(p);
    converged = detail::descend(problem, p, 200);
  }

  const auto size = detail::sizes_of(p);
  const detail::HouseholderQr<S> qr(problem.full_jacobian(p) * size.asDiagonal());
  fit.condition = detail::condition_number(qr.r());
  expects(is_finite(fit.condition) && fit.condition < S(1e8), owner, "condition number",
          fit.condition,
          "< 1e8: the depths must spread over several mm, and differ at every radius");

  fit.fluid.c_red_per_mm = p.c_red;
  fit.fluid.c_green_per_mm = p.c_red + p.delta;
  fit.fluid.kappa = p.linear(0);
  for (std::size_t j = 0; j < fit.scattering.coefficient.size(); ++j) {
    fit.scattering.coefficient[j] = p.linear(static_cast<Index>(j) + 1);
  }
  fit.scattering.rho_max_mm = sqrt(rho_sq_max);
  fit.delta_at_limit = !(p.delta > S(0));

  fit.residual_rms = detail::residual_rms(fit, samples);
  const int left = static_cast<int>(samples.size()) - (4 + Degree);
  const S by_residual = left > 0 ? S(sqrt(S(p.cost / S(left)))) : not_a_number<S>();
  fit.grey_noise = grey_noise > S(0) ? grey_noise : by_residual;
  // (J^T J)^-1 = R^-1 R^-T, for parameters relative to their size.
  const Matrix scaled = size.asDiagonal() * qr.inverse_of_r() * fit.grey_noise;
  fit.covariance = scaled.lazyProduct(scaled.transpose());
  fit.explained = detail::explained_by_depth(problem, p);
  fit.cause = converged ? detail::mistake_in(fit, samples) : cause::not_converged;
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
