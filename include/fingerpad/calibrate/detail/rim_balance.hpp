// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Equations of the vertical balance of the free pad from its side dots,
// mu t (A / L - B L^3) = p a / 2, their solution and its errors. See calibrate/rim.hpp.
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/calibrate/detail/rim_frames.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/rim_traction.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// The equation of a pressure level.
template <scalar S>
struct RimEquation {
  S a;
  S b;
  S pull;  ///< p a / 2, N/mm
  /// Mean pull for mu t = 1.
  S mean_pull(const S& length) const { return S(a / length - b * length * length * length); }
};

/// Condition number of two columns scaled to length 1: the root of the ratio of the eigenvalues of
/// [aa ab; ab bb].
template <scalar S>
S condition_of(const S& aa, const S& ab, const S& bb) {
  using std::sqrt;
  const S cosine_sq = ab * ab / (aa * bb);
  const S cosine = sqrt(cosine_sq);
  return S(sqrt(S((S(1) + cosine) / (S(1) - cosine))));
}

/// Solution for both unknowns.
template <scalar S>
struct RimUnknowns {
  S u;  ///< mu t / L
  S v;  ///< mu t L^3
  S condition;
};

/// Both unknowns by least squares, with equal weights of all levels.
template <scalar S>
RimUnknowns<S> both_of(const std::vector<RimEquation<S>>& equations) {
  S aa = S(0), ab = S(0), bb = S(0), ap = S(0), bp = S(0);
  for (const RimEquation<S>& e : equations) {
    aa = aa + e.a * e.a;
    ab = ab + e.a * e.b;
    bb = bb + e.b * e.b;
    ap = ap + e.a * e.pull;
    bp = bp + e.b * e.pull;
  }
  const S determinant = aa * bb - ab * ab;
  return {S((ap * bb - bp * ab) / determinant), S((ap * ab - bp * aa) / determinant),
          condition_of(aa, ab, bb)};
}

/// mu t for a given L.
template <scalar S>
S modulus_of(const S& length, const std::vector<RimEquation<S>>& equations) {
  S gp = S(0), gg = S(0);
  for (const RimEquation<S>& e : equations) {
    const S g = e.mean_pull(length);
    gp = gp + g * e.pull;
    gg = gg + g * g;
  }
  return S(gp / gg);
}

/// The rim at all pressure levels. Rim, levels and row must outlive it.
template <class Row, scalar S>
class FreeRimBalance {
 public:
  using Levels = std::vector<RimLevel<S>>;
  FreeRimBalance(const CalibratedRim<S>& rim, const Levels& levels, const Row& row)
      : rim_(rim), levels_(levels), row_(row), lever_mm_(levels.size()), equations_(levels.size()) {
    shares_.assign(static_cast<std::size_t>(rim.size()), S(1));
    take_levers(S(1), S(0));
    find_shares();
    set_equations();
  }

  /// Recomputes D from the dots for this L, mu t and rubber.
  void correct(const S& length, const S& modulus, const S& mooney_share) {
    mooney_share_ = mooney_share;
    take_levers(length, modulus);
    set_equations();
  }

  const std::vector<S>& shares() const { return shares_; }
  const std::vector<RimEquation<S>>& equations() const { return equations_; }

  /// sd of the relative lengths of one level about their means; NaN for a single level.
  S share_scatter() const {
    using std::sqrt;
    S squares = S(0);
    int count = 0, means = 0;
    for (std::size_t j = 0; j < shares_.size(); ++j) {
      int seen = 0;
      for (std::size_t k = 0; k < levels_.size(); ++k) {
        if (levels_[k].sees(j)) {
          squares = squares + square(S(relative_length(k, j) - shares_[j]));
          ++seen;
        }
      }
      count += seen;
      means += seen > 0 ? 1 : 0;
    }
    return count > means ? S(sqrt(S(squares / S(count - means)))) : not_a_number<S>();
  }

