// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Recordings of foam arrays: synthetic taxels.csv with vibrations of known place and time.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "foam/recording.hpp"
#include "replay/check/check.hpp"
#include "replay/foam/recording.hpp"
#include "replay/replay.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;
using test::Line;

namespace {

const fs::path bundled = test::bundled_recordings / "foam";

constexpr int window = 16;
constexpr double rate_hz = 32;      // so that times have few digits
constexpr int first_begins = 100;   // sample from which a taxel vibrates
constexpr int second_begins = 124;  // and another one begins, faster

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

/// Nearly normal with a standard deviation of 1; a function of its arguments alone.
double noise(int sample, int row, int col) {
  std::uint32_t state = 1 + static_cast<std::uint32_t>((sample * 64 + row) * 64 + col);
  double sum = -6;
  for (int k = 0; k < 16; ++k) {
    state = state * 1664525U + 1013904223U;
    sum += k < 4 ? 0 : state / 4294967296.0;
  }
  return sum;
}

/// A taxels.csv; tests change its cells.
struct Taxels {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> lines;

  std::size_t column(const std::string& name) const {
    const auto at = std::find(header.begin(), header.end(), name);
    REQUIRE(at != header.end());
    return static_cast<std::size_t>(at - header.begin());
  }
  std::string& cell(int line, const std::string& name) {
    return lines.at(static_cast<std::size_t>(line)).at(column(name));
  }
  std::string text() const {
    const auto line = [](const std::vector<std::string>& cells) {
      std::string joined;
      for (std::size_t k = 0; k < cells.size(); ++k) {
        joined += (k > 0 ? "," : "") + cells[k];
      }
      return joined + "\n";
    };
    std::string all = line(header);
    for (const auto& cells : lines) {
      all += line(cells);
    }
    return all;
  }
};

using Signal = std::function<double(int sample, int row, int col)>;

Taxels taxels_of(int rows, int cols, int samples, const Signal& signal) {
  Taxels taxels{{"frame", "time_s"}, {}};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      std::string& name = taxels.header.emplace_back("r");
      name += std::to_string(i) + "_c" + std::to_string(j);
    }
  }
  for (int k = 0; k < samples; ++k) {
    taxels.lines.push_back({std::to_string(k), number(k / rate_hz)});
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) {
        taxels.lines.back().push_back(number(signal(k, i, j)));
      }
    }
  }
  return taxels;
}

/// A hill of pressure in integer counts without vibration.
double held(int k, int i, int j) {
  return std::round(300 * std::exp(-((i - 2.5) * (i - 2.5) + (j - 1.5) * (j - 1.5)) / 4) + 20 +
                    3 * noise(k, i, j));
}

/// The same, where taxel (1, 1) begins to vibrate and then (4, 2), more strongly and faster.
double creeping(int k, int i, int j) {
  const auto shaken = [&](int row, int col, int from, double hz, double counts) {
    return i == row && j == col && k >= from
               ? counts * std::sin(2 * std::numbers::pi * hz * (k - from) / rate_hz)
               : 0.0;
  };
  return std::round(held(k, i, j) + shaken(1, 1, first_begins, 4, 60) +
                    shaken(4, 2, second_begins, 6, 100));
}

constexpr int rows = 6;
constexpr int cols = 4;
constexpr int samples = 160;  // at rest for more than half of them

/// A folder with a recording.
class Workplace {
 public:
  explicit Workplace(const std::string& taxels, const std::string& sensor = "") {
    fs::create_directories(folder());
    write("taxels.csv", taxels);
    if (!sensor.empty()) {
      write("sensor.json", sensor);
    }
  }
  explicit Workplace(const Taxels& taxels, const std::string& sensor = "")
      : Workplace(taxels.text(), sensor) {}

  fs::path folder() const { return root_.path() / "recording"; }
  fs::path out() const { return root_.path() / "out"; }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder() / file) << text;
  }

  /// The error line of a run, or an empty string; a failed run must leave nothing behind.
  std::string complaint(bool pictures = false, const replay::Range& range = {}) const {
    replay::Options options;
    options.recording = folder();
    options.out = out();
    options.raw = true;
    options.pictures = pictures;
    options.range = range;
    try {
      const int status = replay::run(options);
      CHECK(status == 0);
    } catch (const replay::Failure& failure) {
      const std::string line = failure.what();
      CHECK(line.find('\n') == std::string::npos);
      CHECK(std::distance(fs::directory_iterator(root_.path()), fs::directory_iterator()) == 1);
      return line;
    }
    return "";
  }

  std::string table_text() const { return test::text_of(out() / "frames.csv"); }
  std::vector<Line> table() const { return test::table_of(out() / "frames.csv"); }

 private:
  test::ScratchFolder root_;
};

