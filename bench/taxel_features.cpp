// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The features of 486 taxels, three fingers of 27 x 6, in windows of 16 and 64 samples; "ns/pixel"
// is per taxel. "hand" rows are a whole sample: the features of three fingers and the rule over a
// history of 1000. In "vibrating" rows one taxel of each finger vibrates, in "quiet" rows none.
// Errors: of the vibrating taxel's rms, relative, against two passes in double.
#include "fingerpad/taxel_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "fingerpad/preslip.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

constexpr Index rows = 27, cols = 6, period = 256;
constexpr Index vibrating_taxel = 74;

/// Readings of one finger: `period` arrays, again and again.
template <class Cell>
std::vector<Cell> recording(bool vibrates) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 4);
  std::vector<Cell> readings;
  for (Index n = 0; n < period; ++n) {
    for (Index k = 0; k < rows * cols; ++k) {
      const bool shakes = vibrates && k == vibrating_taxel;
      const double wave = shakes ? 60 * std::sin(1.7 * static_cast<double>(n)) : 0;
      readings.push_back(static_cast<Cell>(std::round(std::max(0.0, 300 + wave + noise(random)))));
    }
  }
  return readings;
}

template <class Cell, class S, class Waves, class Level>
struct Hand {
  using Features = TaxelFeatures<Waves, Level, S>;
  using Rule = Preslip<GraspLift<>, 3, NewestPairs, S>;

  Hand(bool vibrates, Index window)
      : readings(recording<Cell>(vibrates)),
        features(rows, cols, options(window)),
        rule(PreslipOptions<S>{.history = 1000}) {}

  static TaxelOptions<S> options(Index window) {
    TaxelOptions<S> o;
    o.window = window;
    o.sample_period_s = S(1);
    o.longest_gap_s = S(8);
    return o;
  }

  StridedView<const Cell> next() {
    n = n + 1 < period ? n + 1 : 0;
    time = time + S(1);
    return {readings.data() + n * rows * cols, rows, cols, cols};
  }

  double relative_error() const {
    const Index window = features.options().window;
    if (n < window) {
      return 0;  // the last window began in the recording's last round
    }
    const double length = static_cast<double>(window), middle = (length - 1) / 2;
    const auto reading = [&](Index u) {
      return static_cast<double>(
          readings[static_cast<std::size_t>((n + 1 - window + u) * rows * cols + vibrating_taxel)]);
    };
    double mean = 0, tilt = 0, spread = 0, squares = 0;
    for (Index u = 0; u < window; ++u) {
      const double at = static_cast<double>(u) - middle;
      mean += reading(u) / length;
      tilt += at * reading(u);
      spread += at * at;
    }
    for (Index u = 0; u < window; ++u) {
      squares += std::pow(reading(u) - mean - tilt / spread * (static_cast<double>(u) - middle), 2);
    }
    return std::abs(static_cast<double>(samples[0].deviation) / std::sqrt(squares / length) - 1);
  }

  std::vector<Cell> readings;
  Features features;
  Rule rule;
  std::array<typename Features::State, 3> fingers{features.start(), features.start(),
                                                  features.start()};
  typename Rule::State history = rule.start();
  std::array<FingerSample<S>, 3> samples;
  PreslipResult result;
  S time = S(0);
  Index n = 0;
};

template <class Cell, class S, class Waves = ZeroCrossings, class Level = TrendRemoved>
void add(const std::string& name, bool vibrates, Index window, bool with_rule) {
  const auto hand = std::make_shared<Hand<Cell, S, Waves, Level>>(vibrates, window);
  bench::add(
      name, static_cast<std::size_t>(3 * rows * cols),
      [hand, with_rule] {
        const auto taxels = hand->next();
        for (std::size_t f = 0; f < 3; ++f) {
          hand->samples[f] = hand->features(taxels, hand->time, hand->fingers[f]);
        }
        if (with_rule) {
          hand->result = hand->rule(hand->samples, hand->history);
        }
      },
      [hand, vibrates](auto& counters) {
        if (vibrates) {
          counters["max_rel_error"] = hand->relative_error();
        }
      });
}

}  // namespace

int main(int argc, char** argv) {
  using Counts = std::uint16_t;
  add<Counts, double>("quiet/window 16", false, 16, false);
  add<Counts, float>("quiet/window 16, float", false, 16, false);
  add<float, float>("quiet/window 16, float readings", false, 16, false);
  add<Counts, double>("quiet/window 64", false, 64, false);
  add<Counts, double, ZeroCrossings, MeanRemoved>("quiet/window 16, MeanRemoved", false, 16, false);
  add<Counts, double>("quiet/window 16, hand", false, 16, true);
  for (const Index window : {16, 64}) {
    const std::string group = "vibrating, window " + std::to_string(window) + "/";
    add<Counts, double>(group + "ZeroCrossings", true, window, false);
    add<Counts, float>(group + "ZeroCrossings, float", true, window, false);
    add<Counts, double, SpectralPeak>(group + "SpectralPeak", true, window, false);
    add<Counts, double>(group + "ZeroCrossings, hand", true, window, true);
  }
  return bench::run(argc, argv);
}
