// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The model of tangential force and moment, its fit, and mistakes that the residuals show. See
// calibrate/force.hpp.
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/calibrate/detail/force_checks.hpp"
#include "fingerpad/calibrate/detail/model_fit.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/householder_qr.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

// A force or moment y is an odd polynomial of a displacement or rotation x, normalised by a power
// of the contact's measure: y = sum over k of c_k (u |x|)^(k-1) u x, u = (measure / reference)^T.
// The exponent T is first found by a search, then fitted together with the coefficients.

/// One equation: a component of x and of y, and the length |x|.
template <scalar S>
struct ShearEquation {
  S log_measure;  ///< log(measure / reference)
  S component;
  S length;
  S measured;
  std::size_t sample;
};

template <scalar S>
class ShearModel final : public FitModel<S> {
 public:
  using typename FitModel<S>::Matrix;
  using typename FitModel<S>::Vector;

  /// The exponent is the last parameter, unless it is `given`.
  ShearModel(const std::vector<ShearEquation<S>>& equations,
             Index degree,
             const std::optional<S>& given)
      : equations_(equations), degree_(degree), given_(given) {}

  Index size() const { return degree_ + (given_ ? 0 : 1); }

  void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const override {
    const S exponent = given_ ? *given_ : S(parameters(degree_));
    for (Index i = 0; i < values.size(); ++i) {
      const ShearEquation<S>& e = equations_[static_cast<std::size_t>(i)];
      S value = S(0), by_log = S(0);
      for (Index k = 0; k < degree_; ++k) {
        const S term = column(e, exponent, k);
        value += S(parameters(k) * term);
        by_log += S(S(static_cast<int>(k) + 1) * S(parameters(k) * term));
        jacobian(i, k) = term;
      }
      values(i) = value;
      if (!given_) {
        jacobian(i, degree_) = by_log * e.log_measure;
      }
    }
  }

  /// The best coefficients for an exponent. Returns the residual: the sum of squares or, if robust,
  /// of magnitudes.
  S left_at(const S& exponent, bool robust, Vector& coefficients) const {
    const Index n = static_cast<Index>(equations_.size());
    Matrix a(n, degree_);
    Vector b(n);
    for (Index i = 0; i < n; ++i) {
      const ShearEquation<S>& e = equations_[static_cast<std::size_t>(i)];
      b(i) = e.measured;
      for (Index k = 0; k < degree_; ++k) {
        a(i, k) = column(e, exponent, k);
      }
    }
    coefficients = HouseholderQr<S>(a).solve(b);
    const Vector left = b - a.lazyProduct(coefficients);
    return robust ? S(left.cwiseAbs().sum()) : S(left.squaredNorm());
  }

 private:
  static S column(const ShearEquation<S>& e, const S& exponent, Index k) {
    using std::exp;
    const S factor = exp(S(exponent * e.log_measure));
    S term = factor * e.component;
    for (Index i = 0; i < k; ++i) {
      term = term * S(factor * e.length);
    }
    return term;
  }

  const std::vector<ShearEquation<S>>& equations_;
  Index degree_;
  std::optional<S> given_;
};

/// Fits a shear model: a search for the exponent from -2 to 6, then all parameters together.
template <scalar S>
ModelFit<S> fit_shear_model(const char* owner,
                            const std::vector<std::string>& names,
                            const typename ModelFit<S>::Vector& measured,
                            const ShearModel<S>& model,
                            Index degree,
                            const FitOptions& options) {
  using Vector = typename ModelFit<S>::Vector;
  const S lowest = S(-2), highest = S(6);
  constexpr int steps = 80;
  const ModelFitter<S> fitter(owner, names, measured, model, options);
  Vector start = Vector::Zero(model.size()), coefficients;
  const bool searched = model.size() > degree;
  S least = not_a_number<S>();
  for (int k = 0; searched && k <= steps; ++k) {
    const S at = lowest + S(S(highest - lowest) * S(S(k) / S(steps)));
    const S left = model.left_at(at, options.robust, coefficients);
    if (!(value(left) >= value(least)) && is_finite(left)) {
      least = left;
      start.head(degree) = coefficients;
      start(degree) = at;
    }
  }
  ModelFit<S> fit = fitter(start);
  const bool inside = !searched || (value(fit.parameters(degree)) >= value(lowest) &&
                                    value(fit.parameters(degree)) <= value(highest));
  expects(inside, owner, names.back().c_str(), S(fit.parameters(fit.parameters.size() - 1)),
          "in [-2, 6]: the samples do not determine it");
  return fit;
}

