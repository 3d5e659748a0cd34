// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Whole chains from readings to alarms on signals of known truth: how often and how late slip is
// detected, and how often falsely. test_figures "[preslip]" -s prints all figures.
#include "fingerpad/foam/preslip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "bench/trials/grip/foam_fingers.hpp"
#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "support/catch.hpp"
#include "support/foam_signals.hpp"

using namespace fingerpad;
using test::FoamScene;
using test::FoamSignal;

namespace {

/// The hand of a scene.
class Chain {
 public:
  Chain(PreslipRule rule, const FoamScene& scene, double rate_hz, double longest_gap_s = 0)
      : finger_(scene.rows, scene.cols, options(scene, rate_hz, longest_gap_s)),
        hand_({finger_, finger_}, {.rule = rule}) {}

  bool alarms(FoamSignal& signal, double time_s) { return alarms(signal, time_s, time_s); }
  /// The sample is taken at `time_s` and received at `received_s`.
  bool alarms(FoamSignal& signal, double time_s, double received_s) {
    const auto left = signal.finger(0, time_s), right = signal.finger(1, time_s);
    return hand_(std::array{left, right}, received_s) == PreslipStatus::preslip;
  }
  double window_s() const { return 16 * finger_.options().sample_period_s; }

 private:
  static TaxelOptions options(const FoamScene& scene, double rate_hz, double longest_gap_s) {
    TaxelOptions o;
    o.sample_period_s = 1 / rate_hz;
    o.longest_gap_s = longest_gap_s > 0 ? longest_gap_s : 8 / rate_hz;
    o.noise = scene.noise;
    return o;
  }
  TaxelFeatures<> finger_;
  FoamHand<> hand_;
};

struct Detection {
  int scenes = 0;
  int found = 0;
  int early = 0;              // scenes with an alarm before anything slips
  double latest_windows = 0;  // from the onset of slip to the alarm
};

/// Two fingers on which square patches begin to slip at random positions, frequencies and times.
FoamScene any_slip(std::mt19937& random, double rate_hz, int patches, Index side) {
  const auto any = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  FoamScene scene;
  scene.drift = any(0, 0.3);
  const double frequency = rate_hz * any(0.08, 0.3);
  for (auto& finger : scene.patches) {
    for (int p = 0; p < patches; ++p) {
      test::VibratingPatch patch;
      patch.rows = patch.cols = side;
      patch.row = static_cast<Index>(any(0, 14));
      patch.col = static_cast<Index>(any(0, 2));
      patch.begin_s = (60 + any(0, 1)) / rate_hz;
      patch.frequency_hz = frequency;
      patch.phase = any(0, 6.28);
      finger.push_back(patch);
    }
  }
  return scene;
}

Detection detection(PreslipRule rule, int scenes, int patches, Index side = 2) {
  Detection d;
  const double rates[] = {10, 31, 100, 1000};
  std::mt19937 random(17);
  for (int k = 0; k < scenes; ++k) {
    const double rate_hz = rates[k % 4];
    const FoamScene scene = any_slip(random, rate_hz, patches, side);
    FoamSignal signal(scene, static_cast<unsigned>(k));
    Chain chain(rule, scene, rate_hz);
    bool is_early = false;
    double found_s = -1;
    for (int n = 0; n < 140 && found_s < 0; ++n) {
      const double time_s = n / rate_hz;
      if (chain.alarms(signal, time_s)) {
        if (n < 60) {
          is_early = true;
        } else {
          found_s = time_s;
        }
      }
    }
    ++d.scenes;
    d.early += is_early ? 1 : 0;
    d.found += found_s >= 0 ? 1 : 0;
    if (found_s >= 0) {
      d.latest_windows = std::max(d.latest_windows, (found_s - 60 / rate_hz) / chain.window_s());
    }
  }
  return d;
}

void show(const std::string& name, const Detection& d) {
  std::ostringstream text;
  text << name << ": found " << d.found << " of " << d.scenes << ", early alarms " << d.early
       << ", at most " << std::setprecision(2) << d.latest_windows << " windows after the slip";
  INFO(text.str());
  SUCCEED();
}

/// Of a hold whose noise is `noisier` times as large as stated.
int false_alarms(
    PreslipRule rule, double minutes, double rate_hz, unsigned seed, double noisier = 1) {
  FoamScene scene;
  scene.rows = 8;
  scene.drift = 0.3;
  FoamScene noisy = scene;
  noisy.noise *= noisier;
  FoamSignal signal(noisy, seed);
  Chain chain(rule, scene, rate_hz);
  int alarms = 0;
  for (int n = 0; n < minutes * 60 * rate_hz; ++n) {
    alarms += chain.alarms(signal, n / rate_hz) ? 1 : 0;
  }
  return alarms;
}

}  // namespace

