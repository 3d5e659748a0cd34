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
#include <algorithm>
#include <array>
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
#include "fingerpad/math/detail/small_matrices.hpp"
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
  static constexpr std::size_t parameters = 4 + Degree;

  const char* cause = cause::not_converged;  ///< likely mistake
  Absorption<S> fluid = {};
  RadialScattering<S, Degree> scattering = {};
  /// NaN with as many samples as parameters and no given grey_noise.
  detail::SmallMatrix<S, parameters> covariance = detail::zero_matrix<S, parameters>();
  S condition =
      S(0);  ///< of dF / d ln(parameter), by Frobenius norms; 6e3 for depths of 0.5, 4, 8 and 12 mm
  S residual_rms = S(0);  ///< of F, grey levels
  S explained = S(0);     ///< share of the variance that a fit without depths leaves, both per
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

/// c_red and delta, and the best kappa, g_0, g_1, ... for them.
template <scalar S>
struct AbsorptionPoint {
  S c_red, delta;
  std::vector<S> linear;
  S cost = not_a_number<S>();  // sum of squared residuals, each over its noise
  Triangle<S> triangle = {};   // of the equations, each over its noise

  /// Appends dF by kappa, g_0, g_1, ..., c_red and delta, and F without kappa and g, times
  /// `weight`.
  void append(const DepthSample<S>& s,
              const S& rho_sq_max,
              const S& weight,
              std::vector<S>& rows) const {
    using std::exp;
    const S path = s.pencil.path_factor * s.depth_mm;
    const S light = scattered_light(s.depth_mm, c_red, s.pencil);
    const S membrane = weight * s.colour.green * exp(delta * path);
    S power = weight, g = S(0);
    rows.push_back(-weight * s.colour.red);
    for (std::size_t k = 1; k < linear.size(); ++k, power *= s.rho_sq_mm2 / rho_sq_max) {
      rows.push_back(power * light);
      g += power * linear[k];
    }
    rows.push_back(g * scattered_light_per_absorption(s.depth_mm, c_red, s.pencil));
    rows.push_back(membrane * path);
    rows.push_back(membrane);
  }

  /// Whether kappa and g_0 are positive. There are unphysical minima where they are not.
  bool is_physical() const { return is_finite(cost) && linear[0] > 0 && linear[1] > 0; }
};

/// The equations, each over its noise.
template <scalar S>
class AbsorptionProblem {
 public:
  AbsorptionProblem(std::span<const DepthSample<S>> samples, const S& rho_sq_max)
      : samples_(samples), rho_sq_max_(rho_sq_max) {
    for (const DepthSample<S>& s : samples) {
      weights_.push_back(s.weight);
    }
  }

  /// Divides each equation by the noise of F there, sqrt(e^{2 delta k l} + kappa^2) times the noise
  /// of a colour. It is constant to a few per cent over the depths of a pad.
  void weigh(const AbsorptionPoint<S>& p) {
    using std::exp;
    using std::sqrt;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const DepthSample<S>& s = samples_[i];
      const S path = s.pencil.path_factor * s.depth_mm;
      weights_[i] = s.weight / sqrt(exp(S(2) * p.delta * path) + square(p.linear[0]));
    }
  }

  /// The point at c_red and delta. The columns of these are projected on the complement of the
  /// linear ones; that this space rotates is ignored (Kaufman), and so is the change of g since
  /// `linear`, which affects the steps but not the minimum.
  AbsorptionPoint<S> project(const S& c_red, const S& delta, const std::vector<S>& linear) const {
    AbsorptionPoint<S> p{c_red, delta, linear};
    const std::size_t count = linear.size();
    std::vector<S> rows;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      p.append(samples_[i], rho_sq_max_, weights_[i], rows);
    }
    p.triangle = Triangle<S>(std::move(rows), count + 3);
    p.linear = p.triangle.solve(count, count + 2);
    for (S& x : p.linear) {
      x = -x;
    }
    p.cost = S(0);
    for (std::size_t k = count; k < count + 3; ++k) {
      p.cost += square(p.triangle(k, count + 2));
    }
    return p;
  }

  /// Share of the variance explained by depth. The comparison is a fit of kappa and g alone,
  /// without absorption and with W = 1; both variances are per degree of freedom.
  S explained_by_depth(const AbsorptionPoint<S>& p) const {
    const std::size_t count = p.linear.size();
    std::vector<S> rows;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      rows.push_back(-weights_[i] * samples_[i].colour.red);
      S power = weights_[i];
      for (std::size_t k = 1; k < count; ++k, power *= samples_[i].rho_sq_mm2 / rho_sq_max_) {
        rows.push_back(power);
      }
      rows.push_back(weights_[i] * samples_[i].colour.green);
    }
    const S without_sq = square(Triangle<S>(std::move(rows), count + 1)(count, count));
    const double left = static_cast<double>(samples_.size()) - static_cast<double>(count + 2);
    return left > 0 ? S(1) - p.cost / S(left) / (without_sq / S(left + 2)) : not_a_number<S>();
  }

 private:
  std::span<const DepthSample<S>> samples_;
  S rho_sq_max_;
  std::vector<S> weights_;  // of each equation
};

