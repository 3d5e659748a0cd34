// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A fingertip under a lamp that is not that of the reference.
#include <cmath>
#include <cstdint>
#include <utility>

#include "fingerpad/pipeline/fingertip.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

test::Pad bright_pad() {
  test::Pad pad = test::pad_of(240, 280, 0.16);
  pad.brightness = 120;
  pad.scattering *= 120 / 57.0;
  return pad;
}

/// Plays frames of a pad, free or pressed by 2 mm, under any light.
class Player {
 public:
  Player() : pad_(bright_pad()), fingertip_(options_of(pad_)) {}

  FingertipResult operator()(bool pressed, double green, double red) {
    depth_mm_ = pressed ? pad_.pressed_depths(2) : pad_.free_depths();
    const auto clean = pad_.frame<double>(depth_mm_);
    test::Frame<std::uint8_t> frame(pad_.rows, pad_.cols);
    for (std::size_t k = 0; k < clean.red.cells.size(); ++k) {
      if (clean.red.cells[k] > 0) {
        frame.red.cells[k] =
            test::stored<std::uint8_t>(red * clean.red.cells[k] + random_.normal());
        frame.green.cells[k] =
            test::stored<std::uint8_t>(green * clean.green.cells[k] + random_.normal());
      }
    }
    return fingertip_(frame.red, frame.green);
  }
  /// Mean of the last frame, in the middle of the pad.
  double error_mm() const {
    double sum = 0, count = 0;
    const auto found = fingertip_.depth_mm();
    for (Index i = 40; i < 200; ++i) {
      for (Index j = 60; j < 220; ++j) {
        const double e = std::abs(static_cast<double>(found(i, j)) - depth_mm_(i, j));
        sum += std::isfinite(e) ? e : 0;
        count += std::isfinite(e) ? 1 : 0;
      }
    }
    return sum / count;
  }

 private:
  static FingertipOptions options_of(const test::Pad& pad) {
    FingertipOptions options{pad.camera, pad.fluid, pad.reference<float>()};
    options.sampling = 2;
    options.smoothing_px = 15;
    options.contact.ring_px = 13;
    return options;
  }

  test::Pad pad_;
  Fingertip fingertip_;
  test::Random random_{9};
  Image<double> depth_mm_;
};

}  // namespace

TEST_CASE("a free frame tells the light, which a press then keeps", "[fingertip]") {
  for (const auto& [green, red] : {std::pair(0.9, 0.9), {1.0, 1.03}, {0.97, 1.0}}) {
    CAPTURE(green, red);
    Player play;
    CHECK_FALSE(play(false, green, red).depth_in_doubt);
    CHECK(play.error_mm() < 0.04);
    for (int k = 0; k < 10; ++k) {
      const auto touch = play(true, green, red);
      CHECK(touch.contact.in_contact());
      CHECK_FALSE(touch.depth_in_doubt);
      CHECK(play.error_mm() < 0.04);
    }
  }
}

TEST_CASE("a lamp that jumps is in doubt for one frame", "[fingertip]") {
  for (const auto& [green, red] : {std::pair(0.9, 0.9), {1.0, 1.03}, {0.97, 0.97}}) {
    CAPTURE(green, red);
    Player play;
    CHECK_FALSE(play(false, 1, 1).depth_in_doubt);
    CHECK(play(false, green, red).depth_in_doubt);
    CHECK(play.error_mm() > 0.09);
    CHECK_FALSE(play(false, green, red).depth_in_doubt);
    CHECK(play.error_mm() < 0.04);
  }
}

TEST_CASE("a light that does not change is never in doubt", "[fingertip]") {
  Player play;
  for (int k = 0; k < 40; ++k) {
    const auto touch = play(k % 10 > 4, 1, 1);
    CAPTURE(k);
    CHECK_FALSE(touch.depth_in_doubt);
    CHECK(play.error_mm() < 0.04);
  }
}

TEST_CASE("a light that drifts during a press is in doubt before the depth is wrong",
          "[fingertip]") {
  // green and red for each frame, from a single free frame on
  for (const auto& [green, red] :
       {std::pair(0.997, 0.997), {1.004, 1.004}, {1.0, 1.001}, {1.0, 0.999}}) {
    CAPTURE(green, red);
    Player play;
    CHECK_FALSE(play(false, 1, 1).depth_in_doubt);
    CHECK_FALSE(play(true, 1, 1).depth_in_doubt);
    double greens = 1, reds = 1;
    bool is_doubted = false;
    for (int k = 0; k < 12; ++k) {
      const auto touch = play(true, greens *= green, reds *= red);
      is_doubted = touch.depth_in_doubt;
      CAPTURE(k, touch.depth_light_sd_mm);
      CHECK((is_doubted || play.error_mm() < 0.05));
    }
    CHECK(is_doubted);
    (void)play(false, greens, reds);
    CHECK_FALSE(play(false, greens, reds).depth_in_doubt);  // a free frame ends it
    CHECK_FALSE(play(true, greens, reds).depth_in_doubt);
  }
}

TEST_CASE("a recording that begins in contact doubts a light that is not the reference's",
          "[fingertip]") {
  Player as_ever, darker, redder;
  CHECK_FALSE(as_ever(true, 1, 1).depth_in_doubt);
  CHECK(darker(true, 0.97, 0.97).depth_in_doubt);
  CHECK(redder(true, 1, 1.01).depth_in_doubt);
}
