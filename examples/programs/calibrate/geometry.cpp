// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates the camera.
#include "calibrate/geometry.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <string>

#include "calibrate/recordings.hpp"
#include "common/failure.hpp"
#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_finder.hpp"

namespace calibrate {
namespace {

using fingerpad::Point2;

/// The dots of the target, or of as many rows and columns around its middle as the picture holds.
std::vector<PlateDot> dots_of(const cv::Mat& picture, const Path& folder, const DotPlate& plate) {
  const fingerpad::Point2<double> middle_px = {(picture.cols - 1) / 2.0, (picture.rows - 1) / 2.0};
  for (int out = 0; out <= plate.rows + plate.cols; out += 2) {
    for (int out_rows = 0; out_rows <= out; out_rows += 2) {
      const int rows = plate.rows - out_rows, cols = plate.cols - (out - out_rows);
      if (rows < 5 || cols < 5) {
        continue;
      }
      fingerpad::DotFinderOptions options;
      options.pattern.rows = rows;
      options.pattern.cols = cols;
      const fingerpad::DotFinder finder(picture, options);
      if (!finder.ok() || count_present(finder.free_px()) != rows * cols) {
        continue;
      }
      const auto& px = finder.free_px();
      const Point2<double> pitch_px = px(rows / 2, cols / 2 + 1) - px(rows / 2, cols / 2);
      if (out > 0 && norm(px(rows / 2, cols / 2) - middle_px) > norm(pitch_px) / 2) {
        continue;  // of a target that is cut, another row may have been taken for the middle one
      }
      std::vector<PlateDot> dots;
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < cols; ++j) {
          dots.push_back(
              {{(j - (cols - 1) / 2.0) * plate.pitch_mm, (i - (rows - 1) / 2.0) * plate.pitch_mm},
               px(i, j)});
        }
      }
      return dots;
    }
  }
  replay::fail(folder, "no " + std::to_string(plate.rows) + " x " + std::to_string(plate.cols) +
                           " dots were found, nor 5 x 5 or more of them around the middle of the "
                           "picture; they must be sharp and evenly lit");
}

/// Where the camera stands before the target on the plate.
struct Stand {
  double distance_mm, sd_mm, tilt_rad;
};

/// From pictures of the target, the first on the plate, the others tilted against it.
Stand stand_by_tilts(const std::vector<std::vector<PlateDot>>& targets, const cv::Size& size) {
  std::vector<std::vector<cv::Point3f>> dots(targets.size());
  std::vector<std::vector<cv::Point2f>> px(targets.size());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    for (const PlateDot& dot : targets[k]) {
      dots[k].emplace_back(cv::Point2d(dot.plate_mm.x, dot.plate_mm.y));
      px[k].emplace_back(cv::Point2d(dot.picture_px.x, dot.picture_px.y));
    }
  }
  cv::Mat matrix, lens, lens_sd, place_sd, rest;
  std::vector<cv::Mat> turns, places;
  cv::calibrateCamera(dots, px, size, matrix, lens, turns, places, lens_sd, place_sd, rest,
                      cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3);
  cv::Matx33d axes;
  cv::Rodrigues(turns.front(), axes);
  const cv::Vec3d normal(axes(0, 2), axes(1, 2), axes(2, 2)), place(places.front());
  return {std::abs(normal.dot(place)), place_sd.at<double>(5), std::acos(std::abs(normal[2]))};
}

/// What the pictures of a target determine, in this order.
enum { px_per_mm, aspect, distance, center_x, center_y, k1, turn, turn_high, shift_x, shift_y };
using CameraNumber = fingerpad::Dual<10>;

/// Where a dot of a target `raised_mm` beyond the plate is seen.
Point2<CameraNumber> seen_at(const std::array<CameraNumber, 10>& p,
                             const Point2<double>& plate_mm,
                             bool is_high,
                             double raised_mm) {
  fingerpad::Camera<CameraNumber> camera;
  camera.plate_distance_mm = p[distance];
  camera.center_x_px = p[center_x];
  camera.center_y_px = p[center_y];
  camera.pitch_mm = CameraNumber(1) / p[px_per_mm];
  camera.pixel_aspect = p[aspect];
  camera.distortion_k1 = p[k1];
  const CameraNumber angle = p[is_high ? turn_high : turn], c = cos(angle), s = sin(angle);
  const CameraNumber x = c * plate_mm.x - s * plate_mm.y + (is_high ? p[shift_x] : 0.0);
  const CameraNumber y = s * plate_mm.x + c * plate_mm.y + (is_high ? p[shift_y] : 0.0);
  const CameraNumber far = p[distance] + (is_high ? raised_mm : 0.0);
  return pixel_at_tangents(camera, {x / far, y / far});
}

std::array<CameraNumber, 10> constants(const std::array<double, 10>& p) {
  std::array<CameraNumber, 10> numbers;
  std::copy(p.begin(), p.end(), numbers.begin());
  return numbers;
}

