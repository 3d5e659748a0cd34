// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the rim from frames of the free pad: the stress-free lengths of its side dots and
// the membrane's mu t (shear modulus times thickness), for wrench.hpp. Ito, Kim, Obinata 2011 do
// not say how side dots are calibrated.
//
// The free pad as a whole is in balance: 2 pi a T_z = p pi a^2. The mean vertical pull of the rim,
// as wrench.hpp finds it from the side dots, is therefore p a / 2 for any shape. Two pressures give
// both L and mu t, one pressure mu t for a known L. The free pad is the same all around, so r_j,
// the share of dot j in L, is its length over the mean length.
//
// The free rim is not sheared, so it does not show how shear softens the rim of another rubber (m).
// The apex does, where the membrane is stretched in both directions: its height is that of an
// inflated cap of this rubber (membrane/free_pad.hpp). At 16 kPa, mu t = 0.5 N/mm and
// 11 mm of stress-free height it lies 0.19 mm lower for m = 1 than for m = 0. An error of 0.01 mm
// of the apex, or of 0.5 % of mu t, therefore changes m by 0.05 and M_z by 1.5 %.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/rim_pull.hpp"
#include "fingerpad/membrane/free_pad.hpp"

namespace fingerpad {
inline namespace v0 {

/// Noise from which the standard errors follow. If dot and pressure noise are 0, the residual of 3
/// or more pressures is used.
struct RimFitOptions {
  double side_dot_noise_mm = 0;   ///< sd of each coordinate of a side dot in one frame, >= 0
  double pressure_noise_mpa = 0;  ///< sd of the pressure of a frame, >= 0
  double apex_noise_mm = 0;       ///< sd of the apex height of a frame, >= 0
  /// Apex height of the stress-free pad, a spherical cap, >= 0. > 0: also fits m to the apexes.
  double stress_free_height_mm = 0;
};

/// The refusal of the first value that is out of range; "" if all are good.
inline std::string check(const RimFitOptions& o) {
  return check("RimFitOptions", {{"side_dot_noise_mm", o.side_dot_noise_mm, not_negative},
                                 {"pressure_noise_mpa", o.pressure_noise_mpa, not_negative},
                                 {"apex_noise_mm", o.apex_noise_mm, not_negative},
                                 {"stress_free_height_mm", o.stress_free_height_mm, not_negative}});
}

/// The rim of a pad. Usable as the lengths of `Wrench(border, fit, options)`: fit(k) is the length
/// of the k-th side dot.
template <scalar S = double>
struct [[nodiscard]] RimFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  S length_mm = S(0);                        ///< L, the mean stress-free length, mm
  S modulus_n_per_mm = S(0);                 ///< mu t
  std::vector<S> side_dot_share = {};        ///< r_j of each column of the border; mean about 1
  S mooney_share = S(0);         ///< m = C2 / (C1 + C2), clamped to [0, 1]; 0 if not fitted
  S mooney_share_sd = S(0);      ///< from apex_noise_mm and the standard error of mu t, if known
  S apex_residual_mm = S(0);     ///< of the apex heights, rms
  S length_sd_mm = S(0);         ///< standard errors; 0 for a given value, NaN if neither noise
  S modulus_sd_n_per_mm = S(0);  ///< nor residual is known
  S correlation = S(0);          ///< of the two; near 1: their errors compensate
  S residual = S(0);             ///< of the vertical balance, rms, as a share of the mean p a / 2
  S share_scatter = S(0);  ///< sd of one level's lengths / mean length about r_j, due to noise of
                           ///< the dots; NaN for a single level

  bool ok() const { return cause == nullptr; }
  S operator()(Index k) const { return length_mm * side_dot_share[static_cast<std::size_t>(k)]; }
};

/// Collects frames of the free pad at one or more pressures, then fits.
template <scalar S = double>
class RimCalibration {
 public:
  /// `border_mm` and the inclination as for Wrench; refuses what Wrench would (parameter_error).
  template <spatial_dot_grid Border>
  RimCalibration(const Border& border_mm,
                 const S& base_radius_mm,
                 const std::optional<double>& stress_free_inclination_rad = {})
      : inclination_((require(owner,
                              {{"base_radius_mm", base_radius_mm, positive},
                               {"stress_free_inclination_rad",
                                stress_free_inclination_rad.value_or(0), within(0, 1.5707964)}}),
                      stress_free_inclination_rad)),
        rim_(
            owner, border_mm, [](Index) { return S(1); }, base_radius_mm) {}

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
    const std::size_t n = rim_.size();
    if (dots.rows() != 1 || dots.cols() != static_cast<Index>(n) || level > levels_.size() ||
        !is_plausible(pressure_mpa) || !(value(pressure_mpa) > 0)) {
      return false;
    }
    if (level == levels_.size()) {
      levels_.push_back({std::vector<Point3<S>>(n, {S(0), S(0), S(0)}), std::vector<int>(n, 0)});
    }
    Level& at = levels_[level];
    const auto average = [](auto& mean, const auto& next, int& count) {
      ++count;
      mean = mean + (next - mean) / S(count);
    };
    average(at.pressure_mpa, pressure_mpa, at.frames);
    if (is_plausible(apex_mm)) {
      average(at.apex_mm, apex_mm, at.apex_frames);
    }
    for (std::size_t k = 0; k < n; ++k) {
      const auto dot = detail::spatial_dot<S>(dots(0, rim_.column(k)));
      if (is_plausible(dot)) {
        average(at.dots_mm[k], dot, at.seen[k]);
      }
    }
    return true;
  }