std::string text_of(const Taxels& taxels, const std::string& sensor = "") {
  const Workplace work(taxels, sensor);
  REQUIRE(work.complaint() == "");
  return work.table_text();
}

std::vector<Line> run(const Taxels& taxels, const std::string& sensor = "") {
  const Workplace work(taxels, sensor);
  REQUIRE(work.complaint() == "");
  return work.table();
}

/// Index of the first line with an alarm; -1 if there is none.
int first_alarm(const std::vector<Line>& lines) {
  const auto at = std::find_if(lines.begin(), lines.end(),
                               [](const Line& line) { return line.at("preslip") == "1"; });
  return at == lines.end() ? -1 : static_cast<int>(at - lines.begin());
}

const char* const feature_columns[] = {"center_x_mm",   "center_y_mm",     "sum",
                                       "vibrating_row", "vibrating_col",   "waves",
                                       "frequency_hz",  "taxels_left_out", "taxel_status"};

std::string with_foam(const std::string& keys) {
  return "{\"foam\": {" + keys + "}}";
}

}  // namespace

TEST_CASE("a foam recording gives a table, and an alarm when the object begins to creep") {
  const Workplace work(taxels_of(rows, cols, samples, creeping));
  REQUIRE(work.complaint() == "");
  CHECK(work.table_text().substr(0, work.table_text().find('\n')) ==
        "frame,time_s,center_x_mm,center_y_mm,sum,vibrating_row,vibrating_col,waves,frequency_hz,"
        "taxels_left_out,taxel_status,preslip,preslip_rule");
  const auto lines = work.table();
  REQUIRE(lines.size() == samples);
  for (int k = 0; k < samples; ++k) {
    const Line& line = lines[static_cast<std::size_t>(k)];
    INFO("sample " << k);
    CHECK(line.at("frame") == std::to_string(k));
    CHECK(line.at("time_s") == number(k / rate_hz));
    CHECK(std::abs(std::stod(line.at("center_x_mm")) - 3.4 * 1.5) < 0.5);
    CHECK(std::abs(std::stod(line.at("center_y_mm")) - 3.4 * 2.5) < 0.5);
    CHECK(line.at("taxels_left_out") == "0");
    double sum = 0;
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) {
        sum += (std::max)(creeping(k, i, j), 0.0);
      }
    }
    CHECK(line.at("sum") == number(sum));
    const std::string status = line.at("taxel_status");
    CHECK((status == "filling") == (k < window - 1));
    CHECK(line.at("waves").empty() == (k < window - 1));
    CHECK(line.at("vibrating_row").empty() == (status != "vibrating"));
    CHECK((line.at("preslip_rule") == "") == (line.at("preslip") == "0"));
    if (k >= window - 1 && k < first_begins) {
      CHECK(status == "quiet");
      CHECK(line.at("waves") == "0");
      CHECK(line.at("frequency_hz") == "0.000000");
    } else if (k >= first_begins + 8 && k < second_begins) {
      CHECK(line.at("vibrating_row") + line.at("vibrating_col") == "11");
    } else if (k >= second_begins + window) {
      CHECK(line.at("vibrating_row") + line.at("vibrating_col") == "42");
      CHECK(std::abs(std::stod(line.at("frequency_hz")) - 6) < 1.1);
      CHECK(std::abs(std::stod(line.at("waves")) - 6 * window / rate_hz) < 0.6);
    }
  }
  CHECK(first_alarm(lines) >= first_begins);
  CHECK(first_alarm(lines) < first_begins + window);
  CHECK(lines[static_cast<std::size_t>(first_alarm(lines))].at("preslip_rule") == "grasp_lift");
  CHECK_FALSE(fs::exists(work.out() / "pictures"));
  CHECK_FALSE(fs::exists(work.out() / "dots.csv"));
  CHECK_FALSE(fs::exists(work.out() / "depth"));
}

