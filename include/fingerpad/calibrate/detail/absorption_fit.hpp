// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Least squares on the depth equation F(l_i) = 0 by variable projection. For fixed c_red and
// delta = c_green - c_red it is linear in kappa and in the coefficients of g, which a QR
// factorisation eliminates. The Levenberg-Marquardt method finds the other two, as (ln c_red,
// delta), so that c_red > 0, with delta held at >= 0. No normal equations are formed.
#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/math/detail/householder_qr.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// dW/dc: W/c less the integral of c k z (z + h_m)(z + h_s) exp(-c k z).
template <scalar S>
S scattered_light_per_absorption(const S& depth_mm, const S& c_per_mm, const Pencil<S>& pencil) {
  using std::exp;
  const S path = pencil.path_factor * depth_mm;
  const S t = c_per_mm * path;
  const ExponentialMoments<S> m = exponential_moments(t);
  // The third moment by its own series of positive terms, see exponential_moments.
  S third{};
  if (value(t) < 4) {
    S term = S(1) / S(4);
    third = term;
    for (int j = 5; j < 200 && value(term) > epsilon<S>() * value(third) / 4; ++j) {
      term = term * t / S(j);
      third = third + term;
    }
    third = third * exp(S(-t));
  } else {
    third = (S(3) * m.second - exp(S(-t))) / t;
  }
  const S& h_m = pencil.height.meridional_mm;
  const S& h_s = pencil.height.sagittal_mm;
  const S lower = h_m * h_s * m.zeroth + depth_mm * ((h_m + h_s) * m.first + depth_mm * m.second);
  const S higher = h_m * h_s * m.first + depth_mm * ((h_m + h_s) * m.second + depth_mm * third);
  return S(depth_mm * (lower - t * higher));
}

/// Data of one equation; `v` is the variable of g's polynomial.
template <scalar S>
struct AbsorptionEquation {
  Pencil<S> pencil;
  S depth_mm;
  S v;
  Colour<S> colour;
  S weight;
};

/// c_red and delta, with the best linear parameters for them: kappa, g_0, g_1, ...
template <scalar S, int Linear>
struct AbsorptionPoint {
  static constexpr int linear_size = Linear;
  S c_red;
  S delta;
  Eigen::Matrix<S, Linear, 1, Eigen::DontAlign> linear;
  S cost = not_a_number<S>();  ///< sum of squared residuals, each over its noise
};

/// The problem for g with Linear - 1 coefficients; Sample is an AbsorptionEquation.
template <scalar S, int Linear, class Samples>
class AbsorptionProblem {
 public:
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  using Point = AbsorptionPoint<S, Linear>;

  explicit AbsorptionProblem(const Samples& samples)
      : samples_(samples), row_weight_(static_cast<Index>(samples.size())) {
    for (Index i = 0; i < row_weight_.size(); ++i) {
      row_weight_(i) = sample(i).weight;
    }
  }

  Index size() const { return row_weight_.size(); }

  /// Sum of squares of the weighted greens, the scale of the cost.
  S green_sq() const {
    S sum = S(0);
    for (Index i = 0; i < size(); ++i) {
      sum += square(S(row_weight_(i) * sample(i).colour.green));
    }
    return sum;
  }

  /// Divides each equation by the noise of F there, sqrt(e^{2 delta k l} + kappa^2) times the noise
  /// of a colour. It is constant to a few per cent over the depths of a pad.
  void weigh(const Point& p) {
    using std::exp;
    using std::sqrt;
    const S kappa_sq = square(S(p.linear(0)));
    for (Index i = 0; i < size(); ++i) {
      const S path = sample(i).pencil.path_factor * sample(i).depth_mm;
      const S noise = sqrt(S(exp(S(S(2) * p.delta * path)) + kappa_sq));
      row_weight_(i) = sample(i).weight / noise;
    }
  }

  /// Eliminates the linear parameters. Optionally also gives the residual and its Jacobian in (ln
  /// c_red, delta), both projected on the complement of the linear columns. The Jacobian ignores
  /// that this space rotates (Kaufman), which affects the steps but not the minimum.
  Point project(const S& c_red, const S& delta, Vector* residual, Matrix* jacobian) const {
    Matrix a(size(), Linear), rest(size(), 3);
    for (Index i = 0; i < size(); ++i) {
      fill_linear(i, c_red, a);
      rest(i, 0) = row_weight_(i) * membrane(i, delta);
    }
    const HouseholderQr<S> qr(std::move(a));
    Point p{c_red, delta, qr.solve(-rest.col(0))};
    for (Index i = 0; i < size(); ++i) {
      rest(i, 1) = c_red * by_c_red(i, p);
      rest(i, 2) = by_delta(i, delta);
    }
    qr.apply_transposed(rest);
    const Index left = size() - Linear;
    const Vector r = rest.col(0).tail(left);
    p.cost = r.squaredNorm();
    if (residual != nullptr) {
      *residual = r;
      *jacobian = rest.bottomRightCorner(left, 2);
    }
    return p;
  }

  /// Residual sum of squares of the linear parameters alone, without depth: delta = 0 and W = 1.
  S left_without_depth() const {
    Matrix a(size(), Linear), green(size(), 1);
    for (Index i = 0; i < size(); ++i) {
      a(i, 0) = -row_weight_(i) * sample(i).colour.red;
      green(i, 0) = row_weight_(i) * sample(i).colour.green;
      a(i, 1) = row_weight_(i);
      for (int k = 2; k < Linear; ++k) {
        a(i, k) = a(i, k - 1) * sample(i).v;
      }
    }
    HouseholderQr<S>(std::move(a)).apply_transposed(green);
    return S(green.bottomRows(size() - Linear).squaredNorm());
  }

