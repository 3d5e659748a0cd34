// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The parameters of the stick ratio for a sensor of one's own: delta_0 from the noise of its dots
// (calibrate/slip_noise.hpp, calibration_threshold.hpp), U_min from the same, and U from
// a recording in which slip begins, by the measures S and D (calibration_measures.hpp). Source:
// "Selection of delta_0" and "Selection of U" of 003, corrected: docs/errata.md, E037, E038.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "fingerpad/calibrate/slip_noise.hpp"
#include "fingerpad/calibrate/slip_search.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

/// Runs the stick ratio with all U of the search over a recording, frame by frame as they come.
/// The recording: at least one contact that begins sticking and slips at last, better several.
template <class Motion = StickConsensus<>,
          class Reference = UpdatedReference,
          class Denoising = ResidualMean,
          scalar S = float>
class StickTestCalibration {
  using Estimator = StickRatio<Motion, Reference, Denoising, S>;

 public:
  /// Refuses bad parameters, and noise that leaves no U of the search (parameter_error).
  StickTestCalibration(Index rows,
                       Index cols,
                       const DotNoise& noise,
                       const ReferenceSearch& search = {},
                       const Motion& motion = {},
                       const Reference& reference = {},
                       const Denoising& denoising = {})
      : search_(search) {
    expects_valid(search);
    expects(rows >= 1, "StickTestCalibration", "rows", static_cast<long long>(rows), ">= 1");
    expects(cols >= 1, "StickTestCalibration", "cols", static_cast<long long>(cols), ">= 1");
    const double largest_px = search.largest_px;
    const StickTest largest =
        stick_test_for(rows * cols, noise, largest_px, search, motion, denoising);
    const double min_px = (std::max)(largest.slip_px, largest.store_px);
    for (int k = 0; k < search.candidates; ++k) {
      const double share = static_cast<double>(k) / (search.candidates - 1);
      ReferenceCandidate candidate;
      candidate.test = largest;
      candidate.test.reference_px =
          k + 1 < search.candidates
              ? search.smallest_px * std::pow(largest_px / search.smallest_px, share)
              : largest_px;
      if (candidate.test.reference_px > min_px) {
        const Estimator estimator(rows, cols, candidate.test, motion, reference, denoising);
        runs_.push_back({estimator, estimator.start(), {}, {}, table_.size()});
      }
      table_.push_back(candidate);
    }
    states_.assign(static_cast<std::size_t>(rows * cols), DotState::none);
  }

  /// The next frame; false, and nothing changed, if a grid has another size.
  template <dot_grid Dots, contact_mask Contact>
  bool add(const Dots& dots_px, const Contact& contact, double time_s = not_a_number<double>()) {
    const Index cols = runs_.front().estimator.cols();
    const StridedView<DotState> states(states_.data(), runs_.front().estimator.rows(), cols, cols);
    bool stands = false;  // as the smallest U says
    for (Run& run : runs_) {
      const auto result = run.estimator(dots_px, contact, states, run.state, time_s);
      if (!result.accepted()) {
        return false;
      }
      if (&run == &runs_.front()) {
        const double furthest_px = static_cast<double>(value(result.furthest_px));
        furthest_px_ = (std::max)(furthest_px_, furthest_px);
        stands = result.status == StickStatus::standing;
      }
      const double ratio = static_cast<double>(value(result.stick_ratio));
      if (result.status == StickStatus::restarted || result.status == StickStatus::no_contact) {
        run.ratios.push_back(not_a_number<double>());
        run.costs.push_back(not_a_number<double>());
      } else if (!stands) {
        add_step(is_finite(ratio) ? ratio : 1, result.updated(), run);
      }
    }
    return true;
  }

