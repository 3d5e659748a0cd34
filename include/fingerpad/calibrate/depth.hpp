// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Fits the optical properties of the fluid to colours at known depths: c_red, c_green (through
// their difference), kappa and g, by least squares on the depth equation F(l) = 0 of
// depth/absorption.hpp, with any number of samples. Source: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor" (slides), parameter identification, which solves three equations for
// three unknowns; printed error E005.
//
// kappa and g are linear and eliminated by a QR factorisation (variable projection); the
// Levenberg-Marquardt method finds (ln c_red, delta), so that c_red > 0, with delta held at >= 0.
// The parameters are far less certain than the depth (docs/depth/depth.md, calibration). The result
// therefore includes the covariance, from which the error of a depth is predicted.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// The mean colour of one place of the membrane with known depth. The reference frame gives such
/// samples, too.
template <scalar S = double>
struct DepthSample {
  Ray<S> ray;                ///< of the pixel
  Point2<S> plate_mm;        ///< where its ray meets the plate, from the axis
  S depth_mm;                ///< l along the ray, >= 0
  Colour<S> colour;          ///< grey levels, > 0
  S green_laplacian = S(0);  ///< mean of the pixels' 4-neighbour Laplacian, grey levels
};

template <scalar S>
std::string check(const DepthSample<S>& s) {
  return check("DepthSample", {{"ray.path_factor", s.ray.path_factor, at_least(2)},
                               {"plate_mm.x", s.plate_mm.x, finite_number},
                               {"plate_mm.y", s.plate_mm.y, finite_number},
                               {"depth_mm", s.depth_mm, not_negative},
                               {"colour.red", s.colour.red, positive},
                               {"colour.green", s.colour.green, positive},
                               {"green_laplacian", s.green_laplacian, finite_number}});
}

/// The sample of pixel (row, col).
template <scalar S>
DepthSample<S> depth_sample(const Camera<S>& camera,
                            const S& row,
                            const S& col,
                            const S& depth_mm,
                            const Colour<S>& colour) {
  const Point3<S> at = point_at(camera, row, col, S(0));
  return {ray_at_pixel(camera, row, col), {at.x, at.y}, depth_mm, colour};
}

/// The fluid, the light and their uncertainty. Parameters are in the order c_red, delta, the
/// coefficients of kappa and of g and, unless Degree is 0, red_blur.
template <scalar S = double, int Degree = 0>
struct [[nodiscard]] AbsorptionFit {
  static constexpr std::size_t kappa_terms = decltype(PadLight<S, Degree>::kappa)::terms;
  static constexpr std::size_t linear =
      kappa_terms + decltype(PadLight<S, Degree>::scattering)::terms + (Degree > 0 ? 1 : 0);
  static constexpr std::size_t parameters = 2 + linear;

  const char* cause = cause::not_converged;  ///< likely mistake
  Absorption<S> fluid = {};                  ///< with kappa on the axis
  PadLight<S, Degree> light = {};
  /// By how much the pictures blur red more than green: red has red_blur times green_laplacian. A
  /// mosaic that was interpolated bilinearly has 1/8. Without it, the weaker contrast of dots in
  /// red would pass for a smaller delta.
  S red_blur = S(0);
  /// NaN with as many samples as parameters.
  std::array<std::array<S, parameters>, parameters> covariance =
      detail::zero_matrix<S, parameters>();
  S condition =
      S(0);  ///< of dF / d ln(parameter), by Frobenius norms; 6e3 for depths of 0.5, 4, 8 and 12 mm
  S residual_rms = S(0);  ///< of F, grey levels
  S explained = S(0);     ///< share of the variance that a fit without depths leaves, both per
                          ///< degree of freedom; NaN with as many samples as parameters
  bool delta_at_limit = false;  ///< the best delta would be < 0; it is held at 0

  bool ok() const { return cause == nullptr; }