/// A force and the normalised displacement that should cause it.
template <scalar S>
struct PlaneForce {
  Point2<S> normalised;  ///< u d
  Point2<S> force;
  Point2<S> left;  ///< residual of the force
};

/// Collects equations in samples: pairs of x and y for a force, single ones for a moment. `left(i)`
/// is the residual of equation i.
template <scalar S, class Left>
std::vector<PlaneForce<S>> plane_forces(const std::vector<ShearEquation<S>>& equations,
                                        const S& exponent,
                                        std::size_t components,
                                        const Left& left) {
  using std::exp;
  std::vector<PlaneForce<S>> forces;
  for (std::size_t i = 0; i + components <= equations.size(); i += components) {
    const ShearEquation<S>& x = equations[i];
    const S u = exp(S(exponent * x.log_measure));
    PlaneForce<S> f{{S(u * x.component), S(0)}, {x.measured, S(0)}, {left(i), S(0)}};
    if (components > 1) {
      const ShearEquation<S>& y = equations[i + 1];
      f.normalised.y = u * y.component;
      f.force.y = y.measured;
      f.left.y = left(i + 1);
    }
    forces.push_back(f);
  }
  return forces;
}

/// Sums over all samples that relate the directions of forces and displacements.
template <scalar S>
struct ForceDirections {
  S dd = S(0), ff = S(0), along = S(0), across = S(0), mirrored_x = S(0), mirrored_y = S(0);

  explicit ForceDirections(const std::vector<PlaneForce<S>>& samples) {
    for (const PlaneForce<S>& s : samples) {
      const Point2<S>&d = s.normalised, &f = s.force;
      dd = dd + squared_norm(d);
      ff = ff + squared_norm(f);
      along = along + dot(d, f);
      across = across + S(d.x * f.y - d.y * f.x);
      mirrored_x = mirrored_x + S(d.x * f.x - d.y * f.y);
      mirrored_y = mirrored_y + S(d.x * f.y + d.y * f.x);
    }
  }
  /// Sums of squares explained by a rotation with a scale, and by a reflection with a scale.
  S by_rotation() const { return S(S(square(along) + square(across)) / dd); }
  S by_mirror() const { return S(S(square(mirrored_x) + square(mirrored_y)) / dd); }
  static bool exceeds(const S& a, const S& b) { return value(a) > value(b); }
};

/// Rotation of a force gauge about the normal, against the image; NaN: not determined.
template <scalar S>
struct GaugeAngle {
  S rad = not_a_number<S>();
  S sd_rad = not_a_number<S>();  ///< standard error, for samples with independent errors
};

/// The rotation from the least-squares linear map A of normalised displacements to forces. The
/// stiffness of an elastic pad is symmetric (Betti), so an antisymmetric part of A is a rotation.
/// Displacements along one line do not distinguish it from an anisotropic pad, and near one line
/// the nonlinearity of the pad outweighs it. There is no angle if the determinant of sum d d^T is
/// below a fifth of that for displacements even in all directions.
template <scalar S>
GaugeAngle<S> gauge_angle(const std::vector<PlaneForce<S>>& samples) {
  using std::atan2;
  using std::sqrt;
  S xx = S(0), xy = S(0), yy = S(0);                 // of d d^T
  Point2<S> f_x = {S(0), S(0)}, f_y = {S(0), S(0)};  // sums of x f and y f
  for (const PlaneForce<S>& s : samples) {
    const Point2<S>& d = s.normalised;
    xx += S(d.x * d.x);
    xy += S(d.x * d.y);
    yy += S(d.y * d.y);
    f_x += d.x * s.force;
    f_y += d.y * s.force;
  }
  const S determinant = S(xx * yy) - S(xy * xy), trace = xx + yy;
  constexpr int min_samples = 3;
  if (samples.size() < min_samples || !(value(S(S(20) * determinant)) > value(square(trace)))) {
    return {};
  }
  const S over = S(1) / determinant;
  const Point2<S> by_x =
      over * Point2<S>{S(yy * f_x.x) - S(xy * f_y.x), S(yy * f_x.y) - S(xy * f_y.y)};
  const Point2<S> by_y =
      over * Point2<S>{S(xx * f_y.x) - S(xy * f_x.x), S(xx * f_y.y) - S(xy * f_x.y)};
  const S along = by_x.x + by_y.y, across = by_x.y - by_y.x;
  S left_sq = S(0);
  for (const PlaneForce<S>& s : samples) {
    left_sq += squared_norm(Point2<S>(s.force - s.normalised.x * by_x - s.normalised.y * by_y));
  }
  const S variance = left_sq / S(2.0 * static_cast<double>(samples.size()) - 4);
  const S size_sq = square(along) + square(across);
  return {S(atan2(across, along)), S(sqrt(S(variance * trace * over / size_sq)))};
}

