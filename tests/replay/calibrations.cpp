// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Saved calibrations load again bit for bit; invalid files are refused.
#include "calibrate/calibrations.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "calibrate/recordings.hpp"
#include "replay/foam/sensor.hpp"
#include "replay/io/failure.hpp"
#include "support/catch.hpp"
#include "support/inflated_rubber.hpp"

namespace {

namespace fs = std::filesystem;
using calibrate::Outcome;
using calibrate::Report;
using nlohmann::json;

fs::path scratch(const std::string& name) {
  const fs::path file = fs::temp_directory_path() / ("fingerpad_" + name + ".json");
  fs::remove(file);
  return file;
}

std::string said(const fs::path& file, const json& content) {
  std::ofstream(file) << content.dump();
  try {
    (void)calibrate::load_reports(file);
    (void)replay::read_sensor(file);
  } catch (const replay::Failure& failure) {
    return failure.what();
  }
  return "";
}

Outcome camera_and_more() {
  Report report;
  report.what = "absorption";
  report.verdict = calibrate::Verdict::doubtful;
  report.because = "too few presses";
  report.residual = 1.0 / 3;
  report.residual_unit = "grey levels";
  report.parameters = {{"c_red_per_mm", 0.1 / 3, 1e-300}, {"kappa", 2.0 / 3}};
  report.covariance = {{1.0 / 7, -1.0 / 9}, {-1.0 / 9, 1.0 / 11}};
  Outcome outcome;
  outcome.reports = {report};
  outcome.sections = {
      {"camera",
       {{"plate_distance_mm", 50.0 / 3},
        {"refractive_index", 4.0 / 3},
        {"center_px", {100.0 / 3, 100.0 / 7}},
        {"pitch_mm", 0.1 / 3}}},
      {"absorption",
       {{"c_red_per_mm", 0.1 / 3},
        {"c_green_per_mm", 0.1},
        {"kappa", 2.0 / 3},
        {"max_depth_mm", 12}}},
      {"pad", {{"base_radius_mm", 18}, {"apex_height_mm", 40.0 / 3}}},
      {"reference", {{"frame", "a.png"}, {"depth", "b.tiff"}}},
      {"contact", {{"threshold_per_mm", 0.1 / 7}}},
      {"stick", {{"noise_px", 1.0 / 7}}},
      {"rim",
       {{"side_dot_length_mm", 0.8 / 3},
        {"membrane_modulus_n_per_mm", 1.0 / 3},
        {"mooney_share", 0.1 / 3}}},
      {"neighbour_light", {{"radius_px", 3}, {"m0_mm_per_rad", 1e-3 / 3}, {"n_per_mm", 0.1 / 3}}},
      {"smoothing_px", 15},
      {"force",
       {{"by_area",
         {{"coefficients", {0, 0.1 / 3}},
          {"from_mm2", 1.0 / 3},
          {"to_mm2", 500.0 / 3},
          {"residual_n", 0.1 / 3},
          {"covariance", {{1.0 / 3, -1.0 / 7}, {-1.0 / 7, 1.0 / 9}}}}},
        {"by_depth",
         {{"coefficients", {0, 2.0 / 3}},
          {"from_mm", 0.1 / 3},
          {"to_mm", 10.0 / 3},
          {"residual_n", 0.1 / 7}}},
        {"shear",
         {{"by", "depth"},
          {"reference", 2},
          {"displacement_exponent", 1.0 / 3},
          {"force_n_per_mm", {7.0 / 3}},
          {"to_mm", 4.0 / 3},
          {"rotation_exponent", 5.0 / 3},
          {"moment_n_mm_per_rad", {1000.0 / 3}},
          {"to_rad", 0.1 / 3}}}}}};
  return outcome;
}

}  // namespace