  /// Mean lambda of a level.
  S stretch(std::size_t level, const S& length) const {
    using std::sqrt;
    S sum = S(0), weights = S(0);
    for (std::size_t j = 0; j < shares_.size(); ++j) {
      if (levels_[level].sees(j)) {
        const S across = sqrt(across_sq(lever_mm_[level][j], j));
        sum = sum + rim_[j].weight * across / (length * shares_[j]);
        weights = weights + rim_[j].weight;
      }
    }
    return S(sum / weights);
  }

  /// Residual of the balance, rms over the levels, as a share of their mean p a / 2.
  S residual(const S& length, const S& modulus) const {
    using std::sqrt;
    S squares = S(0), pulls = S(0);
    for (const RimEquation<S>& e : equations_) {
      squares = squares + square(S(modulus * e.mean_pull(length) - e.pull));
      pulls = pulls + e.pull;
    }
    const S count = S(static_cast<double>(equations_.size()));
    return S(sqrt(S(squares / count)) * count / pulls);
  }

  struct Errors {
    S length_sd_mm;
    S modulus_sd_n_per_mm;
    S correlation;
    S condition;
  };
  /// First-order standard errors of the fitted values, from the given noise or, without noise, from
  /// the residual.
  Errors errors(const S& length,
                const S& modulus,
                bool length_found,
                const S& dot_noise,
                const S& pressure_noise) const {
    using std::sqrt;
    // Jacobian by ln L and ln mu t; the column of a given L is 0
    S ll = S(0), lm = S(0), mm = S(0);
    S vl = S(0), vlm = S(0), vm = S(0);  // J^T V J
    const bool noisy = value(dot_noise) > 0 || value(pressure_noise) > 0;
    const int free_levels = static_cast<int>(levels_.size()) - (length_found ? 2 : 1);
    S squares = S(0);
    for (const RimEquation<S>& e : equations_) {
      squares = squares + square(S(modulus * e.mean_pull(length) - e.pull));
    }
    const S by_residual = free_levels > 0 ? S(squares / S(free_levels)) : not_a_number<S>();
    for (std::size_t k = 0; k < equations_.size(); ++k) {
      const RimEquation<S>& e = equations_[k];
      const S l = length_found
                      ? S(-modulus * (e.a / length + S(3) * e.b * length * length * length))
                      : S(0);
      const S m = modulus * e.mean_pull(length);
      const S v = noisy ? variance(k, length, modulus, dot_noise, pressure_noise) : by_residual;
      ll = ll + l * l;
      lm = lm + l * m;
      mm = mm + m * m;
      vl = vl + v * l * l;
      vlm = vlm + v * l * m;
      vm = vm + v * m * m;
    }
    const S zero = S(0), one = S(1);
    if (!length_found) {
      return {zero, S(modulus * sqrt(vm) / mm), zero, one};
    }
    const S determinant = ll * mm - lm * lm;
    // rows of (J^T J)^-1
    const S p = mm / determinant, q = -lm / determinant, r = ll / determinant;
    const S var_l = p * p * vl + S(2) * p * q * vlm + q * q * vm;
    const S var_m = q * q * vl + S(2) * q * r * vlm + r * r * vm;
    const S both = p * q * vl + (p * r + q * q) * vlm + q * r * vm;
    return {S(length * sqrt(var_l)), S(modulus * sqrt(var_m)), S(both / sqrt(S(var_l * var_m))),
            condition_of<S>(ll, lm, mm)};
  }

 private:
  /// |C|^2, where C is the part of D across the rim.
  S across_sq(const Point3<S>& lever, std::size_t column) const {
    return S(squared_norm(lever) - square(dot(lever, rim_[column].tangent)));
  }

  /// Length of a dot over the mean length of the dots seen at every level.
  S relative_length(std::size_t level, std::size_t column) const {
    using std::sqrt;
    return S(sqrt(across_sq(lever_mm_[level][column], column)) / mean_length_[level]);
  }

