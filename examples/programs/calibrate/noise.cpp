// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates the noise of dots and taxels, and the resulting thresholds.
#include <cmath>
#include <limits>
#include <vector>

#include "calibrate/calibrations.hpp"
#include "calibrate/recordings.hpp"
#include "common/failure.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/foam/recording.hpp"

namespace calibrate {
namespace {

/// Tracks the dots through pictures.
template <class Take>
void follow(fingerpad::DotFinder finder, const std::vector<cv::Mat>& pictures, const Take& take) {
  cv::Mat_<cv::Vec2d> dots(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  for (const cv::Mat& picture : pictures) {
    if (!finder(picture, dots).ok()) {
      dots = cv::Vec2d::all(std::numeric_limits<double>::quiet_NaN());
    }
    take(dots);
  }
}

}  // namespace

Outcome dots(const Path& recording, const Path& sensor_file) {
  auto format = known_pictures(sensor_file);
  format.may_be_grey = format.mosaic.empty();  // as replay reads a pad that has dots only
  const auto pictures = read_pictures(recording / "free", format);
  const fingerpad::DotFinder finder(pictures.front());
  if (!finder.ok()) {
    replay::fail(recording / "free", "the first image shows " + finder.refusal());
  }
  fingerpad::StickRatio<> stick(finder.rows(), finder.cols());
  const fingerpad::LazyView nothing_touches(finder.rows(), finder.cols(),
                                            [](auto, auto) { return false; });
  Plot plot{"frame", "mean distance from frame 0 [px]", {}};
  follow(finder, pictures, [&](const cv::Mat_<cv::Vec2d>& dots) {
    (void)stick(dots, nothing_touches);
    double sum = 0;
    int count = 0;
    for (int i = 0; i < dots.rows; ++i) {
      for (int j = 0; j < dots.cols; ++j) {
        const auto free = finder.free_px()(i, j);
        const double d = std::hypot(dots(i, j)[0] - free.x, dots(i, j)[1] - free.y);
        sum += std::isfinite(d) ? d : 0;
        count += std::isfinite(d) ? 1 : 0;
      }
    }
    plot.points.push_back({static_cast<double>(plot.points.size()), sum / count, 0});
  });
  const double noise_px = stick.noise();
  // with independent noise in two pictures the mean distance is sqrt(pi) sigma
  for (PlotPoint& point : plot.points) {
    point.fitted = point.x > 0 ? std::sqrt(3.141592653589793) * noise_px : 0;
  }
  Report report{.what = "dots", .residual = noise_px, .residual_unit = "px (noise)"};
  report.doubt(!(noise_px > 0), "no two pictures in a row differ and show the same dozen dots");
  report.doubt(pictures.size() < 5, "four frames are too few to estimate the noise: record twenty");
  report.parameters = {{"noise_px", noise_px}};
  Outcome outcome;
  outcome.reports = {report};
  outcome.plots = {plot};
  return outcome;
}

Outcome taxels(const Path& recording) {
  const replay::TaxelTable table = replay::read_taxels(recording / "taxels.csv");
  const auto sensor = replay::read_foam_sensor(recording / "sensor.json");
  fingerpad::TaxelOptions options = sensor.taxels;
  options.noise = 1;
  const std::size_t taxels = table.taxels();
  if (table.samples() > 1) {
    const double period = (table.times_s.back() - table.times_s.front()) / (table.samples() - 1);
    options.sample_period_s = sensor.sample_period_s.value_or(period);
    options.longest_gap_s =
        sensor.longest_gap_s.value_or(std::fmax(options.longest_gap_s, 4 * period));
  }
  fingerpad::TaxelNoiseCalibration calibration(table.rows, table.cols, options);
  for (int k = 0; k < table.samples(); ++k) {
    const fingerpad::StridedView<const double> readings(
        table.readings.data() + static_cast<std::size_t>(k) * taxels, table.rows, table.cols,
        table.cols);
    (void)calibration.add(readings, table.times_s[static_cast<std::size_t>(k)]);
  }
  const auto noise = calibration.fit();
  Report report{
      .what = "taxels", .residual = noise.typical, .residual_unit = "(unit of the readings)"};
  report.parameters = {{"noise", noise.typical, noise.typical_error},
                       {"largest_factor", noise.largest_factor},
                       {"centroid_noise_mm", noise.centroid_deviation_mm},
                       {"windows", static_cast<double>(noise.windows)}};
  report.doubt(!noise.ok(), text_of(noise));
  report.doubt(noise.largest_factor > options.noise_factor,
               "the readings of a window spread by more than noise_factor times the noise: check "
               "that nothing touched the array");
  Outcome outcome;
  outcome.sections["foam"] = {{"noise", noise.typical}};
  Plot plot{"taxel (row by row)", "standard deviation [unit of the readings]", {}};
  for (std::size_t k = 0; k < noise.deviations.size(); ++k) {
    plot.points.push_back({static_cast<double>(k), noise.deviations[k], noise.typical});
  }
  outcome.reports = {report};
  outcome.plots = {plot};
  return outcome;
}

}  // namespace calibrate
