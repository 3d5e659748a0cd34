// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Thresholds of the pre-slip rules from recordings in which a person, or a camera, has marked the
// onset of slip. The paper prints none ("Pre-Slip Sensing Using Tactile Sensor", 2007). A rule is
// judged by both its recall (onsets found) and its precision (alarms that are right). Recall alone
// is meaningless, since a rule that always alarms finds every onset.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/finger_sample.hpp"
#include "fingerpad/foam/preslip.hpp"

namespace fingerpad {
inline namespace v0 {

/// Comparison of alarms with marked onsets.
template <scalar S = double>
struct [[nodiscard]] PreslipFit {
  /// Cause of a fit without a useful threshold.
  static constexpr const char* onsets_not_found =
      "no threshold separates the onsets from the rest: check the marks, or use another "
      "rule";

  const char* cause = onsets_not_found;  ///< likely mistake
  PreslipOptions<S> options = {};        ///< for Preslip
  Index onsets = 0;                      ///< marked samples in a row count as one
  Index found = 0;                       ///< onsets with an alarm
  Index alarms = 0;                      ///< samples with an alarm
  Index right = 0;                       ///< alarms in marked samples
  Index samples = 0;
  Index marked = 0;
  Index ties = 0;  ///< equally good thresholds, these included: the more, the less they matter

  bool ok() const { return cause == nullptr; }
  double recall() const { return onsets > 0 ? share(found, onsets) : 0; }
  double precision() const { return alarms > 0 ? share(right, alarms) : 0; }
  /// The precision of a rule that always alarms. A useful rule has a higher `precision`.
  double chance() const { return samples > 0 ? share(marked, samples) : 0; }

 private:
  static double share(Index part, Index whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  }
};

/// Collects marked samples, then finds the thresholds. Rule and Fingers as in Preslip.
template <class Rule = GraspLift, std::size_t Fingers = 2, scalar S = double>
class PreslipCalibration {
 public:
  /// `history` as in PreslipOptions. Refuses bad parameters (parameter_error).
  explicit PreslipCalibration(Index history = 100) {
    options_.history = history;
    expects_valid(options_);
  }

  /// The next sample belongs to another recording and is not compared with earlier ones.
  void begin_recording() { begins_ = true; }

  /// Adds a sample of all fingers. `is_onset` marks the onset of slip. Mark the samples in which an
  /// alarm would be right: about a window of samples from the first that slips.
  void add(const std::array<FingerSample<S>, Fingers>& samples, bool is_onset) {
    samples_.push_back({samples, is_onset, begins_ || samples_.empty()});
    begins_ = false;
  }

  /// The thresholds that find the most onsets with a precision of at least `min_precision`; of
  /// equally good ones, the middle. `onsets_not_found`: there are none, or the alarms are no better
  /// than chance. Refuses (parameter_error) samples of which none, or all, are marked, and a
  /// `min_precision` outside [0, 1]. Takes O(samples history) time, 96 times.
  PreslipFit<S> fit(double min_precision = 0.9) const {
    const char* const owner = "PreslipCalibration";
    expects(min_precision >= 0 && min_precision <= 1, owner, "min_precision", min_precision,
            "in [0, 1]");
    const auto marked = static_cast<long long>(
        std::count_if(samples_.begin(), samples_.end(), [](const Marked& s) { return s.onset; }));
    expects(marked > 0, owner, "marked samples", marked, "> 0");
    expects(marked < static_cast<long long>(samples_.size()), owner, "samples without a mark",
            static_cast<long long>(samples_.size()) - marked, "> 0");
    std::vector<PreslipFit<S>> all;
    for (Index min_waves = 0; min_waves < 8; ++min_waves) {
      for (const double tolerance : tolerances_mm) {
        PreslipOptions<S> options = options_;
        options.min_waves = min_waves;
        options.centroid_tolerance_mm = S(tolerance);
        all.push_back(judge(options));
      }
    }
    return best_of(all, min_precision);
  }

  /// Judges given thresholds, for example from other recordings, on these samples. The status of
  /// the result is not set. Refuses bad parameters (parameter_error).
  PreslipFit<S> judge(const PreslipOptions<S>& options) const {
    const Preslip<Rule, Fingers, S> rule(options);
    auto state = rule.start();
    PreslipFit<S> score;
    score.options = options;
    bool in_onset = false, is_found = false;
    for (const Marked& s : samples_) {
      if (s.begins) {
        state.reset();
        in_onset = false;
      }
      const bool alarm = rule(s.fingers, state).is_fresh;
      const bool is_new = s.onset && !in_onset;
      in_onset = s.onset;
      is_found = is_found && !is_new;
      ++score.samples;
      score.marked += s.onset ? 1 : 0;
      score.onsets += is_new ? 1 : 0;
      score.alarms += alarm ? 1 : 0;
      score.right += alarm && s.onset ? 1 : 0;
      score.found += alarm && s.onset && !is_found ? 1 : 0;
      is_found = is_found || (alarm && s.onset);
    }
    return score;
  }

 private:
  struct Marked {
    std::array<FingerSample<S>, Fingers> fingers;
    bool onset;
    bool begins;
  };
  static constexpr std::array<double, 12> tolerances_mm = {0,   0.01, 0.02, 0.05, 0.1, 0.2,
                                                           0.5, 1,    2,    3,    5,   10};

  static PreslipFit<S> best_of(const std::vector<PreslipFit<S>>& all, double min_precision) {
    const auto is_better = [&](const PreslipFit<S>& a, const PreslipFit<S>& b) {
      const bool a_holds = a.precision() >= min_precision, b_holds = b.precision() >= min_precision;
      if (a_holds != b_holds) {
        return a_holds;
      }
      return a.found != b.found ? a.found > b.found : a.precision() > b.precision();
    };
    PreslipFit<S> best = all.front();
    for (const PreslipFit<S>& score : all) {
      best = is_better(score, best) ? score : best;
    }
    std::vector<PreslipFit<S>> ties;
    for (const PreslipFit<S>& score : all) {
      // only with the same min_waves, so that the middle is one of the ties
      if (!is_better(best, score) && score.options.min_waves == best.options.min_waves) {
        ties.push_back(score);
      }
    }
    PreslipFit<S> fit = ties[ties.size() / 2];
    fit.ties = static_cast<Index>(ties.size());
    fit.cause = fit.precision() >= min_precision && fit.found > 0 && fit.precision() > fit.chance()
                    ? nullptr
                    : PreslipFit<S>::onsets_not_found;
    return fit;
  }

  PreslipOptions<S> options_ = {};
  std::vector<Marked> samples_;
  bool begins_ = true;
};

}  // namespace v0
}  // namespace fingerpad