  /// Computes D of every dot seen, under the load p / (mu t); without load if mu t is not > 0.
  void take_levers(const S& length, const S& modulus) {
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      const RimLevel<S>& level = levels_[k];
      const S load = value(modulus) > 0 ? S(level.pressure_mpa / modulus) : S(0);
      lever_mm_[k].assign(shares_.size(), missing_point<S>());
      for (std::size_t j = 0; j < shares_.size(); ++j) {
        if (level.sees(j)) {
          const S dot_length = length * shares_[j];
          const RimPoint<S> point{rim_[j].border, rim_[j].tangent, dot_length, rim_.radius_mm()};
          const Point3<S>* dots = &level.dot_mm[j * static_cast<std::size_t>(Row::rows)];
          lever_mm_[k][j] = dot_length * row_.along(point, dots, load, mooney_share_);
        }
      }
    }
  }

  void find_shares() {
    using std::sqrt;
    std::vector<bool> in_all(shares_.size(), true);
    for (std::size_t j = 0; j < shares_.size(); ++j) {
      for (const RimLevel<S>& level : levels_) {
        in_all[j] = in_all[j] && level.sees(j);
      }
    }
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      S sum = S(0), weights = S(0);
      for (std::size_t j = 0; j < shares_.size(); ++j) {
        if (in_all[j]) {
          sum = sum + rim_[j].weight * sqrt(across_sq(lever_mm_[k][j], j));
          weights = weights + rim_[j].weight;
        }
      }
      mean_length_.push_back(S(sum / weights));
    }
    for (std::size_t j = 0; j < shares_.size(); ++j) {
      S sum = S(0);
      int seen = 0;
      for (std::size_t k = 0; k < levels_.size(); ++k) {
        if (levels_[k].sees(j)) {
          sum = sum + relative_length(k, j);
          ++seen;
        }
      }
      shares_[j] = S(sum / S(seen));
    }
  }

  void set_equations() {
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      RimEquation<S> e{S(0), S(0), S(levels_[k].pressure_mpa * rim_.radius_mm() / S(2))};
      S weights = S(0);
      for (std::size_t j = 0; j < shares_.size(); ++j) {
        if (levels_[k].sees(j)) {
          const S& share = shares_[j];
          const Point3<S>& lever = lever_mm_[k][j];
          const S lift = rim_[j].weight * lever.z;
          e.a = e.a + lift / share;
          e.b = e.b + lift * share * share * share / square(across_sq(lever, j));
          weights = weights + rim_[j].weight;
        }
      }
      equations_[k] = {S(e.a / weights), S(e.b / weights), e.pull};
    }
  }

  /// Variance of the balance of a level, from the noise of the dots and the pressure of a frame.
  S variance(std::size_t k,
             const S& length,
             const S& modulus,
             const S& dot_noise,
             const S& pressure_noise) const {
    const RimLevel<S>& level = levels_[k];
    const ClampedRim law{};
    S sum = S(0), weights = S(0);
    for (std::size_t j = 0; j < shares_.size(); ++j) {
      if (!level.sees(j)) {
        continue;
      }
      const S dot_length = length * shares_[j];
      const Point3<S> along = S(S(1) / dot_length) * lever_mm_[k][j];
      S gain = S(0);
      for (const Point3<S>& axis : {Point3<S>{S(1), S(0), S(0)}, Point3<S>{S(0), S(1), S(0)},
                                    Point3<S>{S(0), S(0), S(1)}}) {
        gain = gain + square(law.change_of_pull(along, rim_[j].tangent, axis).z);
      }
      sum = sum + square(rim_[j].weight) * gain / (square(dot_length) * S(level.count[j]));
      weights = weights + rim_[j].weight;
    }
    const S dots = square(S(modulus * dot_noise * S(Row::noise_gain))) * sum / square(weights);
    const S pressure = square(S(pressure_noise * rim_.radius_mm() / S(2))) / S(level.frames);
    return S(dots + pressure);
  }

  const CalibratedRim<S>& rim_;
  const Levels& levels_;
  const Row& row_;
  S mooney_share_ = S(0);
  std::vector<std::vector<Point3<S>>> lever_mm_;  ///< D: d times the stress-free length
  std::vector<S> mean_length_;
  std::vector<S> shares_;
  std::vector<RimEquation<S>> equations_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
