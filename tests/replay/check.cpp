// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Typical mistakes in recordings, and the findings of replay --check for each.
#include "replay/check/check.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/optics/camera.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path& data = test::bundled_recordings;

using Row = std::vector<std::string>;

/// A copy of the first frames of the bundled recording, or of the foam recording, to be modified.
class Copy {
 public:
  static constexpr int frames = 3;

  explicit Copy(const std::string& bundled) {
    for (const fs::directory_entry& entry : fs::directory_iterator(data / bundled)) {
      if (entry.is_regular_file()) {
        fs::copy_file(entry.path(), folder() / entry.path().filename());
      }
    }
    if (bundled == "press") {
      fs::create_directory(folder() / "frames");
      for (int k = 0; k < frames; ++k) {
        fs::copy_file(data / bundled / frame(k), folder() / frame(k));
      }
      for (const char* file : {"signals.csv", "forces.csv"}) {
        edit_table(file, [](Row& row) { return std::stoi(row[0]) < frames; });
      }
    }
  }

  const fs::path& folder() const { return folder_.path(); }
  static std::string frame(int k) { return "frames/00000" + std::to_string(k) + ".png"; }

  /// The findings, one per line.
  std::string said() const {
    std::string lines;
    for (const replay::Finding& finding : replay::check_recording(folder())) {
      CHECK_FALSE(finding.remedy.empty());
      CHECK(finding.remedy.back() == '.');
      CHECK((finding.place + finding.what + finding.remedy).find('\n') == std::string::npos);
      if (finding.is_wrong) {
        lines += finding.place + ": " + finding.what + ". " + finding.remedy + "\n";
      }
    }
    return lines;
  }

  void replace(const std::string& file, const std::string& old, const std::string& with) const {
    test::replace_in(folder() / file, old, with);
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder() / file) << text;
  }
  /// Edits each row of a table; rows for which `change` is false are dropped.
  void edit_table(const std::string& file, const std::function<bool(Row&)>& change) const {
    std::ifstream in(folder() / file);
    std::string line;
    std::getline(in, line);
    std::string text = line + "\n";
    while (std::getline(in, line)) {
      Row row;
      std::stringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) {
        row.push_back(cell);
      }
      if (change(row)) {
        for (std::size_t k = 0; k < row.size(); ++k) {
          text += (k == 0 ? "" : ",") + row[k];
        }
        text += "\n";
      }
    }
    in.close();
    write(file, text);
  }
  /// Sets column `k` to `factor` times it plus `offset`.
  void scale(const std::string& file, std::size_t k, double factor, double offset = 0) const {
    edit_table(file, [&](Row& row) {
      std::ostringstream number;
      number.precision(12);
      number << factor * std::stod(row[k]) + offset;
      row[k] = number.str();
      return true;
    });
  }
  void edit_picture(const std::string& file, const std::function<void(cv::Mat&)>& change) const {
    cv::Mat picture = cv::imread((folder() / file).string(), cv::IMREAD_UNCHANGED);
    change(picture);
    cv::imwrite((folder() / file).string(), picture);
  }
  void edit_frames(const std::function<void(cv::Mat&)>& change) const {
    for (int k = 0; k < frames; ++k) {
      edit_picture(frame(k), change);
    }
  }

 private:
  test::ScratchFolder folder_;
};

/// dots.csv of a grid of 6 x 7 dots; `place` gives the position of row i, column j in a frame.
std::string dots_csv(const std::function<cv::Vec2d(int frame, int i, int j)>& place) {
  std::string text = "frame,row,col,x_px,y_px\n";
  for (int frame = 0; frame < Copy::frames; ++frame) {
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 7; ++j) {
        const cv::Vec2d at = place(frame, i, j);
        text += std::to_string(frame) + "," + std::to_string(i) + "," + std::to_string(j) + "," +
                std::to_string(at[0]) + "," + std::to_string(at[1]) + "\n";
      }
    }
  }
  return text;
}

cv::Vec2d good_place(int frame, int i, int j) {
  return {150.0 + 25 * j + frame, 160.0 + 25 * i};
}

