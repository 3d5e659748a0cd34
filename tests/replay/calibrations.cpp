// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Saved calibrations load again bit for bit; invalid files are refused.
#include "calibrate/calibrations.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "calibrate/geometry.hpp"
#include "calibrate/recordings.hpp"
#include "common/failure.hpp"
#include "replay/foam/sensor.hpp"
#include "support/catch.hpp"
#include "support/inflated_rubber.hpp"
#include "support/pad.hpp"

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
      {"contact",
       {{"threshold_per_mm", 0.1 / 7},
        {"faint_per_mm", 0.2 / 7},
        {"ring_px", 100.0 / 3},
        {"depth_noise_mm", 0.1 / 3}}},
      {"stick", {{"noise_px", 1.0 / 7}}},
      {"rim",
       {{"membrane_modulus_n_per_mm", 1.0 / 3},
        {"mooney_share", 0.1 / 3},
        {"membrane_thickness_mm", 1.0 / 3},
        {"full_scale_n", 100.0 / 3}}},
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
  std::ifstream kept_in(file);
  const json kept = json::parse(kept_in).at("calibration");
  REQUIRE(kept.size() == 1);
  const json& there = kept.at("absorption");
  const Report& here = outcome.reports.front();
  CHECK(there == to_json(here));
  CHECK(there.at("verdict") == "doubtful");
  CHECK(there.at("because") == here.because);
  CHECK(there.at("residual") == here.residual);
  CHECK(there.at("residual_unit") == here.residual_unit);
  REQUIRE(there.at("parameters").size() == 2);
  CHECK(there.at("parameters").at("c_red_per_mm") == json{0.1 / 3, 1e-300});
  CHECK(there.at("parameters").at("kappa").at(1).is_null());
  CHECK(there.at("covariance") == here.covariance);

  const replay::Sensor sensor = replay::read_sensor(file);
  CHECK(sensor.camera.plate_distance_mm == 50.0 / 3);
  CHECK(sensor.camera.center_y_px == 100.0 / 7);
  CHECK(sensor.camera.pitch_mm == 0.1 / 3);
  CHECK(sensor.absorption.c_red_per_mm == 0.1 / 3);
  CHECK(sensor.pad.apex_height_mm == 40.0 / 3);
  REQUIRE(sensor.contact);
  CHECK(sensor.contact->threshold_per_mm == 0.1 / 7);
  CHECK(sensor.contact->faint_per_mm == 0.2 / 7);
  CHECK(sensor.contact->ring_px == 100.0 / 3);
  CHECK(sensor.contact->depth_noise_mm == 0.1 / 3);
  CHECK(sensor.stick.noise == 1.0 / 7);
  CHECK(sensor.rim->membrane_modulus_n_per_mm == 1.0 / 3);
  CHECK(sensor.rim->mooney_share == 0.1 / 3);
  CHECK(sensor.rim->membrane_thickness_mm == 1.0 / 3);
  CHECK(sensor.rim->full_scale_n == 100.0 / 3);
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
  CHECK(sensor.force->shear->map.moment.slope == 1000.0 / 3);
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
  std::ofstream signals(folder / "signals.csv"), apexes(folder / "apex.csv");
  signals << "frame,time_s,pressure_mpa\n";
  apexes << "frame,apex_mm\n" << std::fixed;
  for (int frame = 0; frame < 4; ++frame) {
    pad.pressure_mpa = 0.008 + 0.004 * frame;
    const auto profile = pad.profile();
    signals << frame << ',' << frame << ',' << pad.pressure_mpa << '\n';
    apexes << frame << ',' << profile.front().z << '\n';
  }
  signals.close(), apexes.close();

  calibrate::RimNoise noise;
  noise.base_radius_mm = pad.radius_mm;
  noise.stress_free_height_mm = pad.height_mm;
  CHECK_FALSE(calibrate::rim(folder, noise).sections["rim"].contains("mooney_share"));
  noise.height_sd_mm = 0.02;
  noise.apex_noise_mm = 0.001;
  noise.finds_rubber = true;
  Outcome found = calibrate::rim(folder, noise);
  const double share = found.sections["rim"]["mooney_share"];
  CHECK(share == Approx(0.3).margin(0.034));
  CHECK(found.sections["rim"]["membrane_modulus_n_per_mm"] == Approx(0.5).epsilon(0.005));

  // a pressed pad has more pressure and a lower apex: it is left out, and told
  std::ofstream(folder / "signals.csv", std::ios::app) << "4,4,0.021\n";
  std::ofstream(folder / "apex.csv", std::ios::app) << "4,11.5\n";
  const Outcome pressed = calibrate::rim(folder, noise);
  CHECK(pressed.sections.at("rim") == found.sections["rim"]);
  CHECK(pressed.reports.front().verdict == calibrate::Verdict::doubtful);
  CHECK(pressed.reports.front().because.find("left out (1)") != std::string::npos);

  const fs::path file = scratch("rubber");
  Outcome whole = camera_and_more();
  whole.sections["rim"] = found.sections["rim"];
  save(whole, file);
  CHECK(replay::read_sensor(file).rim->mooney_share == share);
  CHECK(replay::read_sensor(file).rim->membrane_modulus_sd_n_per_mm ==
        found.sections["rim"]["membrane_modulus_sd_n_per_mm"].get<double>());
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
  CHECK(with("/camera/pitch_mm", {0.1, 0.1, 0.1}).find("two numbers") != std::string::npos);
  CHECK(with("/camera/pitch_mm", {0.1, -0.1}).find("pixel_aspect = -1") != std::string::npos);
  CHECK(with("/camera/distortion", {0.1, 0, 0.01}).find("p1") != std::string::npos);
  CHECK(with("/camera/distortion", {0.1, 0, 0, 0, 0}).empty());
  CHECK(with("/camera/mosaic", "rgbg").find("\"rggb\" or \"bggr\"") != std::string::npos);
  CHECK(with("/camera/response", "gamma").find("\"linear\" or \"srgb\"") != std::string::npos);
  std::vector<double> curve(256, 1);
  CHECK(with("/camera/response", curve).empty());
  curve[3] = 0;
  CHECK(with("/camera/response", curve).find("256 values that grow") != std::string::npos);
  CHECK(with("/camera/response", {0, 1}).find("256 values that grow") != std::string::npos);
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

