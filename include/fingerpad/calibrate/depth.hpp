// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Fits the optical properties of the fluid to colours at known depths: c_red, c_green (through
// their difference), kappa and g, by least squares on the depth equation F(l) = 0 of
// depth/absorption.hpp, with any number of samples. Source: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor" (slides), parameter identification, which solves three equations for
// three unknowns; printed error E005.
//
// For fixed c_red and delta = c_green - c_red the equation is linear in kappa and in the
// coefficients of g, which a QR factorisation eliminates (variable projection). The
// Levenberg-Marquardt method finds the other two, as (ln c_red, delta), so that c_red > 0, with
// delta held at >= 0.
//
// The parameters are far less certain than the depth: their errors compensate to microns of depth
// (docs/depth/depth.md). The result therefore includes the covariance, from which the error of a
// depth is predicted.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

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

template <scalar S>
std::string check(const DepthSample<S>& s) {
  return check("DepthSample", {{"pencil.path_factor", s.pencil.path_factor, at_least(2)},
                               {"rho_sq_mm2", s.rho_sq_mm2, not_negative},
                               {"depth_mm", s.depth_mm, not_negative},
                               {"colour.red", s.colour.red, positive},
                               {"colour.green", s.colour.green, positive},
                               {"weight", s.weight, positive}});
}

/// The sample of pixel (row, col).
template <scalar S>
DepthSample<S> depth_sample(const Camera<S>& camera,
                            const S& row,
                            const S& col,
                            const S& depth_mm,
                            const Colour<S>& colour,
                            const S& weight = S(1)) {
  const Ray<S> ray = ray_at_pixel(camera, row, col);
  return {pencil_of(camera, ray), square(ray.plate_rho_mm), depth_mm, colour, weight};
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
  S explained = S(0);          ///< share of the variance that a fit without depths leaves, both per
                               ///< degree of freedom; NaN with as many samples as parameters
  bool delta_at_limit = false;  ///< the best delta would be < 0; it is held at 0

  bool ok() const { return cause == nullptr; }
};

namespace detail {

/// dW/dc by parts: l (l + h_m)(l + h_s) exp(-c k l) less the integral of z (2 z + h_m + h_s)
/// exp(-c k z).
template <scalar S>
S scattered_light_per_absorption(const S& depth_mm, const S& c_per_mm, const Pencil<S>& pencil) {
  using std::exp;
  const S t = c_per_mm * (pencil.path_factor * depth_mm);
  const ExponentialMoments<S> m = exponential_moments(t);
  const S& h_m = pencil.height.meridional_mm;
  const S& h_s = pencil.height.sagittal_mm;
  const S end = (depth_mm + h_m) * (depth_mm + h_s) * exp(-t);
  return depth_mm * (end - depth_mm * ((h_m + h_s) * m.first + S(2) * depth_mm * m.second));
}

/// c_red and delta, with the best linear parameters for them: kappa, g_0, g_1, ...
template <scalar S, int Linear>
struct AbsorptionPoint {
  S c_red, delta;
  Eigen::Matrix<S, Linear, 1, Eigen::DontAlign> linear;
  S cost = not_a_number<S>();  ///< sum of squared residuals, each over its noise
  // residual and its Jacobian in (ln c_red, delta), both projected on the complement of the linear
  // columns; the Jacobian ignores that this space rotates (Kaufman), which affects the steps but
  // not the minimum
  Eigen::Matrix<S, Eigen::Dynamic, 1> residual = {};
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> jacobian = {};

  /// Whether kappa and g_0 are positive. There are unphysical minima where they are not.
  bool is_physical() const { return is_finite(cost) && linear(0) > 0 && linear(1) > 0; }
};

/// The equations, each over its noise, of fluids whose g has Linear - 1 coefficients.
template <scalar S, int Linear>
class AbsorptionProblem {
 public:
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  using Point = AbsorptionPoint<S, Linear>;

  AbsorptionProblem(std::span<const DepthSample<S>> samples, const S& rho_sq_max)
      : samples_(samples), rho_sq_max_(rho_sq_max), weight_(Vector::Ones(size())) {
    weight_ = weighted([](const DepthSample<S>& s) { return s.weight; });
  }

