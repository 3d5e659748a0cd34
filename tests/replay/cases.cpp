// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Faults of recordings that users of tactile sensors report: what replay makes of each, and that
// --check names what replay refuses. Gels are synthetic: an imprint over printed dots is held, or
// slides past them from frame 15 on. Pads and arrays are the bundled ones with one thing changed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/calibrations.hpp"
#include "common/failure.hpp"
#include "replay/check/check.hpp"
#include "replay/replay.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;

namespace {

using Frames = std::vector<cv::Mat>;
using Change = std::function<cv::Mat(const cv::Mat& frame, int k)>;

constexpr int width = 320, height = 240, pitch = 24;
enum class Kind { free, hold, slip };

/// Like a gel lit from three sides: an imprint is light where it faces a lamp.
cv::Mat gel_frame(Kind kind, bool bright_dots, int k) {
  const double depth = kind == Kind::free ? 0 : std::clamp((k - 2) / 6.0, 0.0, 1.0);
  const double drag = std::clamp(k - 9.0, 0.0, 5.0);
  const double slide = kind == Kind::slip ? 2 * std::max(k - 14.0, 0.0) : 0;
  const cv::Point2d middle(0.45 * width + drag, 0.5 * height);
  cv::Mat_<float> paint(height, width, 0.F);
  for (int y = pitch; y < height - pitch / 2; y += pitch) {
    for (int x = pitch - 4; x < width - pitch / 2; x += pitch) {
      const double u = x - middle.x + drag, v = y - middle.y;
      const double share = depth * std::exp(-(u * u + v * v) / (57.6 * 57.6));
      const cv::Point2d dot(x + share * (3 * u / 48 + drag), y + share * 3 * v / 48);
      for (int i = int(dot.y) - 5; i < dot.y + 6; ++i) {
        for (int j = int(dot.x) - 5; j < dot.x + 6; ++j) {
          const double in = std::clamp(4.1 - std::hypot(dot.x - j, dot.y - i), 0.0, 1.0);
          paint(i, j) = std::max(paint(i, j), static_cast<float>(in));
        }
      }
    }
  }
  cv::Mat_<cv::Vec3f> picture(height, width), noise(height, width);
  cv::RNG random(static_cast<std::uint64_t>(1000 * (k + 1) + static_cast<int>(kind)));
  random.fill(noise, cv::RNG::NORMAL, 0, 1);
  for (int i = 0; i < height; ++i) {
    for (int j = 0; j < width; ++j) {
      const double u = (j - middle.x - slide) / 48, v = (i - middle.y) / 48, q = u * u + v * v;
      const double dent = depth * std::exp(-1.5 * q * q), slope = -6 * q * dent / 48;
      const cv::Vec3d gel(90 + 30.0 * j / width, 100 + 20.0 * i / height, 110 - 25.0 * j / width);
      const cv::Vec3d shade(-500 * slope * (u + v), 900 * slope * v, 900 * slope * u);
      picture(i, j) = (1 - paint(i, j)) * cv::Vec3f(gel + shade + cv::Vec3d::all(8 * dent)) +
                      cv::Vec3f::all(paint(i, j) * (bright_dots ? 235 : 25));
    }
  }
  cv::Mat levels;
  cv::Mat(picture + noise).convertTo(levels, CV_8U);
  return levels;
}

/// The frames of a gel, rendered once.
const Frames& gel(Kind kind, bool bright_dots = false) {
  static std::map<std::pair<Kind, bool>, Frames> all;
  Frames& frames = all[{kind, bright_dots}];
  while (frames.size() < (kind == Kind::free ? 4 : 18)) {
    frames.push_back(gel_frame(kind, bright_dots, static_cast<int>(frames.size())));
  }
  return frames;
}

cv::Mat unchanged(const cv::Mat& frame, int /*k*/) {
  return frame;
}

/// Multiplies by the light of a lamp, which `light` gives in px.
Change lit(const std::function<double(int k, double x, double y)>& light) {
  return [light](const cv::Mat& frame, int k) {
    cv::Mat_<cv::Vec3b> other = frame.clone();
    for (int i = 0; i < other.rows; ++i) {
      for (int j = 0; j < other.cols; ++j) {
        for (int c = 0; c < 3; ++c) {
          other(i, j)[c] = cv::saturate_cast<uchar>(light(k, j, i) * other(i, j)[c]);
        }
      }
    }
    return cv::Mat(other);
  };
}

std::string plain_name(int k) {
  return std::to_string(100 + k);
}

/// A recording in a scratch folder, and what is said of it.
class Recording {
 public:
  Recording() { fs::create_directories(folder()); }

