// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A finger of one's own, from pictures to depth: a pad of rubber under a lamp that falls to one
// side, with a spot and colour across.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "calibrate/calibrations.hpp"
#include "calibrate/shape.hpp"
#include "calibrate/today.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/recording.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/membrane/free_pad.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/pad.hpp"

namespace {

namespace fs = std::filesystem;
using calibrate::DepthMap;
using fingerpad::Camera;
using fingerpad::Point3;

const Camera<double> camera{50, 1.33, 79.6, 79.1, 0.25};
const fingerpad::Absorption<double> fluid{0.029, 0.0336, 0.9924, 18};
constexpr double base_mm = 18.7, ball_mm = 10;
constexpr int size_px = 160;

const calibrate::Meridian& true_meridian() {
  static const auto meridian = fingerpad::FreePad<double>({base_mm, 11, 0.1}).meridian(0.016 / 0.5);
  return meridian;
}

/// The lowest point of the ball that just touches the pad at this distance from the axis.
double touch_mm(double rho_mm) {
  double highest = 0;
  for (const auto& p : true_meridian()) {
    const double beside = p.x - rho_mm;
    if (std::abs(beside) < ball_mm) {
      highest = std::fmax(highest, p.y + std::sqrt(ball_mm * ball_mm - beside * beside));
    }
  }
  return highest - ball_mm;
}

/// 16-bit picture of a membrane at these depths; the noise is that of the mean of 16 frames. The
/// plate of a pad with dots, 3 mm apart, may reflect a spot of light.
cv::Mat picture(const DepthMap& depth_mm,
                test::Random& random,
                double noise = 0.25,
                double glare = 0) {
  cv::Mat_<cv::Vec3w> image(depth_mm.size());
  for (int i = 0; i < image.rows; ++i) {
    for (int j = 0; j < image.cols; ++j) {
      const auto l = static_cast<double>(depth_mm(i, j));
      const auto at = point_at(camera, double(i), double(j), 0.0);
      const double x = at.x / 20, y = at.y / 20;
      const double spot = std::exp(-((x - 0.3) * (x - 0.3) + (y + 0.2) * (y + 0.2)) / 0.5);
      const double off = std::hypot(std::remainder(at.x, 3), std::remainder(at.y, 3));
      const double dot = glare > 0 ? 1 - 0.5 / (1 + std::exp((off - 0.4) / 0.1)) : 1;
      const double lamp = 1 + 0.08 * x - 0.06 * y + 0.06 * spot;
      const auto light = ray_at_pixel(camera, double(i), double(j));
      const auto c = std::isfinite(l) ? colour_at_depth(fluid, light, 180 * dot, 0.05, l)
                                      : fingerpad::Colour<double>{5, 5};
      const double more = glare * std::exp(-2 * ((at.x - 4) * (at.x - 4) + at.y * at.y));
      const auto stored = [&](double level) {
        return cv::saturate_cast<ushort>(256 * (level + more + noise * random.normal()));
      };
      image(i, j) = {stored(5), stored(c.green * lamp), stored(c.red * lamp / (1 + 0.02 * x))};
    }
  }
  return image;
}

/// The pad with a ball or a plate pressed into it.
DepthMap pressed(const DepthMap& free_mm, const calibrate::Sphere& ball) {
  DepthMap depth = free_mm.clone();
  for (int i = 0; i < depth.rows; ++i) {
    for (int j = 0; j < depth.cols; ++j) {
      const auto on = static_cast<float>(calibrate::depth_on(camera, i, j, ball));
      depth(i, j) = on < depth(i, j) ? on : depth(i, j);
    }
  }
  return depth;
}

/// Writes what a person records; one press may lie `aside_mm` from where it is written down.
void record(const fs::path& folder, double aside_mm, double glare = 0) {
  test::Random random(3);
  fs::create_directories(folder / "free");
  fs::create_directories(folder / "frames");
  const DepthMap free_mm = calibrate::depth_of_shape(camera, {size_px, size_px}, true_meridian());
  replay::write_png(folder / "reference.png", picture(free_mm, random, 0.25, glare));
  std::ofstream touches(folder / "touches.csv");
  touches << "x_mm,y_mm,z_mm\n0,0," << touch_mm(0) + 0.01 * random.normal() << "\n";
  for (int k = 0; k < 24; ++k) {
    const double rho = base_mm * (0.3 + 0.3 * (k % 3)), angle = 2.1 * k;
    touches << rho * std::cos(angle) << "," << rho * std::sin(angle) << ","
            << touch_mm(rho) + 0.01 * random.normal() << "\n";
  }
  std::ofstream presses(folder / "presses.csv");
  presses << "frame,x_mm,y_mm,z_mm,radius_mm\n";
  const double places[][4] = {{0, 0, 9, 12},  {0, 0, 5, 12},  {6, 0, 7, 12},
                              {-4, 5, 6, 12}, {0, -7, 4, 12}, {0, 0, 10, 1e6}};
  int frame = 0;
  for (const auto& [x, y, z, radius] : places) {
    const double moved = frame == 2 ? aside_mm : 0;
    const auto depth = pressed(free_mm, {{x + moved, y, z + radius}, radius});
    replay::write_png(folder / "frames" / (std::to_string(frame) + ".png"),
                      picture(depth, random, 0.25, glare));
    presses << frame++ << "," << x << "," << y << "," << z << "," << radius << "\n";
  }
  std::ofstream(folder / "sensor.json")
      << R"({"camera": {"plate_distance_mm": 50, "refractive_index": 1.33,)"
      << R"( "center_px": [79.6, 79.1], "pitch_mm": 0.25}})";
}

/// A target of 9 x 9 dots of 1 mm, 3 mm apart, its middle `raised_mm` above the plate in air,
/// tilted about an axis at `angle` to x.
cv::Mat target(double raised_mm, double tilt = 0, double angle = 0) {
  cv::Mat_<cv::Vec3w> image(size_px, size_px);
  const double far = camera.plate_distance_mm + raised_mm, c = std::cos(angle), s = std::sin(angle);
  const auto off = [](double x) { return x - 3 * std::clamp(std::round(x / 3), -4.0, 4.0); };
  for (int i = 0; i < image.rows; ++i) {
    for (int j = 0; j < image.cols; ++j) {
      const auto ray = 1 / camera.plate_distance_mm * point_at(camera, double(i), double(j), 0.0);
      const double up = c * ray.y - s * ray.x;  // across the axis, per mm of distance
      const double meets = far / (1 - up * std::tan(tilt));
      const double along = meets * (c * ray.x + s * ray.y);
      const double across = meets * up / std::cos(tilt);
      const double x = c * along - s * across, y = s * along + c * across;
      const double dark = 1 / (1 + std::exp((std::hypot(off(x), off(y)) - 0.5) / 0.05));
      const auto level = cv::saturate_cast<ushort>(256 * 170 * (1 - 0.8 * dark));
      image(i, j) = {level, level, level};
    }
  }
  return image;
}

calibrate::Report calibrated(const fs::path& folder) {
  const fs::path sensor = folder / "sensor.json";
  save(calibrate::shape(folder, sensor, {base_mm, 0, ball_mm, 0, false}), sensor);
  const auto outcome = calibrate::absorption(folder, sensor);
  save(outcome, sensor);
  return outcome.reports.front();
}

}  // namespace

