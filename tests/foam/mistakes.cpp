// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Responses to mistakes with foam fingers. Two fingers hold an object and nothing slips. Each line
// below has a mistake, the hand's status at the end, the status of the affected finger, and from
// when on the hand must not report "steady". No mistake is taken for slip, and no controller moves
// where the status is unknown.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iomanip>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double period_s = 1.0 / 30;
constexpr Index array_rows = 8, array_cols = 4;

/// Data of sample k, which a mistake changes.
struct Sample {
  int k = 0;
  double time_s = 0;
  std::array<Image<double>, 2> fingers{Image<double>(array_rows, array_cols),
                                       Image<double>(array_rows, array_cols)};
};

/// Readings of a firm grip with the noise of real foam: 12 bits, 6 counts.
class Grip {
 public:
  Sample next() {
    Sample sample;
    sample.k = k_;
    sample.time_s = k_++ * period_s;
    for (auto& finger : sample.fingers) {
      for (Index i = 0; i < array_rows; ++i) {
        for (Index j = 0; j < array_cols; ++j) {
          const double load = 600 + 80 * static_cast<double>(i * j);
          finger(i, j) = std::round(load + 6 * normal_(random_));
        }
      }
    }
    return sample;
  }

 private:
  int k_ = 0;
  std::mt19937 random_{11};
  std::normal_distribution<double> normal_{0, 1};
};

template <class Change>
void each(Image<double>& finger, const Change& change) {
  for (double& reading : finger.cells) {
    reading = change(reading);
  }
}

double swapped(double reading) {
  const auto counts = static_cast<std::uint16_t>(reading);
  return static_cast<double>((counts & 0xFF) << 8 | counts >> 8);
}

using Spoil = std::function<void(Sample&)>;
using Change = std::function<void(TaxelOptions&)>;

struct Mistake {
  std::string name;
  PreslipStatus hand;  // at the end
  TaxelStatus finger;  // of finger 1, at the end
  Spoil spoil;         // changes each sample
  Change options = {};
  int seen_from = 0;  // from this sample on not steady, if the hand cannot tell
};