  /// Writes frames into a part of the recording, each after `change`.
  void write(const std::string& part,
             const Frames& frames,
             const Change& change = unchanged,
             const std::function<std::string(int)>& name = plain_name,
             const std::string& extension = ".png") {
    fs::create_directories(folder() / part);
    for (int k = 0; k < static_cast<int>(frames.size()); ++k) {
      cv::imwrite((folder() / part / (name(k) + extension)).string(),
                  change(frames[static_cast<std::size_t>(k)], k));
    }
    std::ofstream(folder() / "sensor.json") << "{}";
  }
  /// Copies a bundled recording.
  void copy(const std::string& bundled) {
    fs::copy(test::bundled_recordings / bundled, folder(), fs::copy_options::recursive);
  }

  fs::path folder() const { return root_.path() / "recording"; }

  /// What --check says; "" if nothing is wrong.
  std::string checked() const {
    std::string lines;
    for (const replay::Finding& finding : replay::check_recording(folder())) {
      lines += finding.is_wrong ? finding.place + ": " + finding.what + "\n" : "";
    }
    return lines;
  }
  /// Runs replay; returns its refusal, or "".
  std::string refusal() const {
    if (std::exchange(has_run_, true)) {
      return refusal_;
    }
    replay::Options options;
    options.recording = folder();
    options.out = root_.path() / "out";
    options.pictures = false;
    try {
      replay::run(options);
    } catch (const replay::Failure& failure) {
      refusal_ = failure.what();
    }
    return refusal_;
  }
  std::vector<test::Line> table(const std::string& name) const {
    REQUIRE(refusal().empty());
    return test::table_of(root_.path() / "out" / name);
  }
  /// The first frame with a slip, or -1.
  int slips() const {
    for (const test::Line& line : table("frames.csv")) {
      if (line.at("slip") == "1") {
        return std::stoi(line.at("frame"));
      }
    }
    return -1;
  }

