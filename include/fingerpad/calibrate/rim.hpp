// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the rim from frames of the free pad: the stress-free lengths of its side dots and
// the membrane's mu t (shear modulus times thickness), for wrench.hpp. Source of the law:
// rim_traction.hpp; Ito, Kim, Obinata 2011 do not say how side dots are calibrated.
//
// The free pad as a whole is in balance: 2 pi a T_z = p pi a^2. The mean vertical pull of the rim
// is therefore p a / 2 for any shape. Let D_j = x_j - b_j (for two rows 2 L d), C_j its part across
// the rim, w_j its share of the rim and L_j = r_j L the stress-free length. By clamped_rim_pull the
// mean is
//   mu t (A / L - B L^3),   A = sum w_j D_jz / r_j,   B = sum w_j D_jz r_j^3 / |C_j|^4,
// linear in u = mu t / L and v = mu t L^3. Two pressures give both, with L = (v / u)^(1/4). The
// free pad is the same all around, so r_j, the share of dot j in L, is its length over the mean
// length.
//
// The free rim is not sheared, so it does not show how shear softens the rim of another rubber (m,
// rim_traction.hpp). The apex does, where the membrane is stretched in both directions: its height
// is that of an inflated cap of this rubber (calibrate/detail/inflated_cap.hpp). At 16 kPa,
// mu t = 0.5 N/mm and 11 mm of stress-free height it lies 0.19 mm lower for m = 1 than for m = 0.
// An error of 0.01 mm of the apex, or of 0.5 % of mu t, therefore changes m by 0.05 and M_z by
// 1.5 %.
//
// One pressure gives mu t for a known L. OneRow uses the chord as the derivative at the rim. For
// side dots of 0.8 mm on a rim of 18.7 mm, mu t is therefore 1.4 % too large and L 0.1 % too small;
// with the inclination the errors are 0.1 % and 0.03 % (finite elements, tests/calibrate/rim.cpp).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/calibrate/detail/inflated_cap.hpp"
#include "fingerpad/calibrate/detail/rim_balance.hpp"
#include "fingerpad/calibrate/detail/rim_frames.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/rim_traction.hpp"

namespace fingerpad {
inline namespace v0 {

/// Noise from which the standard errors follow. If dot and pressure noise are 0, the residual of 3
/// or more pressures is used.
struct RimFitOptions {
  double side_dot_noise_mm = 0;   ///< sd of each coordinate of a side dot in one frame, >= 0
  double pressure_noise_mpa = 0;  ///< sd of the pressure of a frame, >= 0
  double apex_noise_mm = 0;       ///< sd of the apex height of a frame, >= 0
  /// Apex height of the stress-free pad, a spherical cap. > 0: also fits m to the apex heights.
  double stress_free_height_mm = 0;
};

/// The rim of a pad. Usable as the lengths of `Wrench(border, fit, options)`: fit(k) is the length
/// of the k-th side dot.
template <scalar S = double>
struct [[nodiscard]] RimFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  S length_mm = S(0);                        ///< L, the mean stress-free length, mm
  S modulus_n_per_mm = S(0);                 ///< mu t
  std::vector<S> side_dot_share = {};        ///< r_j of each column of the border; mean about 1
  S mooney_share = S(0);      ///< m = C2 / (C1 + C2), for ClampedRim, clamped to [0, 1]; 0 if not
                              ///< fitted
  S mooney_share_sd = S(0);   ///< from apex_noise_mm and the standard error of mu t, if known
  S apex_residual_mm = S(0);  ///< of the apex heights, rms
  S length_sd_mm = S(0);      ///< standard errors; 0 for a given value, NaN if neither noise
  S modulus_sd_n_per_mm = S(0);  ///< nor residual is known
  S correlation = S(0);          ///< of the two; near 1: their errors compensate
  S condition = S(0);            ///< of the equations in relative changes of L and mu t
  S residual = S(0);             ///< of the vertical balance, rms, as a share of the mean p a / 2
  S share_scatter = S(0);       ///< sd of one level's lengths / mean length about r_j, due to noise
                                ///< of the dots; NaN for a single level
  std::vector<S> stretch = {};  ///< mean lambda at each level
  Index missing = 0;  ///< side dots not seen at some level; their r_j is from the other levels

  bool ok() const { return cause == nullptr; }
  S operator()(Index k) const { return S(length_mm * side_dot_share[static_cast<std::size_t>(k)]); }
};

/// Collects frames of the free pad at one or more pressures, then fits. `Row` as in Wrench. The
/// standard errors ignore that OneRow with an inclination depends on L and mu t.
template <class Row = OneRow, scalar S = double>
class RimCalibration {
 public:
  /// `border_mm` as for Wrench; refuses what Wrench would refuse (parameter_error).
  template <spatial_dot_grid Border>
  RimCalibration(const Border& border_mm, const S& base_radius_mm, const Row& row = {})
      : rim_(border_mm, base_radius_mm), row_(row) {
    expects_valid(row);
  }