TEST_CASE("a finger of one's own: depth from pictures under an uneven lamp", "[own]") {
  const test::ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  record(folder, 0);
  const auto report = calibrated(folder);
  INFO(report.because);
  CHECK(report.verdict == calibrate::Verdict::good);
  const replay::Sensor sensor = replay::read_sensor(folder / "sensor.json");
  REQUIRE(sensor.light.has_value());

  const DepthMap free_mm = calibrate::depth_of_shape(camera, {size_px, size_px}, true_meridian());
  const DepthMap known_mm = replay::read_depth_image(folder / "reference_depth.tiff");
  const cv::Mat free = replay::read_colour_image(folder / "reference.png");
  const auto reference = fingerpad::fit_reference(
      sensor.camera, sensor.absorption, fingerpad::channel<std::uint16_t>(free, 2),
      fingerpad::channel<std::uint16_t>(free, 1), known_mm, &*sensor.light);
  fingerpad::DepthEstimator<float> estimate(sensor.camera, sensor.absorption, reference,
                                            {.window_px = 1});
  test::Random random(9);
  for (const calibrate::Sphere& ball :
       {calibrate::Sphere{{3, -4, 8 + 15.0}, 15}, calibrate::Sphere{{-5, 0, 6 + 9.0}, 9}}) {
    const DepthMap truth = pressed(free_mm, ball);
    const cv::Mat seen = picture(truth, random, 0);
    DepthMap depth(truth.size());
    const auto result = estimate(fingerpad::channel<std::uint16_t>(seen, 2),
                                 fingerpad::channel<std::uint16_t>(seen, 1), depth);
    CHECK(result.ok());
    double sum = 0, count = 0;
    for (int i = 0; i < depth.rows; ++i) {
      for (int j = 0; j < depth.cols; ++j) {
        const auto at = point_at(camera, double(i), double(j), 0.0);
        if (std::hypot(at.x, at.y) < 14) {
          sum += std::abs(static_cast<double>(depth(i, j) - truth(i, j)));
          count += 1;
        }
      }
    }
    CHECK(sum / count < 0.02);
  }
}

