// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratios against 50 digits, derivatives, angles at the cut, and poorly determined motions.
#include "fingerpad/slip/stick_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/slipping_dots.hpp"

namespace test {

template <class Real>
Dual<Real> atan2(const Dual<Real>& y, const Dual<Real>& x) {
  using std::atan2;
  return {Real(atan2(y.v, x.v)), Real((x.v * y.d - y.v * x.d) / (x.v * x.v + y.v * y.v))};
}

template <class Real>
Dual<Real>& operator+=(Dual<Real>& a, const Dual<Real>& b) {
  return a = a + b;
}

}  // namespace test

using namespace fingerpad;
using test::ContactFlags;
using test::Digits50;
using test::DotStates;
using test::PointsPx;
using test::SlippingDots;
using test::SlippingPattern;

namespace {

constexpr double pi = std::numbers::pi;

/// In any number.
template <class Motion_, class Denoising_>
struct Of {
  using Motion = Motion_;
  template <class S>
  using Ratio = StickRatio<Motion_, UpdatedReference, Denoising_, S>;
  template <class S>
  static Ratio<S> ratio(Index rows, Index cols, const StickTest& test = {}) {
    return Ratio<S>(rows, cols, test, Motion_(), {.capacity = 4});
  }
};
using Default = Of<StickConsensus<>, ResidualMean>;

/// Frames with positions that float holds exactly.
std::vector<PointsPx> frames(std::uint64_t seed, const SlippingPattern& pattern) {
  SlippingDots truth(pattern);
  test::Random random(seed);
  std::vector<PointsPx> out;
  for (int k = 0; k < 6; ++k) {
    out.push_back(noisy(truth.dots, 0.1, random));
    for (auto& p : out.back().cells) {
      p = {static_cast<double>(static_cast<float>(p.x)),
           static_cast<double>(static_cast<float>(p.y))};
    }
    truth.step({.shift_px = 2.5,
                .direction_rad = random.uniform(-3, 3),
                .turn_rad = random.uniform(-0.03, 0.03),
                .zoom = random.uniform(0.98, 1.02),
                .stick_share = random.uniform(0.4, 0.9)});
  }
  return out;
}

template <class S>
struct Answers {
  std::vector<StickRatioResult<S>> results;
  std::vector<DotStates> states;
};

template <class Policies, class S>
Answers<S> follow(const std::vector<PointsPx>& recording,
                  const ContactFlags& contact,
                  const StickTest& test = {}) {
  const auto ratio = Policies::template ratio<S>(contact.rows(), contact.cols(), test);
  auto state = ratio.start();
  Answers<S> answers;
  DotStates states(contact.rows(), contact.cols());
  for (const PointsPx& dots : recording) {
    answers.results.push_back(ratio(dots, contact, states, state));
    answers.states.push_back(states);
  }
  return answers;
}

template <class S>
double off(const S& a, const Digits50& b) {
  return std::abs(static_cast<double>(Digits50(Digits50(a) - b)));
}

/// One frame after another.
template <class Policies, class S = double>
StickRatioResult<S> between(const PointsPx& before,
                            const PointsPx& after,
                            const ContactFlags& contact,
                            const StickTest& test = {}) {
  return follow<Policies, S>({before, after}, contact, test).results.back();
}

}  // namespace

TEMPLATE_TEST_CASE("stick ratios follow 50 digits", "[stick_ratio]", Default) {
  // Dots that are not within rounding of the threshold have the same state. Positions of some
  // hundred px have an error of 3e-5 px in float; the threshold is at least 0.2 px.
  const SlippingPattern pattern{.rows = 11, .cols = 11, .contact_pitches = 5.2};
  const ContactFlags contact = SlippingDots(pattern).contact;
  int updated = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto recording = frames(seed, pattern);
    const auto exact = follow<TestType, Digits50>(recording, contact);
    StickTest lower, upper;
    lower.slip *= 1 - 1e-3;
    upper.slip *= 1 + 1e-3;
    const auto low = follow<TestType, double>(recording, contact, lower);
    const auto high = follow<TestType, double>(recording, contact, upper);
    const auto in_float = follow<TestType, float>(recording, contact);
    const auto in_double = follow<TestType, double>(recording, contact);
    for (std::size_t k = 0; k < recording.size(); ++k) {
      const auto& e = exact.results[k];
      REQUIRE(in_double.results[k].status == e.status);
      REQUIRE(in_float.results[k].status == e.status);
      if (!e.updated()) {
        continue;
      }
      ++updated;
      CHECK(in_double.states[k].cells == exact.states[k].cells);
      CHECK(off(in_double.results[k].angle_rad, e.angle_rad) < 1e-13);
      CHECK(off(in_double.results[k].scale, e.scale) < 1e-13);
      CHECK(off(in_double.results[k].furthest_px, e.furthest_px) < 1e-12);
      CHECK(in_double.results[k].stick_ratio == Approx(static_cast<double>(e.stick_ratio)));
      if (low.states[k].cells == high.states[k].cells) {
        CHECK(in_float.states[k].cells == exact.states[k].cells);
        CHECK(off(in_float.results[k].angle_rad, e.angle_rad) < 2e-6);
        CHECK(off(in_float.results[k].scale, e.scale) < 2e-6);
        CHECK(off(in_float.results[k].furthest_px, e.furthest_px) < 1e-4);
      }
    }
  }
  CHECK(updated > 40);
}

