// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/image/curvature.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "support/cameras.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/rotated.hpp"

using namespace fingerpad;
using test::Image;
using test::refusal;

namespace {

constexpr double pi = 3.14159265358979323846;
using Plan = OrthographicCamera<double>;
using Through = Camera<double>;
using test::plan;
using test::through;

const Plan plate = plan(0.0768);

template <class S, class F>
Image<S> depths(Index rows, Index cols, const F& depth_at_mm, double pitch_mm = plate.pitch_mm) {
  Image<S> depth(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double x = (static_cast<double>(j) - static_cast<double>(cols - 1) / 2) * pitch_mm;
      const double y = (static_cast<double>(i) - static_cast<double>(rows - 1) / 2) * pitch_mm;
      depth(i, j) = static_cast<S>(depth_at_mm(x, y));
    }
  }
  return depth;
}

enum class Mean { clamped, plain };

template <Mean Of, class S, class CameraType = Plan>
Image<S> curvatures(const Image<S>& depth, double ring, const CameraType& camera = plate) {
  CurvatureMap<S> map(camera, depth.rows(), depth.cols(), ring);
  Image<S> clamped(depth.rows(), depth.cols(), S(7)), plain = clamped;
  REQUIRE(map(depth, clamped, plain).has_value());
  return Of == Mean::plain ? plain : clamped;
}

/// The mean at the middle pixel of an image of odd size.
template <Mean Of, class F, class CameraType = Plan>
double in_the_middle(const F& depth_at_mm, Index radius_px = 10, const CameraType& camera = plate) {
  const Index size = 2 * radius_px + 1;
  const Image<double> depth = depths<double>(size, size, depth_at_mm, camera.pitch_mm);
  return curvatures<Of>(depth, {static_cast<double>(radius_px)}, camera)(radius_px, radius_px);
}

}  // namespace

TEST_CASE("curvature: (K1) is the circle through three points, bulging outward positive") {
  const double radius = 20, angle = 0.03;
  for (const double middle : {0.0, 0.4, -1.1}) {
    // equally spaced in u: the ends are at sin(middle) +- step
    const double u = radius * std::sin(middle), step = radius * angle;
    const auto dome = [&](double x) { return std::sqrt(radius * radius - x * x); };
    const double k = section_curvature(step, dome(u - step), dome(u), dome(u + step));
    CHECK(k == Approx(1 / radius).epsilon(1e-11));
    CHECK(section_curvature(step, -dome(u - step), -dome(u), -dome(u + step)) == -k);
    CHECK(published::circle_center_curvature(step, dome(u - step), dome(u), dome(u + step)) ==
          Approx(k).epsilon(1e-10));
    CHECK(published::circle_center_curvature(step, -dome(u - step), -dome(u), -dome(u + step)) ==
          Approx(-k).epsilon(1e-10));
  }
  CHECK(section_curvature(0.768, 5.0, 5.0, 5.0) == 0);
  CHECK(section_curvature(0.768, 5.0, 6.0, 7.0) == 0);
  CHECK(std::isnan(published::circle_center_curvature(0.768, 5.0, 5.0, 5.0)));
}

TEST_CASE("curvature: vertical sections of a sphere carry the factor of their slope (E016)") {
  const double sphere = 20, step = 1e-3;
  for (const double degrees : {0.0, 20.0, 40.0, 60.0, 69.4}) {
    const double alpha = degrees * pi / 180, x0 = sphere * std::sin(alpha);
    const auto depth = [&](double x, double y) {
      return std::sqrt(sphere * sphere - x * x - y * y);
    };
    const auto along = [&](double theta) {
      const double x = step * std::cos(theta), y = step * std::sin(theta);
      return section_curvature(step, depth(x0 - x, -y), depth(x0, 0), depth(x0 + x, y));
    };
    CHECK(along(0) == Approx(1 / sphere).epsilon(1e-5));
    CHECK(along(pi / 2) == Approx(1 / (sphere * std::cos(alpha))).epsilon(1e-5));
    double sum = 0;
    for (int k = 0; k < 360; ++k) {
      sum += along(pi * k / 360);
    }
    CHECK(sum / 360 == Approx(2 / pi * std::comp_ellint_1(std::sin(alpha)) / sphere).epsilon(1e-5));
  }
}

