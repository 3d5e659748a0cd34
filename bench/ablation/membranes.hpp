// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finite-element membranes (tests/data/README.md) as shapes, as frames of 640 x 480 pixels and as
// the contact that is known of them. What a scene stands for:
//   free                 the pad that nothing touches
//   press                flat plate, 3.5 mm deep
//   drag                 flat plate dragged half way to slip, and slipping
//   reversal             the same half way back
//   twist                flat plate turned half way to slip, and slipping
//   normal force change  flat plate deeper step by step while it is dragged and turned
//   rolling              ball of 18 mm, half way of rolling
//   wedge                cylinder of 12 mm, pressed, and dragged: an edge, as it were
//   tilted               plate tilted by 8 degrees, pressed, and dragged
//   noisy                the press with twice the noise: 2 grey levels
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../../tests/support/pad.hpp"
#include "fingerpad/optics.hpp"
#include "table.hpp"

namespace bench::ablation {

using fingerpad::Camera;
using fingerpad::Index;
using test::Image;

inline constexpr double base_radius_mm = 18.735;

inline void require(bool held, const std::string& what) {
  if (!held) {
    std::fprintf(stderr, "ablation: %s\n", what.c_str());
    std::exit(1);
  }
}

inline std::ifstream open_data(const std::string& name, const std::string& header) {
  const auto bench = std::filesystem::path(__FILE__).parent_path().parent_path();
  std::ifstream file(bench.parent_path() / "tests" / "data" / name, std::ios::binary);
  std::string found(header.size(), ' ');
  file.read(found.data(), static_cast<std::streamsize>(found.size()));
  require(found == header, "no data: " + name);
  return file;
}

/// 160 x 160 samples 0.24 mm apart around the axis: heights, and what touches.
class Membrane {
 public:
  explicit Membrane(const std::string& name)
      : heights_(samples, samples), touches_(samples, samples) {
    auto heights = open_data(name + ".pgm", "P5\n160 160\n65535\n");
    for (double& h : heights_.cells) {
      const int high = heights.get();
      h = (256 * high + heights.get()) / 4000.0 - 2;
    }
    if (name == "free") {
      return;
    }
    auto bits = open_data(name + ".pbm", "P4\n160 160\n");
    for (std::size_t k = 0; k < touches_.cells.size(); k += 8) {
      const int byte = bits.get();
      for (std::size_t bit = 0; bit < 8; ++bit) {
        touches_.cells[k + bit] = byte >> (7 - bit) & 1;
      }
    }
    require(heights.good() && bits.good(), "short file: " + name);
  }

  /// By cubic interpolation.
  double height(double x_mm, double y_mm) const {
    const double col = position(x_mm, 1), row = position(y_mm, 1);
    const Index j = static_cast<Index>(col), i = static_cast<Index>(row);
    double along[4];
    for (Index k = 0; k < 4; ++k) {
      along[k] = cubic(&heights_(i - 1 + k, j - 1), col - static_cast<double>(j));
    }
    return cubic(along, row - static_cast<double>(i));
  }
  /// By linear interpolation.
  bool touches(double x_mm, double y_mm) const {
    const double col = position(x_mm, 0), row = position(y_mm, 0);
    const Index j = static_cast<Index>(col), i = static_cast<Index>(row);
    const double u = col - static_cast<double>(j), v = row - static_cast<double>(i);
    return (1 - v) * ((1 - u) * touches_(i, j) + u * touches_(i, j + 1)) +
               v * ((1 - u) * touches_(i + 1, j) + u * touches_(i + 1, j + 1)) >=
           0.5;
  }
  /// In plan; 0 of the free pad.
  double area_mm2() const {
    double sum = 0;
    for (const double t : touches_.cells) {
      sum += t;
    }
    return sum * 0.24 * 0.24;
  }

 private:
  static constexpr Index samples = 160;
  static double position(double mm, double margin) {
    const double at = mm / 0.24 + (static_cast<double>(samples) - 1) / 2;
    return (std::min)((std::max)(at, margin), static_cast<double>(samples) - 2.001 - margin);
  }
  static double cubic(const double* h, double t) {  // Catmull and Rom
    const double a = 3 * (h[1] - h[2]) + h[3] - h[0];
    const double b = 2 * h[0] - 5 * h[1] + 4 * h[2] - h[3];
    return h[1] + t * (h[2] - h[0] + t * (b + t * a)) / 2;
  }
  Image<double> heights_;
  Image<double> touches_;  // 1 or 0; free: 0
};

/// The published pad before the default camera.
inline test::Pad published_pad() {
  test::Pad pad;
  pad.rows = 480;
  pad.cols = 640;
  pad.camera = Camera<double>();
  return pad;
}

/// Where every pixel's ray meets the membrane; NaN outside of the base.
inline Image<double> depths(const test::Pad& pad, const Membrane& membrane) {
  Image<double> depth(pad.rows, pad.cols, test::nan);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const auto at = [&](double z) {
        return point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), z);
      };
      const auto foot = at(0), top = at(1);
      if (std::hypot(foot.x, foot.y) >= base_radius_mm) {
        continue;
      }
      const auto above = [&](double z) {
        return membrane.height(foot.x + z * (top.x - foot.x), foot.y + z * (top.y - foot.y)) - z;
      };
      double low = 0, high = 14, at_low = above(low), at_high = above(high), z = 0;
      for (int step = 0; step < 60 && at_low > 0 && high - low > 1e-6; ++step) {
        // every third step halves, or a steep end would stay where it is
        const double secant = low + (high - low) * at_low / (at_low - at_high);
        z = step % 3 == 2 ? (low + high) / 2 : secant;
        const double f = above(z);
        if (std::abs(f) < 1e-6) {
          break;
        }
        (f > 0 ? low : high) = z;
        (f > 0 ? at_low : at_high) = f;
      }
      depth(i, j) = z;
    }
  }
  return depth;
}

