// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates the camera and the shape of the free pad.
#include "calibrate/geometry.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calibrate/recordings.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "replay/io/failure.hpp"
#include "replay/io/images.hpp"
#include "replay/io/number_table.hpp"

namespace calibrate {
namespace {

using fingerpad::Point2;

std::vector<PlateDot> dots_of(const Path& folder, const DotPlate& plate) {
  fingerpad::DotFinderOptions options;
  options.pattern.rows = plate.rows;
  options.pattern.cols = plate.cols;
  const fingerpad::DotFinder finder(read_pictures(folder).front(), options);
  const auto found = finder.ok() ? count_present(finder.free_px()) : 0;
  if (found != plate.rows * plate.cols) {
    replay::fail(folder, std::to_string(found) + " of " + std::to_string(plate.rows) + " x " +
                             std::to_string(plate.cols) +
                             " dots were found; all must be in the image, sharp and evenly lit");
  }
  std::vector<PlateDot> dots;
  for (int i = 0; i < plate.rows; ++i) {
    for (int j = 0; j < plate.cols; ++j) {
      dots.push_back({{(j - (plate.cols - 1) / 2.0) * plate.pitch_mm,
                       (i - (plate.rows - 1) / 2.0) * plate.pitch_mm},
                      finder.free_px()(i, j)});
    }
  }
  return dots;
}

PlatePicture picture_of(const Path& folder, const DotPlate& plate) {
  return fit_plate(dots_of(folder, plate));
}

TouchedCap touched_cap(const Path& file, double ball_radius_mm) {
  const replay::NumberTable table(file, {"x_mm", "y_mm", "z_mm"});
  std::vector<fingerpad::Point3<double>> touches;
  for (const auto& line : table.lines()) {
    touches.push_back({line.values[0], line.values[1], line.values[2]});
  }
  if (touches.size() < 5) {
    replay::fail(file, "has " + std::to_string(touches.size()) +
                           " touches; the fit of four parameters needs at least 5");
  }
  const TouchedCap fit = fit_cap(touches, ball_radius_mm);
  if (std::isnan(fit.size.base_radius_mm)) {
    replay::fail(file,
                 "the touches are not on a cap above the plate; give them in mm above the inner "
                 "face of the plate, and check the radius of the ball");
  }
  return fit;
}

/// Least squares of N parameters by normal equations, which are well conditioned here: all lengths
/// are in mm about the middle of a pad. (A decomposition of all rows takes ten seconds to compile.)
template <int N>
class LeastSquares {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;

  void add(const Vector& regressors, double value) {
    normal_ += regressors * regressors.transpose();
    right_ += regressors * value;
  }
  Eigen::Matrix<double, N, N> inverse() const { return normal_.inverse(); }
  Vector solution() const { return inverse() * right_; }

