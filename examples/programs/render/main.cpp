// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// render: makes the frames of a recording from a membrane with the library's own forward model. The
// first step of the membrane is the free pad. The same input gives the same bytes.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/sensor.hpp"
#include "light.hpp"
#include "membrane.hpp"

namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path recording;
  fs::path out;
  fs::path truth;
  fs::path measured;
  int size_px = 480;
  int samples = 3;
  int reference_frames = 64;
  unsigned long long seed = 1;
  render::Lighting lighting;
};

std::string numbered(std::size_t number, const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.%s", number, extension);
  return name;
}

/// Mean of many noisy frames, 16 bit (256 units per grey level). It is rounded to 1/16 grey level,
/// which is less than its noise, for a smaller file.
cv::Mat averaged(const cv::Mat_<cv::Vec3f>& ideal, int frames, render::Noise& noise) {
  cv::Mat sum(ideal.size(), CV_32SC3, cv::Scalar::all(0));
  for (int i = 0; i < frames; ++i) {
    cv::add(sum, noise.expose(ideal), sum, cv::noArray(), CV_32S);
  }
  cv::Mat sixteenths;
  sum.convertTo(sixteenths, CV_16U, 16.0 / frames);
  return sixteenths * 16;
}

/// Rounds to 1/1024 mm, far below the resolution of measurements, for a smaller file.
cv::Mat_<float> rounded(cv::Mat_<float> depth_mm) {
  for (float& depth : depth_mm) {
    depth = std::round(depth * 1024) / 1024;
  }
  return depth_mm;
}

/// Mean absolute difference of two depth maps, mm, over pixels valid in both and within `radius_mm`
/// of the axis on the plate.
double mean_error_mm(const fingerpad::Camera<double>& camera,
                     const cv::Mat_<float>& measured,
                     const cv::Mat_<float>& truth,
                     double radius_mm) {
  double sum = 0;
  int count = 0;
  for (int i = 0; i < truth.rows; ++i) {
    for (int j = 0; j < truth.cols; ++j) {
      const double x_mm = (j - camera.center_x_px) * camera.pitch_mm;
      const double y_mm = (i - camera.center_y_px) * camera.pitch_mm;
      const double error = static_cast<double>(std::abs(measured(i, j) - truth(i, j)));
      if (std::isfinite(error) && std::hypot(x_mm, y_mm) <= radius_mm) {
        sum += error;
        ++count;
      }
    }
  }
  return sum / count;
}

/// Prints the errors of the depth maps of an earlier run of replay --raw.
void compare_all(const Options& options) {
  const replay::Sensor sensor = replay::read_sensor(options.recording / "sensor.json");
  const render::Membrane membrane = render::read_membrane(options.recording / "membrane");
  constexpr double inner_mm = 14;
  constexpr double outer_mm = 17.5;
  double inner_sum = 0;
  double outer_sum = 0;
  std::printf("Mean absolute error of the depth in mm, within %g and %g mm of the axis\n", inner_mm,
              outer_mm);
  for (std::size_t k = 0; k < membrane.steps.size(); ++k) {
    const cv::Mat_<float> measured =
        replay::read_depth_image(options.measured / numbered(k, "tiff"));
    const auto truth =
        look(sensor.camera, membrane.triangles, membrane.steps[k], measured.size(), 1, 0);
    const double inner = mean_error_mm(sensor.camera, measured, truth.depth_mm, inner_mm);
    const double outer = mean_error_mm(sensor.camera, measured, truth.depth_mm, outer_mm);
    std::printf("%-6zu %.4f %.4f\n", k, inner, outer);
    inner_sum += inner;
    outer_sum += outer;
  }
  const double frames = static_cast<double>(membrane.steps.size());
  std::printf("mean   %.4f %.4f\n", inner_sum / frames, outer_sum / frames);
}

void copy_unless_same(const fs::path& from, const fs::path& to) {
  if (fs::exists(from) && !(fs::exists(to) && fs::equivalent(from, to))) {
    fs::copy_file(from, to, fs::copy_options::overwrite_existing);
  }
}

void render_all(const Options& options) {
  const replay::Sensor sensor = replay::read_sensor(options.recording / "sensor.json");
  const render::Membrane membrane = render::read_membrane(options.recording / "membrane");
  const cv::Size size(options.size_px, options.size_px);
  if (membrane.steps.empty()) {
    replay::fail(options.recording / "membrane" / "nodes.npy", "contains no step");
  }
  const double dot_mm = sensor.dots ? sensor.dots->diameter_mm : 0.0;
  fs::create_directories(options.out / "frames");
  copy_unless_same(options.recording / "sensor.json", options.out / "sensor.json");
  for (const char* file : {"signals.csv", "stress_free_dots.csv"}) {
    copy_unless_same(options.recording / file, options.out / file);
  }
  render::Noise noise(options.seed, options.lighting);
  const auto centers = [&](const render::Step& step) {
    return look(sensor.camera, membrane.triangles, step, size, 1, dot_mm).depth_mm;
  };
  const auto ideal = [&](const render::Step& step) {
    const auto sight = look(sensor.camera, membrane.triangles, step, size, options.samples, dot_mm);
    return ideal_frame(sensor, options.lighting, sight, options.samples);
  };
  const render::Step& free_pad = membrane.steps.front();
  replay::write_png(options.out / sensor.reference_frame,
                    averaged(ideal(free_pad), options.reference_frames, noise));
  replay::write_depth_image(options.out / sensor.reference_depth, rounded(centers(free_pad)));
  for (std::size_t k = 0; k < membrane.steps.size(); ++k) {
    const render::Step& step = membrane.steps[k];
    replay::write_png(options.out / "frames" / numbered(k, "png"), noise.expose(ideal(step)));
    if (!options.truth.empty()) {
      fs::create_directories(options.truth);
      replay::write_depth_image(options.truth / numbered(k, "tiff"), centers(step));
    }
  }
  std::printf("%zu frames of %d x %d px in %s\n", membrane.steps.size(), size.width, size.height,
              options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Renders reference.png, reference_depth.tiff and frames/ of a recording from its "
      "sensor.json and membrane/ (nodes.npy, triangles.npy, dots.npy).");
  Options options;
  app.add_option("RECORDING", options.recording, "folder with sensor.json and membrane/")
      ->required();
  app.add_option("--out", options.out, "output folder; default: RECORDING");
  app.add_option("--truth", options.truth,
                 "also write the true depth of each frame to this folder");
  app.add_option(
      "--compare", options.measured,
      "render nothing; print the errors of the depth maps that replay --raw wrote to this "
      "folder");
  app.add_option("--size", options.size_px, "width and height of the frames, px")
      ->capture_default_str()
      ->check(CLI::Range(16, 4096));
  app.add_option("--reference-frames", options.reference_frames,
                 "number of frames averaged for the reference")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  app.add_option("--noise", options.lighting.noise,
                 "standard deviation of the noise of the brightest pixels, grey levels")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--seed", options.seed, "seed of the noise")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (options.out.empty()) {
    options.out = options.recording;
  }
  try {
    options.measured.empty() ? render_all(options) : compare_all(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "render: %s\n", error.what());
    return 1;
  }
  return 0;
}
