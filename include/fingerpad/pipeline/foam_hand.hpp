// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects pre-slip from the readings of foam fingers. One object computes the features of each
// finger and applies the rules over all fingers. It only combines the methods of foam/.
//
//   FoamHand<2> hand(options);  // allocates all memory, refuses bad parameters
//
//   auto felt = hand(std::array{left, right}, time_s);  // every sample
//
//   if (felt.status == PreslipStatus::preslip) { ... }
#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/several_arrays.hpp"
#include "fingerpad/foam/taxel_features.hpp"

namespace fingerpad {
inline namespace v0 {

/// The rules of a hand and their methods. Derive from it and override what differs. A rule that is
/// false is not instantiated and costs nothing.
///   struct WhileLoosening : FoamHandMethods {
///     static constexpr bool has_grasp_optimise = true;
///   };
struct FoamHandMethods {
  static constexpr bool has_grasp_lift = true;  ///< slip of any finger
  /// Slip of all fingers at once, as in the paper's first experiment.
  static constexpr bool has_grasp_optimise = false;
  static constexpr std::size_t arrays = 1;  ///< number of arrays of each finger
  using Scalar = double;
};

/// One array of a finger.
struct FoamArray {
  Index rows = 0;
  Index cols = 0;
  /// Standard deviation of each taxel at rest; NaN: dead. Empty: the noise of the options for all
  /// taxels.
  StridedView<const double> noise = {};
  /// Position of the first taxel in the unrolled plan of the finger's sides.
  Point2<double> place_mm = {0, 0};
};

/// Everything that is known of a hand before its first sample.
template <std::size_t Arrays = 2, scalar S = double>
struct FoamHandOptions {
  std::array<FoamArray, Arrays> arrays = {};  ///< finger by finger
  TaxelOptions<S> taxels = {};
  PreslipOptions<S> rules = {};
};

/// The results of a sample. A rule that is switched off leaves the default: cannot tell.
template <std::size_t Fingers = 2, scalar S = double>
struct [[nodiscard]] FoamHandResult {
  PreslipStatus status = PreslipStatus::cannot_tell;  ///< of all rules combined: act on this one
  std::array<FingerSample<S>, Fingers> fingers = {};
  PreslipResult grasp_lift = {};
  PreslipResult grasp_optimise = {};

  /// Whether the fingers could be judged.
  bool ok() const { return status != PreslipStatus::cannot_tell; }
};

/// Pre-slip detector of one hand. Do not share it between threads: a sample changes the windows and
/// the history. A sample allocates nothing, throws nothing, and takes O(taxels + history) time.
template <std::size_t Fingers = 2, class Methods = FoamHandMethods>
class FoamHand {
  using S = typename Methods::Scalar;
  using Features = TaxelFeatures<S>;
  static constexpr std::size_t arrays_each = Methods::arrays;
  static constexpr std::size_t all_arrays = Fingers * arrays_each;

 public:
  using Options = FoamHandOptions<all_arrays, S>;
  using Result = FoamHandResult<Fingers, S>;

  /// Refuses bad parameters (parameter_error).
  explicit FoamHand(const Options& options) : lift_(options.rules), optimise_(options.rules) {
    for (std::size_t k = 0; k < all_arrays; ++k) {
      const FoamArray& array = options.arrays[k];
      features_.push_back(features_of(array, options.taxels));
      windows_.push_back(features_.back().start());
      auto& finger = fingers_[k / arrays_each];
      finger.taxels[k % arrays_each] = array.rows * array.cols;
      finger.places_mm[k % arrays_each] = {S(array.place_mm.x), S(array.place_mm.y)};
    }
  }

  /// Processes one sample: the readings of each array, in the order of the options, and the time
  /// when they were received. The rules ignore a sample that a finger refuses for its size or time.
  template <grid Readings>
  Result operator()(const std::array<Readings, all_arrays>& readings, double time_s) {
    Result felt;
    for (std::size_t f = 0; f < Fingers; ++f) {
      felt.fingers[f] = finger(f, readings, time_s);
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

  /// All taxels of an array that vibrate in the newest sample.
  auto vibrating(std::size_t array) const { return windows_[array].vibrating(); }

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

  /// Sizes and positions of the arrays of a finger.
  struct FingerPlan {
    std::array<Index, arrays_each> taxels = {};
    std::array<Point2<S>, arrays_each> places_mm = {};
  };

  template <grid Readings>
  FingerSample<S> finger(std::size_t f,
                         const std::array<Readings, all_arrays>& readings,
                         double time_s) {
    if constexpr (arrays_each == 1) {
      return features_[f](readings[f], time_s, windows_[f]);
    } else {
      std::array<FingerSample<S>, arrays_each> arrays;
      for (std::size_t k = 0; k < arrays_each; ++k) {
        const std::size_t at = f * arrays_each + k;
        arrays[k] = features_[at](readings[at], time_s, windows_[at]);
      }
      return finger_of(arrays, fingers_[f].places_mm, fingers_[f].taxels);
    }
  }

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

  /// Pre-slip of one rule is pre-slip; otherwise the rules agree, unless one is switched off.
  static PreslipStatus fused(PreslipStatus a, PreslipStatus b) {
    if (a == PreslipStatus::preslip || b == PreslipStatus::preslip) {
      return PreslipStatus::preslip;
    }
    return a == PreslipStatus::cannot_tell ? b : a;
  }

  std::vector<Features> features_;
  std::vector<typename Features::State> windows_;
  std::array<FingerPlan, Fingers> fingers_ = {};
  [[no_unique_address]] Stage<Methods::has_grasp_lift, GraspLift> lift_;
  [[no_unique_address]] Stage<Methods::has_grasp_optimise, GraspOptimise> optimise_;
};

}  // namespace v0
}  // namespace fingerpad