/// Turn, px per mm, and middle of a target by its moments.
struct TargetLook {
  double turn = 0, px_per_mm = 0;
  Point2<double> middle_px = {0, 0};

  explicit TargetLook(const std::vector<PlateDot>& dots) {
    double along = 0, across = 0, square = 0;
    for (const PlateDot& dot : dots) {
      middle_px += (1 / static_cast<double>(dots.size())) * dot.picture_px;
      along += dot.plate_mm.x * dot.picture_px.x + dot.plate_mm.y * dot.picture_px.y;
      across += dot.plate_mm.x * dot.picture_px.y - dot.plate_mm.y * dot.picture_px.x;
      square += squared_norm(dot.plate_mm);
    }
    turn = std::atan2(across, along);
    px_per_mm = std::hypot(along, across) / square;
  }
};

struct CameraEstimate {
  std::array<double, 10> p = {};
  std::array<double, 10> sd = {};
  double residual_px = 0;
};

/// Gauss-Newton from `p`, with the parameters held that `is_held` names.
CameraEstimate estimate_camera(const std::array<const std::vector<PlateDot>*, 2>& pictures,
                               double raised_mm,
                               std::array<double, 10> p,
                               const std::array<bool, 10>& is_held) {
  using Matrix = Eigen::Matrix<double, 10, 10>;
  using Vector = Eigen::Matrix<double, 10, 1>;
  CameraEstimate best;
  for (int step = 0; step < 20; ++step) {
    std::array<CameraNumber, 10> number;
    Matrix normal = Matrix::Zero();  // well conditioned: all lengths are in mm about the middle
    Vector right = Vector::Zero();
    const auto add = [&](const Vector& regressors, double value) {
      normal += regressors * regressors.transpose();
      right += regressors * value;
    };
    double count = 0, residual_sq = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      number[k] = is_held[k] ? CameraNumber(p[k]) : CameraNumber::parameter(p[k], k);
      add(Vector::Unit(static_cast<int>(k)) * (is_held[k] ? 1 : 0), 0);
      count -= is_held[k] ? 0 : 1;
    }
    for (const bool is_high : {false, true}) {
      for (const PlateDot& dot : *pictures[is_high ? 1 : 0]) {
        const auto at = seen_at(number, dot.plate_mm, is_high, raised_mm);
        const Point2<double> miss = dot.picture_px - Point2<double>{at.x.value, at.y.value};
        add(Eigen::Map<const Vector>(at.x.slopes.data()), miss.x);
        add(Eigen::Map<const Vector>(at.y.slopes.data()), miss.y);
        residual_sq += squared_norm(miss);
        count += 2;
      }
    }
    const Matrix inverse = normal.inverse();
    const Vector change = inverse * right;
    double largest = 0;  // change in standard deviations
    best.residual_px = std::sqrt(residual_sq / count);
    best.p = p;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const auto i = static_cast<int>(k);
      p[k] += change(i);
      best.sd[k] = is_held[k] ? std::numeric_limits<double>::quiet_NaN()
                              : best.residual_px * std::sqrt(inverse(i, i));
      largest = std::fmax(largest, std::abs(change(i)) / best.sd[k]);
    }
    if (largest < 1e-3) {
      break;
    }
  }
  return best;
}

}  // namespace

CameraFit fit_camera(const std::vector<PlateDot>& low,
                     const std::vector<PlateDot>& high,
                     double raised_mm,
                     double plate_distance_mm) {
  const TargetLook on_plate(low), raised(high.empty() ? low : high);
  std::array<double, 10> start = {};
  start[px_per_mm] = on_plate.px_per_mm;
  start[aspect] = 1;
  start[distance] = high.empty()
                        ? plate_distance_mm
                        : raised_mm * raised.px_per_mm / (on_plate.px_per_mm - raised.px_per_mm);
  start[center_x] = on_plate.middle_px.x;
  start[center_y] = on_plate.middle_px.y;
  start[turn] = on_plate.turn;
  start[turn_high] = raised.turn;
  std::array<bool, 10> is_held = {};
  is_held[distance] = is_held[turn_high] = is_held[shift_x] = is_held[shift_y] = high.empty();
  const auto estimate = [&] { return estimate_camera({&low, &high}, raised_mm, start, is_held); };
  CameraEstimate fit = estimate();
  is_held[aspect] = std::abs(fit.p[aspect] - 1) < 3 * fit.sd[aspect];
  is_held[k1] = std::abs(fit.p[k1]) < 3 * fit.sd[k1];
  fit = estimate();
  CameraFit found;
  found.camera.plate_distance_mm = fit.p[distance];
  found.camera.center_x_px = fit.p[center_x];
  found.camera.center_y_px = fit.p[center_y];
  found.camera.pitch_mm = 1 / fit.p[px_per_mm];
  found.camera.pixel_aspect = fit.p[aspect];
  found.camera.distortion_k1 = fit.p[k1];
  found.residual_px = fit.residual_px;
  found.pitch_sd_mm = fit.sd[px_per_mm] * found.camera.pitch_mm * found.camera.pitch_mm;
  found.aspect_sd = fit.sd[aspect];
  found.distance_sd_mm = fit.sd[distance];
  found.center_sd_px = std::fmax(fit.sd[center_x], fit.sd[center_y]);
  found.k1_sd = fit.sd[k1];
  found.moved_mm = std::hypot(fit.p[shift_x], fit.p[shift_y]);
  const Point2<double> middle = {fit.p[center_x], fit.p[center_y]};
  for (const PlateDot& dot : low) {
    const auto fitted = seen_at(constants(fit.p), dot.plate_mm, false, 0);
    found.plot.points.push_back({norm(dot.plate_mm), norm(dot.picture_px - middle),
                                 norm(Point2<double>{fitted.x.value, fitted.y.value} - middle)});
  }
  return found;
}

