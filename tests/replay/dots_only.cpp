// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Recordings of any pad with a grid of dots, of which only the frames, drawn here, are known.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "replay/dots/dots.hpp"
#include "replay/replay.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;
using replay::DotGrid;
using replay::is_present;
using test::table_of;

namespace {

const cv::Size frame_size(320, 240);

/// A pad whose dots are drawn at given positions.
struct Pad {
  double radius_px = 5;
  bool bright = false;
  cv::Scalar ground{150, 110, 90};  ///< blue, green, red
  double fall = 0.5;                ///< relative loss of light from the left to the right border
};

/// Rows x cols of dots around the middle of the frame, rotated from x to y.
DotGrid grid_of(cv::Size size, double pitch_px, double turn_degrees) {
  const double c = std::cos(turn_degrees * CV_PI / 180);
  const double s = std::sin(turn_degrees * CV_PI / 180);
  DotGrid dots(size);
  for (int i = 0; i < size.height; ++i) {
    for (int j = 0; j < size.width; ++j) {
      const double u = pitch_px * (j - (size.width - 1) / 2.0);
      const double v = pitch_px * (i - (size.height - 1) / 2.0);
      dots(i, j) = {160 + c * u - s * v, 120 + s * u + c * v};
    }
  }
  return dots;
}

cv::Mat drawn(const Pad& pad, const DotGrid& dots) {
  constexpr int fine = 4;
  const cv::Size size(frame_size.width * fine, frame_size.height * fine);
  cv::Mat sheet(size, CV_8UC3, pad.ground);
  for (const cv::Vec2d& dot : dots) {
    if (is_present(dot)) {
      const cv::Point at(cvRound((dot[0] + 0.5) * fine - 0.5),
                         cvRound((dot[1] + 0.5) * fine - 0.5));
      cv::circle(sheet, at, cvRound(pad.radius_px * fine),
                 pad.bright ? cv::Scalar(230, 235, 225) : cv::Scalar(30, 25, 28), cv::FILLED);
    }
  }
  cv::Mat frame;
  cv::resize(sheet, frame, frame_size, 0, 0, cv::INTER_AREA);
  for (int i = 0; i < frame.rows; ++i) {
    for (int j = 0; j < frame.cols; ++j) {
      frame.at<cv::Vec3b>(i, j) *= 1 - pad.fall * j / frame.cols;
    }
  }
  return frame;
}

DotGrid moved(const DotGrid& dots, const cv::Vec2d& by) {
  DotGrid all = dots.clone();
  for (cv::Vec2d& dot : all) {
    dot += by;
  }
  return all;
}

/// A recording with a sensor.json and frames, and a folder for the results.
class DotRecording {
 public:
  explicit DotRecording(const std::vector<cv::Mat>& frames, const std::string& sensor = "{}") {
    fs::create_directories(folder() / "frames");
    std::ofstream(folder() / "sensor.json") << sensor;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const std::string name = std::to_string(1000 + k) + ".png";
      cv::imwrite((folder() / "frames" / name).string(), frames[k]);
    }
  }

  fs::path folder() const { return root_.path() / "recording"; }
  fs::path out() const { return root_.path() / "out"; }

  std::string complaint(bool pictures = false) const {
    replay::Options options;
    options.recording = folder();
    options.out = out();
    options.pictures = pictures;
    options.raw = true;
    try {
      replay::run(options);
    } catch (const replay::Failure& failure) {
      CHECK_FALSE(fs::exists(out()));
      return failure.what();
    }
    return "";
  }

  /// The dots of every frame as replay finds them.
  std::vector<DotGrid> dots() const {
    replay::Recording recording = replay::open_recording(folder());
    auto source = replay::DotSource::of_dots_only(folder(), recording);
    std::vector<DotGrid> all;
    recording.frames.seek(0);
    for (int frame = 0; frame < recording.frames.size(); ++frame) {
      all.push_back(source.of(frame, recording.frames.next()));
    }
    return all;
  }

 private:
  test::ScratchFolder root_;
};

}  // namespace

TEST_CASE("frames without a grid of dots are refused") {
  const DotRecording even(
      std::vector<cv::Mat>{cv::Mat(frame_size, CV_8UC3, cv::Scalar(90, 120, 100))});
  CHECK(even.complaint().find("none of the first 1 frames shows a grid of nine or more dots") !=
        std::string::npos);
}

TEST_CASE("a first frame without dots does no harm") {
  const DotGrid truth = grid_of({7, 5}, 30, 10);
  const DotRecording recording(std::vector<cv::Mat>{
      cv::Mat(frame_size, CV_8UC3, cv::Scalar(1, 1, 1)), drawn({}, truth), drawn({}, truth)});
  const auto dots = recording.dots();
  CHECK(fingerpad::count_present(dots[0]) == 0);
  CHECK(fingerpad::count_present(dots[2]) == 35);
}

