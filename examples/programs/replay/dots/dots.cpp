// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/dots.hpp"

#include <algorithm>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "common/median.hpp"
#include "replay/dots/file.hpp"

namespace replay {
namespace {

constexpr int first_frames = 10;  // a camera's first frames may be dark

/// The mean of green and red, which is the fluid's light, in grey levels of 8 bit.
cv::Mat_<float> light_of(const cv::Mat& image) {
  cv::Mat_<float> light;
  const double unit = image.depth() == CV_16U ? 1.0 / 256 : 1.0;
  if (image.channels() == 1) {
    image.convertTo(light, CV_32F, unit);
    return light;
  }
  cv::Mat green, red;
  cv::extractChannel(image, green, 1);
  cv::extractChannel(image, red, 2);
  cv::addWeighted(green, 0.5 * unit, red, 0.5 * unit, 0, light, CV_32F);
  return light;
}

/// Empty for a print that cannot be followed: dots too small, or too few that look like a disc.
std::optional<fingerpad::DotFollower> follower_of(const fingerpad::DotFinder& finder,
                                                  const cv::Mat& free_frame) {
  try {
    return fingerpad::DotFollower(light_of(free_frame), finder.free_px(),
                                  {.radius_px = finder.pattern().radius_px});
  } catch (const fingerpad::parameter_error&) {
    return std::nullopt;
  }
}

DotGrid free_dots(const fingerpad::DotFinder& finder) {
  DotGrid dots(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  const auto found = finder.free_px();
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      dots(i, j) = {found(i, j).x, found(i, j).y};
    }
  }
  return dots;
}

/// Whether equal rows and columns of two grids denote the same dots.
bool agree(const DotGrid& a, const DotGrid& b, double pitch_px) {
  int both = 0;
  int near = 0;
  for (int i = 0; i < a.rows; ++i) {
    for (int j = 0; j < a.cols; ++j) {
      if (is_present(a(i, j)) && is_present(b(i, j))) {
        ++both;
        near += cv::norm(a(i, j) - b(i, j)) < 0.5 * pitch_px ? 1 : 0;
      }
    }
  }
  return 2 * near > both;
}

fingerpad::DotFinder finder_of(const std::filesystem::path& folder,
                               const cv::Mat& free_frame,
                               const fingerpad::DotFinderOptions& options) {
  try {
    return fingerpad::DotFinder(free_frame, options);
  } catch (const fingerpad::parameter_error& error) {
    fail(folder / "sensor.json", std::string("section dots: ") + error.what());
  }
}

}  // namespace

constexpr double nearest_mm = 1.5;  // nearer, the clamp bends the sheet and the rim blurs a dot

std::optional<fingerpad::SideDots> side_dots_of(const Sensor& sensor, const cv::Mat& free_frame) {
  std::vector<fingerpad::SideRow> rows;
  if (sensor.rim) {
    std::copy_if(sensor.rim->side_rows.begin(), sensor.rim->side_rows.end(),
                 std::back_inserter(rows),
                 [](const fingerpad::SideRow& row) { return row.arc_mm >= nearest_mm; });
  }
  if (rows.empty()) {
    return std::nullopt;
  }
  return fingerpad::SideDots(light_of(free_frame), sensor.camera, sensor.pad.base_radius_mm, rows);
}

fingerpad::DotFinderOptions print_of(const Sensor& sensor,
                                     const cv::Mat_<float>& reference_depth,
                                     const std::optional<fingerpad::SideDots>& side) {
  fingerpad::DotFinderOptions options;
  options.where = cv::Mat_<uchar>(reference_depth.size(), uchar{0});
  std::vector<float> depths_mm;
  float least_mm = 0;  // lower are dots of a row that is too near the rim, and no print
  for (const auto& row : sensor.rim ? sensor.rim->side_rows : std::vector<fingerpad::SideRow>()) {
    least_mm = row.arc_mm < nearest_mm ? std::max(least_mm, float(1.25 * row.arc_mm)) : least_mm;
  }
  for (int i = 0; i < reference_depth.rows; ++i) {
    for (int j = 0; j < reference_depth.cols; ++j) {
      if (std::isfinite(reference_depth(i, j))) {
        options.where(i, j) = reference_depth(i, j) < least_mm ? 0 : 1;
        depths_mm.push_back(reference_depth(i, j));
      }
    }
  }
  for (const auto& dot : side ? side->free_px() : std::vector<fingerpad::Point2<double>>()) {
    if (is_present(dot)) {
      cv::circle(options.where, cv::Point(cvRound(dot.x), cvRound(dot.y)), cvCeil(side->reach_px()),
                 0, cv::FILLED);
    }
  }
  if (depths_mm.empty()) {
    return options;
  }
  const double depth_mm = static_cast<double>(median_of(depths_mm));
  const auto x_px = [&](double x_mm) {
    return pixel_of(sensor.camera, fingerpad::Point3<double>{x_mm, 0, depth_mm}).x;
  };
  const double px_per_mm = x_px(0.5) - x_px(-0.5);
  options.pattern.rows = sensor.dots->rows;
  options.pattern.cols = sensor.dots->cols;
  options.pattern.radius_px = sensor.dots->diameter_mm / 2 * px_per_mm;
  options.pattern.pitch_px = sensor.dots->pitch_mm * px_per_mm;
  options.pattern.bright = false;
  options.pattern.middle_px = {sensor.camera.center_x_px, sensor.camera.center_y_px};
  options.color_weights = {0, 1, 1};  // the fluid's light is red and green
  return options;
}

