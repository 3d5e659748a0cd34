// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates the shape of the free pad.
#include "calibrate/shape.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "calibrate/calibrations.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/recording.hpp"
#include "common/table.hpp"
#include "fingerpad/membrane/free_pad.hpp"

namespace calibrate {
namespace {

using fingerpad::Point2;
using fingerpad::Point3;
using Touches = std::vector<Point3<double>>;

constexpr double touch_sd_mm = 0.01;
constexpr std::size_t size = 7;
/// Middle x and y, base radius, and of a rubber its stress-free height, its Mooney share and the
/// logarithm of its load per mm; of a cap its apex and three terms.
using Parameters = std::array<double, size>;

/// The nearest point of a meridian and its distance.
struct Foot {
  Point2<double> at;
  double distance_mm;
};
Foot foot_on(const Meridian& meridian, const Point2<double>& from) {
  Foot best{{0, 0}, std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k + 1 < meridian.size(); ++k) {
    const Point2<double> along = meridian[k + 1] - meridian[k], to = from - meridian[k];
    const double share = std::clamp(dot(to, along) / squared_norm(along), 0.0, 1.0);
    const Point2<double> at = meridian[k] + share * along;
    const double distance = std::sqrt(squared_norm(from - at));
    best = distance < best.distance_mm ? Foot{at, distance} : best;
  }
  return best;
}

class ShapeProblem {
 public:
  ShapeProblem(const Touches& touches, const TouchedPad& pad) : touches_(touches), pad_(pad) {}

  /// Which parameters are searched.
  bool is_free(std::size_t k) const {
    return k == 2 ? pad_.base_radius_mm == 0 : pad_.is_rubber ? k < 6 : true;
  }

  Meridian meridian(const Parameters& p) const {
    if (!pad_.is_rubber) {
      return p[2] > 0 && p[3] > 0 ? cap_meridian(p[2], p[3], &p[4]) : Meridian{};
    }
    if (!(p[2] > 0 && p[3] > p[2] / 50 && p[4] >= 0 && p[4] <= 1)) {
      return {};
    }
    return fingerpad::FreePad<double>({p[2], p[3], p[4]}).meridian(std::exp(p[5]));
  }

  /// Deviations of touches and of what is known, each over its sd; empty where there is no shape.
  std::vector<double> residuals(const Parameters& p) const {
    const Meridian shape = meridian(p);
    std::vector<double> all;
    if (shape.size() < 2) {
      return all;
    }
    for (const auto& t : touches_) {
      all.push_back((foot_on(shape, center(p, t)).distance_mm - pad_.ball_radius_mm) / touch_sd_mm);
    }
    all.push_back(p[0] / 2);
    all.push_back(p[1] / 2);
    if (pad_.is_rubber) {
      const bool known = pad_.stress_free_height_mm > 0;
      all.push_back(known ? (p[3] - pad_.stress_free_height_mm) / 0.3 : p[3] / (0.16 * p[2]) - 2);
      all.push_back(p[4] / 0.1 - 1);
    }
    return all;
  }

  /// The middle of the ball beside the axis.
  Point2<double> center(const Parameters& p, const Point3<double>& touch) const {
    return {std::hypot(touch.x - p[0], touch.y - p[1]), touch.z + pad_.ball_radius_mm};
  }

  Parameters start() const {
    double apex = 0, reach = 0;
    for (const auto& t : touches_) {
      apex = (std::max)(apex, t.z);
      reach = (std::max)(reach, std::hypot(t.x, t.y));
    }
    const double base = pad_.base_radius_mm > 0 ? pad_.base_radius_mm : (std::max)(reach, apex);
    if (!pad_.is_rubber) {
      return {0, 0, base, apex, 0, 0, 0};
    }
    Parameters best{};
    double least = std::numeric_limits<double>::infinity();
    for (const double height : {0.3, 0.45, 0.6, 0.75}) {
      for (int k = 0; k < 24; ++k) {
        const bool known = pad_.stress_free_height_mm > 0;
        const Parameters p = {0,    0,
                              base, known ? pad_.stress_free_height_mm : height * base,
                              0.1,  std::log(2 / base) - 0.25 * k,
                              0};
        const double cost = cost_of(residuals(p));
        if (cost < least) {
          least = cost;
          best = p;
        }
      }
    }
    return best;
  }

