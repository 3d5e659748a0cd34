// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Features of 486 taxels, three fingers of 27 x 6, in windows of 16 and 64 samples; "ns/pixel" is
// per taxel. "hand" rows are a whole sample: the features of three fingers and the rule over a
// history of 1000. In "vibrating" rows one taxel of each finger vibrates, in "quiet" rows none.
// Errors, over twelve recordings with 0.08 to 0.32 waves a sample: of the vibrating taxel's rms,
// against two passes in long double; of its waves, which are integers, against the true waves of a
// window; of the centroid, against sums in double.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxels.hpp"

using namespace fingerpad;

namespace {

constexpr Index rows = 27, cols = 6, period = 256;
constexpr Index vibrating_taxel = 74;
constexpr double timed_turn_rad = 1.7;  // phase step of the vibration, per sample

/// Readings of one finger: `period` arrays, repeated. The phase of the vibrating taxel advances by
/// `turn_rad` from sample to sample; 0: no taxel vibrates.
template <class Cell>
std::vector<Cell> recording(double turn_rad) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 4);
  std::vector<Cell> readings;
  for (Index n = 0; n < period; ++n) {
    for (Index k = 0; k < rows * cols; ++k) {
      const double wave =
          k == vibrating_taxel ? 60 * std::sin(turn_rad * static_cast<double>(n)) : 0;
      readings.push_back(static_cast<Cell>(std::round(std::max(0.0, 300 + wave + noise(random)))));
    }
  }
  return readings;
}

/// The `length` readings of a taxel up to the n-th; the index wraps around within the round.
template <class Cell>
std::vector<double> window_of(const std::vector<Cell>& readings,
                              Index taxel,
                              Index n,
                              Index length) {
  std::vector<double> window;
  window.reserve(static_cast<std::size_t>(length));
  for (Index u = n + 1 - length; u <= n; ++u) {
    const auto at = ((u + period) % period) * rows * cols + taxel;
    window.push_back(static_cast<double>(readings[static_cast<std::size_t>(at)]));
  }
  return window;
}

/// The rms about a straight line, or about the mean, in two passes.
template <class T>
T rms_of(const std::vector<double>& window) {
  const T length = static_cast<T>(window.size()), middle = (length - 1) / 2;
  T mean = 0, tilt = 0, spread = 0, squares = 0;
  for (std::size_t u = 0; u < window.size(); ++u) {
    const T at = static_cast<T>(u) - middle, reading = static_cast<T>(window[u]);
    mean += reading / length;
    tilt += at * reading;
    spread += at * at;
  }
  const T slope = tilt / spread;
  for (std::size_t u = 0; u < window.size(); ++u) {
    const T line = mean + slope * (static_cast<T>(u) - middle);
    const T beside = static_cast<T>(window[u]) - line;
    squares += beside * beside;
  }
  return std::sqrt(squares / length);
}

/// Relative error of an rms against two passes in long double.
double rms_error(double rms, const std::vector<double>& window) {
  const long double truth = rms_of<long double>(window);
  return static_cast<double>(static_cast<long double>(rms) / truth - 1);
}

/// Centroid of one array, mm.
template <class Cell>
Point2<double> centroid_of(const Cell* readings, double pitch_mm) {
  double sum = 0, x = 0, y = 0;
  for (Index k = 0; k < rows * cols; ++k) {
    const double w = static_cast<double>(readings[k]);
    sum += w;
    x += w * static_cast<double>(k % cols);
    y += w * static_cast<double>(k / cols);
  }
  return {pitch_mm * x / sum, pitch_mm * y / sum};
}

struct FeatureErrors {
  std::vector<double> rms, waves, centroid_mm;

  void note(bench::Counters& counters) const {
    if (!rms.empty()) {
      bench::note_errors(counters, "rms", "share", rms);
      bench::note_errors(counters, "waves", "waves", waves);
    }
    bench::note_errors(counters, "centroid", "mm", centroid_mm);
  }
};

template <class Cell, class S>
struct Hand {
  explicit Hand(Index window)
      : finger(rows, cols, {.window = window, .sample_period_s = 1, .longest_gap_s = 8}),
        fingers{finger, finger, finger},
        rule(3, {.history = 1000}) {}

