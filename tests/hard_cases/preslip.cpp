// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Histories that are hard for the search, and numbers at the ends of their range.
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;

namespace {

using Options = PreslipOptions;
template <std::size_t Fingers, class S = double>
using Hand = std::array<FingerSample<S>, Fingers>;
constexpr double largest = (std::numeric_limits<double>::max)();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

template <class S = double>
FingerSample<S> felt(Index location, Index waves, double x_mm = 0, double y_mm = 0) {
  FingerSample<S> sample;
  sample.status = TaxelStatus::vibrating;
  if (location >= 0) {
    sample.add_vibration(location, waves);
  }
  sample.location = location;
  sample.waves = waves;
  sample.center_x_mm = S(x_mm);
  sample.center_y_mm = S(y_mm);
  return sample;
}

template <class Fingers>
bool holds(PreslipRule rule, const Fingers& older, const Fingers& later, Options options = {}) {
  options.rule = rule;
  return is_preslip(older, later, options);
}

/// The number of samples with an alarm. Sample k is hand(k).
template <class Make>
int alarms(int samples, Index history, const Make& hand, PreslipRule rule) {
  Preslip<> preslip(2, {.rule = rule, .history = history});
  int count = 0;
  for (int k = 0; k < samples; ++k) {
    count += preslip(hand(k)) == PreslipStatus::preslip ? 1 : 0;
  }
  return count;
}

class Bits {
 public:
  explicit Bits(std::uint64_t seed) : bits_(seed) {}
  Index operator()(Index low, Index high) {
    return low + static_cast<Index>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace

TEST_CASE("pre-slip: a hundred thousand samples alike", "[preslip]") {
  constexpr int samples = 100000;
  const PreslipRule optimise = PreslipRule::printed_grasp_optimise;
  const auto alike = [](int) { return Hand<2>{felt(3, 5), felt(4, 5)}; };
  CHECK(alarms(samples, 50, alike, optimise) == 0);
  CHECK(alarms(samples, 50, alike, PreslipRule::printed_grasp_lift) == 0);
  // two alternating places: from the second sample on, each makes a pair with the previous one
  const auto in_turn = [](int k) { return Hand<2>{felt(k % 2, 5), felt(1 - k % 2, 5)}; };
  CHECK(alarms(samples, 50, in_turn, optimise) == samples - 1);
  // a wave every 60 samples, each at another place: the history never holds two of them
  const auto seldom = [](int k) {
    const Index location = k % 60 == 0 ? k / 60 % 7 : FingerSample<>::no_location;
    return Hand<2>{felt(location, 5), felt(location, 5)};
  };
  CHECK(alarms(samples, 50, seldom, optimise) == 0);
  // now it does: each meets the previous one for one sample
  CHECK(alarms(samples, 61, seldom, optimise) == (samples - 1) / 60);
}

TEST_CASE("pre-slip: centroids at the ends of their range", "[preslip]") {
  const auto lift = [](double a_mm, double b_mm, double tolerance_mm) {
    const Options options{.centroid_tolerance_mm = tolerance_mm};
    return holds(PreslipRule::printed_grasp_lift, Hand<1>{felt(1, 1, a_mm, 0)},
                 Hand<1>{felt(2, 2, b_mm, 0)}, options);
  };
  CHECK(lift(largest, -largest, 1));        // their difference is infinite
  CHECK(lift(-largest, largest, largest));  // and beyond any tolerance
  CHECK_FALSE(lift(largest, largest, 0));
  CHECK(lift(5e-324, 0, 0));
  CHECK_FALSE(lift(5e-324, 0, 5e-324));
  CHECK_FALSE(lift(infinity, 0, 1));  // not a centroid
  CHECK_FALSE(lift(0, -infinity, 1));
  CHECK_FALSE(lift(infinity, -infinity, 1));
  CHECK_FALSE(lift(none, 0, 0));
}

TEST_CASE("pre-slip: the newest sample is compared with all others at the ends of the range",
          "[preslip]") {
  const double ends[] = {0,    -0.0,     5e-324, -5e-324,     1e-300,  0.05,  -0.05,     0.0500001,
                         0.15, 1e8,      -1e8,   1e8 + 0.049, 1e8 - 1, 1e300, -largest,  largest,
                         none, infinity, 1,      -infinity,   1e9,     -1e9,  123456.75, 5e7};
  const Index far[] = {(std::numeric_limits<Index>::min)(), -2, -1, 0, 1, 2, 63, 64, 65, 70,
                       (std::numeric_limits<Index>::max)()};
  for (const double tolerance_mm : {5e-324, 1e-300, 0.1, 1.0, 1e300, largest}) {
    for (const PreslipRule rule :
         {PreslipRule::printed_grasp_lift, PreslipRule::printed_grasp_optimise}) {
      CAPTURE(tolerance_mm, name_of(rule));
      const Options options{.rule = rule, .history = 9, .centroid_tolerance_mm = tolerance_mm};
      Preslip<> preslip(2, options);
      Bits bits(11);
      std::vector<Hand<2>> history;
      int differ = 0;
      for (int k = 0; k < 2000; ++k) {
        Hand<2> now;
        for (auto& sample : now) {
          sample = felt(far[bits(0, 10)], far[bits(0, 10)], ends[bits(0, 23)], ends[bits(0, 23)]);
        }
        bool pairs = false;
        for (std::size_t ago = 1; ago < 9 && ago <= history.size(); ++ago) {
          pairs = pairs || is_preslip(history[history.size() - ago], now, options);
        }
        differ += (preslip(now) == PreslipStatus::preslip) == pairs ? 0 : 1;
        history.push_back(now);
      }
      CHECK(differ == 0);
    }
  }
}

TEMPLATE_TEST_CASE("pre-slip: the same answers in any number",
                   "[preslip]",
                   float,
                   long double,
                   test::Digits50,
                   test::Dual<double>) {
  using S = TestType;
  const auto check = [](PreslipRule rule) {
    const Options options{.rule = rule, .history = 12, .centroid_tolerance_mm = 0.125};
    Preslip<S> preslip(2, options);
    Preslip<> reference(2, options);
    Bits bits(5);
    int alarms = 0, differ = 0;
    Hand<2, S> last;
    Hand<2> reference_last;
    for (int k = 0; k < 400; ++k) {
      Hand<2, S> now;
      Hand<2> reference_now;
      for (std::size_t f = 0; f < 2; ++f) {
        const Index location = bits(-1, 2), waves = bits(0, 3);
        const double x = bits(0, 9) == 0 ? none : static_cast<double>(bits(-3, 3)) / 16;
        const double y = static_cast<double>(bits(-3, 3)) / 16;
        now[f] = felt<S>(location, waves, x, y);
        reference_now[f] = felt(location, waves, x, y);
      }
      const PreslipStatus status = reference(reference_now);
      differ += preslip(now) == status ? 0 : 1;
      differ += is_preslip(last, now, options) == is_preslip(reference_last, reference_now, options)
                    ? 0
                    : 1;
      alarms += status == PreslipStatus::preslip ? 1 : 0;
      last = now;
      reference_last = reference_now;
    }
    CHECK(differ == 0);
    CHECK(alarms > 10);
    CHECK(alarms < 400);
  };
  check(PreslipRule::printed_grasp_optimise);
  check(PreslipRule::printed_grasp_lift);
}

TEST_CASE("pre-slip: a derivative that is not a number changes nothing", "[preslip]") {
  using S = test::Dual<double>;
  auto older = felt<S>(1, 1, 0, 0), later = felt<S>(2, 2, 1, 0);
  later.center_x_mm.d = none;
  CHECK(holds(PreslipRule::printed_grasp_lift, Hand<1, S>{older}, Hand<1, S>{later}));
}

TEST_CASE("pre-slip: a pair as old as a history", "[preslip]") {
  const auto first = felt(1, 1, 0, 0), silent = felt(FingerSample<>::no_location, 0, none, none);
  for (const Index history : {3000, 100000}) {
    for (const PreslipRule rule :
         {PreslipRule::printed_grasp_lift, PreslipRule::printed_grasp_optimise}) {
      Preslip<> preslip(1, {.rule = rule, .history = history});
      const auto last = felt(2, rule == PreslipRule::printed_grasp_optimise ? 1 : 2, 1, 1);
      for (const Index between : {history - 2, history - 1}) {
        preslip.reset();
        (void)preslip(Hand<1>{first});
        for (Index k = 0; k < between; ++k) {
          (void)preslip(Hand<1>{silent});
        }
        const PreslipStatus status = preslip(Hand<1>{last});
        CHECK((status == PreslipStatus::preslip) == (between == history - 2));
        CHECK(preslip(Hand<1>{silent}) == PreslipStatus::steady);
      }
    }
  }
}
