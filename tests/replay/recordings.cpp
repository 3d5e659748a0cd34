// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <sys/resource.h>
#include <sys/types.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/recording.hpp"
#include "common/video.hpp"
#include "replay/chain.hpp"
#include "replay/replay.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path bundled = test::bundled_recordings / "press";

/// A separate folder for each test, with a copy of the first frames of the bundled recording.
class Workplace {
 public:
  Workplace() {
    fs::create_directories(recording() / "frames");
    for (const char* file : {"sensor.json", "reference.png", "reference_depth.tiff",
                             "frames/000000.png", "frames/000001.png", "frames/000002.png"}) {
      fs::copy_file(bundled / file, recording() / file);
    }
  }

  fs::path recording() const { return root_.path() / "recording"; }
  fs::path out() const { return root_.path() / "out"; }

  replay::Options options() const {
    replay::Options options;
    options.recording = recording();
    options.out = out();
    options.raw = true;
    options.pictures = false;
    return options;
  }

  /// The error line of a run, or an empty string. A failed run must leave nothing behind.
  std::string complaint() const {
    std::string line;
    try {
      replay::run(options());
    } catch (const replay::Failure& failure) {
      line = failure.what();
      CHECK(names() == "recording ");
    }
    CHECK(line.find('\n') == std::string::npos);
    return line;
  }

  /// Names of the files beside the recording, hidden files included.
  std::string names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(root_.path())) {
      all.push_back(entry.path().filename().string());
    }
    std::sort(all.begin(), all.end());
    std::string line;
    for (const std::string& name : all) {
      line += name + " ";
    }
    return line;
  }

  void replace_in_sensor(const std::string& old, const std::string& with) const {
    test::replace_in(recording() / "sensor.json", old, with);
  }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(recording() / file) << text;
  }

 private:
  test::ScratchFolder root_;
};

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

/// Largest difference of two depth maps, which must be invalid in the same pixels.
double largest_difference(const fs::path& a, const fs::path& b) {
  const cv::Mat_<float> first = replay::read_depth_image(a);
  const cv::Mat_<float> second = replay::read_depth_image(b);
  REQUIRE(first.size() == second.size());
  double largest = 0;
  for (int i = 0; i < first.rows; ++i) {
    for (int j = 0; j < first.cols; ++j) {
      REQUIRE(std::isnan(first(i, j)) == std::isnan(second(i, j)));
      if (!std::isnan(first(i, j))) {
        largest = (std::max)(largest, static_cast<double>(std::abs(first(i, j) - second(i, j))));
      }
    }
  }
  return largest;
}

/// Three frames of 16 x 16 px; no file where there is no encoder.
void write_video(const fs::path& file) {
  const replay::QuietCodecs quiet;
  cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('F', 'F', 'V', '1'), 10,
                        cv::Size(16, 16));
  for (int k = 0; k < 3 && video.isOpened(); ++k) {
    video.write(cv::Mat(16, 16, CV_8UC3, cv::Scalar(0, 80 * k, 0)));
  }
}

}  // namespace

