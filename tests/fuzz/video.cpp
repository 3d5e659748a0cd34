// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A recording whose video has any bytes in it: it is read, or refused by one line. A decoder may
// crash; this process may not.
// with: examples/programs/common/recording.cpp examples/programs/common/video.cpp
// with: examples/programs/common/capture.cpp examples/programs/replay/live/frames.cpp
// with: examples/programs/common/sensor.cpp examples/programs/common/table.cpp
// with: examples/programs/common/signals.cpp examples/programs/common/images.cpp
// with: examples/programs/common/stress_free_dots.cpp examples/programs/common/true_forces.cpp
// with: -lopencv_core -lopencv_imgproc -lopencv_imgcodecs -lopencv_videoio
// The thread that watches memory may hold a lock of the address sanitizer at a fork.
// options: -rss_limit_mb=0
#include "common/video.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "common/failure.hpp"
#include "common/recording.hpp"
#include "fuzz/file.hpp"
#include "fuzz/input.hpp"
#include "replay/live/frames.hpp"

using fuzz::require;

// Decoders run in another process and come without counters of what code they run. The fuzzer keeps
// an input that gives a new result instead.
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

/// The most memory that one of these processes has held, in MB.
long peak_memory(int whose) {
  rusage used{};
  getrusage(whose, &used);
  return used.ru_maxrss / 1024;
}

// A crash of a decoder's process is no find: it ends as it would without the fuzzer.
bool is_decoder = false;

void crash_alone() {
  is_decoder = true;
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) {
    std::signal(signal, SIG_DFL);
  }
}

/// Whether a video has been decoded to its end. A process is kept for the next input, since
/// starting one takes longer than most inputs; where a decoder crashes, a new one is started.
bool decode(const std::filesystem::path& file, std::size_t bytes, Results& results) {
  static std::optional<replay::Video> video;
  try {
    if (video) {
      video->rewind();
    } else {
      video.emplace(file);
    }
    cv::Mat frame;
    std::size_t count = 0;
    for (; video->grab(); ++count) {
      require(count < bytes, "each frame takes a byte or more");
      frame = video->retrieve();
    }
    for (const int value : {int(count), frame.cols, frame.rows, frame.type()}) {
      results.add(value);
    }
    return true;
  } catch (const replay::Failure& failure) {
    const std::string line = failure.what();
    require(line.find('\n') == std::string::npos, "a refusal is one line");
    if (line.find("its decoder") != std::string::npos) {
      video.reset();
    }
    return false;
  }
}

void is_frame(const cv::Mat& frame, cv::Size size) {
  require(frame.size() == size && !frame.empty(), "each frame has the size of the first");
  require((frame.depth() == CV_8U || frame.depth() == CV_16U) && frame.channels() >= 3,
          "each frame is a colour image of 8 or 16 bits");
}

/// As `replay RECORDING --frames N:` does: the first frame, which is the reference, and the last.
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
    recording.frames.seek(count - 1);
    is_frame(replay::next_frame(recording.frames, size), size);
    results.add(count);
  });
  return size;
}

/// As `replay RECORDING --video FILE --headless` does.
void show(const std::filesystem::path& file, cv::Size size, std::size_t bytes, Results& results) {
  auto frames = replay::LiveFrames::of_video(file, size, {}, false);
  require(frames.rate_hz() > 0 && std::isfinite(frames.rate_hz()), "a video has a frame rate");
  cv::Mat frame;
  double time_s = -1;
  while (frames.next(frame)) {
    is_frame(frame, size);
    require(frames.time_s() > time_s, "time goes on");
    time_s = frames.time_s();
    require(static_cast<std::size_t>(frames.number()) < bytes, "each frame takes a byte or more");
    results.add(frames.number());
  }
}

}  // namespace

/// The address sanitizer calls it where it finds an error, before it writes its report.
extern "C" void __asan_on_error() {
  if (is_decoder) {
    ::_exit(1);
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::File file;
  static const bool has_sensor =
      (std::ofstream(file.folder() / "sensor.json") << R"({"video": "file"})").good();
  // Most of the time would go into clearing memory for large frames.
  static const bool is_limited = setenv("OPENCV_IO_MAX_IMAGE_PIXELS", "65536", 0) == 0;
  static const bool crashes_alone = pthread_atfork(nullptr, nullptr, crash_alone) == 0;
  require(has_sensor && is_limited && crashes_alone, "the target can begin");
  const std::string content(reinterpret_cast<const char*>(data), size);
  const auto& path = file.with(content);
  Results results(content);
  if (decode(path, size, results) && size % 64 == 0) {
    read_or_refused([&] {
      const cv::Size frame_size = read(file.folder(), size, results);
      show(path, frame_size, size, results);
    });
  }
  require(peak_memory(RUSAGE_SELF) < 1000 && peak_memory(RUSAGE_CHILDREN) < 1000,
          "a video of 2 kB takes less than a gigabyte");
  return 0;
}