  static double cost_of(const std::vector<double>& residuals) {
    double sum = residuals.empty() ? std::numeric_limits<double>::infinity() : 0;
    for (const double r : residuals) {
      sum += r * r;
    }
    return sum;
  }

 private:
  const Touches& touches_;
  const TouchedPad& pad_;
};

/// Derivatives of residuals and apex, by differences to the side on which there is a shape.
struct Slopes {
  std::array<std::vector<double>, size> residuals;
  Parameters apex{};
};
Slopes slopes_at(const ShapeProblem& problem,
                 const Parameters& p,
                 const std::vector<double>& here) {
  Slopes slopes;
  const double apex = problem.meridian(p).front().y;
  for (std::size_t k = 0; k < size; ++k) {
    slopes.residuals[k].assign(here.size(), 0.0);
    for (const double step : {1e-4, -1e-4}) {
      Parameters moved = p;
      moved[k] += step;
      const std::vector<double> there =
          problem.is_free(k) ? problem.residuals(moved) : std::vector<double>();
      if (!there.empty()) {
        for (std::size_t i = 0; i < here.size(); ++i) {
          slopes.residuals[k][i] = (there[i] - here[i]) / step;
        }
        slopes.apex[k] = (problem.meridian(moved).front().y - apex) / step;
        break;
      }
    }
  }
  return slopes;
}

/// Normal equations, with 1 on the diagonal of what is not searched.
using Normal = Eigen::Matrix<double, size, size>;
using Column = Eigen::Matrix<double, size, 1>;
Normal normal_of(const ShapeProblem& problem, const Slopes& slopes, double damping) {
  Normal normal = Normal::Zero();
  for (std::size_t a = 0; a < size; ++a) {
    const auto row = Eigen::Index(a);
    for (std::size_t b = 0; b < size; ++b) {
      for (std::size_t i = 0; i < slopes.residuals[a].size(); ++i) {
        normal(row, Eigen::Index(b)) += slopes.residuals[a][i] * slopes.residuals[b][i];
      }
    }
    normal(row, row) = problem.is_free(a) ? normal(row, row) * (1 + damping) + 1e-12 : 1;
  }
  return normal;
}

Touches read_touches(const Path& file) {
  replay::Table table(file, {"x_mm", "y_mm", "z_mm"});
  Touches touches;
  while (table.next()) {
    touches.push_back({table.number(0), table.number(1), table.number(2)});
  }
  if (touches.size() < 8) {
    replay::fail(file,
                 "has " + std::to_string(touches.size()) + " touches; the fit needs at least 8");
  }
  return touches;
}

/// The mean of all pictures of a folder as they are stored, 16 bit, 256 units per grey level.
cv::Mat mean_picture(const Path& folder) {
  replay::FrameSource source = replay::FrameSource::of_folder(folder);
  cv::Mat sum, mean;
  for (int k = 0; k < source.size(); ++k) {
    const cv::Mat picture = source.next_stored();
    if (!sum.empty() && (picture.size() != sum.size() || picture.channels() != sum.channels())) {
      replay::fail(source.last_file(), "has another size than the pictures before it");
    }
    cv::Mat scaled;
    picture.convertTo(scaled, CV_64F, picture.depth() == CV_16U ? 1 : 256);
    sum = sum.empty() ? scaled : cv::Mat(sum + scaled);
  }
  sum.convertTo(mean, CV_16U, 1.0 / source.size());
  return mean;
}

}  // namespace

Meridian cap_meridian(double base_radius_mm, double apex_height_mm, const double* terms) {
  const double b = base_radius_mm, h = apex_height_mm, radius = (b * b + h * h) / (2 * h);
  Meridian meridian;
  for (int k = 0; k <= 600; ++k) {
    const double angle = 2 * std::atan(h / b) * k / 600, r = radius * std::sin(angle);
    const double s = (r / b) * (r / b);
    const double more =
        terms != nullptr ? (1 - s) * s * (terms[0] + s * (terms[1] + s * terms[2])) : 0;
    meridian.push_back({r, radius * std::cos(angle) - radius + h + more});
  }
  return meridian;
}

TouchedShape fit_shape(const Touches& touches_mm, const TouchedPad& pad) {
  const ShapeProblem problem(touches_mm, pad);
  Parameters p = problem.start();
  std::vector<double> here = problem.residuals(p);
  TouchedShape fit;
  if (here.empty()) {
    return fit;
  }
  double damping = 1e-3;
  Slopes slopes = slopes_at(problem, p, here);
  for (int step = 0; step < 60 && damping < 1e9; ++step) {
    Column down = Column::Zero();
    for (std::size_t k = 0; k < size; ++k) {
      for (std::size_t i = 0; i < here.size(); ++i) {
        down(Eigen::Index(k)) -= slopes.residuals[k][i] * here[i];
      }
    }
    const Column change = normal_of(problem, slopes, damping).inverse() * down;
    Parameters next = p;
    for (std::size_t k = 0; k < size; ++k) {
      next[k] += change(Eigen::Index(k));
    }
    if (pad.is_rubber) {
      next[4] = std::clamp(next[4], 0.0, 1.0);
    }
    std::vector<double> there = problem.residuals(next);
    const double gain = ShapeProblem::cost_of(here) - ShapeProblem::cost_of(there);
    if (gain > 0) {
      p = next;
      here = std::move(there);
      slopes = slopes_at(problem, p, here);
      damping /= 10;
      if (gain < 1e-6 * ShapeProblem::cost_of(here)) {
        break;
      }
    } else {
      damping *= 10;
    }
  }

  fit.meridian = problem.meridian(p);
  fit.base_radius_mm = p[2];
  fit.apex_height_mm = fit.meridian.front().y;
  fit.off_axis_mm = std::hypot(p[0], p[1]);
  double left_sq = 0;
  for (const auto& t : touches_mm) {
    const auto center = problem.center(p, t);
    const Foot foot = foot_on(fit.meridian, center);
    const double left = foot.distance_mm - pad.ball_radius_mm;
    left_sq += left * left;
    fit.reach_mm = (std::max)(fit.reach_mm, foot.at.x);
    fit.plot.points.push_back({foot.at.x, foot.at.y + left, foot.at.y});
  }
  const auto count = static_cast<double>(touches_mm.size());
  fit.residual_mm = std::sqrt(left_sq / count);
  const double sd = std::sqrt(left_sq / (std::max)(1.0, count - 4)) / touch_sd_mm;
  const Normal covariance = normal_of(problem, slopes, 0).inverse();
  const auto of = [&](const Parameters& by) {
    const Eigen::Map<const Column> column(by.data());
    return sd * std::sqrt(column.dot(covariance * column));
  };
  fit.apex_sd_mm = of(slopes.apex);
  fit.base_sd_mm = problem.is_free(2) ? of({0, 0, 1, 0, 0, 0, 0}) : 0;
  fit.off_axis_sd_mm = std::hypot(of({1, 0, 0, 0, 0, 0, 0}), of({0, 1, 0, 0, 0, 0, 0}));
  return fit;
}

DepthMap depth_of_shape(const fingerpad::Camera<double>& camera,
                        cv::Size picture,
                        const Meridian& meridian) {
  // where the rays through the meridian meet the plate, rising to the rim
  Meridian seen;
  for (const auto& [r, z] : meridian) {
    const auto px = pixel_of(camera, Point3<double>{r, 0, z});
    const auto at = point_at(camera, px.y, px.x, 0.0);
    const double rho = std::hypot(at.x, at.y);
    if (seen.empty() || rho > seen.back().x) {
      seen.push_back({rho, z});
    }
  }
  DepthMap depth(picture);
  for (int i = 0; i < depth.rows; ++i) {
    for (int j = 0; j < depth.cols; ++j) {
      const auto at = point_at(camera, double(i), double(j), 0.0);
      const double rho = std::hypot(at.x, at.y);
      depth(i, j) = std::numeric_limits<float>::quiet_NaN();
      if (rho < meridian.back().x) {
        const auto next = std::lower_bound(seen.begin() + 1, seen.end() - 1, rho,
                                           [](const auto& p, double x) { return p.x < x; });
        const auto last = next - 1;
        const double share = (rho - last->x) / (next->x - last->x);
        depth(i, j) = static_cast<float>((std::max)(0.0, last->y + share * (next->y - last->y)));
      }
    }
  }
  return depth;
}

Outcome shape(const Path& recording, const Path& sensor_file, const PadSize& given) {
  const replay::Sensor sensor = known_sensor(sensor_file, {"camera"});
  Report report{.what = "shape", .residual_unit = "mm (touches)"};
  Outcome outcome;
  Meridian meridian;
  double base_mm = given.base_radius_mm, apex_mm = given.apex_height_mm;
  if (given.ball_radius_mm > 0) {
    const Path file = recording / "touches.csv";
    const TouchedShape fit =
        fit_shape(read_touches(file), {given.ball_radius_mm, given.base_radius_mm,
                                       given.stress_free_height_mm, !given.no_rubber});
    if (fit.meridian.empty()) {
      replay::fail(file,
                   "no inflated rubber passes near the touches; give them in mm above the inner "
                   "face of the plate, and check the radii of ball and base");
    }
    meridian = fit.meridian;
    base_mm = fit.base_radius_mm;
    apex_mm = fit.apex_height_mm;
    report.residual = fit.residual_mm;
    report.parameters = {{"base_radius_mm", base_mm, fit.base_sd_mm},
                         {"apex_height_mm", apex_mm, fit.apex_sd_mm},
                         {"off_axis_mm", fit.off_axis_mm, fit.off_axis_sd_mm},
                         {"touched_to_mm", fit.reach_mm}};
    const double other_mm =
        given.no_rubber
            ? fit.residual_mm
            : fit_shape(read_touches(file), {given.ball_radius_mm, base_mm, 0, false}).residual_mm;
    report.doubt(fit.residual_mm > 2 * (std::max)(other_mm, 0.005),
                 "a cap with three terms fits the touches twice as well as an inflated rubber: use "
                 "--no-rubber, or check the base radius and the ball's");
    char where[160];
    std::snprintf(
        where, sizeof where,
        "the ball touched the pad out to %.1f of %.1f mm only, beyond which a pad without "
        "rubber is unknown: touch with the ball's center beyond the rim",
        fit.reach_mm, base_mm);
    report.doubt(given.no_rubber && fit.reach_mm < 0.8 * base_mm, where);
    report.doubt(fit.residual_mm > 0.1,
                 "the touches deviate from the shape by more than 0.1 mm: touch more gently, or "
                 "give a depth map (reference_depth.tiff) instead");
    report.doubt(
        fit.base_sd_mm > 0.2,
        "the base radius is uncertain by more than 0.2 mm: give it, or touch nearer to the "
        "rim");
    report.doubt(fit.off_axis_mm > 0.3 + 2 * fit.off_axis_sd_mm,
                 "the center of the pad is more than 0.3 mm off the axis: the zero of the stage, "
                 "or the pad, is not at the middle dot of the target");
    outcome.plots = {fit.plot};
  } else {
    if (!(base_mm > 0) || !(apex_mm > 0)) {
      replay::fail(recording, "the base radius and the apex height must be > 0");
    }
    meridian = cap_meridian(base_mm, apex_mm);
    report.parameters = {{"base_radius_mm", base_mm}, {"apex_height_mm", apex_mm}};
    report.residual = std::numeric_limits<double>::quiet_NaN();
    report.doubt(true, "nothing was measured: the shape is a cap of the given size");
    outcome.plots = {Plot{"", "", {}}};
  }
  const Path picture = recording / "reference.png";
  if (!std::filesystem::exists(picture)) {
    replay::write_png(picture, mean_picture(recording / "free"));
  }
  replay::write_depth_image(
      recording / "reference_depth.tiff",
      depth_of_shape(sensor.camera, replay::read_stored_image(picture).size(), meridian));
  outcome.sections["pad"] = {{"base_radius_mm", base_mm}, {"apex_height_mm", apex_mm}};
  outcome.sections["reference"] = {{"frame", "reference.png"}, {"depth", "reference_depth.tiff"}};
  outcome.reports = {report};
  return outcome;
}

}  // namespace calibrate