TEST_CASE("stick ratios by another formula: what sticks is what one similarity fits",
          "[stick_ratio]") {
  // The same code in more digits is no independent reference. This is one: dots as complex numbers,
  // then = a now + b, by least squares over the sticking dots; and the number of dots that it fits
  // to within delta is the same.
  using Complex = std::complex<double>;
  const SlippingPattern pattern{.rows = 11, .cols = 11, .contact_pitches = 5.2};
  const ContactFlags contact = SlippingDots(pattern).contact;
  int updated = 0, other_dots = 0;
  double worst_angle = 0, worst_scale = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto recording = frames(seed, pattern);
    const auto found = follow<Of<StickConsensus<>, NoDenoising>, double>(recording, contact);
    for (std::size_t k = 0; k < recording.size(); ++k) {
      const auto& r = found.results[k];
      if (!r.updated()) {
        continue;
      }
      ++updated;
      const PointsPx& then = recording[k - static_cast<std::size_t>(r.reference_age)];
      const auto at = [](const PointsPx& dots, std::size_t c) {
        return Complex(dots.cells[c].x, dots.cells[c].y);
      };
      Complex now_sum, then_sum;
      double count = 0, furthest = 0;
      for (std::size_t c = 0; c < contact.cells.size(); ++c) {
        if (contact.cells[c] != 0) {
          furthest = (std::max)(furthest, std::abs(at(recording[k], c) - at(then, c)));
        }
        if (found.states[k].cells[c] == DotState::stick) {
          now_sum += at(recording[k], c);
          then_sum += at(then, c);
          count += 1;
        }
      }
      Complex both;
      double spread = 0;
      for (std::size_t c = 0; c < contact.cells.size(); ++c) {
        if (found.states[k].cells[c] == DotState::stick) {
          const Complex n = at(recording[k], c) - now_sum / count;
          both += std::conj(n) * (at(then, c) - then_sum / count);
          spread += std::norm(n);
        }
      }
      const Complex a = both / spread;
      worst_angle = (std::max)(worst_angle, std::abs(-std::arg(a) - r.angle_rad));
      worst_scale = (std::max)(worst_scale, std::abs(std::abs(a) - r.scale));
      const double delta = 0.24 * furthest / 2;
      int fits = 0;
      for (std::size_t c = 0; c < contact.cells.size(); ++c) {
        const Complex left =
            a * (at(recording[k], c) - now_sum / count) - (at(then, c) - then_sum / count);
        fits += contact.cells[c] != 0 && std::abs(left) < delta ? 1 : 0;
      }
      other_dots += std::abs(fits - static_cast<int>(count));
      CHECK(r.furthest_px == Approx(furthest));
    }
  }
  INFO(updated << " answers; angle " << worst_angle << ", scale " << worst_scale << ", dots "
               << other_dots);
  CHECK(updated > 40);
  CHECK(worst_angle < 2e-3);
  CHECK(worst_scale < 2e-3);
  CHECK(other_dots <= updated / 10);
}