TEST_CASE("a finger of one's own: one command takes all that there is", "[own]") {
  const test::ScratchFolder scratch;
  const fs::path &finger = scratch.path(), pad = finger / "pad";
  fs::create_directories(finger / "plate");
  fs::create_directories(finger / "plate_raised");
  record(pad, 0);
  fs::remove(pad / "sensor.json");
  test::Random random(4);
  for (const char* name : {"0.png", "1.png", "2.png"}) {
    const auto free_mm = calibrate::depth_of_shape(camera, {size_px, size_px}, true_meridian());
    replay::write_png(pad / "free" / name, picture(free_mm, random));
  }
  replay::write_png(finger / "plate/0.png", target(0));
  CHECK_THROWS_AS(calibrate::all(finger), replay::Failure);  // about.json is missing
  std::ofstream(finger / "about.json")
      << R"({"refractive_index": 1.33, "base_radius_mm": 18.7, "touch_ball_radius_mm": 10,)"
      << R"( "side_dots": {"count": 72, "arc_mm": [2, 4], "diameter_mm": 0.5, "first_angle_rad": [0, 1]},)"
      << R"( "target": {"rows": 9, "cols": 9, "pitch_mm": 3, "raised_mm": 10}})";
  CHECK_FALSE(calibrate::all(finger));  // without the raised target there is no camera
  replay::write_png(finger / "plate_raised/0.png", target(10));
  CHECK_FALSE(calibrate::all(finger));  // rim/ is missing, and all else is there
  const replay::Sensor sensor = replay::read_sensor(finger / "sensor.json");
  CHECK(sensor.camera.plate_distance_mm == Approx(50).margin(0.5));
  CHECK(sensor.pad.apex_height_mm == Approx(true_meridian().front().y).margin(0.02));
  CHECK(sensor.light.has_value());
  CHECK(sensor.contact.has_value());
  REQUIRE(sensor.rim->side_rows.size() == 2);
  CHECK(sensor.rim->side_rows[1].arc_mm == 4);
  CHECK(sensor.rim->side_rows[1].first_angle_rad == 1);
  // a recording of its use needs no sensor.json of its own
  const fs::path use = finger / "use";
  fs::create_directories(use / "frames");
  fs::copy_file(pad / "frames/0.png", use / "frames/0.png");
  CHECK_THROWS_AS(replay::open_recording(use), replay::Failure);
  const replay::Recording recording = replay::open_recording(use, finger / "sensor.json");
  CHECK(recording.reference.size() == cv::Size(size_px, size_px));
  CHECK(recording.free_frames.size() == 3);
}

