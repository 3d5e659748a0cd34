// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/live/live.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <opencv2/highgui.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/interrupt.hpp"
#include "common/output.hpp"
#include "common/recording.hpp"
#include "common/table.hpp"
#include "replay/chain.hpp"
#include "replay/live/frames.hpp"
#include "replay/live/recorder.hpp"
#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/pictures.hpp"

namespace replay {
namespace {

struct Shown {
  int frame;
  std::string time_s;
  double latency_ms;  ///< from the arrival of the frame to its finished picture
};

/// The shown frames and their latencies.
class Log {
  using Clock = LiveFrames::Clock;

 public:
  void add(const LiveFrames& frames, const std::string& time_s) {
    last_ = Clock::now();
    first_ = shown_.empty() ? last_ : first_;
    const std::chrono::duration<double, std::milli> latency = last_ - frames.arrival();
    shown_.push_back({frames.number(), time_s, latency.count()});
  }
  const std::vector<Shown>& shown() const { return shown_; }
  double rate_hz() const {
    const double seconds = std::chrono::duration<double>(last_ - first_).count();
    return seconds > 0 ? static_cast<double>(shown_.size() - 1) / seconds : 0;
  }
  /// Latencies of the last `count` pictures, in ascending order.
  std::vector<double> latencies_ms(std::size_t count) const {
    std::vector<double> values;
    for (std::size_t k = shown_.size() - (std::min)(count, shown_.size()); k < shown_.size(); ++k) {
      values.push_back(shown_[k].latency_ms);
    }
    std::sort(values.begin(), values.end());
    return values;
  }

 private:
  std::vector<Shown> shown_;
  Clock::time_point first_ = {}, last_ = {};
};

/// A window on the screen.
class Window {
 public:
  Window() {
#ifdef __linux__  // without a display the GUI toolkit would abort the program
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) {
      fail("window",
           "there is no screen; use --headless --out DIR to write the pictures to a folder");
    }
#endif
    cv::namedWindow(name, cv::WINDOW_AUTOSIZE | cv::WINDOW_GUI_NORMAL);
  }
  ~Window() {
    cv::destroyAllWindows();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Returns the key that was pressed, 'q' when the user closes the window or presses Esc.
  int show(const cv::Mat& picture) const {
    cv::imshow(name, picture);
    const int key = cv::waitKey(1);
    const bool is_open = cv::getWindowProperty(name, cv::WND_PROP_VISIBLE) >= 1;
    return key == 27 || !is_open ? 'q' : key;
  }

 private:
  static constexpr const char* name = "fingerpad";
};

/// Turns frames into pictures. `show` receives each picture and its frame number and returns the
/// key that was pressed: q ends the loop, r begins or ends a recording.
Log play(const Options& options,
         Recording& pad,
         LiveFrames& frames,
         Recorder& recorder,
         const std::function<int(int, const cv::Mat&)>& show) {
  Chain chain(pad, options);
  const Painter painter(pad.sensor, pad.reference_depth, brightest_level(pad.reference));
  const int end = options.range.last.value_or((std::numeric_limits<int>::max)());
  for (int k = 0; k < options.range.first; ++k) {
    frames.skip();
  }
  Log log;
  std::string title = "live";
  cv::Mat image;
  int key = 0;
  while (key != 'q' && !is_interrupted() && frames.number() + 1 < end && frames.next(image)) {
    const std::string time_s = format("%.2f", frames.time_s());
    pad.signals.times_s = {{frames.number(), time_s}};
    Scene scene = chain(frames.number(), image);
    scene.section = painter.find_section(scene.depth_mm);
    key = show(frames.number(), painter.montage(title, {std::move(scene)}, 1));
    log.add(frames, time_s);
    recorder.add(frames.stored(), format("%.4f", frames.time_s()));
    if (key == 'r') {
      recorder.toggle();
    }
    const std::vector<double> recent = log.latencies_ms(30);
    const int left_out =
        frames.number() + 1 - options.range.first - static_cast<int>(log.shown().size());
    title = (recorder.is_on() ? format("recording, %d frames;  ", recorder.frames()) : "") +
            format("latency %.0f ms", recent[recent.size() / 2]) +
            (log.rate_hz() > 0 ? format(",  %.0f pictures per second", log.rate_hz()) : "") +
            (left_out > 0 ? format(",  %d frames lost", left_out) : "");
  }
  if (log.shown().empty()) {
    fail(options.recording, "there was no frame to show");
  }
  return log;
}

void print(const Log& log, const LiveFrames& frames, int first) {
  const std::vector<double> ms = log.latencies_ms(log.shown().size());
  std::printf("shown        %zu of %d frames\n", ms.size(), frames.number() + 1 - first);
  std::printf("rate         %.1f pictures per second", log.rate_hz());
  if (frames.rate_hz() > 0) {
    std::printf(", from %.1f frames per second", frames.rate_hz());
  }
  std::printf("\n");
  std::printf("latency      %.1f ms from frame to picture (median), maximum %.1f ms\n",
              ms[ms.size() / 2], ms.back());
}

void play_to_window(const Options& options,
                    Recording& pad,
                    LiveFrames& frames,
                    Recorder& recorder) {
  const Window window;
  const Log log = play(options, pad, frames, recorder,
                       [&](int, const cv::Mat& picture) { return window.show(picture); });
  print(log, frames, options.range.first);
}

void play_to_folder(const Options& options,
                    Recording& pad,
                    LiveFrames& frames,
                    Recorder& recorder) {
  OutputFolder output(options.out);
  const Log log = play(options, pad, frames, recorder, [&](int frame, const cv::Mat& picture) {
    write_picture(output.file("pictures", numbered("live_", frame, ".png")), picture);
    return 0;
  });
  TableWriter<Shown> table(
      output.file("frames.csv"),
      {{"frame", [](const Shown& shown) { return std::to_string(shown.frame); }},
       {"time_s", [](const Shown& shown) { return shown.time_s; }},
       {"latency_ms", [](const Shown& shown) { return format("%.1f", shown.latency_ms); }}});
  for (const Shown& shown : log.shown()) {
    table.write(shown);
  }
  table.close();
  output.publish();
  print(log, frames, options.range.first);
  std::printf("pictures     %s\n", (output.place() / "pictures").c_str());
}

}  // namespace

int run_live(const Options& options, const LiveOptions& live) {
  Recording pad = open_pad(options.recording, options.sensor);
  if (pad.sensor.dots_only) {
    fail(options.recording,
         "has dots only, and live pictures show depth: record a video, write { \"video\": \"FILE\" "
         "} "
         "to sensor.json, and run replay with --out");
  }
  const cv::Size size = pad.reference.size();
  LiveFrames frames =
      live.camera ? LiveFrames::of_camera(*live.camera, size, pad.sensor.pictures)
                  : LiveFrames::of_video(live.video, size, pad.sensor.pictures, !live.headless);
  watch_for_interrupts();
  Recorder recorder(live.record);
  if (live.headless) {
    if (!live.record.empty()) {
      recorder.toggle();
    }
    play_to_folder(options, pad, frames, recorder);
  } else {
    play_to_window(options, pad, frames, recorder);
  }
  return 0;
}

}  // namespace replay
