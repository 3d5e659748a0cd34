// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/dots.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "common/recording.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;
using replay::DotGrid;
using replay::is_present;

namespace {

const fs::path bundled = test::bundled_recordings / "press";

struct Recorded {
  replay::Recording recording = replay::open_recording(bundled);
  std::vector<cv::Mat> frames;

  Recorded() {
    recording.frames.seek(0);
    for (int k = 0; k < recording.frames.size(); ++k) {
      frames.push_back(recording.frames.next());
    }
  }
  replay::DotSource source(const fs::path& folder = bundled) const {
    return replay::DotSource(folder, recording.sensor, recording.reference,
                             recording.reference_depth, recording.frames.size());
  }
};

/// Read once, because the images are the same in every test.
const Recorded& press() {
  static const Recorded recorded;
  return recorded;
}

/// True dots of the bundled recording, per frame. The file has float32 triples behind a header that
/// ends with a line feed. On the free pad, its first step, the dots lie on multiples of the pitch
/// in plan, which is their place in the print.
std::vector<DotGrid> true_dots() {
  std::ifstream file(bundled / "membrane" / "dots.npy", std::ios::binary);
  std::string header;
  std::getline(file, header);
  const std::string values(std::istreambuf_iterator<char>(file), {});
  const std::size_t steps = press().frames.size();
  const std::size_t count = values.size() / (steps * 3 * sizeof(float));
  REQUIRE(header.find("'<f4'") != std::string::npos);
  REQUIRE(header.find("(" + std::to_string(steps) + ", " + std::to_string(count) + ", 3)") !=
          std::string::npos);
  const auto value = [&](std::size_t step, std::size_t dot, std::size_t axis) {
    float number = 0;
    const std::size_t at = ((step * count + dot) * 3 + axis) * sizeof(float);
    values.copy(reinterpret_cast<char*>(&number), sizeof(float), at);
    return static_cast<double>(number);
  };
  const replay::Dots& print = *press().recording.sensor.dots;
  std::vector<DotGrid> dots(steps);
  for (std::size_t step = 0; step < steps; ++step) {
    dots[step] = replay::no_dots({print.cols, print.rows});
    for (std::size_t dot = 0; dot < count; ++dot) {
      const auto col = std::lround(value(0, dot, 0) / print.pitch_mm) + (print.cols - 1) / 2;
      const auto row = std::lround(value(0, dot, 1) / print.pitch_mm) + (print.rows - 1) / 2;
      const auto pixel = fingerpad::pixel_of(
          press().recording.sensor.camera,
          fingerpad::Point3<double>{value(step, dot, 0), value(step, dot, 1), value(step, dot, 2)});
      dots[step](static_cast<int>(row), static_cast<int>(col)) = {pixel.x, pixel.y};
    }
  }
  return dots;
}

struct Comparison {
  int true_count = 0;
  int found = 0;
  int wrong = 0;      ///< more than half a pitch from the truth, or missing
  double rms_px = 0;  ///< of found dots within 16 mm of the axis on the plate
};

Comparison compare(const DotGrid& found, const DotGrid& truth) {
  const replay::Sensor& sensor = press().recording.sensor;
  const cv::Vec2d axis(sensor.camera.center_x_px, sensor.camera.center_y_px);
  REQUIRE(found.size() == truth.size());
  Comparison result;
  double sum = 0;
  int inner = 0;
  for (int i = 0; i < truth.rows; ++i) {
    for (int j = 0; j < truth.cols; ++j) {
      result.true_count += is_present(truth(i, j)) ? 1 : 0;
      if (!is_present(found(i, j))) {
        continue;
      }
      ++result.found;
      const double error = cv::norm(found(i, j) - truth(i, j));
      // Near the rim, dots are closer together in the image than half a pitch on the plate.
      const bool right = error < 3;
      result.wrong += right ? 0 : 1;
      if (right && cv::norm(truth(i, j) - axis) * sensor.camera.pitch_mm < 16) {
        sum += error * error;
        ++inner;
      }
    }
  }
  result.rms_px = std::sqrt(sum / (inner > 0 ? inner : 1));
  return result;
}

/// Largest distance of corresponding dots; both grids must have the same dots.
double largest_distance(const DotGrid& a, const DotGrid& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (int i = 0; i < a.rows; ++i) {
    for (int j = 0; j < a.cols; ++j) {
      REQUIRE(is_present(a(i, j)) == is_present(b(i, j)));
      if (is_present(a(i, j))) {
        largest = (std::max)(largest, cv::norm(a(i, j) - b(i, j)));
      }
    }
  }
  return largest;
}

struct Folder : test::ScratchFolder {
  void write(const std::string& text) const { std::ofstream(path() / "dots.csv") << text; }
};

std::string lines_of(int frame, const DotGrid& dots) {
  std::string lines;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      if (is_present(dots(i, j))) {
        lines += std::to_string(frame) + "," + std::to_string(i) + "," + std::to_string(j) + "," +
                 std::to_string(dots(i, j)[0]) + "," + std::to_string(dots(i, j)[1]) + "\n";
      }
    }
  }
  return lines;
}

}  // namespace