TEST_CASE("a finger of one's own: a press that lies aside is named", "[own]") {
  const test::ScratchFolder scratch;
  record(scratch.path(), 0.5);
  const auto report = calibrated(scratch.path());
  CHECK(report.verdict == calibrate::Verdict::doubtful);
  CHECK(report.because.find("press 2 is not where") != std::string::npos);
}

TEST_CASE("a finger of one's own: compressed and saturated pictures are told", "[own]") {
  const test::ScratchFolder scratch;
  record(scratch.path(), 0, 40);
  const fs::path file = scratch.path() / "reference.png";
  cv::Mat picture;
  std::vector<uchar> bytes;
  replay::read_colour_image(file).convertTo(picture, CV_8U, 1.0 / 256);
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 85});
  replay::write_png(file, cv::imdecode(bytes, cv::IMREAD_COLOR));
  CHECK(calibrated(scratch.path()).because.find("compressed") != std::string::npos);
  picture(cv::Rect(70, 70, 20, 20)) = cv::Scalar(255, 200, 255);
  replay::write_png(file, picture);
  CHECK(calibrated(scratch.path()).because.find("saturated") != std::string::npos);
}

TEST_CASE("a finger of one's own: glare is left out, and no press is blamed", "[own]") {
  const test::ScratchFolder scratch;
  record(scratch.path(), 0, 40);
  const auto report = calibrated(scratch.path());
  INFO(report.because);
  CHECK(report.verdict == calibrate::Verdict::good);
  const auto found = replay::read_sensor(scratch.path() / "sensor.json").absorption;
  CHECK(found.c_red_per_mm == Approx(fluid.c_red_per_mm).epsilon(0.03));
}

TEST_CASE("a finger of one's own: the target may be cut by the picture", "[own]") {
  const test::ScratchFolder scratch;
  const cv::Rect part(0, 35, size_px, 90);  // the outer rows lie 48 px from the middle
  for (const auto& [name, raised_mm] : {std::pair("plate", 0.0), {"plate_raised", 10.0}}) {
    fs::create_directories(scratch.path() / name);
    replay::write_png(scratch.path() / name / "0.png", target(raised_mm)(part).clone());
  }
  calibrate::DotPlate plate;
  plate.rows = plate.cols = 9;
  plate.pitch_mm = 3;
  plate.raised_mm = 10;
  plate.refractive_index = camera.refractive_index;
  const auto outcome = calibrate::camera(scratch.path(), plate);
  const auto& found = outcome.sections.at("camera");
  CHECK(found.at("plate_distance_mm").get<double>() == Approx(50).margin(0.5));
  CHECK(found.at("center_px").at(1).get<double>() == Approx(79.1 - 35).margin(0.1));
}

TEST_CASE("a finger of one's own: a target that is tilted in place of raised", "[own]") {
  const test::ScratchFolder scratch;
  const fs::path tilted = scratch.path() / "plate_tilted";
  fs::create_directories(scratch.path() / "plate");
  fs::create_directories(tilted);
  replay::write_png(scratch.path() / "plate/0.png", target(0));
  calibrate::DotPlate plate;
  plate.rows = plate.cols = 9;
  plate.pitch_mm = 3;
  for (const double angle : {0.3, 2.4, 4.5}) {
    CHECK_THROWS_AS(calibrate::camera(scratch.path(), plate), replay::Failure);  // too few
    replay::write_png(tilted / (std::to_string(angle) + ".png"), target(7, 0.5, angle));
  }
  const auto outcome = calibrate::camera(scratch.path(), plate);
  INFO(outcome.reports.front().because);
  CHECK(outcome.reports.front().verdict == calibrate::Verdict::good);
  CHECK(outcome.sections.at("camera").at("plate_distance_mm").get<double>() ==
        Approx(50).margin(0.5));
}