constexpr auto steady = PreslipStatus::steady;
constexpr auto cannot_tell = PreslipStatus::cannot_tell;
constexpr auto quiet = TaxelStatus::quiet;

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all = {
      {"none", steady, quiet, [](Sample&) {}},
      // the clock
      {"time in ms", cannot_tell, TaxelStatus::clock_jumps, [](Sample& s) { s.time_s *= 1e3; }},
      {"time in us", cannot_tell, TaxelStatus::clock_jumps, [](Sample& s) { s.time_s *= 1e6; }},
      {"time in samples", cannot_tell, TaxelStatus::clock_jumps, [](Sample& s) { s.time_s = s.k; }},
      {"a clock that stands still", cannot_tell, TaxelStatus::refused,
       [](Sample& s) { s.time_s = 1; }},
      {"no time", cannot_tell, TaxelStatus::refused, [](Sample& s) { s.time_s = test::nan; }},
      {"time backwards", cannot_tell, TaxelStatus::refused,
       [](Sample& s) { s.time_s = -s.time_s; }},
      {"float times from 1e6 s on: every second one is the one before", steady, quiet,
       [](Sample& s) { s.time_s = static_cast<double>(static_cast<float>(1e6 + s.time_s)); }},
      {"a period of a tenth", cannot_tell, TaxelStatus::clock_jumps, [](Sample&) {},
       [](TaxelOptions& o) { o.sample_period_s = period_s / 10; }},
      {"gaps of a second, now and then", steady, quiet, [](Sample& s) { s.time_s += s.k / 20; }},
      // dead arrays
      {"an array dead at 0", cannot_tell, TaxelStatus::frozen,
       [](Sample& s) { each(s.fingers[1], [](double) { return 0; }); }},
      {"dead at some number", cannot_tell, TaxelStatus::frozen,
       [](Sample& s) { each(s.fingers[1], [](double) { return 517; }); }},
      {"dead at full scale", cannot_tell, TaxelStatus::frozen,
       [](Sample& s) { each(s.fingers[1], [](double) { return 4095; }); }},
      {"dead at full scale, which is known", cannot_tell, TaxelStatus::no_taxels,
       [](Sample& s) { each(s.fingers[1], [](double) { return 4095; }); },
       [](TaxelOptions& o) { o.saturated_at = 4095; }},
      {"no number at all", cannot_tell, TaxelStatus::no_taxels,
       [](Sample& s) { each(s.fingers[1], [](double) { return test::nan; }); }},
      {"an array that freezes in the middle",
       cannot_tell,
       TaxelStatus::frozen,
       [last = Image<double>(array_rows, array_cols)](Sample& s) mutable {
         (s.k < 40 ? last : s.fingers[1]) = (s.k < 40 ? s.fingers[1] : last);
       },
       {},
       40 + 30},
      {"every second sample of one finger missing",
       cannot_tell,
       TaxelStatus::no_taxels,
       [](Sample& s) {
         each(s.fingers[1], [&](double r) { return s.k % 2 == 0 ? r : test::nan; });
       },
       {},
       121},
      // single taxels
      {"a taxel that flickers to 0", steady, quiet,
       [](Sample& s) { s.fingers[1](7, 3) *= s.k % 3 == 0 ? 1 : 0; }},
      {"a taxel that flickers to no number", steady, quiet,
       [](Sample& s) { s.fingers[1](7, 3) = s.k % 3 == 0 ? s.fingers[1](7, 3) : test::nan; }},
      {"a taxel that flickers to infinity", steady, quiet,
       [](Sample& s) { s.fingers[1](7, 3) /= s.k % 3 == 0 ? 1 : 0; }},
      {"a taxel that reads 1e300 now and then", steady, quiet,
       [](Sample& s) { s.fingers[1](7, 3) = s.k % 3 == 0 ? 1e300 : s.fingers[1](7, 3); }},
      {"a taxel that reads -1e300 now and then", steady, quiet,
       [](Sample& s) { s.fingers[1](7, 3) = s.k % 3 == 0 ? -1e300 : s.fingers[1](7, 3); }},
      {"readings times 1e300", cannot_tell, TaxelStatus::no_taxels,
       [](Sample& s) { each(s.fingers[1], [](double r) { return 1e300 * r; }); }},
      {"a taxel stuck at its load", steady, quiet, [](Sample& s) { s.fingers[1](7, 3) = 2000; }},
      {"half of the taxels missing", steady, quiet,
       [](Sample& s) {
         for (Index i = 0; i < array_rows; i += 2) {
           for (Index j = 0; j < array_cols; ++j) {
             s.fingers[1](i, j) = test::nan;
           }
         }
       }},
      // numbers
      {"bytes swapped", cannot_tell, TaxelStatus::vibrating,
       [](Sample& s) { each(s.fingers[1], swapped); }},
      {"noise ten times too small", cannot_tell, TaxelStatus::vibrating, [](Sample&) {},
       [](TaxelOptions& o) { o.noise = 0.6; }},
      {"readings in N, noise in counts", cannot_tell, TaxelStatus::too_weak,
       [](Sample& s) { each(s.fingers[1], [](double r) { return r / 800; }); }},
      {"readings scaled to 0 to 1", cannot_tell, TaxelStatus::too_weak,
       [](Sample& s) { each(s.fingers[1], [](double r) { return r / 4096; }); }},
      {"noise in thousandths of a count", cannot_tell, TaxelStatus::too_weak, [](Sample&) {},
       [](TaxelOptions& o) { o.noise = 6000; }},
      {"readings with their sign changed", cannot_tell, TaxelStatus::too_weak,
       [](Sample& s) { each(s.fingers[1], [](double r) { return -r; }); }},
      // sizes
      {"rows and columns exchanged", cannot_tell, TaxelStatus::refused,
       [](Sample& s) { s.fingers[1] = Image<double>(array_cols, array_rows, 600); }},
      {"one row missing", cannot_tell, TaxelStatus::refused,
       [](Sample& s) { s.fingers[1] = Image<double>(array_rows - 1, array_cols, 600); }},
  };
  return all;
}

}  // namespace