  /// The error of the depth that this sample's colours give, mm.
  S error_mm(const DepthSample<S>& s) const {
    Absorption<S> here = fluid;
    here.kappa = light.kappa.at(s.plate_mm);
    const Colour<S> sharp = {s.colour.red, s.colour.green + red_blur * s.green_laplacian};
    const auto [f, slope] =
        depth_equation(here, s.ray, light.scattering.at(s.plate_mm), sharp, s.depth_mm);
    return -f / slope;
  }
};

namespace detail {

/// dW/dc by parts: l (l + h_m)(l + h_s) exp(-c k l) less the integral of z (2 z + h_m + h_s)
/// exp(-c k z).
template <scalar S>
S scattered_light_per_absorption(const S& depth_mm, const S& c_per_mm, const Ray<S>& ray) {
  using std::exp;
  const S t = c_per_mm * (ray.path_factor * depth_mm);
  const ExponentialMoments<S> m = exponential_moments(t);
  const S& h_m = ray.meridional_mm;
  const S& h_s = ray.sagittal_mm;
  const S end = (depth_mm + h_m) * (depth_mm + h_s) * exp(-t);
  return depth_mm * (end - depth_mm * ((h_m + h_s) * m.first + S(2) * depth_mm * m.second));
}

/// c_red and delta, and the best coefficients of kappa and g for them.
template <scalar S, int Degree>
struct AbsorptionPoint {
  using Fit = AbsorptionFit<S, Degree>;
  S c_red, delta;
  std::array<S, Fit::linear> linear = zeros<S, Fit::linear>();
  S cost = not_a_number<S>();  // sum of squared residuals, each over its noise
  Triangle<S> triangle = {};   // of the equations, each over its noise

  /// Appends dF by the linear coefficients, c_red and delta, and F without kappa and g, times
  /// `weight`. `flat`: without absorption, with W = 1.
  void append(const DepthSample<S>& s,
              const S& scale_mm,
              const S& weight,
              std::vector<S>& rows,
              bool flat = false) const {
    using std::exp;
    using Light = PadLight<S, Degree>;
    const S path = s.ray.path_factor * s.depth_mm;
    const S w = flat ? S(1) : scattered_light(s.depth_mm, c_red, s.ray);
    const S fade = weight * (flat ? S(1) : exp(delta * path));
    const S membrane = fade * s.colour.green;
    const S x = s.plate_mm.x / scale_mm, y = s.plate_mm.y / scale_mm;
    S g = S(0);
    for (const S& m : decltype(Light::kappa)::monomials(x, y)) {
      rows.push_back(-weight * s.colour.red * m);
    }
    std::size_t k = Fit::kappa_terms;
    for (const S& m : decltype(Light::scattering)::monomials(x, y)) {
      rows.push_back(weight * m * w);
      g += weight * m * linear[k++];
    }
    if (Degree > 0) {
      rows.push_back(fade * s.green_laplacian);
    }
    if (!flat) {
      rows.push_back(g * scattered_light_per_absorption(s.depth_mm, c_red, s.ray));
      const S blur = Degree > 0 ? linear.back() * s.green_laplacian : S(0);
      rows.push_back((membrane + fade * blur) * path);
    }
    rows.push_back(membrane);
  }

  /// Whether kappa and g on the axis are positive. There are unphysical minima where they are not.
  bool is_physical() const {
    return is_finite(cost) && linear[0] > 0 && linear[Fit::kappa_terms] > 0;
  }
};

/// The equations, each over its noise.
template <scalar S, int Degree>
class AbsorptionProblem {
 public:
  using Point = AbsorptionPoint<S, Degree>;
  static constexpr std::size_t linear = Point::Fit::linear;

  AbsorptionProblem(std::span<const DepthSample<S>> samples, const S& scale_mm)
      : seen_(samples),
        samples_(samples.begin(), samples.end()),
        scale_mm_(scale_mm),
        weights_(samples.size(), S(1)),
        left_(samples.size(), S(0)) {}

