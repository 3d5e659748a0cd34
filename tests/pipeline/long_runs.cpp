// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// States after many frames with drop-outs, jumps of the clock and restarts: they have not drifted
// and are not stuck. LONG_RUN_FRAMES=10000000 runs that many frames of each instead of a few
// thousand.
#include <array>
#include <cstdlib>
#include <random>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/grip_control.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

long frames() {
  const char* given = std::getenv("LONG_RUN_FRAMES");
  return given != nullptr ? std::atol(given) : 4000;
}

class Any {
 public:
  double number(double min, double max) {
    return std::uniform_real_distribution<>(min, max)(engine_);
  }
  /// True with a probability of 1 / count.
  bool once_in(int count) { return std::uniform_int_distribution<>(1, count)(engine_) == 1; }

 private:
  std::mt19937 engine_{20110801};
};

test::Image<Point2<float>> lattice(Any& any, float shift) {
  test::Image<Point2<float>> dots(6, 6);
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 6; ++j) {
      dots(i, j) = {20 * static_cast<float>(j) + shift, 20 * static_cast<float>(i)};
      if (any.once_in(30)) {
        dots(i, j).x = std::nanf("");
      }
    }
  }
  return dots;
}

/// A pad's dots in mm, displaced along x, some of them missing.
test::Image<Point3<double>> dots_in_space(Any& any, double shift_mm) {
  test::Image<Point3<double>> dots(6, 6);
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 6; ++j) {
      const double x = static_cast<double>(j) - 2.5, y = static_cast<double>(i) - 2.5;
      dots(i, j) = {1.5 * x + shift_mm, 1.5 * y,
                    any.once_in(30) ? test::nan : 12 - 0.05 * (x * x + y * y)};
    }
  }
  return dots;
}

/// A round contact with a pattern of its own, anywhere on a gel; holes are unknown.
test::Image<float> imprint(Any& any, double x, double y) {
  test::Image<float> cells(20, 20, 0);
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 0; j < 20; ++j) {
      const double u = static_cast<double>(j) - x, v = static_cast<double>(i) - y;
      if (u * u + v * v < 36) {
        cells(i, j) = any.once_in(300)
                          ? std::nanf("")
                          : static_cast<float>(1 + 0.3 * std::sin(u) * std::cos(2 * v));
      }
    }
  }
  return cells;
}
test::Image<std::uint8_t> pressed(const test::Image<float>& cells) {
  test::Image<std::uint8_t> contact(20, 20, 0);
  for (std::size_t k = 0; k < cells.cells.size(); ++k) {
    contact.cells[k] = cells.cells[k] > 0 ? 1 : 0;
  }
  return contact;
}

}  // namespace

TEST_CASE("long runs: after a lost contact a stick ratio is that of a start", "[long_run]") {
  Any any;
  StickRatio<> state(6, 6), fresh(6, 6);
  test::Image<std::uint8_t> contact(6, 6, 1), none(6, 6, 0);
  float shift = 0;
  bool sound = true;
  for (long k = 0; k < frames(); ++k) {
    shift = any.once_in(100) ? 0 : shift + static_cast<float>(any.number(-1, 1.2));
    const double time_s = 0.03 * static_cast<double>(k) * (any.once_in(100) ? -1 : 1);
    const auto r = state(lattice(any, shift), any.once_in(40) ? none : contact, time_s);
    sound = sound && (std::isnan(r.stick_ratio) || (r.stick_ratio >= 0 && r.stick_ratio <= 1));
  }
  CHECK(sound);
  state.reset();
  const auto free = lattice(any, 0);
  (void)state(free, none);
  (void)fresh(free, none);
  for (int k = 0; k < 20; ++k) {
    const auto dots = lattice(any, 0.7F * static_cast<float>(k));
    const auto a = state(dots, contact), b = fresh(dots, contact);
    CHECK(a.status == b.status);
    CHECK((a.stick_ratio == b.stick_ratio || std::isnan(b.stick_ratio)));
  }
}

