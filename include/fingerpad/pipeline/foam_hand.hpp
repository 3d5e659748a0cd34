// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects pre-slip from the readings of foam fingers. One object computes the features of each
// finger and applies a rule over all fingers. It only combines the methods of foam/.
//
//   const TaxelFeatures<> finger(16, 4, options);
//   FoamHand<> hand({finger, finger});  // allocates all memory, refuses bad parameters
//
//   const auto status = hand(std::array{left, right}, time_s);  // every sample
//
//   if (status == PreslipStatus::preslip) { ... }
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxels.hpp"

namespace fingerpad {
inline namespace v1 {

/// Pre-slip detector of one hand. It keeps the windows of its fingers and the history of the rule:
/// one object a hand; copy it to return to this sample later. A sample allocates nothing, throws
/// nothing, and takes O(taxels window + history) time.
template <scalar S = double>
class FoamHand {
 public:
  /// A hand of 1 to 100 fingers, each with its taxels. Refuses bad parameters (parameter_error).
  explicit FoamHand(std::vector<TaxelFeatures<S>> fingers, const PreslipOptions& rule = {})
      : features_(std::move(fingers)),
        samples_(features_.size()),
        rule_(static_cast<Index>(features_.size()), rule) {}

  /// Processes one sample: the readings of each finger, in the order of the constructor, and the
  /// time when they were received. `readings` is an array or a vector of grids. A sample that a
  /// finger refuses, or of another number of fingers, is `cannot_tell`.
  template <class Readings>
  PreslipStatus operator()(const Readings& readings, double time_s) {
    if (readings.size() != features_.size()) {
      return PreslipStatus::cannot_tell;
    }
    for (std::size_t f = 0; f < features_.size(); ++f) {
      samples_[f] = features_[f](readings[f], time_s);
    }
    return rule_(samples_);
  }

  /// What the fingers felt in the newest sample.
  std::span<const FingerSample<S>> fingers() const { return samples_; }

  /// Forgets all samples: the next one is the first.
  void reset() {
    for (TaxelFeatures<S>& finger : features_) {
      finger.reset();
    }
    rule_.reset();
  }

 private:
  std::vector<TaxelFeatures<S>> features_;
  std::vector<FingerSample<S>> samples_;
  Preslip<S> rule_;
};

}  // namespace v1
}  // namespace fingerpad