/// Adds frames in which dots are dragged in three directions, and forces of a rotated gauge.
void drag(const Copy& copy, double turned_rad, int directions = 5) {
  std::string dots = "frame,row,col,x_px,y_px\n",
              forces = "frame,force_x_n,force_y_n,force_z_n,moment_z_nm\n";
  constexpr int all = 12;
  for (int k = 0; k < all; ++k) {
    const double way = k == 0 ? 0 : 4 + k % 3, at = 2 * CV_PI * k / directions;
    if (k >= Copy::frames) {
      fs::copy_file(copy.folder() / Copy::frame(k % 2),
                    copy.folder() / ("frames/" + std::to_string(100000 + k) + ".png"));
    }
    for (int n = 0; n < 42; ++n) {
      const cv::Vec2d home = good_place(0, n / 7, n % 7);
      const double share = n % 7 == 0 ? 0 : 1;  // some are not touched
      dots += std::to_string(k) + "," + std::to_string(n / 7) + "," + std::to_string(n % 7) + "," +
              std::to_string(home[0] + share * way * std::cos(at) + 0.06 * std::sin(7.0 * n + k)) +
              "," +
              std::to_string(home[1] + share * way * std::sin(at) + 0.06 * std::cos(5.0 * n + k)) +
              "\n";
    }
    const double f = 0.2 * way;
    forces += std::to_string(k) + "," +
              std::to_string(f * std::cos(at + turned_rad) + 0.02 * std::sin(3.0 * k)) + "," +
              std::to_string(f * std::sin(at + turned_rad) + 0.02 * std::cos(4.0 * k)) + ",-3,0\n";
  }
  copy.write("dots.csv", dots);
  copy.write("forces.csv", forces);
}

void no_print(const Copy& copy) {
  copy.replace("sensor.json",
               R"("dots": { "rows": 21, "cols": 21, "pitch_mm": 1.5, "diameter_mm": 0.7 },)", "");
  fs::remove(copy.folder() / "stress_free_dots.csv");
}

struct Mistake {
  const char* name;
  std::function<void(const Copy&)> make;
  const char* said;
};

/// A dots.csv with a mistake.
Mistake dots_mistake(const char* name, const char* said, cv::Vec2d (*place)(int, int, int)) {
  return {name, [place](const Copy& copy) { copy.write("dots.csv", dots_csv(place)); }, said};
}

/// Converts heights along rays to heights above the point of the plate that each pixel shows.
void in_plan(cv::Mat& depth) {
  const fingerpad::Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};
  const cv::Mat_<float> along = depth.clone();
  const cv::Rect image(0, 0, along.cols, along.rows);
  for (int i = 0; i < along.rows; ++i) {
    for (int j = 0; j < along.cols; ++j) {
      float z = 0;
      for (int step = 0; step < 20 && std::isfinite(z); ++step) {
        const auto p =
            fingerpad::pixel_of(camera, fingerpad::Point3<double>{(j - 239.5) * camera.pitch_mm,
                                                                  (i - 239.5) * camera.pitch_mm,
                                                                  static_cast<double>(z)});
        const cv::Point seen(static_cast<int>(std::lround(p.x)),
                             static_cast<int>(std::lround(p.y)));
        z = image.contains(seen) ? along(seen) : std::numeric_limits<float>::quiet_NaN();
      }
      depth.at<float>(i, j) = z;
    }
  }
}