TEST_CASE("long runs: a window of taxels forgets all that was before it", "[long_run]") {
  Any any;
  const TaxelFeatures<> finger(3, 3);
  FoamHand<> hand({finger, finger});
  double time_s = 0;
  const auto sample = [&](double size) {
    test::Image<double> taxels(3, 3);
    for (double& reading : taxels.cells) {
      reading = any.once_in(50) ? test::nan : 1000 + any.number(-size, size);
    }
    return taxels;
  };
  for (long k = 0; k < frames(); ++k) {
    time_s += any.once_in(500) ? any.number(-1, 100) : 0.03;
    const auto left = sample(any.once_in(100) ? 1e12 : 30), right = sample(30);
    (void)hand(std::array{as_view(left), as_view(right)}, time_s);
    if (any.once_in(3000)) {
      hand.reset();
    }
  }
  FoamHand<> fresh({finger, finger});
  for (int k = 0; k < 300; ++k) {
    time_s += k == 0 ? 1000 : 0.03;  // the clock jumps: both restart
    const auto left = sample(30), right = sample(30);
    (void)hand(std::array{as_view(left), as_view(right)}, time_s);
    (void)fresh(std::array{as_view(left), as_view(right)}, time_s);
    if (k > 200) {
      for (std::size_t f = 0; f < 2; ++f) {
        CHECK(hand.fingers()[f].waves == fresh.fingers()[f].waves);
        CHECK(hand.fingers()[f].deviation == Approx(fresh.fingers()[f].deviation).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("long runs: after lost contact an object's motion begins anew", "[long_run]") {
  Any any;
  ObjectMotion<> motion(6, 6), fresh(6, 6);
  const test::Image<std::uint8_t> contact(6, 6, 1), none(6, 6, 0);
  double shift_mm = 0;
  bool sound = true;
  for (long k = 0; k < frames(); ++k) {
    shift_mm = any.once_in(100) ? 0 : shift_mm + any.number(-0.05, 0.06);
    const auto r = motion(dots_in_space(any, shift_mm), any.once_in(60) ? none : contact);
    sound = sound && (!r.ok() || is_finite(r.pose.translation_mm));
  }
  CHECK(sound);
  CHECK(motion(dots_in_space(any, 0), none).status == MotionStatus::no_contact);
  for (int k = 0; k < 20; ++k) {
    const auto dots = dots_in_space(any, 0.1 * k);
    const auto a = motion(dots, contact), b = fresh(dots, contact);
    CHECK(a.status == b.status);
    REQUIRE(a.has_pose());
    CHECK(a.pose.translation_mm.x == b.pose.translation_mm.x);
    CHECK(a.pose.translation_mm.z == b.pose.translation_mm.z);
  }
}

TEST_CASE("long runs: a copy of the start forgets all slides", "[long_run]") {
  Any any;
  const GelSlide start(20, 20, lattice(any, 0), {.cell_px = 6, .min_cells = 30});
  GelSlide slide = start, fresh = start;
  double x = 10, y = 10;
  bool sound = true;
  for (long k = 0; k < frames(); ++k) {
    x = any.once_in(100) ? any.number(-9, 29) : x + any.number(-0.3, 0.3);
    y = any.once_in(100) ? any.number(-9, 29) : y + any.number(-0.3, 0.3);
    const auto cells = imprint(any, x, y);
    const auto r =
        slide(cells, pressed(cells), lattice(any, static_cast<float>(any.number(-9, 9))));
    sound = sound && is_finite(r.slide_px) && r.lost >= 0 && r.lost <= 1 && r.held() >= 0;
    if (any.once_in(3000)) {
      slide = start;
    }
  }
  CHECK(sound);
  const auto last = imprint(any, 12, 10);
  (void)slide(last, pressed(last), lattice(any, 0));  // now there is something to forget
  slide = start;
  for (int k = 0; k < 20; ++k) {
    const auto cells = imprint(any, 8 + 0.2 * k, 10);
    const auto contact = pressed(cells);
    const auto dots = lattice(any, 0);
    const auto a = slide(cells, contact, dots), b = fresh(cells, contact, dots);
    CHECK(a.status == b.status);
    CHECK(a.evidence == b.evidence);
    CHECK(a.slide_px.x == b.slide_px.x);
  }
}
