// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finite-element membranes (tests/data/README.md): shapes, contact, and full-size frames with
// refracted rays, printed dots, 8 bit and noise in each channel.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "pad.hpp"

namespace test {

constexpr double base_radius_mm = 18.735;

inline void require_data(bool held, const std::string& what) {
  if (!held) {
    throw std::runtime_error("tests/data: " + what);
  }
}

inline std::ifstream open_data(const std::string& name, const std::string& header) {
  const auto folder = std::filesystem::path(__FILE__).parent_path().parent_path() / "data";
  std::ifstream file(folder / name, std::ios::binary);
  std::string found(header.size(), ' ');
  file.read(found.data(), static_cast<std::streamsize>(found.size()));
  require_data(found == header, name + " begins otherwise");
  return file;
}

/// Heights of a membrane: 160 x 160 samples 0.24 mm apart around the axis.
class Membrane {
 public:
  explicit Membrane(const std::string& name) : heights_(samples, samples) {
    auto file = open_data(name + ".pgm", "P5\n160 160\n65535\n");
    for (double& h : heights_.cells) {
      const int high = file.get();
      h = (256 * high + file.get()) / 4000.0 - 2;
    }
    require_data(file.good(), name + ".pgm is too short");
  }

  /// Height above (x, y), by cubic interpolation.
  double operator()(double x_mm, double y_mm) const {
    const double col = position(x_mm);
    const double row = position(y_mm);
    const Index j = static_cast<Index>(col);
    const Index i = static_cast<Index>(row);
    double along[4];
    for (Index k = 0; k < 4; ++k) {
      const double* h = &heights_(i - 1 + k, j - 1);
      along[k] = cubic(h, col - static_cast<double>(j));
    }
    return cubic(along, row - static_cast<double>(i));
  }

 private:
  static constexpr Index samples = 160;
  static double position(double mm) {
    const double middle = (static_cast<double>(samples) - 1) / 2;
    return (std::min)((std::max)(mm / 0.24 + middle, 1.0), static_cast<double>(samples) - 3);
  }
  static double cubic(const double* h, double t) {  // Catmull-Rom
    const double a = 3 * (h[1] - h[2]) + h[3] - h[0];
    const double b = 2 * h[0] - 5 * h[1] + 4 * h[2] - h[3];
    return h[1] + t * (h[2] - h[0] + t * (b + t * a)) / 2;
  }
  Image<double> heights_;
};

/// Contact of a membrane at the same samples.
class TrueContact {
 public:
  explicit TrueContact(const std::string& name) : touches_(samples, samples) {
    auto file = open_data(name + ".pbm", "P4\n160 160\n");
    for (Index k = 0; k < samples * samples; k += 8) {
      const int byte = file.get();
      for (Index bit = 0; bit < 8; ++bit) {
        touches_.cells[static_cast<std::size_t>(k + bit)] = byte >> (7 - bit) & 1;
      }
    }
    require_data(file.good(), name + ".pbm is too short");
  }

  /// Area in plan.
  double area_mm2() const {
    double sum = 0;
    for (const int touches : touches_.cells) {
      sum += touches;
    }
    return sum * 0.24 * 0.24;
  }

  /// Whether (x, y) touches, by linear interpolation between the samples.
  bool operator()(double x_mm, double y_mm) const {
    const double col = position(x_mm);
    const double row = position(y_mm);
    const auto j = static_cast<Index>(col);
    const auto i = static_cast<Index>(row);
    const double u = col - static_cast<double>(j);
    const double v = row - static_cast<double>(i);
    return (1 - v) * ((1 - u) * touches_(i, j) + u * touches_(i, j + 1)) +
               v * ((1 - u) * touches_(i + 1, j) + u * touches_(i + 1, j + 1)) >=
           0.5;
  }