TEST_CASE("the dots of the bundled recording are found where they are") {
  auto source = press().source();
  REQUIRE(source.present());
  CHECK(source.how() == "found in the frames");
  const std::vector<DotGrid> truth = true_dots();
  const auto check = [](const DotGrid& found, const DotGrid& true_dots_of_frame) {
    const Comparison result = compare(found, true_dots_of_frame);
    CHECK(result.found >= 0.99 * result.true_count);
    CHECK(result.wrong == 0);
    CHECK(result.rms_px < 0.08);
  };
  check(source.initial(), truth.front());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    INFO("frame " << k);
    check(source.of(static_cast<int>(k), press().frames[k]), truth[k]);
  }
}

TEST_CASE("rows of dots around the rim are found beside the grid, and given with each frame") {
  const DotGrid grid = press().source().initial();
  replay::Sensor sensor = press().recording.sensor;
  sensor.rim->side_rows = {{72, 1.5, 0.64, 0}, {72, 3, 0.64, CV_PI / 72}};
  std::vector<cv::Vec2d> painted;
  const auto paint = [&](const cv::Mat& from) {
    cv::Mat image = from.clone();
    painted.clear();
    for (int k = 0; k < 144; ++k) {
      const double angle = (k < 72 ? 0.0 : CV_PI / 72) + 2 * CV_PI * k / 72,
                   rho = k < 72 ? 222 : 205;
      const cv::Vec2d at(239.5 + rho * std::cos(angle), 239.5 + rho * std::sin(angle));
      const bool is_free = std::none_of(grid.begin(), grid.end(), [&](const cv::Vec2d& dot) {
        return is_present(dot) && cv::norm(dot - at) < 12;
      });
      painted.push_back(is_free ? at : cv::Vec2d::all(std::nan("")));
      if (is_free) {
        cv::circle(image, cv::Point(cvRound(16 * at[0]), cvRound(16 * at[1])), 64,
                   cv::Scalar::all(image.depth() == CV_16U ? 2560 : 10), cv::FILLED, cv::LINE_AA,
                   4);
      }
    }
    return image;
  };
  const cv::Mat reference = paint(press().recording.reference);
  replay::DotSource source(bundled, sensor, reference, press().recording.reference_depth, 0);
  INFO(source.side_how());
  const DotGrid free_pad = source.initial(), seen = source.of(0, paint(press().frames[0]));
  for (const DotGrid& found : {free_pad, seen}) {  // the grid is the same
    REQUIRE(found.size() == grid.size());
    CHECK(100 * fingerpad::count_present(found) > 97 * fingerpad::count_present(grid));
    for (int k = 0; k < static_cast<int>(grid.total()); ++k) {
      const cv::Vec2d& dot = found(k / grid.cols, k % grid.cols);
      CHECK((!is_present(dot) || cv::norm(dot - grid(k / grid.cols, k % grid.cols)) < 0.2));
    }
  }
  REQUIRE(source.side().size() == 144);
  int found = 0, drawn = 0;
  for (std::size_t k = 0; k < 144; ++k) {
    const auto& dot = source.side()[k];
    found += is_present(cv::Vec2d(dot.px.x, dot.px.y)) ? 1 : 0;
    drawn += is_present(painted[k]) ? 1 : 0;
    if (is_finite(dot.px)) {  // none of the grid's dots
      CHECK(cv::norm(cv::Vec2d(dot.px.x, dot.px.y) - painted[k]) < 0.3);
      CHECK((dot.sd_px > 0 && dot.sd_px < 0.3));
    }
  }
  CHECK(found > 0.9 * drawn);
  CHECK(source.side_how() == std::to_string(drawn) + " around the rim");

  sensor.rim->side_rows[1].count = 41;
  const replay::DotSource other(bundled, sensor, reference, press().recording.reference_depth, 0);
  CHECK(other.side_how().find("none: the row of side dots at 3 mm from the rim shows") == 0);
}