TEST_CASE("Rays meet a ball where it is", "[calibrate]") {
  const fingerpad::Camera<double> camera{50, 1.33, 40, 30, 0.3};
  const calibrate::Sphere ball{{2, -1, 7 + 10}, 10};
  for (const int row : {20, 30, 44}) {
    const double depth = calibrate::depth_on(camera, row, 43, ball);
    const auto at = point_at(camera, double(row), 43.0, depth);
    CHECK(norm(at - ball.center_mm) == Approx(ball.radius_mm).epsilon(1e-12));
    CHECK(depth < ball.center_mm.z);  // on its lower half
  }
  CHECK(std::isnan(calibrate::depth_on(camera, 300, 400, ball)));  // the ray misses it
}

namespace {

/// Where a camera in air sees a target of 9 x 9 dots, 3 mm apart, that is turned, shifted, tilted
/// about y, and raised.
std::vector<calibrate::PlateDot> target(const fingerpad::Camera<double>& camera,
                                        double raised_mm,
                                        double turn,
                                        double shift_mm,
                                        double tilt = 0,
                                        double noise_px = 0) {
  test::Random random(7);
  std::vector<calibrate::PlateDot> dots;
  for (int k = 0; k < 81; ++k) {
    const double u = 3.0 * (k % 9 - 4), v = 3.0 * (k / 9 - 4);
    const double x = u * std::cos(turn) - v * std::sin(turn) + shift_mm;
    const double y = u * std::sin(turn) + v * std::cos(turn) - 2 * shift_mm;
    const double away = camera.plate_distance_mm + raised_mm + x * std::sin(tilt);
    auto pixel = pixel_at_tangents(camera, {x * std::cos(tilt) / away, y / away});
    pixel.x += noise_px * random.normal();
    pixel.y += noise_px * random.normal();
    dots.push_back({{u, v}, pixel});
  }
  return dots;
}

}  // namespace

TEST_CASE("The camera of two pictures of a target is found", "[calibrate]") {
  fingerpad::Camera<double> lens;
  lens.plate_distance_mm = 47;
  lens.center_x_px = 322.3;
  lens.center_y_px = 237.1;
  lens.pixel_aspect = 1.02;
  lens.distortion_k1 = -0.12;
  const auto of = [](const auto& camera, double tilt, double noise_px) {
    return calibrate::fit_camera(target(camera, 0, 0.03, 0, tilt, noise_px),
                                 target(camera, 10, -0.02, 0.1, tilt, noise_px), 10, 0);
  };
  const auto exact = of(lens, 0, 0);
  CHECK(exact.camera.plate_distance_mm == Approx(47).epsilon(1e-9));
  CHECK(exact.camera.pitch_mm == Approx(0.08).epsilon(1e-9));
  CHECK(exact.camera.pixel_aspect == Approx(1.02).epsilon(1e-9));
  CHECK(exact.camera.center_x_px == Approx(322.3).epsilon(1e-9));
  CHECK(exact.camera.center_y_px == Approx(237.1).epsilon(1e-9));
  CHECK(exact.camera.distortion_k1 == Approx(-0.12).epsilon(1e-9));
  CHECK(exact.moved_mm == Approx(std::hypot(0.1, 0.2)).epsilon(1e-6));
  CHECK(exact.residual_px < 1e-9);
  // with noise, within its standard deviations; what is not there is not fitted
  const auto noisy = of(lens, 0, 0.05);
  CHECK(noisy.residual_px == Approx(0.05).epsilon(0.2));
  CHECK(std::abs(noisy.camera.plate_distance_mm - 47) < 4 * noisy.distance_sd_mm);
  CHECK(std::abs(noisy.camera.distortion_k1 + 0.12) < 4 * noisy.k1_sd);
  CHECK(std::abs(noisy.camera.pixel_aspect - 1.02) < 4 * noisy.aspect_sd);
  CHECK((noisy.distance_sd_mm < 0.1 && noisy.k1_sd < 0.005 && noisy.aspect_sd < 1e-3));
  const auto pinhole = of(fingerpad::Camera<double>(), 0, 0.05);
  CHECK(pinhole.camera.pixel_aspect == 1);
  CHECK(pinhole.camera.distortion_k1 == 0);
  // one picture has no distance
  const auto one = calibrate::fit_camera(target(lens, 0, 0.03, 0), {}, 0, 47);
  CHECK(one.camera.plate_distance_mm == 47);
  CHECK(one.camera.distortion_k1 == Approx(-0.12).epsilon(1e-9));
  CHECK(std::isnan(one.distance_sd_mm));
  // a camera that looks at the target askew shows in the residual
  CHECK(of(lens, 0.02, 0).residual_px > 0.2);
}

