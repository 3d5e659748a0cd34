// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "replay/chain.hpp"
#include "replay/failure.hpp"
#include "replay/replay.hpp"
#include "replay/side_dots.hpp"
#include "replay/signals.hpp"
#include "support/catch.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path bundled =
    fs::path(__FILE__).parent_path().parent_path().parent_path() / "examples" / "data" / "press";

const std::vector<std::string> components = {"fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"};

using Line = std::map<std::string, std::string>;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<Line> table(const fs::path& file) {
  std::ifstream stream(file);
  std::string text;
  REQUIRE(std::getline(stream, text));
  const auto header = cells_of(text);
  std::vector<Line> lines;
  while (std::getline(stream, text)) {
    const auto cells = cells_of(text);
    REQUIRE(cells.size() == header.size());
    Line line;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      line[header[k]] = cells[k];
    }
    lines.push_back(line);
  }
  return lines;
}

/// A copy of the bundled recording that tests may break.
class Workplace {
 public:
  Workplace() {
    std::string pattern = (fs::temp_directory_path() / "fingerpad.XXXXXX").string();
    root_ = ::mkdtemp(pattern.data());
    fs::copy(bundled, recording(), fs::copy_options::recursive);
  }
  ~Workplace() { fs::remove_all(root_); }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  fs::path recording() const { return root_ / "recording"; }
  fs::path out() const { return root_ / "out"; }

  std::vector<Line> run(replay::Range range, bool pictures = false) const {
    replay::Options options;
    options.recording = recording();
    options.out = out();
    options.range = range;
    options.pictures = pictures;
    replay::run(options);
    return table(out() / "frames.csv");
  }

  std::string complaint() const {
    try {
      run({0, 1});
    } catch (const replay::Failure& failure) {
      return failure.what();
    }
    return "";
  }

  std::string read(const std::string& file) const {
    std::ifstream in(recording() / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(recording() / file) << text;
  }
  void replace(const std::string& file, const std::string& old, const std::string& with) const {
    std::string text = read(file);
    REQUIRE(text.find(old) != std::string::npos);
    text.replace(text.find(old), old.size(), with);
    write(file, text);
  }
  /// Keeps the lines of side_dots.csv that `good(frame, index)` says.
  template <class Good>
  void keep_side_dots(const Good& good) const {
    std::istringstream in(read("side_dots.csv"));
    std::string kept, line;
    std::getline(in, line);
    kept = line + "\n";
    while (std::getline(in, line)) {
      const auto cells = cells_of(line);
      kept += good(std::stoi(cells[0]), std::stoi(cells[1])) ? line + "\n" : "";
    }
    write("side_dots.csv", kept);
  }

 private:
  fs::path root_;
};

bool is_empty(const Line& line) {
  return std::all_of(components.begin(), components.end(),
                     [&](const std::string& name) { return line.at("wrench_" + name).empty(); });
}

bool is_full(const Line& line) {
  return std::none_of(components.begin(), components.end(),
                      [&](const std::string& name) { return line.at("wrench_" + name).empty(); });
}

double number(const Line& line, const std::string& name) {
  REQUIRE_FALSE(line.at(name).empty());
  return std::stod(line.at(name));
}

}  // namespace

TEST_CASE("replay: force and moment of the bundled recording", "[wrench]") {
  // against what the finite elements say; from 8-bit frames with noise and side dots good to 5 um
  const Workplace work;
  const auto found = work.run({});
  const auto truth = table(bundled / "membrane" / "load.csv");
  REQUIRE(found.size() == 11);
  REQUIRE(truth.size() == 11);
  double error[6] = {};
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (std::size_t c = 0; c < 6; ++c) {
      error[c] +=
          std::abs(number(found[k], "wrench_" + components[c]) - number(truth[k], components[c])) /
          static_cast<double>(truth.size());
    }
  }
  INFO("mean errors " << error[0] << ' ' << error[1] << ' ' << error[2] << " N, " << error[3] << ' '
                      << error[4] << ' ' << error[5] << " N m");
  const double largest_n = 1.8, largest_press_n = 3.1, largest_n_m = 0.0232;
  CHECK(error[0] < 0.05 * largest_n);
  CHECK(error[1] < 0.05 * largest_n);
  CHECK(error[2] < 0.05 * largest_press_n);
  CHECK(error[3] < 0.15 * largest_n_m);
  CHECK(error[4] < 0.15 * largest_n_m);
  CHECK(error[5] < 0.06 * largest_n_m);
  // a free pad carries nothing
  for (const std::string& name : components) {
    CHECK(number(found[0], "wrench_" + name) == 0);
  }
}