TEST_CASE("a foam recording at rest gives no alarm") {
  const auto [name, signal] = GENERATE(table<const char*, Signal>(
      {{"held", held},
       {"never pressed", [](int, int, int) { return 0.0; }},
       {"held without noise", [](int, int i, int j) { return 10.0 * i + j; }},
       {"loosened evenly", [](int k, int i, int j) { return held(k, i, j) * (1 - 0.004 * k); }}}));
  INFO(name);
  const auto lines = run(taxels_of(rows, cols, samples, signal));
  CHECK(first_alarm(lines) == -1);
  const bool has_noise = std::string(name) == "held" || std::string(name) == "loosened evenly";
  CHECK(lines.back().at("taxel_status") == (has_noise ? "quiet" : "frozen"));
}

TEST_CASE("fingers are found where sensor.json says, each as if it were alone") {
  // The second finger is beside the first one, a row lower, with a column between them.
  const auto other = [](int k, int i, int j) {
    return std::round(1.5 * held(k, i, j)) +
           (i == 2 && j == 0 && k >= 110 ? 80 * std::sin(0.9 * k) : 0.0);
  };
  const auto both = taxels_of(rows + 1, 2 * cols + 1, samples, [&](int k, int i, int j) {
    return i < rows && j < cols ? creeping(k, i, j)
           : i > 0 && j > cols  ? other(k, i - 1, j - cols - 1)
                                : 1000.0 + 900 * ((k + i + j) % 2);
  });
  const auto lines = run(both, with_foam(R"("fingers": [
      {"first_row": 0, "rows": 6, "first_col": 0, "cols": 4},
      {"first_row": 1, "rows": 6, "first_col": 5, "cols": 4}])"));
  const std::vector<std::vector<Line>> alone = {run(taxels_of(rows, cols, samples, creeping)),
                                                run(taxels_of(rows, cols, samples, other))};
  for (std::size_t k = 0; k < lines.size(); ++k) {
    INFO("sample " << k);
    for (std::size_t f = 0; f < 2; ++f) {
      for (const char* column : feature_columns) {
        CHECK(lines[k].at("finger" + std::to_string(f) + "_" + column) == alone[f][k].at(column));
      }
    }
  }
  const std::string header = text_of(both, with_foam(R"("fingers": [
      {"first_row": 0, "rows": 1, "first_col": 0, "cols": 1},
      {"first_row": 0, "rows": 1, "first_col": 1, "cols": 1}])"));
  CHECK(header.substr(0, header.find('\n')) ==
        "frame,time_s,finger0_center_x_mm,finger0_center_y_mm,finger0_sum,finger0_vibrating_row,"
        "finger0_vibrating_col,finger0_waves,finger0_frequency_hz,finger0_taxels_left_out,"
        "finger0_taxel_status,finger1_center_x_mm,finger1_center_y_mm,finger1_sum,"
        "finger1_vibrating_row,finger1_vibrating_col,finger1_waves,finger1_frequency_hz,"
        "finger1_taxels_left_out,finger1_taxel_status,preslip,preslip_rule");
}

TEST_CASE("either rule may be left out") {
  // With equal waves at another place grasp-optimise alarms, too.
  const auto signal = [](int k, int i, int j) {
    const bool first = i == 1 && j == 1 && k >= first_begins && k < second_begins;
    const bool second = i == 4 && j == 2 && k >= second_begins;
    return held(k, i, j) + (first || second ? 80 * std::sin(0.84 * k) : 0.0);
  };
  const auto taxels = taxels_of(rows, cols, samples, signal);
  const auto both = run(taxels, with_foam(R"("rule": "both")"));
  const auto lift = run(taxels);
  const auto explicitly = run(taxels, with_foam(R"("rule": "grasp_lift")"));
  const auto optimise = run(taxels, with_foam(R"("rule": "grasp_optimise")"));
  int together = 0;
  for (std::size_t k = 0; k < both.size(); ++k) {
    INFO("sample " << k);
    const bool lifts = lift[k].at("preslip") == "1";
    const bool optimises = optimise[k].at("preslip") == "1";
    CHECK(lift[k].at("preslip_rule") == (lifts ? "grasp_lift" : ""));
    CHECK(optimise[k].at("preslip_rule") == (optimises ? "grasp_optimise" : ""));
    CHECK(both[k].at("preslip") == (lifts || optimises ? "1" : "0"));
    CHECK(both[k].at("preslip_rule") == (lifts && optimises ? "grasp_optimise+grasp_lift"
                                         : lifts            ? "grasp_lift"
                                         : optimises        ? "grasp_optimise"
                                                            : ""));
    CHECK(explicitly[k] == lift[k]);
    together += lifts && optimises ? 1 : 0;
  }
  CHECK(first_alarm(lift) >= first_begins);
  CHECK(first_alarm(lift) < second_begins);
  CHECK(first_alarm(optimise) >= second_begins);
  CHECK(together > 0);
}

