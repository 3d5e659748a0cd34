// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/depth.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Dual;
using test::Frame;
using test::Image;
using test::Pad;

namespace {

/// A pad of 75 x 81 pixels of 0.55 mm.
Pad fine_pad() {
  Pad pad;
  pad.rows = 75;
  pad.cols = 81;
  pad.camera.pitch_mm = 0.55;
  pad.camera.center_x_px = 40;
  pad.camera.center_y_px = 37;
  return pad;
}

/// Adds clumps of bad pixels, each of one kind, until they cover a share of the frame.
template <class Pixel>
Image<std::uint8_t> spoil_in_clumps(Frame<Pixel>& frame, double share, test::Random& random) {
  const Index rows = frame.red.rows();
  const Index cols = frame.red.cols();
  Image<std::uint8_t> bad(rows, cols);
  double left = share * static_cast<double>(rows * cols);
  while (left > 0) {
    const Index i0 = random.whole(0, rows - 1);
    const Index j0 = random.whole(0, cols - 1);
    const double radius = random.uniform(1, 12);
    const auto kind = random.whole(0, std::is_integral_v<Pixel> ? 1 : 2);
    const Pixel cell = kind == 0   ? Pixel(0)
                       : kind == 1 ? test::stored<Pixel>(255)
                                   : static_cast<Pixel>(test::nan);
    auto& channel = random.whole(0, 1) == 0 ? frame.red : frame.green;
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        if (std::hypot(static_cast<double>(i - i0), static_cast<double>(j - j0)) <= radius) {
          channel(i, j) = cell;
          left -= bad(i, j) == 0 ? 1 : 0;
          bad(i, j) = 1;
        }
      }
    }
  }
  return bad;
}

/// Remaining share of a pixel's variance after a mean of n1 of n2 pixels with weights a and 1 - a.
double variance_left(double n1, double n2, double a) {
  const double b = a - 1;
  return a * a / n1 - 2 * a * b / n2 + b * b / n2;
}

/// Depth error per grey level of F: 1 / F', for the darkest membrane, where F rises least.
double mm_per_level(const Pad& pad, Index i, Index j, double l) {
  const auto light = pad.pencil(i, j);
  const auto c = pad.colour(i, j, l, 0.4 * pad.brightness);
  return 1 / depth_equation(pad.fluid, light, pad.g(i, j), c, l).slope;
}

template <class Pixel>
PixelStatus reason(const Pixel& red, const Pixel& green) {
  if (!is_finite(real_of_t<Pixel>(red)) || !is_finite(real_of_t<Pixel>(green))) {
    return PixelStatus::not_a_number;
  }
  const Pixel top = test::stored<Pixel>(255);
  return red >= top || green >= top ? PixelStatus::saturated : PixelStatus::dark;
}

/// Windows of the policy's mean, and the weight of the first.
struct Windows {
  Index inner;
  Index outer;
  double weight;
};

}  // namespace