  /// Adds a frame of the free pad to pressure level 0, 1, ... The frames of a level have about the
  /// same pressure and are averaged. A NaN dot was not found. False, and nothing added, if pressure
  /// or grid are not usable, or the level is neither an existing one nor the next. `apex_mm`:
  /// height of the pad's apex above the base; NaN: not measured.
  template <spatial_dot_grid Dots>
  bool add(std::size_t level,
           const Dots& side_dots_mm,
           const S& pressure_mpa,
           const S& apex_mm = not_a_number<S>()) {
    const auto dots = as_view(side_dots_mm);
    if (dots.rows() != Row::rows || dots.cols() != rim_.size() || level > levels_.size() ||
        !is_plausible(pressure_mpa) || !(value(pressure_mpa) > 0)) {
      return false;
    }
    if (level == levels_.size()) {
      levels_.emplace_back(Row::rows, rim_.size());
    }
    levels_[level].template add<Row>(dots, pressure_mpa, apex_mm);
    return true;
  }

  std::size_t levels() const { return levels_.size(); }

  /// Fits L and mu t to 2 or more pressures. Refuses (parameter_error) fewer or equal pressures,
  /// dots that are missing, do not stretch, or stretch alike at all pressures, and a pull that is
  /// not upward.
  RimFit<S> fit(const RimFitOptions& options = {}) const {
    using std::sqrt;
    check(options, 2);
    expects(distinct_pressures() >= 2, owner, "distinct pressures",
            static_cast<long long>(distinct_pressures()), ">= 2, more than a hundredth apart");
    Balance balance(rim_, levels_, row_);
    return settled(balance, options, true, [&] {
      const auto both = detail::membrane::both_of(balance.equations());
      expects(is_finite(both.condition) && as_double(both.condition) < 1e4, owner,
              "condition number", both.condition,
              "< 1e4: the side dots have to stretch more at the higher pressure");
      expects(value(both.u) > 0 && value(both.v) > 0, owner, "L^4 in mm^4", S(both.v / both.u),
              "> 0, with mu t > 0: check pressures and dots");
      const S length = sqrt(S(sqrt(S(both.v / both.u))));
      return Membrane{length, S(both.u * length)};
    });
  }

  /// Fits mu t for a known mean length L.
  RimFit<S> fit_modulus(const S& length_mm, const RimFitOptions& options = {}) const {
    check(options, 1);
    expects(is_finite(length_mm) && value(length_mm) > 0, owner, "length_mm", length_mm,
            "finite and > 0");
    Balance balance(rim_, levels_, row_);
    return settled(balance, options, false, [&] {
      return Membrane{length_mm, detail::membrane::modulus_of(length_mm, balance.equations())};
    });
  }

 private:
  using Balance = detail::membrane::FreeRimBalance<Row, S>;
  static constexpr const char* owner = "RimCalibration";

  static double as_double(const S& x) { return static_cast<double>(value(x)); }