TEST_CASE("A calibration that was saved is loaded bit for bit", "[calibrate]") {
  const fs::path file = scratch("round_trip");
  const Outcome outcome = camera_and_more();
  save(outcome, file);
  save(outcome, file);  // again: no duplicates
  const auto reports = calibrate::load_reports(file);
  REQUIRE(reports.size() == 1);
  const Report &there = reports.front(), &here = outcome.reports.front();
  CHECK(there.what == here.what);
  CHECK(there.verdict == here.verdict);
  CHECK(there.because == here.because);
  CHECK(there.residual == here.residual);
  CHECK(there.residual_unit == here.residual_unit);
  REQUIRE(there.parameters.size() == 2);
  CHECK(there.parameters[0].value == here.parameters[0].value);
  CHECK(there.parameters[0].standard_error == here.parameters[0].standard_error);
  CHECK(std::isnan(there.parameters[1].standard_error));
  CHECK(there.covariance == here.covariance);

  const replay::Sensor sensor = replay::read_sensor(file);
  CHECK(sensor.camera.plate_distance_mm == 50.0 / 3);
  CHECK(sensor.camera.center_y_px == 100.0 / 7);
  CHECK(sensor.camera.pitch_mm == 0.1 / 3);
  CHECK(sensor.absorption.c_red_per_mm == 0.1 / 3);
  CHECK(sensor.pad.apex_height_mm == 40.0 / 3);
  CHECK(sensor.contact_threshold_per_mm == 0.1 / 7);
  CHECK(sensor.stick.noise == 1.0 / 7);
  CHECK(sensor.rim->membrane_modulus_n_per_mm == 1.0 / 3);
  CHECK(sensor.rim->mooney_share == 0.1 / 3);
  CHECK(sensor.neighbour_light->m0_mm_per_rad == 1e-3 / 3);
  CHECK(sensor.smoothing_px == 15);
  REQUIRE(sensor.force);
  CHECK(sensor.force->by_area->coefficients[1] == 0.1 / 3);
  CHECK(sensor.force->by_area->to == 500.0 / 3);
  const auto& errors = *sensor.force->by_area;
  CHECK(errors.residual_sd_n == 0.1 / 3);
  CHECK(errors.covariance[0][0] == 1.0 / 3);
  CHECK(errors.covariance[0][1] == -1.0 / 7);
  CHECK(errors.covariance[1][1] == 1.0 / 9);
  CHECK(errors.covariance[2][2] == 0);
  CHECK(sensor.force->by_depth->from == 0.1 / 3);
  CHECK(sensor.force->shear->by == replay::ContactMeasure::depth);
  CHECK(sensor.force->shear->map.force.exponent == 1.0 / 3);
  CHECK(sensor.force->shear->map.moment.coefficients[0] == 1000.0 / 3);
  CHECK(sensor.force->shear->map.moment.to == 0.1 / 3);

  const fs::path foam = scratch("foam_round_trip");
  Outcome taxels;
  taxels.sections = {{"foam", {{"noise", 10.0 / 3}}}};
  save(taxels, foam);
  CHECK(replay::read_foam_sensor(foam).noise == 10.0 / 3);
}

TEST_CASE("The rubber that calibrate finds is the one that a recording is read with",
          "[calibrate]") {
  test::InflatedRubber pad{.mooney_share = 0.3};
  const fs::path folder = fs::temp_directory_path() / "fingerpad_rubber";
  fs::create_directories(folder);
  std::ofstream signals(folder / "signals.csv"), dots(folder / "side_dots.csv"),
      apexes(folder / "apex.csv");
  signals << "frame,time_s,pressure_mpa\n";
  dots << "frame,index,border_x,border_y,border_z,dot_x,dot_y,dot_z\n" << std::fixed;
  apexes << "frame,apex_mm\n" << std::fixed;
  for (int frame = 0; frame < 3; ++frame) {
    pad.pressure_mpa = 0.008 * (frame + 1);
    const auto profile = pad.profile();
    const auto dot = test::InflatedRubber::near_rim(profile, 0.8);
    signals << frame << ',' << frame << ',' << pad.pressure_mpa << '\n';
    apexes << frame << ',' << profile.front().z << '\n';
    for (int k = 0; k < 12; ++k) {
      const double c = std::cos(k * CV_PI / 6), s = std::sin(k * CV_PI / 6);
      dots << frame << ',' << k << ',' << pad.radius_mm * c << ',' << pad.radius_mm * s << ",0,"
           << dot.r * c << ',' << dot.r * s << ',' << dot.z << '\n';
    }
  }
  signals.close(), dots.close(), apexes.close();

  calibrate::RimNoise noise;
  noise.base_radius_mm = pad.radius_mm;
  noise.inclination_rad = 2 * std::atan(pad.height_mm / pad.radius_mm);
  CHECK_FALSE(calibrate::rim(folder, noise).sections["rim"].contains("mooney_share"));
  noise.stress_free_height_mm = pad.height_mm;
  Outcome found = calibrate::rim(folder, noise);
  const double share = found.sections["rim"]["mooney_share"];
  CHECK(share == Approx(0.3).margin(0.034));
  CHECK(found.sections["rim"]["membrane_modulus_n_per_mm"] == Approx(0.5).epsilon(0.005));

  const fs::path file = scratch("rubber");
  Outcome whole = camera_and_more();
  whole.sections["rim"] = found.sections["rim"];
  save(whole, file);
  CHECK(replay::read_sensor(file).rim->mooney_share == share);
  fs::remove(folder / "apex.csv");
  CHECK_THROWS_AS(calibrate::rim(folder, noise), replay::Failure);
  fs::remove_all(folder);
}