TEST_CASE("curvature: maps of sphere, cylinder and saddle") {
  const auto sphere = [](double x, double y) { return std::sqrt(400 - x * x - y * y) - 7; };
  const auto cylinder = [](double x, double) { return std::sqrt(400 - x * x) - 7; };
  const auto saddle = [](double x, double y) { return 8 + (y * y - x * x) / 40; };
  CHECK(in_the_middle<Mean::plain>(sphere) == Approx(0.05).epsilon(1e-4));
  CHECK(in_the_middle<Mean::clamped>(sphere) == Approx(0.05).epsilon(1e-4));

  CHECK(in_the_middle<Mean::plain>(cylinder) == Approx(0.025).epsilon(2e-3));

  CHECK(in_the_middle<Mean::plain>(saddle) == Approx(0).margin(1e-6));
  // the directions of the nearest pixels are not quite evenly spaced
  CHECK(in_the_middle<Mean::clamped>(saddle) == Approx(0.05 / pi).epsilon(6e-2));
  CHECK(in_the_middle<Mean::clamped>(saddle, 40) == Approx(0.05 / pi).epsilon(2e-2));
}

TEMPLATE_TEST_CASE_SIG("curvature: nothing flat is lost, but by the published form",
                       "",
                       ((Mean Of), Of),
                       Mean::clamped,
                       Mean::plain) {
  const Index rows = 40, cols = 60, r = 10;
  const auto flat = [&](const auto& depth_at_mm, double bound) {
    const Image<float> depth = depths<float>(rows, cols, depth_at_mm);
    const Image<float> k = curvatures<Of>(depth, double(r));
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const bool inside = i >= r && i < rows - r && j >= r && j < cols - r;
        CAPTURE(i, j, k(i, j));
        CHECK((!inside || std::abs(static_cast<double>(k(i, j))) <= bound));
      }
    }
  };
  flat([](double, double) { return 10.5; }, 0);
  flat([](double x, double y) { return 8 + x / 16 - y / 8; }, 2e-5);  // depths rounded to float
  flat([](double x, double) { return std::floor(x * 20) / 4; }, 1e4);
}

TEST_CASE("curvature: seen through a camera a tilted plane stays flat, and a ball round") {
  const double growth = 1 / 66.5;
  const Through camera = through(0.0768, growth);
  for (const double slope : {0.0, 0.1, 0.5, 1.0}) {
    // the point at depth l is seen at x if it is at x (1 + c l)
    const auto plane = [&](double x, double y) {
      const double lateral = x * 0.6 + y * 0.8;
      return (8 + slope * lateral) / (1 - slope * lateral * growth);
    };
    CHECK(in_the_middle<Mean::plain>(plane, 25, camera) == Approx(0).margin(1e-12));
  }
  // a ball whose top is far enough from the axis that the membrane slopes on the axis
  for (const double degrees : {0.0, 25.0}) {
    const double alpha = degrees * pi / 180;
    const auto ball = [&](double x, double y) {
      double l = 8;
      for (int k = 0; k < 100; ++k) {
        const double s = 1 + growth * l, from_top = x * s + 20 * std::sin(alpha);
        l = std::sqrt(400 - from_top * from_top - y * y * s * s) - 20 * std::cos(alpha) + 8;
      }
      return l;
    };
    const double sections = 2 / pi * std::comp_ellint_1(std::sin(alpha)) / 20;
    CHECK(in_the_middle<Mean::plain>(ball, 10, camera) == Approx(sections).epsilon(5e-3));
    CHECK(in_the_middle<Mean::plain>(ball, 10) > 1.1 * sections);
  }
}

