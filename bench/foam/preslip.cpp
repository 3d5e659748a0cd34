// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rules of pre-slip: patches of two foam fingers begin to slip at a known time
// (tests/support/foam_signals.hpp). Time: of one sample. Error: the delay of the alarm, in windows
// of 16 samples; an earlier alarm counts as none.
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "support/foam_signals.hpp"

using namespace fingerpad;

namespace {

using Hand = std::array<FingerSample<double>, 2>;

/// Samples of the foam fingers of each recording.
using Recordings = std::vector<std::vector<Hand>>;

constexpr std::size_t slip_begins = 60;

/// Three patches on each finger begin to slip; place, speed and rate vary.
const Recordings& slips() {
  static const Recordings all = [] {
    std::mt19937 random(17);
    const auto any = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    Recordings recordings;
    for (unsigned n = 0; n < 40; ++n) {
      const double rate_hz = std::array{10.0, 31.0, 100.0, 1000.0}[n % 4];
      test::FoamScene scene;
      scene.drift = any(0, 0.3);
      const double frequency_hz = rate_hz * any(0.08, 0.3);
      for (int p = 0; p < 6; ++p) {
        test::VibratingPatch patch;
        patch.row = static_cast<Index>(any(0, 14));
        patch.col = static_cast<Index>(any(0, 2));
        patch.begin_s = (static_cast<double>(slip_begins) + any(0, 1)) / rate_hz;
        patch.frequency_hz = frequency_hz;
        patch.phase = any(0, 6.28);
        scene.patches[static_cast<std::size_t>(p % 2)].push_back(patch);
      }
      const TaxelFeatures<> finger(
          scene.rows, scene.cols,
          {.sample_period_s = 1 / rate_hz, .longest_gap_s = 8 / rate_hz, .noise = scene.noise});
      std::array fingers{finger, finger};
      test::FoamSignal signal(scene, n);
      auto& hands = recordings.emplace_back();
      for (int k = 0; k < 140; ++k) {
        auto& hand = hands.emplace_back();
        for (std::size_t f = 0; f < 2; ++f) {
          hand[f] = fingers[f](signal.finger(f, k / rate_hz), k / rate_hz);
        }
      }
    }
    return recordings;
  }();
  return all;
}

/// Applies a rule to the samples of a recording one after the other.
struct Watching {
  explicit Watching(PreslipRule rule) : preslip(2, {.rule = rule}) {}

  bool alarms(const std::vector<Hand>& hands) {
    return preslip(hands[k++ % hands.size()]) == PreslipStatus::preslip;
  }

  Preslip<> preslip;
  std::size_t k = 0;
};

void add_detection(const std::string& name, PreslipRule rule) {
  const bench::Memory memory;
  const auto d = std::make_shared<Watching>(rule);
  const long bytes = memory.bytes();
  bench::add(
      "detection/" + name, 1, bytes, [d] { benchmark::DoNotOptimize(d->alarms(slips().front())); },
      [rule](auto& counters) {
        std::vector<double> delays;
        for (const std::vector<Hand>& hands : slips()) {
          Watching watching(rule);
          while (watching.k < hands.size() && !watching.alarms(hands)) {
          }
          const bool found = watching.k > slip_begins && watching.k < hands.size();
          const double windows = (static_cast<double>(watching.k - 1) - slip_begins) / 16;
          delays.push_back(found ? windows : test::nan);
        }
        bench::note_errors(counters, "delay", "windows", delays);
      });
}

}  // namespace

int main(int argc, char** argv) {
  using enum PreslipRule;
  add_detection("GraspLift, the default", grasp_lift);
  add_detection("published: GraspOptimise", printed_grasp_optimise);
  add_detection("GraspOptimise", grasp_optimise);
  return bench::run(argc, argv);
}
