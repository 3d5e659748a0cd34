// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every sensor, every frame and every window.
#include "fingerpad/depth/depth.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fingerpad/published/depth.hpp"
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
constexpr double bisection = 14.0 / 32768 + 1e-9;  // its half-width, 16 halvings of 14 mm
constexpr double newton = 1e-10;                   // roundoff of g, of the rays and of the colours
constexpr double polynomial = 1e-9;                // wider cameras need more powers of u
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

/// Depth of each pixel by itself, by polynomials.
template <class S>
struct Rows {
  using Scalar = S;
  static constexpr bool one_height = false;
  static constexpr double bound =
      std::is_same_v<S, float> ? bound_mm::single : bound_mm::polynomial;

  static Image<S> depth_of(const Pad& pad, const Frame<S>& frame) {
    auto e = test::estimate(pad.estimator<S>({.window_px = 1}), frame);
    RC_ASSERT(e.result.status != FrameStatus::refused);
    return e.depth_mm;
  }
};

/// The same by Newton's method.
template <class S>
struct Newton {
  using Scalar = S;
  static constexpr bool one_height = false;
  static constexpr double bound = std::is_same_v<S, float> ? bound_mm::single : bound_mm::newton;

  static Image<S> depth_of(const Pad& pad, const Frame<S>& frame) {
    Image<S> depth(pad.rows, pad.cols, not_a_number<S>());
    const auto reference = pad.reference<S>();
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        if (reference.in_pad(i, j)) {
          const auto light = pad.pencil(i, j);
          depth(i, j) =
              newton_depth(cast<S>(pad.fluid),
                           Pencil<S>{S(light.path_factor),
                                     {S(light.height.meridional_mm), S(light.height.sagittal_mm)}},
                           reference.g(i, j), Colour<S>{frame.red(i, j), frame.green(i, j)})
                  .depth_mm;
        }
      }
    }
    return depth;
  }
};

/// As printed. It has no plate, and takes one height for both directions of a pencil.
struct Printed {
  using Scalar = double;
  static constexpr bool one_height = true;
  static constexpr double bound = bound_mm::bisection;

  static Image<double> depth_of(const Pad& pad, const Frame<double>& frame) {
    const auto free = pad.free_depths();
    const auto free_frame = pad.frame<double>(free);
    published::DepthEstimator<> estimator(pad.published(1), free_frame.red, free_frame.green, free);
    Image<double> depth(pad.rows, pad.cols);
    RC_ASSERT(estimator(frame.red, frame.green, depth));
    return depth;
  }
};

/// A pad that the way can see.
template <class Way>
Pad any_pad_of() {
  Pad pad = any_pad();
  pad.one_height = Way::one_height;
  pad.camera.plate_thickness_mm = Way::one_height ? 0 : pad.camera.plate_thickness_mm;
  return pad;
}

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
                   Rows<float>,
                   Rows<double>,
                   Newton<float>,
                   Newton<double>,
                   Printed) {
  rc::prop("on random sensors, with printed dots", [] {
    using S = typename TestType::Scalar;
    const Pad pad = any_pad_of<TestType>();
    const auto depth = pad.pressed_depths(test::uniform(0, 5));
    const auto found = TestType::depth_of(pad, pad.frame<S>(depth));
    RC_ASSERT(test::largest_error(found, depth) <= TestType::bound);
  });
}

TEMPLATE_TEST_CASE("the membrane's brightness does not matter",
                   "[depth][law]",
                   Rows<double>,
                   Newton<double>,
                   Printed) {
  rc::prop("pixel by pixel", [] {
    const Pad pad = any_pad_of<TestType>();
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
    const auto found = TestType::depth_of(pad, frame);
    RC_ASSERT(test::largest_error(found, depth) <= 3 * TestType::bound);
  });
}

TEST_CASE("units do not matter", "[depth][law]") {
  const auto depth_of = [](const Pad& pad, const Frame<double>& frame, double levels) {
    const auto scale = GreyScale{levels, 0, 255 * levels};
    const auto free = pad.free_depths();
    const auto free_frame = pad.frame<double>(free);
    const auto reference =
        fit_reference<double>(pad.camera, pad.fluid, free_frame.red, free_frame.green, free, scale);
    DepthEstimator<double> estimator(pad.camera, pad.fluid, reference,
                                     {.window_px = 3, .scale = scale});
    return test::estimate(estimator, frame).depth_mm;
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
                   Rows<float>,
                   Newton<double>,
                   Printed) {
  rc::prop("at every pixel", [] {
    using S = typename TestType::Scalar;
    const Pad pad = any_pad_of<TestType>();
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
    const auto before = TestType::depth_of(pad, frame);
    const auto red = TestType::depth_of(pad, redder);
    const auto green = TestType::depth_of(pad, greener);
    // beyond the range there is no depth, or, as printed, its end
    const S end = S(TestType::one_height ? 2 * bound_mm::bisection : 0);
    const S deepest = S(pad.fluid.max_depth_mm) - end;
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      const S l = before.cells[k];
      if (is_finite(l) && l > end && l < deepest) {
        RC_ASSERT(!is_finite(red.cells[k]) || red.cells[k] > l);
        RC_ASSERT(!is_finite(green.cells[k]) || green.cells[k] < l);
      }
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
    const auto depth_of = [&](const Pad& p, const Frame<Pixel>& f) {
      return test::estimate(p.estimator<float>({.window_px = 5}), f).depth_mm;
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

template <class P, class S>
struct Kind {
  using Pixel = P;
  using Scalar = S;
};

}  // namespace

TEMPLATE_TEST_CASE("bands of rows give the bits of the whole frame, and the counts add up",
                   "[depth][law]",
                   (Kind<std::uint8_t, float>),
                   (Kind<std::uint16_t, float>),
                   (Kind<float, float>),
                   (Kind<std::uint8_t, double>),
                   (Kind<double, double>)) {
  rc::prop("for any band", [] {
    using S = typename TestType::Scalar;
    using Pixel = typename TestType::Pixel;
    Pad pad = any_pad();
    pad.rows += test::whole(0, 50);  // more than the rows after which running sums restart
    auto frame = pad.frame<Pixel>(pad.pressed_depths(test::uniform(0, 5)), 1, 3);
    spoil(frame, static_cast<int>(test::whole(0, 40)));
    // any odd window, so that restarts and borders fall everywhere
    const int window_px = 1 + 2 * static_cast<int>(test::whole(0, 10));
    auto estimator = pad.estimator<S>({.window_px = window_px});
    const auto whole = test::estimate(estimator, frame);

    test::Estimate<S> bands(pad.rows, pad.cols);
    const Index a = test::whole(0, pad.rows);
    const Index b = test::whole(a, pad.rows);
    std::array<Index, pixel_status_count> count = {};
    const std::pair<Index, Index> rows_of[] = {{b, pad.rows}, {0, a}, {a, b}};  // in any order
    for (const auto& [first, last] : rows_of) {
      const auto result =
          estimator.band(first, last, frame.red, frame.green, bands.depth_mm, bands.status);
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