  void check(const RimFitOptions& options, long long min_levels) const {
    const char* const of_options = "RimFitOptions";
    const auto noise = [&](double sd, const char* name) {
      expects(is_finite(sd) && sd >= 0, of_options, name, sd, "finite and >= 0");
    };
    noise(options.side_dot_noise_mm, "side_dot_noise_mm");
    noise(options.pressure_noise_mpa, "pressure_noise_mpa");
    noise(options.apex_noise_mm, "apex_noise_mm");
    const double height = options.stress_free_height_mm;
    expects(is_finite(height) && height >= 0 && height <= 2 * as_double(rim_.radius_mm()),
            of_options, "stress_free_height_mm", height,
            "in [0, 2 base_radius_mm]; 0 if m is not fitted");
    expects(!(height > 0) || apexes() > 0, owner, "levels with an apex height",
            static_cast<long long>(apexes()), ">= 1 if m is fitted");
    expects(static_cast<long long>(levels_.size()) >= min_levels, owner, "levels of pressure",
            static_cast<long long>(levels_.size()),
            min_levels > 1 ? ">= 2 (with one use fit_modulus)" : ">= 1");
    const Index seen = detail::membrane::seen_in_all(rim_, levels_);
    expects(3 * seen >= 2 * rim_.size(), owner, "side dots found at every level",
            static_cast<long long>(seen), ">= 2/3 of the border points");
    const Index ever = detail::membrane::seen_in_any(rim_, levels_);
    expects(ever == rim_.size(), owner, "side dots found at any level",
            static_cast<long long>(ever),
            "all of the border points: leave the others out of the border");
  }

  Index distinct_pressures() const {
    Index distinct = 0;
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      bool is_new = true;
      for (std::size_t before = 0; before < k; ++before) {
        const double ratio = as_double(levels_[k].pressure_mpa / levels_[before].pressure_mpa);
        is_new = is_new && std::abs(std::log(ratio)) > 0.01;
      }
      distinct += is_new ? 1 : 0;
    }
    return distinct;
  }

  Index apexes() const {
    Index count = 0;
    for (const auto& level : levels_) {
      count += level.apex_frames > 0 ? 1 : 0;
    }
    return count;
  }

  struct Membrane {
    S length;
    S modulus;
    S mooney_share = S(0);
  };

  /// Sums over the levels for the fit of m; miss = measured less modelled apex height.
  struct ApexSums {
    S miss_sq = S(0);
    S slope_miss = S(0);  ///< slope: of the height by m
    S slope_sq = S(0);
    S slope_modulus = S(0);  ///< times the slope by ln(mu t)
    S slope_frames = S(0);   ///< squared slope / number of frames
  };
  ApexSums apex_sums(const RimFitOptions& options, const S& modulus, const S& m) const {
    const S step = S(1) / S(100);
    const auto cap = [&](const S& share) {
      return detail::membrane::InflatedCap<S>(rim_.radius_mm(), S(options.stress_free_height_mm),
                                              share);
    };
    ApexSums sums;
    for (const auto& level : levels_) {
      if (level.apex_frames > 0) {
        const S load = level.pressure_mpa / modulus;
        const S height = cap(m).apex_mm(load);
        const S slope = (cap(S(m + step)).apex_mm(load) - height) / step;
        const S by_modulus = (cap(m).apex_mm(S(load * (S(1) - step))) - height) / step;
        const S miss = level.apex_mm - height;
        sums.miss_sq = sums.miss_sq + square(miss);
        sums.slope_miss = sums.slope_miss + slope * miss;
        sums.slope_sq = sums.slope_sq + square(slope);
        sums.slope_modulus = sums.slope_modulus + slope * by_modulus;
        sums.slope_frames = sums.slope_frames + square(slope) / S(level.apex_frames);
      }
    }
    expects(is_finite(sums.slope_sq) && value(sums.slope_sq) > 0, owner, "load on the pad", modulus,
            "that of an inflated cap: check pressure and height");
    return sums;
  }

  /// One Gauss-Newton step toward m, clamped to [0, 1].
  S next_share(const RimFitOptions& options, const Membrane& found) const {
    const ApexSums sums = apex_sums(options, found.modulus, found.mooney_share);
    const S m = found.mooney_share + sums.slope_miss / sums.slope_sq;
    return m < S(0) ? S(0) : (S(1) < m ? S(1) : m);
  }