void DotSource::read(const std::filesystem::path& file, int frame_count, cv::Size size) {
  how_ = "dots.csv";
  listed_ = read_dots(file, frame_count, size.empty() ? std::nullopt : std::optional(size));
  initial_ = listed_.begin()->second;
}

void DotSource::follow(fingerpad::DotFinder finder, const DotGrid& free) {
  how_ = "found in the frames";
  initial_ = free;
  finder_ = std::move(finder);
}

DotSource::DotSource(const std::filesystem::path& folder,
                     const Sensor& sensor,
                     const cv::Mat& reference_image,
                     const cv::Mat_<float>& reference_depth,
                     int frame_count) {
  side_ = side_dots_of(sensor, reference_image);
  std::optional<fingerpad::DotFinder> finder;
  if (sensor.dots) {
    finder = finder_of(folder, reference_image, print_of(sensor, reference_depth, side_));
  }
  const bool found = finder && finder->ok();
  DotGrid free;
  if (found) {
    free = free_dots(*finder);
    follower_ = follower_of(*finder, reference_image);
    DotGrid followed(free.size());
    if (follower_ && (*follower_)(light_of(reference_image), followed).ok()) {
      free = followed;
    }
  }
  if (frame_count > 0 && std::filesystem::exists(folder / "dots.csv")) {
    const cv::Size size = sensor.dots ? cv::Size(sensor.dots->cols, sensor.dots->rows) : cv::Size();
    read(folder / "dots.csv", frame_count, size);
    if (found && fingerpad::count_present(free) > fingerpad::count_present(initial_) &&
        agree(free, initial_, finder->pattern().pitch_px)) {
      initial_ = free;
    }
  } else if (found) {
    follow(std::move(*finder), free);
  }
}

DotSource DotSource::of_dots_only(const std::filesystem::path& folder, Recording& recording) {
  DotSource source;
  const DotPattern& given = recording.sensor.pattern;
  source.bright_ = given.bright.value_or(false);
  if (std::filesystem::exists(folder / "dots.csv")) {
    source.read(folder / "dots.csv", recording.frames.size(), {given.cols, given.rows});
    return source;
  }
  fingerpad::DotFinderOptions options;
  options.pattern.rows = given.rows;
  options.pattern.cols = given.cols;
  options.pattern.radius_px = given.diameter_px / 2;
  options.pattern.bright = given.bright;
  options.max_off = 0.3;  // for an elastic pad
  auto finder = finder_of(folder, recording.reference, options);
  const int tried = (std::min)(first_frames, recording.frames.size());
  recording.frames.seek(0);
  DamagedFrames damaged;
  for (int k = 0; k < tried && !finder.ok(); ++k) {
    const cv::Mat frame = next_whole_frame(recording.frames, recording.reference.size(), damaged);
    if (!frame.empty()) {
      finder = finder_of(folder, frame, options);
    }
  }
  if (!finder.ok()) {
    fail(folder, "none of the first " + std::to_string(tried) +
                     " frames shows a grid of nine or more dots (describe them by \"dots\" in "
                     "sensor.json, or give their positions in dots.csv)");
  }
  const DotGrid free = free_dots(finder);
  source.follow(std::move(finder), free);
  return source;
}

DotGrid DotSource::found(const cv::Mat& image) {
  DotGrid dots = no_dots(initial_.size());
  (void)(*finder_)(image, dots);
  return dots;
}

DotGrid DotSource::followed(const cv::Mat& image) {
  const cv::Mat_<float> light = light_of(image);
  DotGrid dots = no_dots(initial_.size());
  if ((*follower_)(light, dots).ok()) {
    return dots;
  }
  const DotGrid rough = found(image);
  dots = rough.clone();
  return follower_->restart(light, dots).ok() ? dots : rough;
}

std::string DotSource::side_how() const {
  if (!side_ || !side_->ok()) {
    return side_ ? "none: " + side_->refusal() : "";
  }
  const auto px = side_->free_px();
  return std::to_string(std::count_if(px.begin(), px.end(), [](auto p) { return is_present(p); })) +
         " around the rim";
}

void DotSource::look_for_side(const cv::Mat& image) {
  (void)(*side_)(light_of(image));
  side_marks_.clear();
  for (std::size_t k = 0; k < side_->px().size(); ++k) {
    side_marks_.push_back({.px = side_->px()[k], .sd_px = side_->sd_px()[k]});
  }
}

DotGrid DotSource::of(int frame, const cv::Mat& image) {
  if (side_ && side_->ok()) {
    look_for_side(image);
  }
  if (finder_) {
    return follower_ ? followed(image) : found(image);
  }
  if (!present()) {
    return {};
  }
  const auto listed = listed_.find(frame);
  return listed == listed_.end() ? no_dots(initial_.size()) : listed->second.clone();
}

}  // namespace replay