TEST_CASE("the order of the columns and the way of the file do not matter") {
  const Taxels taxels = taxels_of(rows, cols, samples, creeping);
  const std::string expected = text_of(taxels);
  Taxels rotated = taxels;
  std::reverse(rotated.header.begin(), rotated.header.end());
  std::rotate(rotated.header.begin(), rotated.header.begin() + 7, rotated.header.end());
  for (auto& line : rotated.lines) {
    std::reverse(line.begin(), line.end());
    std::rotate(line.begin(), line.begin() + 7, line.end());
  }
  CHECK(text_of(rotated) == expected);

  std::string text = "\xEF\xBB\xBF";  // as a spreadsheet writes it
  for (const char c : taxels.text()) {
    text += c == '\n' ? "\r\n" : c == ',' ? ", " : std::string(1, c);
  }
  const Workplace work(text + "\r\n");
  REQUIRE(work.complaint() == "");
  CHECK(work.table_text() == expected);
}

TEST_CASE("what sensor.json leaves out is as documented") {
  const Taxels taxels = taxels_of(rows, cols, samples, creeping);
  const std::string expected = text_of(taxels);
  CHECK(text_of(taxels, "{}") == expected);
  CHECK(text_of(taxels, with_foam("")) == expected);
  CHECK(text_of(taxels,
                with_foam(R"("fingers": [{"first_row": 0, "rows": 6, "first_col": 0, "cols": 4}],
      "pitch_mm": 3.4, "window": 16, "sample_period_s": 0.03125, "noise_factor": 2.5,
      "quiet_until_s": 1.99, "stuck_after": 30, "longest_gap_s": 2, "history": 100,
      "least_waves": 1, "centroid_tolerance_mm": 0.1, "rule": "grasp_lift")")) == expected);
}

TEST_CASE("each key of sensor.json reaches the features or the rules") {
  const Taxels taxels = taxels_of(rows, cols, samples, creeping);
  const std::string expected = text_of(taxels);
  const std::string key =
      GENERATE(R"("pitch_mm": 1)", R"("window": 8)", R"("sample_period_s": 0.01)", R"("noise": 30)",
               R"("noise_factor": 20)", R"("saturated_at": 200)", R"("longest_gap_s": 0.01)",
               R"("history": 2)", R"("least_waves": 4)", R"("centroid_tolerance_mm": 3)");
  INFO(key);
  CHECK(text_of(taxels, with_foam(key)) != expected);
}

TEST_CASE("counts become newtons by what is stated of the array or of each taxel") {
  const Taxels taxels = taxels_of(rows, cols, samples, creeping);
  const auto counts = run(taxels), all = run(taxels, with_foam(R"("newton_per_unit": 0.01)"));
  std::string each;
  for (int k = 0; k < rows * cols; ++k) {
    each += (k > 0 ? ", " : "") + number(k < cols ? 0.02 : 0.01);
  }
  const auto twice = run(taxels, with_foam(R"("newton_per_unit": [)" + each + "]"));
  CHECK(first_alarm(all) == first_alarm(counts));
  for (std::size_t k = 0; k < counts.size(); k += 10) {
    double first_row = 0;
    for (int j = 0; j < cols; ++j) {
      first_row += creeping(static_cast<int>(k), 0, j);
    }
    CHECK(std::stod(all[k].at("force_n")) == Approx(0.01 * std::stod(counts[k].at("sum"))));
    CHECK(std::stod(twice[k].at("force_n")) ==
          Approx(0.01 * (std::stod(counts[k].at("sum")) + first_row)));
  }
  CHECK(Workplace(taxels, with_foam(R"("newton_per_unit": [1, 2])"))
            .complaint()
            .find("foam.newton_per_unit has 2 entries, but taxels.csv has 24 taxels") !=
        std::string::npos);
}

TEST_CASE("taxels lie where places_mm says") {
  const Taxels taxels = taxels_of(rows, cols, samples, creeping);
  const auto places = [](double pitch_mm, double from_mm) {
    std::string list;
    for (int k = 0; k < rows * cols; ++k) {
      list += (k > 0 ? ", [" : "[") + number(from_mm + pitch_mm * (k % cols)) + ", " +
              number(pitch_mm * (k / cols)) + "]";
    }
    return with_foam("\"places_mm\": [" + list + "]");
  };
  CHECK(text_of(taxels, places(3.4, 0)) == text_of(taxels));
  const auto there = run(taxels, places(3.4, 50)), here = run(taxels);
  CHECK(std::stod(there[9].at("center_x_mm")) == Approx(std::stod(here[9].at("center_x_mm")) + 50));
  CHECK(Workplace(taxels, with_foam(R"("places_mm": [[0, 0]])"))
            .complaint()
            .find("foam.places_mm has 1 entries, but taxels.csv has 24 taxels") !=
        std::string::npos);
}

TEST_CASE("a zero that drifts is told and taken off, and so is a rate that is too low") {
  // pressed from sample 70 to 130, while every taxel's zero rises by its own 10 to 33 counts
  const auto load = [](int k, int i, int j) {
    return k < 70 || k >= 130 ? 3 * noise(k, i, j) : 3 * held(k, i, j);
  };
  const auto drifts = [&](int k, int i, int j) {
    return std::round(load(k, i, j) + (10 + (7 * (i * cols + j)) % 24) * k / 199.0);
  };
  const Workplace plain(taxels_of(rows, cols, 200, load)), work(taxels_of(rows, cols, 200, drifts));
  const auto told = [](const Workplace& in) {
    const auto recording = replay::open_foam_recording(in.folder());
    return recording.told.empty() ? "" : recording.told.back().what;
  };
  CHECK(told(plain).find("the zero of the taxels moves") == std::string::npos);
  CHECK(told(work).find("the zero of the taxels moves by up to ") == 0);
  REQUIRE(plain.complaint() == "");
  REQUIRE(work.complaint() == "");
  const auto with = work.table(), without = plain.table();
  CHECK(std::stod(with[100].at("sum")) == Approx(std::stod(without[100].at("sum"))).epsilon(0.02));
  CHECK(with[60].at("center_x_mm") == "");  // touch and release
  CHECK(with[75].at("center_x_mm") != "");
  CHECK(with[190].at("center_x_mm") == "");
  Taxels slow = taxels_of(rows, cols, 60, held);
  for (int k = 0; k < 60; ++k) {
    slow.cell(k, "time_s") = number(0.2 * k);
  }
  const auto findings = replay::check_recording(Workplace(slow).folder());
  CHECK(std::any_of(findings.begin(), findings.end(), [](const replay::Finding& finding) {
    return finding.what.find("a window of 16 samples takes 3.2 s") == 0;
  }));
}

TEST_CASE("lost readings do not end the run") {
  const Taxels whole = taxels_of(rows, cols, samples, creeping);
  Taxels taxels = whole;
  SECTION("cells without a finite number") {
    taxels.cell(30, "r0_c0") = "";
    taxels.cell(30, "r0_c3") = "nan";
    taxels.cell(31, "r5_c3") = "-inf";
    taxels.cell(31, "r5_c2") = "NaN";
    taxels.cell(31, "r5_c1") = "1e999";
    const auto lines = run(taxels);
    CHECK(lines[29].at("taxels_left_out") == "0");
    CHECK(lines[30].at("taxels_left_out") == "2");
    CHECK(lines[31].at("taxels_left_out") == "3");
    CHECK(lines[32].at("taxels_left_out") == "0");
    CHECK(first_alarm(lines) == first_alarm(run(whole)));
  }
  SECTION("a line that ends too early") {
    taxels.lines[30].resize(2 + 20);
    const auto lines = run(taxels);
    CHECK(lines[30].at("taxels_left_out") == "4");
    CHECK(lines[30].at("taxel_status") == "quiet");
    CHECK(first_alarm(lines) == first_alarm(run(whole)));
  }
  SECTION("a sample without readings") {
    taxels.lines[30].resize(2);
    const auto lines = run(taxels);
    CHECK(lines[30].at("taxels_left_out") == std::to_string(rows * cols));
    CHECK(lines[30].at("taxel_status") == "no taxels");
    CHECK(lines[30].at("center_x_mm") == "");
    CHECK(lines[30].at("waves") == "");
    CHECK(lines[45].at("taxel_status") == "no taxels");  // no taxel has a whole valid window
    CHECK(lines[46].at("taxel_status") == "quiet");
    CHECK(first_alarm(lines) >= first_begins);
  }
  SECTION("no readings at all") {
    for (auto& line : taxels.lines) {
      line.resize(2);
    }
    const auto lines = run(taxels);
    CHECK(first_alarm(lines) == -1);
    CHECK(lines.back().at("taxel_status") == "no taxels");
  }
}

TEST_CASE("frames are named as in the file, and counted on where their names are lost") {
  Taxels taxels = taxels_of(rows, cols, 30, held);
  for (int k = 0; k < 30; ++k) {
    taxels.cell(k, "frame") = std::to_string(1000 + 2 * k);
  }
  taxels.cell(7, "frame") = "";
  const auto lines = run(taxels);
  CHECK(lines[6].at("frame") == "1012");
  CHECK(lines[7].at("frame") == "1013");
  CHECK(lines[8].at("frame") == "1016");
}

TEST_CASE("a slow recording is not one of gaps") {
  Taxels taxels = taxels_of(rows, cols, samples, creeping);
  for (int k = 0; k < samples; ++k) {
    taxels.cell(k, "time_s") = number(2.0 * k);
  }
  const auto lines = run(taxels);
  CHECK(lines[20].at("taxel_status") == "quiet");
  CHECK(first_alarm(lines) == first_alarm(run(taxels_of(rows, cols, samples, creeping))));
  const auto gaps = run(taxels, with_foam(R"("longest_gap_s": 1)"));
  CHECK(gaps.back().at("taxel_status") == "clock jumps");
}

TEST_CASE("a table that is none of taxels is refused with the column's name") {
  struct Fault {
    const char* text;
    const char* complaint;
  };
  const auto [text, complaint] = GENERATE(
      Fault{"", "taxels.csv: is empty or cannot be read"},
      Fault{"frame,time_s,r0_c0\n", "taxels.csv: holds no samples"},
      Fault{"frame,r0_c0\n0,1\n", "line 1: column time_s is missing"},
      Fault{"time_s,r0_c0\n0,1\n", "line 1: column frame is missing"},
      Fault{"frame,time_s\n0,1\n", "line 1: there are no taxel columns r<row>_c<col>"},
      Fault{
          "frame,time_s,r0_c0,r0_c1,r1_c0\n0,0,1,1,1\n",
          "line 1: column r1_c1 is missing; the other columns belong to an array of 2 x 2 taxels"},
      Fault{"frame,time_s,r1_c0\n0,0,1\n", "line 1: column r0_c0 is missing"},
      Fault{"frame,time_s,r0_c0,r2_c0\n0,0,1,1\n", "line 1: column r1_c0 is missing"},
      Fault{"frame,time_s,r0_c0,r0_c0\n0,0,1,1\n", "line 1: column r0_c0 is given twice"},
      Fault{"frame,time_s,r0_c0,r00_c0\n0,0,1,1\n", "line 1: column r00_c0 is given twice"},
      Fault{"frame,time_s,r0_c0,time_s\n0,0,1,1\n", "line 1: column time_s is given twice"},
      Fault{"frame,time_s,r0_c0,pressure\n0,0,1,1\n",
            "line 1: unknown column 'pressure' (known: frame, time_s, r<row>_c<col>)"},
      Fault{"frame,time_s,r0_c\n0,0,1\n", "unknown column 'r0_c'"},
      Fault{"frame,time_s,r0_c0x\n0,0,1\n", "unknown column 'r0_c0x'"},
      Fault{"frame,time_s,r9999_c0\n0,0,1\n", "unknown column 'r9999_c0'"},
      Fault{"frame,time_s,r99999999999999999999_c0\n0,0,1\n", "unknown column 'r9999999"},
      Fault{"frame,time_s,r-1_c0\n0,0,1\n", "unknown column 'r-1_c0'"},
      Fault{"frame,time_s,,r0_c0\n0,0,,1\n", "unknown column ''"},
      Fault{"frame;time_s;r0_c0\n0;0;1\n", "line 1: the values are separated by ';'"},
      Fault{"frame,time_s,r0_c0\n0,0,1\n1,1,2,3\n",
            "line 3: has 4 values, must have 3 (decimals must be"},
      Fault{"frame,time_s,r0_c0\n0,0,1\n1,1,two\n", "line 3: r0_c0 'two' is not a number"},
      Fault{"frame,time_s,r0_c0\n0,soon,1\n", "line 2: time_s 'soon' is not a number"},
      Fault{"frame,time_s,r0_c0\n-1,0,1\n", "line 2: frame '-1' is not a whole number >= 0"},
      Fault{"frame,time_s,r0_c0\n0.5,0,1\n", "line 2: frame '0.5' is not a whole number"});
  const Workplace work{std::string(text)};
  const std::string line = work.complaint();
  INFO(line);
  CHECK(line.find(complaint) != std::string::npos);
}

TEST_CASE("the section foam of sensor.json is refused with the key's name") {
  struct Fault {
    const char* sensor;
    const char* complaint;
  };
  const auto [sensor, complaint] = GENERATE(
      Fault{R"({"foam": {"pich_mm": 1}})", "unknown key foam.pich_mm (known keys: fingers, "},
      Fault{R"({"foams": {}})", "unknown key foams (known keys: version, calibration, foam)"},
      Fault{R"({"foam": [1]})", "foam is an array, must be an object"},
      Fault{R"({"foam": {"window": 3}})", "foam: TaxelOptions: window = 3, must be in [4, 4096]"},
      Fault{R"({"foam": {"window": 16.5}})", "foam.window is 16.5 (a number), must be a whole"},
      Fault{R"({"foam": {"stuck_after": -1}})", "foam.stuck_after = -1, must be >= 0"},
      Fault{R"({"foam": {"pitch_mm": "1"}})",
            "foam.pitch_mm is \"1\" (a string), must be a number"},
      Fault{R"({"foam": {"pitch_mm": 0}})", "pitch_mm = 0"},
      Fault{R"({"foam": {"noise": -1}})", "noise = -1"},
      Fault{R"({"foam": {"noise_factor": -1}})", "noise_factor = -1"},
      Fault{R"({"foam": {"sample_period_s": 0}})", "sample_period_s = 0"},
      Fault{R"({"foam": {"longest_gap_s": -1}})", "longest_gap_s = -1"},
      Fault{R"({"foam": {"saturated_at": 0}})", "saturated_at = 0"},
      Fault{R"({"foam": {"quiet_until_s": 0.3}})",
            "foam.quiet_until_s = 0.3: TaxelNoiseCalibration: windows = 0, must be >= 4"},
      Fault{R"({"foam": {"history": 1}})", "foam: PreslipOptions: history = 1"},
      Fault{R"({"foam": {"centroid_tolerance_mm": -1}})", "centroid_tolerance_mm = -1"},
      Fault{R"({"foam": {"rule": "lift"}})",
            "foam.rule is \"lift\" (a string), must be \"grasp_lift\" or \"grasp_optimise\""},
      Fault{R"({"foam": {"fingers": []}})", "fingers must be a list [...] of 1 to 5 fingers"},
      Fault{R"({"foam": {"fingers": {}}})", "fingers must be a list [...] of 1 to 5 fingers"},
      Fault{R"({"foam": {"fingers": [1, 2, 3, 4, 5, 6]}})", "of 1 to 5 fingers"},
      Fault{R"({"foam": {"fingers": [{"rows": 1, "first_col": 0, "cols": 1}]}})",
            "foam.fingers[0].first_row is missing (first row of the finger in the array, counted "
            "from 0)"},
      Fault{R"({"foam": {"fingers": [{"first_row": 0, "rows": 0, "first_col": 0, "cols": 1}]}})",
            "foam.fingers[0].rows = 0, must be >= 1"},
      Fault{R"({"foam": {"fingers": [{"first_row": -1, "rows": 1, "first_col": 0, "cols": 1}]}})",
            "foam.fingers[0].first_row = -1, must be >= 0"},
      Fault{R"({"foam": {"fingers": [{"first_row": 1, "rows": 6, "first_col": 0, "cols": 4}]}})",
            "foam.fingers[0] extends beyond the array, which has 6 x 4 taxels"},
      Fault{R"({"foam": {"fingers": [{"first_row": 0, "rows": 6, "first_col": 2147483647,
                                      "cols": 2147483647}]}})",
            "foam.fingers[0] extends beyond the array"},
      Fault{R"({"foam": {"fingers": [{"first_row": 0, "rows": 3, "first_col": 0, "cols": 4},
                                     {"first_row": 2, "rows": 4, "first_col": 3, "cols": 1}]}})",
            "foam.fingers[1] shares taxels with foam.fingers[0]"},
      Fault{R"({"camera": {}})",
            "has section camera, which a recording with taxels.csv cannot have"},
      Fault{R"({"foam": {}, "dots": {}})", "has section dots, which a recording with taxels.csv"},
      Fault{"{", "parse error"}, Fault{"[]", "the whole file is an array, must be an object"});
  const Workplace work(taxels_of(rows, cols, 20, held), sensor);
  const std::string line = work.complaint();
  INFO(line);
  CHECK(line.find("sensor.json: ") != std::string::npos);
  CHECK(line.find(complaint) != std::string::npos);
}

