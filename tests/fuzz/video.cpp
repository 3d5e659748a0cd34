// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A recording whose video has any bytes in it: it is read, or refused by one line. All videos are
// opened and their frames counted. Frames are fetched only from codecs that have their size from
// the container: where a stream has another size than its container claims, OpenCV 4.6 copies from
// beyond its own buffer (VideoCapture::retrieve), which replay cannot foresee.
// with: examples/replay/io/recording.cpp examples/replay/io/video.cpp
// with: examples/replay/live/frames.cpp
// with: examples/replay/io/sensor.cpp examples/replay/io/number_table.cpp
// with: examples/replay/io/signals.cpp examples/replay/io/images.cpp
// with: examples/replay/io/side_dots.cpp examples/replay/io/true_forces.cpp
// with: -lopencv_core -lopencv_imgproc -lopencv_imgcodecs -lopencv_videoio
#include "replay/io/video.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "fuzz/file.hpp"
#include "fuzz/input.hpp"
#include "replay/io/failure.hpp"
#include "replay/io/recording.hpp"
#include "replay/live/frames.hpp"

using fuzz::require;

// Decoders come without counters of what code they run. The fuzzer keeps an input that gives a new
// result instead.
__attribute__((section("__libfuzzer_extra_counters"))) std::uint8_t seen[4096];

namespace {

class Results {
 public:
  /// Files of different formats begin with different bytes.
  explicit Results(const std::string& content) : hash_(content.empty() ? 0 : content[0] & 0xFFU) {}
  /// With what has been added before it.
  void add(double value) {
    hash_ = (hash_ ^ static_cast<std::uint32_t>(std::lround(value))) * 0x9E3779B1U;
    seen[hash_ >> 20] = 1;
  }

 private:
  std::uint32_t hash_;
};

template <class Call>
void read_or_refused(const Call& call) {
  try {
    call();
  } catch (const replay::Failure& failure) {
    require(std::string(failure.what()).find('\n') == std::string::npos, "a refusal is one line");
  }
}

/// The most memory that this process has held, in MB.
long peak_memory() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss / 1024;
}

void is_frame(const cv::Mat& frame, cv::Size size) {
  require(frame.size() == size && !frame.empty(), "each frame has the size of the first");
  require((frame.depth() == CV_8U || frame.depth() == CV_16U) && frame.channels() >= 3,
          "each frame is a colour image of 8 or 16 bits");
}

/// Whether the frames have no size of their own that may differ from the container's.
bool has_size_of_container(const std::filesystem::path& file) {
  const auto codec = static_cast<int>(replay::open_video(file).get(cv::CAP_PROP_FOURCC));
  const auto codecs = {
      cv::VideoWriter::fourcc('F', 'F', 'V', '1'), cv::VideoWriter::fourcc('H', 'F', 'Y', 'U'),
      cv::VideoWriter::fourcc('I', '4', '2', '0'), cv::VideoWriter::fourcc('R', 'G', 'B', 'A')};
  return std::find(codecs.begin(), codecs.end(), codec) != codecs.end();
}

/// Opens a video, counts its frames, and moves to the last one.
void count(const std::filesystem::path& file, std::size_t bytes, Results& results) {
  auto frames = replay::FrameSource::of_video(file);
  require(frames.size() > 0 && static_cast<std::size_t>(frames.size()) <= bytes,
          "each frame takes a byte or more");
  results.add(frames.size());
  frames.seek(frames.size() - 1);
}

/// As `replay RECORDING` does, from the first frame, which is the reference, to the last.
cv::Size read(const std::filesystem::path& folder, std::size_t bytes, Results& results) {
  replay::Recording recording = replay::open_recording(folder);
  const int count = recording.frames.size();
  require(count > 0 && static_cast<std::size_t>(count) <= bytes, "each frame takes a byte or more");
  const cv::Size size = recording.reference.size();
  is_frame(recording.reference, size);
  for (const double value : {double(count), double(size.width), double(size.height),
                             cv::mean(recording.reference)[1] / 8}) {
    results.add(value);
  }
  read_or_refused([&] {
    recording.frames.seek(0);
    for (int k = 0; k < count; ++k) {
      is_frame(replay::next_frame(recording.frames, size), size);
      results.add(k);
    }
  });
  read_or_refused([&] {
    recording.frames.seek(count - 1);
    is_frame(replay::next_frame(recording.frames, size), size);
  });
  return size;
}

/// As `replay RECORDING --video FILE --headless` does.
void show(const std::filesystem::path& file, cv::Size size, std::size_t bytes) {
  auto frames = replay::LiveFrames::of_video(file, size, false);
  require(frames.rate_hz() > 0 && std::isfinite(frames.rate_hz()), "a video has a frame rate");
  cv::Mat frame;
  double time_s = -1;
  while (frames.next(frame)) {
    is_frame(frame, size);
    require(frames.time_s() > time_s, "time goes on");
    time_s = frames.time_s();
    require(static_cast<std::size_t>(frames.number()) < bytes, "each frame takes a byte or more");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::File file;
  static const bool has_sensor =
      (std::ofstream(file.folder() / "sensor.json") << R"({"video": "file"})").good();
  require(has_sensor, "sensor.json can be written");
  const std::string content(reinterpret_cast<const char*>(data), size);
  const auto& path = file.with(content);
  Results results(content);
  read_or_refused([&] {
    count(path, size, results);
    if (has_size_of_container(path)) {
      const cv::Size frame_size = read(file.folder(), size, results);
      show(path, frame_size, size);
    }
  });
  require(peak_memory() < 1000, "a video of 2 kB takes less than a gigabyte");
  return 0;
}
