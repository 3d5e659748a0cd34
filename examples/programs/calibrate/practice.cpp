// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Writes recordings of a simulated sensor, which docs/first_hour describes. All commands can be
// tried without hardware, and tests know the true results.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>

#include "calibrate/calibrations.hpp"
#include "calibrate/shape.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/membrane/free_pad.hpp"

namespace calibrate {
namespace {

constexpr int size_px = 240;
constexpr double base_mm = 18;
constexpr double ball_mm = 15;
const fingerpad::Camera<double> practice_camera{50, 1.33, 120.3, 118.8, 0.153};
const fingerpad::Absorption<double> practice_fluid{0.031, 0.0365, 0.98, 17};

/// Noise that is the same on every machine: the sum of twelve uniform numbers has variance 1.
class Noise {
 public:
  double operator()() {
    double sum = -6;
    for (int k = 0; k < 12; ++k) {
      sum += (static_cast<double>(bits_() >> 11U) + 0.5) / 9007199254740992.0;
    }
    return sum;
  }

 private:
  std::mt19937_64 bits_{20110801};
};

Path picture_file(const Path& folder, int number) {
  std::filesystem::create_directories(folder);
  char name[16];
  std::snprintf(name, sizeof name, "%06d.png", number);
  return folder / name;
}

void write_text(const Path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) {
    replay::fail(file, "cannot be written");
  }
}

template <class... Numbers>
std::string line(const char* format, Numbers... numbers) {
  char text[160];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

/// Standard deviation of shot noise: 1 grey level at a level of 57.
double shot_noise(float level) {
  return std::sqrt(static_cast<double>(level) / 57);
}

/// The mean of 16 noisy frames, 16 bit, 256 units per grey level.
cv::Mat averaged(const cv::Mat_<cv::Vec3f>& ideal, Noise& noise) {
  cv::Mat_<cv::Vec3w> mean(ideal.size());
  for (int i = 0; i < ideal.rows; ++i) {
    for (int j = 0; j < ideal.cols; ++j) {
      for (int c = 0; c < 3; ++c) {
        const double level = static_cast<double>(ideal(i, j)[c]);
        mean(i, j)[c] =
            cv::saturate_cast<ushort>(256 * (level + shot_noise(ideal(i, j)[c]) / 4 * noise()));
      }
    }
  }
  return mean;
}

/// A noisy 8-bit frame.
cv::Mat exposed(const cv::Mat_<cv::Vec3f>& ideal, Noise& noise) {
  cv::Mat_<cv::Vec3b> frame(ideal.size());
  for (int i = 0; i < ideal.rows; ++i) {
    for (int j = 0; j < ideal.cols; ++j) {
      for (int c = 0; c < 3; ++c) {
        const double level = static_cast<double>(ideal(i, j)[c]);
        frame(i, j)[c] = cv::saturate_cast<uchar>(level + shot_noise(ideal(i, j)[c]) * noise());
      }
    }
  }
  return frame;
}

cv::Mat_<cv::Vec3f> rendered(const DepthMap& depth_mm) {
  cv::Mat_<cv::Vec3f> frame(depth_mm.size(), cv::Vec3f(2, 2, 2));
  for (int i = 0; i < frame.rows; ++i) {
    for (int j = 0; j < frame.cols; ++j) {
      const auto depth = static_cast<double>(depth_mm(i, j));
      if (std::isfinite(depth)) {
        const auto ray = ray_at_pixel(practice_camera, double(i), double(j));
        const auto colour =
            colour_at_depth(practice_fluid, ray, 140.0,
                            0.044 - 0.00001 * ray.plate_rho_mm * ray.plate_rho_mm, depth);
        frame(i, j) =
            cv::Vec3f(4, static_cast<float>(colour.green), static_cast<float>(colour.red));
      }
    }
  }
  return frame;
}

/// An image of antialiased dark dots on a bright background.
cv::Mat_<cv::Vec3f> dotted(const std::vector<cv::Point2d>& dots, double radius_px) {
  cv::Mat_<uchar> grey(size_px, size_px, static_cast<uchar>(170));
  for (const cv::Point2d& p : dots) {
    constexpr int shift = 8, one = 1 << shift;
    cv::circle(grey, cv::Point(cvRound(p.x * one), cvRound(p.y * one)), cvRound(radius_px * one),
               cv::Scalar(50), cv::FILLED, cv::LINE_AA, shift);
  }
  cv::Mat blurred, colour;
  cv::GaussianBlur(grey, blurred, cv::Size(), 0.8);
  cv::cvtColor(blurred, colour, cv::COLOR_GRAY2BGR);
  cv::Mat_<cv::Vec3f> frame;
  colour.convertTo(frame, CV_32FC3);
  return frame;
}

/// Writes plates of 9 x 9 dots, 3 mm apart, on the pad's plate and 10 mm above it.
void write_plates(const Path& folder, Noise& noise) {
  for (const double raised_mm : {0.0, 10.0}) {
    const double scale = 50 / (50 + raised_mm) / practice_camera.pitch_mm;
    std::vector<cv::Point2d> dots;
    for (int k = 0; k < 81; ++k) {
      dots.emplace_back(practice_camera.center_x_px + (k % 9 - 4) * 3 * scale,
                        practice_camera.center_y_px + (k / 9 - 4) * 3 * scale);
    }
    replay::write_png(picture_file(folder / (raised_mm > 0 ? "plate_raised" : "plate"), 0),
                      exposed(dotted(dots, 0.5 * scale), noise));
  }
}

/// Writes the free pad, balls that just touch it, and balls pressed into it.
void write_pad(const Path& folder, Noise& noise) {
  const Meridian pad = fingerpad::FreePad<double>({base_mm, 10, 0.1}).meridian(0.03);
  const DepthMap free_mm = depth_of_shape(practice_camera, {size_px, size_px}, pad);
  for (int k = 0; k < 16; ++k) {
    replay::write_png(picture_file(folder / "free", k), exposed(rendered(free_mm), noise));
  }
  std::string touches = "x_mm,y_mm,z_mm\n";
  for (int k = 0; k < 25; ++k) {
    const double x = 6 * (k % 5 - 2), y = 6 * (k / 5 - 2);
    double center = 0;  // of the ball that touches the pad
    for (const auto& p : pad) {
      const double beside = std::hypot(x, y) - p.x;
      center =
          std::fmax(center, p.y + std::sqrt(std::fmax(0, ball_mm * ball_mm - beside * beside)));
    }
    const double z = center - ball_mm + 0.01 * noise();
    touches += line("%.3f,%.3f,%.3f\n", x, y, z);
  }
  write_text(folder / "touches.csv", touches);
  std::string presses = "frame,x_mm,y_mm,z_mm,radius_mm\n";
  constexpr int count = 12;
  constexpr double places[count][3] = {{0, 0, 9},  {0, 0, 6},  {0, 0, 3},  {0, 0, 1},
                                       {6, 0, 7},  {6, 0, 4},  {6, 0, 1},  {-4, 5, 6},
                                       {-4, 5, 2}, {0, -7, 5}, {0, -7, 1}, {-8, -1, 3}};
  for (int k = 0; k < count; ++k) {
    const auto& [x, y, z] = places[k];
    DepthMap depth = free_mm.clone();
    for (int i = 0; i < size_px; ++i) {
      for (int j = 0; j < size_px; ++j) {
        const double on_ball = depth_on(practice_camera, i, j, {{x, y, z + ball_mm}, ball_mm});
        if (on_ball < static_cast<double>(depth(i, j))) {
          depth(i, j) = static_cast<float>(on_ball);
        }
      }
    }
    replay::write_png(picture_file(folder / "frames", k), averaged(rendered(depth), noise));
    presses += line("%d,%.3f,%.3f,%.3f,%.3f\n", k, x, y, z, ball_mm);
  }
  write_text(folder / "presses.csv", presses);
}

/// Writes apex heights of the free pad at four pressures, of a cap of 11 mm with mu t = 0.5 N/mm.
void write_rim(const Path& folder, Noise& noise) {
  std::filesystem::create_directories(folder);
  std::string signals = "frame,time_s,pressure_mpa\n";
  std::string apexes = "frame,apex_mm\n";
  const fingerpad::FreePad<double> pad({base_mm, 11});
  for (int k = 0; k < 20; ++k) {
    const double pressure_mpa = 0.008 + 0.004 * (k / 5);
    signals += line("%d,%.1f,%.6f\n", k, 0.1 * k, pressure_mpa);
    apexes += line("%d,%.4f\n", k, pad.rim(pressure_mpa / 0.5)->apex_mm + 0.01 * noise());
  }
  write_text(folder / "signals.csv", signals);
  write_text(folder / "apex.csv", apexes);
}

/// Writes 15 x 15 dots: at rest in free/; in frames/ an object drags them three times and loses
/// more and more of them, starting at the edge.
void write_dots(const Path& folder, Noise& noise) {
  constexpr double spacing_px = 15, jitter_px = 0.05;
  const auto picture = [&](double moved_px, double stuck_radius) {
    std::vector<cv::Point2d> dots;
    for (int k = 0; k < 225; ++k) {
      const double u = k % 15 - 7, v = k / 15 - 7;
      const double beyond = std::fmax(std::hypot(u, v) - stuck_radius, 0.0);
      const double along = moved_px / (1 + beyond);
      dots.emplace_back(119.5 + spacing_px * u + along + jitter_px * noise(),
                        119.5 + spacing_px * v + jitter_px * noise());
    }
    return exposed(dotted(dots, 4), noise);
  };
  for (int k = 0; k < 20; ++k) {
    replay::write_png(picture_file(folder / "free", k), picture(0, 99));
  }
  for (int k = 0; k < 60; ++k) {
    const int step = k % 30;
    const double stuck = step < 14 ? 12 - 0.2 * step : std::fmax(0.0, 9.2 - (step - 14));
    replay::write_png(picture_file(folder / "frames", k),
                      picture((k < 30 ? 0.6 : -0.6) * step, stuck));
  }
  write_text(folder / "sensor.json", "{ \"stick\": { \"covers_pattern\": true } }\n");
}

/// Writes 4 x 4 taxels at rest under a steady grip, with a noise of 3 counts.
void write_taxels(const Path& folder, Noise& noise) {
  std::filesystem::create_directories(folder);
  std::string text = "frame,time_s";
  for (int k = 0; k < 16; ++k) {
    text += line(",r%d_c%d", k / 4, k % 4);
  }
  for (int n = 0; n < 900; ++n) {
    text += line("\n%d,%.4f", n, n / 30.0);
    for (int k = 0; k < 16; ++k) {
      text += line(",%.0f", 800 + 40 * (k % 4) + 3 * noise());
    }
  }
  write_text(folder / "taxels.csv", text + "\n");
}

}  // namespace

void write_practice(const Path& folder) {
  Noise noise;
  write_plates(folder / "plate", noise);
  write_pad(folder / "pad", noise);
  write_rim(folder / "rim", noise);
  write_dots(folder / "dots", noise);
  write_taxels(folder / "foam", noise);
}

}  // namespace calibrate