  /// d(weighted F)/d(c_red, delta, kappa, g_0, ...): size x (2 + Linear).
  Matrix full_jacobian(const Point& p) const {
    Matrix a(size(), Linear), j(size(), 2 + Linear);
    for (Index i = 0; i < size(); ++i) {
      fill_linear(i, p.c_red, a);
      j(i, 0) = by_c_red(i, p);
      j(i, 1) = by_delta(i, p.delta);
    }
    j.rightCols(Linear) = a;
    return j;
  }

 private:
  const AbsorptionEquation<S>& sample(Index i) const {
    return samples_[static_cast<std::size_t>(i)];
  }

  S membrane(Index i, const S& delta) const {
    using std::exp;
    const AbsorptionEquation<S>& s = sample(i);
    return S(s.colour.green * exp(S(delta * s.pencil.path_factor * s.depth_mm)));
  }
  S by_delta(Index i, const S& delta) const {
    const AbsorptionEquation<S>& s = sample(i);
    return S(row_weight_(i) * s.pencil.path_factor * s.depth_mm * membrane(i, delta));
  }
  S by_c_red(Index i, const Point& p) const {
    const AbsorptionEquation<S>& s = sample(i);
    S g = p.linear(Linear - 1);
    for (int k = Linear - 2; k >= 1; --k) {
      g = g * s.v + p.linear(k);
    }
    return S(row_weight_(i) * g * scattered_light_per_absorption(s.depth_mm, p.c_red, s.pencil));
  }
  void fill_linear(Index i, const S& c_red, Matrix& a) const {
    const AbsorptionEquation<S>& s = sample(i);
    a(i, 0) = -row_weight_(i) * s.colour.red;
    a(i, 1) = row_weight_(i) * scattered_light(s.depth_mm, c_red, s.pencil);
    for (int k = 2; k < Linear; ++k) {
      a(i, k) = a(i, k - 1) * s.v;
    }
  }

  const Samples& samples_;
  Vector row_weight_;
};

/// Whether kappa and g_0 are positive. There are unphysical minima where they are not.
template <class Point>
bool is_physical(const Point& p) {
  return is_finite(p.cost) && p.linear(0) > 0 && p.linear(1) > 0;
}

/// Levenberg-Marquardt descent from p; true if it converged to roundoff.
template <class Problem>
bool descend(const Problem& problem, typename Problem::Point& p, int max_iterations) {
  using std::exp;
  using std::sqrt;
  using S = typename Problem::Vector::Scalar;
  using Vector = typename Problem::Vector;
  using Matrix = typename Problem::Matrix;
  const S tiny = S(4) * epsilon<S>();
  bool converged = false;
  S damping = S(1) / S(1000);
  Vector r;
  Matrix j;
  p = problem.project(p.c_red, p.delta, &r, &j);
  for (int iteration = 0; iteration < max_iterations && !converged; ++iteration) {
    // At the limit delta = 0, delta only moves if that is downhill.
    const bool at_limit = !(p.delta > S(0)) && j.col(1).dot(r) > S(0);
    Matrix damped = Matrix::Zero(r.size() + 2, 2);
    damped.topRows(r.size()) = j;
    if (at_limit) {
      damped.col(1).setZero();
    }
    for (Index k = 0; k < 2; ++k) {
      const S length = j.col(k).norm();
      damped(r.size() + k, k) = length > S(0) ? S(sqrt(damping) * length) : S(1);
    }
    Vector right = Vector::Zero(r.size() + 2);
    right.head(r.size()) = -r;
    const Vector step = HouseholderQr<S>(damped).solve(right);
    const S limited = step(0) > S(1) ? S(1) : (step(0) < S(-1) ? S(-1) : S(step(0)));
    const S c_red = p.c_red * exp(limited);
    const S free_delta = p.delta + step(1);
    const S delta = at_limit || free_delta < S(0) ? S(0) : free_delta;
    Vector new_r;
    Matrix new_j;
    const auto next = problem.project(c_red, delta, &new_r, &new_j);
    const S moved = (step(0) < S(0) ? S(-step(0)) : S(step(0))) +
                    (delta < p.delta ? S(p.delta - delta) : S(delta - p.delta)) / c_red;
    if (is_physical(next) && next.cost < p.cost) {
      const bool gained = next.cost < p.cost * (S(1) - S(100) * epsilon<S>());
      p = next;
      r = new_r;
      j = new_j;
      damping = damping / S(10);
      converged = !(moved > tiny) || !gained;
    } else {
      damping = damping < tiny ? tiny : S(damping * S(10));
      // Even the shortest step leads uphill: converged.
      converged = !(moved > tiny) || damping > S(1) / tiny;
    }
  }
  return converged;
}

/// The lowest minimum found from a coarse grid over all fluids that a pad could hold. The descent
/// starts at the best c_red for each delta, because there can be several minima. Of minima equal up
/// to roundoff (four samples can have two exact solutions), that of the smallest delta is taken.
/// Needs no initial guess. The cost is NaN if no fluid is physical.
template <class Problem>
auto search_absorption(const Problem& problem, int max_iterations) {
  using std::exp;
  using S = typename Problem::Vector::Scalar;
  using Point = typename Problem::Point;
  Point best{};
  const S roundoff = square(S(S(1000) * epsilon<S>())) * problem.green_sq();
  for (int j = 0; j <= 8; ++j) {
    const S delta = S(j * j) / S(1000);  // 0 to 0.064 per mm
    Point start{};
    for (int i = 0; i <= 24; ++i) {
      const S c_red = S(exp(S(i) / S(4))) / S(1000);  // 0.001 to 0.4 per mm
      const Point p = problem.project(c_red, delta, nullptr, nullptr);
      if (is_physical(p) && !(start.cost < p.cost)) {
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

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
