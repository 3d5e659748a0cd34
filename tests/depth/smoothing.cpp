// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Smoothing policies against a mean that sums every window anew.
#include "fingerpad/depth/smoothing.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Frame;
using test::Image;
using test::Pad;

namespace {

namespace bound {
// Roundoff in grey levels of up to 255, with weights of two windows that sum to less than 2.5.
constexpr double single = 2.5 * 255 * 4 * 1.2e-7;
constexpr double twice = 2.5 * 255 * 1e3 * 2.3e-16;  // running sums of up to 1e3 pixels
constexpr double residual_step = 2.5 / 256;          // residuals are stored in steps of 1/128
}  // namespace bound

template <class S>
struct Smoothed {
  Image<S> red;
  Image<S> green;
};

template <class S, class Smoothing, class Pixel>
Smoothed<S> smooth(const detail::ColourSetup<S>& setup,
                   const Smoothing& smoothing,
                   const Frame<Pixel>& frame,
                   const GreyScale& scale) {
  Smoothed<S> out{Image<S>(setup.rows, setup.cols), Image<S>(setup.rows, setup.cols)};
  detail::ColourRows<Pixel, S, Smoothing> rows(setup, smoothing, scale);
  const auto red = as_view(frame.red);
  const auto green = as_view(frame.green);
  rows.start(setup, red, green, 0);
  for (Index i = 0; i < setup.rows; ++i) {
    rows.next(setup, red, green, &out.red(i, 0), &out.green(i, 0));
  }
  return out;
}

/// A random frame and mask, wide enough for whole SIMD vectors and a remainder. Valid levels are 20
/// to 230, whose residuals are below the 256 levels that 16 bits hold.
template <class Pixel, class S>
struct Scene {
  GreyScale scale = grey_scale_of<Pixel>();
  detail::ColourSetup<S> setup;
  Frame<Pixel> frame{0, 0};

  explicit Scene(bool anchored) {
    setup.rows = test::whole(1, 14);
    setup.cols = test::whole(1, 36);
    frame = Frame<Pixel>(setup.rows, setup.cols);
    test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
    // eighths, so that a float pixel can lie exactly on a limit
    scale.dark = scale.units_per_level * static_cast<double>(test::whole(160, 240)) / 8;
    scale.saturated = scale.units_per_level * static_cast<double>(test::whole(1600, 1840)) / 8;
    const double bad = test::uniform(0, 1);
    const double inside = test::uniform(0.3, 1);
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      setup.in_pad.push_back(random.uniform() < inside ? 1 : 0);
      // some of the levels lie exactly on a limit
      const auto level = [&] {
        const double x = random.uniform() < bad ? random.uniform(0, 255) : random.uniform(60, 190);
        return random.uniform() < 0.02 ? scale.dark / scale.units_per_level : x;
      };
      frame.red.cells[k] = test::stored<Pixel>(level());
      frame.green.cells[k] = test::stored<Pixel>(level());
      if (!std::is_integral_v<Pixel> && random.uniform() < bad / 3) {
        frame.red.cells[k] = static_cast<Pixel>(test::nan);
      }
      if (anchored) {
        setup.anchor.rise.push_back(S(random.uniform(1, 1.1)));
        setup.anchor.scattered.push_back(S(random.uniform(0, 10)));
      }
    }
    setup.anchor.kappa = S(random.uniform(0.9, 1.1));
  }

  double red(Index i, Index j) const {
    return static_cast<double>(frame.red(i, j)) / scale.units_per_level;
  }
  double green(Index i, Index j) const {
    return static_cast<double>(frame.green(i, j)) / scale.units_per_level;
  }
  bool valid(Index i, Index j) const {
    const auto good = [&](double x) {
      return x > scale.dark / scale.units_per_level && x < scale.saturated / scale.units_per_level;
    };
    return setup.in_pad[static_cast<std::size_t>(i * setup.cols + j)] != 0 && good(red(i, j)) &&
           good(green(i, j));
  }
  double rise(Index i, Index j) const {
    return static_cast<double>(setup.anchor.rise[static_cast<std::size_t>(i * setup.cols + j)]);
  }
  double scattered(Index i, Index j) const {
    return static_cast<double>(
        setup.anchor.scattered[static_cast<std::size_t>(i * setup.cols + j)]);
  }
  double kappa() const { return static_cast<double>(setup.anchor.kappa); }
  double residual(Index i, Index j) const {
    return rise(i, j) * green(i, j) - kappa() * red(i, j) + scattered(i, j);
  }
};

