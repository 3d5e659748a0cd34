// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/io/recording.hpp"

#include <algorithm>
#include <string>
#include <system_error>

#include "replay/io/failure.hpp"
#include "replay/io/images.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

std::string size_of(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " px";
}

/// Natural order: numbers in names compare by value, so frame10 comes after frame2.
bool comes_before(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) {
        return a[i] < b[j];
      }
      ++i;
      ++j;
      continue;
    }
    const auto number = [&](const std::string& text, std::size_t& at) {
      const std::size_t first = std::min(text.find_first_not_of('0', at), text.size());
      for (at = first; at < text.size() && is_digit(text[at]); ++at) {
      }
      return text.substr(first, at - first);
    };
    const std::string one = number(a, i);
    const std::string other = number(b, j);
    if (one != other) {
      return one.size() != other.size() ? one.size() < other.size() : one < other;
    }
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

}  // namespace

FrameSource FrameSource::of_folder(const fs::path& folder, PictureFormat format) {
  FrameSource source;
  source.format_ = std::move(format);
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) {
    fail(folder,
         "there is no such folder (a recording needs frames in it, or \"video\" in sensor.json)");
  }
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(error) && name.front() != '.') {
      source.files_.push_back(entry.path());
    }
  }
  if (source.files_.empty()) {
    fail(folder, "holds no frames");
  }
  std::sort(source.files_.begin(), source.files_.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  source.count_ = static_cast<int>(source.files_.size());
  return source;
}

FrameSource FrameSource::of_video(const fs::path& file, PictureFormat format) {
  FrameSource source;
  source.format_ = std::move(format);
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    fail(file, "there is no such video (named by \"video\" in sensor.json)");
  }
  source.files_ = {file};
  source.video_.emplace(file);
  // Counted, because the number in a video's header is an estimate.
  while (source.video_->grab()) {
    ++source.count_;
  }
  if (source.count_ == 0) {
    fail(file, "holds no frames");
  }
  return source;
}

void FrameSource::seek(int first) {
  position_ = first;
  if (video_) {
    video_->rewind();
    for (int i = 0; i < first; ++i) {
      video_->grab();
    }
  }
}

fs::path FrameSource::last_file() const {
  const int last = video_ ? 0 : (std::max)(position_ - 1, 0);
  return files_[static_cast<std::size_t>(last)];
}

cv::Mat FrameSource::next() {
  const cv::Mat stored = next_stored();
  return linear_colours(stored, format_, last_file());
}

cv::Mat FrameSource::next_stored() {
  ++position_;
  if (!video_) {
    return read_stored_image(last_file());
  }
  const cv::Mat frame = video_->grab() ? video_->retrieve() : cv::Mat();
  if (frame.empty()) {
    fail(last_file(), "frame " + std::to_string(position_ - 1) + " cannot be decoded");
  }
  return frame;
}

cv::Mat next_frame(FrameSource& frames, cv::Size size) {
  cv::Mat image = frames.next();
  if (image.size() != size) {
    fail(frames.last_file(), "is " + size_of(image) + ", but the reference is " +
                                 std::to_string(size.width) + " x " + std::to_string(size.height) +
                                 " px");
  }
  return image;
}

namespace {

/// Reads the picture of the free pad and its depth.
void read_reference(const fs::path& folder, Recording& recording) {
  const fs::path frame_file = folder / recording.sensor.reference_frame;
  const fs::path depth_file = folder / recording.sensor.reference_depth;
  recording.reference = read_colour_image(frame_file, recording.sensor.pictures);
  recording.reference_depth = read_depth_image(depth_file);
  if (recording.reference_depth.size() != recording.reference.size()) {
    fail(depth_file, "is " + size_of(recording.reference_depth) + ", but " +
                         frame_file.filename().string() + " is " + size_of(recording.reference));
  }
}

/// Reads the reference of a dots-only recording, or its first frame.
void read_first_picture(const fs::path& folder, Recording& recording) {
  if (recording.sensor.reference_frame.empty()) {
    recording.frames.seek(0);
    recording.reference = recording.frames.next();
  } else {
    recording.reference = read_colour_image(folder / recording.sensor.reference_frame);
  }
}

}  // namespace

Recording open_pad(const fs::path& folder, const fs::path& sensor) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    fail(folder, "there is no such folder");
  }
  const fs::path sensor_file = sensor.empty() ? folder / "sensor.json" : sensor;
  Recording recording;
  recording.sensor = read_sensor(sensor_file);
  fs::path free = folder / "free";
  if (!recording.sensor.dots_only) {
    const fs::path at_sensor = sensor_file.parent_path();
    read_reference(at_sensor, recording);
    if (!fs::is_directory(free, error)) {
      free = (at_sensor / recording.sensor.reference_frame).parent_path() / "free";
    }
  }
  if (fs::is_directory(free, error)) {
    recording.free_frames = FrameSource::of_folder(free, recording.sensor.pictures);
  }
  return recording;
}

Recording open_recording(const fs::path& folder, const fs::path& sensor) {
  Recording recording = open_pad(folder, sensor);
  const auto& video = recording.sensor.video;
  const PictureFormat& format = recording.sensor.pictures;
  recording.frames = video ? FrameSource::of_video(folder / *video, format)
                           : FrameSource::of_folder(folder / "frames", format);
  if (recording.sensor.dots_only) {
    read_first_picture(folder, recording);
  }
  recording.signals = read_signals(folder / "signals.csv", recording.frames.size());
  if (!recording.sensor.dots_only) {
    recording.true_forces = read_true_forces(folder / "forces.csv", recording.frames.size());
    if (const auto& dots = recording.sensor.dots) {
      recording.stress_free_dots =
          read_stress_free_dots(folder / "stress_free_dots.csv", {dots->cols, dots->rows});
    }
  }
  return recording;
}

}  // namespace replay
