// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Where the camera is, and the shape of the free pad.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calibrate/calibrations.hpp"
#include "calibrate/recordings.hpp"
#include "fingerpad/adapt/dot_finder.hpp"
#include "replay/io/failure.hpp"
#include "replay/io/images.hpp"
#include "replay/io/number_table.hpp"

namespace calibrate {
namespace {

using fingerpad::Point2;

/// A plate's dots as an affine picture of a square grid, by least squares.
struct PlatePicture {
  Point2<double> middle_px;
  double px_per_mm = 0;
  double anisotropy = 0;  ///< longest over shortest px of a mm, less 1
  double residual_px = 0;
  double middle_sd_px = 0, px_per_mm_sd = 0;
  Plot plot{"distance from the middle of the plate [mm]", "distance in the picture [px]", {}};
};

Eigen::MatrixXd dots_of(const Path& folder, const DotPlate& plate) {
  fingerpad::DotFinderOptions options;
  options.pattern.rows = plate.rows;
  options.pattern.cols = plate.cols;
  const fingerpad::DotFinder finder(read_pictures(folder).front(), options);
  const auto found = finder.ok() ? count_present(finder.free_px()) : 0;
  if (found != plate.rows * plate.cols) {
    replay::fail(folder, std::to_string(found) + " of " + std::to_string(plate.rows) + " x " +
                             std::to_string(plate.cols) +
                             " dots were found: all must be in the picture, sharp and evenly lit");
  }
  Eigen::MatrixXd dots(found, 2);
  for (Eigen::Index k = 0; k < found; ++k) {
    const Point2<double> p = finder.free_px()(k / plate.cols, k % plate.cols);
    dots.row(k) << p.x, p.y;
  }
  return dots;
}

PlatePicture picture_of(const Path& folder, const DotPlate& plate) {
  const Eigen::MatrixXd dots = dots_of(folder, plate);
  Eigen::MatrixXd grid(dots.rows(), 3);  // 1, x, y in mm from the middle dot
  for (Eigen::Index k = 0; k < grid.rows(); ++k) {
    grid.row(k) << 1,
        (static_cast<double>(k % plate.cols) - (plate.cols - 1) / 2.0) * plate.pitch_mm,
        (static_cast<double>(k / plate.cols) - (plate.rows - 1) / 2.0) * plate.pitch_mm;
  }
  const Eigen::MatrixXd affine = grid.colPivHouseholderQr().solve(dots);
  const Eigen::MatrixXd fitted = grid * affine;
  const double freedom = 2 * static_cast<double>(dots.rows()) - 6;
  const Eigen::Matrix2d map = affine.bottomRows(2);
  const Eigen::Vector2d stretch = map.jacobiSvd().singularValues();
  PlatePicture picture;
  picture.middle_px = {affine(0, 0), affine(0, 1)};
  picture.px_per_mm = std::sqrt(std::abs(map.determinant()));
  picture.anisotropy = stretch(0) / stretch(1) - 1;
  picture.residual_px = std::sqrt((dots - fitted).squaredNorm() / freedom);
  picture.middle_sd_px = picture.residual_px / std::sqrt(static_cast<double>(dots.rows()));
  picture.px_per_mm_sd = picture.residual_px / grid.rightCols(2).norm();
  for (Eigen::Index k = 0; k < dots.rows(); ++k) {
    const Eigen::RowVector2d from = affine.row(0);
    picture.plot.points.push_back(
        {grid.row(k).tail(2).norm(), (dots.row(k) - from).norm(), (fitted.row(k) - from).norm()});
  }
  return picture;
}

/// The cap that balls have touched.
struct TouchedCap {
  CapSize size;
  double base_sd_mm = 0, apex_sd_mm = 0, off_axis_mm = 0, off_axis_sd_mm = 0, residual_mm = 0;
  Plot plot{"distance from the axis [mm]", "distance from the center of the cap [mm]", {}};
};

TouchedCap touched_cap(const Path& file, double ball_radius_mm) {
  const replay::NumberTable table(file, {"x_mm", "y_mm", "z_mm"});
  const auto n = static_cast<Eigen::Index>(table.lines().size());
  if (n < 5) {
    replay::fail(file, "has " + std::to_string(n) + " touches; four numbers need 5 or more");
  }
  Eigen::MatrixXd at(n, 3);  // center of the ball
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& v = table.lines()[static_cast<std::size_t>(k)].values;
    at.row(k) << v[0], v[1], v[2] + ball_radius_mm;
  }
  // |p - c|^2 = (R + r)^2 is linear in c and in (R + r)^2 - |c|^2; then least squares of distances
  Eigen::MatrixXd a(n, 4);
  a << 2 * at, Eigen::VectorXd::Ones(n);
  const Eigen::Vector4d linear = a.colPivHouseholderQr().solve(at.rowwise().squaredNorm());
  Eigen::Vector4d p;
  p << linear.head<3>(), std::sqrt(linear(3) + linear.head<3>().squaredNorm());
  Eigen::MatrixXd jacobian(n, 4);
  Eigen::VectorXd left(n);
  for (int step = 0; step < 20; ++step) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Vector3d from = at.row(k).transpose() - p.head<3>();
      left(k) = from.norm() - p(3);
      jacobian.row(k) << -from.transpose() / from.norm(), -1;
    }
    p -= jacobian.colPivHouseholderQr().solve(left);
  }
  const double radius = p(3) - ball_radius_mm;
  const double base_sq = radius * radius - p(2) * p(2);
  if (!(base_sq > 0) || !(radius + p(2) > 0)) {
    replay::fail(file,
                 "the touches lie on no cap over the plate: are they in mm, from the plate's "
                 "inner face up, with the ball's radius right?");
  }
  TouchedCap fit;
  fit.size = {std::sqrt(base_sq), radius + p(2), ball_radius_mm};
  fit.off_axis_mm = p.head<2>().norm();
  fit.residual_mm = std::sqrt(left.squaredNorm() / (std::max)(1.0, static_cast<double>(n - 4)));
  const Eigen::Matrix4d covariance =
      (jacobian.transpose() * jacobian).inverse() * fit.residual_mm * fit.residual_mm;
  const Eigen::Vector4d by_apex(0, 0, 1, 1);
  const Eigen::Vector4d by_base(0, 0, -p(2) / fit.size.base_radius_mm,
                                radius / fit.size.base_radius_mm);
  fit.apex_sd_mm = std::sqrt(by_apex.dot(covariance * by_apex));
  fit.base_sd_mm = std::sqrt(by_base.dot(covariance * by_base));
  fit.off_axis_sd_mm = std::sqrt(covariance(0, 0) + covariance(1, 1));
  for (Eigen::Index k = 0; k < n; ++k) {
    fit.plot.points.push_back({at.row(k).head(2).norm(), left(k) + radius, radius});
  }
  return fit;
}

