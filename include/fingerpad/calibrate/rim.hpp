// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The membrane's mu t (shear modulus times thickness) for force/wrench.hpp, from the apex of the
// contact-free pad at several pressures, which is that of an inflated cap of its rubber
// (membrane/free_pad.hpp). docs/force/wrench.md has it from one known weight.
//
// At a single pressure the apex says only how far the pad has risen above its stress-free height,
// so an error of that height is one of mu t. Several pressures give both. Where the membrane is
// thicker on one side, they show it, too: its dots then move otherwise than those of a round pad.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/membrane/free_pad.hpp"

namespace fingerpad {
inline namespace v1 {

/// Height of the contact-free pad's apex above the base at a pressure, the mean of its frames.
struct FreeApex {
  double pressure_mpa = 0;  ///< > 0
  double apex_mm = 0;       ///< > 0
  double sd_mm = 0.01;      ///< of the mean, > 0
};

/// Standard deviations of what is measured, and of what is known beforehand.
struct RimFitOptions {
  double pressure_sd_share = 0.002;  ///< of a pressure, of itself, in [0, 1]
  double height_sd_mm = 0.1;         ///< of the stress-free height that is given, >= 0
  double radius_sd_mm = 0.02;        ///< of the base radius that is given, >= 0
  double mooney_sd = 0;              ///< of the rubber's share that is given, >= 0; 0: it is known
};

/// Says which option has no meaning; "" if all have one.
inline std::string check(const RimFitOptions& o) {
  return check("RimFitOptions", {{"pressure_sd_share", o.pressure_sd_share, within(0, 1)},
                                 {"height_sd_mm", o.height_sd_mm, not_negative},
                                 {"radius_sd_mm", o.radius_sd_mm, not_negative},
                                 {"mooney_sd", o.mooney_sd, not_negative}});
}

/// The membrane of a pad.
struct [[nodiscard]] RimFit {
  const char* cause = cause::not_converged;  ///< likely mistake; nullptr if it looks good
  double modulus_n_per_mm = not_a_number<double>();
  double modulus_sd_n_per_mm = not_a_number<double>();
  double height_mm = not_a_number<double>();  ///< of the stress-free apex
  double height_sd_mm = not_a_number<double>();
  double mooney_share = 0;  ///< C2 / (C1 + C2)
  double mooney_sd = 0;
  double residual_mm = 0;  ///< of the apex heights, rms

  bool ok() const { return cause == nullptr; }
};

namespace cause {
inline constexpr char one_pressure[] =
    "the pressures hardly differ, so mu t depends on the stress-free height, and an uneven "
    "membrane does not show: record several, or use a weight for mu t";
inline constexpr char no_such_cap[] =
    "the apex heights are not those of an inflated cap: check radius, rubber and units";
inline constexpr char modulus_uncertain[] =
    "mu t is uncertain by more than 5 %: use pressures further apart, or more frames";
}  // namespace cause

/// mu t and the stress-free height from apex heights at one or more pressures. `cap` says what is
/// known of the pad. Refuses (parameter_error) pressures and heights that are not above 0, and
/// heights that no pressure gives this cap. O(apexes) shots of a free pad.
inline RimFit fit_rim(const StressFreeCap<double>& cap,
                      std::span<const FreeApex> apexes,
                      const RimFitOptions& options = {}) {
  constexpr const char* owner = "fit_rim";
  require(cap);
  require(options);
  expects(!apexes.empty(), owner, "apexes", apexes.size(), ">= 1");
  double least = apexes.front().pressure_mpa, most = least;
  for (const FreeApex& a : apexes) {
    require(owner, {{"pressure_mpa", a.pressure_mpa, positive},
                    {"apex_mm", a.apex_mm, positive},
                    {"sd_mm", a.sd_mm, positive}});
    least = (std::min)(least, a.pressure_mpa);
    most = (std::max)(most, a.pressure_mpa);
  }
  // unknown: ln(mu t), height, radius, share
  using Unknowns = Eigen::Vector4d;
  const auto apex_of = [](const Unknowns& x, double pressure_mpa) {
    const double load = pressure_mpa / std::exp(x[0]);
    const StressFreeCap<double> at{x[2], x[1], (std::min)((std::max)(x[3], 0.0), 1.0)};
    const auto rim = FreePad<double>(at).rim(load);
    // below the least load a pad is as good as stress-free, above the largest there is none
    return rim ? rim->apex_mm : load * x[2] < 0.1 ? x[1] : 4 * x[2];
  };
  const Unknowns given(0, cap.height_mm, cap.base_radius_mm, cap.mooney_share);
  const Unknowns sd(0, options.height_sd_mm, options.radius_sd_mm, options.mooney_sd);
  const FreeApex& high = *std::max_element(
      apexes.begin(), apexes.end(),
      [](const FreeApex& a, const FreeApex& b) { return a.pressure_mpa < b.pressure_mpa; });
  const bool in_mm = high.apex_mm < 2 * cap.base_radius_mm && high.apex_mm > cap.height_mm / 2;
  expects(in_mm, owner, "apex_mm", high.apex_mm,
          "between half the stress-free height and twice the base radius, in mm");
  Unknowns x = given;
  double low = std::log(high.pressure_mpa * cap.base_radius_mm / 20), top = low + 9;
  for (int k = 0; k < 60; ++k) {
    x[0] = (low + top) / 2;
    (apex_of(x, high.pressure_mpa) > high.apex_mm ? low : top) = x[0];
  }

  RimFit fit;
  fit.cause = cause::no_such_cap;
  Eigen::Matrix4d normal;
  double sum = 0, weighed = 0;
  for (int iteration = 0; iteration < 20; ++iteration) {
    normal.setZero();
    Unknowns gradient = Unknowns::Zero();
    sum = weighed = 0;
    for (const FreeApex& a : apexes) {
      Unknowns slope = Unknowns::Zero();
      for (Eigen::Index k = 0; k < 4; ++k) {
        if (k == 0 || sd[k] > 0) {
          const double h = k == 0 || k == 3 ? 1e-4 : 1e-4 * x[k];
          Unknowns more = x, less = x;
          more[k] += h;
          less[k] -= less[k] < h ? 0 : h;
          slope[k] =
              (apex_of(more, a.pressure_mpa) - apex_of(less, a.pressure_mpa)) / (more[k] - less[k]);
        }
      }
      const double miss = a.apex_mm - apex_of(x, a.pressure_mpa);
      const double weight = 1 / (square(a.sd_mm) + square(options.pressure_sd_share * slope[0]));
      normal += weight * slope * slope.transpose();
      gradient += weight * miss * slope;
      sum += square(miss);
      weighed += weight * square(miss);
    }
    for (Eigen::Index k = 1; k < 4; ++k) {
      const double known = 1 / square((std::max)(sd[k], 1e-9));
      normal(k, k) += known;
      gradient[k] += known * (given[k] - x[k]);
    }
    const Unknowns step = normal.ldlt().solve(gradient);
    const double part = (std::min)(1.0, 0.3 / (std::max)(std::fabs(step[0]), 1e-9));
    x += part * step;
    x[3] = (std::min)((std::max)(x[3], 0.0), 1.0);
    if (std::fabs(step[0]) < 1e-6) {
      fit.cause = nullptr;
      break;
    }
  }
  const Eigen::Matrix4d covariance = normal.ldlt().solve(Eigen::Matrix4d::Identity());
  const auto count = static_cast<double>(apexes.size());
  fit.modulus_n_per_mm = std::exp(x[0]);
  fit.modulus_sd_n_per_mm = fit.modulus_n_per_mm * std::sqrt(covariance(0, 0));
  fit.height_mm = x[1];
  fit.height_sd_mm = options.height_sd_mm > 0 ? std::sqrt(covariance(1, 1)) : 0;
  fit.mooney_share = x[3];
  fit.mooney_sd = options.mooney_sd > 0 ? std::sqrt(covariance(3, 3)) : 0;
  fit.residual_mm = std::sqrt(sum / count);
  expects(is_finite(fit.modulus_n_per_mm) && is_finite(fit.modulus_sd_n_per_mm), owner,
          "modulus_n_per_mm", fit.modulus_n_per_mm, "that of an inflated cap: check the units");
  if (fit.ok()) {
    const bool is_off = std::fabs(x[1] - cap.height_mm) > 4 * options.height_sd_mm + 1e-6;
    fit.cause = weighed > 9 * count || is_off     ? cause::no_such_cap
                : most < 1.2 * least              ? cause::one_pressure
                : covariance(0, 0) > square(0.05) ? cause::modulus_uncertain
                                                  : nullptr;
  }
  return fit;
}

/// Where the dots of the free pad are seen at a pressure, the mean of its frames: in the same order
/// at each pressure, NaN where one is not seen.
struct FreeDots {
  double pressure_mpa = 0;  ///< > 0
  std::span<const Point2<double>> px;
};

/// Where a membrane is thicker.
struct [[nodiscard]] UnevenFit {
  const char* cause = cause::not_converged;  ///< likely mistake; nullptr if it looks good
  /// For `StressFreeCap::uneven_x` and `uneven_y`, with the standard deviation of each.
  Point2<double> share = {not_a_number<double>(), not_a_number<double>()};
  double share_sd = not_a_number<double>();
  Point2<double> axis_px = share;  ///< of the pad, from the camera's
  Index dots = 0;                  ///< used

  bool ok() const { return cause == nullptr; }
};

/// By the pad's motion from one pressure to the next. The stress-free place of each dot must be the
/// same in all pictures; unevenness, axis and modulus that make it so are found by Gauss and
/// Newton's method. An axis that is off alone moves the dots otherwise. Refuses (parameter_error)
/// fewer than two pressures, and lists of different size.
template <class CameraType>
UnevenFit fit_uneven(const CameraType& camera,
                     WrenchOptions options,
                     std::span<const FreeDots> pictures) {
  constexpr const char* owner = "fit_uneven";
  expects(pictures.size() > 1, owner, "pictures", pictures.size(), ">= 2");
  const std::size_t dots = pictures.front().px.size(), all = 2 * dots * pictures.size();
  double least = pictures.front().pressure_mpa, most = least;
  for (const FreeDots& picture : pictures) {
    require(owner, {{"pressure_mpa", picture.pressure_mpa, positive}});
    expects(picture.px.size() == dots, owner, "dots of a picture", picture.px.size(), "of all");
    least = (std::min)(least, picture.pressure_mpa);
    most = (std::max)(most, picture.pressure_mpa);
  }
  // unknown: unevenness, axis in px, ln(mu t)
  using Unknowns = Eigen::Matrix<double, 5, 1>;
  const Unknowns step_of(0.01, 0.01, 0.2, 0.2, 0.01);
  const double modulus = options.modulus_n_per_mm;
  std::vector<char> is_used(dots, 1);
  // how far the place in each picture is off the mean of all, in mm; false: no such pad
  const auto look = [&](const Unknowns& x, Eigen::VectorXd& off) {
    options.cap.uneven_x = x[0];
    options.cap.uneven_y = x[1];
    options.modulus_n_per_mm = modulus * std::exp(x[4]);
    Wrench<CameraType> wrench(camera, options);
    std::vector<Point2<double>> places(dots * pictures.size()), mean(dots, {0, 0});
    for (std::size_t n = 0; n < places.size(); ++n) {
      const std::size_t k = n % dots;
      const FreeDots& picture = pictures[n / dots];
      if (k == 0 && !wrench.begin(picture.pressure_mpa)) {
        return false;
      }
      const auto at = wrench.place_in_free_picture(picture.px[k] - Point2<double>{x[2], x[3]});
      is_used[k] = at ? is_used[k] : 0;
      if (at) {
        const double first = n < dots ? at->azimuth_rad : places[k].y;
        places[n] = {at->arc_mm,
                     first + std::remainder(at->azimuth_rad - first, 2 * std::numbers::pi)};
        mean[k] += places[n] / static_cast<double>(pictures.size());
      }
    }
    off.resize(static_cast<Eigen::Index>(all));
    for (std::size_t n = 0; n < places.size(); ++n) {
      const Point2<double> change = places[n] - mean[n % dots];
      off[static_cast<Eigen::Index>(2 * n)] = change.x;
      off[static_cast<Eigen::Index>(2 * n + 1)] = options.cap.rho_mm(mean[n % dots].x) * change.y;
    }
    return true;
  };

  UnevenFit fit;
  if (most < 1.2 * least) {
    fit.cause = cause::one_pressure;
    return fit;
  }
  Unknowns x = Unknowns::Zero();
  Eigen::VectorXd now, more;
  Eigen::Matrix<double, Eigen::Dynamic, 5> slopes(static_cast<Eigen::Index>(all), 5);
  for (int iteration = 0; iteration < 8; ++iteration) {
    bool is_pad = look(x, now);
    for (Eigen::Index k = 0; k < 5 && is_pad; ++k) {
      Unknowns moved = x;
      moved[k] += step_of[k];
      is_pad = look(moved, more);
      slopes.col(k) = (more - now) / step_of[k];
    }
    for (std::size_t row = 0; row < all; ++row) {
      if (is_used[row / 2 % dots] == 0) {
        slopes.row(static_cast<Eigen::Index>(row)).setZero();
        now[static_cast<Eigen::Index>(row)] = 0;
      }
    }
    fit.dots = std::count(is_used.begin(), is_used.end(), 1);
    if (!is_pad || fit.dots < 20) {
      return fit;
    }
    const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> normal(slopes.transpose() * slopes);
    const Unknowns step = normal.solve(-slopes.transpose() * now);
    x += step;
    x.head(2) *= (std::min)(1.0, 0.25 / (std::max)(x.head(2).norm(), 1e-9));
    if (step.cwiseQuotient(step_of).cwiseAbs().maxCoeff() < 0.01) {
      const auto of_dot = static_cast<double>(pictures.size() - 1);
      const double variance =
          now.squaredNorm() / (2 * static_cast<double>(fit.dots) * of_dot - 5) *
          (normal.solve(Unknowns::Unit(0))[0] + normal.solve(Unknowns::Unit(1))[1]) / 2;
      fit.share = {x[0], x[1]};
      fit.share_sd = std::sqrt(variance);
      fit.axis_px = {x[2], x[3]};
      fit.cause = nullptr;
      return fit;
    }
  }
  return fit;
}

}  // namespace v1
}  // namespace fingerpad
