// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/intensity_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/contact/surface.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::refusal;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Grey level of an uneven lamp.
double free_level(Index i, Index j) {
  return 150 + 0.3 * static_cast<double>(i) - 0.2 * static_cast<double>(j);
}

/// A ball in a gel of 4 mm. A one-channel camera has calibrated the darkening on free frames.
struct PressedBall {
  static constexpr Index rows = 96;
  static constexpr Index cols = 120;
  static constexpr double mm_per_px = 0.05;
  static constexpr double gel_mm = 4;
  double ball_mm = test::uniform(2, 4);
  double contact_px = test::uniform(24, 30);
  IntensityLaw<> law{test::uniform(2, 4), 0, 0};
  test::Random random{static_cast<std::uint64_t>(test::whole(1, 1000))};

  double depth_mm(double r_px) const {
    const double r = r_px * mm_per_px;
    const double a = contact_px * mm_per_px;
    return r < a ? std::sqrt(ball_mm * ball_mm - r * r) - std::sqrt(ball_mm * ball_mm - a * a) : 0;
  }
  Image<std::uint8_t> frame(bool is_pressed, const Point2<double>& way_px) {
    Image<std::uint8_t> image(rows, cols);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const Point2<double> from_ball = {static_cast<double>(j) - 59.5 - way_px.x,
                                          static_cast<double>(i) - 47.5 - way_px.y};
        const double depth = is_pressed ? depth_mm(norm(from_ball)) : 0;
        const double level = free_level(i, j) * std::exp(-depth / law.linear_mm);
        image(i, j) = static_cast<std::uint8_t>(level + 0.3 * random.normal() + 0.5);
      }
    }
    return image;
  }
};

/// Results of a frame: heights of the gel's surface, and the contact.
struct BallSeen {
  Image<double> depth_mm{PressedBall::rows, PressedBall::cols};
  Image<double> height_mm = depth_mm;
  Image<Touch> contact{PressedBall::rows, PressedBall::cols};
  GelResult found;
};

}  // namespace

TEST_CASE("intensity depth: the law holds pixel by pixel, whatever the lamp", "[intensity_depth]") {
  rc::prop("for every lamp and law", [] {
    const IntensityLaw<> law{test::uniform(1, 6), test::uniform(-1, 1), test::uniform(-0.5, 0.5)};
    const double lamp = test::log_uniform(0.2, 1.5);
    const double l = test::uniform(-0.2, 0.6);
    Image<double> free(20, 30);
    Image<double> now(20, 30);
    for (Index i = 0; i < 20; ++i) {
      for (Index j = 0; j < 30; ++j) {
        free(i, j) = lamp * free_level(i, j);
        now(i, j) = free(i, j) * std::exp(-l);
      }
    }
    IntensityDepth<double> depth(free, law, {.saturated = 1000});
    Image<double> out(20, 30);
    (void)depth(now, out);
    const double expected = l * (law.linear_mm + l * (law.square_mm + l * law.cube_mm));
    for (const double found : out.cells) {
      RC_ASSERT(std::abs(found - expected) < 1e-12 * (1 + std::abs(expected)));
    }
  });
}

TEST_CASE("intensity depth: bytes and numbers, one answer", "[intensity_depth]") {
  Image<std::uint8_t> free(20, 30);
  Image<std::uint8_t> now(20, 30);
  Image<float> now_float(20, 30);
  test::Random random(3);
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 0; j < 30; ++j) {
      free(i, j) = static_cast<std::uint8_t>(free_level(i, j));
      now(i, j) = static_cast<std::uint8_t>(random.whole(20, 200));
      now_float(i, j) = now(i, j);
    }
  }
  IntensityDepth<> depth(free, {});
  Image<float> a(20, 30);
  Image<float> b(20, 30);
  CHECK(depth(now, a) != FrameStatus::refused);
  CHECK(depth(now_float, b) != FrameStatus::refused);
  for (std::size_t k = 0; k < a.cells.size(); ++k) {
    CHECK(std::abs(a.cells[k] - b.cells[k]) < 1e-5F);
  }
}

TEST_CASE("intensity depth: bad pixels have no depth and change no other", "[intensity_depth]") {
  const Image<double> free(40, 40, 100.0);
  IntensityDepth<double> depth(free, {});
  Image<double> now(40, 40, 100 * std::exp(-0.25));
  now(7, 8) = none;
  now(20, 20) = 255;
  now(21, 20) = 0;
  now(30, 1) = std::numeric_limits<double>::infinity();
  Image<double> out(40, 40);
  (void)depth(now, out);
  Index missing = 0;
  for (const double found : out.cells) {
    missing += found != found;
    CHECK((found != found || std::abs(found - 0.75) < 1e-12));
  }
  CHECK(missing == 4);
}