/// Mean of f over the valid pixels of a window; NaN where there are none.
template <class AnyScene, class F>
double window_mean_of(const AnyScene& scene, Index row, Index col, int window, const F& f) {
  double sum = 0;
  double count = 0;
  const Index r = window / 2;
  const Index last_row = (std::min)(row + r, scene.setup.rows - 1);
  const Index last_col = (std::min)(col + r, scene.setup.cols - 1);
  for (Index i = (std::max)(row - r, Index(0)); i <= last_row; ++i) {
    for (Index j = (std::max)(col - r, Index(0)); j <= last_col; ++j) {
      if (scene.valid(i, j)) {
        sum += f(i, j);
        count += 1;
      }
    }
  }
  return sum / count;
}

double oracle_mean(
    const auto& scene, const published::BoxMean& mean, Index i, Index j, const auto& f) {
  return window_mean_of(scene, i, j, mean.window_px, f);
}
double oracle_mean(const auto& scene, const AnchoredMean& mean, Index i, Index j, const auto& f) {
  return window_mean_of(scene, i, j, mean.window_px, f);
}
/// Sizes and weights as the documentation of the policy states them.
double oracle_mean(const auto& scene, const BiasFreeMean& mean, Index i, Index j, const auto& f) {
  const auto odd_near = [](double x) { return 2 * static_cast<int>(std::floor(x / 2)) + 1; };
  const double in = odd_near(1.4 * mean.window_px);
  const double out = odd_near(2.3 * mean.window_px);
  const double inner = window_mean_of(scene, i, j, static_cast<int>(in), f);
  const double outer = window_mean_of(scene, i, j, static_cast<int>(out), f);
  const double b = (in * in - 1) / (out * out - in * in);
  return (1 + b) * inner - b * outer;  // NaN if the inner window is empty
}

double oracle_red(const auto& scene, const published::BoxMean& mean, Index i, Index j) {
  return oracle_mean(scene, mean, i, j, [&](Index p, Index q) { return scene.red(p, q); });
}
double oracle_green(const auto& scene, const published::BoxMean& mean, Index i, Index j) {
  return oracle_mean(scene, mean, i, j, [&](Index p, Index q) { return scene.green(p, q); });
}
template <class Mean>
  requires(Mean::anchored)
double oracle_green(const auto& scene, const Mean& s, Index i, Index j) {
  return oracle_green(scene, published::BoxMean{s.windows_px()[0]}, i, j);  // one window for green
}
template <class Mean>
  requires(Mean::anchored)
double oracle_red(const auto& scene, const Mean& s, Index i, Index j) {
  const double residual =
      oracle_mean(scene, s, i, j, [&](Index p, Index q) { return scene.residual(p, q); });
  return (scene.rise(i, j) * oracle_green(scene, s, i, j) + scene.scattered(i, j) - residual) /
         scene.kappa();
}
double oracle_green(const auto& scene, const NoSmoothing&, Index i, Index j) {
  return scene.valid(i, j) ? scene.green(i, j) : test::nan;
}
double oracle_red(const auto& scene, const NoSmoothing&, Index i, Index j) {
  return scene.valid(i, j) ? scene.red(i, j) : test::nan;
}

bool near(double a, double b, double bound) {
  return a != a ? b != b : std::abs(a - b) <= bound;
}

template <class Smoothing>
Smoothing any(int window) {
  if constexpr (std::is_same_v<Smoothing, NoSmoothing>) {
    return {};
  } else {
    return {window};
  }
}

