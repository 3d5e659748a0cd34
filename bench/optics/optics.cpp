// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Virtual heights and points, one call for each pixel of an image. Errors are against long double
// at the same pixel: the worse of the two heights; the position of a point. "published": one
// height, and the sine of eq. 13.
#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/optics/camera.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "fingerpad/published/depth.hpp"

using namespace fingerpad;

namespace {

using Long = long double;
constexpr Index rows = 480, cols = 640;
constexpr std::size_t pixels = rows * cols;

/// Calls `visit(k, row, col, depth)` for each pixel.
template <class S, class Visit>
void each_pixel(const Visit& visit) {
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      visit(static_cast<std::size_t>(i * cols + j), S(i), S(j), S(1 + (i + j) % 12));
    }
  }
}

/// The same camera in the symbols of the slides, which neglect the plate.
template <class S>
published::Pinhole<S> pinhole_of(const Camera<S>& c) {
  return {c.plate_distance_mm, c.refractive_index, c.center_y_px, c.center_x_px, c.pitch_mm};
}

/// Of the pencil that comes back along a ray.
template <class S>
struct Heights {
  S meridional_mm = 0, sagittal_mm = 0;

  Heights() = default;
  Heights(const Ray<S>& ray) : meridional_mm(ray.meridional_mm), sagittal_mm(ray.sagittal_mm) {}
  Heights(const S& both) : meridional_mm(both), sagittal_mm(both) {}
};

double error(const Heights<Long>& a, const Heights<Long>& b) {
  return static_cast<double>((std::max)(std::abs(a.meridional_mm - b.meridional_mm),
                                        std::abs(a.sagittal_mm - b.sagittal_mm)));
}
double error(const Point3<Long>& a, const Point3<Long>& b) {
  return static_cast<double>(std::hypot(a.x - b.x, a.y - b.y));
}

template <class S>
Heights<Long> widened(const Heights<S>& h) {
  Heights<Long> out(Long(h.meridional_mm));
  out.sagittal_mm = Long(h.sagittal_mm);
  return out;
}
template <class S>
Point3<Long> widened(const Point3<S>& p) {
  return {Long(p.x), Long(p.y), Long(p.z)};
}

/// `call(k, row, col, depth)` and `truth(row, col, depth)` are in mm, px or 1.
template <class S, class Call, class Truth>
void add(const std::string& name,
         const std::string& quantity,
         const std::string& unit,
         const Call& call,
         const Truth& truth) {
  using Result = decltype(call(std::size_t(0), S(0), S(0), S(1)));
  const bench::Memory memory;
  const auto out = std::make_shared<std::vector<Result>>(pixels);
  bench::add(
      name, pixels, memory.bytes(),
      [=] {
        each_pixel<S>([&, to = out->data()](std::size_t k, S row, S col, S depth) {
          to[k] = call(k, row, col, depth);
        });
      },
      [=](auto& counters) {
        std::vector<double> errors;
        each_pixel<Long>([&](std::size_t k, Long row, Long col, Long depth) {
          errors.push_back(error(widened((*out)[k]), truth(row, col, depth)));
        });
        bench::note_errors(counters, quantity, unit, errors);
      });
}

/// All calls with one camera in one scalar; CameraOf<S> is Camera<S> or OrthographicCamera<S>.
template <class S, template <class> class CameraOf>
struct Calls {
  std::string row;
  CameraOf<S> camera;
  CameraOf<Long> exact = cast<Long>(camera);

  Calls(const std::string& name, const CameraOf<double>& c) : row(name), camera(cast<S>(c)) {}

  auto exact_heights() const {
    return [e = exact](Long i, Long j, Long) { return Heights<Long>(ray_at_pixel(e, i, j)); };
  }
  void add_heights() const {
    add<S>(
        "virtual heights/" + row, "height", "mm",
        [c = camera](std::size_t, S i, S j, S) { return Heights<S>(ray_at_pixel(c, i, j)); },
        exact_heights());
  }
  void add_published() const {
    const auto pinhole = pinhole_of(camera);
    add<S>(
        "virtual heights/SingleHeight, published, " + row, "height", "mm",
        [pinhole](std::size_t, S i, S j, S) {
          const S h2 = published::ray_of(pinhole, i, j).h2_mm;
          return Heights<S>(h2);
        },
        exact_heights());
    add<S>(
        "point/published sine, " + row, "point", "mm",
        [pinhole](std::size_t, S i, S j, S z) { return published::point_at(pinhole, i, j, z); },
        [e = exact](Long i, Long j, Long z) { return point_at(e, i, j, z); });
  }
  void add_points() const {
    add<S>(
        "point/" + row, "point", "mm",
        [c = camera](std::size_t, S i, S j, S z) { return point_at(c, i, j, z); },
        [e = exact](Long i, Long j, Long z) { return point_at(e, i, j, z); });
  }
};

/// Straight rays of a camera with radial distortion, and remapping of an image.
void add_all_opencv() {
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 1000, 0, 319.5, 0, 1000, 239.5, 0, 0, 1);
  const std::vector<double> distortion{-0.1, 0.01, 0, 0};
  cv::Mat from(int(pixels), 1, CV_32FC2), image(int(rows), int(cols), CV_32F, 1.0);
  cv::Mat map[2] = {image.clone(), image.clone()};
  each_pixel<float>([&](std::size_t k, float i, float j, float) {
    from.at<cv::Point2f>(int(k)) = {j, i};
    map[0].at<float>(int(k / cols), int(k % cols)) = j + 0.3F;
    map[1].at<float>(int(k / cols), int(k % cols)) = i + 0.3F;
  });
  cv::Mat points = from.clone(), carried = image.clone();
  constexpr long bytes = sizeof(float) * pixels;
  bench::add(
      "point/cv::undistortPoints, float", pixels, 2 * bytes,
      [=]() mutable { cv::undistortPoints(from, points, matrix, distortion); }, [](auto&) {});
  bench::add(
      "point/cv::remap, float, linear", pixels, bytes,
      [=]() mutable { cv::remap(image, carried, map[0], map[1], cv::INTER_LINEAR); }, [](auto&) {});
  bench::add_streaming("point", pixels);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const auto camera = bench::full_pad().pad.camera;
  auto behind_plate = camera;
  behind_plate.plate_thickness_mm = 5;
  const OrthographicCamera<double> from_above;
  const Calls<double, Camera> thin("double", camera), thick("double, plate of 5 mm", behind_plate);
  const Calls<float, Camera> single("float", camera);
  const Calls<double, OrthographicCamera> heights("OrthographicCamera, double", from_above);
  thin.add_heights();
  single.add_heights();
  thick.add_heights();
  thin.add_published();
  const auto add_points = [](const auto&... calls) { (calls.add_points(), ...); };
  add_points(thin, single, thick, heights);
  add_all_opencv();
  return bench::run(argc, argv);
}
