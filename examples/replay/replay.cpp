// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <vector>

#include "failure.hpp"
#include "images.hpp"
#include "output.hpp"
#include "pictures.hpp"
#include "progress.hpp"
#include "recording.hpp"

namespace replay {
namespace {

constexpr int published_window_px = 29;
constexpr int montage_columns = 6;

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int /*signal*/) {
  interrupted = 1;
}

struct Summary {
  std::vector<double> step_ms;
  double valid_share_sum = 0;
  double deepest_mm = 0;
};

Range within(const Range& range, int size, const std::filesystem::path& recording) {
  const int last = range.last.value_or(size);
  if (range.first >= last || last > size) {
    fail(recording, "holds frames 0 to " + std::to_string(size - 1) + ", so --frames " +
                        std::to_string(range.first) + ":" + std::to_string(last) +
                        " names none or too many");
  }
  return {range.first, last};
}

DepthStep depth_step_of(const Recording& recording, const Options& options) {
  const auto window = recording.sensor.smoothing_px;
  const Smoothing by_default = window ? Smoothing::anchored : Smoothing::none;
  try {
    return make_depth_step(recording, options.smoothing.value_or(by_default),
                           window.value_or(published_window_px));
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

/// The grey level that only the brightest hundredth of the free pad's pixels exceed.
double brightest_level(const cv::Mat& image) {
  const double units = image.depth() == CV_16U ? 256 : 1;
  cv::Mat levels;
  image.convertTo(levels, CV_8U, 1 / units);
  std::vector<int> count(256, 0);
  for (int i = 0; i < levels.rows; ++i) {
    for (int j = 0; j < levels.cols * levels.channels(); ++j) {
      ++count[levels.ptr<uchar>(i)[j]];
    }
  }
  const double total = static_cast<double>(levels.total()) * levels.channels();
  double above = 0;
  int level = 255;
  while (level > 0 && above + count[static_cast<std::size_t>(level)] < 0.01 * total) {
    above += count[static_cast<std::size_t>(level)];
    --level;
  }
  return level;
}

Scene measured(int frame,
               const Recording& recording,
               const cv::Mat& image,
               const cv::Mat_<float>& depth_mm,
               const FrameDepth& result) {
  Scene scene;
  scene.frame = frame;
  const auto time = recording.times_s.find(frame);
  scene.time_s = time == recording.times_s.end() ? "" : time->second;
  scene.image = image;
  scene.depth_mm = depth_mm;
  double sum = 0;
  double top = -std::numeric_limits<double>::infinity();
  for (const float depth : depth_mm) {
    if (std::isfinite(depth)) {
      sum += static_cast<double>(depth);
      top = (std::max)(top, static_cast<double>(depth));
    }
  }
  const auto valid = static_cast<double>(result.valid_pixels);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  scene.valid_share =
      valid / static_cast<double>((std::max)(result.pad_pixels, fingerpad::Index{1}));
  scene.depth_mean_mm = valid > 0 ? sum / valid : none;
  scene.depth_max_mm = valid > 0 ? top : none;
  return scene;
}

/// Whether frame number `done` of `total` has a column in the montage; they lie evenly.
bool in_montage(int done, int total) {
  const int columns = (std::min)(total, montage_columns);
  for (int k = 0; k < columns; ++k) {
    if (done == (columns == 1 ? 0 : (k * (total - 1) + (columns - 1) / 2) / (columns - 1))) {
      return true;
    }
  }
  return false;
}

void print_summary(const Summary& summary,
                   const Recording& recording,
                   const Options& options,
                   const OutputFolder& output) {
  std::vector<double> ms = summary.step_ms;
  std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
  const double median = ms[ms.size() / 2];
  const double frames = static_cast<double>(ms.size());
  std::printf("frames       %zu\n", ms.size());
  std::printf("size         %d x %d px, %g mm/px\n", recording.reference.cols,
              recording.reference.rows, recording.sensor.camera.pitch_mm);
  std::printf("valid        %.2f %% of the pad's pixels\n", 100 * summary.valid_share_sum / frames);
  std::printf("deepest      %.2f mm\n", summary.deepest_mm);
  std::printf("depth step   %.2f ms a frame (median), %.0f frames/s\n", median, 1000 / median);
  std::printf("table        %s\n", (output.place() / "frames.csv").c_str());
  if (options.raw) {
    std::printf("depth maps   %s\n", (output.place() / "depth").c_str());
  }
  if (options.pictures) {
    std::printf("pictures     %s; montage.png first\n", (output.place() / "pictures").c_str());
  }
}

}  // namespace

Range parse_range(const std::string& text) {
  const auto colon = text.find(':');
  const auto number = [&](const std::string& digits) {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || value < 0) {
      throw std::invalid_argument("'" + text + "' is not of the form A:B, as in 3:10");
    }
    return value;
  };
  if (colon == std::string::npos) {
    throw std::invalid_argument("'" + text + "' is not of the form A:B, as in 3:10");
  }
  Range range;
  const std::string first = text.substr(0, colon);
  const std::string last = text.substr(colon + 1);
  range.first = first.empty() ? 0 : number(first);
  if (!last.empty()) {
    range.last = number(last);
  }
  return range;
}

int run(const Options& options) {
  Recording recording = open_recording(options.recording);
  const Range range = within(options.range, recording.frames.size(), options.recording);
  const int total = *range.last - range.first;
  const DepthStep depth_step = depth_step_of(recording, options);
  const Painter painter(recording.sensor, recording.reference_depth,
                        brightest_level(recording.reference));
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  OutputFolder output(options.out);
  FramesCsv table(output.file("frames.csv"));
  Summary summary;
  std::vector<Scene> columns;
  cv::Mat_<float> depth_mm(recording.reference.size());
  recording.frames.seek(range.first);
  {
    const Progress progress(total);
    for (int done = 0; done < total; ++done) {
      progress.show(done);
      if (interrupted != 0) {
        return 130;
      }
      const int frame = range.first + done;
      const cv::Mat image = recording.frames.next();
      if (image.size() != recording.reference.size()) {
        fail(recording.frames.last_file(),
             "is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                 " px, but the reference is " + std::to_string(recording.reference.cols) + " x " +
                 std::to_string(recording.reference.rows) + " px");
      }
      const auto start = std::chrono::steady_clock::now();
      const FrameDepth result = depth_step(image, depth_mm);
      const std::chrono::duration<double, std::milli> taken =
          std::chrono::steady_clock::now() - start;
      Scene scene = measured(frame, recording, image, depth_mm, result);
      summary.step_ms.push_back(taken.count());
      summary.valid_share_sum += scene.valid_share;
      summary.deepest_mm = std::fmax(summary.deepest_mm, scene.depth_max_mm);
      table.write(
          {frame, scene.time_s, scene.valid_share, scene.depth_mean_mm, scene.depth_max_mm});
      if (options.raw) {
        write_depth_image(output.file("depth", numbered("", frame, ".tiff")), depth_mm);
      }
      if (options.pictures) {
        scene.section = painter.find_section(depth_mm);
        write_png(output.file("pictures", numbered("depth_", frame, ".png")), painter.depth(scene));
        write_png(output.file("pictures", numbered("side_", frame, ".png")), painter.side(scene));
        if (in_montage(done, total)) {
          columns.push_back(scene);
          columns.back().depth_mm = depth_mm.clone();  // the next frame overwrites it
        }
      }
    }
  }
  if (options.pictures) {
    const std::string name = std::filesystem::canonical(options.recording).filename().string();
    const std::string title = name + ": " + std::to_string(total) + " frames";
    write_png(output.file("pictures", "montage.png"), painter.montage(title, columns));
  }
  table.close();
  output.publish();
  print_summary(summary, recording, options, output);
  return 0;
}

}  // namespace replay
