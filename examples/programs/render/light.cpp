// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "light.hpp"

#include <cmath>

#include "fingerpad/depth/absorption.hpp"

namespace render {
namespace {

/// Grey level outside the pad: the ring that clamps the membrane, and darkness beyond it.
float surroundings(const replay::Sensor& sensor, double rho_mm) {
  constexpr double ring_mm = 0.35;
  return rho_mm < sensor.pad.base_radius_mm + ring_mm ? 11.0F : 2.0F;
}

}  // namespace

cv::Mat_<cv::Vec3f> ideal_frame(const replay::Sensor& sensor,
                                const Lighting& lighting,
                                const Sight& sight,
                                int samples) {
  const auto& fluid = sensor.absorption;
  cv::Mat_<cv::Vec3f> frame(sight.depth_mm.rows / samples, sight.depth_mm.cols / samples,
                            cv::Vec3f(0, 0, 0));
  const float weight = 1.0F / static_cast<float>(samples * samples);
  for (int i = 0; i < sight.depth_mm.rows; ++i) {
    for (int j = 0; j < sight.depth_mm.cols; ++j) {
      const double row = (i + 0.5) / samples - 0.5;
      const double col = (j + 0.5) / samples - 0.5;
      const auto ray = fingerpad::ray_at_pixel(sensor.camera, row, col);
      const double depth = static_cast<double>(sight.depth_mm(i, j));
      cv::Vec3f& pixel = frame(i / samples, j / samples);
      if (std::isnan(depth)) {
        const float level = weight * surroundings(sensor, ray.plate_rho_mm);
        pixel += cv::Vec3f(level, level, level);
        continue;
      }
      // The light decreases toward the rim and with the membrane's inclination. The depth model
      // contains neither, because the brightness cancels.
      const double share = ray.plate_rho_mm / sensor.pad.base_radius_mm;
      const double upright = static_cast<double>(sight.upright(i, j));
      double brightness =
          lighting.brightness * (1 - 0.06 * share * share) * (1 - 0.10 * (1 - upright));
      if (sight.on_dot(i, j) != 0) {
        brightness *= lighting.dot_share;
      }
      const double scattering = lighting.scattering * (1 - 0.05 * (1 - std::exp(-share * share)));
      const auto colour = fingerpad::colour_at_depth(fluid, ray, brightness, scattering, depth);
      const double blue = lighting.blue_share * brightness *
                          std::exp(-2 * fluid.c_green_per_mm * ray.path_factor * depth);
      pixel += weight * cv::Vec3f(static_cast<float>(blue), static_cast<float>(colour.green),
                                  static_cast<float>(colour.red));
    }
  }
  return frame;
}

Noise::Noise(std::uint64_t seed, const Lighting& lighting)
    : bits_(seed), variance_per_level_(lighting.noise * lighting.noise / lighting.brightness) {}

cv::Mat_<cv::Vec3b> Noise::expose(const cv::Mat_<cv::Vec3f>& ideal) {
  cv::Mat_<cv::Vec3b> frame(ideal.size());
  for (int i = 0; i < ideal.rows; ++i) {
    for (int j = 0; j < ideal.cols; ++j) {
      for (int c = 0; c < 3; ++c) {
        const double level = static_cast<double>(ideal(i, j)[c]);
        const double noisy = level + std::sqrt(variance_per_level_ * level) * normal();
        frame(i, j)[c] = cv::saturate_cast<uchar>(std::floor(noisy + 0.5));
      }
    }
  }
  return frame;
}

double Noise::normal() {
  // The sum of twelve uniform numbers has variance 1 and is the same on every machine, as
  // std::normal_distribution is not.
  constexpr double unit = 1.0 / 65536.0;
  double sum = -6 + 12 * 0.5 * unit;
  for (int draw = 0; draw < 3; ++draw) {
    std::uint64_t bits = bits_();
    for (int part = 0; part < 4; ++part, bits >>= 16U) {
      sum += static_cast<double>(bits & 0xffffU) * unit;
    }
  }
  return sum;
}

}  // namespace render