TEMPLATE_TEST_CASE("with a fifth of the pixels lost, the others are as good as their windows",
                   "[depth]",
                   std::uint8_t,
                   std::uint16_t,
                   float) {
  using Pixel = TestType;
  const Pad pad = fine_pad();
  const auto truth = pad.free_depths();
  Index lost = 0;
  // Window 5 of the bias-free mean: 7 and 11 pixels, weights 120/72 and -48/72.
  const auto check = [&](const auto& smoothing, const Windows& w, std::uint64_t seed) {
    using Smoothing = std::remove_cvref_t<decltype(smoothing)>;
    const auto estimator = pad.estimator<Smoothing, ExponentialFree<>, float>(smoothing);
    auto frame = pad.frame<Pixel>(truth, 1, seed);
    test::Random random(seed);
    const auto bad = spoil_in_clumps(frame, 0.2, random);
    const auto e = test::estimate<float>(estimator, frame);
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        const double l = truth(i, j);
        const PixelStatus status = e.status(i, j);
        const auto depth = static_cast<double>(e.depth_mm(i, j));
        const auto expect = [&](bool good) {
          if (!good) {
            CAPTURE(i, j, l, depth, static_cast<int>(status));
            FAIL("depth or status is wrong");
          }
        };
        expect(is_finite(depth) == (status == PixelStatus::ok));
        if (l != l) {
          expect(status == PixelStatus::outside_pad);
          continue;
        }
        double n[2] = {0, 0};
        for (Index p = (std::max)(i - w.outer, Index(0));
             p <= (std::min)(i + w.outer, pad.rows - 1); ++p) {
          for (Index q = (std::max)(j - w.outer, Index(0));
               q <= (std::min)(j + w.outer, pad.cols - 1); ++q) {
            if (bad(p, q) == 0 && truth(p, q) == truth(p, q)) {
              n[1] += 1;
              n[0] += std::abs(p - i) <= w.inner && std::abs(q - j) <= w.inner ? 1 : 0;
            }
          }
        }
        if (n[0] == 0) {
          ++lost;
          expect(status == reason(frame.red(i, j), frame.green(i, j)));
          continue;
        }
        // The anchored mean of the free pad has no bias, so the error is noise alone: of 1 grey
        // level, and 1/12 more for the steps of 8 bit, in both channels (rise is below 1.15). The
        // bound is six standard deviations, which no pixel in 1e8 should exceed, and the steps of
        // 1/128 grey level of the stored residuals.
        const double sd =
            std::sqrt(13.0 / 12 * (1.15 * 1.15 + 1) * variance_left(n[0], n[1], w.weight));
        const double allowed = mm_per_level(pad, i, j, l) * (6 * sd + 1.0 / 128);
        if (status == PixelStatus::ok) {
          expect(std::abs(depth - l) <= 1.1 * allowed);
        } else {  // noise near the ends of the range
          const double end = pad.fluid.max_depth_mm;
          expect((status == PixelStatus::below_range && l < 1.1 * allowed) ||
                 (status == PixelStatus::above_range && l > end - 1.1 * allowed));
        }
      }
    }
  };
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    check(AnchoredMean{7}, {3, 3, 1}, seed);
    check(BiasFreeMean{5}, {3, 5, 120.0 / 72}, seed);
  }
  CHECK(lost > 0);  // otherwise nothing was tested about them
}

TEST_CASE("a frame of another size is refused and nothing written", "[depth]") {
  const Pad pad;
  const auto estimator = pad.estimator<published::BoxMean, ExponentialFree<>, float>();
  auto workspace = estimator.workspace<std::uint8_t>();
  const auto good = pad.frame<std::uint8_t>(pad.free_depths());
  const Index r = pad.rows;
  const Index c = pad.cols;
  const auto refused = [&](Index red_rows, Index green_cols, Index depth_rows, Index status_cols) {
    const Image<std::uint8_t> red(red_rows, c, 50);
    const Image<std::uint8_t> green(r, green_cols, 50);
    Image<float> depth(depth_rows, c, -7);
    Image<PixelStatus> status(r, status_cols, PixelStatus::dark);
    const auto result = estimator(red, green, depth, status, workspace);
    CHECK_FALSE(result.ok());
    CHECK(result.valid_pixels() == 0);
    CHECK(depth.cells == Image<float>(depth_rows, c, -7).cells);
    CHECK(status.cells == Image<PixelStatus>(r, status_cols, PixelStatus::dark).cells);
  };
  refused(r - 1, c, r, c);
  refused(r, c + 1, r, c);
  refused(r, c, r + 1, c);
  refused(r, c, r, c - 1);
  test::Estimate<float> e(r, c);
  const auto untouched = e;
  const std::pair<Index, Index> no_bands[] = {{-1, r}, {0, r + 1}, {4, 3}};
  for (const auto& [first, last] : no_bands) {
    CHECK_FALSE(
        estimator.band(first, last, good.red, good.green, e.depth_mm, e.status, workspace).ok());
  }
  // the workspace of an estimator for another pad
  auto foreign = fine_pad()
                     .estimator<published::BoxMean, ExponentialFree<>, float>()
                     .workspace<std::uint8_t>();
  CHECK_FALSE(estimator(good.red, good.green, e.depth_mm, e.status, foreign).ok());
  CHECK(e.depth_mm.cells == untouched.depth_mm.cells);
  CHECK(e.status.cells == untouched.status.cells);
  // and the workspace remains usable
  CHECK(estimator(good.red, good.green, e.depth_mm, workspace).ok());
}