  /// Refuses recordings that do not tell (parameter_error): of too few frames, without motion, with
  /// too few answers, without stick or without slip.
  StickTestChoice choose() const {
    StickTestChoice choice;
    choice.table = table_;
    choice.furthest_px = furthest_px_;
    for (const Run& run : runs_) {
      choice.table[run.row].ratios = measures_of(std::span<const double>(run.ratios));
      choice.table[run.row].cost = sum_of(run.costs);
    }
    const ReferenceCandidate& first = choice.table[runs_.front().row];
    choice.steps = first.ratios.steps;
    const Run& best = best_run(choice);
    bool chosen = false;
    for (const Run& run : runs_) {
      ReferenceCandidate& candidate = choice.table[run.row];
      compare(run.costs, best.costs, candidate);
      if (candidate.updates < search_.min_updates) {
        candidate.verdict = ReferenceVerdict::rarely_updated;
      } else if (candidate.behind > search_.sampling_errors * candidate.behind_error) {
        candidate.verdict = ReferenceVerdict::worse;
      } else {
        candidate.verdict = chosen ? ReferenceVerdict::as_good : ReferenceVerdict::chosen;
        choice.test = chosen ? choice.test : candidate.test;
        chosen = true;
      }
    }
    return choice;
  }

 private:
  struct Run {
    Estimator estimator;
    typename Estimator::State state;
    std::vector<double> ratios;  ///< of the steps; NaN: no contact
    std::vector<double> costs;   ///< of the steps, likewise
    std::size_t row;             ///< of the table
  };

  void add_step(double ratio, bool updated, Run& run) {
    const double before = run.ratios.empty() ? ratio : run.ratios.back();
    run.ratios.push_back(ratio);
    run.costs.push_back((updated ? ratio : 1) + (before < ratio ? ratio - before : 0));
    ReferenceCandidate& candidate = table_[run.row];
    candidate.updates += updated ? 1 : 0;
    candidate.sticking += updated && ratio > search_.stick_and_slip ? 1 : 0;
    candidate.slipping += updated && ratio < search_.stick_and_slip ? 1 : 0;
  }

  /// The one with the lowest cost of those with enough answers.
  const Run& best_run(const StickTestChoice& choice) const {
    const char* const owner = "StickTestCalibration";
    expects(choice.steps >= search_.min_steps, owner, "frames with contact and motion",
            static_cast<long long>(choice.steps), ">= min_steps");
    const Run* best = nullptr;
    Index max_updates = 0;
    for (const Run& run : runs_) {
      const ReferenceCandidate& candidate = choice.table[run.row];
      max_updates = (std::max)(max_updates, candidate.updates);
      if (candidate.updates >= search_.min_updates) {
        best = best == nullptr || candidate.cost < choice.table[best->row].cost ? &run : best;
      }
    }
    const double smallest_px = choice.table[runs_.front().row].test.reference_px;
    expects(choice.furthest_px > smallest_px, owner, "largest displacement in px",
            choice.furthest_px, "> the smallest U that noise allows: the dots did not move");
    expects(best != nullptr, owner, "updated answers", static_cast<long long>(max_updates),
            ">= min_updates: the dots moved too little in one direction");
    const ReferenceCandidate& row = choice.table[best->row];
    expects(row.sticking >= 3, owner, "answers that stick", static_cast<long long>(row.sticking),
            ">= 3 above stick_and_slip: the recording has to begin sticking");
    expects(row.slipping >= 3, owner, "answers that slip", static_cast<long long>(row.slipping),
            ">= 3 below stick_and_slip: the recording has to slip at last");
    return *best;
  }

  static double sum_of(const std::vector<double>& costs) {
    double sum = 0;
    for (const double cost : costs) {
      sum += is_finite(cost) ? cost : 0;
    }
    return sum;
  }

  /// The frames are the same for both, so their steps are compared one by one.
  static void compare(const std::vector<double>& costs,
                      const std::vector<double>& best,
                      ReferenceCandidate& candidate) {
    double count = 0, sum = 0, squares = 0;
    for (std::size_t k = 0; k < costs.size(); ++k) {
      const double more = costs[k] - best[k];
      count += is_finite(more) ? 1 : 0;
      sum += is_finite(more) ? more : 0;
      squares += is_finite(more) ? more * more : 0;
    }
    const double deviations = squares - sum * sum / count;
    candidate.behind = sum;
    candidate.behind_error = std::sqrt((std::max)(deviations, 0.0) * count / (count - 1));
  }

  ReferenceSearch search_;
  std::vector<ReferenceCandidate> table_;
  std::vector<Run> runs_;  ///< of the candidates that noise allows, smallest U first
  std::vector<DotState> states_;
  double furthest_px_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
