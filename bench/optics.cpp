// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Rays, points and pixels, one call for each pixel of an image. The error of a ray is that of its
// path factor against long double; of a point, that of x in mm; of a pixel, how far from where it
// started the way through point_at and pixel_of ends.
#include "fingerpad/optics.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "support/run.hpp"
#include "support/scene.hpp"

using namespace fingerpad;

namespace {

template <class S>
struct Bench {
  std::string type;
  double plate_thickness_mm;
  bench::Scene scene = bench::full_pad();
  Camera<S> camera = make_camera<S>();

  template <class T>
  Camera<T> make_camera() const {
    auto c = scene.pad.camera;
    c.plate_thickness_mm = plate_thickness_mm;
    return cast<T>(c);
  }

  /// call(camera, row, col, depth) of each pixel; error_of(result, row, col, depth).
  template <class Call, class ErrorOf>
  void add(const std::string& name, const std::string& unit, Call call, ErrorOf error_of) const {
    using Result = decltype(call(camera, S(0), S(0), S(1)));
    const auto out = std::make_shared<std::vector<Result>>(scene.pixels());
    const auto each_pixel = [rows = scene.pad.rows, cols = scene.pad.cols](auto&& visit) {
      for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < cols; ++j) {
          visit(i * cols + j, S(i), S(j), S(1 + (i + j) % 12));
        }
      }
    };
    const std::string plate = plate_thickness_mm > 0 ? "thick plate/" : "thin plate/";
    bench::add(
        plate + name + ", " + type, scene.pixels(),
        [=, this] {
          each_pixel([&, to = out->data()](Index k, S row, S col, S depth) {
            to[k] = call(camera, row, col, depth);
          });
        },
        [=](auto& counters) {
          double worst = 0;
          each_pixel([&](Index k, S row, S col, S depth) {
            worst = (std::max)(worst, error_of((*out)[std::size_t(k)], row, col, depth));
          });
          counters["max_error_" + unit] = worst;
        });
  }

  void add_all() const {
    using Long = long double;
    const Camera<Long> exact = make_camera<Long>();
    add(
        "ray_at_pixel", "k",
        [](const auto& c, S row, S col, S) { return ray_at_pixel(c, row, col); },
        [=](const Ray<S>& ray, S row, S col, S) {
          const auto truth = ray_at_pixel(exact, Long(row), Long(col));
          return double(std::abs(Long(ray.path_factor) - truth.path_factor));
        });
    add(
        "point_at", "mm",
        [](const auto& c, S row, S col, S depth) { return point_at(c, row, col, depth); },
        [=](const Point3<S>& point, S row, S col, S depth) {
          const auto truth = point_at(exact, Long(row), Long(col), Long(depth));
          return double(std::abs(Long(point.x) - truth.x));
        });
    add(
        "pixel_of(point_at)", "px",
        [](const auto& c, S row, S col, S depth) {
          return pixel_of(c, point_at(c, row, col, depth));
        },
        [](const Point2<S>& px, S row, S col, S) {
          return double(std::hypot(px.x - col, px.y - row));
        });
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Bench<double> thin{"double", 0};
  const Bench<double> thick{"double", 5};
  const Bench<float> single{"float", 0};
  thin.add_all();
  single.add_all();
  thick.add_all();
  return bench::run(argc, argv);
}