TEST_CASE("a recording gives a table and one depth map per frame") {
  const Workplace work;
  fs::copy_file(bundled / "frames/000003.png", work.recording() / "frames/000002.png",
                fs::copy_options::overwrite_existing);
  work.write("signals.csv", "frame,time_s,pressure_mpa\n0,0.00,0.016\n2,0.25,\n");
  REQUIRE(work.complaint().empty());
  CHECK(work.names() == "out recording ");
  std::ifstream table(work.out() / "frames.csv");
  std::string line;
  std::getline(table, line);
  CHECK(line ==
        "frame,time_s,depth_status,depth_light_sd_mm,pad_changed,valid_share,depth_mean_mm,"
        "depth_max_mm,contact_status,contact_area_mm2,contact_area_sd_mm2,contact_depth_mm,"
        "contact_center_x_mm,contact_center_y_mm,"
        "motion_status,object,object_x_mm,object_y_mm,object_z_mm,"
        "rotation_x_rad,rotation_y_rad,rotation_z_rad,object_sd_mm,rotation_sd_rad,"
        "slip_status,dots_in_contact,stick_ratio,stick_ratio_updated,stick_ratio_sd,slip_evidence,"
        "shift_x_mm,shift_y_mm,shift_rad,look_up_status,"
        "flat_area_mm2,normal_force_n,normal_force_sd_n,tangential_force_x_n,tangential_force_y_n,"
        "moment_z_nm,wrench_status,"
        "wrench_fx_n,wrench_fy_n,wrench_fz_n,wrench_mx_nm,wrench_my_nm,wrench_mz_nm,"
        "wrench_fx_sd_n,wrench_fy_sd_n,wrench_fz_sd_n,wrench_mx_sd_nm,wrench_my_sd_nm,"
        "wrench_mz_sd_nm,slide_status,contact_area_px,contact_center_x_px,contact_center_y_px,"
        "slide_dots,"
        "slide_x_px,slide_y_px,slide_pitches,area_lost,slide_evidence,slip");
  const auto columns = std::count(line.begin(), line.end(), ',');
  std::getline(table, line);
  CHECK(line.substr(0, 7) == "0,0.00,");
  // the free pad: without contact it has no position and no object
  CHECK(line.find(",ok,0.000000,0.000000,,,,no contact,,,,,,,,,,no contact,") != std::string::npos);
  CHECK(std::count(line.begin(), line.end(), ',') == columns);
  std::getline(table, line);
  CHECK(line.substr(0, 3) == "1,,");
  // a small contact, whose outline is not sure; nor are enough dots within it
  CHECK(line.find(",edge in doubt,") != std::string::npos);
  CHECK(line.find(",no pose,,,,,,,,,,") != std::string::npos);
  std::getline(table, line);
  CHECK(line.substr(0, 7) == "2,0.25,");
  // A refusal has neither force nor its sd; a pad with fluid has no columns of gels.
  CHECK(ends_with(line, ",no pressure" + std::string(23, ',')));
  line.resize(line.size() - 23);
  CHECK(line.find(",,,,,,") == std::string::npos);  // a rod touches: every other column is filled
  CHECK(std::count(line.begin(), line.end(), ',') == columns - 23);
  CHECK_FALSE(std::getline(table, line));
  CHECK(fs::exists(work.out() / "depth" / "000002.tiff"));
  CHECK(fs::exists(work.out() / "contact" / "000002.png"));
  std::ifstream dots(work.out() / "dots.csv");
  std::getline(dots, line);
  CHECK(line == "frame,row,col,x_px,y_px,x_mm,y_mm,z_mm,contact,stick");
  CHECK_FALSE(fs::exists(work.out() / "pictures"));
}

TEST_CASE("sensor.json is refused with the key's name") {
  const Workplace work;
  struct Fault {
    const char* old;
    const char* with;
    const char* complaint;
  };
  const auto [old, with, complaint] = GENERATE(
      Fault{"\"pitch_mm\": 0.08", "\"pich_mm\": 0.08", "unknown key camera.pich_mm"},
      Fault{"\"smoothing_px\": 29", "\"smooth\": 29", "unknown key smooth "},
      Fault{"\"smoothing_px\"", "\"stick\": {\"slipp_px\": 1}, \"smoothing_px\"",
            "unknown key stick.slipp_px (known keys: noise_px, covers_pattern, soft_object)"},
      Fault{"\"smoothing_px\"", "\"stick\": {\"noise_px\": -1}, \"smoothing_px\"",
            "stick.noise_px = -1"},
      Fault{"\"smoothing_px\"", "\"stick\": {\"noise_px\": \"1\"}, \"smoothing_px\"",
            "stick.noise_px is \"1\" (a string), must be a number"},
      Fault{"\"kappa\": 0.9924,", "", "absorption.kappa is missing (ratio of light"},
      Fault{"\"frame\": \"reference.png\",", "", "reference.frame is missing (picture of"},
      Fault{"\"plate_distance_mm\": 50.0", "\"plate_distance_mm\": \"50\"",
            "camera.plate_distance_mm is \"50\" (a string), must be a number"},
      Fault{"[239.5, 239.5]", "[239.5]", "camera.center_px is [239.5] (an array), must be two"},
      Fault{"\"smoothing_px\": 29", "\"smoothing_px\": 28", "smoothing_px = 28, must be odd"},
      Fault{"\"smoothing_px\": 29", "\"smoothing_px\": 2.5", "must be a whole number"},
      Fault{"\"refractive_index\": 1.33", "\"refractive_index\": 0.9", "refractive_index = 0.9"},
      Fault{"\"base_radius_mm\": 18.735", "\"base_radius_mm\": -1", "pad.base_radius_mm = -1"},
      Fault{"\"rows\": 21", "\"rows\": 0", "dots.rows = 0"},
      Fault{"\"rows\": 21", "\"rows\": 2000", "dots.rows = 2000, must be 2 to 100"},
      Fault{"\"pitch_mm\": 1.5", "\"pitch_mm\": 1e300",
            "section dots: DotFinder: pattern.pitch_px"},
      Fault{"\"pitch_mm\": 1.5", "\"pitch_mm\": 0.1", "dots: diameter_mm must be less than"},
      Fault{"{", "[", "parse error"},
      Fault{"\"reference.png\"", "7", "reference.frame is 7 (a number), must be the path"},
      Fault{"\"reference.png\"", "\"none.png\"", "none.png: there is no such file"},
      Fault{"\"smoothing_px\"", "\"video\": \"none.mp4\", \"smoothing_px\"", "no such video"});
  work.replace_in_sensor(old, with);
  const std::string line = work.complaint();
  INFO(line);
  CHECK(line.find(complaint) != std::string::npos);
}