TEST_CASE("threads may share an estimator and a frame", "[depth]") {
  const Pad pad = fine_pad();
  auto frame = pad.frame<std::uint8_t>(pad.pressed_depths(2), 1, 4);
  test::Random random(2);
  spoil_in_clumps(frame, 0.2, random);
  const auto estimator = pad.estimator<BiasFreeMean, ExponentialFree<>, float>({9});
  const auto alone = test::estimate<float>(estimator, frame);
  test::Estimate<float> shared(pad.rows, pad.cols);
  std::vector<std::thread> threads;
  constexpr Index count = 4;
  for (Index k = 0; k < count; ++k) {
    threads.emplace_back([&, k] {
      auto workspace = estimator.workspace<std::uint8_t>();
      for (int again = 0; again < 5; ++again) {
        (void)estimator.band(k * pad.rows / count, (k + 1) * pad.rows / count, frame.red,
                             frame.green, shared.depth_mm, shared.status, workspace);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  CHECK(test::same_bits(shared.depth_mm, alone.depth_mm));
  CHECK(shared.status.cells == alone.status.cells);
}

TEMPLATE_TEST_CASE("a 16-bit frame of 256 times the 8-bit levels has the same depth",
                   "[depth]",
                   NoSmoothing,
                   published::BoxMean,
                   AnchoredMean,
                   BiasFreeMean) {
  const Pad pad = fine_pad();
  auto frame = pad.frame<std::uint8_t>(pad.pressed_depths(2), 1, 4);
  test::Random random(3);
  spoil_in_clumps(frame, 0.2, random);
  Frame<std::uint16_t> deep(pad.rows, pad.cols);
  Frame<float> single(pad.rows, pad.cols);
  for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
    deep.red.cells[k] = static_cast<std::uint16_t>(frame.red.cells[k] * 256);
    deep.green.cells[k] = static_cast<std::uint16_t>(frame.green.cells[k] * 256);
    single.red.cells[k] = frame.red.cells[k];
    single.green.cells[k] = frame.green.cells[k];
  }
  const auto estimator = pad.estimator<TestType, ExponentialFree<>, float>();
  const auto e = test::estimate<float>(estimator, frame);
  const auto same = [&](const auto& other, double bound_mm) {
    CHECK(test::largest_error(other.depth_mm, e.depth_mm) <= bound_mm);
    CHECK(other.status.cells == e.status.cells);
  };
  same(test::estimate<float>(estimator, deep), 1e-5);
  // float frames are averaged as they are, not in steps of 1/128 grey level: 2.2 (sum of the
  // weights) times half a step, at 0.75 mm per level
  same(test::estimate<float>(estimator, single), TestType::anchored ? 2.2 / 256 * 0.75 : 5e-5);
}

TEST_CASE("every number type gives the same depth", "[depth]") {
  const Pad pad;
  const auto frame = pad.frame<std::uint8_t>(pad.pressed_depths(3), 1, 8);
  const auto with = [&](auto s) {
    using S = decltype(s);
    const auto e = test::estimate<S>(pad.estimator<BiasFreeMean, Newton, S>({5}), frame);
    Image<double> depth(pad.rows, pad.cols);
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      depth.cells[k] = static_cast<double>(value(e.depth_mm.cells[k]));
    }
    return depth;
  };
  const auto in_double = with(double());
  CHECK(test::largest_error(with(0.0L), in_double) <= 1e-11);
  CHECK(test::largest_error(with(Dual<double>()), in_double) <= 1e-11);
  CHECK(test::largest_error(in_double, with(Dual<double>())) <= 1e-11);
  // float works with residuals in steps of 1/128 grey level
  CHECK(test::largest_error(with(float()), in_double) <= 2.2 / 256 * 0.75);
}

namespace {

using D = Dual<double>;

/// Depth as a function of (red, green, c_red, kappa, g), with the one of index `which` shifted by
/// x.
template <class S>
S shifted_depth(const Pad& pad, double l, int which, const S& x) {
  const auto shift = [&](int k, double v) { return which == k ? S(S(v) + x) : S(v); };
  const auto light = pad.pencil(10, 20);
  const auto c = pad.colour(10, 20, l, pad.brightness);
  const Absorption<S> fluid{shift(2, pad.fluid.c_red_per_mm), S(pad.fluid.c_green_per_mm),
                            shift(3, pad.fluid.kappa), S(pad.fluid.max_depth_mm)};
  const Pencil<S> pencil{S(light.path_factor),
                         {S(light.height.meridional_mm), S(light.height.sagittal_mm)}};
  return newton_depth(fluid, pencil, shift(4, pad.g(10, 20)),
                      Colour<S>{shift(0, c.red), shift(1, c.green)})
      .depth_mm;
}

}  // namespace

TEST_CASE("a dual number carries the derivative of depth", "[depth]") {
  rc::prop("with respect to red, green, c_red, kappa and g", [] {
    const Pad pad;
    const double l = test::uniform(1, 13);
    // steps that change the depth by some micrometres: differences are then accurate to 1e-7
    const double steps[] = {1e-4, 1e-4, 1e-7, 1e-6, 1e-6};
    for (int which = 0; which < 5; ++which) {
      const double by_dual = shifted_depth(pad, l, which, D(0, 1)).d;
      const double h = steps[which];
      const double by_difference =
          (shifted_depth(pad, l, which, h) - shifted_depth(pad, l, which, -h)) / (2 * h);
      RC_ASSERT(test::relative_error(by_dual, by_difference) <= 1e-6);
    }
  });
  SECTION("through the whole estimator") {
    const Pad pad;
    const auto depth = pad.pressed_depths(3);
    const auto plain = pad.frame<double>(depth);
    const bool of_red = GENERATE(true, false);
    const double h = 1e-4;
    Frame<D> seeded(pad.rows, pad.cols);
    auto more = plain;
    auto less = plain;
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      seeded.red.cells[k] = D(plain.red.cells[k], of_red ? 1 : 0);
      seeded.green.cells[k] = D(plain.green.cells[k], of_red ? 0 : 1);
      (of_red ? more.red : more.green).cells[k] += h;
      (of_red ? less.red : less.green).cells[k] -= h;
    }
    using Smoothing = BiasFreeMean;
    const auto dual = pad.estimator<Smoothing, Newton, D>({5});
    const auto real = pad.estimator<Smoothing, Newton, double>({5});
    const auto e = test::estimate<D>(dual, seeded);
    const auto up = test::estimate<double>(real, more).depth_mm;
    const auto down = test::estimate<double>(real, less).depth_mm;
    double worst = 0;
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      if (depth.cells[k] > 0.5) {
        const double difference = (up.cells[k] - down.cells[k]) / (2 * h);
        worst = (std::max)(worst, test::relative_error(e.depth_mm.cells[k].d, difference));
      }
    }
    CHECK(worst <= 1e-6);
  }
}