  std::size_t levels() const { return levels_.size(); }

  /// Fits L and mu t to 2 or more pressures. Refuses (parameter_error) fewer or equal pressures,
  /// dots that are missing, do not stretch, or stretch alike at all pressures, and a pull that is
  /// not upward.
  RimFit<S> fit(const RimFitOptions& options = {}) const {
    check_levels(options, 2);
    int distinct = 0;
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      bool is_new = true;
      for (std::size_t before = 0; before < k; ++before) {
        const double ratio = as_double(levels_[k].pressure_mpa / levels_[before].pressure_mpa);
        is_new = is_new && std::abs(std::log(ratio)) > 0.01;
      }
      distinct += is_new ? 1 : 0;
    }
    expects(distinct >= 2, owner, "distinct pressures", distinct,
            ">= 2, more than a hundredth apart");
    return solved({}, options);
  }

  /// Fits mu t for a known mean length L.
  RimFit<S> fit_modulus(const S& length_mm, const RimFitOptions& options = {}) const {
    check_levels(options, 1);
    require(owner, {{"length_mm", length_mm, positive}});
    return solved(length_mm, options);
  }

 private:
  static constexpr const char* owner = "RimCalibration";

  /// Means over the frames of one pressure; dots in the order of the rim.
  struct Level {
    std::vector<Point3<S>> dots_mm;
    std::vector<int> seen;  ///< frames with the dot
    S pressure_mpa = S(0), apex_mm = S(0);
    int frames = 0, apex_frames = 0;
  };
  struct Membrane {
    S length, modulus, mooney_share = S(0);
  };
  static double as_double(const S& x) { return static_cast<double>(value(x)); }

  void check_levels(const RimFitOptions& options, int min_levels) const {
    require(options);
    int apexes = 0;
    for (const Level& level : levels_) {
      apexes += level.apex_frames > 0 ? 1 : 0;
    }
    expects(options.stress_free_height_mm <= 2 * as_double(rim_.radius_mm()), "RimFitOptions",
            "stress_free_height_mm", options.stress_free_height_mm, "in [0, 2 base_radius_mm]");
    expects(!(options.stress_free_height_mm > 0) || apexes > 0, owner, "levels with an apex height",
            apexes, ">= 1 if m is fitted");
    expects(static_cast<int>(levels_.size()) >= min_levels, owner, "levels of pressure",
            static_cast<int>(levels_.size()),
            min_levels > 1 ? ">= 2 (with one use fit_modulus)" : ">= 1");
    std::size_t in_all = 0, in_any = 0;
    for (std::size_t k = 0; k < rim_.size(); ++k) {
      std::size_t levels = 0;
      for (const Level& level : levels_) {
        levels += level.seen[k] > 0 ? 1U : 0U;
      }
      in_all += levels == levels_.size() ? 1U : 0U;
      in_any += levels > 0 ? 1U : 0U;
    }
    expects(3 * in_all >= 2 * rim_.size(), owner, "side dots found at every level", in_all,
            ">= 2/3 of the border points");
    expects(in_any == rim_.size(), owner, "side dots found at any level", in_any,
            "all of the border points: leave the others out of the border");
  }

  /// Length from the rim to a dot across the rim.
  S reach_mm(const Level& level, std::size_t k) const {
    const Point3<S> chord = level.dots_mm[k] - rim_.border(k);
    using std::sqrt;
    return sqrt(squared_norm(chord) - square(dot(chord, rim_.tangent(k))));
  }

  /// r_j in the order of the rim, their scatter, and the mean length of each level.
  std::vector<S> shares_of(S& scatter, std::vector<S>& mean_mm) const {
    using std::sqrt;
    const std::size_t n = rim_.size();
    for (const Level& level : levels_) {
      S sum = S(0), weights = S(0);
      for (std::size_t k = 0; k < n; ++k) {
        const bool in_all = std::all_of(levels_.begin(), levels_.end(),
                                        [k](const Level& other) { return other.seen[k] > 0; });
        sum += in_all ? rim_.gap_rad(k) * reach_mm(level, k) : S(0);
        weights += in_all ? rim_.gap_rad(k) : S(0);
      }
      mean_mm.push_back(sum / weights);
    }
    std::vector<S> shares(n, S(0));
    S squares = S(0);
    int free = -static_cast<int>(n);
    for (std::size_t k = 0; k < n; ++k) {
      S square_sum = S(0);
      int seen = 0;
      for (std::size_t i = 0; i < levels_.size(); ++i) {
        if (levels_[i].seen[k] > 0) {
          const S share = reach_mm(levels_[i], k) / mean_mm[i], off = share - shares[k];
          ++seen;
          shares[k] += off / S(seen);
          square_sum += off * (share - shares[k]);
        }
      }
      squares += square_sum;
      free += seen;
    }
    scatter = free > 0 ? sqrt(squares / S(free)) : not_a_number<S>();
    return shares;
  }

  /// mu t pull - p a / 2 of a level, N/mm, in `rim`.
  S imbalance(const Level& level,
              const Membrane& found,
              const std::vector<S>& shares,
              detail::membrane::Rim<S>& rim) const {
    for (std::size_t k = 0; k < rim.size(); ++k) {
      rim.set_length(k, found.length * shares[k]);
    }
    rim.set_chords([&](std::size_t k) {
      return level.seen[k] > 0 ? level.dots_mm[k] - rim.border(k) : detail::missing_point<S>();
    });
    rim.find_pulls(inclination_, found.mooney_share, level.pressure_mpa / found.modulus);
    S sum = S(0), weights = S(0);
    for (std::size_t k = 0; k < rim.size(); ++k) {
      sum += level.seen[k] > 0 ? rim.gap_rad(k) * rim.pull(k).z : S(0);
      weights += level.seen[k] > 0 ? rim.gap_rad(k) : S(0);
    }
    return found.modulus * sum / weights - level.pressure_mpa * rim_.radius_mm() / S(2);
  }

  /// Sums of the equations of all levels: of the derivatives by ln L (l) and ln(mu t) (m), of the
  /// imbalance (f), and each product weighed with the level's variance (v).
  struct Sums {
    S ll = S(0), lm = S(0), mm = S(0), lf = S(0), mf = S(0), ff = S(0), pull = S(0);
    S vll = S(0), vlm = S(0), vmm = S(0);
  };
  template <class VarianceOf>
  Sums sums_of(const Membrane& found,
               bool length_found,
               const std::vector<S>& shares,
               detail::membrane::Rim<S>& rim,
               const VarianceOf& variance_of) const {
    Sums sums;
    const S h = S(std::cbrt(static_cast<double>(epsilon<S>())));
    for (const Level& level : levels_) {
      const auto slope = [&](Membrane more, Membrane less) {
        return (imbalance(level, more, shares, rim) - imbalance(level, less, shares, rim)) /
               (S(2) * h);
      };
      Membrane more = found, less = found;
      more.length = found.length * (S(1) + h);
      less.length = found.length * (S(1) - h);
      const S l = length_found ? slope(more, less) : S(0);
      more = less = found;
      more.modulus = found.modulus * (S(1) + h);
      less.modulus = found.modulus * (S(1) - h);
      const S m = slope(more, less), f = imbalance(level, found, shares, rim);
      const S v = variance_of(level);
      sums.ll += l * l;
      sums.lm += l * m;
      sums.mm += m * m;
      sums.lf += l * f;
      sums.mf += m * f;
      sums.ff += f * f;
      sums.pull += level.pressure_mpa * rim_.radius_mm() / S(2);
      sums.vll += v * l * l;
      sums.vlm += v * l * m;
      sums.vmm += v * m * m;
    }
    return sums;
  }

  /// Gauss-Newton in ln L (unless it is given) and ln(mu t), and in m if it is asked for.
  RimFit<S> solved(const std::optional<S>& given_mm, const RimFitOptions& options) const {
    using std::exp;
    using std::sqrt;
    RimFit<S> fit;
    std::vector<S> mean_mm;
    const std::vector<S> shares = shares_of(fit.share_scatter, mean_mm);
    const S least_mm = *std::min_element(mean_mm.begin(), mean_mm.end());
    const bool length_found = !given_mm, asks_rubber = options.stress_free_height_mm > 0;
    const auto check_stretch = [&](const S& length) {
      expects(as_double(least_mm / length) >= 1.005, owner, "stretch of the side dots",
              S(least_mm / length), ">= 1.005 at all pressures");
    };
    if (given_mm) {
      check_stretch(*given_mm);
    }
    detail::membrane::Rim<S> rim = rim_;
    // a stiff membrane is not deformed by the load; then the pull is that of the chords
    Membrane found = {given_mm.value_or(least_mm / S(1.1)), S(1e9)};
    S pulls = S(0), wanted = S(0);
    for (const Level& level : levels_) {
      const S half = level.pressure_mpa * rim_.radius_mm() / S(2);
      pulls += (imbalance(level, found, shares, rim) + half) / found.modulus;
      wanted += half;
    }
    found.modulus = wanted / pulls;
    expects(is_finite(found.modulus) && value(found.modulus) > 0, owner, "membrane modulus",
            found.modulus, "> 0");
    const auto alike = [](const Level&) { return S(1); };
    const double least =
        (std::max)(asks_rubber ? 1e-10 : 0.0, 1e4 * static_cast<double>(epsilon<S>()));
    S change = S(1);
    for (int round = 0; round < 200 && as_double(change) > least; ++round) {
      const Sums s = sums_of(found, length_found, shares, rim, alike);
      S longer = S(0), stiffer = -s.mf / s.mm;
      if (length_found) {
        const S cosine = sqrt(square(s.lm) / (s.ll * s.mm));
        const S condition = sqrt((S(1) + cosine) / (S(1) - cosine));
        expects(is_finite(condition) && as_double(condition) < 1e4, owner, "condition number",
                condition,
                "< 1e4: the side dots have to stretch more at the higher pressure; check "
                "pressures and dots");
        const S determinant = s.ll * s.mm - s.lm * s.lm;
        longer = (s.mf * s.lm - s.lf * s.mm) / determinant;
        stiffer = (s.lf * s.lm - s.mf * s.ll) / determinant;
      }
      const S size = norm(Point2<S>{longer, stiffer});
      const S share = size > S(0.3) ? S(0.3) / size : S(1);  // a cautious step
      const Membrane next = {found.length * exp(share * longer),
                             found.modulus * exp(share * stiffer),
                             asks_rubber ? next_share(options, found) : S(0)};
      change = norm(Point2<S>{size, next.mooney_share - found.mooney_share});
      found = next;
      expects(is_finite(found.modulus) && is_finite(found.length), owner, "membrane modulus",
              found.modulus, "> 0");
    }
    expects(as_double(change) <= least, owner, "change of the last round", change,
            "<= 1e-10, 1e-3 in float");
    check_stretch(found.length);

    const bool noisy = options.side_dot_noise_mm > 0 || options.pressure_noise_mpa > 0;
    const int free_levels = static_cast<int>(levels_.size()) - (length_found ? 2 : 1);
    const S squares = sums_of(found, length_found, shares, rim, alike).ff;
    const S by_residual = free_levels > 0 ? squares / S(free_levels) : not_a_number<S>();
    const Sums s = sums_of(found, length_found, shares, rim, [&](const Level& level) {
      return noisy ? variance(level, found, shares, options) : by_residual;
    });
    fit.length_mm = found.length;
    fit.modulus_n_per_mm = found.modulus;
    fit.side_dot_share.resize(shares.size());
    for (std::size_t k = 0; k < shares.size(); ++k) {
      fit.side_dot_share[static_cast<std::size_t>(rim_.column(k))] = shares[k];
    }
    const S count = S(static_cast<double>(levels_.size()));
    fit.residual = sqrt(s.ff / count) * count / s.pull;
    if (!length_found) {
      fit.modulus_sd_n_per_mm = found.modulus * sqrt(s.vmm) / s.mm;
    } else {  // of (J^T J)^-1 J^T V J (J^T J)^-1
      const S determinant = s.ll * s.mm - s.lm * s.lm;
      const S p = s.mm / determinant, q = -s.lm / determinant, r = s.ll / determinant;
      const S var_l = p * p * s.vll + S(2) * p * q * s.vlm + q * q * s.vmm;
      const S var_m = q * q * s.vll + S(2) * q * r * s.vlm + r * r * s.vmm;
      const S both = p * q * s.vll + (p * r + q * q) * s.vlm + q * r * s.vmm;
      fit.length_sd_mm = found.length * sqrt(var_l);
      fit.modulus_sd_n_per_mm = found.modulus * sqrt(var_m);
      fit.correlation = both / sqrt(var_l * var_m);
    }
    fit.cause = as_double(fit.residual) > 0.1
                    ? "pressure and pull of the rim do not balance: check that "
                      "the pressures are of the same frames and tared"
                    : nullptr;
    for (const Level& level : levels_) {
      if (as_double(level.pressure_mpa) > 0.2) {
        fit.cause = "a pressure exceeds 0.2: give it in MPa above the pressure around the pad";
      }
    }
    if (asks_rubber) {
      tell_rubber(options, found.mooney_share, fit);
    }
    return fit;
  }

  /// Variance of the balance of a level, from the noise of the dots and the pressure of a frame.
  S variance(const Level& level,
             const Membrane& found,
             const std::vector<S>& shares,
             const RimFitOptions& options) const {
    detail::membrane::Rim<S> rim = rim_;
    const S h = S(std::cbrt(static_cast<double>(epsilon<S>())));
    Level more = level, less = level;
    const auto slope = [&](const S& step) {
      return (imbalance(more, found, shares, rim) - imbalance(less, found, shares, rim)) /
             (S(2) * step);
    };
    more.pressure_mpa = level.pressure_mpa * (S(1) + h);
    less.pressure_mpa = level.pressure_mpa * (S(1) - h);
    const S per_mpa = slope(h * level.pressure_mpa);
    S variance = square(S(options.pressure_noise_mpa) * per_mpa) / S(level.frames);
    more = less = level;
    const S step = h * found.length;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      if (level.seen[k] == 0 || !(options.side_dot_noise_mm > 0)) {
        continue;
      }
      for (const Point3<S>& axis : {Point3<S>{step, S(0), S(0)}, Point3<S>{S(0), step, S(0)},
                                    Point3<S>{S(0), S(0), step}}) {
        more.dots_mm[k] = level.dots_mm[k] + axis;
        less.dots_mm[k] = level.dots_mm[k] - axis;
        variance += square(S(options.side_dot_noise_mm) * slope(step)) / S(level.seen[k]);
      }
      more.dots_mm[k] = less.dots_mm[k] = level.dots_mm[k];
    }
    return variance;
  }

  /// Sums over the levels for the fit of m; miss = measured less modelled apex height.
  struct ApexSums {
    S miss_sq = S(0), slope_miss = S(0), slope_sq = S(0);  ///< slope: of the height by m
    S slope_modulus = S(0);                                ///< times the slope by ln(mu t)
    S slope_frames = S(0);                                 ///< squared slope / number of frames
    int levels = 0;
  };
  ApexSums apex_sums(const RimFitOptions& options, const S& modulus, const S& m) const {
    const S step = S(0.01);
    const auto apex_mm = [&](const S& share, const S& load) {
      const StressFreeCap<S> cap = {rim_.radius_mm(), S(options.stress_free_height_mm), share};
      const auto rim = FreePad<S>(cap).rim(load);
      return rim ? rim->apex_mm : not_a_number<S>();
    };
    const S aside = S(0.5) < m ? -step : step;  // within [0, 1]
    ApexSums sums;
    for (const Level& level : levels_) {
      if (level.apex_frames > 0) {
        const S load = level.pressure_mpa / modulus;
        const S height = apex_mm(m, load), miss = level.apex_mm - height;
        const S slope = (apex_mm(m + aside, load) - height) / aside;
        sums.miss_sq += square(miss);
        sums.slope_miss += slope * miss;
        sums.slope_sq += square(slope);
        sums.slope_modulus += slope * (apex_mm(m, load * (S(1) - step)) - height) / step;
        sums.slope_frames += square(slope) / S(level.apex_frames);
        ++sums.levels;
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
    return m < S(0) ? S(0) : S(1) < m ? S(1) : m;
  }

  void tell_rubber(const RimFitOptions& options, const S& mooney_share, RimFit<S>& fit) const {
    using std::sqrt;
    const ApexSums sums = apex_sums(options, fit.modulus_n_per_mm, mooney_share);
    fit.mooney_share = mooney_share;
    fit.apex_residual_mm = sqrt(sums.miss_sq / S(sums.levels));
    const S stiffer = fit.modulus_sd_n_per_mm / fit.modulus_n_per_mm;
    const S by_modulus = is_finite(stiffer) ? sums.slope_modulus / sums.slope_sq * stiffer : S(0);
    const S by_apex = S(options.apex_noise_mm) * sqrt(sums.slope_frames) / sums.slope_sq;
    fit.mooney_share_sd = sqrt(square(by_modulus) + square(by_apex));
  }

  const std::optional<double> inclination_;
  detail::membrane::Rim<S> rim_;
  std::vector<Level> levels_;
};

}  // namespace v0
}  // namespace fingerpad
