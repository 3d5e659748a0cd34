// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every sensor, every frame and every policy.
#include "fingerpad/published/depth.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"
#include "support/rotated.hpp"

using namespace fingerpad;
using test::Frame;
using test::Image;
using test::mirrored;
using test::Pad;
using test::transposed;

namespace {

namespace bound_mm {
constexpr double bisection = 18.0 / 32768 + 1e-9;  // its half-width, 16 halvings of 18 mm
constexpr double newton = 1e-10;                   // roundoff of g, of the rays and of the colours
constexpr double polynomial = 1e-9;  // degree 10 in double; wider cameras need more powers of u
// Single floats of up to 60 grey levels (spacing 3.8e-6) where F rises by more than 1 level per mm.
constexpr double single = 2e-4;
constexpr double anchored_8_bit = 1e-3;  // 1/128 of a grey level, the step of the stored residuals
}  // namespace bound_mm

/// Any camera, fluid and pad; small, so that hundreds of them are fast.
Pad any_pad() {
  Pad pad;
  pad.rows = test::whole(14, 26);
  pad.cols = test::whole(14, 26);
  pad.camera.plate_distance_mm = test::uniform(40, 100);
  pad.camera.refractive_index = test::uniform(1.2, 1.6);
  pad.camera.pitch_mm = test::uniform(1.2, 2);
  pad.camera.center_x_px = static_cast<double>(pad.cols) / 2 + test::uniform(-2, 1);
  pad.camera.center_y_px = static_cast<double>(pad.rows) / 2 + test::uniform(-2, 1);
  pad.camera.plate_thickness_mm = test::whole(0, 1) == 0 ? 0 : test::uniform(0, 10);
  pad.fluid.c_red_per_mm = test::uniform(0.02, 0.04);
  pad.fluid.c_green_per_mm =
      pad.fluid.c_red_per_mm + (test::whole(0, 3) == 0 ? 0 : test::uniform(0, 0.01));
  pad.fluid.kappa = test::uniform(0.8, 1.2);
  // Only g h^2 matters: the light scattered back stays between a few and some 50 grey levels.
  const double h = pad.camera.refractive_index * pad.camera.plate_distance_mm;
  pad.scattering = test::uniform(0.008, 0.02) * square(66.5 / h);
  pad.scattering_loss = test::uniform(0, 0.1);
  pad.brightness = test::uniform(30, 60);
  pad.height_mm = test::uniform(6, 13.5);
  return pad;
}

/// An inverse policy with its number type and its error.
template <class Inverse, class Scalar, class Heights = AstigmaticHeights>
struct Way {
  using inverse = Inverse;
  using scalar = Scalar;
  using heights = Heights;
  static double bound() {
    if constexpr (std::is_same_v<Scalar, float>) {
      return bound_mm::single +
             (std::is_same_v<Inverse, published::Bisection> ? bound_mm::bisection : 0);
    } else {
      return std::is_same_v<Inverse, published::Bisection> ? bound_mm::bisection
             : std::is_same_v<Inverse, Newton>             ? bound_mm::newton
                                                           : bound_mm::polynomial;
    }
  }
};

/// Makes some pixels dark, saturated or, if the type allows it, NaN.
template <class Pixel>
void spoil(Frame<Pixel>& frame, int share) {
  for (Index i = 0; i < frame.red.rows(); ++i) {
    for (Index j = 0; j < frame.red.cols(); ++j) {
      if (test::whole(0, 99) >= share) {
        continue;
      }
      Pixel bad = Pixel(0);
      const auto kind = test::whole(0, 2);
      if (kind == 1) {
        bad = test::stored<Pixel>(255);
      } else if (kind == 2 && !std::is_integral_v<Pixel>) {
        bad = static_cast<Pixel>(test::nan);
      }
      (test::whole(0, 1) == 0 ? frame.red : frame.green)(i, j) = bad;
    }
  }
}

template <class Pixel, class Turn>
Frame<Pixel> rotated(const Frame<Pixel>& frame, const Turn& turn) {
  Frame<Pixel> out(0, 0);
  out.red = turn(frame.red);
  out.green = turn(frame.green);
  return out;
}

/// Largest difference; infinite where only one is NaN.
template <class S>
double difference(const Image<S>& a, const Image<S>& b) {
  return (std::max)(test::largest_error(a, b), test::largest_error(b, a));
}

}  // namespace

TEMPLATE_TEST_CASE("what the forward model shows, the inverse finds",
                   "[depth][law]",
                   (Way<published::Bisection, double>),
                   (Way<published::Bisection, float, published::SingleHeight>),
                   (Way<Newton, double>),
                   (Way<Newton, double, published::SingleHeight>),
                   (Way<Newton, float>),
                   (Way<ExponentialFree<>, float>),
                   (Way<ExponentialFree<9, 10, 8>, double, published::SingleHeight>)) {
  rc::prop("on random sensors, with printed dots", [] {
    using S = typename TestType::scalar;
    using Heights = typename TestType::heights;
    const Pad pad = any_pad();
    const auto depth = pad.pressed_depths(test::uniform(0, 5));
    const auto frame = pad.frame<S, Heights>(depth);
    const auto estimator = pad.estimator<NoSmoothing, typename TestType::inverse, S, Heights>();
    const auto e = test::estimate<S>(estimator, frame);
    RC_ASSERT(test::largest_error(e.depth_mm, depth) <= TestType::bound());
    RC_ASSERT(e.result.valid_pixels() == e.result.pad_pixels);
  });
}