TEST_CASE("an estimator refuses what cannot be, and says why", "[depth]") {
  const Pad pad;
  const auto reference = pad.reference<float>();
  const auto message = [&](const auto& make) -> std::string {
    try {
      make();
    } catch (const parameter_error& e) {
      return e.what();
    }
    return "accepted";
  };
  using Catch::Matchers::StartsWith;
  const auto with_camera = [&](auto change) {
    Camera<double> camera = pad.camera;
    change(camera);
    return message([&] { DepthEstimator<>(camera, pad.fluid, reference); });
  };
  CHECK_THAT(with_camera([](auto& c) { c.refractive_index = 0.9; }),
             StartsWith("Camera: refractive_index = 0.9, must be"));
  CHECK_THAT(with_camera([](auto& c) { c.pitch_mm = 0; }), StartsWith("Camera: pitch_mm = 0"));
  CHECK_THAT(with_camera([](auto& c) { c.center_x_px = test::nan; }),
             StartsWith("Camera: center_x_px = nan"));
  const auto with_fluid = [&](auto change) {
    Absorption<double> fluid = pad.fluid;
    change(fluid);
    return message([&] { DepthEstimator<>(pad.camera, fluid, reference); });
  };
  CHECK_THAT(with_fluid([](auto& f) { f.c_red_per_mm = 0; }),
             StartsWith("Absorption: c_red_per_mm = 0, must be finite and > 0"));
  CHECK_THAT(with_fluid([](auto& f) { f.c_green_per_mm = 0.01; }),
             StartsWith("Absorption: c_green_per_mm = 0.01, must be finite and >= c_red_per_mm"));
  CHECK_THAT(with_fluid([](auto& f) { f.kappa = -1; }), StartsWith("Absorption: kappa = -1"));
  CHECK_THAT(with_fluid([](auto& f) { f.max_depth_mm = test::nan; }),
             StartsWith("Absorption: max_depth_mm = nan"));
  CHECK_THAT(message([&] { DepthEstimator<>(pad.camera, pad.fluid, DepthReference<float>()); }),
             StartsWith("DepthEstimator: rows = 0, must be in [1, 1000000]"));
  for (const int halvings : {-1, 1, 101}) {
    CHECK_THAT(
        message([&] { pad.estimator<NoSmoothing, published::Bisection, float>({}, {halvings}); }),
        StartsWith("Bisection: halvings = " + std::to_string(halvings)));
  }
  CHECK(message([&] { DepthEstimator<>(pad.camera, pad.fluid, reference); }) == "accepted");
}