TEST_CASE("curvature: what refraction off the axis leaves of a tilted plane") {
  Camera<double> camera;  // rays of the exact camera, up to 27 degrees
  camera.center_x_px = 60;
  camera.center_y_px = 60;
  camera.pitch_mm = 0.3;
  const double slope = 0.5;
  Image<double> depth(121, 121);
  for (Index i = 0; i < 121; ++i) {
    for (Index j = 0; j < 121; ++j) {
      double l = 8;
      for (int k = 0; k < 60; ++k) {
        l = 8 + slope * point_at(camera, static_cast<double>(i), static_cast<double>(j), l).x;
        l = (std::min)((std::max)(l, -10.0), 30.0);
      }
      depth(i, j) = l;
    }
  }
  const Image<double> flat = curvatures<Mean::plain>(depth, 6, camera);
  const Image<double> bent = curvatures<Mean::plain>(depth, 6, plan(0.3));
  double worst = 0, worst_bent = 0;
  for (Index i = 20; i <= 100; ++i) {
    for (Index j = 40; j <= 80; ++j) {  // depths of 4 to 12 mm
      worst = (std::max)(worst, std::abs(flat(i, j)));
      worst_bent = (std::max)(worst_bent, std::abs(bent(i, j)));
    }
  }
  CAPTURE(worst, worst_bent);
  CHECK(worst < 5e-4);
  CHECK(worst_bent > 3e-3);
}

TEST_CASE("curvature: a ring is its own mirror image, at true distances") {
  const auto slides =
      detail::ring_offsets(25, 18);  // 25 cos(60 degrees) is midway between two pixels
  CHECK(std::count(slides.begin(), slides.end(), detail::RingOffset{22, 12}) == 1);
  CHECK(std::count(slides.begin(), slides.end(), detail::RingOffset{12, 22}) == 1);
  for (const double radius : {1., 2., 3., 10., 12.5, 25., 30.}) {
    for (const int directions : {3, 9, 18, 36}) {
      const auto ring = detail::ring_offsets(radius, directions);
      CHECK(ring.size() == static_cast<std::size_t>(directions));
      const auto count = [&](const detail::RingOffset& o) {
        return std::count(ring.begin(), ring.end(), o) +
               std::count(ring.begin(), ring.end(), detail::RingOffset{-o.row, -o.col});
      };
      for (const detail::RingOffset& o : ring) {
        CAPTURE(radius, directions, o.row, o.col);
        CHECK(std::abs(std::sqrt(o.distance_sq()) - radius) < 0.71);
        if (radius > 2) {
          CHECK(count({o.row, -o.col}) == count(o));
          CHECK((directions % 2 != 0 || count({o.col, o.row}) == count(o)));
        }
      }
    }
  }
}

TEST_CASE("curvature: pixels that are higher than wide see the same membrane") {
  const double growth = 1 / 66.5;
  const auto sphere = [](double x, double y) { return std::sqrt(400 - x * x - y * y) - 7; };
  const auto cylinder = [](double x, double) { return std::sqrt(400 - x * x) - 7; };
  const auto check = [&](auto camera, double aspect, double x_step, const auto& shape,
                         double expected, double share) {
    camera.pixel_aspect = aspect;
    Image<double> depth(61, 61);
    for (Index i = 0; i < 61; ++i) {
      for (Index j = 0; j < 61; ++j) {
        const double x = static_cast<double>(j - 30) * camera.pitch_mm;
        const double y = static_cast<double>(i - 30) * camera.pitch_mm * aspect;
        depth(i, j) = shape(x * x_step, y * x_step);
      }
    }
    CAPTURE(aspect, expected);
    for (const double ring : {10.0, 12.5}) {
      CHECK(curvatures<Mean::plain>(depth, ring, camera)(30, 30) ==
            Approx(expected).epsilon(share));
      CHECK(curvatures<Mean::clamped>(depth, ring, camera)(30, 30) ==
            Approx(expected).epsilon(share));
    }
  };
  for (const double aspect : {0.5, 0.915, 1.0, 1.093, 2.0}) {
    check(plate, aspect, 1, sphere, 0.05, 1e-3);
    check(plate, aspect, 1, cylinder, 0.025, 0.03);  // directions are not quite evenly spaced
    check(through(0.0768, growth), aspect, 1 + 13 * growth, sphere, 0.05, 0.01);
  }
  // the ring is round in mm, and its sections are mirror images of each other
  const auto ring = detail::ring_offsets(25, 18, 1.25);
  for (const detail::RingOffset& o : ring) {
    CHECK(std::abs(std::sqrt(o.distance_sq(1.25)) - 25) < 0.81);
    CHECK((o.row == 0 || o.col == 0 ||
           std::count(ring.begin(), ring.end(), detail::RingOffset{o.row, -o.col}) == 1));
  }
  CHECK(std::count(ring.begin(), ring.end(), detail::RingOffset{20, 0}) == 1);
}

