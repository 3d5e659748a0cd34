// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "calibrate/recordings.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/json_section.hpp"
#include "common/recording.hpp"
#include "common/table.hpp"

namespace calibrate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

const char* made_by(const std::string& section) {
  return section == "camera"                          ? "calibrate camera"
         : section == "pad" || section == "reference" ? "calibrate shape"
                                                      : "calibrate absorption";
}

/// Depths on a ball. The membrane is assumed to lie on the ball where the indentation is more than
/// half of the largest; farther out it may bridge.
DepthMap depth_on_ball(const replay::Sensor& sensor, const Sphere& ball, const DepthMap& free_mm) {
  DepthMap depth(free_mm.size(), static_cast<float>(none));
  double deepest = 0;
  for (int i = 0; i < depth.rows; ++i) {
    for (int j = 0; j < depth.cols; ++j) {
      const double on_ball = depth_on(sensor.camera, i, j, ball);
      depth(i, j) = static_cast<float>(on_ball);
      deepest = std::fmax(deepest, static_cast<double>(free_mm(i, j)) - on_ball);
    }
  }
  for (int i = 0; i < depth.rows; ++i) {
    for (int j = 0; j < depth.cols; ++j) {
      const double pressed = static_cast<double>(free_mm(i, j) - depth(i, j));
      depth(i, j) = pressed > deepest / 2 ? depth(i, j) : static_cast<float>(none);
    }
  }
  return depth;
}

}  // namespace

replay::Sensor known_sensor(const fs::path& file, const std::vector<std::string>& sections) {
  json content = fs::exists(file) ? replay::parse_json(file) : json::object();
  for (const std::string& section : sections) {
    if (!content.contains(section)) {
      replay::fail(file, "has no section " + section + "; run " + made_by(section) + " first");
    }
  }
  // placeholders for sections that are not calibrated yet; they are parsed but not used
  const json any = {
      {"camera",
       {{"plate_distance_mm", 50},
        {"refractive_index", 1.33},
        {"center_px", {0, 0}},
        {"pitch_mm", 1}}},
      {"absorption",
       {{"c_red_per_mm", 0.03}, {"c_green_per_mm", 0.03}, {"kappa", 1}, {"max_depth_mm", 1}}},
      {"pad", {{"base_radius_mm", 1}, {"apex_height_mm", 1}}},
      {"reference", {{"frame", "reference.png"}, {"depth", "reference_depth.tiff"}}}};
  if (!sections.empty()) {
    for (const auto& item : any.items()) {
      if (!content.contains(item.key())) {
        content[item.key()] = item.value();
      }
    }
  }
  return replay::read_sensor(file, content);
}

replay::PictureFormat known_pictures(const fs::path& file) {
  const bool has_camera = fs::exists(file) && replay::parse_json(file).contains("camera");
  return has_camera ? known_sensor(file, {"camera"}).pictures : replay::PictureFormat{};
}

std::vector<cv::Mat> read_pictures(const fs::path& folder, const replay::PictureFormat& format) {
  replay::FrameSource source = replay::FrameSource::of_folder(folder, format);
  std::vector<cv::Mat> pictures = {source.next()};
  while (static_cast<int>(pictures.size()) < source.size()) {
    pictures.push_back(replay::next_frame(source, pictures.front().size()));
  }
  return pictures;
}

double depth_on(const fingerpad::Camera<double>& camera, int row, int col, const Sphere& sphere) {
  const auto start = point_at(camera, double(row), double(col), 0.0) - sphere.center_mm;
  const auto end = point_at(camera, double(row), double(col), 1.0) - sphere.center_mm;
  const auto along = end - start;  // rays are straight in the fluid
  const double a = squared_norm(along), b = dot(start, along);
  const double c = squared_norm(start) - sphere.radius_mm * sphere.radius_mm;
  const double root = std::sqrt(b * b - a * c);
  const double depth = c / (-b + root);
  return depth >= 0 ? depth : none;
}

std::vector<DepthMap> true_depths(const fs::path& recording,
                                  const replay::Sensor& sensor,
                                  const DepthMap& free_mm,
                                  std::size_t frames) {
  std::vector<DepthMap> depths(frames, DepthMap(free_mm.size(), static_cast<float>(none)));
  if (fs::is_directory(recording / "true_depth")) {
    for (std::size_t k = 0; k < frames; ++k) {
      char name[32];
      std::snprintf(name, sizeof name, "%06zu.tiff", k);
      const fs::path file = recording / "true_depth" / name;
      depths[k] = fs::exists(file) ? replay::read_depth_image(file) : depths[k];
      if (depths[k].size() != free_mm.size()) {
        replay::fail(file, "must have the size of the reference");
      }
    }
    return depths;
  }
  replay::Table table(recording / "presses.csv", {"frame", "x_mm", "y_mm", "z_mm", "radius_mm"});
  while (table.next()) {
    const int frame = table.index(0, static_cast<int>(frames), "frames");
    const double x = table.number(1), y = table.number(2), z = table.number(3);
    const double r = table.number(4);
    if (!(r > 0) || !(z > 0)) {
      table.refuse("radius_mm and z_mm of the ball must be > 0");
    }
    depths[static_cast<std::size_t>(frame)] = depth_on_ball(sensor, {{x, y, z + r}, r}, free_mm);
  }
  return depths;
}

}  // namespace calibrate