// Without a print, because finding its dots takes most of the time.
const std::vector<Mistake> mistakes = {
    {"pressure in kPa", [](const Copy& c) { c.scale("signals.csv", 2, 1e3); },
     "If the unit is kPa, divide by 1000"},
    {"pressure in Pa", [](const Copy& c) { c.scale("signals.csv", 2, 1e6); },
     "If the unit is Pa, divide by 1000000"},
    {"absolute pressure", [](const Copy& c) { c.scale("signals.csv", 2, 1, 0.1013); },
     "If the pressure is absolute"},
    {"pressure of a gauge that is turned", [](const Copy& c) { c.scale("signals.csv", 2, -1); },
     "Tare the gauge with the pad open"},
    {"no pressure", [](const Copy& c) { c.scale("signals.csv", 2, 0); },
     "Check that the gauge is connected"},
    {"time in ms",
     [](const Copy& c) {
       c.edit_table("signals.csv", [](Row& r) {
         r[1] = std::to_string(33 * std::stoi(r[0]));
         return true;
       });
     },
     "If the unit is ms, divide by 1000"},
    {"time in min",
     [](const Copy& c) {
       c.edit_table("signals.csv", [](Row& r) {
         r[1] = std::to_string(std::stoi(r[0]) / (60 * 30.0));
         return true;
       });
     },
     "if it is min, multiply by 60"},
    {"time that goes back",
     [](const Copy& c) {
       c.edit_table("signals.csv", [](Row& r) {
         r[1] = r[0] == "2" ? "0.001" : r[1];
         return true;
       });
     },
     "the time decreases or repeats 1 times"},
    {"time missing",
     [](const Copy& c) { c.edit_table("signals.csv", [](Row& r) { return r[0] != "1"; }); },
     "time_s: missing for 1 of 3 frames"},
    {"reference depth in m",
     [](const Copy& c) { c.edit_picture("reference_depth.tiff", [](cv::Mat& d) { d /= 1000; }); },
     "If the unit is m, multiply by 1000"},
    {"reference depth 0 outside the pad",
     [](const Copy& c) {
       c.edit_picture("reference_depth.tiff", [](cv::Mat& d) { cv::patchNaNs(d, 0); });
     },
     "Write NaN outside the pad"},
    {"reference depth as indentation",
     [](const Copy& c) {
       c.edit_picture("reference_depth.tiff", [](cv::Mat& d) { d = 13.1 - d; });
     },
     "not an indentation"},
    {"reference depth in plan",
     [](const Copy& c) { c.edit_picture("reference_depth.tiff", in_plan); }, "not in plan"},
    {"wrong center",
     [](const Copy& c) { c.replace("sensor.json", "[239.5, 239.5]", "[239.5, 320]"); },
     "camera.center_px: the pad is 6.4"},
    {"pitch of the camera in another unit",
     [](const Copy& c) { c.replace("sensor.json", "\"pitch_mm\": 0.08", "\"pitch_mm\": 0.04"); },
     "sensor.json, camera.pitch_mm"},
    {"max_depth_mm smaller than the pad",
     [](const Copy& c) {
       c.replace("sensor.json", "\"max_depth_mm\": 18.0", "\"max_depth_mm\": 9");
     },
     "larger than the height of the pad"},
    {"red and green exchanged",
     [](const Copy& c) {
       const auto exchange = [](cv::Mat& p) {
         cv::Mat other = p.clone();
         cv::mixChannels(std::vector<cv::Mat>{other}, std::vector<cv::Mat>{p}, {1, 2, 2, 1});
       };
       c.edit_picture("reference.png", exchange);
       c.edit_frames(exchange);
     },
     "Check whether red and green are exchanged"},
    {"a pressed frame for the reference",
     [](const Copy& c) {
       const cv::Mat pressed = cv::imread((data / "press/frames/000006.png").string());
       c.edit_picture("reference.png", [&](cv::Mat& p) { pressed.convertTo(p, p.depth(), 257); });
       fs::create_directory(c.folder() / "free");
       fs::copy_file(data / "press/frames/000000.png", c.folder() / "free/000000.png");
     },
     "or replace the reference if it shows a contact"},
    {"a pressed frame for the reference, without free frames",
     [](const Copy& c) {
       const cv::Mat pressed = cv::imread((data / "press/frames/000006.png").string());
       c.edit_picture("reference.png", [&](cv::Mat& p) { pressed.convertTo(p, p.depth(), 257); });
     },
     "no frame looks like it"},
    {"a frame of another size",
     [](const Copy& c) {
       c.edit_picture(Copy::frame(1), [](cv::Mat& f) { f = f.colRange(0, f.cols - 1).clone(); });
     },
     "000001.png"},
    {"rows read without their padding",
     [](const Copy& c) {
       c.edit_frames([](cv::Mat& f) {
         const cv::Mat good = f.clone();
         for (int k = 0; k < static_cast<int>(good.total()); ++k) {
           const int from = (std::max)(0, k - 5 * (k / f.cols));
           f.at<cv::Vec3b>(k / f.cols, k % f.cols) =
               good.at<cv::Vec3b>(from / f.cols, from % f.cols);
         }
       });
     },
     "Check that row padding is handled"},
    {"absorption in another unit",
     [](const Copy& c) {
       c.replace("sensor.json", "\"c_red_per_mm\": 0.0290", "\"c_red_per_mm\": 0.290");
       c.replace("sensor.json", "\"c_green_per_mm\": 0.0336", "\"c_green_per_mm\": 0.336");
     },
     "Give the coefficients in 1/mm"},
    {"a grey reference",
     [](const Copy& c) {
       c.edit_picture("reference.png", [](cv::Mat& p) { p.setTo(cv::Scalar::all(20000)); });
     },
     "its colours do not depend on the depth"},
    {"saturated frames",
     [](const Copy& c) {
       c.edit_frames(
           [](cv::Mat& f) { f(cv::Rect(150, 150, 100, 100)).setTo(cv::Scalar::all(255)); });
     },
     "of the pad is saturated"},
    {"compressed frames",
     [](const Copy& c) {
       c.edit_frames([](cv::Mat& f) {
         std::vector<uchar> bytes;
         cv::imencode(".jpg", f, bytes, {cv::IMWRITE_JPEG_QUALITY, 95});
         f = cv::imdecode(bytes, cv::IMREAD_COLOR);
       });
     },
     "the pictures were compressed"},
    {"frames too dark", [](const Copy& c) { c.edit_frames([](cv::Mat& f) { f /= 16; }); },
     "the pad is too dark"},
    {"a lamp that has changed", [](const Copy& c) { c.edit_frames([](cv::Mat& f) { f *= 0.9; }); },
     "darker than in the reference"},
    {"a lamp that fades",
     [](const Copy& c) { c.edit_picture(Copy::frame(2), [](cv::Mat& f) { f *= 0.9; }); },
     "darker than in the first frame"},
    {"noise",
     [](const Copy& c) {
       cv::theRNG().state = 7;
       c.edit_frames([](cv::Mat& f) {
         cv::Mat n(f.size(), CV_16SC3);
         cv::randn(n, 0, 25);
         cv::Mat w;
         f.convertTo(w, CV_16S);
         w += n;
         w.convertTo(f, CV_8U);
       });
     },
     "Lower the gain"},
    {"a camera that stands still",
     [](const Copy& c) {
       fs::copy_file(c.folder() / Copy::frame(1), c.folder() / Copy::frame(2),
                     fs::copy_options::overwrite_existing);
     },
     "1 of 3 frames repeat the previous frame"},
    {"free frames that are not free",
     [](const Copy& c) {
       fs::create_directory(c.folder() / "free");
       fs::copy_file(data / "press/frames/000006.png", c.folder() / "free/000000.png");
     },
     "free: "},
    dots_mistake("dots in mm",
                 "Give pixels, not mm",
                 [](int, int i, int j) { return cv::Vec2d(1.5 * j - 5, 1.5 * i - 5); }),
    dots_mistake("dots in m",
                 "Give pixels, not fractions of the frame and not m",
                 [](int, int i, int j) { return cv::Vec2d(1.5e-3 * j, 1.5e-3 * i); }),
    dots_mistake("dots in shares of the frame",
                 "Give pixels, not fractions of the frame",
                 [](int f, int i, int j) { return cv::Vec2d(good_place(f, i, j) / 480.0); }),
    dots_mistake(
        "lost dots as (0, 0)",
        "Leave out the lines of lost dots",
        [](int f, int i, int j) { return i == 2 ? cv::Vec2d(0, 0) : good_place(f, i, j); }),
    dots_mistake("dots column by column",
                 "Check whether row and col, or x_px and y_px, are exchanged",
                 [](int f, int i, int j) {
                   return cv::Vec2d(good_place(f, i, j)[1], good_place(f, i, j)[0]);
                 }),
    dots_mistake("dots mirrored",
                 "the dot pattern is mirrored",
                 [](int f, int i, int j) { return good_place(f, i, 6 - j); }),
    dots_mistake(
        "dots shuffled",
        "the dots of a row are not in the order of their col",
        [](int f, int i, int j) { return good_place(f, (i + 3 * j) % 6, (5 * j + i) % 7); }),
    dots_mistake(
        "dots named anew in each frame",
        "displacements between two frames exceed",
        [](int f, int i, int j) { return good_place(f, i, (j + 2 * f) % 7) + cv::Vec2d(0, 0); }),
    {"area in m^2",
     [](const Copy& c) {
       c.replace("sensor.json", "\"from_mm2\": 3.52, \"to_mm2\": 339.1",
                 "\"from_mm2\": 3.52e-6, \"to_mm2\": 339.1e-6");
     },
     "by_area.to_mm2"},
    {"rotation in degrees",
     [](const Copy& c) { c.replace("sensor.json", "\"to_rad\": 0.1188", "\"to_rad\": 6.8"); },
     "Give it in rad"},
    {"moments in N mm",
     [](const Copy& c) {
       c.scale("forces.csv", 4, 1e3);
       c.scale("forces.csv", 4, 1, 50);
     },
     "If the unit is N mm, divide by 1000"},
    {"forces of the other sign",
     [](const Copy& c) {
       c.edit_table("forces.csv", [](Row& r) {
         r[3] = "2.5";
         return true;
       });
     },
     "a press has force_z_n < 0"},
    {"force columns exchanged",
     [](const Copy& c) {
       c.edit_table("forces.csv", [](Row& r) {
         r[3] = std::to_string(-std::stod(r[0]));
         std::swap(r[1], r[3]);
         return true;
       });
     },
     "Check whether the columns are exchanged"},
    {"a force gauge turned by 30 degrees", [](const Copy& c) { drag(c, CV_PI / 6); },
     "the forces are rotated by 30 +- "},
    {"a force gauge turned by 90 degrees", [](const Copy& c) { drag(c, CV_PI / 2); },
     "(rotated by 90 +- "},
    {"x and y of the forces exchanged",
     [](const Copy& c) {
       drag(c, 0);
       c.edit_table("forces.csv", [](Row& r) {
         std::swap(r[1], r[2]);
         return true;
       });
     },
     "check whether x and y are exchanged"},
    {"a force gauge that was not tared", [](const Copy& c) { c.scale("forces.csv", 3, 1, -0.4); },
     "Tare the gauge with nothing in contact"},
    {"no sensor.json", [](const Copy& c) { fs::remove(c.folder() / "sensor.json"); },
     "sensor.json: cannot be read"},
};

