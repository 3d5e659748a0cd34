// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "replay/check/parts.hpp"

namespace replay {
namespace {

/// Measures of the free pad's known depth.
struct Shape {
  double deepest_mm = 0;
  double area_px = 0;
  double not_positive = 0;  ///< share of the known pixels with depth <= 0
  cv::Vec2d center_px{0, 0};
  double middle_mm = 0;  ///< mean of the inner tenth of the area
  double outer_mm = 0;   ///< mean of the outer half
  bool cut = false;      ///< the pad reaches the frame's border
};

Shape shape_of(const cv::Mat_<float>& depth_mm) {
  Shape shape;
  const cv::Mat known = depth_mm == depth_mm;  // NaN equals nothing
  shape.area_px = cv::countNonZero(known);
  if (shape.area_px < 1) {
    return shape;
  }
  cv::minMaxLoc(depth_mm, nullptr, &shape.deepest_mm, nullptr, nullptr, known);
  shape.not_positive = cv::countNonZero(depth_mm <= 0) / shape.area_px;
  const cv::Moments m = cv::moments(known, true);
  shape.center_px = {m.m10 / m.m00, m.m01 / m.m00};
  const double radius_px = std::sqrt(shape.area_px / CV_PI);
  double middle = 0, outer = 0;
  for (int i = 0; i < depth_mm.rows; ++i) {
    for (int j = 0; j < depth_mm.cols; ++j) {
      const double depth = static_cast<double>(depth_mm(i, j));
      if (std::isfinite(depth)) {
        const double from_center = cv::norm(cv::Vec2d(j, i) - shape.center_px) / radius_px;
        const bool in_middle = from_center * from_center < 0.1;
        const bool is_outer = from_center * from_center > 0.5;
        shape.middle_mm += in_middle ? depth : 0;
        middle += in_middle ? 1 : 0;
        shape.outer_mm += is_outer ? depth : 0;
        outer += is_outer ? 1 : 0;
        shape.cut =
            shape.cut || i == 0 || j == 0 || i == depth_mm.rows - 1 || j == depth_mm.cols - 1;
      }
    }
  }
  shape.middle_mm /= middle;
  shape.outer_mm /= outer;
  return shape;
}

void check_shape(const Recording& recording, const Shape& shape, Findings& findings) {
  const Sensor& sensor = recording.sensor;
  const std::string place = sensor.reference_depth;
  if (shape.area_px < 1) {
    findings.push_back({place, "no pixel has a depth", "Give the depth of the free pad in mm."});
    return;
  }
  const double ratio = shape.deepest_mm / sensor.pad.apex_height_mm;
  if (!(ratio > 0.5 && ratio < 2)) {
    findings.push_back({place,
                        "the largest depth is " + short_number(shape.deepest_mm) +
                            ", but pad.apex_height_mm is " +
                            short_number(sensor.pad.apex_height_mm),
                        ratio < 0.01 ? "If the unit is m, multiply by 1000."
                                     : "Give both in mm above the plate."});
  } else if (shape.deepest_mm > sensor.absorption.max_depth_mm) {
    findings.push_back({"sensor.json, absorption.max_depth_mm",
                        "the value is " + short_number(sensor.absorption.max_depth_mm) +
                            ", but the free pad is " + short_number(shape.deepest_mm) + " mm deep",
                        "Set it somewhat larger than the height of the pad."});
  }
  if (shape.not_positive > 0.02) {
    findings.push_back({place,
                        short_number(100 * shape.not_positive) + " % of the depths are not above 0",
                        "Write NaN outside the pad; depths are heights above the plate."});
  } else if (shape.middle_mm < shape.outer_mm) {
    findings.push_back({place, "the depth is smaller in the middle than at the rim",
                        "Give the height of the free pad above the plate, not an indentation."});
  }
}

void check_camera(const Recording& recording, const Shape& shape, Findings& findings) {
  const Sensor& sensor = recording.sensor;
  const auto& camera = sensor.camera;
  const double radius_mm = std::sqrt(shape.area_px / CV_PI) * camera.pitch_mm;
  const double base_mm = sensor.pad.base_radius_mm;
  if (!shape.cut && shape.not_positive < 0.02 &&
      !(radius_mm > 0.8 * base_mm && radius_mm < 1.25 * base_mm)) {
    findings.push_back({"sensor.json, camera.pitch_mm",
                        "the pad's depth covers a radius of " + short_number(radius_mm) +
                            " mm on the plate, but pad.base_radius_mm is " + short_number(base_mm),
                        "Give the size of a pixel on the plate's inner face, in mm."});
  }
  const double off_mm =
      cv::norm(shape.center_px - cv::Vec2d(camera.center_x_px, camera.center_y_px)) *
      camera.pitch_mm;
  if (!shape.cut && off_mm > 0.1 * base_mm) {
    findings.push_back({"sensor.json, camera.center_px",
                        "the pad is " + short_number(off_mm) + " mm away from it, around [" +
                            short_number(shape.center_px[0]) + ", " +
                            short_number(shape.center_px[1]) + "]",
                        "Give [x, y], with x along the columns."});
  }
}

/// Regression of ln(green / red) on depth: slope, 1/mm, and correlation.
struct ColourSlope {
  double slope = 0;
  double correlation = 0;
};

ColourSlope colour_slope(const cv::Mat& picture, const cv::Mat_<float>& depth_mm) {
  cv::Mat plane;
  cv::extractChannel(picture, plane, 1);
  const cv::Mat_<float> green(plane);
  cv::extractChannel(picture, plane, 2);
  const cv::Mat_<float> red(plane);
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (int i = 0; i < depth_mm.rows; ++i) {
    for (int j = 0; j < depth_mm.cols; ++j) {
      const auto depth = static_cast<double>(depth_mm(i, j));
      if (std::isfinite(depth) && green(i, j) > 0 && red(i, j) > 0) {
        const double ratio = std::log(static_cast<double>(green(i, j) / red(i, j)));
        n += 1;
        x += depth;
        y += ratio;
        xx += depth * depth;
        xy += depth * ratio;
        yy += ratio * ratio;
      }
    }
  }
  const double sxx = xx - x * x / n;
  const double sxy = xy - x * y / n;
  const double syy = yy - y * y / n;
  return {sxy / sxx, sxy / std::sqrt(sxx * syy)};
}

/// Share of the deeper half of the pad in which red is darker than absorption alone predicts from
/// green. There the light scattered by the fluid, which adds to red, would be negative.
double share_without_scattering(const Recording& recording, double deepest_mm) {
  const auto& absorption = recording.sensor.absorption;
  const double delta = absorption.c_green_per_mm - absorption.c_red_per_mm;
  cv::Mat plane;
  cv::extractChannel(recording.reference, plane, 1);
  const cv::Mat_<float> green(plane);
  cv::extractChannel(recording.reference, plane, 2);
  const cv::Mat_<float> red(plane);
  double deep = 0, without = 0;
  for (int i = 0; i < green.rows; ++i) {
    for (int j = 0; j < green.cols; ++j) {
      const auto depth = static_cast<double>(recording.reference_depth(i, j));
      if (depth > deepest_mm / 2) {
        constexpr double path = 2;  // down and back up
        const double left = static_cast<double>(green(i, j)) * std::exp(delta * path * depth);
        deep += 1;
        without += absorption.kappa * static_cast<double>(red(i, j)) < left ? 1 : 0;
      }
    }
  }
  return without / deep;
}

void check_colours(const Recording& recording, const Shape& shape, Findings& findings) {
  const auto& absorption = recording.sensor.absorption;
  const ColourSlope found = colour_slope(recording.reference, recording.reference_depth);
  const std::string place = recording.sensor.reference_frame;
  const double depths = 2 * absorption.c_red_per_mm * recording.sensor.pad.apex_height_mm;
  if (!(std::abs(found.correlation) > 0.3)) {
    findings.push_back({place,
                        "its colours do not depend on the depth (correlation " +
                            short_number(found.correlation) + ")",
                        "Check that it is a colour image of the free pad, and that the depth is "
                        "along the same rays."});
  } else if (found.slope > 0) {
    findings.push_back({place, "red fades faster with depth than green",
                        "Check whether red and green are exchanged; the fluid is red."});
  } else if (!(depths > 0.01 && depths < 10) ||
             share_without_scattering(recording, shape.deepest_mm) > 0.5) {
    findings.push_back({"sensor.json, absorption",
                        "the colours of the reference do not fit these coefficients",
                        "Give the coefficients in 1/mm, or calibrate the fluid again."});
  }
}

/// Checks that the depths are along the pixels' rays: heights in plan view are nearer to those of a
/// cap in plan view.
void check_view(const Recording& recording, Findings& findings) {
  const Pad& pad = recording.sensor.pad;
  const double base_sq = pad.base_radius_mm * pad.base_radius_mm;
  const double radius = (base_sq / pad.apex_height_mm + pad.apex_height_mm) / 2;
  double along_sq = 0, plan_sq = 0;
  for (int i = 0; i < recording.reference_depth.rows; ++i) {
    for (int j = 0; j < recording.reference_depth.cols; ++j) {
      const auto depth = static_cast<double>(recording.reference_depth(i, j));
      const auto miss_sq = [&](double seen_at_mm) {
        const auto at = point_at(recording.sensor.camera, double(i), double(j), seen_at_mm);
        const double rho_sq = at.x * at.x + at.y * at.y;
        const double cap = pad.apex_height_mm - radius + std::sqrt(radius * radius - rho_sq);
        return rho_sq < 0.6 * base_sq ? (depth - cap) * (depth - cap) : 0;
      };
      along_sq += std::isfinite(depth) ? miss_sq(depth) : 0;
      plan_sq += std::isfinite(depth) ? miss_sq(0) : 0;
    }
  }
  if (plan_sq < along_sq / 4) {
    findings.push_back({recording.sensor.reference_depth,
                        "the depths are those of a pad in plan view",
                        "Give the height along the ray of each pixel, not in plan view."});
  }
}

/// Checks that picture and depth match pixel by pixel.
void check_fit(const Recording& recording, Findings& findings) {
  const auto fit = [&]<class Pixel>(Pixel) {
    (void)fingerpad::fit_reference(recording.sensor.camera, recording.sensor.absorption,
                                   fingerpad::channel<Pixel>(recording.reference, 2),
                                   fingerpad::channel<Pixel>(recording.reference, 1),
                                   recording.reference_depth,
                                   recording.sensor.light ? &*recording.sensor.light : nullptr);
  };
  try {
    recording.reference.depth() == CV_16U ? fit(std::uint16_t()) : fit(std::uint8_t());
  } catch (const fingerpad::parameter_error& refusal) {
    findings.push_back({recording.sensor.reference_depth, refusal.what(),
                        "Give the height of the free pad along the ray of each pixel."});
  }
}

}  // namespace

void check_reference(const Recording& recording, Findings& findings) {
  const std::size_t before = findings.size();
  const Shape shape = shape_of(recording.reference_depth);
  check_shape(recording, shape, findings);
  if (shape.area_px >= 1) {
    check_camera(recording, shape, findings);
    check_colours(recording, shape, findings);
  }
  if (findings.size() == before) {  // else the cause is already reported
    check_view(recording, findings);
    check_fit(recording, findings);
  }
}

}  // namespace replay