TEST_CASE("optional sections are accepted, and checked") {
  const Workplace work;
  work.replace_in_sensor("\"stress_free_inclination_rad\": 1.0618",
                         "\"membrane_modulus_n_per_mm\": 0.5");
  work.replace_in_sensor(
      "\"smoothing_px\"",
      "\"neighbour_light\": { \"radius_px\": 30, \"m0_mm_per_rad\": 1e-5, \"n_per_mm\": 0.224 },\n"
      "\"smoothing_px\"");
  CHECK(work.complaint().empty());
  fs::remove_all(work.out());
  work.replace_in_sensor("\"radius_px\": 30", "\"radius_px\": \"30\"");
  CHECK(work.complaint().find("neighbour_light.radius_px is \"30\"") != std::string::npos);
}

TEST_CASE("frames of the free pad set the threshold of contact") {
  const auto area_of_frame_2 = [](const Workplace& work) {
    REQUIRE(work.complaint().empty());
    const double area =
        std::stod(test::table_of(work.out() / "frames.csv").at(2).at("contact_area_mm2"));
    fs::remove_all(work.out());
    return area;
  };
  const Workplace work;
  const double from_shape = area_of_frame_2(work);
  fs::create_directory(work.recording() / "free");
  SECTION("frames of a free pad: much the same") {
    fs::copy_file(work.recording() / "frames/000000.png", work.recording() / "free/0.png");
    const double from_frame = area_of_frame_2(work);
    CHECK(from_frame != from_shape);
    CHECK(std::abs(from_frame - from_shape) < 0.1 * from_shape);
  }
  SECTION("none there") {
    CHECK(ends_with(work.complaint(),
                    "free: holds no frames; put the pictures there, as 000000.png, "
                    "000001.png, ..."));
  }
  SECTION("a frame of another size") {
    cv::imwrite((work.recording() / "free" / "0.png").string(),
                cv::Mat(100, 120, CV_8UC3, cv::Scalar(1, 2, 3)));
    CHECK(
        ends_with(work.complaint(),
                  "free/0.png: is 120 x 100 px, but the reference is 480 x 480 px; take both with "
                  "the same setting of the camera"));
  }
}