TEST_CASE("a section foam without a table of taxels is refused") {
  const Workplace work(taxels_of(rows, cols, 20, held), with_foam(""));
  fs::remove(work.folder() / "taxels.csv");
  CHECK(work.complaint().find("has a section foam, but taxels.csv with the readings") !=
        std::string::npos);
}

TEST_CASE("a part of a foam recording") {
  const Taxels taxels = taxels_of(rows, cols, samples, creeping);
  const Workplace work(taxels, with_foam(R"("noise": 4, "sample_period_s": 0.03125)"));
  CHECK(work.complaint(false, {100, 161}).find("has frames 0 to 159") != std::string::npos);
  REQUIRE(work.complaint(false, {80, 140}) == "");
  const auto part = work.table();
  REQUIRE(part.size() == 60);
  CHECK(part.front().at("frame") == "80");
  CHECK(part[window - 2].at("taxel_status") == "filling");
  const auto whole = run(taxels, with_foam(R"("noise": 4, "sample_period_s": 0.03125)"));
  for (std::size_t k = window - 1; k < part.size(); ++k) {
    CHECK(part[k].at("vibrating_row") == whole[80 + k].at("vibrating_row"));
    CHECK(part[k].at("waves") == whole[80 + k].at("waves"));
  }
}

TEST_CASE("foam recordings with little in them, and with gaps") {
  const auto check = [](const Workplace& work) { CHECK(work.complaint(true) == ""); };
  SECTION("with an alarm, twice in the same place") {
    const Workplace work(taxels_of(rows, cols, samples, creeping));
    check(work);
    check(work);
  }
  SECTION("one sample of one taxel, at rest") {
    check(Workplace(taxels_of(1, 1, 1, held)));
  }
  SECTION("an alarm at the very end, lost readings, a clock that goes back") {
    Taxels taxels = taxels_of(rows, cols, first_begins + 12, creeping);
    taxels.lines[20].resize(2);
    taxels.lines[first_begins + 10].resize(12);
    taxels.cell(3, "time_s") = "";
    for (int k = 0; k < 10; ++k) {
      taxels.cell(k, "time_s") = number(1e6 + k / rate_hz);
    }
    check(Workplace(taxels));
  }
  SECTION("no reading at all") {
    check(Workplace("frame,time_s,r0_c0\n0\n1\n2\n"));
  }
}

TEST_CASE("the bundled foam recording is what its program makes, and alarms in time") {
  const std::string taxels = test::text_of(bundled / "taxels.csv");
  REQUIRE(taxels == foam::recording());
  const Workplace work(taxels, test::text_of(bundled / "sensor.json"));
  REQUIRE(work.complaint() == "");
  const auto lines = work.table();
  REQUIRE(lines.size() == foam::samples);
  std::map<std::string, double> first_s;
  for (const Line& line : lines) {
    for (const char* rule : {"grasp_lift", "grasp_optimise"}) {
      if (line.at("preslip_rule").find(rule) != std::string::npos) {
        first_s.emplace(rule, std::stod(line.at("time_s")));
      }
    }
  }
  for (const char* rule : {"grasp_lift", "grasp_optimise"}) {
    INFO(rule);
    REQUIRE(first_s.count(rule) == 1);
    CHECK(first_s[rule] > foam::creeps_from_s);
    CHECK(first_s[rule] < foam::slips_from_s);
  }
}