  /// Solves. Repeats until it converges if the reading of the dots depends on the solution.
  template <class Solve>
  RimFit<S> settled(Balance& balance,
                    const RimFitOptions& options,
                    bool length_found,
                    const Solve& solve) const {
    Membrane found = solve();
    S change = S(0);
    // float cannot reach 1e-10
    const double least = (std::max)(1e-10, 1e4 * static_cast<double>(epsilon<S>()));
    const bool asks_rubber = options.stress_free_height_mm > 0;
    if (row_.needs_modulus() || asks_rubber) {
      change = S(1);
      for (int round = 0; round < 200 && as_double(change) > least; ++round) {
        balance.correct(found.length, found.modulus, found.mooney_share);
        Membrane next = solve();
        next.mooney_share = found.mooney_share;
        if (asks_rubber) {
          next.mooney_share = next_share(options, next);
        }
        const S longer = next.length / found.length - S(1);
        const S stiffer = next.modulus / found.modulus - S(1);
        change = norm(Point3<S>{longer, stiffer, S(next.mooney_share - found.mooney_share)});
        found = next;
      }
      expects(as_double(change) <= least, owner, "change of the last round", change,
              "<= 1e-10, 1e-3 in float");
    }
    return finished(balance, found, length_found, options);
  }

  RimFit<S> finished(const Balance& balance,
                     const Membrane& found,
                     bool length_found,
                     const RimFitOptions& options) const {
    const S &length = found.length, &modulus = found.modulus;
    RimFit<S> fit;
    fit.length_mm = length;
    fit.modulus_n_per_mm = modulus;
    fit.side_dot_share = balance.shares();
    fit.share_scatter = balance.share_scatter();
    fit.missing = rim_.size() - detail::membrane::seen_in_all(rim_, levels_);
    fit.cause = nullptr;
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      const S lambda = balance.stretch(k, length);
      fit.stretch.push_back(lambda);
      expects(as_double(lambda) >= 1.005, owner, "stretch of the side dots", lambda,
              ">= 1.005 at all pressures");
      if (as_double(levels_[k].pressure_mpa) > 0.2) {
        fit.cause = "a pressure exceeds 0.2: give it in MPa above the pressure around the pad";
      }
    }
    expects(is_finite(modulus) && value(modulus) > 0, owner, "membrane modulus", modulus, "> 0");
    fit.residual = balance.residual(length, modulus);
    if (fit.cause == nullptr && as_double(fit.residual) > 0.1) {
      fit.cause =
          "pressure and pull of the rim do not balance: check that "
          "the pressures are of the same frames and tared";
    }
    const auto errors = balance.errors(length, modulus, length_found, S(options.side_dot_noise_mm),
                                       S(options.pressure_noise_mpa));
    fit.length_sd_mm = errors.length_sd_mm;
    fit.modulus_sd_n_per_mm = errors.modulus_sd_n_per_mm;
    fit.correlation = errors.correlation;
    if (options.stress_free_height_mm > 0) {
      tell_rubber(options, found.mooney_share, fit);
    }
    fit.condition = errors.condition;
    return fit;
  }

  void tell_rubber(const RimFitOptions& options, const S& mooney_share, RimFit<S>& fit) const {
    using std::sqrt;
    const ApexSums sums = apex_sums(options, fit.modulus_n_per_mm, mooney_share);
    fit.mooney_share = mooney_share;
    fit.apex_residual_mm = sqrt(S(sums.miss_sq / S(static_cast<double>(apexes()))));
    const S stiffer = fit.modulus_sd_n_per_mm / fit.modulus_n_per_mm;
    const S by_modulus =
        is_finite(stiffer) ? S(sums.slope_modulus / sums.slope_sq * stiffer) : S(0);
    const S by_apex = S(options.apex_noise_mm) * sqrt(sums.slope_frames) / sums.slope_sq;
    fit.mooney_share_sd = sqrt(S(square(by_modulus) + square(by_apex)));
  }

  detail::membrane::CalibratedRim<S> rim_;
  Row row_;
  std::vector<detail::membrane::RimLevel<S>> levels_;
};

}  // namespace v0
}  // namespace fingerpad