/// "; " and the likely cause, for refusals; for a rotated gauge with its angle.
template <scalar S>
std::string cause_of(const char* mistake, const GaugeAngle<S>& angle) {
  if (mistake != cause::gauge_rotated) {
    return cause_of(mistake);
  }
  constexpr double degrees = 57.29577951308232;
  const auto whole = [](const S& rad) {
    return std::to_string(std::lround(degrees * static_cast<double>(value(rad))));
  };
  return cause_of(mistake) +
         (is_finite(angle.sd_rad)
              ? " (rotated by " + whole(angle.rad) + " +- " + whole(angle.sd_rad) + " degrees)"
              : " (displace in several directions to obtain the angle)");
}

/// Detects axes with which no fit can succeed: mirrored, or rotated by more than 45 degrees.
template <scalar S>
const char* wrong_axes(const std::vector<PlaneForce<S>>& samples) {
  const ForceDirections<S> sums(samples);
  const auto exceeds = sums.exceeds;
  if (exceeds(S(S(2) * sums.by_mirror()), sums.ff) &&
      exceeds(sums.ff, S(S(2) * sums.by_rotation()))) {
    return "the forces mirror the displacements: check whether x and y are exchanged or "
           "one is reversed";
  }
  const bool across = exceeds(square(sums.across), square(sums.along));
  return across && exceeds(S(S(2) * sums.by_rotation()), sums.ff) ? cause::gauge_rotated : nullptr;
}

/// The likely mistake behind the residual of a fit; ok: none detected. A constant counts as one if
/// it explains more than half of the residual and exceeds a tenth of the largest force. A rotation
/// does if it explains more than half and exceeds a tenth of the force along the displacement.
template <scalar S>
const char* mistake_in(const std::vector<PlaneForce<S>>& samples) {
  const ForceDirections<S> sums(samples);
  const auto exceeds = sums.exceeds;
  if (exceeds(S(0), sums.along) && exceeds(S(S(2) * sums.by_rotation()), sums.ff)) {
    return "the forces point against the displacements: check the sign of each axis";
  }
  S left_sq = S(0), largest_sq = S(0);
  Point2<S> sum = {S(0), S(0)};
  for (const PlaneForce<S>& s : samples) {
    sum += s.left;
    left_sq = left_sq + squared_norm(s.left);
    largest_sq = exceeds(squared_norm(s.force), largest_sq) ? squared_norm(s.force) : largest_sq;
  }
  const S count = S(static_cast<double>(samples.size()));
  const S by_constant = squared_norm(sum) / count;
  if (exceeds(S(S(2) * by_constant), left_sq) &&
      exceeds(S(S(100) * S(by_constant / count)), largest_sq)) {
    return cause::gauge_not_tared;
  }
  const S across_sq = square(sums.across);
  const bool explains = exceeds(S(S(2) * S(across_sq / sums.dd)), left_sq);
  const bool matters = exceeds(S(S(100) * across_sq), square(sums.along));
  return explains && matters ? cause::gauge_rotated : nullptr;
}

