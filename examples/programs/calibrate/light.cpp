// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates the light: absorption of the fluid, light from neighbouring membrane, and the contact
// threshold above the noise.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calibrate/calibrations.hpp"
#include "calibrate/recordings.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/median.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"

namespace calibrate {
namespace {

using fingerpad::Index;
using Sample = fingerpad::DepthSample<double>;

/// Window with the same width on the plate as the published 29 px of 0.08 mm.
int window_px(const replay::Sensor& sensor) {
  return sensor.smoothing_px.value_or(
      2 * static_cast<int>(std::lround(29 * 0.08 / sensor.camera.pitch_mm / 2 - 0.5)) + 1);
}

/// The free pad and frames of known depth.
struct KnownFrames {
  replay::Sensor sensor;
  cv::Mat reference;
  DepthMap free_mm;
  std::vector<cv::Mat> frames;
  std::vector<DepthMap> depths_mm;
};

cv::Mat in_grey_levels(const cv::Mat& picture) {
  cv::Mat grey;
  picture.convertTo(grey, CV_32F, picture.depth() == CV_16U ? 1.0 / 256 : 1.0);
  return grey;
}

/// A file of the free pad, which sensor.json names from the recording's folder until `calibrate
/// all` or a person moves it, then from its own.
Path reference_file(const Path& recording, const Path& sensor_file, const std::string& name) {
  const Path in_recording = recording / name;
  return std::filesystem::exists(in_recording) ? in_recording : sensor_file.parent_path() / name;
}

/// Reads the picture of the free pad and its depth.
void read_reference(const Path& recording,
                    const Path& sensor_file,
                    const replay::Sensor& sensor,
                    cv::Mat& reference,
                    DepthMap& free_mm) {
  reference = replay::read_colour_image(
      reference_file(recording, sensor_file, sensor.reference_frame), sensor.pictures);
  free_mm =
      replay::read_depth_image(reference_file(recording, sensor_file, sensor.reference_depth));
}

KnownFrames read_known(const Path& recording,
                       const Path& sensor_file,
                       const std::vector<std::string>& sections) {
  KnownFrames known{known_sensor(sensor_file, sections), {}, {}, {}, {}};
  read_reference(recording, sensor_file, known.sensor, known.reference, known.free_mm);
  known.frames = read_pictures(recording / "frames", known.sensor.pictures);
  if (known.frames.front().size() != known.reference.size() ||
      known.free_mm.size() != known.reference.size()) {
    replay::fail(recording, "the frames, the reference and its depth must have the same size");
  }
  known.depths_mm = true_depths(recording, known.sensor, known.free_mm, known.frames.size());
  return known;
}

/// Samples of a picture, or of all.
struct Samples {
  std::vector<Sample> all;
  std::vector<std::size_t> end;  ///< of the free pad, and of each press
};

/// Adds the mean colours of squares in which each pixel has a depth and a colour. A margin at the
/// rim excludes light from beside the pad.
void add_blocks(const replay::Sensor& sensor,
                const cv::Mat& picture,
                const DepthMap& depth_mm,
                Samples& samples) {
  const int width = (std::max)(8, picture.cols / 53);
  const double most_mm = 0.97 * sensor.pad.base_radius_mm;
  const cv::Mat_<cv::Vec3f> grey = in_grey_levels(picture).reshape(3);
  cv::Mat curved;
  cv::Laplacian(grey, curved, CV_32F);
  for (int i = 0; i + width <= grey.rows; i += width) {
    for (int j = 0; j + width <= grey.cols; j += width) {
      const cv::Rect block(j, i, width, width);
      const double row = i + (width - 1) / 2.0, col = j + (width - 1) / 2.0;
      const auto at_plate = point_at(sensor.camera, row, col, 0.0);
      if (!(std::hypot(at_plate.x, at_plate.y) < most_mm)) {
        continue;
      }
      const double depth = cv::mean(depth_mm(block))[0];  // NaN if one is
      double darkest = 0, brightest = 0;
      cv::minMaxLoc(grey(block).clone().reshape(1), &darkest, &brightest);
      const cv::Scalar colour = cv::mean(grey(block));
      if (depth >= 0 && brightest < 250 && colour[1] > 0 && colour[2] > 0) {
        samples.all.push_back(
            fingerpad::depth_sample(sensor.camera, row, col, depth, {colour[2], colour[1]}));
        samples.all.back().green_laplacian = cv::mean(curved(block))[1];
      }
    }
  }
  samples.end.push_back(samples.all.size());
}

Samples samples_of(const KnownFrames& known) {
  Samples samples;
  add_blocks(known.sensor, known.reference, known.free_mm, samples);
  const std::size_t of_reference = samples.all.size();
  for (std::size_t k = 0; k < known.frames.size(); ++k) {
    add_blocks(known.sensor, known.frames[k], known.depths_mm[k], samples);
  }
  if (samples.all.size() < of_reference + 10) {
    throw replay::Failure(
        "frames/: fewer than 10 places are in contact; use larger balls or deeper presses, or "
        "correct the places in presses.csv");
  }
  return samples;
}

using Fit = fingerpad::AbsorptionFit<double, 6>;

/// Takes the places where the free pad errs by more than six sd of the others (glare, dirt, a
/// scratch) out of all pictures. False if there are none.
bool leave_out_spots(const Fit& fit, Samples& samples) {
  std::vector<double> error_mm;
  for (std::size_t k = 0; k < samples.end.front(); ++k) {
    error_mm.push_back(std::abs(fit.error_mm(samples.all[k])));
  }
  const double limit_mm = 6 * 1.4826 * replay::median_of(error_mm);
  std::vector<fingerpad::Point2<double>> spots;
  for (std::size_t k = 0; k < error_mm.size(); ++k) {
    if (error_mm[k] > limit_mm) {
      spots.push_back(samples.all[k].plate_mm);
    }
  }
  Samples kept;
  std::size_t k = 0;
  for (const std::size_t end : samples.end) {
    for (; k < end; ++k) {
      const auto lies_here = [&](const auto& at) {
        return squared_norm(at - samples.all[k].plate_mm) == 0;
      };
      if (std::none_of(spots.begin(), spots.end(), lies_here)) {
        kept.all.push_back(samples.all[k]);
      }
    }
    kept.end.push_back(kept.all.size());
  }
  samples = std::move(kept);
  return !spots.empty();
}

/// Names the press that is not where presses.csv says: its depths are off on average, or scatter
/// as those of a ball that lies aside. "" if there is none.
std::string misplaced_press(const std::vector<double>& error_mm, const Samples& samples) {
  std::vector<double> mean, sd;
  for (std::size_t k = 0; k + 1 < samples.end.size(); ++k) {
    const auto first = error_mm.begin() + static_cast<std::ptrdiff_t>(samples.end[k]);
    const auto last = error_mm.begin() + static_cast<std::ptrdiff_t>(samples.end[k + 1]);
    const auto count = static_cast<double>(last - first);
    mean.push_back(count < 10 ? 0 : std::accumulate(first, last, 0.0) / count);
    const double sum_sq = std::inner_product(first, last, first, 0.0);
    sd.push_back(count < 10 ? 0 : std::sqrt((std::max)(0.0, sum_sq / count - mean[k] * mean[k])));
  }
  std::vector<double> sorted = sd;
  std::sort(sorted.begin(), sorted.end());
  std::size_t worst = 0;
  const double usual = (std::max)(0.015, sorted[sorted.size() / 2]);
  const auto excess = [&](std::size_t k) {
    const auto count = static_cast<double>(samples.end[k + 1] - samples.end[k]);
    const double by_noise = 3 * usual / std::sqrt((std::max)(count, 1.0));
    return (std::max)(std::abs(mean[k]) / (0.03 + by_noise), sd[k] / (2 * usual));
  };
  for (std::size_t k = 1; k < mean.size(); ++k) {
    worst = excess(k) > excess(worst) ? k : worst;
  }
  if (mean.empty() || excess(worst) <= 1) {
    return "";
  }
  char text[200];
  std::snprintf(text, sizeof text,
                "press %zu is not where presses.csv says: its depths are off by %.3f mm on average "
                "and scatter by %.3f mm, usual %.3f; measure it again or leave it out",
                worst, mean[worst], sd[worst], usual);
  return text;
}

cv::Mat in_16_bit(const cv::Mat& picture) {
  cv::Mat wide;
  picture.convertTo(wide, CV_16U, picture.depth() == CV_16U ? 1 : 256);
  return wide;
}

auto reference_of(const replay::Sensor& sensor, const cv::Mat& picture, const DepthMap& free_mm) {
  const cv::Mat wide = in_16_bit(picture);
  return fingerpad::fit_reference(
      sensor.camera, sensor.absorption, fingerpad::channel<std::uint16_t>(wide, 2),
      fingerpad::channel<std::uint16_t>(wide, 1), free_mm, sensor.light ? &*sensor.light : nullptr);
}

/// Measures the depth of frames with the sensor as calibrated so far.
class DepthMeter {
 public:
  DepthMeter(const replay::Sensor& sensor, const cv::Mat& reference, const DepthMap& free_mm)
      : estimate_(sensor.camera,
                  sensor.absorption,
                  reference_of(sensor, reference, free_mm),
                  {.window_px = window_px(sensor)}) {}