const std::vector<Mistake> print_mistakes = {
    {"dots of another pitch",
     [](const Copy& c) { c.replace("sensor.json", "\"pitch_mm\": 1.5", "\"pitch_mm\": 2.5"); },
     "dots.pitch_mm: the dots are"},
    {"fewer dots than there are",
     [](const Copy& c) {
       c.replace("sensor.json", "\"rows\": 21, \"cols\": 21", "\"rows\": 11, \"cols\": 21");
       fs::remove(c.folder() / "stress_free_dots.csv");
     },
     "dots.rows and cols"},
    {"an absurd pitch",
     [](const Copy& c) { c.replace("sensor.json", "\"pitch_mm\": 1.5", "\"pitch_mm\": 1e30"); },
     "dots.pitch_mm"},
    {"an absurd number of dots",
     [](const Copy& c) { c.replace("sensor.json", "\"rows\": 21", "\"rows\": 2000"); },
     "dots.rows = 2000, must be 2 to 100"},
};

void make_all(const Copy& copy, double reading) {
  copy.edit_table("taxels.csv", [&](Row& row) {
    std::fill(row.begin() + 2, row.end(), std::to_string(reading));
    return true;
  });
}

const std::vector<Mistake> foam_mistakes = {
    {"time in ms", [](const Copy& c) { c.scale("taxels.csv", 1, 1000); },
     "If the unit is ms, divide by 1000"},
    {"time in min", [](const Copy& c) { c.scale("taxels.csv", 1, 1.0 / 60); },
     "if it is min, multiply by 60"},
    {"a gap",
     [](const Copy& c) {
       c.edit_table("taxels.csv", [](Row& r) {
         const int k = std::stoi(r[0]);
         return k < 100 || k > 130;
       });
     },
     "a gap of"},
    {"a dead taxel", [](const Copy& c) { c.scale("taxels.csv", 5, 0); },
     "300 readings of 1 taxel do not change while those beside them do"},
    {"a dead array", [](const Copy& c) { make_all(c, 0); }, "64 of 64 taxels never change"},
    {"an array dead at some reading", [](const Copy& c) { make_all(c, 517); },
     "64 of 64 taxels never change"},
    {"an array at full scale", [](const Copy& c) { make_all(c, 4095); },
     "64 of 64 taxels never change"},
    {"readings below the noise",
     [](const Copy& c) {
       c.replace("sensor.json", "\"pitch_mm\"", "\"noise\": 6000, \"pitch_mm\"");
     },
     "Give the noise in the unit of the readings"},
    {"a taxel that flickers",
     [](const Copy& c) {
       c.edit_table("taxels.csv", [](Row& r) {
         r[7] = std::stoi(r[0]) % 2 == 0 ? "0" : "30000";
         return true;
       });
     },
     "the reading changes by"},
    {"bytes exchanged",
     [](const Copy& c) {
       c.edit_table("taxels.csv", [](Row& r) {
         for (std::size_t k = 2; k < r.size(); ++k) {
           const auto word = static_cast<unsigned>(std::stod(r[k]));
           r[k] = std::to_string(((word & 255U) << 8U) | (word >> 8U));
         }
         return true;
       });
     },
     "Swap the two bytes"},
};

