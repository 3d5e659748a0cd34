// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "loads.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/failure.hpp"

namespace load_trials {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Load load_of(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    replay::fail(file, "cannot be read");
  }
  Load load;
  load.name = file.stem().string();
  std::vector<cv::Vec2d> from;
  std::vector<cv::Vec2d> to;
  try {
    const json content = json::parse(stream);
    load.fx_n = content.at("fx").get<double>();
    load.fz_n = content.at("fz").get<double>();
    load.single_axis =
        content.at("thetax").get<double>() == 0 || content.at("thetaz").get<double>() == 0;
    for (const json& repeat : content.at("MoveData")) {
      for (const json& blob : repeat.at("BlobMoves")) {
        const cv::Vec2d at(blob.at(0).get<double>(), blob.at(1).get<double>());
        from.push_back(at);
        to.push_back(at + cv::Vec2d(blob.at(3).get<double>(), blob.at(4).get<double>()));
      }
    }
  } catch (const json::exception& error) {
    replay::fail(file, error.what());
  }
  if (from.empty()) {
    replay::fail(file, "contains no blobs");
  }
  load.from = cv::Mat_<cv::Vec2d>(from, true).reshape(2, 1);
  load.to = cv::Mat_<cv::Vec2d>(to, true).reshape(2, 1);
  return load;
}

}  // namespace

std::vector<Load> loads_of(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    replay::fail(folder, "there is no such folder");
  }
  std::vector<Load> loads;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".json") {
      loads.push_back(load_of(entry.path()));
    }
  }
  if (loads.empty()) {
    replay::fail(folder, "contains no .json files");
  }
  std::sort(loads.begin(), loads.end(),
            [](const Load& a, const Load& b) { return a.name < b.name; });
  return loads;
}

}  // namespace load_trials
