// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/dots.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "replay/dots/file.hpp"
#include "replay/dots/lattice.hpp"
#include "replay/dots/match.hpp"
#include "replay/dots/order.hpp"
#include "replay/io/failure.hpp"

namespace replay {
namespace {

constexpr int min_dots = 9;       // fewer in order are chance
constexpr int first_frames = 10;  // a camera's first frames may be dark

/// Whether two grids mean the same dots by the same row and column.
bool agree(const DotGrid& a, const DotGrid& b) {
  const BlobMap nothing{Blobs{}};
  const Matcher spacing(a, nothing);
  std::vector<double> distances;
  for (int i = 0; i < a.rows; ++i) {
    for (int j = 0; j < a.cols; ++j) {
      if (is_present(a(i, j)) && is_present(b(i, j))) {
        distances.push_back(cv::norm(a(i, j) - b(i, j)) / spacing.spacing_px(i, j));
      }
    }
  }
  const auto near = std::count_if(distances.begin(), distances.end(),
                                  [](double distance) { return distance < 0.5; });
  return 2 * near > static_cast<std::ptrdiff_t>(distances.size());
}

}  // namespace

DotSource::DotSource(const std::filesystem::path& folder,
                     const Sensor& sensor,
                     const cv::Mat& reference_image,
                     const cv::Mat_<float>& reference_depth,
                     int frame_count) {
  std::optional<FirstOrder> free_pad;
  if (sensor.dots) {
    finder_ = std::make_unique<BlobFinder>(sensor, reference_depth);
    free_pad = order_free_pad(sensor, reference_depth, finder_->find(reference_image));
    if (fingerpad::count_present(free_pad->found) < min_dots) {
      free_pad.reset();
    }
  }
  const std::filesystem::path file = folder / "dots.csv";
  if (std::filesystem::exists(file)) {
    how_ = "dots.csv";
    std::optional<cv::Size> size;
    if (sensor.dots) {
      size = cv::Size(sensor.dots->cols, sensor.dots->rows);
    }
    listed_ = read_dots(file, frame_count, size);
    initial_ = listed_.begin()->second;
    if (free_pad &&
        fingerpad::count_present(free_pad->found) > fingerpad::count_present(initial_) &&
        agree(free_pad->found, initial_)) {
      initial_ = free_pad->found;
    }
  } else if (free_pad) {
    how_ = "found in the frames";
    initial_ = free_pad->found;
    tracker_ = std::make_unique<DotTracker>(*free_pad);
  }
}

DotSource DotSource::of_dots_only(const std::filesystem::path& folder, Recording& recording) {
  DotSource source;
  const DotPattern& given = recording.sensor.pattern;
  const std::filesystem::path file = folder / "dots.csv";
  if (std::filesystem::exists(file)) {
    source.how_ = "dots.csv";
    std::optional<cv::Size> size;
    if (given.rows > 0) {
      size = cv::Size(given.cols, given.rows);
    }
    source.listed_ = read_dots(file, recording.frames.size(), size);
    source.initial_ = source.listed_.begin()->second;
    return source;
  }
  auto pattern = find_pattern(recording.reference, given);
  const int tried = (std::min)(first_frames, recording.frames.size());
  recording.frames.seek(0);
  for (int frame = 0; frame < tried && !pattern; ++frame) {
    pattern = find_pattern(next_frame(recording.frames, recording.reference.size()), given);
  }
  if (!pattern) {
    fail(folder, "none of the first " + std::to_string(tried) +
                     " frames shows a grid of nine or more dots (\"dots\" in sensor.json may say "
                     "what they look like, or dots.csv where they are)");
  }
  source.how_ = "found in the frames";
  source.initial_ = pattern->order.found;
  source.finder_ = std::make_unique<BlobFinder>(recording.reference.size(), pattern->look);
  source.tracker_ = std::make_unique<DotTracker>(pattern->order, elastic_pad);
  return source;
}

DotGrid DotSource::of(int frame, const cv::Mat& image) {
  if (tracker_) {
    return tracker_->track(finder_->find(image));
  }
  const auto listed = listed_.find(frame);
  return listed == listed_.end() ? no_dots(initial_.size()) : listed->second.clone();
}

}  // namespace replay
