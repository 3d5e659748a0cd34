// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Features and a rule in one object: the same results as calling them in sequence, and refused
// samples.
#include "fingerpad/pipeline/foam_hand.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/foam_signals.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double period_s = 0.01;

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

TaxelOptions options() {
  return {.sample_period_s = period_s, .noise = 4};
}

template <class S = double>
FoamHand<S> two_fingers(std::span<const S> noise = {}) {
  const TaxelFeatures<S> finger(16, 4, options(), noise);
  return FoamHand<S>({finger, finger});
}

/// Status of 200 samples of two fingers.
template <class Hand>
std::vector<PreslipStatus> run(Hand& hand) {
  test::FoamSignal signal(slipping(), 1);
  std::vector<PreslipStatus> felt;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    felt.push_back(hand(std::array{signal.finger(0, time_s), signal.finger(1, time_s)}, time_s));
  }
  return felt;
}

}  // namespace

TEST_CASE("foam hand: what features and rules say by themselves", "[foam_hand]") {
  const bool lifts = GENERATE(true, false);
  const PreslipRule rule = lifts ? PreslipRule::grasp_lift : PreslipRule::grasp_optimise;
  TaxelFeatures<> left(16, 4, options()), right = left;
  FoamHand<> hand({left, right}, {.rule = rule});
  Preslip<> preslip(2, {.rule = rule});
  test::FoamSignal signal(slipping(), 1);
  int preslips = 0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    const std::array readings{signal.finger(0, time_s), signal.finger(1, time_s)};
    const PreslipStatus status = hand(readings, time_s);
    const std::array fingers{left(readings[0], time_s), right(readings[1], time_s)};
    CHECK(hand.fingers().size() == 2);
    CHECK(hand.fingers()[1].location == fingers[1].location);
    CHECK(test::same_bits(hand.fingers()[0].center_x_mm, fingers[0].center_x_mm));
    CHECK(status == preslip(fingers));
    CHECK((status == PreslipStatus::cannot_tell) == (k < 15));
    CHECK((k >= 80 || status != PreslipStatus::preslip));
    preslips += status == PreslipStatus::preslip ? 1 : 0;
  }
  CHECK(preslips > 0);
}

TEST_CASE("foam hand: a sample that a finger refuses is none for the rule", "[foam_hand]") {
  FoamHand<> hand = two_fingers();
  (void)run(hand);
  const Image<double> good(16, 4, 100), other(4, 16, 100);
  for (const double time_s : {1.99, test::nan}) {
    CHECK(hand(std::array{good, good}, time_s) == PreslipStatus::cannot_tell);
    CHECK(hand.fingers()[1].status == TaxelStatus::refused);
  }
  CHECK(hand(std::array{good, other}, 2.0) == PreslipStatus::cannot_tell);
  CHECK(hand.fingers()[1].status == TaxelStatus::refused);
  CHECK(hand(std::array{good}, 3.0) == PreslipStatus::cannot_tell);
}

TEST_CASE("foam hand: forgets, and can be copied", "[foam_hand]") {
  FoamHand<> hand = two_fingers();
  const auto first = run(hand);
  hand.reset();
  auto copy = hand;
  CHECK(run(hand) == first);
  CHECK(run(copy) == first);
}

TEST_CASE("foam hand: in float, and with a noise for each taxel", "[foam_hand]") {
  const std::vector<double> noise(64, 4.0);
  FoamHand<float> in_float = two_fingers<float>();
  FoamHand<> in_double = two_fingers(), with_noise = two_fingers<double>(noise);
  const auto felt = run(in_double);
  CHECK(run(in_float) == felt);
  CHECK(run(with_noise) == felt);
}

