// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The surface fitted to a contact in a float depth map of 640 x 480 pixels with noise of 0.02 mm,
// along refracted rays. Timed: a convex sphere of 18 mm, 200 px wide.
// Errors: of the mean curvature over 40 spheres of 15 to 40 mm in other places, and of the normal
// over 40 planes of slopes up to 0.4. First row: a pass that reads depth and mask and sums the
// depths in contact.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/optics/camera.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

using Mask = Image<unsigned char>;

constexpr Index height_px = 480, width_px = 640;
constexpr std::size_t pixels = height_px * width_px;
constexpr double noise_mm = 0.02;

/// z = 9 mm + slope . (p - p0) + the rise of a sphere about p0, the middle of the contact.
struct Object {
  double curvature_per_mm = 1.0 / 18;
  Point2<double> slope = {0, 0};
  Point2<double> middle_px = {319.5, 239.5};
  double contact_px = 100;

  double depth_mm(double x, double y) const {
    const double r_sq = x * x + y * y;
    const double root = std::sqrt((std::max)(1 - square(curvature_per_mm) * r_sq, 0.0));
    return 9 + slope.x * x + slope.y * y + curvature_per_mm * r_sq / (1 + root);
  }
};

std::vector<Object> varied_objects(bool flat) {
  std::vector<Object> objects(40);
  test::Random random(4);
  for (Object& o : objects) {
    if (flat) {
      o.slope = {random.uniform(-0.28, 0.28), random.uniform(-0.28, 0.28)};
    }
    o.curvature_per_mm = flat ? 0 : 1 / random.uniform(15, 40);
    o.middle_px = {319.5 + random.uniform(-50, 50), 239.5 + random.uniform(-50, 50)};
    o.contact_px = random.uniform(60, 110);
  }
  return objects;
}

/// Of the normal, in degrees.
double tilt_of(const Point3<double>& n, const Object& o) {
  const double x = n.x + o.slope.x * n.z, y = n.y + o.slope.y * n.z;
  const double z = o.slope.x * n.y - o.slope.y * n.x;
  const double length = std::sqrt(1 + square(o.slope.x) + square(o.slope.y));
  return std::asin(std::sqrt(x * x + y * y + z * z) / length) * 180 / std::numbers::pi;
}

/// Depths and mask of an object; NaN outside the contact.
struct Contact {
  Image<float> depth{height_px, width_px, static_cast<float>(test::nan)};
  Mask mask{height_px, width_px, 0};

  Contact(const Camera<double>& camera, const Object& o, std::uint64_t seed) {
    test::Random random(seed);
    const auto middle = point_at(camera, o.middle_px.y, o.middle_px.x, 9.0);
    for (Index i = 0; i < height_px; ++i) {
      for (Index j = 0; j < width_px; ++j) {
        const double row = static_cast<double>(i), col = static_cast<double>(j);
        if (std::hypot(col - o.middle_px.x, row - o.middle_px.y) > o.contact_px) {
          continue;
        }
        double z = 9;
        for (int step = 0; step < 40; ++step) {
          const auto p = point_at(camera, row, col, z);
          const double next = o.depth_mm(p.x - middle.x, p.y - middle.y);
          const bool is_there = std::abs(next - z) < 1e-10;
          z = next;
          if (is_there) {
            break;
          }
        }
        mask(i, j) = 255;
        depth(i, j) = static_cast<float>(z + noise_mm * random.normal());
      }
    }
  }
};

struct Bench {
  Camera<double> camera = {};
  std::shared_ptr<const Contact> timed = std::make_shared<Contact>(camera, Object(), 1);

  /// `fit(contact, object)` returns the error.
  template <class Fit>
  void add_fit(const std::string& name, bool flat, long bytes, const Fit& fit) const {
    const auto errors = bench::kept([=, this] {
      std::vector<double> all;
      std::uint64_t seed = 1;
      for (const Object& o : varied_objects(flat)) {
        all.push_back(fit(Contact(camera, o, ++seed), o));
      }
      return all;
    });
    bench::add(
        "rays/" + name, pixels, bytes,
        [=, contact = timed] { benchmark::DoNotOptimize(fit(*contact, Object())); },
        [=](auto& counters) {
          bench::note_errors(counters, flat ? "normal" : "curvature", flat ? "deg" : "1/mm",
                             errors());
        });
  }

  /// The plane by least squares in depth, from the points in contact.
  void add_opencv() const {
    const bench::Memory memory;
    const auto unknowns = std::make_shared<std::vector<double>>(3 * pixels);
    const auto depths = std::make_shared<std::vector<double>>(pixels);
    const auto fit = [=, camera = camera](const Contact& c, const Object& o) {
      int count = 0;
      for (Index i = 0; i < height_px; ++i) {
        for (Index j = 0; j < width_px; ++j) {
          if (c.mask(i, j) != 0) {
            const auto p = point_at(camera, double(i), double(j), double(c.depth(i, j)));
            double* row = unknowns->data() + 3 * count;
            row[0] = 1;
            row[1] = p.x;
            row[2] = p.y;
            (*depths)[static_cast<std::size_t>(count++)] = p.z;
          }
        }
      }
      const cv::Mat a(count, 3, CV_64F, unknowns->data()), b(count, 1, CV_64F, depths->data());
      cv::Mat x;
      cv::solve(a, b, x, cv::DECOMP_NORMAL | cv::DECOMP_CHOLESKY);
      const double slope_x = x.at<double>(1), slope_y = x.at<double>(2);
      const double length = std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
      return tilt_of({-slope_x / length, -slope_y / length, 1 / length}, o);
    };
    add_fit("cv::solve of a plane", true, memory.bytes(), fit);
  }

  void add_all() const {
    const auto sum = std::make_shared<double>(0);
    bench::add(
        "rays/streaming sum of depths", pixels, 0,
        [=, contact = timed] {
          for (std::size_t k = 0; k < pixels; ++k) {
            *sum +=
                contact->mask.cells[k] != 0 ? static_cast<double>(contact->depth.cells[k]) : 0.0;
          }
        },
        [](auto&) {});
    bench::add_streaming("rays", pixels);
    add_fit("quadric", false, 0, [camera = camera](const Contact& c, const Object& o) {
      const auto r = fit_surface(camera, c.depth, c.mask);
      return (r.curvature_1_per_mm + r.curvature_2_per_mm) / 2 - o.curvature_per_mm;
    });
    add_fit("normal of the quadric", true, 0, [camera = camera](const Contact& c, const Object& o) {
      return tilt_of(fit_surface(camera, c.depth, c.mask).normal, o);
    });
    add_opencv();
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench surface{};  // outlives the rows
  surface.add_all();
  return bench::run(argc, argv);
}