TEMPLATE_TEST_CASE("the membrane's brightness does not matter",
                   "[depth][law]",
                   (Way<published::Bisection, double>),
                   (Way<Newton, double>),
                   (Way<ExponentialFree<9, 10, 8>, double>)) {
  rc::prop("pixel by pixel", [] {
    const Pad pad = any_pad();
    const auto depth = pad.pressed_depths(test::uniform(0, 5));
    Frame<double> frame(pad.rows, pad.cols);
    const double low = test::uniform(1, 40);  // at most tripled, so nothing saturates
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        const double bright = low * (1 + static_cast<double>((7 * i + 3 * j) % 5) / 2);
        const auto c = pad.colour(i, j, depth(i, j) == depth(i, j) ? depth(i, j) : 1.0, bright);
        frame.red(i, j) = c.red;
        frame.green(i, j) = c.green;
      }
    }
    const auto e = test::estimate<double>(
        pad.estimator<NoSmoothing, typename TestType::inverse, double>(), frame);
    RC_ASSERT(test::largest_error(e.depth_mm, depth) <= 3 * TestType::bound());
  });
}

TEST_CASE("units do not matter", "[depth][law]") {
  const auto depth_of = [](const Pad& pad, const Frame<double>& frame, double levels) {
    const auto scale = GreyScale{levels, 0, 255 * levels};
    const auto reference = pad.reference<double>(scale);
    const DepthEstimator<BiasFreeMean, Newton, AstigmaticHeights, double> estimator(
        pad.camera, pad.fluid, reference, {3});
    return test::estimate<double>(estimator, frame, scale).depth_mm;
  };
  rc::prop("lengths times a, absorption and scattering divided: depth times a", [&] {
    const Pad pad = any_pad();
    const double a = test::log_uniform(0.1, 10);
    Pad large = pad;
    large.camera.plate_distance_mm *= a;
    large.camera.pitch_mm *= a;
    large.camera.plate_thickness_mm *= a;
    large.sphere_radius_mm *= a;
    large.height_mm *= a;
    large.fluid.c_red_per_mm /= a;
    large.fluid.c_green_per_mm /= a;
    large.fluid.max_depth_mm *= a;
    large.scattering /= a * a;
    const double press = test::uniform(0, 5);
    auto expected = depth_of(pad, pad.frame<double>(pad.pressed_depths(press)), 1);
    for (double& l : expected.cells) {
      l *= a;
    }
    const auto frame = large.frame<double>(large.pressed_depths(a * press));
    RC_ASSERT(difference(depth_of(large, frame, 1), expected) <= a * bound_mm::newton);
  });
  rc::prop("intensities times two, to the last bit", [&] {
    const Pad pad = any_pad();
    auto frame = pad.frame<double>(pad.pressed_depths(test::uniform(0, 5)));
    spoil(frame, 10);
    const auto once = depth_of(pad, frame, 1);
    Pad twice = pad;
    twice.brightness *= 2;
    twice.scattering *= 2;
    for (auto* channel : {&frame.red, &frame.green}) {
      for (double& x : channel->cells) {
        x *= 2;
      }
    }
    RC_ASSERT(test::same_bits(depth_of(twice, frame, 2), once));
  });
}

TEMPLATE_TEST_CASE("more red is deeper, more green is less deep",
                   "[depth][law]",
                   (Way<Newton, double>),
                   (Way<published::Bisection, double>),
                   (Way<ExponentialFree<>, float>)) {
  rc::prop("at every pixel", [] {
    using S = typename TestType::scalar;
    const Pad pad = any_pad();
    const auto estimator = pad.estimator<NoSmoothing, typename TestType::inverse, S>();
    const auto frame = pad.frame<S>(pad.pressed_depths(test::uniform(0, 5)));
    auto redder = frame;
    auto greener = frame;
    const S more = S(test::uniform(0.01, 0.5));
    for (S& x : redder.red.cells) {
      x += more;
    }
    for (S& x : greener.green.cells) {
      x += more;
    }
    const auto before = test::estimate<S>(estimator, frame);
    const auto red = test::estimate<S>(estimator, redder);
    const auto green = test::estimate<S>(estimator, greener);
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      if (before.status.cells[k] != PixelStatus::ok) {
        continue;
      }
      RC_ASSERT(red.status.cells[k] == PixelStatus::above_range ||
                red.depth_mm.cells[k] > before.depth_mm.cells[k]);
      RC_ASSERT(green.status.cells[k] == PixelStatus::below_range ||
                green.depth_mm.cells[k] < before.depth_mm.cells[k]);
    }
  });
}