TEST_CASE("mistakes with foam fingers", "[mistakes]") {
  std::ostringstream table;
  for (const Mistake& mistake : mistakes()) {
    CAPTURE(mistake.name);
    TaxelOptions options;
    if (mistake.options) {
      mistake.options(options);
    }
    const TaxelFeatures<> finger(array_rows, array_cols, options);
    FoamHand<> hand({finger, finger});
    Preslip<> optimise(2, {.rule = PreslipRule::grasp_optimise});
    LoosenUntilPreslip<> loosen({.settle_samples = 0, .watch_samples = 4});
    Grip grip;
    const Spoil spoil = mistake.spoil;  // a fresh copy
    PreslipStatus status = cannot_tell;
    int preslips = 0, steadies = 0;
    for (int k = 0; k < 121; ++k) {
      Sample sample = grip.next();
      spoil(sample);
      status = hand(sample.fingers, sample.time_s);
      CHECK(optimise(hand.fingers()) == status);
      const double before_n = loosen.command().force_n;
      const double after_n = loosen(status).force_n;
      CHECK((status != cannot_tell || before_n == after_n));
      preslips += status == PreslipStatus::preslip ? 1 : 0;
      steadies += status == steady && k >= mistake.seen_from ? 1 : 0;
    }
    CHECK(status == mistake.hand);
    CHECK(hand.fingers()[1].status == mistake.finger);
    CHECK(preslips == 0);
    CHECK((mistake.hand == steady || steadies == 0));
    table << "\n  " << std::left << std::setw(64) << mistake.name << std::setw(14)
          << name_of(status) << name_of(hand.fingers()[1].status);
  }
  INFO(table.str());
  SUCCEED();
}

TEST_CASE("mistakes with foam fingers: what is told of single taxels", "[mistakes]") {
  TaxelFeatures<> finger(array_rows, array_cols);
  Grip grip;
  FingerSample<> felt;
  for (int k = 0; k < 70; ++k) {
    Sample sample = grip.next();
    each(sample.fingers[0], [&](double r) { return r * (1 + 0.01 * k); });
    sample.fingers[0](0, 0) = 0;                    // no pressure there, or dead
    sample.fingers[0](7, 3) = 2000;                 // stuck
    sample.fingers[0](3, 3) *= k % 3 == 0 ? 1 : 0;  // loose
    sample.fingers[0](4, 3) = test::nan;            // missing
    sample.time_s += k > 50 ? 1 : 0;                // a gap
    felt = finger(sample.fingers[0], sample.time_s);
  }
  CHECK(felt.left_out == 3);
  CHECK(felt.status == TaxelStatus::quiet);
}

TEST_CASE("mistakes with foam fingers: one is dead, by the rules as printed", "[mistakes]") {
  for (const PreslipRule rule : {PreslipRule::grasp_lift, PreslipRule::printed_grasp_optimise}) {
    for (const bool dead : {false, true}) {
      const TaxelFeatures<> finger(array_rows, array_cols);
      FoamHand<> hand({finger, finger}, {.rule = rule});
      Grip grip;
      PreslipStatus status = cannot_tell;
      for (int k = 0; k < 121; ++k) {
        Sample sample = grip.next();
        sample.fingers[1] = dead ? Image<double>(array_rows, array_cols, 517) : sample.fingers[1];
        status = hand(sample.fingers, sample.time_s);
        CHECK(status != PreslipStatus::preslip);
      }
      CHECK(status == (dead ? cannot_tell : steady));
    }
  }
}

TEST_CASE("mistakes with foam fingers: another number of fingers", "[mistakes]") {
  const TaxelFeatures<> finger(array_rows, array_cols);
  FoamHand<> hand({finger, finger});
  const std::array<Image<double>, 3> three{Image<double>(array_rows, array_cols, 600),
                                           Image<double>(array_rows, array_cols, 600),
                                           Image<double>(array_rows, array_cols, 600)};
  CHECK(hand(three, 0) == cannot_tell);
  CHECK(test::refusal([] { FoamHand<>({}); }) == "Preslip: fingers = 0, must be in [1, 100]");
}

TEST_CASE("mistakes with foam fingers: arrays larger than any", "[mistakes]") {
  const auto said = [](Index rows, Index cols, Index window) {
    return test::refusal([=] { const TaxelFeatures<> r(rows, cols, {.window = window}); });
  };
  constexpr Index enormous = std::numeric_limits<Index>::max();
  CHECK(said(enormous, 4, 16).find("TaxelFeatures: rows = ") == 0);
  CHECK(said(4, enormous, 16).find("TaxelFeatures: cols = ") == 0);
  CHECK(said(4096, 4096, 4096) ==
        "TaxelFeatures: cells in memory = 68719476736, must be <= 100000000");
  CHECK(test::refusal([] {
          const Preslip<> r(2, {.history = enormous});
        }).find("PreslipOptions: history = ") == 0);
}