TEST_CASE("pre-slip of known signals: slip is found", "[preslip]") {
  // a window has 16 samples; three samples of a new vibration cover its first wave and a half
  const auto check = [](const std::string& name, const Detection& d, double windows) {
    show(name, d);
    CHECK(d.found >= 0.99 * d.scenes);
    CHECK(d.early == 0);
    CHECK(d.latest_windows <= windows);
  };
  check("grasp-optimise, one patch", detection(PreslipRule::grasp_optimise, 120, 1), 0.3);  // 0.25
  check("grasp-optimise, three patches", detection(PreslipRule::grasp_optimise, 120, 3),
        0.25);                                                                           // 0.19
  check("grasp-lift, one patch", detection(PreslipRule::grasp_lift, 120, 1), 0.65);      // 0.56
  check("grasp-lift, three patches", detection(PreslipRule::grasp_lift, 120, 3), 0.25);  // 0.19
}

TEST_CASE("pre-slip of known signals: one taxel of each finger is enough", "[preslip]") {
  // as printed the location of the strongest taxel never differs: this rule cannot detect it
  const Detection printed = detection(PreslipRule::printed_grasp_optimise, 40, 1, 1);
  show("grasp-optimise as printed, patches of one taxel", printed);
  CHECK(printed.found <= 2);
  for (const Detection& d : {detection(PreslipRule::grasp_optimise, 40, 1, 1),
                             detection(PreslipRule::grasp_lift, 40, 1, 1)}) {
    show("patches of one taxel", d);
    CHECK(d.found == 40);
    CHECK(d.early == 0);
  }
}

TEST_CASE("pre-slip of known signals: gaps delay no alarm by more than two samples", "[preslip]") {
  const bool lifts = GENERATE(true, false);
  const PreslipRule rule = lifts ? PreslipRule::grasp_lift : PreslipRule::grasp_optimise;
  // samples are lost for 0.3 to 1.3 s, right before the slip and after its onset, on two clocks:
  // that of the sensor, and that of a receiver that is late by up to a period
  std::mt19937 random(23);
  const double rate_hz = 31;
  for (int n = 0; n < 40; ++n) {
    const FoamScene scene = any_slip(random, rate_hz, 1, 2);
    std::array<int, 3> first = {-1, -1, -1};  // without gaps, and with gaps on either clock
    for (std::size_t clock = 0; clock < 3; ++clock) {
      FoamSignal signal(scene, static_cast<unsigned>(n));
      Chain chain(rule, scene, rate_hz, 2);
      std::mt19937 late(static_cast<unsigned>(n));
      double gaps_s = 0;
      for (int k = 0; k < 140 && first[clock] < 0; ++k) {
        const double taken_s = k / rate_hz;
        const bool is_gap = k == 58 || k == 64 || k % 23 == 22;
        gaps_s += clock > 0 && is_gap ? 0.3 + 1.0 * (k % 5) / 4 : 0;
        const double jitter = clock == 2 ? double(late() % 1000) / 1000 / rate_hz : 0;
        if (chain.alarms(signal, taken_s, taken_s + gaps_s + jitter)) {
          first[clock] = k;
        }
      }
    }
    CAPTURE(n);
    CHECK(first[0] >= 60);
    CHECK(first[1] == first[0]);
    CHECK(std::abs(first[2] - first[0]) <= 2);
  }
}

