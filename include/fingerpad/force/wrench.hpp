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
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/membrane/annulus.hpp"
#include "fingerpad/membrane/free_pad.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

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
  double pressure_sd_share = 0.002;  ///< noise of the gauge, of the pressure, in [0, 1]
  double reach_share = 0.53;  ///< dots are used so far inward, of the base radius, in (0, 0.7]
  bool loose_rim = true;      ///< the rim may be set off along the normal, as a sheet is that bends
  double outlier_sd = 4;      ///< residuals beyond count linearly, > 0
  Index max_marks = 400;      ///< in [20, 100000]; what comes after is not used
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
                      {"outlier_sd", o.outlier_sd, positive},
                      {"max_marks", o.max_marks, within(20, 100000)}});
}

enum class WrenchStatus {
  ok,
  no_pressure,    ///< missing, or so low or high that no free pad has it
  too_few_marks,  ///< fewer than 20
  not_solved,     ///< the fit does not settle
  poor_fit,       ///< residuals are over twice sd_px: wrong places, labels or pad
};
constexpr const char* name_of(WrenchStatus status) {
  constexpr const char* names[] = {"ok", "no pressure", "too few marks", "not solved", "poor fit"};
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
  double misfit = 0;  ///< residuals over sd_px, by their degrees of freedom, without outliers
  Index marks = 0;    ///< used
  bool ok() const { return status == WrenchStatus::ok; }
};