TEST_CASE("intensity depth: no depth where the law overflows", "[intensity_depth]") {
  const Image<double> free(8, 8, 200.0);
  IntensityDepth<float> depth(free, {1, 1e30, 1e38});
  Image<double> now(8, 8, 200.0);
  now(2, 3) = 2;
  Image<float> out(8, 8);
  (void)depth(now, out);
  CHECK(out(2, 3) != out(2, 3));
  CHECK(out(2, 4) == 0);
}

TEST_CASE("intensity depth: smoothing averages the noise", "[intensity_depth]") {
  const Image<double> free(60, 60, 140.0);
  Image<double> now(60, 60);
  test::Random random(9);
  for (double& level : now.cells) {
    level = 120 + random.normal();
  }
  const auto spread = [&](double smoothing_px) {
    IntensityDepth<double> depth(free, {}, {.smoothing_px = smoothing_px});
    Image<double> out(60, 60);
    CHECK(depth(now, out) != FrameStatus::refused);
    double sum = 0;
    for (const double found : out.cells) {
      sum += square(found - 3 * std::log(140.0 / 120));
    }
    return std::sqrt(sum / 3600);
  };
  CHECK(spread(0) == Approx(3.0 / 120).epsilon(0.1));
  // the mean of a Gaussian with the sd s has the noise of 4 pi s^2 pixels
  CHECK(spread(2) == Approx(spread(0) / std::sqrt(4 * 3.14159 * 4)).epsilon(0.2));
}

TEST_CASE("intensity depth: contact, surface and slide of a ball", "[intensity_depth]") {
  rc::prop("for every ball and law", [] {
    PressedBall ball;
    const auto free = ball.frame(false, {0, 0});
    IntensityDepth<double> depth(free, ball.law);
    const auto mat_of = [](const Image<std::uint8_t>& image) {
      cv::Mat mat(int(image.rows()), int(image.cols()), CV_8UC1);
      std::copy(image.cells.begin(), image.cells.end(), mat.data);
      return mat;
    };
    GelContact gel(
        std::vector{mat_of(free), mat_of(ball.frame(false, {0, 0}))},
        {.cell_px = 2, .smoothing_px = 2, .dot_px = 0, .max_gap_px = 8, .min_region_px = 100});
    const auto see = [&](const Point2<double>& way_px) {
      const auto frame = ball.frame(true, way_px);
      BallSeen seen;
      RC_ASSERT(depth(frame, seen.depth_mm) == FrameStatus::ok);
      seen.found = gel(mat_of(frame));
      RC_ASSERT(seen.found.ok());
      for (Index i = 0; i < PressedBall::rows; ++i) {
        for (Index j = 0; j < PressedBall::cols; ++j) {
          const bool touches = gel.mask()(int(i / 2), int(j / 2)) != 0;
          seen.contact(i, j) = touches ? Touch::contact : Touch::none;
        }
      }
      for (std::size_t k = 0; k < seen.depth_mm.cells.size(); ++k) {
        seen.height_mm.cells[k] = PressedBall::gel_mm - seen.depth_mm.cells[k];
      }
      return seen;
    };
    const BallSeen before = see({0, 0});
    const double radius_px = std::sqrt(double(before.found.contact_px) / 3.14159265358979);
    // where the frame differs enough; the mean over 2 px extends beyond the contact
    RC_LOG() << radius_px << " px for " << ball.contact_px << "\n";
    const double dark = -ball.law.linear_mm * std::log(1 - gel.threshold());
    RC_ASSERT(ball.depth_mm(radius_px + 2) < dark);
    RC_ASSERT(radius_px < ball.contact_px + 2);

    Image<std::uint8_t> inner(before.contact.rows(), before.contact.cols(), 0);
    for (Index i = 4; i + 4 < inner.rows(); ++i) {  // a strip of 4 px along the border is left out
      for (Index j = 4; j + 4 < inner.cols(); ++j) {
        const auto in_contact = [&](Index row, Index col) {
          return is_contact(before.contact(i + row, j + col));
        };
        inner(i, j) = in_contact(0, 0) && in_contact(4, 0) && in_contact(-4, 0) &&
                      in_contact(0, 4) && in_contact(0, -4) && in_contact(3, 3) &&
                      in_contact(-3, 3) && in_contact(3, -3) && in_contact(-3, -3);
      }
    }
    const OrthographicCamera<double> plan{59.5, 47.5, PressedBall::mm_per_px};
    const auto surface = fit_surface(plan, before.height_mm, inner);
    RC_ASSERT(surface.ok());
    const double curvature = (surface.curvature_1_per_mm + surface.curvature_2_per_mm) / 2;
    RC_LOG() << 1 / curvature << " mm for " << ball.ball_mm << "\n";
    // the standard error assumes independent pixels, but the mean over 2 px correlates them
    const double as_one = std::sqrt(4 * 3.14159265358979) * 2;
    const double sd = as_one * surface.curvature_1_sd_per_mm * ball.ball_mm;
    RC_ASSERT(sd < 0.04);  // otherwise the next line would allow anything
    RC_ASSERT(std::abs(curvature * ball.ball_mm - 1) < 0.01 + 4 * sd);

    const Point2<double> way = {test::uniform(-6, 6), test::uniform(-6, 6)};
    Image<Point2<double>> dots(3, 3);  // standing dots
    for (Index k = 0; k < 9; ++k) {
      dots(k / 3, k % 3) = {double(39 + 20 * (k % 3)), double(27 + 20 * (k / 3))};
    }
    GelSlide slide(PressedBall::rows, PressedBall::cols, dots, {.cell_px = 1});
    (void)slide(before.depth_mm, before.contact, dots);
    const BallSeen after = see(way);
    const auto slid = slide(after.depth_mm, after.contact, dots);
    RC_LOG() << slid.imprint_px.x << ", " << slid.imprint_px.y << " +- " << slid.imprint_sd_px
             << " px for " << way.x << ", " << way.y << "\n";
    RC_ASSERT(norm(slid.imprint_px - way) < 0.2);
    RC_ASSERT(slid.ok() == (slid.dots >= 3));  // a small ball covers fewer
    RC_ASSERT((!slid.ok() || norm(slid.slide_px - way) < 0.2));
  });
}