TEST_CASE("the stick ratio of a dots-only recording") {
  // Two of eight rows stand still while the others move.
  const DotGrid truth = grid_of({10, 8}, 26, 0);
  std::vector<cv::Mat> frames;
  for (int k = 0; k < 8; ++k) {
    DotGrid now = truth.clone();
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 10; ++j) {
        now(i, j) += cv::Vec2d(0.8 * k, 0);
      }
    }
    frames.push_back(drawn({}, now));
  }
  const DotRecording unknown(frames);  // as likely beside a small object
  REQUIRE(unknown.complaint().empty());
  CHECK(table_of(unknown.out() / "frames.csv")[7].at("stick_ratio").empty());

  const DotRecording recording(frames, R"({"stick": {"covers_pattern": true}})");
  REQUIRE(recording.complaint(true).empty());
  const auto rows = table_of(recording.out() / "frames.csv");
  REQUIRE(rows.size() == 8);
  CHECK(rows[0].at("dots_in_contact") == "80");
  CHECK(rows[0].at("stick_ratio").empty());
  CHECK(rows[0].at("stick_ratio_updated") == "0");
  for (const char* empty : {"depth_max_mm", "contact_area_mm2", "object_x_mm", "valid_share"}) {
    CHECK(rows[7].at(empty).empty());
  }
  // frames between those that the stick ratio compares keep its answer
  std::size_t answered = 7;
  while (answered > 0 && rows[answered].at("stick_ratio_updated") != "1") {
    --answered;
  }
  REQUIRE(answered >= 4);
  CHECK(std::abs(std::stod(rows[answered].at("stick_ratio")) - 0.75) < 1e-6);
  CHECK(rows[7].at("stick_ratio") == rows[answered].at("stick_ratio"));

  std::map<std::string, int> states;
  for (const auto& dot : table_of(recording.out() / "dots.csv")) {
    CHECK(dot.at("contact") == "1");
    CHECK(dot.at("x_mm").empty());
    if (dot.at("frame") == std::to_string(answered)) {
      ++states[dot.at("stick")];
      CHECK((dot.at("stick") == "1") == (std::stoi(dot.at("row")) < 6));
    }
  }
  CHECK(states["1"] == 60);
  CHECK(states["0"] == 20);
  CHECK(fs::exists(recording.out() / "pictures" / "stick_000007.png"));
  CHECK_FALSE(fs::exists(recording.out() / "depth"));
  CHECK_FALSE(fs::exists(recording.out() / "pictures" / "depth_000007.png"));
  // It accepts its own files as output again.
  CHECK(recording.complaint(true).empty());
}

TEST_CASE("thresholds of the stick ratio come from sensor.json") {
  const DotGrid truth = grid_of({8, 6}, 30, 0);
  std::vector<cv::Mat> frames;
  for (int k = 0; k < 5; ++k) {
    frames.push_back(drawn({}, moved(truth, {1.0 * k, 0})));
  }
  const auto answers = [&](const std::string& sensor) {
    const DotRecording recording(frames, sensor);
    REQUIRE(recording.complaint().empty());
    const auto rows = table_of(recording.out() / "frames.csv");
    return std::count_if(rows.begin(), rows.end(),
                         [](const auto& row) { return row.at("stick_ratio_updated") == "1"; });
  };
  CHECK(answers("{}") > 0);
  CHECK(answers(R"({"stick": {"noise_px": 0.3}})") == 0);
}

TEST_CASE("dots.csv serves a dots-only recording, too") {
  const DotGrid truth = grid_of({4, 3}, 30, 0);
  const cv::Mat plain(frame_size, CV_8UC3, cv::Scalar(90, 120, 100));
  const DotRecording recording(std::vector<cv::Mat>(4, plain));
  std::ofstream file(recording.folder() / "dots.csv");
  file << "frame,row,col,x_px,y_px\n";
  for (int frame = 0; frame < 4; ++frame) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) {
        file << frame << ',' << i << ',' << j << ',' << truth(i, j)[0] + 3 * frame << ','
             << truth(i, j)[1] << '\n';
      }
    }
  }
  file.close();
  REQUIRE(recording.complaint().empty());
  const auto rows = table_of(recording.out() / "frames.csv");
  CHECK(rows[3].at("dots_in_contact") == "12");
  CHECK(std::stod(rows[3].at("stick_ratio")) == 1);
}

TEST_CASE("the sensor.json of a dots-only recording is refused with the key's name") {
  struct Fault {
    const char* sensor;
    const char* complaint;
  };
  const auto [sensor, complaint] = GENERATE(
      Fault{R"({"dots": {"pitch_mm": 1}})",
            "unknown key dots.pitch_mm (known keys: rows, cols, diameter_px, bright)"},
      Fault{R"({"dots": {"rows": 5}})", "dots.cols is missing (number of columns of dots"},
      Fault{R"({"dots": {"rows": 5, "cols": 0}})", "dots.cols = 0"},
      Fault{R"({"dots": {"bright": 1}})", "dots.bright is 1 (a number), must be true or false"},
      Fault{R"({"dots": {"diameter_px": -2}})", "dots.diameter_px = -2, must be > 0"},
      Fault{R"({"stick": {"slip": 1}})", "unknown key stick.slip "},
      Fault{R"({"stick": {"noise_px": 0}})", "stick.noise_px = 0"},
      Fault{R"({"reference": {"fram": "a.png"}})", "unknown key reference.fram "},
      Fault{R"({"reference": {"frame": "none.png"}})", "none.png: there is no such file"},
      Fault{R"({"absorption": {}})", "camera is missing"},
      Fault{R"({"smoothing_px": 29})", "camera is missing"},
      Fault{R"({"sens": 1})", "unknown key sens "});
  const DotRecording recording(std::vector<cv::Mat>{drawn({}, grid_of({7, 5}, 30, 0))}, sensor);
  const std::string line = recording.complaint();
  INFO(line);
  CHECK(line.find(complaint) != std::string::npos);
  CHECK(line.find('\n') == std::string::npos);
}