 private:
  test::ScratchFolder root_;
  mutable bool has_run_ = false;
  mutable std::string refusal_;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool is_in_time(int slip) {
  return slip == 15 || slip == 16;
}

}  // namespace

TEST_CASE("cases: a gel that is as it should be, with dark and with white dots") {
  for (const bool bright : {false, true}) {
    Recording held, slipping;
    held.write("free", gel(Kind::free, bright));
    held.write("frames", gel(Kind::hold, bright));
    slipping.write("free", gel(Kind::free, bright));
    slipping.write("frames", gel(Kind::slip, bright));
    CHECK(held.checked() + slipping.checked() == "");
    CHECK(held.slips() == -1);
    CHECK(is_in_time(slipping.slips()));
  }
}

TEST_CASE("cases: names of frames are sorted by their numbers") {
  const std::string name = GENERATE(as<std::string>(), "%.12g", "t%.4gs", "%.2f", "f.%.0f");
  INFO(name);
  const double first = name == "%.12g" ? 1700000000 : 9.5, step = name == "f.%.0f" ? 3 : 0.05;
  Recording recording;
  recording.write("frames", gel(Kind::slip), unchanged, [&](int k) {
    char text[32];
    std::snprintf(text, sizeof text, name.c_str(), first + step * k);
    return std::string(text);
  });
  CHECK(is_in_time(recording.slips()));
}

TEST_CASE("cases: a picture that is missing among numbered ones is told") {
  Recording whole, other;
  for (Recording* recording : {&whole, &other}) {
    recording->write("frames", gel(Kind::hold));
    recording->write("free", gel(Kind::free));
  }
  fs::remove(other.folder() / "frames" / (plain_name(7) + ".png"));
  CHECK(whole.checked() == "");
  CHECK(has(other.checked(), "a number is missing after " + plain_name(6) + ".png"));
}

TEST_CASE("cases: pictures with transparency, of 16 bit, of grey, and a first one that is dark") {
  const int kind = GENERATE(0, 1, 2, 3);
  const Change change = [kind](const cv::Mat& frame, int k) {
    cv::Mat other;
    if (kind == 0) {
      cv::cvtColor(frame, other, cv::COLOR_BGR2BGRA);
    } else if (kind == 3) {
      other = k == 0 ? cv::Mat(frame / 4) : frame;
    } else {
      cv::cvtColor(frame, other, cv::COLOR_BGR2GRAY);
    }
    other.convertTo(other, kind == 2 ? CV_16U : CV_8U, kind == 2 ? 256 : 1);
    return other;
  };
  INFO(kind);
  Recording recording;
  recording.write("frames", gel(Kind::slip), change);
  recording.write("free", gel(Kind::free), kind == 3 ? unchanged : change);
  CHECK(recording.checked() == "");
  CHECK(is_in_time(recording.slips()));
  CHECK_NOTHROW(calibrate::dots(recording.folder(), recording.folder() / "sensor.json"));
}

TEST_CASE("cases: a free frame that is overexposed or dark is named and left out") {
  const double exposure = GENERATE(0.25, 2.5);
  Recording recording;
  recording.write("free", gel(Kind::free), [&](const cv::Mat& frame, int k) {
    return k == 1 ? cv::Mat(frame * exposure) : frame;
  });
  recording.write("frames", gel(Kind::slip));
  CHECK(has(recording.checked(), "frames are darker or lighter than the others"));
  CHECK(is_in_time(recording.slips()));
}

TEST_CASE("cases: a picture that is cut short is named and left out") {
  const std::string extension = GENERATE(as<std::string>(), ".jpg", ".png");
  Recording recording;
  recording.write("free", gel(Kind::free), unchanged, plain_name, extension);
  recording.write("frames", gel(Kind::hold), unchanged, plain_name, extension);
  const fs::path cut[] = {recording.folder() / "free" / (plain_name(1) + extension),
                          recording.folder() / "frames" / (plain_name(12) + extension)};
  for (const fs::path& file : cut) {
    fs::resize_file(file, fs::file_size(file) / 2);
  }
  const std::string checked = recording.checked();
  CHECK(has(checked, cut[0].string()));
  CHECK(has(checked, cut[1].string()));
  CHECK(recording.slips() == -1);
  const auto rows = recording.table("frames.csv");
  REQUIRE(rows.size() == 17);
  CHECK(rows[12].at("frame") == "13");
}

TEST_CASE("cases: a lamp that flickers in bands, or fades on one side") {
  const auto wave = [](double period, double along_x) {
    return [=](int k, double x, double y) {
      const double at = along_x > 0 ? x : y;
      return 1 + 0.1 * std::sin(6.28 * (at / period + 0.37 * k));
    };
  };
  struct Lamp {
    const char* name;
    std::function<double(int, double, double)> light;
  };
  const std::vector<Lamp> lamps = {
      {"bands", wave(90, 0)},
      {"narrow bands", wave(31, 0)},
      {"fades on the left", [](int, double x, double) { return 0.97 + 0.06 * x / width; }},
      {"fades at the bottom, as it warms up",
       [](int k, double, double y) { return 1 - 0.006 * k * y / height; }}};
  Recording plain;
  plain.write("free", gel(Kind::free));
  plain.write("frames", gel(Kind::hold));
  const double area = std::stod(plain.table("frames.csv").back().at("contact_area_px"));
  bool is_held = false;
  for (const auto& [name, light] : lamps) {
    is_held = !is_held;
    INFO(name << (is_held ? ", held" : ", free"));
    Recording recording;
    recording.write("free", gel(Kind::free));
    recording.write("frames", gel(is_held ? Kind::hold : Kind::free), lit(light));
    const double seen = std::stod(recording.table("frames.csv").back().at("contact_area_px"));
    const bool right = std::abs(seen - (is_held ? area : 0)) <= (is_held ? 0.15 * area : 0);
    CHECK((recording.slips() == -1 && right) !=
          has(recording.checked(), "in the same light and with nothing in contact"));
  }
}

TEST_CASE("cases: free frames that show a contact, all or some") {
  const int touched = GENERATE(2, 4);
  INFO(touched);
  Frames free = gel(Kind::free);
  std::copy(gel(Kind::hold).end() - touched, gel(Kind::hold).end(), free.begin());
  Recording recording;
  recording.write("free", free);
  recording.write("frames", gel(Kind::hold));
  CHECK(has(recording.checked(), std::to_string(touched) + " of 4 frames show a contact"));
  CHECK(recording.slips() == -1);
}

TEST_CASE("cases: a recording that begins with a contact, and has no frames of the free pad") {
  Frames frames(gel(Kind::hold).end() - 4, gel(Kind::hold).end());
  frames.insert(frames.end(), gel(Kind::slip).begin(), gel(Kind::slip).end());
  Recording recording;
  recording.write("frames", frames);
  CHECK(is_in_time(recording.slips() - 4));
  const auto rows = recording.table("frames.csv");
  CHECK(std::stod(rows[1].at("contact_area_px")) ==
        Approx(std::stod(rows[17].at("contact_area_px"))).epsilon(0.05));
  CHECK(rows[5].at("contact_area_px") == "0");
}

TEST_CASE("cases: frames that are not like the free pad say so, and are no slip") {
  const Change other_lamp = lit([](int, double x, double) { return 0.4 + 1.2 * x / width; });
  Recording recording;
  recording.write("free", gel(Kind::free));
  recording.write("frames", gel(Kind::slip), [&](const cv::Mat& frame, int k) {
    return k == 4 || k == 11 ? other_lamp(frame, k) : frame;
  });
  CHECK(recording.slips() >= 15);
  CHECK(recording.slips() <= 17);  // across a gap the travel is less certain
  for (const test::Line& line : recording.table("frames.csv")) {
    const bool is_other = line.at("frame") == "4" || line.at("frame") == "11";
    CHECK((line.at("slide_status") == "not of this pad") == is_other);
    CHECK(line.at("contact_area_px").empty() == is_other);
  }
}

TEST_CASE("cases: channels in another order than those of the free pad are told") {
  Recording recording;
  recording.write("free", gel(Kind::free));
  recording.write("frames", gel(Kind::slip), [](const cv::Mat& frame, int) {
    cv::Mat other;
    cv::cvtColor(frame, other, cv::COLOR_BGR2RGB);
    return other;
  });
  CHECK(has(recording.checked(), "channels of its frames are those of frames/ in another order"));
}

namespace {

/// The bundled array after `change` of each reading and time; `change` may turn any cell.
struct Array : Recording {
  using Cells = std::vector<std::string>;
  explicit Array(const std::function<void(int sample, Cells& cells)>& change,
                 const std::string& separator = ",") {
    copy("foam");
    std::ifstream in(test::bundled_recordings / "foam" / "taxels.csv");
    std::ofstream out(folder() / "taxels.csv");
    std::string line;
    for (int k = -1; std::getline(in, line); ++k) {
      Cells cells = test::cells_of(line);
      if (k >= 0) {
        change(k, cells);
      }
      for (std::size_t c = 0; c < cells.size(); ++c) {
        out << (c > 0 ? separator : "") << cells[c];
      }
      out << "\n";
    }
  }
  /// A column of the last sample but `back`.
  double last(const std::string& name, std::size_t back = 0) const {
    const auto rows = table("frames.csv");
    return std::stod(rows.at(rows.size() - 1 - back).at(name));
  }
};

std::string number(double value, const char* format = "%.10g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

const Array& plain_array() {
  static const Array array([](int, Array::Cells&) {});
  return array;
}

}  // namespace

TEST_CASE("cases: an array whose times are since 1970, or in another unit") {
  const Array since_1970([](int, Array::Cells& cells) {
    cells[1] = number(1666135680 + std::stod(cells[1]), "%.4f");
  });
  CHECK(since_1970.checked() == "");
  for (const char* name : {"finger0_center_x_mm", "finger1_center_y_mm"}) {
    CHECK(since_1970.last(name) == plain_array().last(name));
  }
  CHECK(since_1970.table("frames.csv").back().at("finger0_taxel_status") ==
        plain_array().table("frames.csv").back().at("finger0_taxel_status"));
  for (const auto& [factor, unit] : {std::pair(1e3, "unit is ms"), {1e6, "unit is us"}}) {
    const Array other([factor = factor](int, Array::Cells& cells) {
      cells[1] = number(factor * std::stod(cells[1]));
    });
    CHECK(has(other.checked(), unit));
    CHECK(has(other.refusal(), unit));
  }
}

TEST_CASE("cases: a table with other separators is refused with their name") {
  for (const auto& [separator, name] : {std::pair(";", "';'"), {"\t", "tabs"}, {" ", "blanks"}}) {
    const Array other(
        [](int, Array::Cells& cells) { std::replace(cells[1].begin(), cells[1].end(), '.', ','); },
        separator);
    CHECK(has(other.checked(), std::string("separated by ") + name));
    CHECK(has(other.refusal(), std::string("separated by ") + name));
  }
}

TEST_CASE("cases: an array that reads more than nothing when nothing touches it") {
  const auto offset = [](std::size_t c) { return 100 + double((c * 7) % 21); };
  const auto shift = [&](int k, Array::Cells& cells, int free_samples) {
    for (std::size_t c = 2; c < cells.size(); ++c) {
      const double load = k < free_samples ? 0 : std::stod(cells[c]);
      cells[c] = number(load + offset(c) + (k < free_samples ? (k + int(c)) % 3 - 1 : 0));
    }
  };
  const Array held([&](int k, Array::Cells& cells) { shift(k, cells, 0); });
  CHECK(has(held.checked(), "does not change with the load"));
  CHECK(has(held.refusal(), "does not change with the load"));
  for (const int free_samples : {90, 60, 35}) {
    for (const bool below : {false, true}) {
      CAPTURE(free_samples, below);
      const Array free_first([&](int k, Array::Cells& cells) {
        shift(k, cells, free_samples);
        for (std::size_t c = 2; c < cells.size(); ++c) {
          cells[c] = number(std::stod(cells[c]) - (below ? 300 : 0));
        }
      });
      for (const char* name : {"finger0_center_x_mm", "finger1_center_y_mm"}) {
        CHECK(free_first.last(name, 40) == Approx(plain_array().last(name, 40)).margin(0.02));
      }
      CHECK(free_first.last("finger0_sum", 40) ==
            Approx(plain_array().last("finger0_sum", 40)).epsilon(0.01));
    }
  }
  const Array set_under_load([&](int, Array::Cells& cells) {
    for (std::size_t c = 2; c < cells.size(); ++c) {
      cells[c] = number(std::stod(cells[c]) - 220);
    }
  });
  CHECK(has(set_under_load.checked(), "set to zero under a load"));
  CHECK(has(set_under_load.refusal(), "set to zero under a load"));
}

TEST_CASE("cases: an array that holds an object still") {
  Array::Cells held;
  const Array array([&](int k, Array::Cells& cells) {
    held = k == 60 ? cells : held;
    std::copy(k > 60 ? held.begin() + 2 : cells.begin() + 2, k > 60 ? held.end() : cells.end(),
              cells.begin() + 2);
  });
  CHECK(array.checked() == "");
  for (const char* name : {"finger0_center_x_mm", "finger1_center_y_mm", "finger0_sum"}) {
    CHECK(array.last(name) == array.last(name, 239));
  }
}

TEST_CASE("cases: taxels that spike, drift, are stuck, or read full scale are told and left out") {
  const std::string bad =
      GENERATE(as<std::string>(), "spikes", "drift", "full scale", "do not change");
  const Array array([&](int k, Array::Cells& cells) {
    std::string& cell = cells[10];
    cell = bad == "spikes"       ? (k % 50 == 49 ? "4000" : cell)
           : bad == "drift"      ? number(std::stod(cell) + 3 * k)
           : bad == "full scale" ? "4095"
                                 : "801";
  });
  INFO(bad);
  CHECK(has(array.checked(), bad));
  CHECK(array.last("finger0_taxels_left_out", 50) == 1);
}

TEST_CASE("cases: a full scale that nobody has stated is told") {
  for (const double full : {1000.0, 1023.0, 0.25}) {
    const Array array([&](int, Array::Cells& cells) {
      for (std::size_t c = 2; c < cells.size(); ++c) {
        const double reading = std::stod(cells[c]);
        cells[c] = number((std::min)(full, full < 1 ? reading / 4095 : reading));
      }
    });
    test::replace_in(array.folder() / "sensor.json", "\"saturated_at\": 4095,", "");
    CHECK(has(array.checked(), "are at full scale, " + number(full)));
  }
}

TEST_CASE("cases: readings that were lost and written as a number are told and left out") {
  const std::string lost = GENERATE(as<std::string>(), "0", "-1", "-999", "9999", "0, all at once");
  INFO(lost);
  cv::RNG random(7);
  const Array array([&](int k, Array::Cells& cells) {
    for (std::size_t c = 2; c < cells.size(); ++c) {
      const bool is_lost = lost.size() > 4 ? k == 100 : random.uniform(0.0, 1.0) < 0.02;
      cells[c] = is_lost ? lost.substr(0, lost.find(',')) : cells[c];
    }
  });
  test::replace_in(array.folder() / "sensor.json", "\"saturated_at\": 4095,", "");
  CHECK(has(array.checked(), lost == "9999"
                                 ? "are at full scale, 9999"
                                 : "fall to " + lost.substr(0, lost.find(',')) + " for a moment"));
  std::string alarm;
  for (const test::Line& line : array.table("frames.csv")) {
    alarm = alarm.empty() && line.at("preslip") == "1" ? line.at("time_s") : alarm;
  }
  CHECK(std::stod(alarm) == Approx(6.9).margin(0.4));  // the object creeps from 6.5 s on
}

TEST_CASE("cases: an array of which half of the taxels are dead from the start is told") {
  const int kind = GENERATE(0, 1, 2);
  const Array array([kind](int, Array::Cells& cells) {
    for (int taxel = 0; taxel < 64; ++taxel) {
      const int row = taxel / 4, col = taxel % 4;
      if ((kind == 0 ? row : kind == 1 ? col : row + col) % 2 == 1) {
        cells[static_cast<std::size_t>(2 + taxel)] = "0";
      }
    }
  });
  INFO(kind);
  CHECK(has(array.checked(), "do not change while those beside them do"));
  CHECK(array.last("finger0_taxels_left_out", 50) >= 8);
}

TEST_CASE("cases: taxels of a side that never change are noted, untouched or dead") {
  const Array array(
      [](int, Array::Cells& cells) { std::fill(cells.begin() + 2, cells.begin() + 18, "0"); });
  CHECK(array.checked() == "");
  bool noted = false;
  for (const replay::Finding& finding : replay::check_recording(array.folder())) {
    noted = noted || has(finding.what, "16 of 64 taxels never change");
  }
  CHECK(noted);
}

TEST_CASE("cases: an array of which nothing is read before it holds an object warns in time") {
  const Array array([](int k, Array::Cells& cells) {
    for (std::size_t c = 2; k < 64 && c < cells.size(); ++c) {
      cells[c] = "0";
    }
  });
  test::replace_in(array.folder() / "sensor.json", "\"quiet_until_s\": 3,", "");
  double last_alarm_s = 0;
  for (const test::Line& line : array.table("frames.csv")) {
    last_alarm_s = line.at("preslip") == "1" ? std::stod(line.at("time_s")) : last_alarm_s;
  }
  CHECK(last_alarm_s > 6.5);  // when the object begins to creep
}

TEST_CASE("cases: all taxels drift by the same, and that is no fall of their readings") {
  const Array array([](int k, Array::Cells& cells) {
    for (std::size_t c = 2; c < cells.size(); ++c) {
      cells[c] = number(std::stod(cells[c]) + 400.0 * k / 300);
    }
  });
  CHECK_FALSE(has(array.refusal(), "fall where they should rise"));
}

TEST_CASE("cases: an array that reads less where it is pressed more is refused") {
  const Array array([](int, Array::Cells& cells) {
    for (std::size_t c = 2; c < cells.size(); ++c) {
      cells[c] = number(4095 - std::stod(cells[c]));
    }
  });
  CHECK(has(array.refusal(), "the readings fall where they should rise"));
  CHECK(has(array.checked(), array.refusal()));
}

TEST_CASE("cases: an array that shakes while its noise is measured") {
  const Array array([](int k, Array::Cells& cells) {
    for (std::size_t c = 2; c < cells.size(); ++c) {
      cells[c] = number(std::stod(cells[c]) + 40 * std::sin(2.2 * k));
    }
  });
  CHECK(has(array.refusal(), "record while nothing shakes"));
  CHECK(has(array.checked(), array.refusal()));
  test::replace_in(array.folder() / "sensor.json", "\"quiet_until_s\": 3,", "");
  CHECK(has(array.checked(), "shakes in the first samples"));
}

TEST_CASE("cases: tables as spreadsheets and NumPy write them") {
  const Array quoted([](int, Array::Cells& cells) {
    for (std::string& cell : cells) {
      cell = '"' + cell + '"';
    }
  });
  const Array numpy([](int, Array::Cells& cells) {
    for (std::string& cell : cells) {
      cell = number(std::stod(cell), "%.18e");
    }
  });
  test::replace_in(numpy.folder() / "taxels.csv", "frame,", "# by hand\n# frame,");
  for (const Array* array : {&quoted, &numpy}) {
    CHECK(array->checked() == "");
    CHECK(array->last("finger0_sum") == plain_array().last("finger0_sum"));
  }
}

TEST_CASE("cases: a quiet part in which nothing changes is refused, and named by --check") {
  const Array array([](int k, Array::Cells& cells) {
    std::fill(cells.begin() + 2, k < 100 ? cells.end() : cells.begin() + 2, "0");
  });
  CHECK(has(array.refusal(), "foam.quiet_until_s"));
  CHECK(has(array.checked(), array.refusal()));
}

namespace {

/// The first two frames of the bundled press, without its print, which takes most of the time.
struct Press : Recording {
  Press() {
    copy("press");
    for (const char* table : {"signals.csv", "forces.csv"}) {
      std::ifstream in(test::bundled_recordings / "press" / table);
      std::ofstream out(folder() / table);
      std::string line;
      for (int k = 0; k < 3 && std::getline(in, line); ++k) {
        out << line << "\n";
      }
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(folder() / "frames")) {
      if (entry.path().stem() > "000001") {
        fs::remove(entry.path());
      }
    }
    test::replace_in(folder() / "sensor.json",
                     R"("dots": { "rows": 21, "cols": 21, "pitch_mm": 1.5, "diameter_mm": 0.7 },)",
                     "");
  }
};

}  // namespace

TEST_CASE("cases: a gauge that was set to zero with the pad inflated is told") {
  for (const double zero_mpa : {0.016, 0.003}) {
    INFO(zero_mpa);
    const Press press;
    std::ofstream(press.folder() / "signals.csv")
        << "frame,time_s,pressure_mpa\n0,0," << 0.016 - zero_mpa << "\n1,0.1,"
        << 0.016309 - zero_mpa << "\n";
    CHECK(has(press.checked(), "but the free pad needs about 0.0160 MPa"));
  }
}

TEST_CASE("cases: pressures in another unit are told with the unit") {
  struct Unit {
    const char *name, *remedy;
    double per_mpa, zero_mpa;
  };
  for (const auto& [name, remedy, per_mpa, zero_mpa] :
       {Unit{"psi", "psi, divide by 145.04", 145.04, 0},
        Unit{"mmHg", "mmHg, divide by 7500.6", 7500.6, 0},
        Unit{"mbar", "mbar, divide by 10000", 1e4, 0},
        Unit{"absolute kPa", "kPa, divide by 1000 and subtract 0.1013", 1e3, 0.1013},
        Unit{"twice", "", 2, 0}}) {
    INFO(name);
    const Press press;
    std::ofstream(press.folder() / "signals.csv")
        << "frame,time_s,pressure_mpa\n0,0," << per_mpa * (0.016 + zero_mpa) << "\n1,0.1,"
        << per_mpa * (0.016309 + zero_mpa) << "\n";
    std::string told;
    for (const replay::Finding& finding : replay::check_recording(press.folder())) {
      told += finding.is_wrong ? finding.what + ": " + finding.remedy : "";
    }
    CHECK(has(told, *remedy != '\0' ? remedy : "but the free pad needs only 0.0160 MPa"));
  }
}

TEST_CASE("cases: a reference depth that replay refuses, and another light, are told") {
  const Press other_height, other_light;
  const std::string file = (other_height.folder() / "reference_depth.tiff").string();
  cv::imwrite(file, cv::Mat(1.1 * cv::imread(file, cv::IMREAD_UNCHANGED)));
  CHECK(has(other_height.refusal(), "must be within 5 %"));
  CHECK(has(other_height.checked(), other_height.refusal()));
  for (const fs::directory_entry& entry :
       fs::directory_iterator(other_light.folder() / "frames")) {  // darker toward the rim by 3 %
    const cv::Mat picture = cv::imread(entry.path().string());
    const double half = picture.rows / 2.0;
    cv::imwrite(entry.path().string(), lit([&](int, double x, double y) {
                  const double u = x / half - 1, v = y / half - 1;
                  return 1 - 0.03 * (u * u + v * v);
                })(picture, 0));
  }
  CHECK(has(other_light.checked(), "its light is not that of the reference"));
  for (const test::Line& line : other_light.table("frames.csv")) {
    CHECK(line.at("contact_status") != "ok");
    CHECK(line.at("look_up_status") != "ok");
  }
}

TEST_CASE("cases: saturated frames give no confident depth") {
  const Press press;
  for (const fs::directory_entry& entry : fs::directory_iterator(press.folder() / "frames")) {
    cv::Mat picture = cv::imread(entry.path().string());
    const cv::Size size = picture.size() / 8;
    picture({picture.cols / 2, picture.rows / 2, size.width, size.height}) = cv::Scalar(0, 0, 255);
    cv::imwrite(entry.path().string(), picture);
  }
  (void)press.checked();
  for (const test::Line& line : press.table("frames.csv")) {
    CHECK(line.at("depth_status") == "saturated");
    CHECK(line.at("contact_status") != "ok");
  }
}

TEST_CASE(
    "cases: frames that were compressed unlike the reference, or much, give no confident contact") {
  const auto compressed = [](const cv::Mat& picture, int quality) {
    std::vector<uchar> bytes;
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return cv::imdecode(bytes, cv::IMREAD_COLOR);
  };
  struct Case {
    int quality;
    bool reference_too, frames_too, is_ok;
  };
  for (const auto& [quality, reference_too, frames_too, is_ok] :
       {Case{100, false, true, false}, Case{60, false, true, false}, Case{100, true, true, true},
        Case{98, true, true, false}, Case{98, true, false, false}}) {
    CAPTURE(quality, reference_too, frames_too);
    const Press press;
    for (const fs::directory_entry& entry : fs::directory_iterator(press.folder() / "frames")) {
      if (!frames_too) {
        break;
      }
      cv::imwrite(entry.path().string(), compressed(cv::imread(entry.path().string()), quality));
    }
    if (reference_too) {  // it is of 16 bit
      const std::string file = (press.folder() / "reference.png").string();
      cv::Mat reference = cv::imread(file, cv::IMREAD_UNCHANGED), grey, error;
      reference.convertTo(grey, CV_8U, 1.0 / 256);
      cv::subtract(compressed(grey, quality), grey, error, cv::noArray(), CV_32F);
      cv::scaleAdd(error, 256, cv::Mat_<cv::Vec3f>(reference), reference);
      reference.convertTo(reference, CV_16U);
      cv::imwrite(file, reference);
    }
    CHECK(has(press.checked(), "compressed") == frames_too);
    for (const test::Line& line : press.table("frames.csv")) {
      CHECK((line.at("depth_status") == "ok") == is_ok);
      CHECK(line.at("pad_changed") == "0");
      CHECK((line.at("contact_status") != "ok" || is_ok));
      CHECK((line.at("look_up_status") != "ok" || is_ok));
    }
  }
}