/// Membrane darker toward the rim, dots of 0.6 mm every 1.5 mm.
inline test::Frame<std::uint8_t> frame_of(const test::Pad& pad,
                                          const Image<double>& depth_mm,
                                          std::uint64_t seed,
                                          double noise) {
  test::Frame<std::uint8_t> frame(pad.rows, pad.cols, 3);
  test::Random random(seed);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const double l = depth_mm(i, j);
      if (std::isnan(l)) {
        continue;
      }
      const auto p = point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), l);
      const double u = p.x - 1.5 * std::round(p.x / 1.5), v = p.y - 1.5 * std::round(p.y / 1.5);
      const double share = (p.x * p.x + p.y * p.y) / (base_radius_mm * base_radius_mm);
      const double bright = 57 * (1 - 0.06 * share) * (u * u + v * v < 0.09 ? 0.4 : 1);
      const auto c = pad.colour(i, j, l, bright);
      frame.red(i, j) = test::stored<std::uint8_t>(c.red + noise * random.normal());
      frame.green(i, j) = test::stored<std::uint8_t>(c.green + noise * random.normal());
    }
  }
  return frame;
}

/// The reference of a camera, or of what is taken for it, from the mean of many free frames: 1/4 of
/// a grey level of noise, 16 bit. `seen_mm`: what there is; `known_mm`: where the rays of `camera`
/// meet the free pad.
inline fingerpad::DepthReference<float> reference_of(const test::Pad& pad,
                                                     const Camera<double>& camera,
                                                     const Image<double>& seen_mm,
                                                     const Image<double>& known_mm) {
  test::Frame<std::uint16_t> mean(pad.rows, pad.cols);
  test::Random random(99);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      if (!std::isnan(seen_mm(i, j))) {
        const auto c = pad.colour(i, j, seen_mm(i, j), 57);
        mean.red(i, j) = test::stored<std::uint16_t>(c.red + 0.25 * random.normal());
        mean.green(i, j) = test::stored<std::uint16_t>(c.green + 0.25 * random.normal());
      }
    }
  }
  return fit_reference(camera, pad.fluid, mean.red, mean.green, known_mm);
}

/// Shapes by scene; `heights` is the name of the data. The same shapes serve depth, contact, force.
struct ShapeOfScene {
  Scene scene;
  const char* heights;
  double noise = 1;  ///< grey levels
};
inline const std::vector<ShapeOfScene>& shapes() {
  static const std::vector<ShapeOfScene> all = {{Scene::free, "free"},
                                                {Scene::press, "press"},
                                                {Scene::drag, "wrench_drag_a"},
                                                {Scene::drag, "wrench_drag_b"},
                                                {Scene::reversal, "wrench_drag_c"},
                                                {Scene::twist, "wrench_twist_a"},
                                                {Scene::twist, "wrench_twist_b"},
                                                {Scene::normal_force_change, "wrench_mix_a"},
                                                {Scene::normal_force_change, "wrench_mix_b"},
                                                {Scene::normal_force_change, "wrench_mix_c"},
                                                {Scene::normal_force_change, "wrench_mix_d"},
                                                {Scene::rolling, "roll"},
                                                {Scene::wedge, "cylinder"},
                                                {Scene::wedge, "wrench_cylinder_b"},
                                                {Scene::tilted, "tilt"},
                                                {Scene::tilted, "wrench_tilt_b"},
                                                {Scene::noisy, "press", 2}};
  return all;
}

/// A shape, and of every pixel the point that it sees and whether that touches.
struct Seen {
  ShapeOfScene of;
  std::uint64_t seed;
  double area_mm2;  ///< of the contact
  Image<double> depth_mm;
  Image<fingerpad::Point3<double>> point_mm;
  Image<std::uint8_t> touches;

  Seen(const test::Pad& pad, const ShapeOfScene& shape, std::uint64_t number)
      : of(shape), seed(number), point_mm(pad.rows, pad.cols), touches(pad.rows, pad.cols) {
    const Membrane membrane(shape.heights);
    area_mm2 = membrane.area_mm2();
    depth_mm = depths(pad, membrane);
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        const auto p =
            point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), depth_mm(i, j));
        point_mm(i, j) = p;
        touches(i, j) = !std::isnan(p.z) && membrane.touches(p.x, p.y) ? 1 : 0;
      }
    }
  }
};

}  // namespace bench::ablation
