// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/preslip.hpp"

#include <array>

#include "fingerpad/foam/taxel_features.hpp"
#include "grip/foam_fingers.hpp"
#include "support/catch.hpp"
#include "support/foam_signals.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::finger;

namespace {

using Samples = std::array<FingerSample<double>, 2>;

/// A trembling hand. Between slips the force moves by 0.3 mm and a taxel vibrates with two waves
/// now and then; at the onset of slip the force moves by 1.5 mm and a taxel vibrates with `waves`.
template <class Calibration>
void add_trembling(Calibration& calibration, unsigned seed, Index waves, Index late = 0) {
  test::Random random(seed);
  calibration.begin_recording();
  for (Index k = 0; k < 400; ++k) {
    const auto is_onset = [](Index at) { return at % 50 >= 44; };
    const bool slips = is_onset(k);
    const double x = 20 + random.uniform(-0.15, 0.15) + (slips ? 1.5 : 0);
    const Index now = slips ? waves : (k % 7 == 0 ? Index(2) : Index(0));
    const auto one = finger(x, k % 11, now);
    calibration.add({one, finger(20, 0, 0)}, k >= late && is_onset(k - late));
  }
}

}  // namespace

TEST_CASE("pre-slip calibration: thresholds between what trembles and what slips", "[preslip]") {
  PreslipCalibration<> calibration(20);
  add_trembling(calibration, 1, 3);
  add_trembling(calibration, 2, 3);
  const auto fit = calibration.fit();
  CAPTURE(fit.options.centroid_tolerance_mm, fit.options.min_waves, fit.precision(), fit.recall());
  CHECK(fit.ok());
  CHECK(fit.onsets == 16);
  CHECK(fit.found == 16);
  CHECK(fit.samples == 800);
  CHECK(fit.marked == 96);
  CHECK(fit.chance() == Approx(0.12));
  CHECK(fit.precision() == 1);
  CHECK(fit.options.history == 20);
  // either threshold separates them
  CHECK((fit.options.min_waves == 3 || fit.options.centroid_tolerance_mm >= 0.3));
  CHECK(fit.ties >= 1);

  // with equal waves, the centroid alone separates them
  PreslipCalibration<> alike(20);
  add_trembling(alike, 3, 2);
  const auto by_centroid = alike.fit();
  CHECK(by_centroid.ok());
  CHECK(by_centroid.recall() == 1);
  CHECK(by_centroid.options.centroid_tolerance_mm >= 0.3);
  CHECK(by_centroid.options.centroid_tolerance_mm < 1.5);
  CHECK(alike.judge({.history = 20}).precision() < 0.6);  // the default of 0.1 mm
}

TEST_CASE("pre-slip calibration: round tolerances separate what moves little less or more",
          "[preslip]") {
  for (const double tolerance : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0}) {
    PreslipCalibration<> calibration(20);
    for (Index k = 0; k < 400; ++k) {
      const bool slips = k % 50 == 44;
      const double moved = k % 50 == 20 ? 0.98 * tolerance : (slips ? 1.02 * tolerance : 0);
      calibration.add({finger(20 + moved, k % 11, moved > 0 ? 2 : 0), finger(20, 0, 0)}, slips);
    }
    const auto fit = calibration.fit();
    CAPTURE(tolerance, fit.precision(), fit.recall());
    CHECK(fit.ok());
    CHECK(fit.options.centroid_tolerance_mm == tolerance);
  }
}

TEST_CASE("pre-slip calibration: marks that do not fit are told", "[preslip]") {
  PreslipCalibration<> calibration(20);
  add_trembling(calibration, 1, 3, 25);
  const auto fit = calibration.fit();
  CHECK(fit.cause == std::string(fit.onsets_not_found));
  CHECK(fit.precision() < 0.5);

  PreslipCalibration<> none, all;
  none.add({finger(1, 1, 2), finger(1, 1, 2)}, false);
  all.add({finger(1, 1, 2), finger(1, 1, 2)}, true);
  CHECK(test::refusal([&] { (void)none.fit(); }) ==
        "PreslipCalibration: marked samples = 0, must be > 0");
  CHECK(test::refusal([&] { (void)all.fit(); }) ==
        "PreslipCalibration: samples without a mark = 0, must be > 0");
  CHECK(test::begins_with(test::refusal([&] { (void)calibration.fit(1.5); }),
                          "PreslipCalibration: min_precision = 1.5"));
  CHECK(test::begins_with(test::refusal([] { PreslipCalibration<>(1); }),
                          "PreslipOptions: history = 1"));
}

TEST_CASE("pre-slip calibration: nothing is compared across recordings", "[preslip]") {
  // one sample per recording: a pair would need two
  PreslipCalibration<> calibration;
  for (int k = 0; k < 20; ++k) {
    calibration.begin_recording();
    calibration.add({finger(k, k, 1 + k), finger(k, k, 1 + k)}, k % 2 == 1);
  }
  const auto fit = calibration.fit();
  CHECK(fit.alarms == 0);
  CHECK(fit.cause == std::string(fit.onsets_not_found));
}

namespace {

/// Loosens simulated fingers until the object falls, with three times the default noise. An onset
/// is a slip less than a window ago.
template <class Calibration>
void add_loosening(Calibration& calibration, unsigned seed) {
  grip::FoamFingersSetup object;
  object.friction.factor = 0.25 + 0.05 * (seed % 4);
  object.weight_n = 2.5 + 0.7 * (seed % 3);
  grip::FoamFingers hand(object, seed);
  const TaxelFeatures<> features(object.rows, object.cols,
                                 TaxelOptions<>{.pitch_mm = object.pitch_mm,
                                                .sample_period_s = 1 / object.rate_hz,
                                                .noise = object.noise_counts});
  std::array<TaxelFeatures<>::State, 2> fingers{features.start(), features.start()};
  calibration.begin_recording();
  Index since_slip = 1000;
  for (int k = 0; !hand.has_slipped() && k < 4000; ++k) {
    hand.advance(object.first_force_n - 0.2 * (k / 40));
    Samples samples;
    for (std::size_t f = 0; f < 2; ++f) {
      samples[f] = features(hand.readings(f), hand.time_s(), fingers[f]);
    }
    since_slip = hand.slipped_mm(0) > 0 || hand.slipped_mm(1) > 0 ? 0 : since_slip + 1;
    calibration.add(samples, since_slip < features.options().window);
  }
}

}  // namespace

TEST_CASE("pre-slip calibration: thresholds of some objects hold for others", "[preslip]") {
  PreslipCalibration<GraspLift> lift;
  for (unsigned seed = 0; seed < 3; ++seed) {
    add_loosening(lift, seed);
  }
  const auto fit = lift.fit(0.95);
  CHECK(fit.ok());
  CHECK(fit.precision() >= 0.95);
  CHECK(fit.recall() >= 0.9);
  // on objects outside the calibration
  for (unsigned seed = 7; seed < 10; ++seed) {
    PreslipCalibration<GraspLift> unseen;
    add_loosening(unseen, seed);
    CAPTURE(seed);
    const auto judged = unseen.judge(fit.options);
    CHECK(judged.precision() >= 0.9);
    CHECK(judged.recall() >= 0.9);
  }
}
