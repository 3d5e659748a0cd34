// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Recordings of a gel pad: a ball of support/elastic_gel.hpp is pressed, dragged until it slides,
// and lifted. The results of replay are compared with the true slide.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "replay/gel/slide_step.hpp"
#include "replay/replay.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/gel_frames.hpp"

namespace fs = std::filesystem;
using test::GelCamera;

namespace {

struct Step {
  double force_n;
  double ball_x_mm;
};

/// A folder of frames with a sensor.json of {}, and a folder for the results.
class GelRecording {
 public:
  GelRecording() {
    fs::create_directories(folder() / "frames");
    std::ofstream(folder() / "sensor.json") << "{}";
  }

  fs::path folder() const { return root_.path() / "recording"; }
  fs::path out() const { return root_.path() / "out"; }

  /// Adds the current frame of the camera.
  void add(const char* part) {
    const auto frame = camera.frame(contact, random_);
    cv::Mat picture(static_cast<int>(frame.rows()), static_cast<int>(frame.cols()), CV_8UC3);
    std::memcpy(picture.data, frame.cells.data(), picture.total() * picture.elemSize());
    fs::create_directories(folder() / part);
    cv::imwrite((folder() / part / (std::to_string(100 + count_++) + ".png")).string(), picture);
  }
  void drag(const std::vector<Step>& steps) {
    for (const Step& step : steps) {
      contact.drag(step.force_n, {step.ball_x_mm, 0});
      add("frames");
    }
  }
  /// Converts the frames to a video; false if none can be written.
  bool becomes_video() const {
    cv::VideoWriter video;
    for (int k = 0; k < count_; ++k) {
      const fs::path file = folder() / "frames" / (std::to_string(100 + k) + ".png");
      if (fs::exists(file)) {
        const cv::Mat frame = cv::imread(file.string());
        if (!video.isOpened() &&
            !video.open((folder() / "gel.avi").string(),
                        cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25, frame.size())) {
          return false;
        }
        video.write(frame);
      }
    }
    fs::remove_all(folder() / "frames");
    std::ofstream(folder() / "sensor.json") << R"({"video": "gel.avi"})";
    return true;
  }
  void run(bool pictures = false) const {
    replay::Options options;
    options.recording = folder();
    options.out = out();
    options.pictures = pictures;
    replay::run(options);
  }

  /// A column of frames.csv.
  std::vector<std::string> column(const std::string& name) const {
    std::vector<std::string> column;
    for (const test::Line& line : test::table_of(out() / "frames.csv")) {
      column.push_back(line.at(name));
    }
    return column;
  }
  std::size_t first_slip() const {
    const auto slips = column("slip");
    return static_cast<std::size_t>(std::find(slips.begin(), slips.end(), "1") - slips.begin());
  }

  GelCamera camera{.contrast = 0.8};
  test::BallOnGel<> contact{test::GelPad{}};

 private:
  test::ScratchFolder root_;
  test::Random random_{3};
  int count_ = 0;
};

}  // namespace

TEST_CASE("a gel on which a ball slides: contact, slide and slip") {
  GelRecording recording;
  const std::vector<Step> steps = {{0, 0},     {0, 0},     {0.8, 0},   {1.2, 0},   {1.2, 0.1},
                                   {1.2, 0.2}, {1.2, 1.2}, {1.2, 2.2}, {1.2, 3.2}, {0, 3.2}};
  const bool video = GENERATE(false, true);
  bool pictures = false;
  SECTION("the first frames show the free pad") {}
  SECTION("free frames beside it") {
    recording.add("free");
    recording.add("free");
    pictures = !video;
  }
  recording.drag(steps);
  if (video && !recording.becomes_video()) {
    WARN("no encoder for motion JPEG here; videos of a gel are not tested");
    return;
  }
  recording.run(pictures);
  const auto area = recording.column("contact_area_px");
  REQUIRE(area.size() == steps.size());
  CHECK(area[1] == "0");
  CHECK(area.back() == "0");
  CHECK(std::stod(area[4]) > 0);
  CHECK(recording.column("contact_center_x_px")[1].empty());
  CHECK(recording.column("slide_status")[2] == "ok");
  // it slides by 1 mm a frame, 12.5 px, from the sixth frame on at the latest
  const auto slide = recording.column("slide_x_px");
  CHECK(std::stod(slide[8]) - std::stod(slide[7]) == Approx(12.5).epsilon(0.2));
  CHECK(std::abs(std::stod(recording.column("slide_y_px")[8])) < 1);
  CHECK(recording.first_slip() >= 6);
  CHECK(recording.first_slip() <= 7);
  CHECK(recording.column("slide_status").back() == "no contact");
  CHECK(fs::exists(recording.out() / "pictures" / "slide_000009.png") == pictures);
  if (pictures) {  // its own files are accepted as output again
    recording.run();
    CHECK_FALSE(fs::exists(recording.out() / "pictures"));
  }
}

TEST_CASE("a gel that holds a ball, and one that nothing touches") {
  GelRecording recording;
  recording.drag({{0, 0}, {0, 0}, {0.8, 0}, {1.2, 0}, {1.2, 0.1}, {0.8, 0.1}, {0, 0.1}});
  recording.run();
  CHECK(recording.first_slip() == 7);
  CHECK(std::stod(recording.column("area_lost")[5]) > 0.02);
  GelRecording untouched;
  untouched.drag({{0, 0}, {0, 0}, {0, 0}});
  untouched.run(true);
  CHECK(untouched.column("contact_area_px") == std::vector<std::string>(3, "0"));
  CHECK(fs::exists(untouched.out() / "pictures" / "slide_000000.png"));
}

TEST_CASE("gel contact for dots of any size") {
  const fingerpad::GelOptions usual;
  for (const double larger : {0.1, 0.5, 1.0, 2.0, 10.0}) {
    const auto options = replay::gel_options_for(larger * usual.dot_px);
    CHECK(check(options) == "");
    CHECK(options.smoothing_px == Approx(larger * usual.smoothing_px));
    CHECK(std::abs(options.min_region_px - larger * larger * 800) <= 1);
  }
}
