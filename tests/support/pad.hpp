// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A pad with known numbers, and frames of it: a spherical cap behind a plate, seen along refracted
// rays through the forward model. It is small enough for many tests.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/published/depth.hpp"
#include "image.hpp"

namespace test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Whether two values are equal to the last bit; NaN equals NaN.
template <class T>
bool same_bits(const T& a, const T& b) {
  return a == b || (a != a && b != b);
}
template <class T>
bool same_bits(const Image<T>& a, const Image<T>& b) {
  return a.width == b.width &&
         std::equal(a.cells.begin(), a.cells.end(), b.cells.begin(), b.cells.end(),
                    [](const T& x, const T& y) { return same_bits(x, y); });
}

/// Random numbers that are the same on every machine and in every run.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  /// In [0, 1).
  double uniform() { return std::ldexp(static_cast<double>(bits_() >> 11U), -53); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  Index whole(Index low, Index high) {
    return low + static_cast<Index>(uniform() * static_cast<double>(high - low + 1));
  }
  /// Mean 0, standard deviation 1. A sum of twelve uniform numbers, because
  /// std::normal_distribution differs between libraries.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
      sum += uniform();
    }
    return sum;
  }

 private:
  std::mt19937_64 bits_;
};

/// Red and green of one frame.
template <class Pixel>
struct Frame {
  Image<Pixel> red;
  Image<Pixel> green;
  Frame(Index rows, Index cols, Pixel cell = Pixel(0))
      : red(rows, cols, cell), green(rows, cols, cell) {}
};

/// A grey level as stored by a camera with this type of pixel.
template <class Pixel>
Pixel stored(double level) {
  if constexpr (std::is_integral_v<Pixel>) {
    const double units = level * fingerpad::grey_scale_of<Pixel>().units_per_level;
    const double top = static_cast<double>((std::numeric_limits<Pixel>::max)());
    return static_cast<Pixel>((std::min)((std::max)(std::floor(units + 0.5), 0.0), top));
  } else {
    return Pixel(level);
  }
}

/// The published fluid (defaults of Absorption) and pad: a sphere of 20 mm cut 13 mm below its top,
/// in 48 x 56 pixels of 0.8 mm. Brightness and scattering give the published change of colour.
struct Pad {
  Index rows = 48;
  Index cols = 56;
  fingerpad::Camera<double> camera;
  fingerpad::Absorption<double> fluid;
  double sphere_radius_mm = 20;
  double height_mm = 13;
  double brightness = 57;
  double scattering = 0.0163;
  double scattering_loss = 0.05;  ///< relative loss from the axis to the rim
  bool one_height = false;        ///< of a pencil in both directions, as printed

  Pad() {
    camera.pitch_mm = 0.8;
    camera.center_x_px = 27.5;
    camera.center_y_px = 23.5;
  }

  double base_radius_mm() const {
    const double below = sphere_radius_mm - height_mm;
    return std::sqrt(sphere_radius_mm * sphere_radius_mm - below * below);
  }
  fingerpad::Ray<double> ray(Index row, Index col) const {
    return fingerpad::ray_at_pixel(camera, static_cast<double>(row), static_cast<double>(col));
  }
  fingerpad::Ray<double> pencil(Index row, Index col) const {
    auto pencil = ray(row, col);
    if (one_height) {
      pencil.sagittal_mm = pencil.meridional_mm;
    }
    return pencil;
  }
  double g(Index row, Index col) const {
    const double share = ray(row, col).plate_rho_mm / base_radius_mm();
    return scattering * (1 - scattering_loss * share * share);
  }

  /// Depth at which the pixel's ray meets the free pad; NaN where it misses the base.
  double free_depth(Index row, Index col) const {
    const auto r = ray(row, col);
    if (!(r.plate_rho_mm < base_radius_mm())) {
      return nan;
    }
    // (rho + t z)^2 + (z - z0)^2 = R^2
    const double z0 = height_mm - sphere_radius_mm;
    const double a = 1 + r.tan_fluid * r.tan_fluid;
    const double b = z0 - r.plate_rho_mm * r.tan_fluid;
    const double c =
        r.plate_rho_mm * r.plate_rho_mm + z0 * z0 - sphere_radius_mm * sphere_radius_mm;
    return (b + std::sqrt(b * b - a * c)) / a;
  }
  /// Some printed dots: every seventh pixel and its neighbour are darker.
  double dotted_brightness(Index row, Index col) const {
    return brightness * ((row % 7 < 2 && col % 7 < 2) ? 0.4 : 1.0);
  }

