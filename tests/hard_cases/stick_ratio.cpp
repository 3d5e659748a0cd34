// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratios against 50 digits, angles at the cut, and poorly determined motions.
#include "fingerpad/slip/stick_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/slipping_dots.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;
using test::ContactFlags;
using test::Digits50;
using test::PointsPx;
using test::SlippingDots;
using test::SlippingPattern;

namespace {

constexpr double pi = std::numbers::pi;

template <class S>
S angle_of(const StickResult<S>& r) {
  using std::atan2;
  return S(atan2(r.motion.rotation.m[1][0], r.motion.rotation.m[0][0]));
}

/// What a recording gives, in doubles.
struct Answers {
  std::vector<StickStatus> status;
  std::vector<double> ratios, sds, angles, scales, furthest, slips;

  template <class S>
  void add(const StickRatio<S>& stick, const StickResult<S>& r) {
    status.push_back(r.status);
    if (r.updated()) {
      ratios.push_back(static_cast<double>(r.stick_ratio));
      sds.push_back(static_cast<double>(r.ratio_sd));
      angles.push_back(static_cast<double>(angle_of(r)));
      scales.push_back(static_cast<double>(r.scale));
      furthest.push_back(static_cast<double>(r.furthest));
      const Index middle = stick.rows() / 2;
      slips.push_back(static_cast<double>(stick.slips()(middle, middle + 2).x));
    }
  }
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) {
    largest = std::max(largest, std::abs(a[k] - b[k]));
  }
  return largest;
}

void check(const Answers& a, const Answers& exact, double tolerance) {
  CAPTURE(tolerance);
  CHECK(a.status == exact.status);
  CHECK(largest_difference(a.ratios, exact.ratios) < 1e-6);  // the same dots stick
  CHECK(largest_difference(a.sds, exact.sds) < 100 * tolerance);
  CHECK(largest_difference(a.angles, exact.angles) < tolerance);
  CHECK(largest_difference(a.scales, exact.scales) < tolerance);
  CHECK(largest_difference(a.furthest, exact.furthest) < 10 * tolerance);
  CHECK(largest_difference(a.slips, exact.slips) < 100 * tolerance);
}

/// Free frames, then dots in the image that are dragged, turned and enlarged while they begin to
/// slip; positions that float holds exactly.
template <class S>
Answers in_image() {
  SlippingDots truth({.rows = 11, .cols = 11, .contact_pitches = 5.2});
  test::Random random(3);
  StickRatio<S> stick(11, 11);
  Answers answers;
  for (int k = 0; k < 20; ++k) {
    auto dots = noisy(truth.dots, 0.06, random);
    for (auto& p : dots.cells) {
      p = {static_cast<double>(static_cast<float>(p.x)),
           static_cast<double>(static_cast<float>(p.y))};
    }
    answers.add(stick, stick(dots, k < 10 ? ContactFlags(11, 11, 0) : truth.contact));
    if (k >= 10) {
      truth.step({.shift_px = 2.5,
                  .direction_rad = random.uniform(-0.5, 0.5),
                  .turn_rad = random.uniform(-0.03, 0.03),
                  .zoom = random.uniform(0.98, 1.02),
                  .stick_share = random.uniform(0.4, 0.9)});
    }
  }
  return answers;
}

/// Free frames, then a patch that is rolled, dragged and rotated while it begins to slip.
template <class S>
Answers in_space() {
  StickRatio<S> stick(21, 21, {.noise = 0.005});
  test::Random random(2);
  test::SlippingPatch patch;
  Answers answers;
  for (int k = 0; k < 24; ++k) {
    const bool free = k < 10;
    const auto dots = noisy(patch.dots, 0.005, 0.025, random);
    answers.add(stick, stick(dots, free ? ContactFlags(21, 21, 0) : patch.contact));
    patch.step(free ? test::moved_by({0, 0, 0}, {0, 0, 0}, {0, 0, 0})
                    : test::moved_by({0.002, 0.003, 0.01}, {0, 0, 28}, {0.17, 0.05, 0}),
               1.2 - 0.02 * k);
  }
  return answers;
}

/// One frame after another.
StickResult<> between(const PointsPx& before, const PointsPx& after, const ContactFlags& contact) {
  StickRatio<> stick(contact.rows(), contact.cols(), {.noise = 0.06});
  (void)stick(before, contact);
  return stick(after, contact);
}

}  // namespace

TEST_CASE("stick ratios follow 50 digits", "[stick_ratio]") {
  const Answers image = in_image<Digits50>(), space = in_space<Digits50>();
  CHECK(image.ratios.size() >= 6);
  CHECK(space.ratios.size() >= 6);
  check(in_image<double>(), image, 1e-12);
  check(in_image<long double>(), image, 1e-12);
  check(in_image<float>(), image, 2e-5);
  check(in_space<double>(), space, 1e-10);
  check(in_space<float>(), space, 2e-4);
}

TEST_CASE("angles near half a turn do not wrap", "[stick_ratio]") {
  const SlippingPattern pattern{.rows = 11, .cols = 11, .contact_pitches = 5.2};
  for (const double angle : {pi - 1e-6, pi - 0.01, -pi + 1e-6, -pi + 0.01, 3.0, -3.0, pi / 2}) {
    SlippingDots truth(pattern);
    const PointsPx before = truth.dots;
    truth.step({.shift_px = 3, .direction_rad = 1, .turn_rad = angle});
    const auto r = between(before, truth.dots, truth.contact);
    REQUIRE(r.updated());
    CHECK(angle_of(r) == Approx(angle).margin(1e-10));
    CHECK(r.scale == Approx(1).margin(1e-9));
    CHECK(r.stick_ratio == 1);
  }
}

TEST_CASE("a plain press has its scale", "[stick_ratio]") {
  // There is no common motion.
  SlippingDots truth;
  const PointsPx before = truth.dots;
  truth.step({.zoom = 1.05});
  const auto r = between(before, truth.dots, truth.contact);
  REQUIRE(r.updated());
  CHECK(r.stick_ratio == 1);
  CHECK(r.scale == Approx(1.05).margin(1e-9));
  CHECK(std::abs(angle_of(r)) < 1e-12);
}

TEST_CASE("dots on a line, and displacements that are all parallel", "[stick_ratio]") {
  for (const bool upright : {false, true}) {
    const Index rows = upright ? 15 : 1, cols = upright ? 1 : 15;
    const SlippingPattern pattern{.rows = rows, .cols = cols, .contact_pitches = 20};
    for (const double direction : {0.0, pi / 4, pi / 2}) {
      for (const double turn : {0.0, 0.04}) {
        SlippingDots truth(pattern);
        const PointsPx before = truth.dots;
        truth.step({.shift_px = 4, .direction_rad = direction, .turn_rad = turn});
        const auto r = between(before, truth.dots, truth.contact);
        CAPTURE(upright, direction, turn);
        REQUIRE(r.updated());
        CHECK(r.stick_ratio == 1);
        CHECK(angle_of(r) == Approx(turn).margin(1e-12));
        CHECK(r.scale == Approx(1).margin(1e-9));
      }
    }
  }
}
