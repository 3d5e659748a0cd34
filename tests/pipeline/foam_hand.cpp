// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Features and rules in one object: the same results as calling them in sequence, disabled rules,
// and refused samples.
#include "fingerpad/pipeline/foam_hand.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/foam_signals.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double period_s = 0.01;

struct BothRules : FoamHandMethods {
  static constexpr bool has_grasp_optimise = true;
};
struct NoRules : FoamHandMethods {
  static constexpr bool has_grasp_lift = false;
};
struct TwoHalves : BothRules {
  static constexpr std::size_t arrays = 2;
};
struct FiveSides : FoamHandMethods {
  static constexpr std::size_t arrays = 5;
};
struct InFloat : BothRules {
  using Scalar = float;
};

/// Both fingers begin to slip at 0.8 s.
test::FoamScene slipping() {
  test::FoamScene scene;
  for (auto& finger : scene.patches) {
    for (const Index row : {2, 8}) {
      finger.push_back({.row = row, .col = 1, .begin_s = 0.8, .frequency_hz = 14});
    }
  }
  return scene;
}

template <class S = double>
FoamHandOptions<2, S> options() {
  FoamHandOptions<2, S> o;
  o.arrays = {FoamArray{16, 4}, FoamArray{16, 4}};
  o.taxels.sample_period_s = S(period_s);
  o.taxels.noise = S(4);
  return o;
}

/// Results of 200 samples of two fingers.
template <class Hand>
auto run(Hand& hand) {
  test::FoamSignal signal(slipping(), 1);
  std::vector<typename Hand::Result> felt;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    const std::array readings{signal.finger(0, time_s), signal.finger(1, time_s)};
    felt.push_back(hand(readings, time_s));
  }
  return felt;
}

bool same(const PreslipResult& a, const PreslipResult& b) {
  return a.status == b.status && a.alarm == b.alarm && a.is_fresh == b.is_fresh &&
         a.samples_ago == b.samples_ago;
}

}  // namespace

TEST_CASE("foam hand: what features and rules say by themselves", "[foam_hand]") {
  FoamHand<2, BothRules> hand(options());
  const auto felt = run(hand);
  const TaxelFeatures<> features(16, 4, options().taxels);
  const Preslip<GraspLift> lift;
  const Preslip<GraspOptimise> optimise;
  std::array windows{features.start(), features.start()};
  auto of_lift = lift.start();
  auto of_optimise = optimise.start();
  test::FoamSignal signal(slipping(), 1);
  int preslips = 0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    std::array<FingerSample<>, 2> fingers;
    for (std::size_t f = 0; f < 2; ++f) {
      fingers[f] = features(signal.finger(f, time_s), time_s, windows[f]);
    }
    const auto& now = felt[static_cast<std::size_t>(k)];
    CHECK(now.fingers[1].location == fingers[1].location);
    CHECK(test::same_bits(now.fingers[0].center_x_mm, fingers[0].center_x_mm));
    const PreslipResult by_lift = lift(fingers, of_lift),
                        by_optimise = optimise(fingers, of_optimise);
    CHECK(same(now.grasp_lift, by_lift));
    CHECK(same(now.grasp_optimise, by_optimise));
    const bool is_preslip = by_lift.is_fresh || by_optimise.is_fresh;
    CHECK((now.status == PreslipStatus::preslip) == is_preslip);
    CHECK((now.status == PreslipStatus::cannot_tell) == (k < 15));
    CHECK(now.ok() == (k >= 15));
    CHECK((k >= 80 || !is_preslip));
    preslips += is_preslip ? 1 : 0;
  }
  CHECK(preslips > 0);
}

TEST_CASE("foam hand: a rule that is off says nothing and changes nothing", "[foam_hand]") {
  FoamHand<2, BothRules> both(options());
  FoamHand<2> lift(options());
  FoamHand<2, NoRules> none(options());
  const auto of_both = run(both);
  const auto of_lift = run(lift);
  const auto of_none = run(none);
  for (std::size_t k = 0; k < of_both.size(); ++k) {
    CHECK(same(of_lift[k].grasp_lift, of_both[k].grasp_lift));
    CHECK(same(of_lift[k].grasp_optimise, PreslipResult{}));
    CHECK(of_none[k].fingers[0].location == of_both[k].fingers[0].location);
    CHECK(same(of_none[k].grasp_lift, PreslipResult{}));
    CHECK(of_none[k].status == PreslipStatus::cannot_tell);
  }
  CHECK(sizeof(none) < sizeof(lift));
  CHECK(sizeof(lift) < sizeof(both));
}

TEST_CASE("foam hand: a sample that a finger refuses is none for the rules", "[foam_hand]") {
  FoamHand<2> hand(options());
  const auto before = run(hand);
  const auto nothing_done = [&](const auto& readings, double time_s, TaxelStatus why) {
    const auto felt = hand(readings, time_s);
    CHECK(felt.status == PreslipStatus::cannot_tell);
    CHECK_FALSE(felt.ok());
    CHECK(felt.fingers[1].status == why);
    CHECK_FALSE(felt.grasp_lift.alarm);
  };
  const Image<double> good(16, 4, 100), other(4, 16, 100);
  nothing_done(std::array{good, good}, 1.99, TaxelStatus::time_not_later);
  nothing_done(std::array{good, good}, test::nan, TaxelStatus::time_not_later);
  nothing_done(std::array{good, other}, 2.0, TaxelStatus::other_size);
}

TEST_CASE("foam hand: forgets, and can be copied", "[foam_hand]") {
  FoamHand<2> hand(options());
  const auto first = run(hand);
  hand.reset();
  auto copy = hand;
  const auto again = run(hand);
  const auto of_copy = run(copy);
  for (std::size_t k = 0; k < first.size(); ++k) {
    CHECK(same(first[k].grasp_lift, again[k].grasp_lift));
    CHECK(same(first[k].grasp_lift, of_copy[k].grasp_lift));
  }
}