  void step(const std::vector<Cell>& readings, bool with_rule) {
    n = n + 1 < period ? n + 1 : 0;
    time += 1;
    const StridedView<const Cell> taxels(readings.data() + n * rows * cols, rows, cols, cols);
    for (std::size_t f = 0; f < 3; ++f) {
      samples[f] = fingers[f](taxels, time);
    }
    if (with_rule) {
      status = rule(samples);
    }
  }

  TaxelFeatures<S> finger;
  std::array<TaxelFeatures<S>, 3> fingers;
  Preslip<S> rule;
  std::array<FingerSample<S>, 3> samples;
  PreslipStatus status = PreslipStatus::cannot_tell;
  double time = 0;
  Index n = 0;
};

/// Adds the errors of a round of the recording, after one that fills the window.
template <class Cell, class S>
void add_errors(double turn_rad, Index window, FeatureErrors& errors) {
  const auto readings = recording<Cell>(turn_rad);
  Hand<Cell, S> hand(window);
  const double pitch_mm = hand.finger.options().pitch_mm;
  for (Index k = 0; k < 2 * period; ++k) {
    hand.step(readings, false);
    if (k < period || hand.n < window - 1) {
      continue;  // a wave is interrupted where a round begins
    }
    const FingerSample<S>& sample = hand.samples[0];
    const auto center = centroid_of(readings.data() + hand.n * rows * cols, pitch_mm);
    errors.centroid_mm.push_back(std::hypot(static_cast<double>(sample.center_x_mm) - center.x,
                                            static_cast<double>(sample.center_y_mm) - center.y));
    if (turn_rad > 0) {
      const bool found = sample.location == vibrating_taxel;
      const auto of = window_of(readings, vibrating_taxel, hand.n, window);
      const double waves = turn_rad / (2 * std::numbers::pi) * static_cast<double>(window);
      const double none = not_a_number<double>();
      errors.rms.push_back(found ? rms_error(static_cast<double>(sample.deviation), of) : none);
      errors.waves.push_back(found ? static_cast<double>(sample.waves) - waves : none);
    }
  }
}

template <class Cell, class S>
FeatureErrors errors_of(bool vibrates, Index window) {
  FeatureErrors errors;
  for (int k = 0; k < (vibrates ? 12 : 1); ++k) {
    add_errors<Cell, S>(vibrates ? 0.5 + 0.14 * k : 0, window, errors);
  }
  return errors;
}

template <class Cell, class S>
void add(const std::string& name, bool vibrates, Index window, bool with_rule) {
  const auto readings =
      std::make_shared<const std::vector<Cell>>(recording<Cell>(vibrates ? timed_turn_rad : 0));
  const bench::Memory memory;
  const auto hand = std::make_shared<Hand<Cell, S>>(window);
  bench::add(
      name, static_cast<std::size_t>(3 * rows * cols), memory.bytes(),
      [=] {
        hand->step(*readings, with_rule);
        benchmark::DoNotOptimize(hand->samples);
      },
      [=, errors = FeatureErrors()](auto& counters) mutable {
        errors = errors.centroid_mm.empty() ? errors_of<Cell, S>(vibrates, window) : errors;
        errors.note(counters);
      });
}

/// Mean and standard deviation of the windows of all taxels.
void add_opencv(const std::string& group, Index window) {
  const auto length = static_cast<int>(window);
  const auto windows = std::make_shared<cv::Mat>(3 * rows * cols, length, CV_32F);
  for (int k = 0; k < windows->rows; ++k) {
    for (int u = 0; u < length; ++u) {
      windows->at<float>(k, u) = static_cast<float>(300 + k * u % 17);
    }
  }
  bench::add(
      group + "cv::meanStdDev of all windows", static_cast<std::size_t>(3 * rows * cols), 0,
      [windows] {
        cv::Scalar mean, deviation;
        for (int k = 0; k < windows->rows; ++k) {
          cv::meanStdDev(windows->row(k), mean, deviation);
          benchmark::DoNotOptimize(deviation);
        }
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  using Counts = std::uint16_t;
  const std::string group = "vibrating, window 16/";
  add<Counts, double>(group + "double, the default", true, 16, false);
  add<Counts, float>(group + "float", true, 16, false);
  add<Counts, double>(group + "hand", true, 16, true);
  add_opencv(group, 16);
  return bench::run(argc, argv);
}