TEST_CASE("replay: the rim is pulled inward and up, and as hard as the force says", "[wrench]") {
  replay::Options options;
  options.recording = bundled;
  replay::Recording recording = replay::open_recording(bundled);
  replay::Chain chain(recording, options);
  recording.frames.seek(5);
  const replay::WrenchFrame frame = chain(5, recording.frames.next()).wrench;
  REQUIRE(frame.present);
  CHECK_FALSE(frame.given_modulus);
  REQUIRE(frame.tension.size() == 72);
  const double radius_mm = 18.735, rim_mm = 2 * CV_PI * radius_mm;
  fingerpad::Point3<double> sum{0, 0, 0};
  for (const replay::RimTension& rim : frame.tension) {
    const auto& t = rim.n_per_mm;
    CHECK(t.z > 0);
    const double inward = -(t.x * rim.border_mm.x + t.y * rim.border_mm.y) / radius_mm;
    const double along = (t.y * rim.border_mm.x - t.x * rim.border_mm.y) / radius_mm;
    CHECK(inward > 2 * std::abs(along));
    sum = {sum.x + t.x * rim_mm / 72, sum.y + t.y * rim_mm / 72, sum.z + t.z * rim_mm / 72};
  }
  const double bearing_n = 0.020365 * CV_PI * radius_mm * radius_mm;
  const auto& force = frame.result.force_n;
  CHECK(sum.x == Approx(force.x).margin(0.02));
  CHECK(sum.y == Approx(force.y).margin(0.02));
  CHECK(sum.z - bearing_n == Approx(force.z).margin(0.05));
}

TEST_CASE("replay: what the force needs may be missing", "[wrench]") {
  const Workplace work;
  SECTION("no side dots") {
    fs::remove(work.recording() / "side_dots.csv");
    CHECK(is_empty(work.run({5, 6}, true)[0]));
    CHECK_FALSE(fs::exists(work.out() / "pictures" / "rim_000005.png"));
    CHECK_FALSE(fs::exists(work.out() / "pictures" / "wrench.png"));
    CHECK(fs::exists(work.out() / "pictures" / "traction_000005.png"));
  }
  SECTION("no rim in sensor.json") {
    const std::string text = work.read("sensor.json");
    const auto at = text.find(",\n  \"rim\"");
    REQUIRE(at != std::string::npos);
    work.write("sensor.json", text.substr(0, at) + "\n}\n");
    CHECK(is_empty(work.run({5, 6})[0]));
  }
  SECTION("no pressure at all") {
    work.write("signals.csv", "frame,time_s\n5,0.5\n");
    const auto line = work.run({5, 6})[0];
    CHECK(is_empty(line));
    CHECK(line.at("time_s") == "0.5");
  }
  SECTION("no pressure in one frame, no signals in another") {
    work.write("signals.csv", "frame,time_s,pressure_mpa\n5,0.5,0.020365\n6,0.6,\n");
    const auto lines = work.run({5, 8});
    CHECK(is_full(lines[0]));
    CHECK(is_empty(lines[1]));
    CHECK(is_empty(lines[2]));
  }
  SECTION("side dots that were not found, in one frame a few, then half, then all") {
    const double all_n = number(work.run({5, 6})[0], "wrench_fz_n");
    work.keep_side_dots([](int frame, int index) {
      return frame < 5 || (frame == 5 && index % 5 != 0) || (frame == 6 && index % 2 != 0);
    });
    const auto lines = work.run({5, 8});
    CHECK(number(lines[0], "wrench_fz_n") == Approx(all_n).epsilon(0.03));
    CHECK(is_empty(lines[1]));
    CHECK(is_empty(lines[2]));
  }
}

TEST_CASE("replay: how side dots are carried to the rim is said in sensor.json", "[wrench]") {
  const Workplace work;
  const double carried_n_m = number(work.run({8, 9})[0], "wrench_my_nm");
  work.replace("sensor.json", ", \"stress_free_inclination_rad\": 1.0618", "");
  const double chord_n_m = number(work.run({8, 9})[0], "wrench_my_nm");
  CHECK(chord_n_m != carried_n_m);
  CHECK(chord_n_m == Approx(carried_n_m).epsilon(0.3));
  // a modulus that is given stands by for frames whose shape does not tell
  work.replace("sensor.json", "0.79995", "0.79995, \"membrane_modulus_n_per_mm\": 0.7");
  CHECK(number(work.run({8, 9})[0], "wrench_my_nm") == chord_n_m);
}

TEST_CASE("replay: pictures of forces, and its own files are known again", "[wrench]") {
  const Workplace work;
  for (int again = 0; again < 2; ++again) {
    work.run({6, 8}, true);
    for (const char* name : {"wrench.png", "rim_000006.png", "rim_000007.png",
                             "traction_000006.png", "traction_000007.png"}) {
      const cv::Mat picture = cv::imread((work.out() / "pictures" / name).string());
      INFO(name);
      CHECK(picture.cols > 400);
      CHECK(picture.rows > 400);
    }
  }
  fs::remove(work.recording() / "stress_free_dots.csv");
  work.run({6, 7}, true);
  CHECK_FALSE(fs::exists(work.out() / "pictures" / "traction_000006.png"));
}