  fingerpad::Colour<double> colour(Index row, Index col, double depth_mm, double bright) const {
    return fingerpad::colour_at_depth(fluid, pencil(row, col), bright, g(row, col), depth_mm);
  }

  Image<double> free_depths() const {
    Image<double> depth(rows, cols);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        depth(i, j) = free_depth(i, j);
      }
    }
    return depth;
  }
  Image<double> pressed_depths(double press_mm) const {
    Image<double> depth = free_depths();
    for (double& l : depth.cells) {
      l = l < height_mm - press_mm ? l : l != l ? l : height_mm - press_mm;
    }
    return depth;
  }

  /// Frame of a membrane at these depths, black outside, with `noise` in grey levels.
  template <class Pixel>
  Frame<Pixel> frame(const Image<double>& depth_mm,
                     double noise = 0,
                     std::uint64_t seed = 1) const {
    Frame<Pixel> frame(rows, cols);
    Random random(seed);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        if (depth_mm(i, j) != depth_mm(i, j)) {
          continue;
        }
        const auto c = colour(i, j, depth_mm(i, j), dotted_brightness(i, j));
        frame.red(i, j) = stored<Pixel>(c.red + (noise > 0 ? noise * random.normal() : 0));
        frame.green(i, j) = stored<Pixel>(c.green + (noise > 0 ? noise * random.normal() : 0));
      }
    }
    return frame;
  }

  /// Result of fit_reference() for a frame of the free pad without noise.
  template <class S>
  auto reference() const {
    const Image<double> depth = free_depths();
    const auto free = frame<double>(depth);
    return fingerpad::fit_reference<S>(camera, fluid, free.red, free.green, depth);
  }

  template <class S>
  fingerpad::DepthEstimator<S> estimator(const fingerpad::DepthOptions& options = {}) const {
    return {camera, fluid, reference<S>(), options};
  }

  /// The pad in the symbols of the printed method.
  fingerpad::published::DepthOptions<double> published(int window_px = 29) const {
    return {{camera.plate_distance_mm, camera.refractive_index, camera.center_y_px,
             camera.center_x_px, camera.pitch_mm},
            {fluid.c_red_per_mm, fluid.c_green_per_mm, fluid.kappa},
            window_px,
            16,
            fluid.max_depth_mm};
  }
};

/// A pad in the middle of such frames.
inline Pad pad_of(Index rows, Index cols, double pitch_mm) {
  Pad pad;
  pad.rows = rows;
  pad.cols = cols;
  pad.camera.pitch_mm = pitch_mm;
  pad.camera.center_x_px = static_cast<double>(cols - 1) / 2;
  pad.camera.center_y_px = static_cast<double>(rows - 1) / 2;
  return pad;
}

/// Results of an estimator for one frame.
template <class S>
struct Estimate {
  fingerpad::DepthResult result;
  Image<S> depth_mm;
  Image<fingerpad::PixelStatus> status;
  Estimate(Index rows, Index cols)
      : depth_mm(rows, cols, S(-1)), status(rows, cols, fingerpad::PixelStatus::ok) {}
};

template <class S, class Pixel>
Estimate<S> estimate(fingerpad::DepthEstimator<S>& estimator, const Frame<Pixel>& frame) {
  Estimate<S> e(frame.red.rows(), frame.red.cols());
  e.result = estimator(frame.red, frame.green, e.depth_mm, e.status);
  return e;
}
template <class S, class Pixel>
Estimate<S> estimate(fingerpad::DepthEstimator<S>&& estimator, const Frame<Pixel>& frame) {
  return estimate(estimator, frame);
}

/// Largest |a - b| where b is a number; infinite if a is NaN there.
template <class A, class B>
double largest_error(const Image<A>& a, const Image<B>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < b.cells.size(); ++k) {
    const double expected = static_cast<double>(b.cells[k]);
    const double error = std::abs(static_cast<double>(a.cells[k]) - expected);
    if (expected == expected && !(error <= worst)) {
      worst = error == error ? error : std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

}  // namespace test
