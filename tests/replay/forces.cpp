// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "common/signals.hpp"
#include "common/true_forces.hpp"
#include "replay/replay.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;
using test::Line;
using test::table_of;

namespace {

const fs::path bundled = test::bundled_recordings / "press";

const std::vector<std::string> components = {"fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"};

/// A copy of the bundled recording that tests may modify.
class Workplace {
 public:
  Workplace() { fs::copy(bundled, recording(), fs::copy_options::recursive); }

  fs::path recording() const { return root_.path() / "recording"; }
  fs::path out() const { return root_.path() / "out"; }

  std::vector<Line> run(replay::Range range, bool pictures = false) const {
    replay::Options options;
    options.recording = recording();
    options.out = out();
    options.range = range;
    options.pictures = pictures;
    replay::run(options);
    return table_of(out() / "frames.csv");
  }

  std::string complaint() const {
    try {
      run({0, 1});
    } catch (const replay::Failure& failure) {
      return failure.what();
    }
    return "";
  }

  std::string read(const std::string& file) const { return test::text_of(recording() / file); }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(recording() / file) << text;
  }
  void replace(const std::string& file, const std::string& old, const std::string& with) const {
    test::replace_in(recording() / file, old, with);
  }

 private:
  test::ScratchFolder root_;
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

const std::vector<std::string> look_up = {"normal_force_n", "tangential_force_x_n",
                                          "tangential_force_y_n", "moment_z_nm"};

constexpr const char* by_depth_alone =
    R"({"by_depth": {"coefficients": [0, 1, 0.5], "from_mm": 0.1, "to_mm": 3.5}})";
constexpr const char* by_area_alone =
    R"({"by_area": {"coefficients": [0, 0.02], "from_mm2": 3, "to_mm2": 340}})";
constexpr const char* shear_alone =
    R"({"shear": {"by": "area", "reference": 50,
                  "displacement_exponent": 0.5, "force_n_per_mm": [2], "to_mm": 9,
                  "rotation_exponent": 1, "moment_n_mm_per_rad": [300], "to_rad": 0.1}})";

/// Replaces the "force" of the bundled recording's sensor.json.
void set_force(const Workplace& work, const std::string& force) {
  const std::string text = work.read("sensor.json");
  const auto at = text.find(",\n  \"force\"");
  REQUIRE(at != std::string::npos);
  work.write("sensor.json",
             text.substr(0, at) + (force.empty() ? "" : ",\n  \"force\": " + force) + "\n}\n");
}

bool is_empty(const Line& line, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(),
                     [&](const std::string& name) { return line.at(name).empty(); });
}

}  // namespace

TEST_CASE("replay: force and moment of the bundled recording", "[wrench]") {
  // against the finite elements; places of the dots from a single frame of the free pad
  const Workplace work;
  const auto found = work.run({});
  const auto truth = table_of(bundled / "membrane" / "load.csv");
  REQUIRE(found.size() == 11);
  REQUIRE(truth.size() == 11);
  double error[6] = {};
  int within = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (std::size_t c = 0; c < 6; ++c) {
      const double off =
          std::abs(number(found[k], "wrench_" + components[c]) - number(truth[k], components[c]));
      const std::string sd =
          "wrench_" + components[c].substr(0, 2) + "_sd" + components[c].substr(2);
      error[c] += off / static_cast<double>(truth.size());
      within += off < 3 * number(found[k], sd) ? 1 : 0;
    }
  }
  INFO("mean errors " << error[0] << ' ' << error[1] << ' ' << error[2] << " N, " << error[3] << ' '
                      << error[4] << ' ' << error[5] << " N m; " << within << " of 66 within 3 sd");
  const double largest_n = 1.8, largest_press_n = 3.1, largest_n_m = 0.0232;
  CHECK(error[0] < 0.05 * largest_n);
  CHECK(error[1] < 0.05 * largest_n);
  CHECK(error[2] < 0.05 * largest_press_n);
  CHECK(error[3] < 0.15 * largest_n_m);
  CHECK(error[4] < 0.15 * largest_n_m);
  CHECK(error[5] < 0.06 * largest_n_m);
}