TEST_CASE("a finger of one's own: the modulus from one weight", "[own]") {
  const test::ScratchFolder scratch;
  const fs::path folder = scratch.path() / "weight";
  fs::create_directories(folder / "frames");
  for (const char* name : {"sensor.json", "reference.png", "reference_depth.tiff",
                           "frames/000000.png", "frames/000005.png"}) {
    fs::copy(test::bundled_recordings / "press" / name, folder / name);
  }
  std::ofstream(folder / "signals.csv")
      << "frame,time_s,pressure_mpa\n0,0,0.016000\n1,0.1,0.020365\n";
  calibrate::RimNoise noise;
  noise.base_radius_mm = 18.735;
  noise.stress_free_height_mm = 11;
  const auto by = [&](double weight_n) {
    const auto found = calibrate::rim_by_weight(folder, folder / "sensor.json", noise, weight_n);
    return found.sections.at("rim").at("membrane_modulus_n_per_mm").get<double>();
  };
  CHECK(by(3.09135) == Approx(0.5).epsilon(0.03));
  CHECK_THROWS_AS(by(2 * 3.09135), replay::Failure);  // no free pad of its height
}

TEST_CASE("a finger of one's own: the free shape from touches", "[own]") {
  std::vector<Point3<double>> touches;
  const auto touch = [&](double share) {
    for (int k = 0; k < 6; ++k) {
      const double rho = share * base_mm, angle = k + 10 * share;
      touches.push_back({rho * std::cos(angle), rho * std::sin(angle), touch_mm(rho)});
    }
  };
  const auto error_mm = [&](const calibrate::TouchedShape& fit) {
    const auto found = calibrate::depth_of_shape(camera, {size_px, size_px}, fit.meridian);
    const auto truth = calibrate::depth_of_shape(camera, {size_px, size_px}, true_meridian());
    double worst = 0;
    for (int i = 0; i < size_px; ++i) {
      for (int j = 0; j < size_px; ++j) {
        const auto at = point_at(camera, double(i), double(j), 0.0);
        if (std::hypot(at.x, at.y) < 14) {
          worst = std::fmax(worst, std::abs(static_cast<double>(found(i, j) - truth(i, j))));
        }
      }
    }
    return worst;
  };
  for (const double share : {0.0, 0.3, 0.6, 0.85}) {
    touch(share);
  }
  const auto rubber = calibrate::fit_shape(touches, {ball_mm, base_mm, 0, true});
  CHECK(error_mm(rubber) < 0.02);
  CHECK(rubber.reach_mm < 0.75 * base_mm);
  // without rubber the touches must reach further, and the fit says how far they did
  const auto near = calibrate::fit_shape(touches, {ball_mm, base_mm, 0, false});
  touch(1.0);
  touch(1.15);
  const auto far = calibrate::fit_shape(touches, {ball_mm, base_mm, 0, false});
  CHECK(error_mm(far) < 0.03);
  CHECK(error_mm(far) < error_mm(near));
  CHECK(far.reach_mm > 0.75 * base_mm);
}