  Index size() const { return static_cast<Index>(samples_.size()); }

  /// Sum of squares of the weighted greens, the scale of the cost.
  S green_sq() const { return membrane(S(0)).squaredNorm(); }

  /// Divides each equation by the noise of F there, sqrt(e^{2 delta k l} + kappa^2) times the noise
  /// of a colour. It is constant to a few per cent over the depths of a pad.
  void weigh(const Point& p) {
    using std::exp;
    using std::sqrt;
    weight_.setOnes();
    weight_ = weighted([&](const DepthSample<S>& s) {
      return S(s.weight / sqrt(exp(S(2) * p.delta * path(s)) + square(S(p.linear(0)))));
    });
  }

  /// Eliminates the linear parameters.
  Point project(const S& c_red, const S& delta, bool with_jacobian) const {
    const HouseholderQr<S> qr(linear_columns(c_red));
    Matrix rest(size(), with_jacobian ? 3 : 1);
    rest.col(0) = membrane(delta);
    Point p{c_red, delta, qr.solve(-rest.col(0))};
    if (with_jacobian) {
      rest.rightCols(2) = slopes(p);
      rest.col(1) *= c_red;
    }
    qr.apply_transposed(rest);
    p.residual = rest.col(0).tail(size() - Linear);
    p.jacobian = rest.bottomRightCorner(size() - Linear, rest.cols() - 1);
    p.cost = p.residual.squaredNorm();
    return p;
  }

  /// Share of the variance explained by depth. The comparison is a fit of kappa and g alone,
  /// without absorption and with W = 1; both variances are per degree of freedom.
  S explained_by_depth(const Point& p) const {
    const Index left = size() - Linear - 2;
    Matrix green = membrane(S(0));
    HouseholderQr<S>(columns([](const DepthSample<S>&) { return S(1); })).apply_transposed(green);
    const S without = green.bottomRows(size() - Linear).squaredNorm();
    return left > 0 ? S(1) - p.cost / S(static_cast<double>(left)) /
                                 (without / S(static_cast<double>(left + 2)))
                    : not_a_number<S>();
  }

  /// d(weighted F)/d(c_red, delta, kappa, g_0, ...): size x (2 + Linear).
  Matrix full_jacobian(const Point& p) const {
    Matrix j(size(), 2 + Linear);
    j.leftCols(2) = slopes(p);
    j.rightCols(Linear) = linear_columns(p.c_red);
    return j;
  }

 private:
  static S path(const DepthSample<S>& s) { return s.pencil.path_factor * s.depth_mm; }

  template <class Of>
  Vector weighted(const Of& of) const {
    Vector all(size());
    for (Index i = 0; i < size(); ++i) {
      all(i) = weight_(i) * of(samples_[static_cast<std::size_t>(i)]);
    }
    return all;
  }

  /// Green times e^{delta k l}.
  Vector membrane(const S& delta) const {
    using std::exp;
    return weighted(
        [&](const DepthSample<S>& s) { return S(s.colour.green * exp(delta * path(s))); });
  }

  /// d(weighted F)/d(c_red, delta).
  Matrix slopes(const Point& p) const {
    using std::exp;
    Matrix by(size(), 2);
    by.col(0) = weighted([&](const DepthSample<S>& s) {
      S g = p.linear(Linear - 1);
      for (int k = Linear - 2; k >= 1; --k) {
        g = g * s.rho_sq_mm2 / rho_sq_max_ + p.linear(k);
      }
      return S(g * scattered_light_per_absorption(s.depth_mm, p.c_red, s.pencil));
    });
    by.col(1) = weighted([&](const DepthSample<S>& s) {
      return S(s.colour.green * path(s) * exp(p.delta * path(s)));
    });
    return by;
  }

  Matrix linear_columns(const S& c_red) const {
    return columns(
        [&](const DepthSample<S>& s) { return scattered_light(s.depth_mm, c_red, s.pencil); });
  }
  /// Columns of kappa, g_0, g_1, ..., where light(sample) is W.
  template <class Light>
  Matrix columns(const Light& light) const {
    Matrix a(size(), Linear);
    a.col(0) = weighted([](const DepthSample<S>& s) { return S(-s.colour.red); });
    a.col(1) = weighted(light);
    for (Index i = 0; i < size(); ++i) {
      for (int k = 2; k < Linear; ++k) {
        a(i, k) = a(i, k - 1) * samples_[static_cast<std::size_t>(i)].rho_sq_mm2 / rho_sq_max_;
      }
    }
    return a;
  }