  /// Divides each equation by the noise of F there, sqrt(e^{2 delta k l} + kappa^2) times the noise
  /// of a colour, and takes the derivatives of F at the nearest colours for which it is 0. Noisy
  /// colours would make delta and kappa too small (errors in variables).
  void weigh(const Point& p) {
    using std::abs;
    using std::exp;
    using std::sqrt;
    std::vector<double> noise(seen_.size());
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const DepthSample<S>& s = seen_[i];
      weights_[i] =
          S(1) / sqrt(exp(S(2) * p.delta * s.ray.path_factor * s.depth_mm) + square(p.linear[0]));
      std::vector<S> by;
      p.append(s, scale_mm_, S(1), by);
      left_[i] = std::inner_product(p.linear.begin(), p.linear.end(), by.begin(), by.back());
      noise[i] = static_cast<double>(abs(weights_[i] * left_[i]));
    }
    const S limit = S(6 * median(noise));  // what lies beyond is no noise
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const DepthSample<S>& s = seen_[i];
      left_[i] = abs(weights_[i] * left_[i]) > limit ? S(0) : left_[i];
      const S share = left_[i] * square(weights_[i]);
      samples_[i].colour.red = s.colour.red + p.linear[0] * share;
      samples_[i].colour.green =
          s.colour.green - exp(p.delta * s.ray.path_factor * s.depth_mm) * share;
    }
  }

  /// The point at c_red and delta. The columns of these are projected on the complement of the
  /// linear ones; that this space rotates is ignored (Kaufman), and so is the change of g since
  /// `last`, which affects the steps but not the minimum.
  Point project(const S& c_red, const S& delta, const std::array<S, linear>& last) const {
    Point p{c_red, delta, last};
    std::vector<S> rows;
    rows.reserve(samples_.size() * (linear + 3));
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      p.append(samples_[i], scale_mm_, weights_[i], rows);
      rows.back() += weights_[i] * left_[i];
    }
    if (Degree > 0) {  // red_blur is 0 +- 1000, should no sample have a Laplacian
      rows.resize(rows.size() + linear + 3, S(0));
      rows[rows.size() - 4] = S(1) / S(1000);
    }
    p.triangle = Triangle<S>(std::move(rows), linear + 3);
    const std::vector<S> x = p.triangle.solve(linear, linear + 2);
    p.cost = S(0);
    for (std::size_t k = 0; k < linear; ++k) {
      p.linear[k] = -x[k];
    }
    for (std::size_t k = linear; k < linear + 3; ++k) {
      p.cost += square(p.triangle(k, linear + 2));
    }
    return p;
  }

  /// Share of the variance explained by depth. The comparison is a fit of kappa and g alone,
  /// without absorption and with W = 1; both variances are per degree of freedom.
  S explained_by_depth(const Point& p) const {
    std::vector<S> rows;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      p.append(seen_[i], scale_mm_, weights_[i], rows, true);
    }
    const S without_sq = square(Triangle<S>(std::move(rows), linear + 1)(linear, linear));
    const double left = static_cast<double>(samples_.size()) - static_cast<double>(linear + 2);
    return left > 0 ? S(1) - p.cost / S(left) / (without_sq / S(left + 2)) : not_a_number<S>();
  }

 private:
  std::span<const DepthSample<S>> seen_;
  std::vector<DepthSample<S>> samples_;  // with the nearest colours for which F is 0
  S scale_mm_;
  std::vector<S> weights_, left_;  // of each equation; F of the colours that were seen
};