TEST_CASE("curvature: other sizes are refused and nothing is written") {
  CurvatureMap<> map(plate, 9, 10, 2);
  const Image<float> depth(9, 10, 1.0F), narrow(9, 9, 1.0F);
  Image<float> out(9, 10, 7.0F), low(8, 10, 7.0F);
  CHECK_FALSE(map(narrow, out).has_value());
  CHECK_FALSE(map(depth, low).has_value());
  CHECK_FALSE(map(depth, out, low).has_value());
  CHECK_FALSE(map(depth, low, out).has_value());
  CHECK(out.cells == Image<float>(9, 10, 7.0F).cells);
  CHECK(low.cells == Image<float>(8, 10, 7.0F).cells);
  CHECK(map(depth, out).has_value());
}

TEST_CASE("curvature: bad parameters are refused by name, value and range") {
  const auto map = [](double ring_px, const auto& camera, Index rows, Index cols,
                      int directions = 18) {
    return refusal([&] { CurvatureMap<>(camera, rows, cols, ring_px, directions); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(map(1, plate, 4, 5) == "accepted");
  CHECK(map(1000, plate, 4, 5) == "accepted");
  CHECK(map(0, plate, 4, 5) == "CurvatureMap: ring_px = 0, must be in [1, 1000]");
  CHECK(map(1001, plate, 4, 5) == "CurvatureMap: ring_px = 1001, must be in [1, 1000]");
  CHECK(map(5, plate, 4, 5, 1) == "accepted");
  CHECK(map(5, plate, 4, 5, 360) == "accepted");
  CHECK(map(5, plate, 4, 5, 0) == "CurvatureMap: directions = 0, must be in [1, 360]");
  CHECK(map(5, plate, 4, 5, 361) == "CurvatureMap: directions = 361, must be in [1, 360]");
  CHECK(map(25, plan(0), 4, 5) == "OrthographicCamera: pitch_mm = 0, must be finite and > 0");
  CHECK(map(25, plan(1e-5), 4, 5) ==
        "CurvatureMap: camera.pitch_mm = 1e-05, must be in [0.0001, 10]");
  CHECK(map(25, plan(11), 4, 5) == "CurvatureMap: camera.pitch_mm = 11, must be in [0.0001, 10]");
  CHECK(map(25, through(nan, 0.01), 4, 5) == "Camera: pitch_mm = nan, must be finite and > 0");
  CHECK(map(25, through(0.1, -1), 4, 5).starts_with("Camera: plate_distance_mm = -"));
  Plan high = plate;
  high.pixel_aspect = 2;
  CHECK(map(2, high, 4, 5) == "accepted");  // a ring has pixels above its center
  CHECK(map(1.9, high, 4, 5) == "CurvatureMap: camera.pixel_aspect = 2, must be in [0.1, 1.9]");
  high.pixel_aspect = 11;
  CHECK(map(25, high, 4, 5) == "CurvatureMap: camera.pixel_aspect = 11, must be in [0.1, 10]");
  CHECK(map(25, plate, 0, 5) == "CurvatureMap: rows = 0, must be in [1, 1000000]");
  CHECK(map(25, plate, 4, -1) == "CurvatureMap: cols = -1, must be in [1, 1000000]");
}

TEST_CASE("curvature: a camera's pitch grows with depth as its rays spread") {
  const Camera<double> camera;
  const double row = camera.center_y_px, col = camera.center_x_px + 1;
  const auto spread = [&](double l) { return point_at(camera, row, col, l).x; };
  CHECK(spread(10) / spread(0) == Approx(1 + 10 * growth_per_mm(camera)).epsilon(1e-5));
  CHECK(growth_per_mm(plate) == 0);
}

#if defined(FINGERPAD_HAS_VECTORS)
TEST_CASE("quick inverse roots keep their bounds") {
  constexpr int n = detail::row_lanes<float>;
  using V = detail::lanes<float, n>;
  double worst = 0;
  for (int k = 0; k < 200000; ++k) {
    const float x = static_cast<float>(std::exp(static_cast<double>(k) * 1.6e-3 / 2 - 80));
    const double truth = 1 / std::sqrt(static_cast<double>(x));
    const double found = static_cast<double>(detail::inverse_sqrt(V(V{} + x))[n - 1]);
    worst = (std::max)(worst, std::abs(found / truth - 1));
  }
  CAPTURE(worst);
  CHECK(worst < 2.1e-5);
  CHECK(std::isfinite(detail::inverse_sqrt(V{})[0]));
  CHECK(std::isnan(detail::inverse_sqrt(V(V{} + not_a_number<float>()))[0]));
}
#endif

// Properties for every membrane, with any pixels missing, and both means.

using test::mirrored;
using test::rotated;
using test::transposed;

namespace {

/// A wavy membrane with holes, wide enough for whole SIMD vectors and a remainder.
template <class S>
Image<S> any_membrane() {
  Image<S> depth(test::whole(1, 30), test::whole(1, 60));
  const double bend = test::uniform(-0.02, 0.02), wave = test::uniform(0, 0.3);
  const double phase = test::uniform(0, 6), slope = test::uniform(-1, 1);
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  const double missing = test::whole(0, 2) == 0 ? 0 : test::uniform(0, 0.05);
  for (Index i = 0; i < depth.rows(); ++i) {
    for (Index j = 0; j < depth.cols(); ++j) {
      const double x = static_cast<double>(j) / 8 - 3, y = static_cast<double>(i) / 8 - 2;
      const double l = 9 + slope * x + bend * (x * x + y * y) + wave * std::sin(2 * x + y + phase);
      depth(i, j) = random.uniform() < missing ? std::numeric_limits<S>::quiet_NaN() : S(l);
    }
  }
  return depth;
}

double any_ring() {
  return test::uniform(1, 8);
}

/// Whether the same pixels are known and |a - b| is within a bound for numbers of order 1 per mm.
template <class A, class B>
bool close(const Image<A>& a, const Image<B>& b, double bound) {
  for (std::size_t k = 0; k < a.cells.size(); ++k) {
    const double x = static_cast<double>(a.cells[k]), y = static_cast<double>(b.cells[k]);
    if (std::isnan(x) != std::isnan(y) ||
        std::abs(x - y) > bound * (1 + std::abs(x) + std::abs(y))) {
      return false;
    }
  }
  return a.cells.size() == b.cells.size();
}

constexpr double rounding = 1e-9;  // of fits through few remaining sections, in double

}  // namespace

TEMPLATE_TEST_CASE_SIG("curvature turns and scales with the membrane",
                       "[curvature]",
                       ((Mean Of), Of),
                       Mean::clamped,
                       Mean::plain) {
  rc::prop("transposed, mirrored, rotated by 180 degrees", [] {
    const Image<double> depth = any_membrane<double>();
    const double ring = any_ring();
    const Image<double> k = curvatures<Of>(depth, ring);
    RC_ASSERT(close(curvatures<Of>(transposed(depth), ring), transposed(k), rounding));
    RC_ASSERT(close(curvatures<Of>(mirrored(depth), ring), mirrored(k), rounding));
    RC_ASSERT(close(curvatures<Of>(rotated(depth), ring), rotated(k), rounding));
  });
  rc::prop("moved along z, on the plate's own pitch", [] {
    const Image<double> depth = any_membrane<double>();
    const double ring = any_ring();
    Image<double> moved = depth;
    const double by = test::uniform(-5, 5);
    for (double& l : moved.cells) {
      l += by;
    }
    RC_ASSERT(close(curvatures<Of>(moved, ring), curvatures<Of>(depth, ring), rounding));
  });
  rc::prop("scaled with its pitch and its camera", [] {
    const Image<double> depth = any_membrane<double>();
    const double ring = any_ring();
    const double scale = test::log_uniform(1e-3, 5), growth = test::uniform(1e-3, 0.03);
    Image<double> scaled = depth;
    for (double& l : scaled.cells) {
      l *= scale;
    }
    Image<double> k = curvatures<Of>(scaled, ring, through(0.125 * scale, growth / scale));
    for (double& c : k.cells) {
      c *= scale;
    }
    RC_ASSERT(close(k, curvatures<Of>(depth, ring, through(0.125, growth)), rounding));
  });
}

TEMPLATE_TEST_CASE_SIG("curvature is the same however it is computed",
                       "[curvature]",
                       ((Mean Of), Of),
                       Mean::clamped,
                       Mean::plain) {
  rc::prop("by vectors or one by one", [] {
    const Image<float> depth = any_membrane<float>();
    const double ring = any_ring();
    Image<double> slow(depth.rows(), depth.cols());
    std::copy(depth.cells.begin(), depth.cells.end(), slow.cells.begin());
    const Through camera = through(0.125, 0.015);
    // a unit in the last place of 15 mm on the smallest ring, 4 e / r^2
    RC_ASSERT(close(curvatures<Of>(depth, ring, camera), curvatures<Of>(slow, ring, camera), 3e-4));
  });
  rc::prop("with the plain mean or without, to the last bit", [] {
    const Image<float> depth = any_membrane<float>();
    const double ring = any_ring();
    const Index rows = depth.rows(), cols = depth.cols();
    CurvatureMap<> map(plate, rows, cols, ring);
    Image<float> clamped(rows, cols), again(rows, cols), plain(rows, cols);
    const auto all = map(depth, clamped);
    RC_ASSERT(*all == std::count_if(clamped.cells.begin(), clamped.cells.end(),
                                    [](float k) { return std::isnan(k); }));
    RC_ASSERT(map(depth, again, plain) == all);
    RC_ASSERT(test::same_bits(clamped, again));
    for (std::size_t k = 0; k < plain.cells.size(); ++k) {
      RC_ASSERT(std::isnan(plain.cells[k]) == std::isnan(clamped.cells[k]));
    }
  });
}

TEMPLATE_TEST_CASE_SIG("what is missing stays within its ring",
                       "[curvature]",
                       ((Mean Of), Of),
                       Mean::clamped,
                       Mean::plain) {
  rc::prop("lost, infinite and absurd depths", [] {
    const Image<float> depth = any_membrane<float>();
    const double ring = any_ring();
    Image<float> hole = depth;
    const Index i = test::whole(0, depth.rows() - 1), j = test::whole(0, depth.cols() - 1);
    const float infinity = std::numeric_limits<float>::infinity();
    hole(i, j) = *rc::gen::element(std::nanf(""), -std::nanf(""), infinity, -infinity, 3e38F,
                                   -3e38F, 1e-42F, 1e5F, -1e5F);
    const Through camera = through(0.125, 0.015);
    const Image<float> before = curvatures<Of>(depth, ring, camera);
    const Image<float> after = curvatures<Of>(hole, ring, camera);
    for (Index r = 0; r < depth.rows(); ++r) {
      for (Index c = 0; c < depth.cols(); ++c) {
        const double distance = std::hypot(static_cast<double>(r - i), static_cast<double>(c - j));
        const bool far = distance > ring + 0.71;
        RC_ASSERT(!far || test::same_bits(before(r, c), after(r, c)));
        RC_ASSERT(!std::isinf(after(r, c)));
        RC_ASSERT(std::isfinite(hole(r, c)) || std::isnan(after(r, c)));
      }
    }
  });
}

TEST_CASE("pixels are known where enough sections are complete", "[curvature]") {
  rc::prop("counted one by one", [] {
    const Image<float> depth = any_membrane<float>();
    const double ring = any_ring();
    const Image<float> k = curvatures<Mean::clamped>(depth, ring);
    const auto offsets = detail::ring_offsets(ring, 18);
    const auto there = [&](Index r, Index c) {
      return r >= 0 && r < depth.rows() && c >= 0 && c < depth.cols() && !std::isnan(depth(r, c));
    };
    for (Index i = 0; i < depth.rows(); ++i) {
      for (Index j = 0; j < depth.cols(); ++j) {
        double mean = 0, count = 0;
        for (const detail::RingOffset& o : offsets) {
          if (there(i, j) && there(i + o.row, j + o.col) && there(i - o.row, j - o.col)) {
            const double radius = std::sqrt(o.distance_sq()) * plate.pitch_mm;
            const auto at = [&](Index sign) {
              return static_cast<double>(depth(i + sign * o.row, j + sign * o.col));
            };
            mean += (std::max)(0.0, section_curvature(radius, at(-1), at(0), at(1)));
            count += 1;
          }
        }
        const bool enough = count >= 9;
        RC_ASSERT(std::isnan(k(i, j)) == !enough);
        RC_ASSERT(!enough || std::abs(static_cast<double>(k(i, j)) - mean / count) <=
                                 5e-6 + 5e-5 * mean / count);
      }
    }
  });
}

// Curvature against 50 digits: the error of the arithmetic, with depths rounded to the type
// first.

using test::Digits50;

namespace {

template <class S>
constexpr double bound_per_mm = 5e-6;
template <>
constexpr double bound_per_mm<double> = 1e-14;

double any_curvature() {
  const double size[] = {0.0, 1.5e-4, 0.05};
  return (test::whole(0, 1) == 0 ? 1 : -1) * size[test::whole(0, 2)];
}

/// Error of a map at the center of a random patch of that curvature.
template <bool Clamped, class S, class CameraType>
double map_error(const CameraType& camera) {
  const Index radius = test::whole(0, 7) == 0 ? 25 : 10;  // 50 digits of the larger ring take long
  const Index size = 2 * radius + 1;
  const double middle = test::uniform(5, 13), slope = test::uniform(0, 1.5);
  const double turn = test::uniform(0, 7), bend_x = any_curvature();
  const double bend_y = any_curvature();
  Image<S> depth(size, size);
  Image<Digits50> exact(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const double x = static_cast<double>(j - radius) * camera.pitch_mm;
      const double y = static_cast<double>(i - radius) * camera.pitch_mm;
      const double rise = slope * (x * std::cos(turn) + y * std::sin(turn));
      depth(i, j) = static_cast<S>(middle + rise - (bend_x * x * x + bend_y * y * y) / 2);
      exact(i, j) = Digits50(depth(i, j));
    }
  }
  const auto ring = static_cast<double>(radius);
  CurvatureMap<S> map(camera, size, size, ring);
  CurvatureMap<Digits50> reference(camera, size, size, ring);
  std::array<Image<S>, 2> k = {Image<S>(size, size), Image<S>(size, size)};
  std::array<Image<Digits50>, 2> truth = {Image<Digits50>(size, size), Image<Digits50>(size, size)};
  (void)map(depth, k[0], k[1]);
  (void)reference(exact, truth[0], truth[1]);
  const std::size_t of = Clamped ? 0 : 1;
  const Digits50 error = Digits50(k[of](radius, radius)) - truth[of](radius, radius);
  return std::abs(static_cast<double>(error));
}

}  // namespace

TEMPLATE_TEST_CASE("maps of curvature follow 50 digits", "[curvature][figures]", float, double) {
  using S = TestType;
  rc::prop("plain", [&] {
    const double error = map_error<false, S>(plate);
    RC_ASSERT(error <= bound_per_mm<S>);
  });
  rc::prop("clamped", [&] {
    const double error = map_error<true, S>(plate);
    RC_ASSERT(error <= bound_per_mm<S>);
  });
}

TEMPLATE_TEST_CASE("through a camera too, up to the rounding of zeta",
                   "[curvature]",
                   float,
                   double) {
  using S = TestType;
  Camera<double> camera;
  camera.pitch_mm = 0.0768;
  rc::prop("clamped", [&] {
    const double error = map_error<true, S>(camera);
    RC_ASSERT(error <= 4 * bound_per_mm<S>);
  });
}

TEST_CASE("fifty digits and dual numbers have curvature", "[curvature]") {
  using S = Digits50;
  const S radius(0.768), before(9), center(9.5), after(9.25);
  const S tiny("1e-16");
  const auto by_center = [&](const auto& l) {
    using T = std::decay_t<decltype(l)>;
    return section_curvature(T(radius), T(before), l, T(after));
  };
  const S exact = test::slope_by_tangent(by_center, center);
  const S nearly = test::slope_by_difference(by_center, center, tiny);
  CHECK(test::relative_error(nearly, exact) < S("1e-28"));
  const S published = published::circle_center_curvature(radius, before, center, after);
  const S menger = section_curvature(radius, before, center, after);
  CHECK(test::relative_error(published, menger) < S("1e-47"));
}