  std::span<const DepthSample<S>> samples_;
  S rho_sq_max_;
  Vector weight_;  // of each equation
};

/// Levenberg-Marquardt descent from p; true if it converged to roundoff.
template <scalar S, int Linear>
bool descend(const AbsorptionProblem<S, Linear>& problem,
             AbsorptionPoint<S, Linear>& p,
             int max_iterations) {
  using std::exp;
  const S tiny = S(4) * epsilon<S>();
  S damping = S(1) / S(1000);
  p = problem.project(p.c_red, p.delta, true);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const auto by_c = p.jacobian.col(0), by_delta = p.jacobian.col(1);
    const S down_c = -by_c.dot(p.residual), down_delta = -by_delta.dot(p.residual);
    const S cc = by_c.squaredNorm() * (S(1) + damping), cd = by_c.dot(by_delta),
            dd = by_delta.squaredNorm() * (S(1) + damping), determinant = cc * dd - cd * cd;
    // At the limit delta = 0, delta only moves if that is downhill.
    const bool at_limit = !(p.delta > S(0)) && !(down_delta > S(0));
    const S step = at_limit ? S(down_c / cc) : S((dd * down_c - cd * down_delta) / determinant);
    const S c_red = p.c_red * exp((std::max)(S(-1), (std::min)(step, S(1))));
    const S delta =
        at_limit ? S(0)
                 : (std::max)(S(p.delta + (cc * down_delta - cd * down_c) / determinant), S(0));
    const auto next = problem.project(c_red, delta, true);
    const bool moved = !(square(step) + square((delta - p.delta) / c_red) <= square(tiny));
    if (next.is_physical() && next.cost < p.cost) {
      const bool gained = next.cost < p.cost * (S(1) - S(100) * epsilon<S>());
      p = next;
      damping = damping / S(10);
      if (!moved || !gained) {
        return true;
      }
    } else {
      damping = (std::max)(S(damping * S(10)), tiny);
      if (!moved || damping > S(1) / tiny) {  // even the shortest step leads uphill
        return true;
      }
    }
  }
  return false;
}

