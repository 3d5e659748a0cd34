// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// calibrate today: whether a pad is still as it was calibrated.
#include "calibrate/today.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "calibrate/calibrations.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/median.hpp"
#include "fingerpad/depth/absorption.hpp"

namespace calibrate {
namespace {

/// A square of pixels of the pad: where it lies, and the change of its colours.
struct Block {
  double x, y;                      ///< from the axis, in base radii
  double cap;                       ///< its depth moves by this share of the apex
  double green, red;                ///< ln of today's colour over that of then
  double green_per_mm, red_per_mm;  ///< by the law, per mm of depth
  bool fits = true;
};

struct Factor {
  double value, sd;
};

std::vector<Block> blocks_of(const replay::Sensor& sensor,
                             const cv::Mat& reference,
                             const DepthMap& free_mm,
                             const cv::Mat& now) {
  const int width = (std::max)(8, reference.cols / 53);
  const double units = reference.depth() == CV_16U ? 256 : 1;
  const fingerpad::Absorption<double>& fluid = sensor.absorption;
  std::vector<Block> blocks;
  for (int i = 0; i + width <= reference.rows; i += width) {
    for (int j = 0; j + width <= reference.cols; j += width) {
      const cv::Rect square(j, i, width, width);
      const double row = i + (width - 1) / 2.0, col = j + (width - 1) / 2.0;
      const auto at = point_at(sensor.camera, row, col, 0.0);
      const double x = at.x / sensor.pad.base_radius_mm, y = at.y / sensor.pad.base_radius_mm;
      const double l = cv::mean(free_mm(square))[0];  // NaN if one is
      const cv::Scalar then = cv::mean(reference(square)) / units,
                       here = cv::mean(now(square)) / units;
      const bool counts = x * x + y * y < 0.8 && l > 0 &&
                          (std::min)({then[1], then[2], here[1], here[2]}) > 2 &&
                          (std::max)({then[1], then[2], here[1], here[2]}) < 250;
      if (!counts) {
        continue;
      }
      const auto ray = ray_at_pixel(sensor.camera, row, col);
      const double kappa = sensor.light ? sensor.light->kappa.at({at.x, at.y}) : fluid.kappa;
      const double k = ray.path_factor, delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
      // kappa red = green exp(delta k l) + g W(l) gives g W, and its slope
      const double membrane = then[1] * std::exp(delta * k * l);
      const double scattered = kappa * then[2] - membrane;
      const double slope = scattered * scattered_light_slope(l, fluid.c_red_per_mm, ray) /
                           scattered_light(l, fluid.c_red_per_mm, ray);
      // a spherical cap of height a over the base R has the radius rho = (a^2 + R^2) / (2 a); its
      // height at r changes by dh/da, and the depth along the ray by less, as the ray runs outward
      const double a = sensor.pad.apex_height_mm, base = sensor.pad.base_radius_mm;
      const double rho = (a * a + base * base) / (2 * a), per_a = (1 - (base / a) * (base / a)) / 2;
      const auto on_cap = point_at(sensor.camera, row, col, l);
      const double r = std::hypot(on_cap.x, on_cap.y), rise = std::sqrt(rho * rho - r * r);
      const double cap = (1 - per_a + per_a * rho / rise) / (1 + r / rise * ray.tan_fluid);
      blocks.push_back({x, y, cap, std::log(here[1] / then[1]), std::log(here[2] / then[2]),
                        -fluid.c_green_per_mm * k,
                        (slope - fluid.c_red_per_mm * k * membrane) / (kappa * then[2])});
    }
  }
  return blocks;
}

/// Least squares of `value` by `terms` of the blocks that fit: factors, and standard deviations.
template <class Value, class Terms>
std::vector<Factor> fitted(const std::vector<Block>& blocks,
                           const Value& value,
                           const Terms& terms) {
  const auto count = static_cast<Eigen::Index>(blocks.size());
  const auto n = static_cast<Eigen::Index>(terms(blocks.front()).size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(count, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
  double fitting = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Block& block = blocks[static_cast<std::size_t>(i)];
    if (block.fits) {
      const auto row = terms(block);
      std::copy(row.begin(), row.end(), a.row(i).begin());
      b(i) = value(block);
      fitting += 1;
    }
  }
  const Eigen::MatrixXd inverse = (a.transpose() * a).inverse();
  const Eigen::VectorXd x = inverse * (a.transpose() * b);
  const double variance = (b - a * x).squaredNorm() / (fitting - static_cast<double>(n));
  std::vector<Factor> out;
  for (Eigen::Index k = 0; k < n; ++k) {
    out.push_back({x(k), std::sqrt(variance * inverse(k, k))});
  }
  return out;
}

/// How dark each printed dot is, as a share of the light beside it.
cv::Mat_<float> darkness(const cv::Mat& picture, int dot_px) {
  cv::Mat green, hat;
  cv::extractChannel(picture, green, 1);
  green.convertTo(green, CV_32F);
  cv::log(cv::max(green, 1), green);
  const int size = 2 * dot_px + 1;
  cv::morphologyEx(green, hat, cv::MORPH_BLACKHAT,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {size, size}));
  return hat;
}

/// Dots of the reference of which less than half is seen within half a pitch of where they were.
int dots_gone(const replay::Sensor& sensor,
              const cv::Mat& reference,
              const DepthMap& free_mm,
              const cv::Mat& now) {
  const double per_mm = 1 / sensor.camera.pitch_mm;
  const int dot_px = (std::max)(2, cvRound(sensor.dots->diameter_mm * per_mm));
  const int reach_px = (std::max)(1, cvRound(sensor.dots->pitch_mm * per_mm / 2));
  const cv::Mat_<float> then = darkness(reference, dot_px);
  cv::Mat_<float> nearby;
  cv::dilate(darkness(now, dot_px), nearby,
             cv::Mat::ones(2 * reach_px + 1, 2 * reach_px + 1, CV_8U));
  cv::Mat_<int> label;
  cv::Mat_<int> boxes;
  cv::Mat_<double> centers;
  const cv::Mat dark = (then > 0.1) & (free_mm > 0);
  const int count = cv::connectedComponentsWithStats(dark, label, boxes, centers);
  int gone = 0;
  for (int k = 1; k < count; ++k) {
    const cv::Rect box(boxes(k, cv::CC_STAT_LEFT), boxes(k, cv::CC_STAT_TOP),
                       boxes(k, cv::CC_STAT_WIDTH), boxes(k, cv::CC_STAT_HEIGHT));
    double darkest = 0, left = 0;
    cv::minMaxLoc(then(box), nullptr, &darkest, nullptr, nullptr, label(box) == k);
    cv::minMaxLoc(nearby(box), &left, nullptr, nullptr, nullptr, label(box) == k);
    const bool is_dot = boxes(k, cv::CC_STAT_AREA) > 0.3 * CV_PI / 4 * dot_px * dot_px;
    gone += is_dot && left < 0.5 * darkest ? 1 : 0;
  }
  return gone;
}

/// By how much the picture has moved, px.
cv::Point2d moved_px(const cv::Mat& reference, const cv::Mat& now) {
  const auto logarithm = [](const cv::Mat& picture) {
    cv::Mat green;
    cv::extractChannel(picture, green, 1);
    green.convertTo(green, CV_32F);
    cv::log(cv::max(green, 1), green);
    return green;
  };
  cv::Mat window;
  cv::createHanningWindow(window, reference.size(), CV_32F);
  return cv::phaseCorrelate(logarithm(reference), logarithm(now), window);
}

}  // namespace

bool Change::is_told() const {
  return std::abs(by) > (std::max)(tolerated, 3 * sd);
}

std::vector<Change> changes(const replay::Sensor& sensor,
                            const cv::Mat& reference,
                            const DepthMap& free_mm,
                            const cv::Mat& today) {
  constexpr double still_px = 0.5;
  const cv::Point2d moved = moved_px(reference, today);
  cv::Mat now = today;
  if (cv::norm(moved) > still_px) {
    const cv::Matx23d back(1, 0, -moved.x, 0, 1, -moved.y);
    cv::warpAffine(today, now, back, today.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  }
  std::vector<Block> blocks = blocks_of(sensor, reference, free_mm, now);
  if (blocks.size() < 30) {
    throw replay::Failure("the pad is too dark or saturated in most of the picture");
  }
  const auto colour = [](const Block& b) { return b.red - b.green; };
  const auto by_height = [](const Block& b) {
    return std::array<double, 2>{1, b.cap * (b.red_per_mm - b.green_per_mm)};
  };
  std::vector<Factor> found;
  double spots = 0;
  for (int round = 0; round < 4; ++round) {
    found = fitted(blocks, colour, by_height);
    std::vector<double> left;
    for (const Block& b : blocks) {
      left.push_back(std::abs(colour(b) - found[0].value - found[1].value * by_height(b)[1]));
    }
    const double limit = std::fmax(0.005, 6 * 1.4826 * replay::median_of(left));
    spots = 0;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      blocks[k].fits = left[k] <= limit;
      spots += blocks[k].fits ? 0.0 : 1.0;
    }
  }
  const Factor balance = found[0], apex = found[1];
  const auto lamp = fitted(
      blocks, [&](const Block& b) { return b.green - b.green_per_mm * apex.value * b.cap; },
      [](const Block& b) {
        return std::array<double, 3>{1, b.x, b.y};
      });
  std::vector<Change> all = {
      {"brightness, %", 100 * std::expm1(lamp[0].value), 100 * lamp[0].sd, 5, "absorption"},
      {"brightness from the middle to one side, %", 100 * std::hypot(lamp[1].value, lamp[2].value),
       100 * std::fmax(lamp[1].sd, lamp[2].sd), 2, "absorption"},
      {"red over green, %", 100 * std::expm1(balance.value), 100 * balance.sd,
       // A membrane does not rise as a cap does: over pads of rubber 9 to 14.5 mm high on a base of
       // 18.7 mm, up to 1 mm higher or lower, this hides at most 1.4 % for each mm that is found.
       0.6 + 1.5 * std::abs(apex.value), "white balance of the camera; else absorption"},
      {"height of the apex, mm", apex.value, apex.sd, 0.1,
       "fill the pad to its height; else shape, absorption, contact, rim"},
      {"place in the picture, px", cv::norm(moved), 0, still_px, "camera, and all that follows"},
      {"share with spots, %", 100 * spots / static_cast<double>(blocks.size()), 0, 2,
       "clean the pad and let nothing touch it; then compare again"}};
  if (sensor.dots) {
    all.push_back({"dots that are gone", double(dots_gone(sensor, reference, free_mm, now)), 0, 0,
                   "print them; until then dots and forces do without"});
  }
  return all;
}

bool today(const Path& folder, const Path& pictures) {
  const Path file = folder / "sensor.json";
  const replay::Sensor sensor = known_sensor(file, {"camera", "absorption", "pad", "reference"});
  const cv::Mat reference =
      replay::read_colour_image(folder / sensor.reference_frame, sensor.pictures);
  const DepthMap free_mm = replay::read_depth_image(folder / sensor.reference_depth);
  cv::Mat sum = cv::Mat::zeros(reference.size(), CV_32FC3), now;
  const std::vector<cv::Mat> frames = read_pictures(pictures, sensor.pictures);
  if (frames.front().size() != reference.size() || free_mm.size() != reference.size()) {
    replay::fail(pictures, "the pictures must have the size of the reference and its depth");
  }
  for (const cv::Mat& frame : frames) {
    cv::accumulate(frame, sum);
  }
  const double units = (reference.depth() == CV_16U ? 256.0 : 1.0) /
                       (frames.front().depth() == CV_16U ? 256.0 : 1.0);
  sum.convertTo(now, CV_32F, units / static_cast<double>(frames.size()));
  bool is_same = true;
  for (const Change& change : changes(sensor, reference, free_mm, now)) {
    std::printf("%-42s %+9.3g", change.what, change.by);
    if (change.sd > 0) {
      std::printf(" +- %-7.1g", change.sd);
    } else {
      std::printf("%11s", "");
    }
    std::printf(" %s%s\n", change.is_told() ? "changed: " : "as calibrated",
                change.is_told() ? change.again : "");
    is_same = is_same && !change.is_told();
  }
  std::printf("%s\n", is_same ? "nothing must be done again" : "the sensor has changed");
  return is_same;
}

}  // namespace calibrate