TEST_CASE("a root is refined by the order that is told", "[depth]") {
  // sum f[j] s^(j + 1) with terms that fall like those of the depth
  test::Random random(6);
  for (int k = 0; k < 50; ++k) {
    double f[6];
    double scale = 1;
    for (double& c : f) {
      c = scale * random.uniform(0.5, 1);
      scale *= -0.3;
    }
    const double truth = random.uniform(0.2, 1);
    double target = 0;
    for (int j = 5; j >= 0; --j) {
      target = (target + f[j]) * truth;
    }
    const double off = 1e-2;
    CHECK(detail::refine<1>(f, target, truth + off) == truth + off);
    CHECK(std::abs(detail::refine<2>(f, target, truth + off) - truth) < off * off);
    CHECK(std::abs(detail::refine<3>(f, target, truth + off) - truth) < off * off * off);
    CHECK(std::abs(detail::refine<6>(f, target, truth + off) - truth) < 1e-11);
  }
}

TEST_CASE("the rim is the part of the pad up to a fifth of its depth", "[depth]") {
  struct {
    detail::PadArea area;
    DepthReference<double> reference;
  } pad;
  pad.reference.rows = 1;
  pad.reference.cols = 5;
  pad.reference.depth_mm = {10, 2, 2.01, 0, test::nan};
  pad.reference.rim_green = 100;
  const Image<double> light(1, 5, 50);
  const auto sum = detail::RimLight(pad).sum(0, 1, as_view(light), as_view(light), GreyScale{});
  CHECK(sum.pixels == 2);
  CHECK(sum.lit == 2);
  CHECK(sum.light == 1);
}