TEST_CASE("What a camera does to light is undone where its pictures are read", "[calibrate]") {
  // sRGB, at the values of 8 bit and between them
  const replay::PictureFormat srgb{replay::srgb_response(), ""};
  cv::Mat_<cv::Vec3b> stored(1, 256);
  for (int k = 0; k < 256; ++k) {
    stored(0, k) = cv::Vec3b::all(static_cast<uchar>(k));
  }
  const cv::Mat_<cv::Vec3w> light = replay::linear_colours(stored, srgb, "x");
  CHECK(light(0, 0)[1] == 0);
  CHECK(light(0, 10)[1] == std::lround(256 * 255 * 10 / 255.0 / 12.92));
  CHECK(light(0, 188)[1] / 256.0 == Approx(255 * 0.5029).epsilon(1e-3));
  CHECK(light(0, 255)[2] == 255 * 256);
  const cv::Mat_<cv::Vec3w> between(1, 1, cv::Vec3w::all(100 * 256 + 128));
  const cv::Mat_<cv::Vec3w> half = replay::linear_colours(between, srgb, "x");
  CHECK(std::abs(half(0, 0)[0] - (light(0, 100)[0] + light(0, 101)[0]) / 2) <= 1);
  CHECK(cv::norm(replay::linear_colours(stored, {}, "x"), stored, cv::NORM_INF) == 0);
  // a mosaic: its own colours stay, and a ramp is found between them
  const auto ramp = [](int i, int j, int c) { return 40 + 20 * c + 2 * i + 3 * j; };
  for (const char* mosaic : {"rggb", "bggr", "grbg", "gbrg"}) {
    cv::Mat_<uchar> raw(12, 16);
    for (int i = 0; i < raw.rows; ++i) {
      for (int j = 0; j < raw.cols; ++j) {
        const char colour = mosaic[2 * (i % 2) + j % 2];
        raw(i, j) = static_cast<uchar>(ramp(i, j, colour == 'b' ? 0 : colour == 'g' ? 1 : 2));
      }
    }
    const cv::Mat_<cv::Vec3w> colours = replay::linear_colours(raw, {{}, mosaic}, "x");
    for (int i = 2; i < raw.rows - 2; ++i) {
      for (int j = 2; j < raw.cols - 2; ++j) {
        for (int c = 0; c < 3; ++c) {
          CHECK(colours(i, j)[c] == 256 * ramp(i, j, c));
        }
      }
    }
  }
  CHECK_THROWS_AS(replay::linear_colours(stored, {{}, "rggb"}, "x"), replay::Failure);
  CHECK_THROWS_AS(replay::linear_colours(cv::Mat_<uchar>(4, 4), {}, "x"), replay::Failure);
}

TEST_CASE("A sensor file tells lens, pixels and light of a camera", "[calibrate]") {
  const fs::path file = scratch("lens");
  Outcome outcome = camera_and_more();
  outcome.sections["camera"]["pitch_mm"] = {0.08, 0.0816};
  outcome.sections["camera"]["distortion"] = {-0.12, 0.02};
  outcome.sections["camera"]["response"] = "srgb";
  outcome.sections["camera"]["mosaic"] = "gbrg";
  save(outcome, file);
  const replay::Sensor sensor = replay::read_sensor(file);
  CHECK(sensor.camera.pitch_mm == 0.08);
  CHECK(sensor.camera.pixel_aspect == Approx(1.02));
  CHECK(sensor.camera.distortion_k1 == -0.12);
  CHECK(sensor.camera.distortion_k2 == 0.02);
  CHECK(sensor.pictures.response == replay::srgb_response());
  CHECK(sensor.pictures.mosaic == "gbrg");
}
