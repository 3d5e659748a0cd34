// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Force and moment on the pad from where printed dots near the rim are seen. Near the rim nothing
// but the fluid's pressure loads the membrane, whatever touches the pad further inward. So the free
// membrane is fitted to the pixels of its dots, and its pull at the rim, less the pressure on the
// base, is the whole force:
//   F = mu t sum(share A) - p pi R^2 e_z,   M = mu t sum(share b cross A).
// No depth, no colours, no region of contact: a hollow, soft or double object is as good as a
// plate.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/membrane/annulus.hpp"
#include "fingerpad/membrane/free_pad.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// A printed dot near the rim: where it lies on the membrane without stress, and where it is seen.
struct Mark {
  double arc_mm = 0;       ///< stress-free arc from the rim
  double azimuth_rad = 0;  ///< from x to y
  Point2<double> px = {0, 0};
  double sd_px = 0.06;  ///< of each coordinate, > 0; the covariance follows the residuals
};

struct WrenchOptions {
  StressFreeCap<double> cap = {};
  double modulus_n_per_mm = 0.5;     ///< mu t: shear modulus times thickness, > 0
  double modulus_sd_share = 0.01;    ///< what it is known to, in [0, 1]
  double pressure_sd_share = 0.002;  ///< noise of the gauge, in [0, 1]; 1: no gauge
  double reach_share = 0.53;  ///< dots are used so far inward, of the base radius, in (0, 0.7]
  bool loose_rim = true;      ///< the rim may be set off along the normal, as a sheet is that bends
  double thickness_mm = 0;    ///< of the membrane, >= 0, for the bend of a loose rim; 0: not known
  double outlier_sd = 4;      ///< residuals beyond count linearly, > 0
  Index max_marks = 400;      ///< in [20, 100000]; what comes after is not used
  /// Press that is measured, N, >= 0, by which `uncertain` is judged; 0: the largest so far, at
  /// least what the pressure exerts on an eighth of the base.
  double full_scale_n = 0;
};

inline std::string check(const WrenchOptions& o) {
  const std::string cap = check(o.cap);
  return !cap.empty()
             ? cap
             : check("WrenchOptions",
                     {{"modulus_n_per_mm", o.modulus_n_per_mm, positive},
                      {"modulus_sd_share", o.modulus_sd_share, within(0, 1)},
                      {"pressure_sd_share", o.pressure_sd_share, within(0, 1)},
                      {"reach_share", o.reach_share, {.min = 0, .max = 0.7, .above_min = true}},
                      {"thickness_mm", o.thickness_mm, not_negative},
                      {"outlier_sd", o.outlier_sd, positive},
                      {"max_marks", o.max_marks, within(20, 100000)},
                      {"full_scale_n", o.full_scale_n, not_negative}});
}

enum class WrenchStatus {
  ok,
  no_pressure,    ///< missing, or so low or high that no free pad has it
  too_few_marks,  ///< fewer than 20
  not_solved,     ///< the fit does not settle
  poor_fit,       ///< residuals are over twice sd_px: wrong places, labels or pad
  uncertain,      ///< a number, but two standard deviations exceed what `full_scale_n` allows
  not_tared,      ///< the free pad is no longer as it was tared; set by a Fingertip
};
constexpr const char* name_of(WrenchStatus status) {
  constexpr const char* names[] = {"ok",       "no pressure", "too few marks", "not solved",
                                   "poor fit", "uncertain",   "not tared"};
  return names[static_cast<std::size_t>(status)];
}