/// Levenberg-Marquardt descent from p; true if it converged to roundoff.
template <scalar S>
bool descend(const AbsorptionProblem<S>& problem, AbsorptionPoint<S>& p, int max_iterations) {
  using std::exp;
  const S tiny = S(4) * epsilon<S>();
  S damping = S(1) / S(1000);
  p = problem.project(p.c_red, p.delta, p.linear);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    // the columns of ln c_red, delta and F, in the triangle that is left of them
    const std::size_t n = p.linear.size();
    const S c = p.c_red * p.triangle(n, n), along = p.triangle(n, n + 1);
    const S across = p.triangle(n + 1, n + 1), f = p.triangle(n, n + 2);
    const S down_c = -c * f, down_delta = -along * f - across * p.triangle(n + 1, n + 2);
    const S cc = square(c) * (S(1) + damping), cd = c * along;
    const S dd = (square(along) + square(across)) * (S(1) + damping);
    const S determinant = cc * dd - cd * cd;
    // At the limit delta = 0, delta only moves if that is downhill.
    const bool at_limit = !(p.delta > S(0)) && !(down_delta > S(0));
    const S step = at_limit ? S(down_c / cc) : S((dd * down_c - cd * down_delta) / determinant);
    const S c_red = p.c_red * exp((std::max)(S(-1), (std::min)(step, S(1))));
    const S delta =
        at_limit ? S(0)
                 : (std::max)(S(p.delta + (cc * down_delta - cd * down_c) / determinant), S(0));
    const auto next = problem.project(c_red, delta, p.linear);
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
template <scalar S>
AbsorptionPoint<S> search_absorption(const AbsorptionProblem<S>& problem,
                                     std::size_t linear,
                                     int max_iterations) {
  using std::exp;
  const AbsorptionPoint<S> none = {S(0), S(0), std::vector<S>(linear, S(0))};
  AbsorptionPoint<S> best = none;
  for (int j = 0; j <= 8; ++j) {
    const S delta = S(j * j) / S(1000);  // 0 to 0.064 per mm
    AbsorptionPoint<S> start = none;
    for (int i = 0; i <= 24; ++i) {
      const S c_red = exp(S(i) / S(4)) / S(1000);  // 0.001 to 0.4 per mm
      const auto p = problem.project(c_red, delta, none.linear);
      if (p.is_physical() && !(start.cost < p.cost)) {
        start = p;
      }
    }
    if (is_finite(start.cost)) {
      descend(problem, start, max_iterations);
      S scale_sq = S(0);
      for (std::size_t k = 0; k < linear + 3; ++k) {
        scale_sq += square(start.triangle(k, linear + 2));
      }
      if (!(best.cost <= start.cost + square(S(1000) * epsilon<S>()) * scale_sq)) {
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
  detail::AbsorptionProblem<S> problem(samples, rho_sq_max);
  auto p = detail::search_absorption(problem, Degree + 2, 60);
  expects(
      is_finite(p.cost), owner, "residual", p.cost,
      "finite with kappa > 0 and g > 0: colours must change with the depth; check whether red and "
      "green are exchanged");
  AbsorptionFit<S, Degree> fit;
  bool converged = false;
  for (int round = 0; round < 3; ++round) {  // the noise of F depends, weakly, on the fit
    problem.weigh(p);
    converged = detail::descend(problem, p, 200);
  }

  // R over the scales of the parameters, for a condition number that does not depend on units;
  // delta may be 0
  constexpr std::size_t linear = Degree + 2, all = linear + 2;
  std::array<S, all> size;
  size.fill(p.linear[1]);
  size[0] = p.linear[0];
  size[linear] = p.c_red;
  size[linear + 1] = (std::max)(p.delta, p.c_red / S(10));
  const std::vector<S> covariance = p.triangle.covariance(all);
  S r_sq = S(0), inverse_sq = S(0);
  for (std::size_t j = 0; j < all; ++j) {
    inverse_sq += covariance[j * all + j] / square(size[j]);
    for (std::size_t i = 0; i <= j; ++i) {
      r_sq += square(p.triangle(i, j) * size[j]);
    }
  }
  fit.condition = sqrt(r_sq * inverse_sq);
  expects(is_finite(fit.condition) && fit.condition < S(1e8), owner, "condition number",
          fit.condition,
          "< 1e8: the depths must spread over several mm, and differ at every radius");

  fit.fluid.c_red_per_mm = p.c_red;
  fit.fluid.c_green_per_mm = p.c_red + p.delta;
  fit.fluid.kappa = p.linear[0];
  for (std::size_t j = 0; j < fit.scattering.coefficient.size(); ++j) {
    fit.scattering.coefficient[j] = p.linear[j + 1];
  }
  fit.scattering.rho_max_mm = sqrt(rho_sq_max);
  fit.delta_at_limit = !(p.delta > S(0));

  const int left = static_cast<int>(samples.size()) - (4 + Degree);
  const S by_residual = left > 0 ? S(sqrt(p.cost / S(left))) : not_a_number<S>();
  const S noise = grey_noise > S(0) ? grey_noise : by_residual;
  for (std::size_t i = 0; i < all; ++i) {  // c_red and delta come first
    for (std::size_t j = 0; j < all; ++j) {
      fit.covariance[(i + 2) % all][(j + 2) % all] = square(noise) * covariance[i * all + j];
    }
  }
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
  constexpr std::size_t all = Degree + 4;
  detail::AbsorptionPoint<S> p{
      fit.fluid.c_red_per_mm, fit.fluid.c_green_per_mm - fit.fluid.c_red_per_mm, {fit.fluid.kappa}};
  const auto& g = fit.scattering.coefficient;
  p.linear.insert(p.linear.end(), g.begin(), g.end());
  std::vector<S> by;
  p.append(at, square(fit.scattering.rho_max_mm), S(1), by);
  S variance = S(0);
  for (std::size_t i = 0; i < all; ++i) {
    for (std::size_t j = 0; j < all; ++j) {
      variance += by[i] * fit.covariance[(i + 2) % all][(j + 2) % all] * by[j];
    }
  }
  const auto [f, slope] = depth_equation(fit.fluid, at.pencil, fit.scattering.at(at.rho_sq_mm2),
                                         at.colour, at.depth_mm);
  return sqrt(variance) / slope;
}

}  // namespace v0
}  // namespace fingerpad