TEST_CASE("intensity depth: fifty digits and duals", "[intensity_depth]") {
  const IntensityLaw<> law{3, -0.5, 0.25};
  using test::Digits50;
  const Digits50 fine = pressed_depth_mm(law, Digits50(0.3));
  CHECK(pressed_depth_mm(law, 0.3) == Approx(static_cast<double>(fine)).epsilon(1e-15));
  const double slope =
      test::slope_by_tangent<double>([&](const auto& l) { return pressed_depth_mm(law, l); }, 0.3);
  CHECK(slope == Approx(3 - 0.3 + 3 * 0.25 * 0.09));
}

TEST_CASE("intensity depth: what does not fit is refused", "[intensity_depth]") {
  const Image<double> free(20, 30, 100.0);
  IntensityDepth<double> depth(free, {});
  Image<double> out(20, 30, 7.0);
  CHECK(depth(Image<double>(20, 29), out) == FrameStatus::refused);
  CHECK(out(3, 3) == 7);

  const auto law = [&](const IntensityLaw<>& given) {
    return refusal([&] { IntensityDepth<>{free, given}; });
  };
  CHECK(begins_with(law({0, 0, 0}), "IntensityLaw: linear_mm = 0"));
  CHECK(begins_with(law({1, none, 0}), "IntensityLaw: square_mm = nan"));
  CHECK(begins_with(law({1, 0, none}), "IntensityLaw: cube_mm = nan"));
  const auto options = [&](const IntensityOptions& given) {
    return refusal([&] { IntensityDepth<>{free, {}, given}; });
  };
  CHECK(begins_with(options({.smoothing_px = 21}), "IntensityOptions: smoothing_px = 21"));
  CHECK(begins_with(options({.dark = -1}), "IntensityOptions: dark = -1"));
  CHECK(begins_with(options({.saturated = 5}), "IntensityOptions: saturated = 5"));
  CHECK(begins_with(options({.saturated = none}), "IntensityOptions: saturated = nan"));
  CHECK(options({.saturated = std::numeric_limits<double>::infinity()}) == "accepted");
}

TEST_CASE("intensity depth: a frame allocates nothing", "[intensity_depth]") {
  const test::Image<std::uint8_t> free(40, 50, 140);
  const test::Image<std::uint8_t> now(40, 50, 120);
  test::Image<float> depth(40, 50);
  IntensityDepth<> pressed(free, {});
  const long before = test::allocations();
  const auto result = pressed(now, depth);
  const long after = test::allocations();
  CHECK(result == FrameStatus::not_of_this_pad);
  CHECK(after == before);
}