TEST_CASE("pre-slip of known signals: no alarm where nothing slips", "[preslip]") {
  // the goal is at most one alarm in ten minutes
  CHECK(false_alarms(PreslipRule::grasp_optimise, 20, 31, 1) == 0);
  CHECK(false_alarms(PreslipRule::grasp_lift, 20, 31, 2) == 0);
  CHECK(false_alarms(PreslipRule::grasp_lift, 20, 31, 3, 1.25) == 0);
  const int wrong_noise = false_alarms(PreslipRule::grasp_lift, 20, 31, 3, 1.5);
  INFO("noise 1.5 times as large as stated: " << wrong_noise << " alarms in 20 minutes");
  CHECK(wrong_noise > 5);
}

namespace {

/// Alarms of a rule on a simulated object, compared with the samples in which a taxel slipped less
/// than a window ago. Consecutive such samples are one onset.
struct Onsets {
  int onsets = 0;
  int found = 0;
  int alarms = 0;
  int right = 0;  // alarms within an onset
  int samples = 0;
  int in_onset = 0;

  double precision() const { return double(right) / double(alarms); }
  double recall() const { return double(found) / double(onsets); }
  /// The precision of a rule that always alarms.
  double chance() const { return double(in_onset) / double(samples); }
};

struct Loosening {
  HoldingCommand<double> end;
  double slipped_at_n = 0;
};

/// Loosens the grip on a simulated object until it slips as a whole, and counts the alarms on the
/// way.
Loosening loosened(PreslipRule rule,
                   const grip::FoamFingersSetup& object,
                   unsigned seed,
                   Onsets& onsets) {
  grip::FoamFingers hand(object, seed);
  const TaxelFeatures<> finger(object.rows, object.cols,
                               {.pitch_mm = object.pitch_mm,
                                .sample_period_s = 1 / object.rate_hz,
                                .noise = object.noise_counts});
  FoamHand<> foam({finger, finger}, {.rule = rule});
  LoosenUntilPreslip<> loosen({.first_force_n = object.first_force_n,
                               .min_force_n = 0.1,
                               .step_n = 0.2,
                               .settle_samples = 4,
                               .watch_samples = 36,
                               .until_slipped = true});
  HoldingCommand<double> command = loosen.command();
  Index since_slip = 1000;
  bool is_onset = false, is_found = false;
  while (!is_end(command.phase)) {
    hand.advance(command.force_n);
    const PreslipStatus status =
        foam(std::array{hand.readings(0), hand.readings(1)}, hand.time_s());
    since_slip = hand.slipped_mm(0) > 0 || hand.slipped_mm(1) > 0 ? 0 : since_slip + 1;
    const bool was_onset = is_onset;
    is_onset = since_slip < finger.options().window;
    is_found = is_found && was_onset;
    ++onsets.samples;
    onsets.in_onset += is_onset ? 1 : 0;
    onsets.onsets += is_onset && !was_onset ? 1 : 0;
    if (status == PreslipStatus::preslip) {
      ++onsets.alarms;
      onsets.right += is_onset ? 1 : 0;
      onsets.found += is_onset && !is_found ? 1 : 0;
      is_found = is_onset;
    }
    command = loosen(hand.has_slipped() ? PreslipStatus::slipped : status);
  }
  return {command, hand.force_n()};
}

Onsets every_loosening_is_warned_of(PreslipRule rule, const std::string& name) {
  std::string text = name + ": steps of warning";
  Onsets onsets;
  for (unsigned seed = 0; seed < 12; ++seed) {
    grip::FoamFingersSetup object;
    object.friction.factor = 0.25 + 0.05 * (seed % 4);
    object.weight_n = 2.5 + 0.7 * (seed % 3);
    const Loosening run = loosened(rule, object, seed, onsets);
    CAPTURE(seed);
    CHECK(run.end.phase == SearchPhase::slipped);
    CHECK(run.end.warning_steps >= 1);
    CHECK(run.end.preslip_force_n > run.slipped_at_n);
    text +=
        ' ' + std::to_string(run.end.warning_steps) + " of " + std::to_string(run.end.steps) + ',';
  }
  text.pop_back();
  INFO(text);
  INFO(name << ": precision " << onsets.precision() << " of " << onsets.alarms << " alarms, recall "
            << onsets.recall() << " of " << onsets.onsets << " onsets");
  SUCCEED();
  return onsets;
}

}  // namespace