  DepthMap operator()(const cv::Mat& frame) {
    const cv::Mat wide = in_16_bit(frame);
    DepthMap depth(frame.size());
    (void)estimate_(fingerpad::channel<std::uint16_t>(wide, 2),
                    fingerpad::channel<std::uint16_t>(wide, 1), depth);
    return depth;
  }

 private:
  fingerpad::DepthEstimator<float> estimate_;
};

/// Root mean square of what depths of the free pad differ from its shape, at heights that an object
/// touches: above a third of the apex.
double depth_noise_mm(const std::vector<DepthMap>& depths_mm,
                      const DepthMap& free_mm,
                      double apex_mm) {
  double sum_sq = 0, count = 0;
  for (const DepthMap& depth_mm : depths_mm) {
    const cv::Mat used = (depth_mm == depth_mm) & (free_mm > apex_mm / 3);
    sum_sq += std::pow(cv::norm(depth_mm, free_mm, cv::NORM_L2, used), 2);
    count += cv::countNonZero(used);
  }
  return std::sqrt(sum_sq / count);
}

}  // namespace

Outcome absorption(const Path& recording, const Path& sensor_file) {
  const KnownFrames known = read_known(recording, sensor_file, {"camera", "pad", "reference"});
  Samples samples = samples_of(known);
  const auto seen = static_cast<double>(samples.all.size());
  Fit fit = fingerpad::fit_absorption<6>(std::span<const Sample>(samples.all));
  for (int round = 0; round < 5 && leave_out_spots(fit, samples); ++round) {
    fit = fingerpad::fit_absorption<6>(std::span<const Sample>(samples.all));
  }
  const auto deepest =
      *std::max_element(samples.all.begin(), samples.all.end(),
                        [](const Sample& a, const Sample& b) { return a.depth_mm < b.depth_mm; });
  const double depth_sd = predicted_depth_sd(fit, deepest);
  std::vector<double> error_mm;
  for (const Sample& s : samples.all) {
    error_mm.push_back(fit.error_mm(s));
  }
  const double left_mm =
      std::sqrt(std::inner_product(error_mm.begin(), error_mm.end(), error_mm.begin(), 0.0) /
                static_cast<double>(error_mm.size()));
  const auto sd = [&](std::size_t k) { return std::sqrt(fit.covariance[k][k]); };
  const auto& fluid = fit.fluid;
  const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
  Report report{.what = "absorption", .residual = left_mm, .residual_unit = "mm (depth)"};
  report.parameters = {
      {"c_red_per_mm", fluid.c_red_per_mm, sd(0)},
      {"c_green_less_c_red_per_mm", delta, sd(1)},
      {"kappa", fluid.kappa, sd(2)},
      {"red_blur", fit.red_blur, sd(fit.parameters - 1)},
      {"share_with_glare_or_dirt", 1 - static_cast<double>(samples.all.size()) / seen},
      {"depth_sd_at_deepest_mm", depth_sd},
      {"explained_by_depth", fit.explained}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = fit.covariance[i];
    report.covariance.push_back({row[0], row[1], row[2]});
  }
  const cv::Mat pad = known.free_mm > 0;
  report.doubt(replay::saturated_share(known.reference, pad) > replay::most_saturated,
               "more than 1 % of the pad is saturated, where depth is not known: shorten the "
               "exposure or lower the gain of that colour, and record everything again");
  report.doubt(!fit.ok(), text_of(fit));
  const std::string misplaced = misplaced_press(error_mm, samples);
  report.doubt(!misplaced.empty(), misplaced);
  report.doubt(replay::step_between_blocks(known.reference, pad) > replay::compressed_step,
               "the pictures were compressed: depths are right to what is left over, but c_red and "
               "c_green err by more than their sd; calibrate with PNG or raw pictures");
  report.doubt(
      left_mm > 0.05 && fit.red_blur > 5 * sd(fit.parameters - 1),
      "depths at known places are off by more than 0.05 mm, by noise or by a mosaic that samples "
      "the edges of dots too coarsely: c_green less c_red errs by more than its sd; use more "
      "light, a lens that blurs by a pixel, or a wider window");
  const bool mixed = sd(0) > fluid.c_red_per_mm / 2;
  report.doubt(depth_sd > 0.05,
               std::string("the fit alone makes depths uncertain by more than 0.05 mm") +
                   (mixed ? " (c_red and kappa could not be separated)" : "") +
                   ": press at more places and depths");
  report.doubt(
      left_mm > 0.15,
      "the depths at known places deviate by more than 0.15 mm: average more frames of each press, "
      "use more light, or check the shape of the free pad");
  report.doubt(fit.delta_at_limit,
               "green is not absorbed more than red: check whether red and green are exchanged");
  Outcome outcome;
  outcome.sections["absorption"] = {{"c_red_per_mm", fluid.c_red_per_mm},
                                    {"c_green_per_mm", fluid.c_green_per_mm},
                                    {"kappa", fluid.kappa},
                                    {"max_depth_mm", 1.2 * known.sensor.pad.apex_height_mm}};
  outcome.sections["light"] = {{"scale_mm", fit.light.kappa.scale_mm},
                               {"kappa", fit.light.kappa.coefficient},
                               {"scattering", fit.light.scattering.coefficient}};
  outcome.sections["smoothing_px"] = window_px(known.sensor);
  Plot plot{"depth [mm]", "depth by the fit [mm]", {}};
  for (std::size_t k = 0; k < samples.all.size(); ++k) {
    const double depth_mm = samples.all[k].depth_mm;
    plot.points.push_back({depth_mm, depth_mm + error_mm[k], depth_mm});
  }
  outcome.reports = {report};
  outcome.plots = {plot};
  return outcome;
}

Outcome neighbour_light(const Path& recording, const Path& sensor_file, int max_radius_px) {
  const KnownFrames known =
      read_known(recording, sensor_file, {"camera", "pad", "reference", "absorption"});
  DepthMeter meter(known.sensor, known.reference, known.free_mm);
  const DepthMap free_mm = meter(known.reference);
  std::vector<DepthMap> measured;
  for (const cv::Mat& frame : known.frames) {
    measured.push_back(meter(frame));
  }
  // distance between the points that neighbouring pixels see at the pad's mean depth
  const auto& camera = known.sensor.camera;
  const double mean_mm = cv::mean(free_mm, free_mm == free_mm)[0];
  const double pitch = point_at(camera, camera.center_y_px, camera.center_x_px + 1, mean_mm).x -
                       point_at(camera, camera.center_y_px, camera.center_x_px, mean_mm).x;
  const auto fit = fingerpad::fit_neighbour_light(pitch, free_mm, measured, known.depths_mm,
                                                  {1, max_radius_px}, camera.pixel_aspect);
  Report report{.what = "neighbour_light", .residual = fit.rms_after_mm, .residual_unit = "mm"};
  report.parameters = {{"radius_px", static_cast<double>(fit.light.radius_px)},
                       {"m0_mm_per_rad", fit.light.m0_mm_per_rad, fit.m0_sd},
                       {"n_per_mm", fit.light.n_per_mm, fit.n_sd},
                       {"residual_without_it_mm", fit.rms_before_mm}};
  report.doubt(!fit.ok(), text_of(fit));
  Outcome outcome;
  outcome.sections["neighbour_light"] = {{"radius_px", fit.light.radius_px},
                                         {"m0_mm_per_rad", fit.light.m0_mm_per_rad},
                                         {"n_per_mm", fit.light.n_per_mm}};
  Plot plot{"radius [px]", "error of depth [mm]", {}, "before", "after"};
  for (std::size_t k = 0; k < fit.rms_of_radius_mm.size(); ++k) {
    plot.points.push_back({static_cast<double>(k + 1), fit.rms_before_mm, fit.rms_of_radius_mm[k]});
  }
  outcome.reports = {report};
  outcome.plots = {plot};
  return outcome;
}

Outcome contact(const Path& recording, const Path& sensor_file, double pressure_mpa) {
  replay::Sensor sensor = known_sensor(sensor_file, {"camera", "pad", "reference", "absorption"});
  cv::Mat reference;
  DepthMap free_mm;
  read_reference(recording, sensor_file, sensor, reference, free_mm);
  const std::vector<cv::Mat> frames = read_pictures(recording / "free", sensor.pictures);
  for (const cv::Mat& frame : frames) {
    if (frame.size() != reference.size()) {
      replay::fail(recording / "free", "the frames must have the size of the reference");
    }
  }
  // Noise may set the threshold, and not the edge: then a wider window and a wider ring, in turn,
  // average it away. The ring takes the larger share, since a window biases depth where a small
  // object presses.
  const int first_px = window_px(sensor), wider_px = (std::max)(2, first_px / 8 * 2);
  replay::Contact found;
  std::vector<DepthMap> depths_mm;
  fingerpad::ThresholdFit<double> pad;
  constexpr int last_step = 8;
  for (int step = 0; step <= last_step; ++step) {
    sensor.smoothing_px = first_px + wider_px * ((step + 1) / 2);
    const double wider = 1 + double(wider_px * (step / 2)) / first_px;
    found.ring_px = fingerpad::ContactTest().ring_px * wider * wider;
    DepthMeter meter(sensor, reference, free_mm);
    depths_mm.clear();
    for (const cv::Mat& frame : frames) {
      depths_mm.push_back(meter(frame));
    }
    try {
      pad = fit_contact_threshold(sensor.camera, depths_mm, found.ring_px);
    } catch (const fingerpad::parameter_error&) {  // all noise
      if (step == last_step) {
        throw;
      }
      continue;
    }
    if (pad.threshold_per_mm >= 0.4 * pad.median_per_mm) {
      break;
    }
  }
  const DepthMap& last = depths_mm.back();
  found.depth_noise_mm = depth_noise_mm(depths_mm, free_mm, sensor.pad.apex_height_mm);
  fingerpad::ContactTest test;
  test.threshold_per_mm = pad.threshold_per_mm;
  test.faint_per_mm = pad.faint_per_mm;
  test.ring_px = found.ring_px;
  const auto limit = fingerpad::detection_limit(sensor.camera, depths_mm, test, pad.median_per_mm,
                                                sensor.pad.base_radius_mm);
  Report report{.what = "contact", .residual = pad.noise_per_mm, .residual_unit = "1/mm (noise)"};
  report.parameters = {{"threshold_per_mm", pad.threshold_per_mm, pad.median_error_per_mm / 2},
                       {"curvature_of_free_pad_per_mm", pad.median_per_mm, pad.median_error_per_mm},
                       {"ring_px", found.ring_px},
                       {"depth_noise_mm", *found.depth_noise_mm},
                       {"smoothing_px", double(*sensor.smoothing_px)},
                       {"free_frames_that_seem_touched", double(limit.false_frames)},
                       {"felt_from_mm", limit.depth_mm},
                       {pressure_mpa > 0 ? "felt_from_n" : "felt_from_n_per_mpa",
                        limit.area_mm2() * (pressure_mpa > 0 ? pressure_mpa : 1)}};
  report.doubt(!pad.ok(), text_of(pad));
  report.doubt(2 * cv::countNonZero(last == last) < cv::countNonZero(free_mm == free_mm),
               "fewer than half of the pad's pixels have a depth: check calibration, exposure and "
               "frame");
  report.doubt(frames.size() < 3,
               "two frames are too few to estimate the noise: record sixteen or more");
  report.doubt(pad.threshold_per_mm < 0.4 * pad.median_per_mm,
               "the threshold is set by the noise instead of the edge: use more light");
  Outcome outcome;
  outcome.sections["contact"] = {{"threshold_per_mm", pad.threshold_per_mm},
                                 {"ring_px", found.ring_px},
                                 {"depth_noise_mm", *found.depth_noise_mm}};
  if (pad.faint_per_mm > pad.threshold_per_mm) {
    outcome.sections["contact"]["faint_per_mm"] = pad.faint_per_mm;
  }
  outcome.sections["smoothing_px"] = *sensor.smoothing_px;
  Plot plot{"column on the middle row [px]", "depth of the free pad [mm]", {}};
  const int row = reference.rows / 2;
  for (int j = 0; j < reference.cols; j += 4) {
    if (std::isfinite(last(row, j)) && std::isfinite(free_mm(row, j))) {
      plot.points.push_back({double(j), double(last(row, j)), double(free_mm(row, j))});
    }
  }
  outcome.reports = {report};
  outcome.plots = {plot};
  return outcome;
}

}  // namespace calibrate
