// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "membrane.hpp"

#if __has_include(<xtensor/io/xnpy.hpp>)
#include <xtensor/io/xnpy.hpp>
#else
#include <xtensor/xnpy.hpp>
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/failure.hpp"

namespace render {
namespace {

namespace fs = std::filesystem;

template <class T>
auto read_npy(const fs::path& file, std::size_t dimensions) {
  try {
    auto array = xt::load_npy<T>(file.string());
    if (array.dimension() != dimensions || array.shape(dimensions - 1) != 3) {
      replay::fail(file, "must be an array of points or triangles");
    }
    return array;
  } catch (const std::runtime_error& error) {
    replay::fail(file, error.what());
  }
}

/// Row `step` of an array (steps, points, 3).
template <class Array>
std::vector<Point> points_of(const Array& array, std::size_t step) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < array.shape(1); ++i) {
    const auto at = [&](std::size_t axis) { return static_cast<double>(array(step, i, axis)); };
    points.push_back({at(0), at(1), at(2)});
  }
  return points;
}

/// Unit normals of the nodes: area-weighted means of the adjacent triangles' normals.
std::vector<Point> node_normals(const std::vector<std::array<int, 3>>& triangles,
                                const std::vector<Point>& nodes) {
  std::vector<Point> normals(nodes.size(), Point{0, 0, 0});
  for (const auto& [a, b, c] : triangles) {
    const auto at = [&](int i) { return nodes[static_cast<std::size_t>(i)]; };
    const Point n = cross(at(b) - at(a), at(c) - at(a));
    for (const int corner : {a, b, c}) {
      Point& sum = normals[static_cast<std::size_t>(corner)];
      sum = {sum.x + n.x, sum.y + n.y, sum.z + n.z};
    }
  }
  for (Point& n : normals) {
    const double length = std::sqrt(dot(n, n));
    n = {n.x / length, n.y / length, n.z / length};
  }
  return normals;
}

/// The straight part of a ray in the fluid: start + depth * direction, with direction.z = 1.
struct FluidRay {
  Point start;
  Point direction;
};

/// Samples and rays of an image.
class Rays {
 public:
  Rays(const fingerpad::Camera<double>& camera, cv::Size size, int samples)
      : camera_(camera),
        samples_(samples),
        rows_(size.height * samples),
        cols_(size.width * samples) {
    rays_.reserve(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_));
    for (int i = 0; i < rows_; ++i) {
      for (int j = 0; j < cols_; ++j) {
        const double row = (i + 0.5) / samples_ - 0.5;
        const double col = (j + 0.5) / samples_ - 0.5;
        const Point start = fingerpad::point_at(camera_, row, col, 0.0);
        rays_.push_back({start, fingerpad::point_at(camera_, row, col, 1.0) - start});
      }
    }
  }

  cv::Size size() const { return {cols_, rows_}; }
  const FluidRay& operator()(int i, int j) const {
    return rays_[static_cast<std::size_t>(i) * static_cast<std::size_t>(cols_) +
                 static_cast<std::size_t>(j)];
  }

  /// Bounding box of the samples that see `points`, extended by `margin` samples.
  cv::Rect around(const std::vector<Point>& points, double margin) const {
    double left = std::numeric_limits<double>::infinity();
    double top = left;
    double right = -left;
    double bottom = -left;
    for (const Point& point : points) {
      const auto pixel = fingerpad::pixel_of(camera_, point);
      left = (std::min)(left, (pixel.x + 0.5) * samples_ - 0.5);
      right = (std::max)(right, (pixel.x + 0.5) * samples_ - 0.5);
      top = (std::min)(top, (pixel.y + 0.5) * samples_ - 0.5);
      bottom = (std::max)(bottom, (pixel.y + 0.5) * samples_ - 0.5);
    }
    const cv::Point first(static_cast<int>(std::floor(left - margin)),
                          static_cast<int>(std::floor(top - margin)));
    const cv::Point last(static_cast<int>(std::ceil(right + margin)),
                         static_cast<int>(std::ceil(bottom + margin)));
    return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect(cv::Point(0, 0), size());
  }

 private:
  fingerpad::Camera<double> camera_;
  int samples_;
  int rows_;
  int cols_;
  std::vector<FluidRay> rays_;
};