TEST_CASE("replay: rims that cannot be are refused with what is wrong", "[wrench]") {
  const Workplace work;
  const auto says = [&](const std::string& words) {
    const std::string line = work.complaint();
    INFO(line);
    CHECK(line.find(words) != std::string::npos);
    CHECK(line.find('\n') == std::string::npos);
    CHECK_FALSE(fs::exists(work.out()));
  };
  const std::string header = "frame,index,border_x,border_y,border_z,dot_x,dot_y,dot_z\n";
  SECTION("a border off the rim") {
    work.replace("sensor.json", "\"base_radius_mm\": 18.735", "\"base_radius_mm\": 25");
    says("border point");
  }
  SECTION("too few") {
    work.keep_side_dots([](int, int index) { return index < 5; });
    says("border columns = 5");
  }
  SECTION("an inclination that is none") {
    work.replace("sensor.json", "1.0618", "2.5");
    says("stress_free_inclination_rad = 2.5");
  }
  SECTION("a key that is none") {
    work.replace("sensor.json", "stress_free_inclination_rad", "inclination");
    says("unknown key rim.inclination (known here: side_dot_length_mm, ");
  }
  SECTION("another header") {
    work.write("side_dots.csv", "frame,index\n0,0\n");
    says("side_dots.csv: line 1: must be frame,index,border_x,");
  }
  SECTION("an empty file") {
    work.write("side_dots.csv", "");
    says("side_dots.csv: is empty");
    work.write("side_dots.csv", header);
    says("side_dots.csv: names no side dots");
  }
  SECTION("lines that cannot be") {
    const std::string good = "0,0,18.735,0,0,18.4,0,0.8\n";
    work.write("side_dots.csv", header + good + "0,1,18.735,0,0,18.4,0\n");
    says("line 3: has 7 values, must have 8");
    work.write("side_dots.csv", header + good + "0,1,18.735,0,0,18.4,nan,0.8\n");
    says("line 3: dot_y 'nan' is not a number");
    work.write("side_dots.csv", header + good + "\n11,0,18.735,0,0,18.4,0,0.8\n");
    says("line 4: frame '11' is not one of the frames 0 to 10");
    work.write("side_dots.csv", header + good + "0,-1,18.735,0,0,18.4,0,0.8\n");
    says("line 3: index '-1' is not one of the side dots");
    work.write("side_dots.csv", header + good + "0,1.5,18.735,0,0,18.4,0,0.8\n");
    says("line 3: index '1.5' is not");
    work.write("side_dots.csv", header + good + good);
    says("line 3: side dot 0 of frame 0 is given twice");
    work.write("side_dots.csv", header + good + "0,2,18.735,0,0,18.4,0,0.8\n");
    says("side dot 1 is in no frame");
  }
  SECTION("stress-free dots") {
    work.write("stress_free_dots.csv", "row,col,x_mm,y_mm,z_mm\n21,0,1,2,3\n");
    says("stress_free_dots.csv: line 2: row '21' is not one of the rows of dots 0 to 20");
    work.write("stress_free_dots.csv", "row,col,x_mm,y_mm,z_mm\n1,0,1,2,3\n1,0,1,2,3\n");
    says("line 3: row 1, col 0 is given twice");
    work.write("stress_free_dots.csv", "row,col,x,y,z\n1,0,1,2,3\n");
    says("line 1: must be row,col,x_mm,y_mm,z_mm");
  }
}

TEST_CASE("replay: signals keep times as they are written and pressures as numbers") {
  const Workplace work;
  work.write("signals.csv", "frame,time_s,pressure_mpa\n2,0.20,0.016\n4,1e0,\n");
  const replay::Signals signals = replay::read_signals(work.recording() / "signals.csv", 11);
  CHECK(signals.time_s(2) == "0.20");
  CHECK(signals.time_s(4) == "1e0");
  CHECK(signals.time_s(3).empty());
  CHECK(signals.pressure_mpa(2) == 0.016);
  CHECK(std::isnan(signals.pressure_mpa(4)));
  CHECK(std::isnan(signals.pressure_mpa(3)));
}

TEST_CASE("replay: the border is the mean over the frames") {
  const Workplace work;
  work.write("side_dots.csv",
             "frame,index,border_x,border_y,border_z,dot_x,dot_y,dot_z\n"
             "0,1,1,2,3,4,5,6\n0,0,0,0,0,0,0,0\n3,1,3,2,1,7,8,9\n");
  const auto all = replay::read_side_dots(work.recording() / "side_dots.csv", 4);
  REQUIRE(all);
  CHECK(all->border_mm.size() == cv::Size(2, 1));
  CHECK(all->border_mm(0, 1) == cv::Vec3d(2, 2, 2));
  CHECK(all->dots_mm.at(3)(0, 1) == cv::Vec3d(7, 8, 9));
  CHECK(std::isnan(all->dots_mm.at(3)(0, 0)[1]));
  CHECK(all->dots_mm.count(1) == 0);
  CHECK_FALSE(replay::read_side_dots(work.recording() / "none.csv", 4));
}