template <class Smoothing, class Pixel, class S>
void compare_with_oracle() {
  constexpr bool anchored = Smoothing::anchored;
  const Scene<Pixel, S> scene(anchored);
  const auto smoothing = any<Smoothing>(3 + 2 * static_cast<int>(test::whole(0, 6)));
  const auto out = smooth(scene.setup, smoothing, scene.frame, scene.scale);
  const bool single = std::is_same_v<S, float>;
  const bool whole = anchored && single && std::is_integral_v<Pixel>;
  const double rounding = single ? bound::single : bound::twice;
  for (Index i = 0; i < scene.setup.rows; ++i) {
    for (Index j = 0; j < scene.setup.cols; ++j) {
      const auto red = static_cast<double>(out.red(i, j));
      const auto green = static_cast<double>(out.green(i, j));
      RC_ASSERT(near(green, oracle_green(scene, smoothing, i, j), rounding));
      RC_ASSERT(near(red, oracle_red(scene, smoothing, i, j),
                     (1 + (anchored ? 2 : 0)) * rounding + (whole ? bound::residual_step : 0)));
    }
  }
}

}  // namespace

TEMPLATE_TEST_CASE("a smoothed colour is the mean over the valid pixels of the window",
                   "[smoothing]",
                   NoSmoothing,
                   published::BoxMean,
                   AnchoredMean,
                   BiasFreeMean) {
  rc::prop("8 bit", compare_with_oracle<TestType, std::uint8_t, float>);
  rc::prop("16 bit", compare_with_oracle<TestType, std::uint16_t, float>);
  rc::prop("float", compare_with_oracle<TestType, float, float>);
  rc::prop("double", compare_with_oracle<TestType, double, double>);
  rc::prop("8 bit in double", compare_with_oracle<TestType, std::uint8_t, double>);
}

TEST_CASE("the mean over whole windows has the bits of OpenCV's box filter", "[smoothing]") {
  detail::ColourSetup<float> setup;
  setup.rows = 61;
  setup.cols = 93;
  setup.in_pad.assign(std::size_t(61 * 93), 1);
  test::Random random(5);
  Frame<std::uint8_t> frame(61, 93);
  for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
    frame.red.cells[k] = static_cast<std::uint8_t>(random.whole(1, 254));
    frame.green.cells[k] = static_cast<std::uint8_t>(random.whole(1, 254));
  }
  for (const int window : {3, 5, 17, 29}) {
    const auto ours = smooth(setup, published::BoxMean{window}, frame, {});
    cv::Mat_<std::uint8_t> red(61, 93, frame.red.cells.data());
    cv::Mat_<float> theirs;
    cv::boxFilter(red, theirs, CV_32F, cv::Size(window, window));
    int differing = 0;
    for (int i = window / 2; i < 61 - window / 2; ++i) {
      for (int j = window / 2; j < 93 - window / 2; ++j) {
        differing += ours.red(i, j) == theirs(i, j) ? 0 : 1;
      }
    }
    INFO(window);
    CHECK(differing == 0);
  }
}

TEST_CASE("the bias-free mean leaves a quadratic deviation as it is", "[smoothing]") {
  rc::prop("wherever both windows are whole", [] {
    Scene<double, double> scene(false);
    scene.setup.rows = scene.setup.cols = 40;
    scene.setup.in_pad.assign(1600, 1);
    scene.frame = Frame<double>(40, 40);
    scene.scale = {};
    // an anchor of zero: the deviation is minus red
    scene.setup.anchor = {std::vector<double>(1600, 0), std::vector<double>(1600, 0), 1};
    double c[6];
    for (double& x : c) {
      x = test::uniform(-1, 1);
    }
    for (Index i = 0; i < 40; ++i) {
      for (Index j = 0; j < 40; ++j) {
        const double y = static_cast<double>(i - 20) / 20;
        const double x = static_cast<double>(j - 20) / 20;
        scene.frame.red(i, j) = 100 + c[0] * x + c[1] * y + 9 * (c[2] * x * x + c[3] * y * y);
        scene.frame.green(i, j) = 100 + 9 * (c[4] * x * y + c[5] * (x * x - y * y));
      }
    }
    const auto out = smooth(scene.setup, BiasFreeMean{7}, scene.frame, scene.scale);
    const auto box = smooth(scene.setup, AnchoredMean{7}, scene.frame, scene.scale);
    for (Index i = 8; i < 32; ++i) {
      for (Index j = 8; j < 32; ++j) {
        RC_ASSERT(near(out.red(i, j), scene.frame.red(i, j), bound::twice));
        // the bias of a box is its curvature times (w^2 - 1) / 12
        const double bias = 9 * (c[2] + c[3]) / 400 * (49 - 1) / 12;
        RC_ASSERT(near(box.red(i, j), scene.frame.red(i, j) + bias, bound::twice));
      }
    }
  });
}