 private:
  Eigen::Matrix<double, N, N> normal_ = Eigen::Matrix<double, N, N>::Zero();
  Vector right_ = Vector::Zero();
};

/// The mean of all pictures, 16 bit, 256 units per grey level.
cv::Mat mean_picture(const std::vector<cv::Mat>& pictures) {
  cv::Mat sum(pictures.front().size(), CV_64FC3, cv::Scalar::all(0)), mean;
  for (const cv::Mat& picture : pictures) {
    cv::Mat scaled;
    picture.convertTo(scaled, CV_64F, picture.depth() == CV_16U ? 1 : 256);
    sum += scaled;
  }
  sum.convertTo(mean, CV_16U, 1.0 / static_cast<double>(pictures.size()));
  return mean;
}

}  // namespace

PlatePicture fit_plate(const std::vector<PlateDot>& pairs) {
  const auto regressors = [](const PlateDot& dot) {
    return Eigen::Vector3d(1, dot.plate_mm.x, dot.plate_mm.y);
  };
  LeastSquares<3> x_px, y_px;
  for (const PlateDot& dot : pairs) {
    x_px.add(regressors(dot), dot.picture_px.x);
    y_px.add(regressors(dot), dot.picture_px.y);
  }
  Eigen::Matrix<double, 3, 2> affine;
  affine << x_px.solution(), y_px.solution();
  const Eigen::RowVector2d middle = affine.row(0);
  PlatePicture picture;
  double residual_sq = 0, distance_sq = 0;
  for (const PlateDot& dot : pairs) {
    const Eigen::RowVector2d seen(dot.picture_px.x, dot.picture_px.y);
    const Eigen::RowVector2d fitted = regressors(dot).transpose() * affine;
    const double distance_mm = std::hypot(dot.plate_mm.x, dot.plate_mm.y);
    residual_sq += (seen - fitted).squaredNorm();
    distance_sq += distance_mm * distance_mm;
    picture.plot.points.push_back({distance_mm, (seen - middle).norm(), (fitted - middle).norm()});
  }
  const auto count = static_cast<double>(pairs.size());
  const double xx = affine(1, 0), xy = affine(1, 1), yx = affine(2, 0), yy = affine(2, 1);
  // The two scales of a map are the sum and the difference of its turning and its mirroring part.
  const double turning = std::hypot(xx + yy, xy - yx), mirroring = std::hypot(xx - yy, xy + yx);
  picture.middle_px = {middle(0), middle(1)};
  picture.px_per_mm = std::sqrt(std::abs(xx * yy - xy * yx));
  picture.anisotropy = (turning + mirroring) / std::abs(turning - mirroring) - 1;
  picture.residual_px = std::sqrt(residual_sq / (2 * count - 6));
  picture.middle_sd_px = picture.residual_px / std::sqrt(count);
  picture.px_per_mm_sd = picture.residual_px / std::sqrt(distance_sq);
  return picture;
}

PlateDistance plate_distance(const PlatePicture& low, const PlatePicture& high, double raised_mm) {
  const double s = low.px_per_mm, t = high.px_per_mm;
  const double distance = raised_mm * t / (s - t);
  const double relative = std::hypot(low.px_per_mm_sd / s, high.px_per_mm_sd / t);
  return {distance, distance * (distance + raised_mm) / raised_mm * relative};
}

TouchedCap fit_cap(const std::vector<fingerpad::Point3<double>>& touches_mm,
                   double ball_radius_mm) {
  std::vector<Eigen::Vector3d> centers;  // of the ball
  for (const auto& touch : touches_mm) {
    centers.emplace_back(touch.x, touch.y, touch.z + ball_radius_mm);
  }
  // |p - c|^2 = (R + r)^2 is linear in c and in (R + r)^2 - |c|^2. This gives the start for the
  // least squares of distances.
  LeastSquares<4> start;
  for (const Eigen::Vector3d& at : centers) {
    start.add({2 * at(0), 2 * at(1), 2 * at(2), 1}, at.squaredNorm());
  }
  const Eigen::Vector4d linear = start.solution();
  Eigen::Vector4d p;
  p << linear.head<3>(), std::sqrt(linear(3) + linear.head<3>().squaredNorm());
  LeastSquares<4> step;
  double left_sq = 0;
  for (int k = 0; k < 20; ++k) {
    step = {};
    left_sq = 0;
    for (const Eigen::Vector3d& at : centers) {
      const Eigen::Vector3d from = at - p.head<3>();
      const double distance = from.norm();
      const double left = distance - p(3);
      step.add({-from(0) / distance, -from(1) / distance, -from(2) / distance, -1}, left);
      left_sq += left * left;
    }
    p -= step.solution();
  }
  const double radius = p(3) - ball_radius_mm;
  const double base_sq = radius * radius - p(2) * p(2);
  TouchedCap fit;
  fit.size = {base_sq > 0 && radius + p(2) > 0 ? std::sqrt(base_sq)
                                               : std::numeric_limits<double>::quiet_NaN(),
              radius + p(2), ball_radius_mm};
  fit.off_axis_mm = p.head<2>().norm();
  const double freedom = (std::max)(1.0, static_cast<double>(centers.size()) - 4);
  fit.residual_mm = std::sqrt(left_sq / freedom);
  const Eigen::Matrix4d covariance = step.inverse() * fit.residual_mm * fit.residual_mm;
  const Eigen::Vector4d by_apex(0, 0, 1, 1);
  const Eigen::Vector4d by_base(0, 0, -p(2) / fit.size.base_radius_mm,
                                radius / fit.size.base_radius_mm);
  fit.apex_sd_mm = std::sqrt(by_apex.dot(covariance * by_apex));
  fit.base_sd_mm = std::sqrt(by_base.dot(covariance * by_base));
  fit.off_axis_sd_mm = std::sqrt(covariance(0, 0) + covariance(1, 1));
  for (const Eigen::Vector3d& at : centers) {
    fit.plot.points.push_back(
        {at.head<2>().norm(), (at - p.head<3>()).norm() - ball_radius_mm, radius});
  }
  return fit;
}

Outcome camera(const Path& recording, const DotPlate& plate) {
  if (plate.rows < 3 || plate.cols < 3 || plate.rows % 2 == 0 || plate.cols % 2 == 0) {
    replay::fail(recording, "the numbers of rows and columns of the target must be odd and >= 3");
  }
  const PlatePicture low = picture_of(recording / "plate", plate);
  Report report{.what = "camera", .residual = low.residual_px, .residual_unit = "px (dots)"};
  double distance = plate.plate_distance_mm;
  const double pitch = 1 / low.px_per_mm;
  report.parameters = {{"pitch_mm", pitch, pitch * pitch * low.px_per_mm_sd},
                       {"center_x_px", low.middle_px.x, low.middle_sd_px},
                       {"center_y_px", low.middle_px.y, low.middle_sd_px}};
  if (plate.raised_mm > 0) {
    const PlatePicture high = picture_of(recording / "plate_raised", plate);
    if (!(high.px_per_mm < low.px_per_mm)) {
      replay::fail(recording / "plate_raised",
                   "the dots are not closer together than in plate/; check whether the two folders "
                   "are exchanged");
    }
    const PlateDistance found = plate_distance(low, high, plate.raised_mm);
    const double sd = found.sd_mm;
    distance = found.mm;
    report.parameters.push_back({"plate_distance_mm", distance, sd});
    report.doubt(sd > 0.02 * distance,
                 "the distance is uncertain by more than 2 %: raise the target further");
    // a center on the axis does not move
    const double moved =
        std::hypot(high.middle_px.x - low.middle_px.x, high.middle_px.y - low.middle_px.y);
    report.doubt(moved > 0.3 * low.px_per_mm,
                 "the middle of the target moved by more than 0.3 mm when it was raised: it is not "
                 "on the axis, it was shifted, or the camera is tilted");
  }
  report.doubt(low.residual_px > 0.5,
               "the dots deviate from a straight grid by more than half a pixel: the lens "
               "distorts, or the target is bent");
  report.doubt(low.anisotropy > 0.01,
               "the scales in two directions differ by more than 1 %: the camera is tilted");
  Outcome outcome;
  outcome.sections["camera"] = {{"plate_distance_mm", distance},
                                {"refractive_index", plate.refractive_index},
                                {"center_px", {low.middle_px.x, low.middle_px.y}},
                                {"pitch_mm", pitch}};
  outcome.reports = {report};
  outcome.plots = {low.plot};
  return outcome;
}

Outcome shape(const Path& recording, const Path& sensor_file, const CapSize& given) {
  const replay::Sensor sensor = known_sensor(sensor_file, {"camera"});
  Report report{.what = "shape", .residual_unit = "mm (touches)"};
  Outcome outcome;
  CapSize size = given;
  if (given.ball_radius_mm > 0) {
    const TouchedCap fit = touched_cap(recording / "touches.csv", given.ball_radius_mm);
    size = fit.size;
    report.residual = fit.residual_mm;
    report.parameters = {{"base_radius_mm", size.base_radius_mm, fit.base_sd_mm},
                         {"apex_height_mm", size.apex_height_mm, fit.apex_sd_mm},
                         {"off_axis_mm", fit.off_axis_mm, fit.off_axis_sd_mm}};
    report.doubt(fit.residual_mm > 0.2,
                 "the touches deviate from a sphere by more than 0.2 mm: give a depth map "
                 "(reference_depth.tiff) instead");
    report.doubt(fit.base_sd_mm > 0.2,
                 "the base radius is uncertain by more than 0.2 mm: touch nearer to the rim");
    report.doubt(fit.off_axis_mm > 0.3 + 2 * fit.off_axis_sd_mm,
                 "the center of the cap is more than 0.3 mm off the axis: the zero of the stage, "
                 "or the pad, is not at the middle dot of the target");
    outcome.plots = {fit.plot};
  } else {
    report.parameters = {{"base_radius_mm", size.base_radius_mm},
                         {"apex_height_mm", size.apex_height_mm}};
    report.residual = std::numeric_limits<double>::quiet_NaN();
    report.doubt(true, "nothing was measured: the shape is a cap of the given size");
    outcome.plots = {Plot{"", "", {}}};
  }
  if (!(size.base_radius_mm > 0) || !(size.apex_height_mm > 0)) {
    replay::fail(recording, "the base radius and the apex height must be > 0");
  }
  const Path picture = recording / "reference.png";
  if (!std::filesystem::exists(picture)) {
    replay::write_png(picture, mean_picture(read_pictures(recording / "free")));
  }
  replay::write_depth_image(
      recording / "reference_depth.tiff",
      spherical_cap_depth(sensor.camera, replay::read_colour_image(picture).size(),
                          size.base_radius_mm, size.apex_height_mm));
  outcome.sections["pad"] = {{"base_radius_mm", size.base_radius_mm},
                             {"apex_height_mm", size.apex_height_mm}};
  outcome.sections["reference"] = {{"frame", "reference.png"}, {"depth", "reference_depth.tiff"}};
  outcome.reports = {report};
  return outcome;
}

}  // namespace calibrate