TEST_CASE("replay: what the force needs may be missing", "[wrench]") {
  const Workplace work;
  SECTION("no dots") {
    work.replace("sensor.json",
                 R"("dots": { "rows": 21, "cols": 21, "pitch_mm": 1.5, "diameter_mm": 0.7 },)", "");
    CHECK(is_empty(work.run({5, 6}, true)[0]));
  }
  SECTION("no modulus, no inclination") {
    work.replace("sensor.json", "\"membrane_modulus_n_per_mm\": 0.5, ", "");
    CHECK(is_empty(work.run({0, 1})[0]));
    work.replace("sensor.json", "stress_free_inclination_rad\": 1.0618",
                 "membrane_modulus_n_per_mm\": 0.5");
    CHECK(is_empty(work.run({0, 1})[0]));
  }
  SECTION("no frame of the free pad") {
    CHECK(is_empty(work.run({5, 6})[0]));
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
    work.write("signals.csv", "frame,time_s,pressure_mpa\n0,0,0.016\n1,0.1,\n");
    const auto lines = work.run({0, 3});
    CHECK(is_full(lines[0]));
    CHECK(is_empty(lines[1]));
    CHECK(is_empty(lines[2]));
  }
}

TEST_CASE("replay: pictures of forces, and its own files are known again", "[wrench]") {
  const Workplace work;
  for (int again = 0; again < 2; ++again) {
    if (again == 1) {
      fs::remove(work.recording() / "forces.csv");  // no truth to compare with
    }
    work.run({6, 8}, true);
    for (const char* name : {"traction_000006.png", "traction_000007.png"}) {
      const cv::Mat picture = cv::imread((work.out() / "pictures" / name).string());
      INFO(name);
      CHECK(picture.cols > 400);
      CHECK(picture.rows > 400);
    }
  }
  fs::remove(work.recording() / "stress_free_dots.csv");
  set_force(work, "");
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
  SECTION("an inclination that is none") {
    work.replace("sensor.json", "1.0618", "3.5");
    says("height_mm = -");
  }
  SECTION("a key that is none") {
    work.replace("sensor.json", "stress_free_inclination_rad", "inclination");
    says("unknown key rim.inclination (known keys: side_dot_length_mm, ");
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

TEST_CASE("replay: forces by look-up of the bundled recording", "[look-up]") {
  // a rod, looked up in curves of a plate: flat area and shift work for both
  const Workplace work;
  const auto found = work.run({});
  const auto truth = table_of(bundled / "forces.csv");
  REQUIRE(found.size() == 11);
  REQUIRE(truth.size() == 11);
  double normal_n = 0, tangential_n = 0, moment_nm = 0, worst_sds = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const auto error = [&](const char* name, const char* true_name, double sign) {
      return std::abs(number(found[k], name) - sign * number(truth[k], true_name)) / 11;
    };
    const double off_n = error("normal_force_n", "force_z_n", -1);
    normal_n += off_n;
    worst_sds = std::fmax(worst_sds, 11 * off_n / number(found[k], "normal_force_sd_n"));
    tangential_n += error("tangential_force_x_n", "force_x_n", 1) +
                    error("tangential_force_y_n", "force_y_n", 1);
    moment_nm += error("moment_z_nm", "moment_z_nm", 1);
  }
  INFO("mean errors " << normal_n << " N, " << tangential_n << " N, " << moment_nm << " N m");
  CHECK(tangential_n < 0.06 * 1.8);
  CHECK(moment_nm < 0.0004);  // of the 0.04 that were calibrated
  CHECK(normal_n < 0.03 * 3.1);
  CHECK(worst_sds < 3);
  for (const std::string& name : look_up) {
    CHECK(number(found[0], name) == 0);
  }
  CHECK(is_empty(found[0], {"shift_x_mm", "shift_y_mm", "shift_rad"}));
  // the rod sticks in frame 6 and carries the dots along
  CHECK(number(found[6], "shift_x_mm") == Approx(0.5491).margin(0.03));
  CHECK(number(found[6], "shift_y_mm") == Approx(0).margin(0.01));
  CHECK(number(found[6], "shift_rad") == Approx(0).margin(0.001));
}

TEST_CASE("replay: without curves nothing is looked up, and friction tells no slip", "[look-up]") {
  const Workplace work;
  const auto with = work.run({6, 8});
  set_force(work, "");
  const auto without = work.run({6, 8});
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(is_empty(without[k], look_up));
    CHECK(without[k].at("slip_evidence").find("friction") == std::string::npos);
    std::vector<std::string> change = look_up;
    change.insert(change.end(), {"normal_force_sd_n", "look_up_status"});
    if (with[k].at("slip_evidence").find("friction") != std::string::npos) {
      change.insert(change.end(), {"slip_evidence", "stick_ratio", "stick_ratio_sd"});
    }
    for (const auto& [name, text] : with[k]) {
      if (std::find(change.begin(), change.end(), name) == change.end()) {
        INFO(name);
        CHECK(without[k].at(name) == text);
      }
    }
    CHECK_FALSE(without[k].at("shift_x_mm").empty());
  }
}