void check_all(
    const std::string& bundled,
    const std::vector<Mistake>& all,
    void (*prepare)(const Copy&) = [](const Copy&) {}) {
  for (const Mistake& mistake : all) {
    const Copy copy(bundled);
    prepare(copy);
    mistake.make(copy);
    const std::string said = copy.said();
    INFO(mistake.name << ": " << said);
    CHECK(said.find(mistake.said) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("check: good recordings are not complained about") {
  CHECK(Copy("press").said() == "");
  CHECK(Copy("foam").said() == "");
  const Copy dots("press");
  no_print(dots);
  dots.write("dots.csv", dots_csv(good_place));
  CHECK(dots.said() == "");
  const Copy free_frames("press");
  fs::create_directory(free_frames.folder() / "free");
  for (const char* name : {"free/000000.png", "free/000001.png"}) {
    fs::copy_file(data / "press/frames/000000.png", free_frames.folder() / name);
    free_frames.edit_picture(name, [&](cv::Mat& frame) {
      cv::randu(frame(cv::Rect(0, 0, 9, 9)), 0, 9);  // all frames differ
    });
  }
  INFO(free_frames.said());
  CHECK(free_frames.said().find("touches") == std::string::npos);
}

TEST_CASE("check: mistakes in recordings of a camera") {
  check_all("press", mistakes, no_print);
  check_all("press", print_mistakes);
}

TEST_CASE("check: mistakes in recordings of a foam array") {
  check_all("foam", foam_mistakes);
}

TEST_CASE("check: what is missing is told, and is no mistake") {
  const Copy copy("press");
  fs::remove(copy.folder() / "signals.csv");
  CHECK(copy.said() == "");
  const auto findings = replay::check_recording(copy.folder());
  CHECK(std::any_of(findings.begin(), findings.end(), [](const replay::Finding& finding) {
    return !finding.is_wrong && finding.what.find("% of the range") != std::string::npos;
  }));
  CHECK(std::any_of(findings.begin(), findings.end(), [](const replay::Finding& finding) {
    return !finding.is_wrong &&
           finding.what.find("signals.csv has no pressure") != std::string::npos;
  }));
  CHECK(replay::print_check(copy.folder()) == 0);
}

TEST_CASE("check: a gauge that is not turned, and one of which nothing can tell it") {
  for (const auto& [turned_rad, directions] : {std::pair{0.0, 5}, {CV_PI / 6, 1}}) {
    const Copy copy("press");
    no_print(copy);
    drag(copy, turned_rad, directions);
    CHECK(copy.said().find("Rotate the gauge, or rotate its columns") == std::string::npos);
    const auto findings = replay::check_recording(copy.folder());
    const bool told =
        std::any_of(findings.begin(), findings.end(), [](const replay::Finding& finding) {
          return finding.what.find("a rotation of the gauge cannot be detected") !=
                 std::string::npos;
        });
    CHECK(told == (directions == 1));
  }
}

TEST_CASE("check: where all dots count as in contact, that is told") {
  const Copy copy("press");
  copy.write("dots.csv", dots_csv(good_place));
  const auto told = [&](const std::string& sensor) {
    copy.write("sensor.json", sensor);
    CHECK(copy.said() == "");
    const auto findings = replay::check_recording(copy.folder());
    return std::any_of(findings.begin(), findings.end(), [](const replay::Finding& finding) {
      return finding.place == "sensor.json, stick.covers_pattern";
    });
  };
  CHECK(told("{}"));
  CHECK_FALSE(told(R"({"stick": {"covers_pattern": true}})"));
}