/// The mean of all pictures, 16 bit, 256 units a grey level.
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

Outcome camera(const Path& recording, const DotPlate& plate) {
  if (plate.rows < 3 || plate.cols < 3 || plate.rows % 2 == 0 || plate.cols % 2 == 0) {
    replay::fail(recording, "rows and columns of the plate's dots must be odd and 3 or more");
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
    const double s = low.px_per_mm, t = high.px_per_mm;
    if (!(t < s)) {
      replay::fail(recording / "plate_raised",
                   "dots do not lie closer than in plate/: were the two "
                   "exchanged?");
    }
    distance = plate.raised_mm * t / (s - t);
    const double relative = std::hypot(low.px_per_mm_sd / s, high.px_per_mm_sd / t);
    const double sd = distance * (distance + plate.raised_mm) / plate.raised_mm * relative;
    report.parameters.push_back({"plate_distance_mm", distance, sd});
    report.doubt(sd > 0.02 * distance, "the distance is known to less than 2 %: raise it further");
    // a middle on the axis stays where it is
    const double moved =
        std::hypot(high.middle_px.x - low.middle_px.x, high.middle_px.y - low.middle_px.y);
    report.doubt(
        moved > 0.3 * low.px_per_mm,
        "the plate's middle moved by more than 0.3 mm when it was raised: it is not on the "
        "axis, or was shifted, or the camera is tilted");
  }
  report.doubt(low.residual_px > 0.5,
               "dots lie off a straight grid by more than half a pixel: a lens "
               "that distorts, or a bent plate");
  report.doubt(low.anisotropy > 0.01,
               "a mm is longer one way than the other by more than 1 %: the camera is tilted");
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
                 "touches lie off a sphere by more than 0.2 mm: give a map of "
                 "the shape instead (reference_depth.tiff)");
    report.doubt(fit.base_sd_mm > 0.2,
                 "the base is uncertain by more than 0.2 mm: touch places "
                 "nearer to the rim");
    report.doubt(
        fit.off_axis_mm > 0.3 + 2 * fit.off_axis_sd_mm,
        "the cap's center is off the axis by more than 0.3 mm: the stage's zero, or the pad, "
        "is not where the plate's middle dot was");
    outcome.plots = {fit.plot};
  } else {
    report.parameters = {{"base_radius_mm", size.base_radius_mm},
                         {"apex_height_mm", size.apex_height_mm}};
    report.residual = std::numeric_limits<double>::quiet_NaN();
    report.doubt(true, "nothing was measured: the shape is that of a cap of the given size");
    outcome.plots = {Plot{"", "", {}}};
  }
  if (!(size.base_radius_mm > 0) || !(size.apex_height_mm > 0)) {
    replay::fail(recording, "base radius and apex height must be > 0");
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