TEST_CASE("files that cannot be used are refused with their name") {
  const Workplace work;
  SECTION("no frames") {
    fs::remove_all(work.recording() / "frames");
    fs::create_directory(work.recording() / "frames");
    CHECK(ends_with(work.complaint(),
                    "frames: holds no frames; put the pictures there, as "
                    "000000.png, 000001.png, ..."));
  }
  SECTION("no folder of frames") {
    fs::remove_all(work.recording() / "frames");
    CHECK(work.complaint().find("frames: there is no such folder") != std::string::npos);
  }
  SECTION("frames that are no images") {
    for (const char* file : {"frames/000000.png", "frames/000001.png", "frames/000002.png"}) {
      work.write(file, "not an image");
    }
    CHECK(work.complaint().find("frames/000000.png: cannot be read") != std::string::npos);
  }
  SECTION("a frame of another size") {
    cv::imwrite((work.recording() / "frames" / "000001.png").string(),
                cv::Mat(100, 120, CV_8UC3, cv::Scalar(1, 2, 3)));
    CHECK(ends_with(
        work.complaint(),
        "frames/000001.png: is 120 x 100 px, but the reference is 480 x 480 px; take both with "
        "the same setting of the camera"));
  }
  SECTION("a grey frame") {
    cv::imwrite((work.recording() / "frames" / "000001.png").string(),
                cv::Mat(480, 480, CV_8UC1, cv::Scalar(9)));
    CHECK(work.complaint().find("000001.png: has 1 channel, but must be a colour") !=
          std::string::npos);
  }
  SECTION("no reference") {
    fs::remove(work.recording() / "reference.png");
    CHECK(ends_with(work.complaint(),
                    "reference.png: there is no such file; a picture of the pad with nothing in "
                    "contact belongs there"));
  }
  SECTION("a reference depth of another size") {
    cv::imwrite((work.recording() / "reference_depth.tiff").string(), cv::Mat1f(9, 9, 1.0F));
    CHECK(work.complaint().find("reference_depth.tiff: is 9 x 9 px, but reference.png") !=
          std::string::npos);
  }
  SECTION("a reference depth that is no depth") {
    fs::copy_file(work.recording() / "reference.png", work.recording() / "reference_depth.tiff",
                  fs::copy_options::overwrite_existing);
    CHECK(work.complaint().find("must be a 32-bit float image") != std::string::npos);
  }
  SECTION("a reference without the pad") {
    cv::imwrite((work.recording() / "reference_depth.tiff").string(),
                cv::Mat1f(480, 480, std::nanf("")));
    CHECK(work.complaint().find("fit_reference") != std::string::npos);
  }
}

TEST_CASE("signals.csv is refused with the line's number") {
  const Workplace work;
  struct Fault {
    const char* text;
    const char* complaint;
  };
  const auto [text, complaint] = GENERATE(
      Fault{"", "signals.csv: is empty"}, Fault{"time,frame\n", "line 1: must be frame,time_s"},
      Fault{"frame,time_s\n0,0\n1\n", "line 3: has 1 values, must have 2"},
      Fault{"frame,time_s\n0,zero\n", "line 2: time_s 'zero' is not a number"},
      Fault{"frame,time_s\n3,0\n", "line 2: frame '3' is not one of the frames 0 to 2"},
      Fault{"frame,time_s\n1.5,0\n", "line 2: frame '1.5' is not"},
      Fault{"frame,time_s\n1,0\n1,1\n", "line 3: frame 1 is given twice"},
      Fault{"frame,time_s,pressure_mpa\n0,0,x\n", "line 2: pressure_mpa 'x' is not a number"});
  work.write("signals.csv", text);
  const std::string line = work.complaint();
  INFO(line);
  CHECK(line.find(complaint) != std::string::npos);
}

TEST_CASE("an earlier run is replaced, anything else is left alone") {
  const Workplace work;
  REQUIRE(work.complaint().empty());
  auto options = work.options();
  options.range = {1, 2};
  replay::run(options);
  CHECK_FALSE(fs::exists(work.out() / "depth" / "000000.tiff"));
  CHECK(fs::exists(work.out() / "depth" / "000001.tiff"));
  CHECK(work.names() == "out recording ");

  SECTION("a run that fails leaves the earlier one as it was") {
    work.write("frames/000001.png", "");
    CHECK_THROWS_AS(replay::run(options), replay::Failure);
    CHECK(fs::exists(work.out() / "depth" / "000001.tiff"));
    CHECK(work.names() == "out recording ");
  }
  SECTION("a foreign file among the results") {
    std::ofstream(work.out() / "depth" / "notes.txt") << "mine";
    CHECK_THROWS_WITH(replay::run(options), Catch::Contains("contains depth/notes.txt"));
    CHECK(fs::exists(work.out() / "depth" / "notes.txt"));
  }
  SECTION("a folder of somebody else") {
    options.out = work.recording();
    CHECK_THROWS_WITH(replay::run(options), Catch::Contains("which replay did not write"));
    CHECK(fs::exists(work.recording() / "sensor.json"));
  }
  SECTION("a file in the place of the folder") {
    options.out = work.recording() / "sensor.json";
    CHECK_THROWS_WITH(replay::run(options), Catch::Contains("is not a folder"));
  }
  SECTION("an empty folder, and folders that are not there yet") {
    options.out = work.recording().parent_path() / "new" / "newer" / "out";
    replay::run(options);
    CHECK(fs::exists(options.out / "frames.csv"));
    fs::remove_all(options.out);
    fs::create_directory(options.out);
    replay::run(options);
    CHECK(fs::exists(options.out / "frames.csv"));
  }
}

