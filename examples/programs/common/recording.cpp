// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/recording.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "fingerpad/core/check.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

std::string size_of(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " px";
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::size_t end_of_digits(const std::string& text, std::size_t at) {
  while (at < text.size() && is_digit(text[at])) {
    ++at;
  }
  return at;
}

/// The end of the decimals of the number whose whole part is [first, end), as in 17.05; else `end`.
/// Numbers in a row, as in 2026.11.27, have none.
std::size_t end_of_decimals(const std::string& text, std::size_t first, std::size_t end) {
  const std::size_t last = end < text.size() && text[end] == '.' ? end_of_digits(text, end + 1) : 0;
  const bool in_a_row = (first > 1 && text[first - 1] == '.' && is_digit(text[first - 2])) ||
                        (last + 1 < text.size() && text[last] == '.' && is_digit(text[last + 1]));
  return last > end + 1 && !in_a_row ? last : end;
}

/// Whether digits after a point are decimals, whose trailing zeros are left out: 17.1 comes after
/// 17.05. Otherwise they count, as in 17.9 and 17.10.
bool have_decimals(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    const std::string name = file.stem().string();
    for (std::size_t at = 0; at < name.size();) {
      const std::size_t end = end_of_digits(name, at), last = end_of_decimals(name, at, end);
      if (end > at && last > end + 2 && name[last - 1] == '0') {
        return false;
      }
      at = (std::max)(last, at + 1);
    }
  }
  return true;
}

/// 1.1e+06, as %g writes it, becomes 1100000.
std::string without_exponents(std::string name) {
  for (std::size_t at = name.find("e+"); at != std::string::npos; at = name.find("e+", at + 1)) {
    std::size_t first = at;
    while (first > 0 && (is_digit(name[first - 1]) || name[first - 1] == '.')) {
      --first;
    }
    const std::size_t end = end_of_digits(name, at + 2);
    if (is_digit(name[first]) && end > at + 2 && end < at + 5) {
      const double number = std::strtod(name.substr(first, end - first).c_str(), nullptr);
      name.replace(first, end - first, fingerpad::detail::print("%.0f", number));
    }
  }
  return name;
}

/// Natural order: numbers in names compare by value, so frame10 comes after frame2.
bool comes_before(const std::string& a, const std::string& b, bool with_decimals) {
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
      const std::size_t first = at, end = end_of_digits(text, at);
      at = with_decimals ? end_of_decimals(text, first, end) : end;
      const std::size_t begin = (std::min)(text.find_first_not_of('0', first), end);
      std::string decimals = text.substr(end, at - end);
      decimals.erase(decimals.find_last_not_of(".0") + 1);
      return std::pair(text.substr(begin, end - begin), decimals);
    };
    const auto one = number(a, i), other = number(b, j);
    if (one != other) {
      return one.first.size() != other.first.size() ? one.first.size() < other.first.size()
                                                    : one < other;
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
    fail(folder, "holds no frames; put the pictures there, as 000000.png, 000001.png, ...");
  }
  const bool decimals = have_decimals(source.files_);
  std::sort(source.files_.begin(), source.files_.end(), [&](const fs::path& a, const fs::path& b) {
    const std::string one = without_exponents(a.stem().string());
    const std::string other = without_exponents(b.stem().string());
    return one != other ? comes_before(one, other, decimals) : a < b;
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

namespace {

/// Empty for a damaged frame.
cv::Mat next_whole(FrameSource& frames, DamagedFrames& damaged) {
  try {
    return frames.next();
  } catch (const Unreadable& unreadable) {
    damaged.emplace(frames.last_frame(), unreadable.what());
    return {};
  }
}

cv::Mat expects_size(const FrameSource& frames, cv::Mat image, cv::Size size) {
  if (!image.empty() && image.size() != size) {
    fail(frames.last_file(), "is " + size_of(image) + ", but the reference is " +
                                 std::to_string(size.width) + " x " + std::to_string(size.height) +
                                 " px; take both with the same setting of the camera");
  }
  return image;
}

}  // namespace

cv::Mat next_frame(FrameSource& frames, cv::Size size) {
  return expects_size(frames, frames.next(), size);
}

cv::Mat next_whole_frame(FrameSource& frames, cv::Size size, DamagedFrames& damaged) {
  return expects_size(frames, next_whole(frames, damaged), size);
}

namespace {

/// Reads the picture of the free pad and its depth.
void read_reference(const fs::path& folder, Recording& recording) {
  const fs::path frame_file = folder / recording.sensor.reference_frame;
  const fs::path depth_file = folder / recording.sensor.reference_depth;
  for (const auto& [file, what] :
       {std::pair{frame_file, "a picture of the pad with nothing in contact belongs there"},
        std::pair{depth_file,
                  "the depth of that pad in mm belongs there, which calibrate shape writes"}}) {
    if (!fs::exists(file)) {
      fail(file, std::string("there is no such file; ") + what);
    }
  }
  recording.reference = read_colour_image(frame_file, recording.sensor.pictures);
  recording.reference_depth = read_depth_image(depth_file);
  if (recording.reference_depth.size() != recording.reference.size()) {
    fail(depth_file, "is " + size_of(recording.reference_depth) + ", but " +
                         frame_file.filename().string() + " is " + size_of(recording.reference));
  }
}

/// Finds the first frame that is whole and as light as most of the first ones. Throws Failure.
void find_first_frame(Recording& recording) {
  constexpr int tried = 10;
  std::vector<cv::Mat> pictures;
  DamagedFrames damaged;
  recording.frames.seek(0);
  for (int k = 0; k < (std::min)(tried, recording.frames.size()); ++k) {
    pictures.push_back(next_whole(recording.frames, damaged));
  }
  const std::vector<bool> usual = usually_exposed(pictures);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (usual[k]) {
      recording.first_frame = static_cast<int>(k);
      recording.reference = pictures[k];
      return;
    }
  }
  throw Unreadable(damaged.begin()->second);
}

/// Reads the reference of a dots-only recording, or its first frame.
void read_first_picture(const fs::path& folder, Recording& recording) {
  find_first_frame(recording);
  if (!recording.sensor.reference_frame.empty()) {
    recording.reference =
        read_colour_image(folder / recording.sensor.reference_frame, recording.sensor.pictures);
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