TEST_CASE("Forces are looked up with the errors that calibrate found", "[calibrate]") {
  const fs::path table = fs::temp_directory_path() / "fingerpad_contacts.csv";
  std::ofstream contacts(table);
  contacts << "flat_area_mm2,contact_depth_mm,force_x_n,force_y_n,force_z_n,moment_z_nm\n";
  for (int k = 1; k <= 12; ++k) {
    const double noise_n = 0.01 * std::cos(5 * k);
    contacts << 10 * k << ',' << 0.2 * k << ",0,0," << -0.2 * k - noise_n << ",0\n";
  }
  contacts.close();
  const Outcome found = calibrate::force(table, {});
  Outcome whole = camera_and_more();
  whole.sections["force"] = found.sections["force"];
  const fs::path file = scratch("force_errors");
  save(whole, file);
  const auto loaded = *replay::read_sensor(file).force->by_area;
  const auto& expected = found.reports.front().covariance;
  REQUIRE(expected.size() == 4);
  CHECK(expected[3][3] > 0);
  CHECK(loaded.residual_sd_n == found.reports.front().residual);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& row = loaded.covariance[k];
    CHECK(std::equal(expected[k].begin(), expected[k].end(), row.begin()));
  }
  fs::remove(table);
}

TEST_CASE("A sensor file with unknown keys or of another version is refused", "[calibrate]") {
  const fs::path file = scratch("refused");
  save(camera_and_more(), file);
  std::ifstream stream(file);
  const json good = json::parse(stream);
  CHECK(said(file, good).empty());
  const auto with = [&](const std::string& place, const json& value) {
    json bad = good;
    bad[json::json_pointer(place)] = value;
    return said(file, bad);
  };
  CHECK(with("/version", 2).find("version = 2") != std::string::npos);
  CHECK(with("/camera/pich_mm", 1).find("unknown key camera.pich_mm") != std::string::npos);
  CHECK(with("/calibration/absorption/residuals", 1).find("residuals") != std::string::npos);
  CHECK(with("/calibration/absorption/parameters/kappa", 1).find("[value") != std::string::npos);
  CHECK(with("/calibration/absorption/covariance", "x").find("rows of") != std::string::npos);
  CHECK(with("/force/by_area/slope", 1).find("unknown key force.by_area.slope") !=
        std::string::npos);
  CHECK(with("/force/by_area/covariance/1", json::array({1})).find("2 rows of 2 numbers") !=
        std::string::npos);
  CHECK(with("/force/by_area/covariance/1/1", -1).find("variance of a coefficient = -1") !=
        std::string::npos);
  CHECK(with("/stick/slip_mm", 1).find("unknown key stick.slip_mm") != std::string::npos);
  CHECK(with("/rim/lenght_mm", 1).find("unknown key rim.lenght_mm") != std::string::npos);
  CHECK(with("/rim/mooney_share", 2).find("mooney_share = 2") != std::string::npos);
  CHECK(with("/contact/threshold_per_mm", -1).find("must be > 0") != std::string::npos);
}

TEST_CASE("Rays meet a cap and a ball where these are", "[calibrate]") {
  const fingerpad::Camera<double> camera{50, 1.33, 40, 30, 0.3};
  const calibrate::Sphere pad = calibrate::cap(18, 12);
  CHECK(calibrate::depth_on(camera, 30, 40, pad, true) == Approx(12));
  const calibrate::Sphere ball{{2, -1, 7 + 10}, 10};
  for (const int row : {20, 30, 44}) {
    for (const bool far : {false, true}) {
      const calibrate::Sphere& sphere = far ? pad : ball;
      const double depth = calibrate::depth_on(camera, row, 43, sphere, far);
      const auto at = point_at(camera, double(row), 43.0, depth);
      CHECK(norm(at - sphere.center_mm) == Approx(sphere.radius_mm).epsilon(1e-12));
    }
  }
  CHECK(calibrate::depth_on(camera, 30, 40, ball, false) < 12);
  CHECK(std::isnan(calibrate::depth_on(camera, 300, 400, ball, false)));  // the ray misses the ball
}
