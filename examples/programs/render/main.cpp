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

constexpr int size_px = 480, samples = 3, reference_frames = 64;

struct Options {
  fs::path recording;
  fs::path out;
  unsigned long long seed = 1;
  render::Lighting lighting;
};

std::string numbered(std::size_t number) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.png", number);
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

void copy_unless_same(const fs::path& from, const fs::path& to) {
  if (fs::exists(from) && !(fs::exists(to) && fs::equivalent(from, to))) {
    fs::copy_file(from, to, fs::copy_options::overwrite_existing);
  }
}

void render_all(const Options& options) {
  const replay::Sensor sensor = replay::read_sensor(options.recording / "sensor.json");
  const render::Membrane membrane = render::read_membrane(options.recording / "membrane");
  const cv::Size size(size_px, size_px);
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
    const auto sight = look(sensor.camera, membrane.triangles, step, size, samples, dot_mm);
    return ideal_frame(sensor, options.lighting, sight, samples);
  };
  const render::Step& free_pad = membrane.steps.front();
  replay::write_png(options.out / sensor.reference_frame,
                    averaged(ideal(free_pad), reference_frames, noise));
  replay::write_depth_image(options.out / sensor.reference_depth, rounded(centers(free_pad)));
  for (std::size_t k = 0; k < membrane.steps.size(); ++k) {
    const render::Step& step = membrane.steps[k];
    replay::write_png(options.out / "frames" / numbered(k), noise.expose(ideal(step)));
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
    render_all(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "render: %s\n", error.what());
    return 1;
  }
  return 0;
}