TEMPLATE_TEST_CASE("a mirrored or transposed frame gives the mirrored or transposed depth",
                   "[depth][law]",
                   std::uint8_t,
                   std::uint16_t,
                   float) {
  rc::prop("when the camera's center goes with it", [] {
    using Pixel = TestType;
    const Pad pad = any_pad();
    auto frame = pad.frame<Pixel>(pad.pressed_depths(test::uniform(0, 5)), 1, 7);
    spoil(frame, 10);
    const auto smoothing = BiasFreeMean{5};
    const auto depth_of = [&](const Pad& p, const Frame<Pixel>& f) {
      using Smoothing = BiasFreeMean;
      return test::estimate<float>(p.estimator<Smoothing, ExponentialFree<>, float>(smoothing), f)
          .depth_mm;
    };
    const auto depth = depth_of(pad, frame);
    Pad mirror = pad;
    mirror.camera.center_x_px = static_cast<double>(pad.cols - 1) - pad.camera.center_x_px;
    // the reference's depths differ by roundoff and, in 8 bit, so does the step of storage
    const auto flip = [](const auto& image) { return mirrored(image); };
    RC_ASSERT(difference(depth_of(mirror, rotated(frame, flip)), mirrored(depth)) <=
              bound_mm::anchored_8_bit);
    Pad turn = pad;
    std::swap(turn.rows, turn.cols);
    std::swap(turn.camera.center_x_px, turn.camera.center_y_px);
    const auto swap = [](const auto& image) { return transposed(image); };
    RC_ASSERT(difference(depth_of(turn, rotated(frame, swap)), transposed(depth)) <=
              bound_mm::anchored_8_bit);
  });
}

namespace {

template <class Smoothing, class Pixel, class Scalar>
struct Rows {
  using smoothing = Smoothing;
  using pixel = Pixel;
  using scalar = Scalar;
};

/// Any odd window size, so that restarts and borders fall everywhere.
template <class Smoothing>
Smoothing any_window() {
  const int window = 3 + 2 * static_cast<int>(test::whole(0, 9));
  if constexpr (std::is_same_v<Smoothing, NoSmoothing>) {
    return {};
  } else {
    return Smoothing{window};
  }
}

}  // namespace

TEMPLATE_TEST_CASE("bands of rows give the bits of the whole frame, and the counts add up",
                   "[depth][law]",
                   (Rows<NoSmoothing, std::uint8_t, float>),
                   (Rows<published::BoxMean, std::uint8_t, float>),
                   (Rows<AnchoredMean, std::uint8_t, float>),
                   (Rows<BiasFreeMean, std::uint8_t, float>),
                   (Rows<published::BoxMean, std::uint16_t, float>),
                   (Rows<BiasFreeMean, std::uint16_t, float>),
                   (Rows<NoSmoothing, float, float>),
                   (Rows<published::BoxMean, float, float>),
                   (Rows<BiasFreeMean, float, float>),
                   (Rows<BiasFreeMean, double, double>),
                   (Rows<AnchoredMean, double, double>)) {
  rc::prop("for any band", [] {
    using S = typename TestType::scalar;
    using Pixel = typename TestType::pixel;
    Pad pad = any_pad();
    pad.rows += test::whole(0, 50);  // more than the rows after which running sums restart
    auto frame = pad.frame<Pixel>(pad.pressed_depths(test::uniform(0, 5)), 1, 3);
    spoil(frame, static_cast<int>(test::whole(0, 40)));
    const auto estimator = pad.estimator<typename TestType::smoothing, ExponentialFree<>, S>(
        any_window<typename TestType::smoothing>());
    const auto whole = test::estimate<S>(estimator, frame);

    test::Estimate<S> bands(pad.rows, pad.cols);
    auto workspace = estimator.template workspace<Pixel>();
    const Index a = test::whole(0, pad.rows);
    const Index b = test::whole(a, pad.rows);
    std::array<Index, pixel_status_count> count = {};
    const std::pair<Index, Index> rows_of[] = {{b, pad.rows}, {0, a}, {a, b}};  // in any order
    for (const auto& [first, last] : rows_of) {
      const auto result = estimator.band(first, last, frame.red, frame.green, bands.depth_mm,
                                         bands.status, workspace);
      RC_ASSERT(result.ok());
      RC_ASSERT(std::accumulate(result.count.begin(), result.count.end(), Index(0)) ==
                (last - first) * pad.cols);
      for (std::size_t k = 0; k < count.size(); ++k) {
        count[k] += result.count[k];
      }
    }
    RC_ASSERT(test::same_bits(bands.depth_mm, whole.depth_mm));
    RC_ASSERT(bands.status.cells == whole.status.cells);
    RC_ASSERT(count == whole.result.count);
    std::array<Index, pixel_status_count> seen = {};
    Index numbers = 0;
    for (std::size_t k = 0; k < whole.status.cells.size(); ++k) {
      ++seen[static_cast<std::size_t>(whole.status.cells[k])];
      numbers += is_finite(whole.depth_mm.cells[k]) ? 1 : 0;
    }
    RC_ASSERT(seen == whole.result.count);
    RC_ASSERT(numbers == whole.result.valid_pixels());
  });
}