/// Records in `sight` where rays hit the triangle; of several hits the nearest to the plate counts.
void meet_triangle(const Rays& rays,
                   const std::array<Point, 3>& corner,
                   const std::array<Point, 3>& normal,
                   Sight& sight) {
  const Point e1 = corner[1] - corner[0];
  const Point e2 = corner[2] - corner[0];
  const cv::Rect box = rays.around({corner[0], corner[1], corner[2]}, 1.0);
  constexpr double slack = 1e-9;  // so that no ray passes between two triangles
  for (int i = box.y; i < box.y + box.height; ++i) {
    for (int j = box.x; j < box.x + box.width; ++j) {
      const FluidRay& ray = rays(i, j);
      const Point p = cross(ray.direction, e2);
      const double volume = dot(e1, p);
      const Point from_corner = ray.start - corner[0];
      const double u = dot(from_corner, p) / volume;
      const Point q = cross(from_corner, e1);
      const double v = dot(ray.direction, q) / volume;
      if (!(u >= -slack && v >= -slack && u + v <= 1 + slack)) {
        continue;
      }
      const auto depth = static_cast<float>((std::max)(dot(e2, q) / volume, 0.0));
      if (sight.depth_mm(i, j) <= depth) {
        continue;
      }
      const double w = 1 - u - v;
      const Point n = {w * normal[0].x + u * normal[1].x + v * normal[2].x,
                       w * normal[0].y + u * normal[1].y + v * normal[2].y,
                       w * normal[0].z + u * normal[1].z + v * normal[2].z};
      sight.depth_mm(i, j) = depth;
      sight.upright(i, j) = static_cast<float>(std::abs(n.z) / std::sqrt(dot(n, n)));
    }
  }
}

void mark_dots(const Rays& rays, const std::vector<Point>& dots, double radius_mm, Sight& sight) {
  for (const Point& center : dots) {
    std::vector<Point> reach;
    for (const double dx : {-radius_mm, radius_mm}) {
      for (const double dy : {-radius_mm, radius_mm}) {
        reach.push_back({center.x + dx, center.y + dy, center.z});
      }
    }
    const cv::Rect box = rays.around(reach, 3.0);
    for (int i = box.y; i < box.y + box.height; ++i) {
      for (int j = box.x; j < box.x + box.width; ++j) {
        const double depth = static_cast<double>(sight.depth_mm(i, j));
        const FluidRay& ray = rays(i, j);
        const Point off = {ray.start.x + depth * ray.direction.x - center.x,
                           ray.start.y + depth * ray.direction.y - center.y, depth - center.z};
        if (dot(off, off) <= radius_mm * radius_mm) {
          sight.on_dot(i, j) = 1;
        }
      }
    }
  }
}

}  // namespace

Membrane read_membrane(const fs::path& folder) {
  const auto nodes = read_npy<float>(folder / "nodes.npy", 3);
  const auto dots = read_npy<float>(folder / "dots.npy", 3);
  const auto triangles = read_npy<int>(folder / "triangles.npy", 2);
  if (dots.shape(0) != nodes.shape(0)) {
    replay::fail(folder / "dots.npy", "must have as many steps as nodes.npy");
  }
  Membrane membrane;
  const int node_count = static_cast<int>(nodes.shape(1));
  for (std::size_t i = 0; i < triangles.shape(0); ++i) {
    const std::array<int, 3> corners = {triangles(i, 0), triangles(i, 1), triangles(i, 2)};
    for (const int corner : corners) {
      if (corner < 0 || corner >= node_count) {
        replay::fail(folder / "triangles.npy", "refers to a node that is not in nodes.npy");
      }
    }
    membrane.triangles.push_back(corners);
  }
  for (std::size_t step = 0; step < nodes.shape(0); ++step) {
    membrane.steps.push_back({points_of(nodes, step), points_of(dots, step)});
  }
  return membrane;
}

Sight look(const fingerpad::Camera<double>& camera,
           const std::vector<std::array<int, 3>>& triangles,
           const Step& step,
           cv::Size size,
           int samples,
           double dot_diameter_mm) {
  const Rays rays(camera, size, samples);
  Sight sight;
  // Infinite before the first hit, so that the comparison needs no special case.
  sight.depth_mm = cv::Mat_<float>(rays.size(), std::numeric_limits<float>::infinity());
  sight.upright = cv::Mat_<float>(rays.size(), 1.0F);
  sight.on_dot = cv::Mat_<uchar>(rays.size(), uchar{0});
  const std::vector<Point> normals = node_normals(triangles, step.nodes);
  for (const std::array<int, 3>& corners : triangles) {
    const auto pick = [&](const std::vector<Point>& from) {
      return std::array<Point, 3>{from[static_cast<std::size_t>(corners[0])],
                                  from[static_cast<std::size_t>(corners[1])],
                                  from[static_cast<std::size_t>(corners[2])]};
    };
    meet_triangle(rays, pick(step.nodes), pick(normals), sight);
  }
  mark_dots(rays, step.dots, dot_diameter_mm / 2, sight);
  for (float& depth : sight.depth_mm) {
    depth = std::isinf(depth) ? std::numeric_limits<float>::quiet_NaN() : depth;
  }
  return sight;
}

}  // namespace render
