// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Readings of foam fingers in, pre-slip out: the features of each finger and the rules over all of
// them, by one object. It puts the methods of foam/ together and adds none.
//
//   FoamHand<2> hand(options);                       // takes all memory, refuses bad parameters
//   auto felt = hand({left, right}, time_s);         // every sample
//   if (felt.status == PreslipStatus::preslip) { ... }
#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxel_features.hpp"

namespace fingerpad {
inline namespace v0 {

/// Which rules a hand has, and by which methods. Derive from it and change what differs: a rule
/// that is false is not instantiated and costs nothing.
///   struct WhileLoosening : FoamHandMethods {
///     static constexpr bool has_grasp_optimise = true;
///   };
struct FoamHandMethods {
  static constexpr bool has_grasp_lift = true;       ///< on any finger: take this by default
  static constexpr bool has_grasp_optimise = false;  ///< on all fingers alike, as in the paper's
                                                     ///< first experiment
  using Waves = ZeroCrossings;
  using Scalar = double;
};

/// The array of one finger.
struct FoamArray {
  Index rows = 0;
  Index cols = 0;
  StridedView<const double> noise = {};  ///< standard deviation of each taxel at rest; NaN: dead.
                                         ///< Empty: that of the options for all
};

template <std::size_t Fingers = 2, scalar S = double>
struct FoamHandOptions {
  std::array<FoamArray, Fingers> fingers = {};
  TaxelOptions<S> taxels = {};
  PreslipOptions<S> rules = {};
};

/// What a sample says. The result of a rule that is switched off is its default: cannot tell.
template <std::size_t Fingers = 2, scalar S = double>
struct [[nodiscard]] FoamHandResult {
  PreslipStatus status = PreslipStatus::cannot_tell;  ///< of all rules: what to act on
  std::array<FingerSample<S>, Fingers> fingers = {};
  PreslipResult grasp_lift = {};
  PreslipResult grasp_optimise = {};

  /// Whether the fingers could be judged.
  bool ok() const { return status != PreslipStatus::cannot_tell; }
};

/// Not const: a sample changes the windows and the history. One object per hand; it is not shared
/// by threads. A sample allocates nothing, throws nothing, and takes O(taxels + history).
template <std::size_t Fingers = 2, class Methods = FoamHandMethods>
class FoamHand {
  using S = typename Methods::Scalar;
  using Features = TaxelFeatures<typename Methods::Waves, S>;

 public:
  using Result = FoamHandResult<Fingers, S>;

  /// Refuses bad parameters (parameter_error).
  explicit FoamHand(const FoamHandOptions<Fingers, S>& options)
      : lift_(options.rules), optimise_(options.rules) {
    for (const FoamArray& array : options.fingers) {
      features_.push_back(features_of(array, options.taxels));
      windows_.push_back(features_.back().start());
    }
  }

  /// One sample: what each finger reads, in the order of the options, and when it was received. A
  /// sample that a finger refuses (its size, its time) is none for the rules.
  template <grid Readings>
  Result operator()(const std::array<Readings, Fingers>& readings, double time_s) {
    Result felt;
    for (std::size_t f = 0; f < Fingers; ++f) {
      felt.fingers[f] = features_[f](readings[f], time_s, windows_[f]);
    }
    if constexpr (Methods::has_grasp_lift || Methods::has_grasp_optimise) {
      if (std::none_of(felt.fingers.begin(), felt.fingers.end(), is_refused)) {
        felt.grasp_lift = lift_(felt.fingers);
        felt.grasp_optimise = optimise_(felt.fingers);
        felt.status = fused(felt.grasp_lift.status, felt.grasp_optimise.status);
      }
    }
    return felt;
  }

  /// Forgets all samples: the next one is the first.
  void reset() {
    for (auto& window : windows_) {
      window.reset();
    }
    lift_.reset();
    optimise_.reset();
  }

 private:
  /// A rule with its history.
  template <class Rule>
  struct RuleStage {
    Preslip<Rule, Fingers, S> rule;
    typename Preslip<Rule, Fingers, S>::State history;

    explicit RuleStage(const PreslipOptions<S>& options) : rule(options), history(rule.start()) {}
    PreslipResult operator()(const std::array<FingerSample<S>, Fingers>& fingers) {
      return rule(fingers, history);
    }
    void reset() { history.reset(); }
  };

  /// In place of a rule that is switched off.
  struct NoStage {
    explicit NoStage(const PreslipOptions<S>&) {}
    PreslipResult operator()(const std::array<FingerSample<S>, Fingers>&) { return {}; }
    void reset() {}
  };

  template <bool IsOn, class Rule>
  using Stage = std::conditional_t<IsOn, RuleStage<Rule>, NoStage>;

  static Features features_of(const FoamArray& array, const TaxelOptions<S>& options) {
    const bool has_noise = array.noise.rows() > 0;
    expects(!has_noise || (array.noise.rows() == array.rows && array.noise.cols() == array.cols),
            "FoamArray", "noise.rows()", static_cast<long long>(array.noise.rows()),
            "0, or noise as large as the array");
    return has_noise ? Features(array.noise, options) : Features(array.rows, array.cols, options);
  }

  static bool is_refused(const FingerSample<S>& finger) {
    return finger.status == TaxelStatus::other_size || finger.status == TaxelStatus::time_not_later;
  }

  /// Pre-slip of one rule is pre-slip; otherwise both can judge the same fingers.
  static PreslipStatus fused(PreslipStatus a, PreslipStatus b) {
    if (a == PreslipStatus::preslip || b == PreslipStatus::preslip) {
      return PreslipStatus::preslip;
    }
    return a == PreslipStatus::cannot_tell ? b : a;
  }

  std::vector<Features> features_;
  std::vector<typename Features::State> windows_;
  [[no_unique_address]] Stage<Methods::has_grasp_lift, GraspLift> lift_;
  [[no_unique_address]] Stage<Methods::has_grasp_optimise, GraspOptimise> optimise_;
};

}  // namespace v0
}  // namespace fingerpad