/// The fit. All memory is taken in the constructor; a copy is a state of its own.
template <class CameraType = Camera<double>>
class Wrench {
 public:
  Wrench(const CameraType& camera, const WrenchOptions& options)
      : camera_(camera),
        options_((require(options), options)),
        free_(options.cap),
        annulus_(options.cap,
                 {.reach_mm = options.reach_share * options.cap.base_radius_mm,
                  .offset_harmonics = options.loose_rim ? 5 : -1}) {
    require(camera);
    const std::size_t n = annulus_.parameters(), width = annulus_.width();
    const auto count = static_cast<Eigen::Index>(n);
    parameters_.assign(n, 0.0);
    centre_ = parameters_;
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const bool offset = k >= 3 * annulus_.terms();
      const auto harmonic = static_cast<double>((k % annulus_.terms() + 1) / 2);
      // harmonics of a slope fall as those of a corner; an offset is at most some thickness
      weight_.push_back(1 / square(offset ? 0.3 : 0.3 / std::pow((std::max)(1.0, harmonic), 1.5)));
    }
    weight_.push_back(0);
    normal_.resize(count, count);
    solver_ = Eigen::LLT<Eigen::MatrixXd>(count);
    gradient_.resize(count);
    slopes_.resize(2 * options.max_marks, count);
    residuals_.resize(2 * options.max_marks);
    of_position_.resize(3 * width);
    of_load_.resize(6 * width);
    transposed_.resize(count, 6);
    places_ = detail::ReservedVector<Seen>(static_cast<std::size_t>(options.max_marks));
  }

  double reach_mm() const { return annulus_.options().reach_mm; }

  /// Begins with the free pad at a pressure: what `place_in_free_picture` and the first fit
  /// suppose. False if no free pad has this pressure, or 2 % more.
  bool begin(double pressure_mpa) {
    const double load = pressure_mpa / options_.modulus_n_per_mm, more = 0.02;
    begun_ = look_at_free(load * (1 + more));
    const FreeRadii under_more = free_radius_mm_;
    begun_ = begun_ && look_at_free(load);
    for (std::size_t k = free_radius_mm_.size() - 1; begun_ && k-- > 0;) {
      const auto arc = arc_of(under_more, free_radius_mm_[k]);
      arc_by_load_mm_[k] = arc ? (*arc - arc_at(k)) / more : arc_by_load_mm_[k + 1];
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
    const auto arc = arc_of(free_radius_mm_, std::hypot(seen.x, seen.y));
    return arc ? std::optional<Mark>({*arc, std::atan2(seen.y, seen.x), px}) : std::nullopt;
  }

  /// Force and moment from the marks of a frame, which nothing touches. O(marks x parameters^2);
  /// allocates nothing. The fit begins at that of the last frame.
  WrenchResult operator()(std::span<const Mark> marks, double pressure_mpa) {
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
        places_.push_back({annulus_.place(mark.arc_mm, mark.azimuth_rad), mark});
      }
    }
    result.marks = static_cast<Index>(places_.size());
    if (places_.size() < 20) {
      return result;  // too_few_marks
    }
    centre_.back() = load;
    parameters_.back() = load;
    weight_.back() = 1 / square((std::max)(options_.pressure_sd_share, 1e-6) * load);
    if (!fit()) {
      parameters_ = centre_;
      if (!fit()) {
        parameters_ = centre_;
        result.status = WrenchStatus::not_solved;
        return result;
      }
    }
    result.misfit = std::sqrt(misfit_ / freedom());
    read_load(result);
    result.status = result.misfit > 2.5 ? WrenchStatus::poor_fit : WrenchStatus::ok;
    return result;
  }

 private:
  struct Seen {
    Annulus<double>::Place place;
    Mark mark;
  };

  using FreeRadii = std::array<double, 81>;  // on the plate, over the arc

  double arc_at(std::size_t k) const {
    return reach_mm() * static_cast<double>(k) / static_cast<double>(free_radius_mm_.size() - 1);
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

  /// False if no free pad has this load.
  bool look_at_free(double load) {
    const auto rim = is_finite(load) && load > 0 ? free_.rim(load) : std::nullopt;
    if (!rim) {
      return false;
    }
    std::fill(centre_.begin(), centre_.end(), 0.0);
    centre_[0] = rim->stretch * std::cos(rim->slope_rad);
    centre_[2 * annulus_.terms()] = rim->stretch * std::sin(rim->slope_rad);
    centre_.back() = load;
    parameters_ = centre_;
    annulus_.march(centre_, false);
    for (std::size_t k = 0; k < free_radius_mm_.size(); ++k) {
      const auto px = pixel_of(camera_, annulus_.at(annulus_.place(arc_at(k), 0)));
      const auto seen = point_at(camera_, px.y, px.x, 0.0);
      free_radius_mm_[k] = std::hypot(seen.x, seen.y);
    }
    return true;
  }

  /// Gauss and Newton's method with Huber's weights. The slopes are renewed while steps are large.
  bool fit() {
    double step = 1;
    bool with_slopes = true;
    for (int iteration = 0; iteration < 16; ++iteration) {
      annulus_.march(parameters_, with_slopes);
      look(with_slopes);
      solve(with_slopes);
      double largest = gradient_.head(gradient_.size() - 1).cwiseAbs().maxCoeff();
      if (!(largest < 100)) {
        return false;
      }
      const double scale = (std::min)(1.0, 0.1 / (std::max)(largest, 1e-9));
      for (std::size_t k = 0; k < parameters_.size(); ++k) {
        parameters_[k] += scale * gradient_[static_cast<Eigen::Index>(k)];
      }
      largest *= scale;
      if (largest < 3e-5) {
        solve(true);  // with the weights of these residuals
        return true;
      }
      with_slopes = largest > 0.004 || largest > step / 2;
      step = largest;
    }
    return step < 1e-3;
  }

  /// Residuals of all marks over their sd, and their slopes.
  void look(bool with_slopes) {
    misfit_ = 0;
    const auto count = static_cast<Eigen::Index>(annulus_.parameters());
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
        annulus_.slopes_at(seen.place, of_position_);
        slopes_.middleRows(row, 2).setZero();
        for (int axis = 0; axis < 3; ++axis) {
          Point3<double> moved = at;
          (axis == 0 ? moved.x : axis == 1 ? moved.y : moved.z) += h;
          const Point2<double> change = (pixel_of(camera_, moved) - px) / (h * seen.mark.sd_px);
          const Eigen::Map<const Eigen::RowVectorXd> slope(
              &of_position_[static_cast<std::size_t>(axis) * annulus_.width()], count);
          slopes_.row(row) += change.x * slope;
          slopes_.row(row + 1) += change.y * slope;
        }
      }
    }
  }

  double weight_of(Eigen::Index row) const {
    return (std::min)(options_.outlier_sd / std::fabs(residuals_[row]), 1.0);
  }

  /// gradient_ becomes the step. `anew`: the normal equations are those at hand, else the last.
  void solve(bool anew) {
    if (anew) {
      normal_.setZero();
    }
    gradient_.setZero();
    for (Eigen::Index row = 0; row < static_cast<Eigen::Index>(2 * places_.size()); ++row) {
      const double weight = weight_of(row);
      if (anew) {
        normal_.selfadjointView<Eigen::Lower>().rankUpdate(slopes_.row(row).transpose(), weight);
      }
      gradient_ += weight * residuals_[row] * slopes_.row(row).transpose();
    }
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      normal_(i, i) += anew ? weight_[k] : 0;
      gradient_[i] += weight_[k] * (centre_[k] - parameters_[k]);
    }
    if (anew) {
      solver_.compute(normal_);
    }
    solver_.solveInPlace(gradient_);
  }

  /// Residuals less the parameters that they determine, at least 1.
  double freedom() {
    auto count = static_cast<double>(2 * places_.size()) - static_cast<double>(weight_.size());
    for (Eigen::Index k = 0; k < gradient_.size(); ++k) {
      gradient_.setZero();
      gradient_[k] = 1;
      solver_.matrixL().solveInPlace(gradient_);
      count += weight_[static_cast<std::size_t>(k)] * gradient_.squaredNorm();
    }
    return (std::max)(count, 1.0);
  }

  void read_load(WrenchResult& result) {
    const double modulus = options_.modulus_n_per_mm;
    const auto load = annulus_.load_at_rim();
    result.force_n = modulus * load.force;
    result.moment_n_mm = modulus * load.moment;
    annulus_.slopes_of_load(of_load_);
    const auto count = static_cast<Eigen::Index>(annulus_.parameters());
    using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Rows, 0, Eigen::OuterStride<>> slope(
        of_load_.data(), 6, count,
        Eigen::OuterStride<>(static_cast<Eigen::Index>(annulus_.width())));
    transposed_ = slope.transpose();
    for (Eigen::Index k = 0; k < 6; ++k) {  // one by one, because a block allocates
      auto column = transposed_.col(k);
      solver_.matrixL().solveInPlace(column);
    }
    result.covariance = transposed_.transpose().lazyProduct(transposed_);
    result.covariance *= square(modulus * result.misfit);
    Eigen::Matrix<double, 6, 1> by_modulus(result.force_n.x, result.force_n.y, result.force_n.z,
                                           result.moment_n_mm.x, result.moment_n_mm.y,
                                           result.moment_n_mm.z);
    turn_to_modulus();
    by_modulus += modulus * slope.lazyProduct(gradient_);
    result.covariance += square(options_.modulus_sd_share) * by_modulus * by_modulus.transpose();
  }

  /// gradient_ becomes the change of the parameters with ln(mu t): of the load, of the places that
  /// the free picture gave, and by the fit to both.
  void turn_to_modulus() {
    const auto last = gradient_.size() - 1;
    const double load = parameters_.back();
    gradient_.setZero();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Mark& mark = places_[i].mark;
      const double h = 0.01;
      const auto nearest = static_cast<std::size_t>(mark.arc_mm / arc_at(1) + 0.5);
      const double arc = (std::clamp)(mark.arc_mm - h * arc_by_load_mm_[nearest], 0.0, reach_mm());
      const auto seen = pixel_of(camera_, annulus_.at(annulus_.place(arc, mark.azimuth_rad)));
      const auto row = static_cast<Eigen::Index>(2 * i);
      for (Eigen::Index k = row; k < row + 2; ++k) {
        const double off = k == row ? seen.x - mark.px.x : seen.y - mark.px.y;
        const double change = (off / mark.sd_px + residuals_[k]) / h - load * slopes_(k, last);
        gradient_ -= weight_of(k) * change * slopes_.row(k).transpose();
      }
    }
    solver_.solveInPlace(gradient_);
    gradient_[last] -= load;
  }

  CameraType camera_;
  WrenchOptions options_;
  FreePad<double> free_;
  Annulus<double> annulus_;
  bool begun_ = false;
  std::vector<double> parameters_, centre_, weight_, of_position_, of_load_;
  FreeRadii free_radius_mm_ = {}, arc_by_load_mm_ = {};  // the latter with ln of the load
  detail::ReservedVector<Seen> places_;
  Eigen::MatrixXd normal_, transposed_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> slopes_;
  Eigen::VectorXd gradient_, residuals_;
  Eigen::LLT<Eigen::MatrixXd> solver_;
  double misfit_ = 0;  // sum of squares
};

}  // namespace v0
}  // namespace fingerpad