TEST_CASE("replay: forces are what the curves say of area, depth and shift", "[look-up]") {
  const Workplace work;
  SECTION("by depth") {
    set_force(work, by_depth_alone);
    for (const Line& line : work.run({0, 2})) {
      const std::string& deep = line.at("contact_depth_mm");
      const double depth_mm = deep.empty() ? 0 : std::stod(deep);
      CHECK(number(line, "normal_force_n") ==
            Approx(depth_mm + 0.5 * depth_mm * depth_mm).margin(1e-5));
      CHECK(is_empty(line, {"tangential_force_x_n", "tangential_force_y_n", "moment_z_nm"}));
    }
  }
  SECTION("by area") {
    set_force(work, by_area_alone);
    const Line line = work.run({6, 7})[0];
    CHECK(number(line, "normal_force_n") ==
          Approx(0.02 * number(line, "flat_area_mm2")).margin(1e-5));
  }
  SECTION("by both, the area counting, which knows shape") {
    set_force(work,
              R"({"by_area": {"coefficients": [1], "from_mm2": 3, "to_mm2": 340,
                             "residual_n": 0.1},
                  "by_depth": {"coefficients": [2], "from_mm": 0.1, "to_mm": 3.5,
                               "residual_n": 0.2}})");
    CHECK(number(work.run({6, 7})[0], "normal_force_n") == Approx(1));
  }
  SECTION("shear by area") {
    set_force(work, shear_alone);
    const Line line = work.run({7, 8})[0];
    const double share = number(line, "flat_area_mm2") / 50;
    CHECK(number(line, "tangential_force_x_n") ==
          Approx(2 * std::sqrt(share) * number(line, "shift_x_mm")).margin(1e-4));
    CHECK(number(line, "tangential_force_y_n") ==
          Approx(2 * std::sqrt(share) * number(line, "shift_y_mm")).margin(1e-4));
    CHECK(number(line, "moment_z_nm") ==
          Approx(0.3 * share * number(line, "shift_rad")).margin(2e-6));
    CHECK(line.at("normal_force_n").empty());
  }
}