TEST_CASE("foam hand: a finger of two halves is the whole finger", "[foam_hand]") {
  FoamHand<> whole = two_fingers();
  // the lower half first
  std::vector<Point2<double>> places;
  for (const Index row : {8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7}) {
    for (Index col = 0; col < 4; ++col) {
      places.push_back({3.4 * static_cast<double>(col), 3.4 * static_cast<double>(row)});
    }
  }
  const TaxelFeatures<> finger(64, 1, options(), {}, places);
  FoamHand<> halves({finger, finger});
  test::FoamSignal signal(slipping(), 1);
  int preslips = 0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    const std::array readings{signal.finger(0, time_s), signal.finger(1, time_s)};
    const auto joined = [&](std::size_t f) {
      return LazyView(
          64, 1, [&grid = readings[f]](Index i, Index) { return grid((i / 4 + 8) % 16, i % 4); });
    };
    const PreslipStatus status = whole(readings, time_s);
    CHECK(halves(std::vector{joined(0), joined(1)}, time_s) == status);
    for (std::size_t f = 0; f < 2; ++f) {
      const FingerSample<>&a = whole.fingers()[f], &b = halves.fingers()[f];
      CHECK(a.status == b.status);
      CHECK(a.location == (b.location < 0 ? b.location : (b.location + 32) % 64));
      CHECK(a.vibration_count == b.vibration_count);
      CHECK(a.center_x_mm == Approx(b.center_x_mm).epsilon(1e-12));
      CHECK(a.center_y_mm == Approx(b.center_y_mm).epsilon(1e-12));
      CHECK(a.sum == Approx(b.sum).epsilon(1e-12));
    }
    preslips += status == PreslipStatus::preslip ? 1 : 0;
  }
  CHECK(preslips > 0);
}

TEST_CASE("foam hand: the paper's finger of 204 elements, of which one side is touched",
          "[foam_hand]") {
  // 16 x 4 twice, 16 x 2 twice and 6 x 2
  const TaxelFeatures<> finger(204, 1, options());
  FoamHand<> hand({finger, finger});
  test::FoamSignal signal(slipping(), 1);
  int preslips = 0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = k * period_s;
    std::array<std::vector<double>, 2> readings{std::vector<double>(204, 0.0),
                                                std::vector<double>(204, 0.0)};
    for (std::size_t f = 0; f < 2; ++f) {  // the first side of one finger, the second of the other
      const Image<double> side = signal.finger(f, time_s);
      std::copy(side.cells.begin(), side.cells.end(),
                readings[f].begin() + 64 * static_cast<std::ptrdiff_t>(f));
    }
    const Index right = k == 150 ? 203 : 204;
    const PreslipStatus status =
        hand(std::array{grid_of(readings[0], 204, 1), grid_of(readings[1], right, 1)}, time_s);
    CHECK((status == PreslipStatus::cannot_tell) == (k < 15 || k == 150));
    preslips += status == PreslipStatus::preslip ? 1 : 0;
  }
  CHECK(hand.fingers()[0].location < 64);
  CHECK(hand.fingers()[1].location >= 64);
  CHECK(hand.fingers()[1].location < 128);
  CHECK(hand.fingers()[0].left_out == 0);
  CHECK(preslips > 0);
}

TEST_CASE("foam hand: bad parameters are refused by name", "[foam_hand]") {
  const TaxelFeatures<> finger(16, 4);
  CHECK(test::refusal([&] { FoamHand<>({finger}); }) == "accepted");
  CHECK(test::refusal([&] { FoamHand<>({}); }) == "Preslip: fingers = 0, must be in [1, 100]");
  CHECK(test::refusal([&] { FoamHand<>({finger}, {.history = 1}); }) ==
        "PreslipOptions: history = 1, must be in [2, 100000]");
}

TEST_CASE("foam hand: a sample allocates nothing", "[foam_hand]") {
  const TaxelFeatures<> finger(4, 3);
  FoamHand<> hand({finger, finger, finger}, {.rule = PreslipRule::grasp_optimise});
  test::Image<double> taxels(4, 3, 100);
  int preslips = 0;
  const long before = test::allocations();
  for (int k = 0; k < 100; ++k) {
    taxels(k > 50 ? 1 : 3, 2) = k > 30 && k % 4 < 2 ? 200 : 100;
    taxels(0, 1) = 100 + k;
    const auto view = as_view(taxels);
    const PreslipStatus status = hand(std::array{view, view, view}, k / 30.0);
    preslips += status == PreslipStatus::preslip ? 1 : 0;
  }
  hand.reset();
  CHECK(test::allocations() == before);
  CHECK(preslips > 0);
}