Outcome camera(const Path& recording, const DotPlate& plate) {
  if (plate.rows < 3 || plate.cols < 3 || plate.rows % 2 == 0 || plate.cols % 2 == 0) {
    replay::fail(recording, "the numbers of rows and columns of the target must be odd and >= 3");
  }
  const Path tilted = recording / "plate_tilted";
  const bool is_tilted = std::filesystem::exists(tilted);
  const bool has_raised = !is_tilted && plate.raised_mm > 0;
  const auto look = [&](const Path& folder) {
    return dots_of(read_pictures(folder, plate.format()).front(), folder, plate);
  };
  const std::vector<PlateDot> low = look(recording / "plate");
  const std::vector<PlateDot> high =
      has_raised ? look(recording / "plate_raised") : std::vector<PlateDot>{};
  if (has_raised && !(TargetLook(high).px_per_mm < TargetLook(low).px_per_mm)) {
    replay::fail(recording / "plate_raised",
                 "the dots are not closer together than in plate/; check whether the two folders "
                 "are exchanged");
  }
  Stand stand{plate.plate_distance_mm, std::numeric_limits<double>::quiet_NaN(), 0};
  if (is_tilted) {
    const auto pictures = read_pictures(tilted, plate.format());
    std::vector<std::vector<PlateDot>> targets = {low};
    for (const cv::Mat& picture : pictures) {
      targets.push_back(dots_of(picture, tilted, plate));
    }
    if (targets.size() < 4) {
      replay::fail(tilted, "fewer than three pictures: tilt the target to different sides");
    }
    stand = stand_by_tilts(targets, pictures.front().size());
  }
  CameraFit fit = fit_camera(low, high, plate.raised_mm, stand.distance_mm);
  if (is_tilted) {
    fit.distance_sd_mm = stand.sd_mm;
  }
  fit.camera.refractive_index = plate.refractive_index;
  const auto& found = fit.camera;
  Report report{.what = "camera", .residual = fit.residual_px, .residual_unit = "px (dots)"};
  report.parameters = {{"pitch_mm", found.pitch_mm, fit.pitch_sd_mm},
                       {"center_x_px", found.center_x_px, fit.center_sd_px},
                       {"center_y_px", found.center_y_px, fit.center_sd_px}};
  if (has_raised || is_tilted) {
    report.parameters.push_back({"plate_distance_mm", found.plate_distance_mm, fit.distance_sd_mm});
    report.doubt(fit.distance_sd_mm > 0.02 * found.plate_distance_mm,
                 "the distance is uncertain by more than 2 %: raise or tilt the target further");
    report.doubt(stand.tilt_rad > 0.02,
                 "the camera is tilted against the plate by more than 0.02 rad: set it straight");
    // a center on the axis does not move
    report.doubt(fit.moved_mm > 0.3,
                 "the middle of the target moved by more than 0.3 mm when it was raised: it is not "
                 "on the axis, it was shifted, or the camera is tilted");
  }
  Outcome outcome;
  outcome.sections["camera"] = {{"plate_distance_mm", found.plate_distance_mm},
                                {"refractive_index", plate.refractive_index},
                                {"center_px", {found.center_x_px, found.center_y_px}},
                                {"pitch_mm", found.pitch_mm}};
  auto& section = outcome.sections["camera"];
  if (found.pixel_aspect != 1) {
    report.parameters.push_back({"pixel_aspect", found.pixel_aspect, fit.aspect_sd});
    section["pitch_mm"] = {found.pitch_mm, found.pitch_mm * found.pixel_aspect};
  }
  if (found.distortion_k1 != 0) {
    report.parameters.push_back({"distortion_k1", found.distortion_k1, fit.k1_sd});
    section["distortion"] = {found.distortion_k1, 0};
  }
  if (plate.is_srgb) {
    section["response"] = "srgb";
  }
  if (!plate.mosaic.empty()) {
    section["mosaic"] = plate.mosaic;
  }
  report.doubt(fit.residual_px > 0.2,
               "the dots deviate from their fit by more than 0.2 px: the camera is tilted, the "
               "target is bent, or the lens distorts in another way");
  outcome.reports = {report};
  outcome.plots = {fit.plot};
  return outcome;
}

}  // namespace calibrate