/// The lowest minimum found from a coarse grid over all fluids that a pad could hold. The descent
/// starts at the best c_red for each delta, because there can be several minima. Of minima equal up
/// to roundoff (four samples can have two exact solutions), that of the smallest delta is taken.
/// Needs no initial guess. The cost is NaN if no fluid is physical.
template <scalar S, int Linear>
AbsorptionPoint<S, Linear> search_absorption(const AbsorptionProblem<S, Linear>& problem,
                                             int max_iterations) {
  using std::exp;
  AbsorptionPoint<S, Linear> best{};
  const S roundoff = square(S(1000) * epsilon<S>()) * problem.green_sq();
  for (int j = 0; j <= 8; ++j) {
    const S delta = S(j * j) / S(1000);  // 0 to 0.064 per mm
    AbsorptionPoint<S, Linear> start{};
    for (int i = 0; i <= 24; ++i) {
      const S c_red = exp(S(i) / S(4)) / S(1000);  // 0.001 to 0.4 per mm
      const auto p = problem.project(c_red, delta, false);
      if (p.is_physical() && !(start.cost < p.cost)) {
        start = p;
      }
    }
    if (is_finite(start.cost)) {
      descend(problem, start, max_iterations);
      if (!(best.cost <= start.cost + roundoff)) {
        best = start;
      }
    }
  }
  return best;
}

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
S expects_determined(std::span<const DepthSample<S>> samples, int degree) {
  const char* const owner = "fit_absorption";
  std::vector<S> depths, radii;
  for (const DepthSample<S>& s : samples) {
    require(s);
    depths.push_back(s.depth_mm);
    radii.push_back(s.rho_sq_mm2);
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
  return *std::max_element(radii.begin(), radii.end());
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
  const char* const owner = "fit_absorption";
  require(owner, {{"grey_noise", grey_noise, not_negative}});
  const S rho_sq = detail::expects_determined(samples, Degree);
  const S rho_sq_max = rho_sq > S(0) ? rho_sq : S(1);
  detail::AbsorptionProblem<S, Degree + 2> problem(samples, rho_sq_max);
  auto p = detail::search_absorption(problem, 60);
  expects(is_finite(p.cost), owner, "residual", p.cost,
          "finite with kappa > 0 and g > 0: check whether red and green are exchanged");
  AbsorptionFit<S, Degree> fit;
  bool converged = false;
  for (int round = 0; round < 3; ++round) {  // the noise of F depends, weakly, on the fit
    problem.weigh(p);
    converged = detail::descend(problem, p, 200);
  }

  // scales of the parameters, for a condition number that does not depend on units; delta may be 0
  Eigen::Matrix<S, 4 + Degree, 1, Eigen::DontAlign> size;
  size << p.c_red, (std::max)(p.delta, p.c_red / S(10)), p.linear;
  size.template tail<Degree + 1>().setConstant(p.linear(1));
  size = size.cwiseAbs().eval();
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

  const int left = static_cast<int>(samples.size()) - (4 + Degree);
  const S by_residual = left > 0 ? S(sqrt(p.cost / S(left))) : not_a_number<S>();
  const S noise = grey_noise > S(0) ? grey_noise : by_residual;
  // (J^T J)^-1 = R^-1 R^-T, for parameters relative to their size.
  const typename detail::AbsorptionProblem<S, Degree + 2>::Matrix scaled =
      size.asDiagonal() * qr.inverse_of_r() * noise;
  fit.covariance = scaled.lazyProduct(scaled.transpose());
  fit.explained = problem.explained_by_depth(p);
  S deepest = S(0), squares = S(0);
  bool is_lit = fit.scattering.at(S(0)) > S(0);
  for (const DepthSample<S>& s : samples) {
    deepest = (std::max)(deepest, s.depth_mm);
    const S g = fit.scattering.at(s.rho_sq_mm2);
    const auto [f, slope] = depth_equation(fit.fluid, s.pencil, g, s.colour, s.depth_mm);
    is_lit = is_lit && g > S(0);
    squares += square(f);
  }
  fit.residual_rms = sqrt(squares / S(static_cast<double>(samples.size())));
  fit.cause = !converged         ? cause::not_converged
              : deepest < S(0.1) ? cause::depths_not_in_mm
              : !is_lit ? "g is not positive everywhere: check whether red and green are exchanged"
              : !is_finite(fit.explained) ? cause::nothing_to_check
              : fit.explained < S(0.9)    ? cause::colours_unexplained
                                          : nullptr;
  return fit;
}

/// sd in mm of the depth found from this sample's colours, due to the uncertainty of the fit alone:
/// the covariance propagated through F(l) = 0 at the sample's depth.
template <scalar S, int Degree>
S predicted_depth_sd(const AbsorptionFit<S, Degree>& fit, const DepthSample<S>& at) {
  using std::sqrt;
  DepthSample<S> sample = at;
  sample.weight = S(1);
  detail::AbsorptionPoint<S, Degree + 2> p{
      fit.fluid.c_red_per_mm, fit.fluid.c_green_per_mm - fit.fluid.c_red_per_mm, {}};
  p.linear(0) = fit.fluid.kappa;
  for (int j = 0; j <= Degree; ++j) {
    p.linear(j + 1) = fit.scattering.coefficient[static_cast<std::size_t>(j)];
  }
  const detail::AbsorptionProblem<S, Degree + 2> problem(
      std::span<const DepthSample<S>>(&sample, 1), square(fit.scattering.rho_max_mm));
  const Eigen::Matrix<S, 4 + Degree, 1> by = problem.full_jacobian(p).row(0);
  const S variance = by.dot(fit.covariance * by);
  const auto [f, slope] = depth_equation(fit.fluid, at.pencil, fit.scattering.at(at.rho_sq_mm2),
                                         at.colour, at.depth_mm);
  return sqrt(variance) / slope;
}

}  // namespace v0
}  // namespace fingerpad