TEST_CASE("pre-slip of a simulated object: a warning before it slips, and only where a taxel slips",
          "[preslip]") {
  const Onsets optimise =
      every_loosening_is_warned_of(PreslipRule::grasp_optimise, "grasp-optimise");
  const Onsets lift = every_loosening_is_warned_of(PreslipRule::grasp_lift, "grasp-lift");
  every_loosening_is_warned_of(PreslipRule::printed_grasp_optimise, "grasp-optimise as printed");
  // a rule that always alarms has the precision of chance; one that never alarms has no recall
  CHECK(lift.chance() < 0.9);
  CHECK(lift.precision() >= 0.99);
  CHECK(lift.recall() >= 0.95);
  CHECK(optimise.precision() >= 0.99);
  CHECK(optimise.recall() >= 0.3);
}

namespace {

struct Lift {
  HoldingCommand<double> end;
  double least_force_n = 0;  // at which friction just bears the weight
  bool has_slipped = false;
  int alarms_on_the_way_down = 0;
};

/// The paper's second experiment: an object stands on a surface and is gripped with little force,
/// lifted and put back. Its weight passes to the fingers within 5 mm.
Lift lifted(PreslipRule rule, grip::FoamFingersSetup object, unsigned seed) {
  const LiftOptions<double> plan{.first_force_n = 1,
                                 .max_force_n = 20,
                                 .force_step_n = 0.25,
                                 .height_mm = 6,
                                 .height_step_mm = 0.05,
                                 .settle_samples = 30};
  object.contact_radius_mm *= std::cbrt(plan.first_force_n / object.first_force_n);
  object.first_force_n = plan.first_force_n;
  grip::FoamFingers hand(object, seed, 0);
  const TaxelFeatures<> finger(object.rows, object.cols,
                               {.pitch_mm = object.pitch_mm,
                                .sample_period_s = 1 / object.rate_hz,
                                .noise = object.noise_counts});
  FoamHand<> foam({finger, finger}, {.rule = rule});
  LiftWithRegrip<> lift(plan);
  HoldingCommand<double> command = lift.command();
  const auto look = [&](double height_mm) {
    hand.carry(std::clamp(height_mm / 5, 0.0, 1.0));
    hand.advance(command.force_n);
    return foam(std::array{hand.readings(0), hand.readings(1)}, hand.time_s());
  };
  for (int k = 0; k < 100000 && !is_end(command.phase); ++k) {
    const PreslipStatus status = look(command.height_mm);
    command = lift(hand.has_slipped() ? PreslipStatus::slipped : status);
  }
  Lift end{command, hand.least_force_n()};
  for (double height_mm = command.height_mm; height_mm > 0; height_mm -= 0.02) {
    end.alarms_on_the_way_down += look(height_mm) == PreslipStatus::preslip ? 1 : 0;
  }
  end.has_slipped = hand.has_slipped();
  return end;
}

}  // namespace

TEST_CASE("grasp-lift-replace: a simulated object is lifted with little more than it needs",
          "[preslip]") {
  std::string text;
  for (unsigned seed = 0; seed < 12; ++seed) {
    grip::FoamFingersSetup object;
    object.friction.factor = 0.25 + 0.05 * (seed % 4);
    object.weight_n = 2.5 + 0.7 * (seed % 3);
    const Lift lift = lifted(PreslipRule::grasp_lift, object, seed);
    CAPTURE(seed);
    CHECK(lift.end.phase == SearchPhase::lifted);
    CHECK_FALSE(lift.has_slipped);
    CHECK(lift.end.force_n >= lift.least_force_n);
    CHECK(lift.end.force_n < 2 * lift.least_force_n);
    CHECK(lift.alarms_on_the_way_down == 0);
    std::ostringstream one;
    one << std::setprecision(2) << ' ' << lift.end.force_n << " for " << lift.least_force_n << ',';
    text += one.str();
  }
  INFO("lifted with N where at least these N are needed:" << text);
  SUCCEED();
}
