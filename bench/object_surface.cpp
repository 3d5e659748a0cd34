// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Shapes fitted to a contact 200 px wide in a float depth map of 640x480: a convex sphere of 18 mm
// with noise of 0.02 mm, seen along refracted rays and as a map of heights. The error is that of
// the curvature, per mm; of the plane's it is that of its tilt, rad. First row: a pass that reads
// depth and mask and adds up the depths in contact.
#include "fingerpad/object_surface.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <type_traits>

#include "support/run.hpp"
#include "support/scene.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

using Mask = Image<unsigned char>;

constexpr double radius_mm = 18;

double error_of(const Plane<double>& p) {
  return p.tilt().total_rad;
}
double error_of(const Sphere<double>& s) {
  return std::abs(s.curvature_per_mm - 1 / radius_mm);
}
double error_of(const Quadric<double>& q) {
  return std::abs(q.mean_curvature_per_mm() - 1 / radius_mm);
}

template <class CameraType>
struct Bench {
  CameraType camera = {};
  Image<float> depth{480, 640, static_cast<float>(test::nan)};
  Mask mask{480, 640, 0};
  std::string group;

  explicit Bench(const std::string& name) : group(name) {
    test::Random random(1);
    for (Index i = 0; i < 480; ++i) {
      for (Index j = 0; j < 640; ++j) {
        const double y = static_cast<double>(i) - camera.center_y_px;
        const double x = static_cast<double>(j) - camera.center_x_px;
        mask(i, j) = x * x + y * y <= 100 * 100 ? 255 : 0;
        depth(i, j) = static_cast<float>(sphere_depth(i, j) + 0.02 * random.normal());
      }
    }
  }

  /// Where the pixel's ray meets the sphere whose lowest point is 9 mm deep on the axis.
  double sphere_depth(Index i, Index j) const {
    double z = 9;
    for (int step = 0; step < 40; ++step) {
      const auto p = point_at(camera, static_cast<double>(i), static_cast<double>(j), z);
      const double r_sq = (std::min)(p.x * p.x + p.y * p.y, radius_mm * radius_mm);
      z = 9 + r_sq / (radius_mm + std::sqrt(radius_mm * radius_mm - r_sq));
    }
    return z;
  }

  void add_stream() const {
    const auto sum = std::make_shared<double>(0);
    bench::add(
        group + "/streaming sum of depths", depth.cells.size(),
        [=, this] {
          for (std::size_t k = 0; k < depth.cells.size(); ++k) {
            *sum += mask.cells[k] != 0 ? static_cast<double>(depth.cells[k]) : 0.0;
          }
        },
        [](auto&) {});
  }

  template <class Model>
  void add(const std::string& name, Index border_px = 0) const {
    using Fit = SurfaceFit<Model, CameraType>;
    const SurfaceOptions options{50, border_px};
    const auto fit = std::make_shared<Fit>(480, 640, camera, options);
    const auto out = std::make_shared<Image<float>>(480, 640);
    const auto note = [=, this](auto& counters) {
      counters[std::is_same_v<Model, PlaneModel> ? "tilt_error_rad" : "curvature_error_1/mm"] =
          error_of((*fit)(depth, mask).shape);
    };
    bench::add(
        group + "/" + name, depth.cells.size(),
        [=, this] { benchmark::DoNotOptimize((*fit)(depth, mask)); }, note);
    if (border_px == 0) {
      bench::add(
          group + "/" + name + ", residual map", depth.cells.size(),
          [=, this] { benchmark::DoNotOptimize((*fit)(depth, mask, *out)); }, note);
    }
  }

  void add_all() const {
    add_stream();
    add<PlaneModel>("plane");
    add<SphereModel>("sphere");
    add<QuadricModel>("quadric");
    add<QuadricModel>("quadric, border of 6 px left out", 6);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Bench<Camera<double>> rays("rays");
  const Bench<OrthographicCamera<double>> heights("heights");
  rays.add_all();
  heights.add_all();
  return bench::run(argc, argv);
}
