// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every membrane, with any pixels missing, and both means.
#include "fingerpad/image/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "support/cameras.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"
#include "support/rotated.hpp"

using namespace fingerpad;
using test::Image;
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

CurvatureRing any_ring() {
  return {test::uniform(1, 8), test::uniform(0.05, 1)};
}

using Plan = OrthographicCamera<double>;
using Through = Camera<double>;
using test::plan;
using test::through;

const Plan plate = plan(0.125);

enum class Mean { clamped, plain };

template <Mean Of, class S, class CameraType = Plan>
Image<S> curvatures(const Image<S>& depth,
                    const CurvatureRing& ring,
                    const CameraType& camera = plate) {
  CurvatureMap<S> map(camera, depth.rows(), depth.cols(), ring);
  Image<S> out(depth.rows(), depth.cols(), S(7));
  RC_ASSERT(map(depth, out).has_value());
  if (Of == Mean::plain) {
    RC_ASSERT(map.mean(0, depth.rows(), 0, depth.cols(), out));
  }
  return out;
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
    const CurvatureRing ring = any_ring();
    const Image<double> k = curvatures<Of>(depth, ring);
    RC_ASSERT(close(curvatures<Of>(transposed(depth), ring), transposed(k), rounding));
    RC_ASSERT(close(curvatures<Of>(mirrored(depth), ring), mirrored(k), rounding));
    RC_ASSERT(close(curvatures<Of>(rotated(depth), ring), rotated(k), rounding));
  });
  rc::prop("moved along z, on the plate's own pitch", [] {
    const Image<double> depth = any_membrane<double>();
    const CurvatureRing ring = any_ring();
    Image<double> moved = depth;
    const double by = test::uniform(-5, 5);
    for (double& l : moved.cells) {
      l += by;
    }
    RC_ASSERT(close(curvatures<Of>(moved, ring), curvatures<Of>(depth, ring), rounding));
  });
  rc::prop("scaled with its pitch and its camera", [] {
    const Image<double> depth = any_membrane<double>();
    const CurvatureRing ring = any_ring();
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
    const Image<double> depth = any_membrane<double>();
    CurvatureRing ring = any_ring();
    Image<long double> slow(depth.rows(), depth.cols());
    std::copy(depth.cells.begin(), depth.cells.end(), slow.cells.begin());
    const Through camera = through(0.125, 0.015);
    RC_ASSERT(
        close(curvatures<Of>(depth, ring, camera), curvatures<Of>(slow, ring, camera), rounding));
  });
  rc::prop("in parts of the image, to the last bit", [] {
    const Image<float> depth = any_membrane<float>();
    const CurvatureRing ring = any_ring();
    const Index rows = depth.rows(), cols = depth.cols();
    CurvatureMap<> map(plate, rows, cols, ring);
    Image<float> clamped(rows, cols), again(rows, cols), plain(rows, cols);
    const auto all = map(depth, clamped);
    RC_ASSERT(*all == std::count_if(clamped.cells.begin(), clamped.cells.end(),
                                    [](float k) { return std::isnan(k); }));
    map.mean(0, rows, 0, cols, plain);
    Image<float> parts(rows, cols, 7.0F);
    const Index row = test::whole(0, rows), col = test::whole(0, cols);
    map.mean(row, rows, col, cols, parts);
    RC_ASSERT(std::count(parts.cells.begin(), parts.cells.end(), 7.0F) >=
              rows * cols - (rows - row) * (cols - col));
    map.mean(row, rows, 0, col, parts);
    map.mean(0, row, 0, cols, parts);
    RC_ASSERT(test::same_bits(plain, parts));
    RC_ASSERT(map(depth, again) == all);
    RC_ASSERT(test::same_bits(clamped, again));
  });
}

TEMPLATE_TEST_CASE_SIG("what is missing stays within its ring",
                       "[curvature]",
                       ((Mean Of), Of),
                       Mean::clamped,
                       Mean::plain) {
  rc::prop("lost, infinite and absurd depths", [] {
    const Image<float> depth = any_membrane<float>();
    const CurvatureRing ring = any_ring();
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
        const bool far = distance > ring.radius_px + 0.71;
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
    const CurvatureRing ring = any_ring();
    const Image<float> k = curvatures<Mean::clamped>(depth, ring);
    const auto offsets = detail::ring_offsets(ring.radius_px, 18);
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
        const bool enough =
            count >= (std::max)(1.0, std::ceil(ring.min_direction_share * 18 - 1e-9));
        RC_ASSERT(std::isnan(k(i, j)) == !enough);
        RC_ASSERT(!enough || std::abs(static_cast<double>(k(i, j)) - mean / count) <=
                                 5e-6 + 5e-5 * mean / count);
      }
    }
  });
}

TEST_CASE("means of one membrane are in order", "[curvature]") {
  rc::prop("clamped >= plain", [] {
    const Image<double> depth = any_membrane<double>();
    CurvatureRing ring = any_ring();
    const auto mean = curvatures<Mean::plain>(depth, ring);
    const auto clamped = curvatures<Mean::clamped>(depth, ring);
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      RC_ASSERT(!(clamped.cells[k] < mean.cells[k] - 1e-12) && !(clamped.cells[k] < 0));
    }
  });
}
