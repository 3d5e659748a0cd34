// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/core/dots.hpp"

#include <Eigen/Core>
#include <array>
#include <limits>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;
using test::ForeignImage;

namespace {

/// A user's own point type, with names that no trait can guess.
struct OwnPoint {
  double across;
  double down;
};

using Dots = ForeignImage<Point2<double>>;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

template <>
struct fingerpad::point_traits<OwnPoint> {
  static constexpr bool adapted = true;
  static double x(const OwnPoint& p) { return p.across; }
  static double y(const OwnPoint& p) { return p.down; }
};

static_assert(planar_point<Point2<double>> && !spatial_point<Point2<double>>);
static_assert(spatial_point<Point3<float>> && spatial_point<Point3<Digits50>>);
static_assert(planar_point<cv::Point2f> && !spatial_point<cv::Point2f>);
static_assert(spatial_point<cv::Point3d>);
static_assert(planar_point<cv::Vec2d> && spatial_point<cv::Vec3f>);
static_assert(planar_point<Eigen::Vector2d> && spatial_point<Eigen::Vector3f>);
static_assert(planar_point<std::array<float, 2>> && spatial_point<std::array<double, 3>>);
static_assert(planar_point<OwnPoint> && !spatial_point<OwnPoint>);
static_assert(!planar_point<double> && !planar_point<int> && !planar_point<std::string>);
static_assert(dot_grid<Dots> && !dot_grid<ForeignImage<double>>);
static_assert(!spatial_dot_grid<Dots> && spatial_dot_grid<ForeignImage<Point3<double>>>);

TEMPLATE_TEST_CASE("coordinates are read from every point type",
                   "[dots]",
                   Point2<double>,
                   Point2<Digits50>,
                   cv::Point2f,
                   cv::Vec2d,
                   Eigen::Vector2d,
                   (std::array<float, 2>),
                   OwnPoint) {
  const TestType p{3, 5};
  REQUIRE(point_traits<TestType>::x(p) == 3);
  REQUIRE(point_traits<TestType>::y(p) == 5);
  REQUIRE(is_present(p));
}

TEMPLATE_TEST_CASE("depth is read from every spatial point type",
                   "[dots]",
                   Point3<float>,
                   cv::Point3d,
                   cv::Vec3f,
                   Eigen::Vector3d,
                   (std::array<double, 3>)) {
  const TestType p{3, 5, 7};
  REQUIRE(point_traits<TestType>::z(p) == 7);
  REQUIRE(is_present(p));
}

TEST_CASE("a dot with a coordinate that is not finite is missing", "[dots]") {
  for (const double bad : {missing, infinity, -infinity}) {
    CHECK_FALSE(is_present(Point2<double>{bad, 0}));
    CHECK_FALSE(is_present(Point2<double>{0, bad}));
    CHECK_FALSE(is_present(Point3<double>{0, 0, bad}));
    CHECK_FALSE(is_present(Eigen::Vector2d(bad, 0)));
    CHECK_FALSE(is_present(cv::Vec2d(0, bad)));
    CHECK_FALSE(is_present(OwnPoint{0, bad}));
  }
  CHECK(is_present(Point2<double>{999999, -999999}));
  CHECK_FALSE(is_present(Point2<double>{1e6, 0}));  // outside any pad or image
  CHECK_FALSE(is_present(Point3<double>{0, 0, -1e300}));
}

TEST_CASE("dots that come as a computed grid or a view are counted alike", "[dots]") {
  const LazyView diagonal_missing(4, 4, [](Index i, Index j) {
    return Point2<float>{i == j ? std::numeric_limits<float>::infinity() : 0.0f, 0.0f};
  });
  CHECK(count_present(diagonal_missing) == 12);
  std::vector<cv::Point2f> points(12);
  points[5].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(count_present(StridedView<const cv::Point2f>(points.data(), 3, 4, 4)) == 11);
}