/// Converts a fit to a result.
template <class Result, scalar S>
Result shear_fit_of(const ModelFit<S>& fit,
                    const typename ModelFit<S>::Vector& measured,
                    const std::vector<ShearEquation<S>>& equations,
                    const std::optional<S>& given) {
  using std::exp;
  using std::sqrt;
  constexpr std::size_t degree = Result::size;
  constexpr Index last = static_cast<Index>(degree);
  Result result;
  result.exponent = given ? *given : S(fit.parameters(last));
  result.standard_errors = standard_errors_of<S, degree>(fit);
  result.exponent_sd = given ? S(0) : S(sqrt(fit.covariance(last, last)));
  result.covariance = covariance_of<S, degree + 1>(fit);
  result.polynomial.to = S(0);
  std::vector<std::size_t> places;
  for (const ShearEquation<S>& e : equations) {
    const S length = S(exp(S(result.exponent * e.log_measure))) * e.length;
    result.polynomial.to =
        value(length) > value(result.polynomial.to) ? length : result.polynomial.to;
    places.push_back(e.sample);
  }
  for (std::size_t k = 0; k < result.standard_errors.size(); ++k) {
    result.polynomial.coefficients[k] = fit.parameters(static_cast<Index>(k));
  }
  result.residual_sd = fit.residual_sd;
  add_residuals(fit, measured, places, result.residuals);
  result.explained = fit.explained;
  result.largest_residual_sds = fit.worst_sds;
  return result;
}

/// Checks, fit and result, common to force and moment.
template <class Result, class Sample, scalar S>
Result fit_shear(const char* owner,
                 const char* exponent_name,
                 std::size_t components,
                 const std::vector<Sample>& samples,
                 const std::vector<ShearEquation<S>>& equations,
                 const std::optional<S>& exponent,
                 const FitOptions& options) {
  typename ModelFit<S>::Vector measured(static_cast<Index>(equations.size()));
  for (std::size_t i = 0; i < equations.size(); ++i) {
    measured(static_cast<Index>(i)) = equations[i].measured;
  }
  constexpr Index degree = static_cast<Index>(Result::size);
  expects(!exponent || is_finite(*exponent), owner, exponent_name, exponent.value_or(S(0)),
          "finite");
  std::vector<std::string> names;
  for (std::size_t k = 1; k <= Result::size; ++k) {
    names.push_back("coefficient " + std::to_string(k));
  }
  if (!exponent) {
    names.emplace_back(exponent_name);
  }
  const auto forces =
      plane_forces(equations, exponent.value_or(S(0)), components,
                   [&](std::size_t i) -> const S& { return equations[i].measured; });
  const char* const axes = wrong_axes(forces);
  const std::string need =
      "such that the forces follow the displacements" + cause_of(axes, gauge_angle(forces));
  expects(axes == nullptr, owner, "usable samples", static_cast<long long>(samples.size()),
          need.c_str());
  const ShearModel<S> model(equations, degree, exponent);
  const ModelFit<S> fit = fit_shear_model(owner, names, measured, model, degree, options);
  Result result = shear_fit_of<Result>(fit, measured, equations, exponent);
  const auto left =
      plane_forces(equations, result.exponent, components,
                   [&](std::size_t i) -> const S& { return fit.residuals(static_cast<Index>(i)); });
  const GaugeAngle<S> angle = components > 1 ? gauge_angle(left) : GaugeAngle<S>{};
  result.gauge_angle_rad = angle.rad;
  result.gauge_angle_sd_rad = angle.sd_rad;
  const char* const mistake = mistake_in(left);
  expects_explained(fit, options, owner, cause_of(mistake, angle).c_str());
  const bool is_moment = components == 1;
  const char* const units = unit_mistake(samples, {.tangential = !is_moment,
                                                   .displacement = !is_moment,
                                                   .rotation = is_moment,
                                                   .moment = is_moment});
  result.cause = cause_in(fit, units, mistake, options);
  return result;
}

template <scalar S>
void expects_reference(const S& reference, const char* owner) {
  expects(is_finite(reference) && value(reference) > 0, owner, "reference", reference,
          "finite and > 0");
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