/// Levenberg-Marquardt descent from p; true if it converged to roundoff.
template <scalar S, int Degree>
bool descend(const AbsorptionProblem<S, Degree>& problem,
             AbsorptionPoint<S, Degree>& p,
             int max_iterations) {
  using std::exp;
  const S tiny = S(4) * epsilon<S>();
  S damping = S(1) / S(1000);
  p = problem.project(p.c_red, p.delta, p.linear);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    // the columns of ln c_red, delta and F, in the triangle that is left of them
    constexpr std::size_t n = AbsorptionProblem<S, Degree>::linear;
    const S c = p.c_red * p.triangle(n, n), along = p.triangle(n, n + 1);
    const S across = p.triangle(n + 1, n + 1), f = p.triangle(n, n + 2);
    const S down_c = -c * f, down_delta = -along * f - across * p.triangle(n + 1, n + 2);
    const S cc = square(c) * (S(1) + damping), cd = c * along;
    const S dd = (square(along) + square(across)) * (S(1) + damping);
    const S determinant = cc * dd - cd * cd;
    // At the limit delta = 0, delta only moves if that is downhill.
    const bool at_limit = !(p.delta > S(0)) && !(down_delta > S(0));
    const S step = at_limit ? down_c / cc : (dd * down_c - cd * down_delta) / determinant;
    const S c_red = p.c_red * exp((std::max)(S(-1), (std::min)(step, S(1))));
    const S delta =
        at_limit ? S(0) : (std::max)(p.delta + (cc * down_delta - cd * down_c) / determinant, S(0));
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
      damping = (std::max)(damping * S(10), tiny);
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
AbsorptionPoint<S, 0> search_absorption(const AbsorptionProblem<S, 0>& problem,
                                        int max_iterations) {
  using std::exp;
  constexpr std::size_t linear = AbsorptionProblem<S, 0>::linear;
  const AbsorptionPoint<S, 0> none = {S(0), S(0)};
  AbsorptionPoint<S, 0> best = none;
  for (int j = 0; j <= 8; ++j) {
    const S delta = S(j * j) / S(1000);  // 0 to 0.064 per mm
    AbsorptionPoint<S, 0> start = none;
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
S expects_determined(std::span<const DepthSample<S>> samples, std::size_t parameters) {
  const char* const owner = "fit_absorption";
  std::vector<S> depths;
  S rho_sq_max = S(0);
  for (const DepthSample<S>& s : samples) {
    require(s);
    depths.push_back(s.depth_mm);
    rho_sq_max = (std::max)(rho_sq_max, squared_norm(s.plate_mm));
  }
  expects(samples.size() >= parameters, owner, "number of samples",
          static_cast<long long>(samples.size()),
          "at least the number of parameters; with Degree 0, the reference and 3 known depths");
  const long long distinct = distinct_values(depths);
  expects(distinct >= 3, owner, "number of distinct depths", distinct,
          ">= 3, further apart than a thousandth of the largest");
  return rho_sq_max;
}

}  // namespace detail

/// Finds the fluid, g, a polynomial of degree `Degree` over the plate, and kappa, linear over the
/// plate (one number if Degree is 0), from samples at 3 or more depths. With 4 samples of Degree 0
/// there can be two exact solutions (4 % of random sensors); the one with the smaller delta is
/// returned. One more depth avoids this. Refuses samples that do not determine the parameters, and
/// names what is missing (parameter_error). Allocates; O(samples) per iteration, after some 700
/// trial fluids on at most 400 of the samples, with Degree 0.
template <int Degree = 0, scalar S = double>
AbsorptionFit<S, Degree> fit_absorption(std::span<const DepthSample<S>> samples) {
  using std::sqrt;
  const char* const owner = "fit_absorption";
  using Fit = AbsorptionFit<S, Degree>;
  const S rho_sq = detail::expects_determined(samples, Fit::parameters);
  const S scale_mm = rho_sq > S(0) ? sqrt(rho_sq) : S(1);
  std::vector<DepthSample<S>> few;
  const std::size_t stride = (samples.size() + 399) / 400;
  for (std::size_t k = 0; k < samples.size(); k += stride) {
    few.push_back(samples[k]);
  }
  const auto start = detail::search_absorption(detail::AbsorptionProblem<S, 0>(few, scale_mm), 60);
  detail::AbsorptionProblem<S, Degree> problem(samples, scale_mm);
  auto p = problem.project(start.c_red, start.delta, {});
  expects(is_finite(start.cost) && is_finite(p.cost), owner, "residual",
          is_finite(start.cost) ? p.cost : start.cost,
          "finite with kappa > 0 and g > 0: colours must change with the depth; check whether red "
          "and green are exchanged");
  Fit fit;
  bool converged = false;
  for (int round = 0; round < 4; ++round) {  // the noise of F depends on the fit
    problem.weigh(p);
    converged = detail::descend(problem, p, 60);
  }

  // R over the scales of the parameters, for a condition number that does not depend on units;
  // delta may be 0
  constexpr std::size_t linear = Fit::linear, all = Fit::parameters;
  std::array<S, all> size;
  size.fill(p.linear[Fit::kappa_terms]);
  std::fill_n(size.begin(), Fit::kappa_terms, p.linear[0]);
  size[linear - 1] = Degree > 0 ? S(10) : size[linear - 1];
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
          "< 1e8: the depths must spread over several mm, and differ at every place");

  fit.fluid.c_red_per_mm = p.c_red;
  fit.fluid.c_green_per_mm = p.c_red + p.delta;
  fit.fluid.kappa = p.linear[0];
  fit.light.scattering.scale_mm = fit.light.kappa.scale_mm = scale_mm;
  const auto of_g = p.linear.begin() + Fit::kappa_terms;
  std::copy(p.linear.begin(), of_g, fit.light.kappa.coefficient.begin());
  std::copy_n(of_g, fit.light.scattering.terms, fit.light.scattering.coefficient.begin());
  fit.red_blur = Degree > 0 ? p.linear.back() : S(0);
  fit.delta_at_limit = !(p.delta > S(0));

  const double left = static_cast<double>(samples.size()) - static_cast<double>(all);
  const S variance = left > 0 ? p.cost / S(left) : not_a_number<S>();
  for (std::size_t i = 0; i < all; ++i) {  // c_red and delta come first
    for (std::size_t j = 0; j < all; ++j) {
      fit.covariance[(i + 2) % all][(j + 2) % all] = variance * covariance[i * all + j];
    }
  }
  fit.explained = problem.explained_by_depth(p);
  S deepest = S(0), squares = S(0);
  bool is_lit = p.is_physical();
  for (const DepthSample<S>& s : samples) {
    deepest = (std::max)(deepest, s.depth_mm);
    const S g = fit.light.scattering.at(s.plate_mm);
    Absorption<S> here = fit.fluid;
    here.kappa = fit.light.kappa.at(s.plate_mm);
    is_lit = is_lit && g > S(0) && here.kappa > S(0);
    squares += square(depth_equation(here, s.ray, g, s.colour, s.depth_mm).first);
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
  constexpr std::size_t all = AbsorptionFit<S, Degree>::parameters;
  detail::AbsorptionPoint<S, Degree> p{fit.fluid.c_red_per_mm,
                                       fit.fluid.c_green_per_mm - fit.fluid.c_red_per_mm};
  const auto& kappa = fit.light.kappa;
  const auto& g = fit.light.scattering;
  std::copy(g.coefficient.begin(), g.coefficient.end(),
            std::copy(kappa.coefficient.begin(), kappa.coefficient.end(), p.linear.begin()));
  std::vector<S> by;
  p.append(at, g.scale_mm, S(1), by);
  S variance = S(0);
  for (std::size_t i = 0; i < all; ++i) {
    for (std::size_t j = 0; j < all; ++j) {
      variance += by[i] * fit.covariance[(i + 2) % all][(j + 2) % all] * by[j];
    }
  }
  const auto [f, slope] =
      depth_equation(fit.fluid, at.ray, g.at(at.plate_mm), at.colour, at.depth_mm);
  return sqrt(variance) / slope;
}

}  // namespace v1
}  // namespace fingerpad