TEST_CASE("frames are sorted as people sort them") {
  const Workplace work;
  const fs::path folder = work.recording() / "frames";
  const std::vector<std::string> counted = {"frame2.png", "frame10.png", "frame010b.png",
                                            "frame100.png", "left1.png"};
  const std::vector<std::string> microseconds = {"0.png", "900000.png", "1e+06.png", "1.1e+06.png",
                                                 "2.05e+06.png"};
  const auto names = GENERATE_COPY(counted, microseconds);
  fs::rename(folder / "000000.png", folder / names[0]);
  fs::rename(folder / "000001.png", folder / names[1]);
  fs::rename(folder / "000002.png", folder / names[2]);
  fs::copy_file(folder / names[0], folder / names[3]);
  fs::copy_file(folder / names[0], folder / names[4]);
  auto frames = replay::FrameSource::of_folder(folder);
  REQUIRE(frames.size() == 5);
  frames.seek(0);
  for (const std::string& name : names) {
    (void)frames.next();
    CHECK(frames.last_file().filename() == name);
  }
}

TEST_CASE("a picture that does not fit on the disk is told") {
  const cv::Mat picture(64, 64, CV_8UC3, cv::Scalar(1, 2, 3));
  const cv::Mat_<float> depth(64, 64, 1.0F);
  if (fs::exists("/dev/full")) {
    CHECK_THROWS_AS(replay::write_png("/dev/full", picture), replay::Failure);
    CHECK_THROWS_AS(replay::write_depth_image("/dev/full", depth), replay::Failure);
  }
  CHECK_THROWS_AS(replay::write_png("/no such folder/a.png", picture), replay::Failure);
}

TEST_CASE("a lamp that has changed is told of the frame") {
  const Workplace work;
  replay::Recording recording = replay::open_recording(work.recording());
  replay::Chain chain(recording, work.options());
  const cv::Mat frame = cv::imread((work.recording() / "frames/000002.png").string());
  CHECK_FALSE(chain(2, frame).pad_has_changed());
  CHECK(chain(2, frame * 0.85).pad_has_changed());
}

TEST_CASE("16-bit frames give the depth of 8-bit frames") {
  const Workplace narrow;
  const Workplace wide;
  for (const auto& entry : fs::directory_iterator(wide.recording() / "frames")) {
    cv::Mat frame = cv::imread(entry.path().string(), cv::IMREAD_UNCHANGED);
    frame.convertTo(frame, CV_16U, 256);
    cv::imwrite(entry.path().string(), frame);
  }
  auto options = narrow.options();
  auto options_wide = wide.options();
  options.smoothing_px = options_wide.smoothing_px = GENERATE(1, 29);
  replay::run(options);
  replay::run(options_wide);
  for (const char* name : {"000000.tiff", "000002.tiff"}) {
    CHECK(largest_difference(narrow.out() / "depth" / name, wide.out() / "depth" / name) < 2e-5);
  }
}

TEST_CASE("a video takes the place of the folder of frames") {
  const Workplace work;
  const fs::path file = work.recording() / "frames.avi";
  {
    const replay::QuietCodecs quiet;
    // Lossless, so that the depth is that of the images.
    cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('F', 'F', 'V', '1'), 10,
                          cv::Size(480, 480));
    for (const char* name : {"000000.png", "000001.png", "000002.png"}) {
      if (video.isOpened()) {
        video.write(cv::imread((work.recording() / "frames" / name).string()));
      }
    }
  }
  if (!fs::exists(file) || fs::file_size(file) < 10000) {
    WARN("no encoder for FFV1 here; videos are not tested");
    return;
  }
  auto options = work.options();
  replay::run(options);
  work.replace_in_sensor("\"smoothing_px\"", "\"video\": \"frames.avi\", \"smoothing_px\"");
  options.out = work.recording().parent_path() / "from_video";
  options.range = {1, {}};
  replay::run(options);
  CHECK_FALSE(fs::exists(options.out / "depth" / "000000.tiff"));
  // FFV1 stores luminance and colour differences here, which costs about a grey level.
  const cv::Mat_<float> from_images =
      replay::read_depth_image(work.out() / "depth" / "000002.tiff");
  const cv::Mat_<float> from_video =
      replay::read_depth_image(options.out / "depth" / "000002.tiff");
  CHECK(std::abs(from_images(240, 240) - from_video(240, 240)) < 1.0F);

  work.write("frames.avi", "not a video");
  fs::remove_all(work.out());
  fs::remove_all(options.out);
  CHECK(work.complaint().find("frames.avi: cannot be read as a video") != std::string::npos);
}