 private:
  static constexpr Index samples = 160;
  static double position(double mm) {
    const double middle = (static_cast<double>(samples) - 1) / 2;
    return (std::min)((std::max)(mm / 0.24 + middle, 0.0), static_cast<double>(samples) - 1.001);
  }
  Image<int> touches_;
};

/// The published pad before the default camera: 640 x 480 pixels of 0.08 mm.
inline Pad published_pad() {
  Pad pad;
  pad.rows = 480;
  pad.cols = 640;
  pad.camera = fingerpad::Camera<double>();
  return pad;
}

/// Zero of a function that falls from positive to negative between 0 and 14 mm.
template <class F>
double crossing(const F& above) {
  double low = 0;
  double high = 14;
  double at_low = above(low);
  double at_high = above(high);
  if (at_low <= 0) {
    return 0;
  }
  for (int step = 0; step < 60 && high - low > 1e-6; ++step) {
    // every third step halves, because a steep end would otherwise stay where it is
    const double secant = low + (high - low) * at_low / (at_low - at_high);
    const double z = step % 3 == 2 ? (low + high) / 2 : secant;
    const double f = above(z);
    if (std::abs(f) < 1e-6) {
      return z;
    }
    (f > 0 ? low : high) = z;
    (f > 0 ? at_low : at_high) = f;
  }
  return (low + high) / 2;
}

/// Depth at which each pixel's ray meets the membrane; NaN outside the base.
inline Image<double> depths(const Pad& pad, const Membrane& membrane) {
  Image<double> depth(pad.rows, pad.cols, nan);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const auto at = [&](double z) {
        return point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), z);
      };
      const auto foot = at(0);
      if (std::hypot(foot.x, foot.y) >= base_radius_mm) {
        continue;
      }
      const auto top = at(1);
      depth(i, j) = crossing([&](double z) {
        return membrane(foot.x + z * (top.x - foot.x), foot.y + z * (top.y - foot.y)) - z;
      });
    }
  }
  return depth;
}

/// A membrane that is darker toward the rim, with dots of 0.6 mm every 1.5 mm. `noise` is in grey
/// levels.
inline Frame<std::uint8_t> frame_of(const Pad& pad,
                                    const Image<double>& depth_mm,
                                    std::uint64_t seed,
                                    double noise) {
  Frame<std::uint8_t> frame(pad.rows, pad.cols, 3);
  Random random(seed);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const double l = depth_mm(i, j);
      if (std::isnan(l)) {
        continue;
      }
      const auto p = point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), l);
      const double u = p.x - 1.5 * std::round(p.x / 1.5);
      const double v = p.y - 1.5 * std::round(p.y / 1.5);
      const double share = (p.x * p.x + p.y * p.y) / (base_radius_mm * base_radius_mm);
      const double bright = 57 * (1 - 0.06 * share) * (u * u + v * v < 0.09 ? 0.4 : 1);
      const auto c = pad.colour(i, j, l, bright);
      frame.red(i, j) = stored<std::uint8_t>(c.red + noise * random.normal());
      frame.green(i, j) = stored<std::uint8_t>(c.green + noise * random.normal());
    }
  }
  return frame;
}

/// Reference of `camera`, which may differ from the pad's own, from the mean of many free frames:
/// 16 bit, 1/4 of a grey level of noise. `seen_mm` is the true depth; `known_mm` is where the rays
/// of `camera` meet the free pad.
inline fingerpad::DepthReference<float> reference_of(const Pad& pad,
                                                     const fingerpad::Camera<double>& camera,
                                                     const Image<double>& seen_mm,
                                                     const Image<double>& known_mm) {
  Frame<std::uint16_t> mean(pad.rows, pad.cols);
  Random random(99);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      if (!std::isnan(seen_mm(i, j))) {
        const auto c = pad.colour(i, j, seen_mm(i, j), 57);
        mean.red(i, j) = stored<std::uint16_t>(c.red + 0.25 * random.normal());
        mean.green(i, j) = stored<std::uint16_t>(c.green + 0.25 * random.normal());
      }
    }
  }
  return fit_reference(camera, pad.fluid, mean.red, mean.green, known_mm);
}

/// Frames and reference of the published pad, by the names of the shapes.
class Scene {
 public:
  const Pad& pad() const { return pad_; }
  Image<double> depth(const std::string& name) const { return depths(pad_, Membrane(name)); }
  Frame<std::uint8_t> frame(const Image<double>& depth_mm,
                            std::uint64_t seed,
                            double noise = 1) const {
    return frame_of(pad_, depth_mm, seed, noise);
  }
  fingerpad::DepthReference<float> reference(const Image<double>& free_mm) const {
    return reference_of(pad_, pad_.camera, free_mm, free_mm);
  }

 private:
  Pad pad_ = published_pad();
};

}  // namespace test