TEST_CASE("the bias-free mean has the noise of a box of its name", "[smoothing]") {
  // 1.4 and 2.3 times the window: a^2/1.96 - 2ab/5.29 + b^2/5.29 = 1.01 for large windows.
  const auto sizes = BiasFreeMean{29}.windows_px();
  CHECK(sizes == std::array<int, 2>{41, 67});
  const auto w = detail::window_weights(sizes);
  CHECK(w[0] + w[1] == Approx(1));
  CHECK(w[0] * (41 * 41 - 1) + w[1] * (67 * 67 - 1) == Approx(0).margin(1e-9));
  const double variance = w[0] * w[0] / (41 * 41) + (2 * w[0] * w[1] + w[1] * w[1]) / (67 * 67);
  CHECK(variance * 29 * 29 == Approx(1).epsilon(0.05));
}

TEST_CASE("windows in samples are as wide on the pad, and never below three samples",
          "[smoothing]") {
  for (const int window_px : {7, 29, 61}) {
    for (const int step : {2, 3, 4}) {
      CAPTURE(window_px, step);
      const auto whole = BiasFreeMean{window_px}.windows_px();
      const auto sampled = BiasFreeMean{window_px, step}.windows_px();
      for (std::size_t k = 0; k < 2; ++k) {
        const int least = 3 + 2 * static_cast<int>(k);
        CHECK(sampled[k] % 2 == 1);
        CHECK(sampled[k] >= least);
        CHECK((sampled[k] == least || std::abs(sampled[k] * step - whole[k]) <= step + 1));
      }
      const int mean = AnchoredMean{window_px, step}.windows_px()[0];
      CHECK(mean % 2 == 1);
      CHECK((mean == 3 || std::abs(mean * step - window_px) <= step));
    }
  }
  CHECK_THROWS_AS((BiasFreeMean{29, 0}.windows_px()), parameter_error);
  CHECK_THROWS_AS((AnchoredMean{29, 0}.windows_px()), parameter_error);
}

namespace {

/// Error of an anchored estimator on the free pad, rim included, in mm.
template <class Pixel, class Mean, class S>
double free_pad_error(const Pad& pad, int window) {
  const auto estimator =
      pad.estimator<Mean, ExponentialFree<9, (sizeof(S) > 4 ? 12 : 6), (sizeof(S) > 4 ? 8 : 3)>, S>(
          Mean{window});
  const auto depth = pad.free_depths();
  const auto e = test::estimate<S>(estimator, pad.frame<Pixel>(depth));
  const double error = test::largest_error(e.depth_mm, depth);
  CAPTURE(error);
  return error;
}

}  // namespace

TEST_CASE("an anchored mean leaves the free pad as it is, rim and printed dots included",
          "[smoothing]") {
  Pad pad;
  pad.sphere_radius_mm = GENERATE(19.0, 20.0, 40.0);  // the first is steep at the rim
  const int window = GENERATE(3, 9, 21);
  // Double: roundoff. Float: roundoff of 57 grey levels, where F rises by 1.3 per mm; the first
  // pixels of the rim are the least accurate. 16 bit: residuals of half of 1/128 grey level, if all
  // have the same sign.
  CHECK(free_pad_error<double, AnchoredMean, double>(pad, window) <= 1e-10);
  CHECK(free_pad_error<double, BiasFreeMean, double>(pad, window) <= 1e-10);
  CHECK(free_pad_error<float, AnchoredMean, float>(pad, window) <= 3e-5);
  CHECK(free_pad_error<float, BiasFreeMean, float>(pad, window) <= 3e-5);
  CHECK(free_pad_error<std::uint16_t, AnchoredMean, float>(pad, window) <= 3e-3);
  CHECK(free_pad_error<std::uint16_t, BiasFreeMean, float>(pad, window) <= 2.2 * 3e-3);
}