TEST_CASE("without a word about dots there are none") {
  replay::Sensor sensor = press().recording.sensor;
  sensor.dots.reset();
  replay::DotSource source(bundled, sensor, press().recording.reference,
                           press().recording.reference_depth, 11);
  CHECK_FALSE(source.present());
  CHECK(source.of(0, press().frames[0]).empty());
}

TEST_CASE("dots.csv is read as it was written, and goes before the frames") {
  auto found = press().source();
  const DotGrid first = found.of(0, press().frames[0]);
  const DotGrid third = found.of(2, press().frames[2]);
  const Folder folder;
  folder.write("frame,row,col,x_px,y_px\r\n" + lines_of(2, third) + "\n" + lines_of(0, first));
  auto read = press().source(folder.path());
  REQUIRE(read.present());
  CHECK(read.how() == "dots.csv");
  CHECK(largest_distance(read.of(0, press().frames[0]), first) < 1e-5);
  CHECK(fingerpad::count_present(read.of(1, press().frames[1])) == 0);
  CHECK(read.of(1, press().frames[1]).size() == first.size());
  CHECK(largest_distance(read.of(2, press().frames[0]), third) < 1e-5);
  CHECK(largest_distance(read.initial(), first) < 1e-5);
}

TEST_CASE("the reference shows the free pad's dots where dots.csv has fewer of the same") {
  const DotGrid free_pad = press().source().initial();
  const Folder folder;
  const auto half = [&](int by) {
    DotGrid dots = replay::no_dots(free_pad.size());
    for (int i = 0; i < dots.rows; ++i) {
      for (int j = by; j < dots.cols; j += 2) {
        dots(i, j) = free_pad(i, j - by);
      }
    }
    return dots;
  };
  folder.write("frame,row,col,x_px,y_px\n" + lines_of(3, half(0)));
  CHECK(largest_distance(press().source(folder.path()).initial(), free_pad) == 0);
  // Another order of the columns: the file's header determines it.
  folder.write("frame,row,col,x_px,y_px\n" + lines_of(3, half(1)));
  CHECK(largest_distance(press().source(folder.path()).initial(), half(1)) < 1e-5);
}

TEST_CASE("without a print in sensor.json the size is that of dots.csv") {
  replay::Sensor sensor = press().recording.sensor;
  sensor.dots.reset();
  const Folder folder;
  folder.write("frame,row,col,x_px,y_px\n1,2,4,10.5,-3e1\n5,6,0,1,2\n");
  replay::DotSource source(folder.path(), sensor, press().recording.reference,
                           press().recording.reference_depth, 11);
  CHECK(source.initial().size() == cv::Size(5, 7));
  CHECK(source.initial()(2, 4) == cv::Vec2d(10.5, -30));
  CHECK(fingerpad::count_present(source.initial()) == 1);
  CHECK(source.of(5, press().frames[5])(6, 0) == cv::Vec2d(1, 2));
}

TEST_CASE("dots.csv is refused with the line's number") {
  struct Fault {
    const char* text;
    const char* complaint;
  };
  const std::string header = "frame,row,col,x_px,y_px\n";
  const auto [text, complaint] = GENERATE(
      Fault{"", "dots.csv: is empty"}, Fault{"frame,row,col,x,y\n", "line 1: must be frame,row"},
      Fault{"H", "dots.csv: lists no dots"}, Fault{"H0,1,2,3\n", "line 2: has 4 values, must have"},
      Fault{"H0,1,2,3,4,5\n", "line 2: has 6 values, must have 5"},
      Fault{"H0,1,2,3,4\n\n0,1,2,5,6\n", "line 4: row 1, col 2 of frame 0 is given twice"},
      Fault{"H11,1,2,3,4\n", "line 2: frame '11' is not one of the frames 0 to 10"},
      Fault{"H-1,1,2,3,4\n", "line 2: frame '-1' is not"},
      Fault{"H0,21,2,3,4\n", "line 2: row '21' is not one of the rows of dots 0 to 20"},
      Fault{"H0,1.5,2,3,4\n", "line 2: row '1.5' is not"},
      Fault{"H0,1,21,3,4\n", "line 2: col '21' is not one of the columns of dots 0 to 20"},
      Fault{"H0,1,,3,4\n", "line 2: col '' is not"},
      Fault{"H0,1,2,left,4\n", "line 2: x_px 'left' is not a number"},
      Fault{"H0,1,2,3,nan\n", "line 2: y_px 'nan' is not a number"});
  const Folder folder;
  folder.write(text[0] == 'H' ? header + (text + 1) : text);
  std::string line;
  try {
    press().source(folder.path());
  } catch (const replay::Failure& failure) {
    line = failure.what();
  }
  INFO(line);
  CHECK(line.find(complaint) != std::string::npos);
}