TEST_CASE("a range of frames must lie in the recording") {
  const Workplace work;
  auto options = work.options();
  options.range = {2, 5};
  CHECK_THROWS_WITH(replay::run(options),
                    Catch::Contains("has frames 0 to 2, but --frames is 2:5"));
  CHECK(replay::parse_range("3:").first == 3);
  CHECK(replay::parse_range(":7").last == 7);
  for (const char* bad : {"", "3", "a:b", "1:2:3", "-1:2", "1 :2"}) {
    CHECK_THROWS_AS(replay::parse_range(bad), std::invalid_argument);
  }
}

TEST_CASE("a video that claims too large frames and one that names other files are refused") {
  const Workplace work;
  const auto refusal = [&](const std::string& name) -> std::string {
    try {
      (void)replay::Video(work.recording() / name);
    } catch (const replay::Failure& failure) {
      return failure.what();
    }
    return "";
  };
  const auto file = work.recording() / "frames.avi";
  write_video(file);
  work.write("playlist.avi", "ffconcat version 1.0\nfile frames.avi\n");
  CHECK(refusal("playlist.avi").find("playlist") != std::string::npos);
  std::string bytes = test::text_of(file);
  const auto format = bytes.find("strf");
  if (format == std::string::npos) {
    WARN("no encoder for FFV1 here; the size that a video claims is not tested");
    return;
  }
  CHECK(refusal("frames.avi").empty());
  ::setenv("OPENCV_IO_MAX_IMAGE_PIXELS", "255", 1);
  CHECK(refusal("frames.avi").find("16 x 16 px, but at most 255 px") != std::string::npos);
  ::unsetenv("OPENCV_IO_MAX_IMAGE_PIXELS");
  const std::string claimed("\x80\x3e\0\0\x80\x3e\0\0", 8);  // 16000 x 16000
  bytes.replace(format + 12, claimed.size(), claimed);
  work.write("frames.avi", bytes);
  CHECK(refusal("frames.avi").find("16000 x 16000 px, but at most") != std::string::npos);
}

TEST_CASE("a decoder that ends before its video does is one failure") {
  const Workplace work;
  const auto file = work.recording() / "frames.avi";
  write_video(file);
  if (!fs::exists(file)) {
    WARN("no encoder for FFV1 here; decoders that end are not tested");
    return;
  }
  // The children of this process. Where Linux does not tell them, there is none to end.
  std::ifstream children("/proc/thread-self/children");
  if (!children) {
    WARN("this system does not tell which process decodes; decoders that end are not tested");
    return;
  }
  replay::Video video(file);
  REQUIRE(video.grab());
  REQUIRE(video.retrieve().size() == cv::Size(16, 16));
  pid_t decoder = 0;
  REQUIRE(children >> decoder);
  const auto [signal, reason] =
      GENERATE(std::pair(SIGSEGV, "its decoder crashed"),
               std::pair(SIGALRM, "its decoder takes more than a minute"));
  REQUIRE(::kill(decoder, signal) == 0);
  for (int again = 0; again < 2; ++again) {
    CHECK_THROWS_WITH(video.retrieve(), Catch::Contains("frames.avi: ") && Catch::Contains(reason));
    CHECK_THROWS_AS(video.grab(), replay::Failure);
    CHECK_THROWS_AS(video.rewind(), replay::Failure);
  }
  CHECK(replay::Video(file).grab());
}

TEST_CASE("a stream that claims a frame of a gigabyte gets no more memory than its file claims") {
  try {
    replay::Video video(test::bundled_recordings / "../../tests/fuzz/corpus/video" /
                        "larger_stream.webm");
    while (video.grab()) {
      CHECK(video.retrieve().total() < 10000);
    }
  } catch (const replay::Failure& failure) {
    CHECK(std::string(failure.what()).find("larger_stream.webm: ") != std::string::npos);
  }
  rusage used{};  // of the largest process that has been waited for; in kB on Linux
  REQUIRE(getrusage(RUSAGE_CHILDREN, &used) == 0);
  CHECK(used.ru_maxrss < 800'000);
}