/// What the object exerts on the pad, about the origin at the middle of the base.
struct WrenchResult {
  WrenchStatus status = WrenchStatus::too_few_marks;
  Point3<double> force_n = detail::missing_point<double>();
  Point3<double> moment_n_mm = detail::missing_point<double>();
  /// Of force and moment, N and N mm: by the residuals, the gauge, and what the modulus is known
  /// to.
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Constant(not_a_number<double>());
  /// Of the fluid, from gauge and dots together, and its standard deviation, MPa.
  double pressure_mpa = not_a_number<double>(), pressure_sd_mpa = not_a_number<double>();
  double misfit = 0;  ///< residuals over sd_px, by their degrees of freedom, without outliers
  Index marks = 0;    ///< used
  bool ok() const { return status == WrenchStatus::ok; }
  /// Also where it is in doubt; else force, moment, covariance and pressure are NaN.
  bool has_force() const {
    return ok() || status == WrenchStatus::uncertain || status == WrenchStatus::not_tared;
  }
};

/// The fit. All memory is taken in the constructor; a copy is a state of its own.
template <class CameraType = Camera<double>>
class Wrench {
 public:
  Wrench(const CameraType& camera, const WrenchOptions& options)
      : camera_(camera),
        options_((require(options), options)),
        free_(options.cap),
        annulus_(options.cap, march_of(options, false)),
        tangent_(options.cap, march_of(options, true)) {
    require(camera);
    if (options.cap.is_uneven()) {
      StressFreeCap<double> turned = options.cap;
      turned.uneven_x = std::hypot(turned.uneven_x, turned.uneven_y);
      turned.uneven_y = 0;
      uneven_.emplace(turned, AnnulusOptions{.reach_mm = 0.7 * turned.arc_mm(),
                                             .azimuths = 12,
                                             .steps = 20,
                                             .harmonics = 1,
                                             .offset_harmonics = -1});
      leaning_.resize(uneven_->parameters());
    }
    const std::size_t n = annulus_.parameters(), width = tangent_.width();
    const auto count = static_cast<Eigen::Index>(n);
    parameters_.assign(n, 0.0);
    centre_ = at_slopes_ = before_ = parameters_;
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const bool is_offset = k >= 3 * annulus_.terms();
      const auto harmonic = static_cast<double>((k % annulus_.terms() + 1) / 2);
      // harmonics of a slope fall as those of a corner; a sheet that bends over some thickness is
      // set off by that times its slope
      const double bend_mm = 0.3, slope = 0.3 / std::pow((std::max)(1.0, harmonic), 1.5);
      const double offset_mm = harmonic > 0 ? bend_mm * slope : bend_mm;
      prior_.push_back(1 / square(is_offset ? offset_mm : slope));
    }
    prior_.push_back(0);
    weight_ = prior_;
    normal_.resize(count, static_cast<Eigen::Index>(width));
    solver_ = Eigen::LLT<Eigen::MatrixXd>(count);
    gradient_.resize(count);
    rhs_.resize(count);
    slopes_.resize(2 * options.max_marks, static_cast<Eigen::Index>(width));
    residuals_.resize(2 * options.max_marks);
    weights_.setOnes(2 * options.max_marks);
    left_ = weights_;
    of_position_.resize(3 * width);
    of_load_.resize(static_cast<Eigen::Index>(width), 6);
    places_ = detail::ReservedVector<Seen>(static_cast<std::size_t>(options.max_marks));
  }

  double reach_mm() const { return annulus_.options().reach_mm; }
  double base_radius_mm() const { return options_.cap.base_radius_mm; }

  /// Begins with the free pad at a pressure: what `place_in_free_picture` and the first fit
  /// suppose. False if no free pad has this pressure, or 2 % more.
  bool begin(double pressure_mpa) {
    const double load = pressure_mpa / options_.modulus_n_per_mm, more = 0.02;
    begun_ = look_at_free(load * (1 + more));
    const FreeRadii under_more = free_radius_mm_;
    begun_ = begun_ && look_at_free(load);
    for (std::size_t k = 1; begun_ && k < free_radius_mm_.size(); ++k) {
      const auto arc = arc_of(under_more, free_radius_mm_[k]);
      const double before = arc_by_load_mm_[k - 1];
      // inward of what both pictures show it goes on as before
      arc_by_load_mm_[k] =
          arc ? (*arc - arc_at(k)) / more : 2 * before - (k > 1 ? arc_by_load_mm_[k - 2] : 0.0);
    }
    return begun_;
  }

  /// The stress-free place of a dot that a picture of the free pad shows here, by inverting the
  /// membrane of `begin`: nothing of the print need be known. Empty where the dot is not within the
  /// reach, or hidden behind the wall. `sd_px` is left to the caller.
  std::optional<Mark> place_in_free_picture(const Point2<double>& px) {
    if (!begun_ || !is_plausible(px)) {
      return {};
    }
    const auto seen = point_at(camera_, px.y, px.x, 0.0);
    const double radius_mm = std::hypot(seen.x, seen.y);
    double azimuth_rad = std::atan2(seen.y, seen.x);
    auto arc = arc_of(free_radius_mm_, radius_mm);
    for (int step = 0; step < 3 && uneven_ && arc; ++step) {
      const double from_thick = azimuth_rad - thick_rad(), inward = *arc;
      arc = arc_of(free_radius_mm_,
                   radius_mm - at_arc(off_outward_mm_, inward) * std::cos(from_thick));
      azimuth_rad = std::atan2(seen.y, seen.x) -
                    at_arc(off_around_mm_, inward) / radius_mm * std::sin(from_thick);
    }
    return arc ? std::optional<Mark>({*arc, azimuth_rad, px}) : std::nullopt;
  }

  /// Force and moment from the marks of a frame, which nothing touches. O(marks x parameters^2);
  /// allocates nothing. The fit begins at that of the last frame. Where the places of the marks are
  /// the mean of so many free pictures, the noise of the gauge in those counts, too; 0: they are
  /// known otherwise.
  WrenchResult operator()(std::span<const Mark> marks,
                          double pressure_mpa,
                          Index free_pictures = 0) {
    WrenchResult result;
    const double load = pressure_mpa / options_.modulus_n_per_mm;
    if (!(is_finite(load) && load > 0) || (!begun_ && !begin(pressure_mpa))) {
      result.status = WrenchStatus::no_pressure;
      return result;
    }
    places_.clear();
    for (const Mark& mark : marks) {
      if (static_cast<Index>(places_.size()) < options_.max_marks && mark.arc_mm > 0 &&
          mark.arc_mm < reach_mm() && is_plausible(mark.px) && mark.sd_px > 0) {
        auto place = annulus_.place(mark.arc_mm, mark.azimuth_rad);
        places_.push_back({place, place, mark});
        tangent_.shift(places_.back().of_slopes, mark.arc_mm);
      }
    }
    result.marks = static_cast<Index>(places_.size());
    if (places_.size() < 20) {
      return result;  // too_few_marks
    }
    centre_.back() = load;
    parameters_.back() = load;
    prior_.back() = 1 / square((std::max)(options_.pressure_sd_share, 1e-6) * load);
    for (std::size_t k = 0; k < weight_.size(); ++k) {
      weight_[k] = noise_sq_ * prior_[k];
    }
    if (!fit(0.1, 24)) {
      restart();
      if (!fit(0.05, 48)) {
        restart();
        result.status = WrenchStatus::not_solved;
        return result;
      }
    }
    const double square_misfit = misfit_ / freedom();
    result.misfit = std::sqrt(square_misfit);
    noise_sq_ += 0.25 * ((std::clamp)(square_misfit, 0.01, 10.0) - noise_sq_);
    if (result.misfit > 2.5) {
      result.status = WrenchStatus::poor_fit;
      return result;
    }
    read_load(free_pictures, result);
    const double press_n = std::fabs(result.force_n.z) - 2 * std::sqrt(result.covariance(2, 2));
    largest_n_ = (std::max)(largest_n_, press_n);
    result.status = is_uncertain(result, pressure_mpa) ? WrenchStatus::uncertain : WrenchStatus::ok;
    return result;
  }

 private:
  struct Seen {
    Annulus<double>::Place place, of_slopes;
    Mark mark;
  };

  /// Steps of the slopes may be long: they are off by some per cent, and a fit's end is not.
  static AnnulusOptions march_of(const WrenchOptions& o, bool slopes) {
    return {.reach_mm = o.reach_share * o.cap.base_radius_mm,
            .steps = slopes ? 3 : 6,
            .offset_harmonics = o.loose_rim ? 5 : -1,
            .slopes = slopes};
  }

  void restart() {
    parameters_ = centre_;
    has_slopes_ = false;
  }

  /// Of the press F that is measured, on a disc of radius r = sqrt(F / (pi p)), results may be off
  /// by 3 % of F / 2 along the base, 9.6 % of F, 9 % of 0.9 r F, and 5.7 % of 0.3 r F about the
  /// axis.
  bool is_uncertain(const WrenchResult& result, double pressure_mpa) const {
    const double area_mm2 = std::numbers::pi * square(options_.cap.base_radius_mm) / 8;
    const double press_n = options_.full_scale_n > 0
                               ? options_.full_scale_n
                               : (std::max)(largest_n_, pressure_mpa * area_mm2);
    const double arm_mm = std::sqrt(press_n / (std::numbers::pi * pressure_mpa));
    const auto exceeds = [&](Eigen::Index first, Eigen::Index axes, double most) {
      double variance = 0;
      for (Eigen::Index k = first; k < first + axes; ++k) {
        variance += result.covariance(k, k);
      }
      return 4 * variance > square(most * press_n);
    };
    return exceeds(0, 2, 0.03 / 2) || exceeds(2, 1, 0.096) || exceeds(3, 2, 0.09 * 0.9 * arm_mm) ||
           exceeds(5, 1, 0.057 * 0.3 * arm_mm);
  }

  using FreeRadii = std::array<double, 81>;  // on the plate, over the arc

  double arc_at(std::size_t k) const {
    return reach_mm() * static_cast<double>(k) / static_cast<double>(free_radius_mm_.size() - 1);
  }
  double at_arc(const FreeRadii& of_arc, double arc_mm) const {
    const double cells = arc_mm / arc_at(1);
    const auto k = (std::min)(static_cast<std::size_t>(cells), of_arc.size() - 2);
    return std::lerp(of_arc[k], of_arc[k + 1], cells - static_cast<double>(k));
  }
  /// Empty outside the picture of the free membrane within the reach.
  std::optional<double> arc_of(const FreeRadii& radii_mm, double radius_mm) const {
    // an undercut wall is seen from its widest circle inward
    const auto widest = std::max_element(radii_mm.begin(), radii_mm.end());
    const auto inner = std::lower_bound(widest, radii_mm.end(), radius_mm, std::greater<>());
    if (inner == widest || inner == radii_mm.end()) {
      return {};
    }
    const double share = (*(inner - 1) - radius_mm) / (*(inner - 1) - *inner);
    const auto before = static_cast<std::size_t>(inner - radii_mm.begin() - 1);
    return arc_at(before) + share * arc_at(1);
  }

  double thick_rad() const { return std::atan2(options_.cap.uneven_y, options_.cap.uneven_x); }

  /// The first harmonics of how the membrane of a free pad leaves its rim, if it is thicker on one
  /// side: no force and no moment, and it is whole further inward, which the second harmonic of its
  /// circles in plan would not be.
  bool lean(const FreeRim<double>& rim, double load) {
    // The thick side is toward x. Parameters 0 to 2 are harmonics inward (1, cos, sin), 3 to 5
    // around, 6 to 8 up.
    Annulus<double>& pad = *uneven_;
    std::fill(leaning_.begin(), leaning_.end(), 0.0);
    leaning_[0] = rim.stretch * std::cos(rim.slope_rad);
    leaning_[6] = rim.stretch * std::sin(rim.slope_rad);
    leaning_[9] = load;
    constexpr std::array<std::size_t, 4> unknowns = {1, 5, 6, 7};
    Eigen::Vector4d step;
    for (int iteration = 0; iteration < 3; ++iteration) {
      pad.march(leaning_);
      const auto at_rim = pad.load_at_rim();
      pad.slopes_of_load({of_load_.data(), 6 * pad.width()});
      Eigen::Vector4d miss(at_rim.force.x, at_rim.force.z, at_rim.moment.y, 0);
      Eigen::Matrix4d by = Eigen::Matrix4d::Zero();
      for (Eigen::Index k = 0; k < 4; ++k) {
        for (Eigen::Index row = 0; row < 3; ++row) {  // F_x, F_z, M_y
          by(row, k) = of_load_.data()[static_cast<std::size_t>(2 * row) * pad.width() +
                                       unknowns[static_cast<std::size_t>(k)]];
        }
      }
      const Index n = pad.options().azimuths;
      for (Index j = 0; j < n; ++j) {
        const double phi = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(n);
        const auto place = pad.place(pad.options().reach_mm, phi);
        const double c = std::cos(2 * phi), s = std::sin(2 * phi);
        pad.slopes_at(place, of_position_);
        miss[3] += c * pad.at(place).x + s * pad.at(place).y;
        for (Eigen::Index k = 0; k < 4; ++k) {
          const std::size_t of = unknowns[static_cast<std::size_t>(k)];
          by(3, k) += c * of_position_[of] + s * of_position_[pad.width() + of];
        }
      }
      step = by.inverse() * -miss;
      for (std::size_t k = 0; k < 4; ++k) {
        leaning_[unknowns[k]] += step[static_cast<Eigen::Index>(k)];
      }
    }
    const double c = std::cos(thick_rad()), s = std::sin(thick_rad());
    double *inward = centre_.data(), *around = inward + annulus_.terms(),
           *up = around + annulus_.terms();
    inward[1] = c * leaning_[1], inward[2] = s * leaning_[1];
    around[1] = -s * leaning_[5], around[2] = c * leaning_[5];
    up[0] = leaning_[6], up[1] = c * leaning_[7], up[2] = s * leaning_[7];
    return step.cwiseAbs().maxCoeff() < 1e-2;
  }

  /// False if no free pad has this load.
  bool look_at_free(double load) {
    const auto rim = is_finite(load) && load > 0 ? free_.rim(load) : std::nullopt;
    if (!rim) {
      return false;
    }
    std::fill(centre_.begin(), centre_.end(), 0.0);
    centre_[0] = rim->stretch * std::cos(rim->slope_rad);
    centre_[2 * annulus_.terms()] = rim->stretch * std::sin(rim->slope_rad);
    if (options_.loose_rim && options_.thickness_mm > 0) {
      // a clamped sheet leaves at the mould's angle: sqrt(D / T) of the angle, D = mu t^3 / 3
      const double radius_mm = options_.cap.base_radius_mm;
      const double mould_rad = 2 * std::atan(options_.cap.height_mm / radius_mm);
      const double tension = load * radius_mm / (2 * std::sin(rim->slope_rad));  // per mu t
      centre_[3 * annulus_.terms()] =
          (mould_rad - rim->slope_rad) * options_.thickness_mm / std::sqrt(3 * tension);
    }
    centre_.back() = load;
    if (uneven_ && !lean(*rim, load)) {
      return false;
    }
    restart();
    annulus_.march(centre_);
    const auto seen_at = [&](std::size_t k, double azimuth_rad) {
      const auto px = pixel_of(camera_, annulus_.at(annulus_.place(arc_at(k), azimuth_rad)));
      return point_at(camera_, px.y, px.x, 0.0);
    };
    const double to = thick_rad(), across = to + std::numbers::pi / 2;
    for (std::size_t k = 0; k < free_radius_mm_.size(); ++k) {
      const auto thick = seen_at(k, to), thin = seen_at(k, to + std::numbers::pi),
                 side = seen_at(k, across);
      const double one = std::hypot(thick.x, thick.y), other = std::hypot(thin.x, thin.y);
      free_radius_mm_[k] = (one + other) / 2;
      off_outward_mm_[k] = (one - other) / 2;
      off_around_mm_[k] = side.y * std::cos(across) - side.x * std::sin(across);
    }
    return true;
  }

  /// Gauss and Newton's method with Huber's weights. The slopes, of the last frame at first, are
  /// kept until the parameters are far from theirs, or the steps do not halve. A step changes no
  /// parameter by more than `longest`, and the load by no larger share.
  bool fit(double longest, int most_steps) {
    double step = 1;
    bool is_stale = !has_slopes_;
    for (int iteration = 0; iteration < most_steps; ++iteration) {
      if (is_stale) {
        tangent_.march(parameters_);
        at_slopes_ = parameters_;
        has_slopes_ = true;
      }
      annulus_.march(parameters_);
      const bool is_anew = is_stale || iteration == 0;
      look(is_anew);
      const double off = solve(is_anew);
      double largest = gradient_.head(gradient_.size() - 1).cwiseAbs().maxCoeff(), far = 0;
      if (!(largest < 100)) {
        return false;
      }
      const double rise = std::fabs(gradient_[gradient_.size() - 1]) / parameters_.back();
      const double scale = (std::min)(1.0, longest / (std::max)({largest, rise, 1e-9}));
      for (std::size_t k = 0; k < parameters_.size(); ++k) {
        parameters_[k] += scale * gradient_[static_cast<Eigen::Index>(k)];
        far = (std::max)(far, std::fabs(parameters_[k] - at_slopes_[k]));
      }
      largest *= scale;
      if (off < 0.03 * 0.03) {
        return true;
      }
      is_stale = far > 0.01 || largest > step / 2;
      step = largest;
    }
    return step < 1e-3;
  }

  /// Residuals of all marks over their sd, and their slopes.
  void look(bool with_slopes) {
    misfit_ = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Seen& seen = places_[i];
      const Point3<double> at = annulus_.at(seen.place);
      const auto row = static_cast<Eigen::Index>(2 * i);
      if (!(at.z > 0)) {  // no camera sees below the base
        residuals_[row] = residuals_[row + 1] = 0;
        if (with_slopes) {
          slopes_.middleRows(row, 2).setZero();
        }
        continue;
      }
      const Point2<double> px = pixel_of(camera_, at);
      residuals_[row] = (seen.mark.px.x - px.x) / seen.mark.sd_px;
      residuals_[row + 1] = (seen.mark.px.y - px.y) / seen.mark.sd_px;
      for (Eigen::Index k = row; k < row + 2; ++k) {  // one wrong label must not spoil the sum
        misfit_ += square((std::min)(std::fabs(residuals_[k]), options_.outlier_sd));
      }
      if (with_slopes) {
        constexpr double h = 1e-4;  // mm: pixel_of is smooth
        tangent_.slopes_at(seen.of_slopes, of_position_);
        slopes_.middleRows(row, 2).setZero();
        for (int axis = 0; axis < 3; ++axis) {
          Point3<double> moved = at;
          (axis == 0 ? moved.x : axis == 1 ? moved.y : moved.z) += h;
          const Point2<double> change = (pixel_of(camera_, moved) - px) / (h * seen.mark.sd_px);
          const Eigen::Map<const Eigen::RowVectorXd> slope(
              &of_position_[static_cast<std::size_t>(axis) * tangent_.width()], slopes_.cols());
          slopes_.row(row) += change.x * slope;
          slopes_.row(row + 1) += change.y * slope;
        }
      }
    }
  }

  /// gradient_ becomes the step. The normal equations are kept while slopes and weights are.
  /// The square of the step in standard deviations.
  double solve(bool anew) {
    const auto rows = static_cast<Eigen::Index>(2 * places_.size());
    gradient_.setZero();
    for (Eigen::Index row = 0; row < rows; ++row) {
      const double weight = (std::min)(options_.outlier_sd / std::fabs(residuals_[row]), 1.0);
      anew = anew || std::fabs(weight - weights_[row]) > 0.05;
      weights_[row] = weight;
      gradient_ += weight * residuals_[row] * slopes_.row(row).head(gradient_.size()).transpose();
    }
    if (anew) {
      normal_.setZero();
      for (Eigen::Index row = 0; row < rows; row += 2) {
        add_to_normal(row);
      }
    }
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      normal_(i, i) += anew ? weight_[k] : 0;
      gradient_[i] += weight_[k] * (centre_[k] - parameters_[k]);
    }
    if (anew) {
      solver_.compute(normal_.leftCols(gradient_.size()));
    }
    rhs_ = gradient_;
    solver_.solveInPlace(gradient_);
    return rhs_.dot(gradient_);
  }

  /// The two rows of a mark, to the lower triangle.
  void add_to_normal(Eigen::Index row) {
    constexpr Eigen::Index lanes = 2;
    const double *x = &slopes_(row, 0), *y = &slopes_(row + 1, 0);
    const double of_x = weights_[row], of_y = weights_[row + 1];
    for (Eigen::Index i = 0; i < gradient_.size(); ++i) {
      const double a = of_x * x[i], b = of_y * y[i];
      double* to = &normal_(i, 0);
      for (Eigen::Index j = 0; j <= i; j += lanes) {
        double group[lanes];
        for (Eigen::Index l = 0; l < lanes; ++l) {
          group[l] = to[j + l] + a * x[j + l] + b * y[j + l];
        }
        std::copy(group, group + lanes, to + j);
      }
    }
  }

  /// Residuals less the parameters that they determine, at least 1. left_ becomes the share of its
  /// variance that the fit leaves of each residual: less of a dot on which much depends.
  double freedom() {
    double sum = 0;
    for (Eigen::Index row = 0; row < static_cast<Eigen::Index>(2 * places_.size()); ++row) {
      rhs_ = slopes_.row(row).head(gradient_.size()).transpose();
      solver_.matrixL().solveInPlace(rhs_);
      left_[row] = (std::max)(1 - weights_[row] * rhs_.squaredNorm(), 0.01);
      sum += left_[row];
    }
    return (std::max)(sum, 1.0);
  }

  using Axes = Eigen::Matrix<double, 6, 1>;

  /// The variance of each dot is the square of its residual over what the fit leaves of it, so that
  /// no sd_px need be right; that of each parameter known before is what it is known to.
  void read_load(Index free_pictures, WrenchResult& result) {
    tangent_.slopes_of_load({of_load_.data(), static_cast<std::size_t>(of_load_.size())});
    const double modulus = options_.modulus_n_per_mm, less = 0.005;
    const Axes axes = axes_after_step(modulus);
    result.force_n = {axes[0], axes[1], axes[2]};
    result.moment_n_mm = {axes[3], axes[4], axes[5]};
    const Eigen::Index load = gradient_.size() - 1;
    result.pressure_mpa = modulus * parameters_.back();
    rhs_.setZero();
    rhs_[load] = 1;
    solver_.matrixL().solveInPlace(rhs_);
    result.pressure_sd_mpa = modulus * rhs_.norm();
    fit_to_modulus(less);
    const Axes by_modulus = (axes - axes_after_step(modulus * (1 - less))) / less;
    for (Eigen::Index k = 0; k < 6; ++k) {  // one by one, because a block allocates
      auto column = of_load_.col(k).head(gradient_.size());
      solver_.solveInPlace(column);
    }
    const auto through = [&](const auto& by_parameters) {
      Axes by;
      for (Eigen::Index k = 0; k < 6; ++k) {
        by[k] = modulus * of_load_.col(k).head(gradient_.size()).dot(by_parameters);
      }
      return by;
    };
    const auto add = [&](double variance, const Axes& by) {
      result.covariance += variance * by * by.transpose();
    };
    result.covariance.setZero();
    add(square(options_.modulus_sd_share), by_modulus);
    const bool has_gauge = options_.pressure_sd_share < 1;
    if (has_gauge && free_pictures > 0) {
      // force is mu t times what follows from p / (mu t) and the places: a wrong modulus changes
      // the factor, the load of the frame, and the places as a wrong gauge in a free picture does
      const Axes by_load =
          through(weight_.back() * centre_.back() * Eigen::VectorXd::Unit(gradient_.size(), load));
      add(square(options_.pressure_sd_share) / static_cast<double>(free_pictures),
          axes - by_modulus - by_load);
    }
    for (Eigen::Index row = 0; row < static_cast<Eigen::Index>(2 * places_.size()); ++row) {
      add(square(weights_[row] * residuals_[row]) / left_[row],
          through(slopes_.row(row).head(gradient_.size()).transpose()));
    }
    for (Eigen::Index k = 0; k < gradient_.size(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      add(square(weight_[i]) / prior_[i], through(Eigen::VectorXd::Unit(gradient_.size(), k)));
    }
  }

  /// Force and moment at the end of the last step.
  Axes axes_after_step(double modulus) const {
    const auto load = annulus_.load_at_rim();
    const Axes before(load.force.x, load.force.y, load.force.z, load.moment.x, load.moment.y,
                      load.moment.z);
    const auto slope = of_load_.topRows(gradient_.size()).transpose();
    return modulus * (before + slope.lazyProduct(gradient_));
  }

  /// Two steps more, to the load and the places in the free picture of a membrane whose modulus is
  /// less by a share.
  void fit_to_modulus(double less) {
    const double given = centre_.back();
    before_ = parameters_;
    centre_.back() /= 1 - less;
    parameters_.back() /= 1 - less;
    for (Seen& seen : places_) {
      const double arc = seen.mark.arc_mm;
      annulus_.shift(seen.place, arc + less * at_arc(arc_by_load_mm_, arc));
    }
    for (int step = 0; step < 2; ++step) {
      annulus_.march(parameters_);
      look(false);
      solve(false);
      for (std::size_t k = 0; k < parameters_.size(); ++k) {
        parameters_[k] += gradient_[static_cast<Eigen::Index>(k)];
      }
    }
    parameters_ = before_;
    centre_.back() = given;
  }

  CameraType camera_;
  WrenchOptions options_;
  FreePad<double> free_;
  Annulus<double> annulus_, tangent_;  // the membrane; its slopes at at_slopes_
  bool begun_ = false, has_slopes_ = false;
  std::vector<double> parameters_, at_slopes_, centre_, before_, of_position_;
  std::vector<double> prior_, weight_;  // of the parameters, and where sd_px is not the noise
  FreeRadii free_radius_mm_ = {}, arc_by_load_mm_ = {};  // the latter with ln of the load
  FreeRadii off_outward_mm_ = {}, off_around_mm_ = {};   // of an uneven membrane, where it is thick
  std::optional<Annulus<double>> uneven_;                // of the free pad, past the reach
  std::vector<double> leaning_;                          // its parameters
  detail::ReservedVector<Seen> places_;
  Eigen::MatrixXd of_load_;  // by parameters
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> normal_, slopes_;
  Eigen::VectorXd gradient_, rhs_, residuals_, weights_, left_;
  Eigen::LLT<Eigen::MatrixXd> solver_;
  double misfit_ = 0;     // sum of squares
  double noise_sq_ = 1;   // mean square of residuals over sd_px in the last frames
  double largest_n_ = 0;  // press so far, less two standard deviations
};

}  // namespace v1
}  // namespace fingerpad