TEST_CASE("foam hand: in float, and with a noise for each taxel", "[foam_hand]") {
  FoamHand<2, InFloat> in_float(options<float>());
  FoamHand<2, BothRules> in_double(options());
  const Image<double> noise(16, 4, 4.0);
  auto each = options();
  each.arrays[0].noise = as_view(noise);
  FoamHand<2, BothRules> with_noise(each);
  const auto a = run(in_float);
  const auto b = run(in_double);
  const auto c = run(with_noise);
  for (std::size_t k = 0; k < a.size(); ++k) {
    CHECK(same(a[k].grasp_lift, b[k].grasp_lift));
    CHECK(same(c[k].grasp_lift, b[k].grasp_lift));
  }
}

TEST_CASE("foam hand: a finger of two halves is the whole finger", "[foam_hand]") {
  FoamHand<2, BothRules> whole(options());
  FoamHandOptions<4> of_halves;
  of_halves.taxels = options().taxels;
  const double below_mm = 8 * of_halves.taxels.pitch_mm;
  of_halves.arrays = {FoamArray{8, 4}, FoamArray{8, 4, {}, {0, below_mm}}, FoamArray{8, 4},
                      FoamArray{8, 4, {}, {0, below_mm}}};
  FoamHand<2, TwoHalves> halves(of_halves);
  test::FoamSignal signal(slipping(), 1);
  int preslips = 0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    const std::array readings{signal.finger(0, time_s), signal.finger(1, time_s)};
    const auto half = [&](std::size_t f, Index first) {
      return StridedView<const double>(&readings[f](first, 0), 8, 4, 4);
    };
    const auto a = whole(readings, time_s);
    const auto b = halves(std::array{half(0, 0), half(0, 8), half(1, 0), half(1, 8)}, time_s);
    CHECK(a.status == b.status);
    CHECK(same(a.grasp_lift, b.grasp_lift));
    CHECK(same(a.grasp_optimise, b.grasp_optimise));
    for (std::size_t f = 0; f < 2; ++f) {
      CHECK(a.fingers[f].status == b.fingers[f].status);
      CHECK(a.fingers[f].location == b.fingers[f].location);
      CHECK(a.fingers[f].vibration_count == b.fingers[f].vibration_count);
      CHECK(a.fingers[f].center_x_mm == Approx(b.fingers[f].center_x_mm).epsilon(1e-12));
      CHECK(a.fingers[f].center_y_mm == Approx(b.fingers[f].center_y_mm).epsilon(1e-12));
      CHECK(a.fingers[f].sum == Approx(b.fingers[f].sum).epsilon(1e-12));
      CHECK(whole.vibrating(f).size() ==
            halves.vibrating(2 * f).size() + halves.vibrating(2 * f + 1).size());
    }
    preslips += b.status == PreslipStatus::preslip ? 1 : 0;
  }
  CHECK(preslips > 0);
}

TEST_CASE("foam hand: the paper's finger of 204 elements, of which one side is touched",
          "[foam_hand]") {
  FoamHandOptions<10> o;
  o.taxels = options().taxels;
  for (std::size_t f = 0; f < 2; ++f) {
    const FoamArray sides[] = {{16, 4}, {16, 4}, {16, 2}, {16, 2}, {6, 2}};
    std::copy(std::begin(sides), std::end(sides), o.arrays.begin() + std::ptrdiff_t(5 * f));
  }
  FoamHand<2, FiveSides> hand(o);
  test::FoamSignal signal(slipping(), 1);
  const Image<double> plan(16, 4, 0.0), edge(16, 2, 0.0), tip(6, 2, 0.0), other(2, 6, 0.0);
  int preslips = 0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    const Image<double> left = signal.finger(0, time_s), right = signal.finger(1, time_s);
    const auto felt = hand(std::array{as_view(left), as_view(plan), as_view(edge), as_view(edge),
                                      as_view(tip), as_view(plan), as_view(right), as_view(edge),
                                      as_view(edge), as_view(k == 150 ? other : tip)},
                           time_s);
    CHECK((felt.status == PreslipStatus::cannot_tell) == (k < 15 || k == 150));
    preslips += felt.status == PreslipStatus::preslip ? 1 : 0;
    if (k == 199) {
      CHECK(felt.fingers[0].location < 64);
      CHECK(felt.fingers[1].location >= 64);
      CHECK(felt.fingers[1].location < 128);
      CHECK(felt.fingers[0].frozen == 64 + 32 + 32 + 12);
    }
  }
  CHECK(preslips > 0);
}

TEST_CASE("foam hand: bad parameters are refused by name", "[foam_hand]") {
  const auto said = [](auto change) {
    auto o = options();
    change(o);
    return test::refusal([&] { FoamHand<2>{o}; });
  };
  const Image<double> noise(4, 16, 4.0);
  CHECK(said([](auto&) {}) == "accepted");
  CHECK(said([](auto& o) { o.arrays[1].rows = 0; }) ==
        "TaxelFeatures: rows = 0, must be in [1, 4096]");
  CHECK(said([&](auto& o) { o.arrays[1].noise = as_view(noise); }) ==
        "FoamArray: noise.rows() = 4, must be 0, or noise as large as the array");
  CHECK(said([](auto& o) { o.taxels.window = 3; }) ==
        "TaxelOptions: window = 3, must be in [4, 4096]");
  CHECK(said([](auto& o) { o.rules.history = 1; }) ==
        "PreslipOptions: history = 1, must be in [2, 100000]");
}