namespace {

/// The pad at a multiple of the pressure at which it was calibrated.
calibrate::Meridian meridian_at(double pressure) {
  return fingerpad::FreePad<double>({base_mm, 11, 0.1}).meridian(pressure * 0.016 / 0.5);
}

/// What may have happened to the finger since its calibration.
struct Day {
  double bright = 1, to_one_side = 0, red = 1;  ///< of the lamp and the camera, as factors
  double pressure = 1;                          ///< over that of then
  double moved_px = 0;
  double dirt_mm = 0;  ///< radius of a spot
  int dots_gone = 0;
  double noise = 0.25;
};

/// The pad that day, with dots of 0.8 mm, 3 mm apart.
cv::Mat free_pad_on(const Day& day, std::uint64_t seed) {
  test::Random random(seed);
  const DepthMap depth =
      calibrate::depth_of_shape(camera, {size_px, size_px}, meridian_at(day.pressure));
  const auto place = [](int i, int j, double l) {
    return point_at(camera, double(i), double(j), l);
  };
  cv::Mat_<cv::Vec3w> image = picture(depth, random, day.noise);
  for (int i = 0; i < depth.rows; ++i) {
    for (int j = 0; j < depth.cols; ++j) {
      const auto l = static_cast<double>(depth(i, j));
      const auto at = place(i, j, std::isfinite(l) ? l : 0), on_plate = place(i, j, 0);
      const double row = std::round(at.y / 3), col = std::round(at.x / 3);
      const bool is_gone = row == 1 && col >= 0 && col < day.dots_gone;
      const double off = std::hypot(at.x - 3 * col, at.y - 3 * row);
      const double dot = is_gone ? 1 : 1 - 0.5 / (1 + std::exp((off - 0.4) / 0.08));
      const double dirt = std::hypot(at.x - 5, at.y + 4) < day.dirt_mm ? 0.8 : 1;
      const double light = dot * day.bright * (1 + day.to_one_side * on_plate.x / base_mm);
      image(i, j)[1] = cv::saturate_cast<ushort>(light * image(i, j)[1]);
      image(i, j)[2] = cv::saturate_cast<ushort>(light * dirt * day.red * image(i, j)[2]);
    }
  }
  const cv::Matx23d moved(1, 0, day.moved_px, 0, 1, 0);
  cv::warpAffine(image, image, moved, image.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return image;
}

}  // namespace

TEST_CASE("a finger of one's own: what has changed since the calibration, and nothing else",
          "[own]") {
  replay::Sensor sensor;
  sensor.camera = camera;
  sensor.absorption = fluid;
  sensor.pad = {base_mm, true_meridian().front().y};
  sensor.dots = replay::Dots{13, 13, 3, 0.8};
  const cv::Mat reference = free_pad_on({}, 1);
  const DepthMap free_mm = calibrate::depth_of_shape(camera, {size_px, size_px}, true_meridian());
  enum { brightness, slope, balance, apex, place, spots, dots };
  /// Whether the changes `told` are told, and no other.
  const auto of = [&](const Day& day, std::uint64_t seed, const std::vector<int>& told) {
    const auto all = calibrate::changes(sensor, reference, free_mm, free_pad_on(day, seed));
    REQUIRE(all.size() == 7);
    for (int k = 0; k < 7; ++k) {
      const auto& change = all[static_cast<std::size_t>(k)];
      CAPTURE(change.what, change.by, change.sd);
      CHECK(change.is_told() == (std::count(told.begin(), told.end(), k) > 0));
    }
    return all;
  };
  for (std::uint64_t seed = 2; seed < 7; ++seed) {
    of({}, seed, {});
    of({.noise = 1}, seed, {});
    of({.bright = 0.97, .to_one_side = 0.01, .pressure = 1.02}, seed, {});  // costs no depth
  }
  CHECK(of({.bright = 0.9}, 2, {brightness})[brightness].by == Approx(-10).margin(0.3));
  CHECK(of({.to_one_side = -0.05}, 2, {slope})[slope].by == Approx(5).margin(0.3));
  CHECK(of({.red = 1.015}, 2, {balance})[balance].by == Approx(1.5).margin(0.2));
  for (const double pressure : {0.8, 0.9, 1.15}) {  // leak and refill
    const double by_mm = meridian_at(pressure).front().y - sensor.pad.apex_height_mm;
    CAPTURE(by_mm);
    CHECK(of({.pressure = pressure}, 2, {apex})[apex].by == Approx(by_mm).epsilon(0.15));
  }
  CHECK(of({.moved_px = 1.3}, 2, {place})[place].by == Approx(1.3).margin(0.2));
  CHECK(of({.dirt_mm = 4}, 2, {spots})[spots].by > 2);
  CHECK(of({.dots_gone = 3}, 2, {dots})[dots].by == 3);
  // all at once
  const auto all =
      of({.bright = 0.9, .red = 0.98, .pressure = 0.8}, 3, {brightness, balance, apex});
  CHECK(all[brightness].by == Approx(-10).margin(0.7));
  CHECK(all[balance].by == Approx(-2).margin(0.5));
}