TEST_CASE("a plain mean does not", "[smoothing]") {  // otherwise the test above would prove nothing
  const Pad pad;
  const auto depth = pad.free_depths();
  const auto frame = pad.frame<double>(depth);
  const auto box = pad.estimator<published::BoxMean, Newton, double>(published::BoxMean{9});
  CHECK(test::largest_error(test::estimate<double>(box, frame).depth_mm, depth) > 0.3);
}

TEMPLATE_TEST_CASE("what an invalid pixel holds changes no depth",
                   "[smoothing]",
                   std::uint8_t,
                   std::uint16_t,
                   float) {
  rc::prop("to the last bit, for every policy", [] {
    using Pixel = TestType;
    const Pad pad;
    const auto depth = pad.pressed_depths(3);
    auto frame = pad.frame<Pixel>(depth, 1, 11);
    auto other = frame;
    test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
    const double share = test::uniform(0, 0.9);
    const auto bad = [&]() -> Pixel {
      const Pixel kinds[] = {Pixel(0), test::stored<Pixel>(255), Pixel(test::stored<Pixel>(255.5))};
      if (std::is_integral_v<Pixel> || random.uniform() < 0.3) {
        return kinds[random.whole(0, 2)];
      }
      using Limits = std::numeric_limits<Pixel>;
      const Pixel more[] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                            (Limits::max)(), Pixel(-3)};
      return more[random.whole(0, 4)];
    };
    const auto spoil = [&](Frame<Pixel>& f, std::size_t k, bool first) {
      (first ? f.red : f.green).cells[k] = bad();
      (first ? f.green : f.red).cells[k] = test::stored<Pixel>(random.uniform(1, 300));
    };
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      const bool outside = depth.cells[k] != depth.cells[k];
      if (outside || random.uniform() < share) {
        spoil(frame, k, random.uniform() < 0.5);
        spoil(other, k, random.uniform() < 0.5);
      }
    }
    const auto same = [&](const auto& smoothing) {
      using Smoothing = std::remove_cvref_t<decltype(smoothing)>;
      const auto estimator = pad.estimator<Smoothing, ExponentialFree<>, float>(smoothing);
      return test::same_bits(test::estimate<float>(estimator, frame).depth_mm,
                             test::estimate<float>(estimator, other).depth_mm);
    };
    RC_ASSERT(same(NoSmoothing{}));
    RC_ASSERT(same(published::BoxMean{5}));
    RC_ASSERT(same(AnchoredMean{7}));
    RC_ASSERT(same(BiasFreeMean{5}));
  });
}

TEMPLATE_TEST_CASE("windows that cannot be are refused",
                   "[smoothing]",
                   published::BoxMean,
                   AnchoredMean,
                   BiasFreeMean) {
  const Pad pad;
  const auto make = [&](int window) {
    const auto estimator = pad.estimator<TestType, Newton, double>(any<TestType>(window));
    return estimator.template workspace<std::uint8_t>();
  };
  constexpr bool two = std::is_same_v<TestType, BiasFreeMean>;
  const int largest = two ? 109 : 255;
  CHECK_NOTHROW(make(3));
  CHECK_NOTHROW(make(largest));  // larger than the image
  for (const int window : {-3, 0, 1, 2, 4, 28, largest + 1, largest + 2}) {
    std::string message;
    try {
      make(window);
    } catch (const parameter_error& e) {
      message = e.what();
    }
    INFO(window);
    CHECK(message.find("window_px = " + std::to_string(window) + ", must be odd, 3..") !=
          std::string::npos);
  }
}