TEST_CASE("replay: curves that cannot be are refused with what is wrong", "[look-up]") {
  const Workplace work;
  const auto says = [&](const std::string& force, const std::string& words) {
    set_force(work, force);
    const std::string line = work.complaint();
    INFO(line);
    CHECK(line.find("sensor.json: " + words) != std::string::npos);
    CHECK(line.find('\n') == std::string::npos);
    CHECK_FALSE(fs::exists(work.out()));
  };
  const auto changed = [](std::string text, const std::string& old, const std::string& with) {
    REQUIRE(text.find(old) != std::string::npos);
    return text.replace(text.find(old), old.size(), with);
  };
  says("{}", "force: contains no curve (known keys: by_area, by_depth, shear)");
  says("3", "force is a number, must be an object");
  says(R"({"by_volume": {}})", "unknown key force.by_volume (known keys: by_area, by_depth,");
  says(changed(by_depth_alone, "to_mm", "to_mm2"), "unknown key force.by_depth.to_mm2");
  says(changed(by_area_alone, "to_mm2", "to_mm"), "unknown key force.by_area.to_mm");
  says(R"({"by_depth": {"from_mm": 0.1, "to_mm": 3.5}})",
       "force.by_depth.coefficients is missing (normal force in N,");
  says(R"({"by_depth": {"coefficients": [0, 1], "from_mm": 0.1}})",
       "force.by_depth.to_mm is missing (the largest contact of the calibration)");
  says(changed(by_depth_alone, "[0, 1, 0.5]", "[]"),
       "force.by_depth.coefficients is [] (an array), must be 1 to 4 numbers");
  says(changed(by_depth_alone, "[0, 1, 0.5]", "[0, 1, 2, 3, 4]"),
       "force.by_depth.coefficients is [0,1,2,3,4] (an array), must be 1 to 4 numbers");
  says(changed(by_depth_alone, "[0, 1, 0.5]", "[0, \"1\"]"), "force.by_depth.coefficients is [0,");
  says(changed(by_depth_alone, "[0, 1, 0.5]", "[0, 1, -0.5]"),
       "force.by_depth: ForceCurve: slope within the range = -");
  says(changed(by_depth_alone, "3.5", "0.1"), "force.by_depth: ForceCurve: to = 0.1, must be");
  says(changed(by_depth_alone, "3.5", "3.5, \"residual_n\": 0"),
       "force.by_depth.residual_n = 0, must be > 0");
  const std::string both =
      changed(by_area_alone, "}}", "},") + std::string(by_depth_alone).substr(1);
  says(both, "force.by_area.residual_n is missing (standard deviation of the residual, N; by_area");
  says(changed(both, "340", "340, \"residual_n\": 0.1"), "force.by_depth.residual_n is missing");
  says(changed(shear_alone, "\"area\"", "\"volume\""),
       "force.shear.by is \"volume\" (a string), must be \"area\" or \"depth\"");
  says(changed(shear_alone, "\"area\"", "7"), "force.shear.by is 7 (a number), must be");
  says(changed(shear_alone, "\"to_mm\": 9,", ""), "force.shear.to_mm is missing (the largest");
  says(changed(shear_alone, "\"reference\": 50", "\"reference\": 0"),
       "force.shear: ShearMap: reference = 0, must be finite and > 0");
  says(changed(shear_alone, "[2]", "[-2]"), "force.shear: ShearMap: force: slope = -2, must be");
  says(changed(shear_alone, "[300]", "[300, 10]"),
       "force.shear.moment_n_mm_per_rad is [300,10] (an array), must be one number");
  // curves alone do not give a recording of dots a depth
  work.write("sensor.json", std::string("{\"force\": ") + by_depth_alone + "}");
  CHECK(work.complaint().find("sensor.json: camera is missing") != std::string::npos);
}

TEST_CASE("replay: true forces are read, or refused with the line", "[look-up]") {
  const Workplace work;
  const fs::path file = work.recording() / "forces.csv";
  const std::string header = "frame,force_x_n,force_y_n,force_z_n,moment_z_nm\n";
  work.write("forces.csv", header + "3,1,-2,-3.5,0.004\n");
  const auto forces = replay::read_true_forces(file, 11);
  REQUIRE(forces.size() == 1);
  CHECK(forces.at(3).force_n.y == -2);
  CHECK(forces.at(3).force_n.z == -3.5);
  CHECK(forces.at(3).moment_n_mm == Approx(4));
  const auto says = [&](const std::string& text, const std::string& words) {
    work.write("forces.csv", text);
    const std::string line = work.complaint();
    INFO(line);
    CHECK(line.find("forces.csv: " + words) != std::string::npos);
  };
  says("", "is empty");
  says("frame,fx\n", "line 1: must be frame,force_x_n,force_y_n,force_z_n,moment_z_nm");
  says(header + "0,0,0,0\n", "line 2: has 4 values, must have 5");
  says(header + "0,0,0,much,0\n", "line 2: force_z_n 'much' is not a number");
  says(header + "11,0,0,0,0\n", "line 2: frame '11' is not one of the frames 0 to 10");
  says(header + "1,0,0,0,0\n1,0,0,0,0\n", "line 3: frame 1 is given twice");
  fs::remove(file);
  CHECK(replay::read_true_forces(file, 11).empty());
}
