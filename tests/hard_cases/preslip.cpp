// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Histories that are hard for the search, and numbers at the ends of their range.
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/published/preslip.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;

namespace {

using Options = PreslipOptions<double>;
template <std::size_t Fingers, class S = double>
using Hand = std::array<FingerSample<S>, Fingers>;
constexpr double largest = (std::numeric_limits<double>::max)();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

template <class S = double>
FingerSample<S> felt(Index location, Index waves, double x_mm = 0, double y_mm = 0) {
  FingerSample<S> sample;
  sample.status = TaxelStatus::vibrating;
  sample.location = location;
  sample.waves = waves;
  sample.center_x_mm = S(x_mm);
  sample.center_y_mm = S(y_mm);
  return sample;
}

bool equal(const PreslipResult& a, const PreslipResult& b) {
  return a.alarm == b.alarm && a.is_fresh == b.is_fresh && a.samples_ago == b.samples_ago;
}

/// Number of samples in which both searches differ. Sample k is hand(k).
template <class Rule, std::size_t Fingers, class Make>
int differences(int samples, const Options& options, const Make& hand) {
  const Preslip<Rule, Fingers> newest(options);
  const published::StackScan<Rule, Fingers> whole(options);
  auto of_newest = newest.start();
  auto of_whole = whole.start();
  int count = 0;
  for (int k = 0; k < samples; ++k) {
    const Hand<Fingers> now = hand(k);
    count += equal(newest(now, of_newest), whole(now, of_whole)) ? 0 : 1;
  }
  return count;
}

/// The number of samples with an alarm, and with a fresh one.
template <class Rule, std::size_t Fingers, class Make>
std::pair<int, int> alarms(int samples, const Options& options, const Make& hand) {
  const Preslip<Rule, Fingers> preslip(options);
  auto state = preslip.start();
  std::pair<int, int> count{0, 0};
  for (int k = 0; k < samples; ++k) {
    const PreslipResult result = preslip(hand(k), state);
    count.first += result.alarm ? 1 : 0;
    count.second += result.is_fresh ? 1 : 0;
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
  const Options options{.history = 50};
  const auto alike = [](int) { return Hand<2>{felt(3, 5), felt(4, 5)}; };
  CHECK(alarms<published::GraspOptimise, 2>(samples, options, alike) == std::pair{0, 0});
  CHECK(alarms<published::GraspLift, 2>(samples, options, alike) == std::pair{0, 0});
  // two alternating places: from the second sample on, each makes a pair with the previous one
  const auto in_turn = [](int k) { return Hand<2>{felt(k % 2, 5), felt(1 - k % 2, 5)}; };
  CHECK(alarms<published::GraspOptimise, 2>(samples, options, in_turn) ==
        std::pair{samples - 1, samples - 1});
  // a wave every 60 samples, each at another place: the history never holds two of them
  const auto seldom = [](int k) {
    const Index location = k % 60 == 0 ? k / 60 % 7 : FingerSample<>::no_location;
    return Hand<2>{felt(location, 5), felt(location, 5)};
  };
  CHECK(alarms<published::GraspOptimise, 2>(samples, options, seldom) == std::pair{0, 0});
  const Options longer{.history = 61};  // now it does: each meets the previous one for one sample
  const int pairs = (samples - 1) / 60;
  CHECK(alarms<published::GraspOptimise, 2>(samples, longer, seldom) == std::pair{pairs, pairs});
}

TEST_CASE("pre-slip: centroids at the ends of their range", "[preslip]") {
  const auto lift = [](double a_mm, double b_mm, double tolerance_mm) {
    const Options options{.centroid_tolerance_mm = tolerance_mm};
    return is_preslip<published::GraspLift>(Hand<1>{felt(1, 1, a_mm, 0)},
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

TEST_CASE("pre-slip: both searches agree at the ends of the range", "[preslip]") {
  const double ends[] = {0,    -0.0,     5e-324, -5e-324,     1e-300,  0.05,  -0.05,     0.0500001,
                         0.15, 1e8,      -1e8,   1e8 + 0.049, 1e8 - 1, 1e300, -largest,  largest,
                         none, infinity, 1,      -infinity,   1e9,     -1e9,  123456.75, 5e7};
  const Index far[] = {(std::numeric_limits<Index>::min)(), -2, -1, 0, 1, 2, 63, 64, 65, 70,
                       (std::numeric_limits<Index>::max)()};
  for (const double tolerance_mm : {5e-324, 1e-300, 0.1, 1.0, 1e300, largest}) {
    CAPTURE(tolerance_mm);
    const Options options{.history = 9, .centroid_tolerance_mm = tolerance_mm};
    Bits bits(11);
    const auto hand = [&](int) {
      Hand<2> now;
      for (auto& sample : now) {
        sample = felt(far[bits(0, 10)], far[bits(0, 10)], ends[bits(0, 23)], ends[bits(0, 23)]);
      }
      return now;
    };
    CHECK(differences<published::GraspLift, 2>(2000, options, hand) == 0);
    CHECK(differences<published::GraspOptimise, 2>(2000, options, hand) == 0);
  }
}

TEMPLATE_TEST_CASE("pre-slip: the same answers in any number",
                   "[preslip]",
                   float,
                   long double,
                   test::Digits50,
                   test::Dual<double>) {
  using S = TestType;
  const auto check = [](auto rule) {
    using Rule = decltype(rule);
    const Preslip<Rule, 2, S> preslip({.history = 12, .centroid_tolerance_mm = S(0.125)});
    const Preslip<Rule, 2> reference({.history = 12, .centroid_tolerance_mm = 0.125});
    auto state = preslip.start();
    auto of_reference = reference.start();
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
      const PreslipResult result = reference(reference_now, of_reference);
      differ += equal(preslip(now, state), result) ? 0 : 1;
      differ += is_preslip<Rule>(last, now, preslip.options()) ==
                        is_preslip<Rule>(reference_last, reference_now, reference.options())
                    ? 0
                    : 1;
      alarms += result.alarm ? 1 : 0;
      last = now;
      reference_last = reference_now;
    }
    CHECK(differ == 0);
    CHECK(alarms > 10);
    CHECK(alarms < 400);
  };
  check(published::GraspOptimise());
  check(published::GraspLift());
}

TEST_CASE("pre-slip: a derivative that is not a number changes nothing", "[preslip]") {
  using S = test::Dual<double>;
  auto older = felt<S>(1, 1, 0, 0), later = felt<S>(2, 2, 1, 0);
  later.center_x_mm.d = none;
  CHECK(is_preslip<published::GraspLift>(Hand<1, S>{older}, Hand<1, S>{later}));
}

TEMPLATE_TEST_CASE("pre-slip: the longest history",
                   "[preslip]",
                   published::GraspOptimise,
                   published::GraspLift) {
  const Preslip<TestType, 1> preslip({.history = 100000});
  auto state = preslip.start();
  CHECK_FALSE(preslip({felt(1, 1, 0, 0)}, state).alarm);
  CHECK_FALSE(preslip({felt(FingerSample<>::no_location, 0, none, none)}, state).alarm);
  const auto result =
      preslip({felt(2, std::is_same_v<TestType, published::GraspOptimise> ? 1 : 2, 1, 1)}, state);
  CHECK(result.is_fresh);
  CHECK(result.samples_ago == 2);
  state.reset();
  CHECK_FALSE(preslip({felt(3, 3, 0, 0)}, state).alarm);
}

TEMPLATE_TEST_CASE("pre-slip: a pair as old as a history",
                   "[preslip]",
                   published::GraspOptimise,
                   published::GraspLift) {
  const Index history = 3000;
  const Preslip<TestType, 1> preslip({.history = history});
  const auto first = felt(1, 1, 0, 0);
  const auto last = felt(2, std::is_same_v<TestType, published::GraspOptimise> ? 1 : 2, 1, 1);
  const auto silent = felt(FingerSample<>::no_location, 0, none, none);
  for (const Index between : {history - 2, history - 1}) {
    auto state = preslip.start();
    (void)preslip({first}, state);
    for (Index k = 0; k < between; ++k) {
      (void)preslip({silent}, state);
    }
    const auto result = preslip({last}, state);
    CHECK(result.alarm == (between == history - 2));
    CHECK(result.samples_ago == (result.alarm ? history - 1 : PreslipResult::none));
    CHECK_FALSE(preslip({silent}, state).alarm);
  }
}