TEMPLATE_TEST_CASE("derivatives of the object's motion are those of differences",
                   "[stick_ratio]",
                   Default) {
  const SlippingPattern pattern{.rows = 9, .cols = 9, .contact_pitches = 4.2};
  const ContactFlags contact = SlippingDots(pattern).contact;
  SlippingDots truth(pattern);
  const PointsPx before = truth.dots;
  test::Random random(4);
  truth.step({.shift_px = 3, .turn_rad = 0.03, .zoom = 1.01, .stick_share = 0.8});
  const PointsPx after = noisy(truth.dots, 0.02, random);
  const auto motion = [&]<class S>(const S& x, bool scale, Index row, Index col) {
    const auto ratio = TestType::template ratio<S>(9, 9);
    auto state = ratio.start();
    DotStates states(9, 9);
    const auto dots = [&](const PointsPx& from, const S& add) {
      return [&from, &add, row, col](Index i, Index j) {
        const bool here = i == row && j == col;
        return std::array<S, 2>{S(S(from(i, j).x) + (here ? add : S(0))), S(from(i, j).y)};
      };
    };
    const S none(0);
    (void)ratio(LazyView(9, 9, dots(before, none)), contact, states, state);
    const auto r = ratio(LazyView(9, 9, dots(after, x)), contact, states, state);
    REQUIRE(r.updated());
    return scale ? r.scale : r.angle_rad;
  };
  using Dual = test::Dual<Digits50>;
  for (const bool scale : {false, true}) {
    double largest = 0;
    for (const auto& [row, col] : {std::pair<Index, Index>{4, 5}, {3, 4}, {5, 5}, {2, 6}}) {
      const Digits50 dual = motion(Dual(Digits50(0), Digits50(1)), scale, row, col).d;
      const Digits50 step("1e-12");
      const Digits50 slope =
          (motion(step, scale, row, col) - motion(Digits50(-step), scale, row, col)) / (2 * step);
      CHECK(off(dual, slope) < 1e-20);
      largest = std::max(largest, std::abs(static_cast<double>(slope)));
    }
    CHECK(largest > 1e-5);
  }
}

TEMPLATE_TEST_CASE("angles near half a turn do not wrap", "[stick_ratio]", Default) {
  const SlippingPattern pattern{.rows = 11, .cols = 11, .contact_pitches = 5.2};
  for (const double angle : {pi - 1e-6, pi - 0.01, -pi + 1e-6, -pi + 0.01, 3.0, -3.0, pi / 2}) {
    SlippingDots truth(pattern);
    const PointsPx before = truth.dots;
    truth.step({.shift_px = 3, .direction_rad = 1, .turn_rad = angle});
    const auto r = between<TestType>(before, truth.dots, truth.contact);
    REQUIRE(r.updated());
    CHECK(r.angle_rad == Approx(angle).margin(1e-10));
    CHECK(r.scale == Approx(1).margin(1e-3));
    CHECK(r.stick_ratio == 1);
  }
  SlippingDots truth(pattern);
  const PointsPx before = truth.dots;
  truth.step({.turn_rad = pi});
  const auto r = between<TestType>(before, truth.dots, truth.contact);
  CHECK(std::abs(r.angle_rad) == Approx(pi));
}

TEST_CASE("a plain press has its scale", "[stick_ratio]") {
  // There is no common motion.
  SlippingDots truth;
  const PointsPx before = truth.dots;
  truth.step({.zoom = 1.05});
  const auto r = between<Default>(before, truth.dots, truth.contact);
  REQUIRE(r.updated());
  CHECK(r.stick_ratio == 1);
  CHECK(r.scale == Approx(1 / 1.05).margin(2e-3));
  CHECK(std::abs(r.angle_rad) < 1e-12);
  // An implausible scale is ignored.
  SlippingDots far;
  far.step({.shift_px = 1, .zoom = 1.3});
  CHECK(between<Default>(before, far.dots, far.contact).scale == 1);
}

TEMPLATE_TEST_CASE("dots on a line, and displacements that are all parallel",
                   "[stick_ratio]",
                   Default) {
  for (const bool upright : {false, true}) {
    const Index rows = upright ? 15 : 1, cols = upright ? 1 : 15;
    const SlippingPattern pattern{.rows = rows, .cols = cols, .contact_pitches = 20};
    for (const double direction : {0.0, pi / 4, pi / 2}) {
      for (const double turn : {0.0, 0.04}) {
        SlippingDots truth(pattern);
        const PointsPx before = truth.dots;
        truth.step({.shift_px = 4, .direction_rad = direction, .turn_rad = turn});
        const auto r = between<TestType>(before, truth.dots, truth.contact);
        CAPTURE(upright, direction, turn);
        REQUIRE(r.updated());
        CHECK(r.stick_ratio == 1);
        CHECK(r.angle_rad == Approx(turn).margin(1e-12));
        CHECK(r.scale == Approx(1).margin(1e-3));
      }
    }
  }
  // a field shifted as a whole: only the part across the motion determines the scale
  for (const double direction : {0.0, pi / 4, pi / 2, 1.0}) {
    SlippingDots truth;
    const PointsPx before = truth.dots;
    truth.step({.shift_px = 8, .direction_rad = direction});
    const auto r = between<TestType>(before, truth.dots, truth.contact);
    REQUIRE(r.updated());
    CHECK(r.stick_ratio == 1);
    CHECK(r.scale == Approx(1).margin(1e-12));
  }
}
