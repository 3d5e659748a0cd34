// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of U of the stick ratio for a given sensor, from a recording in which slip begins.
// delta_0 and U_min, from the noise of the dots, are in slip_noise.hpp. Source: "Selection of U" of
// 003, corrected: docs/errata.md, E038.
//
// Published: "desirable: U, S and D are small", and U = 2.0 px by eye. Here the best U has the
// lowest S + D' (published::measures_of). A step without a new answer counts as ratio 1, because
// slip is not seen in it and an old answer that happens to be low has no merit. U that are worse by
// at most two standard errors are hardly distinguishable; the smallest of them is taken, as it
// answers soonest. D' alone would choose a U so small or so large that slip is never seen. Frames
// in which the pad stands still are not steps, because their number is unrelated to U.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/calibrate/slip_noise.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

/// The chosen U, and the result of each U on the recording.
struct [[nodiscard]] StickTestFit {
  const char* cause = nullptr;  ///< likely mistake
  struct Row {
    StickTest test;
    Index updates = 0;                       ///< frames with a new answer; 0 if U does not exceed
                                             ///< both thresholds and was not tried
    double cost = not_a_number<double>();    ///< S + D', unknown ratios counted as 1
    double behind = not_a_number<double>();  ///< cost less that of the best
    double behind_error = not_a_number<double>();  ///< its sampling error: the standard deviation
                                                   ///< of a sum of as many independent steps
    bool chosen = false;
  };

  StickTest test;          ///< for StickRatio
  std::vector<Row> table;  ///< from the smallest U to the largest
  Index steps = 0;         ///< frames with contact and motion
  double furthest_px = 0;  ///< the largest d_max with the smallest U tried

  bool ok() const { return cause == nullptr; }
};

/// Runs the stick ratio with all U over a recording, frame by frame. The recording needs at least
/// one contact that begins sticking and finally slips; several are better.
template <class Motion = StickConsensus<>,
          class Reference = UpdatedReference,
          class Denoising = ResidualMean,
          scalar S = float>
class StickTestCalibration {
  using Estimator = StickRatio<Motion, Reference, Denoising, S>;
  using Row = StickTestFit::Row;
  static constexpr const char* owner = "StickTestCalibration";
  static constexpr Index min_steps = 20, min_updates = 10;

 public:
  /// Refuses bad parameters, and noise that leaves no U of the search (parameter_error).
  template <scalar N = double>
  StickTestCalibration(Index rows,
                       Index cols,
                       const DotNoise<N>& noise,
                       const StickTestOptions& options = {},
                       const Motion& motion = {},
                       const Reference& reference = {},
                       const Denoising& denoising = {}) {
    expects_valid(options);
    expects_grid_size(owner, rows, cols);
    const double largest_px = options.largest_px;
    const StickTest largest =
        stick_test_for(rows * cols, noise, largest_px, options, motion, denoising);
    const double ratio = largest_px / options.smallest_px;
    for (int k = 0; k < options.candidates; ++k) {
      Row row{largest};
      if (k + 1 < options.candidates) {
        const double share = static_cast<double>(k) / (options.candidates - 1);
        row.test.reference = options.smallest_px * std::pow(ratio, share);
      }
      if (row.test.reference > (std::max)(largest.slip, largest.store)) {
        const Estimator estimator(rows, cols, row.test, motion, reference, denoising);
        runs_.push_back({estimator, estimator.start(), table_.size()});
      }
      table_.push_back(row);
    }
    states_.assign(static_cast<std::size_t>(rows * cols), DotState::none);
  }

  /// The next frame; false, and nothing changed, if a grid has another size.
  template <dot_grid Dots, contact_mask Contact>
  bool add(const Dots& dots_px, const Contact& contact, double time_s = not_a_number<double>()) {
    const Index cols = runs_.front().estimator.cols();
    const StridedView<DotState> states(states_.data(), runs_.front().estimator.rows(), cols, cols);
    bool stands = false;  // by the smallest U
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
      if (result.status == StickStatus::restarted || result.status == StickStatus::no_contact) {
        run.before = not_a_number<double>();
        run.costs.push_back(run.before);
      } else if (!stands) {
        const double ratio = static_cast<double>(value(result.stick_ratio));
        add_step(is_finite(ratio) ? ratio : 1, result.updated(), run);
      }
    }
    return true;
  }

  /// Chooses U. Refuses recordings with fewer than 20 frames with motion, fewer than 10 answers,
  /// fewer than three answers that stick or fewer than three that slip (parameter_error).
  StickTestFit fit() const {
    StickTestFit fit;
    fit.table = table_;
    fit.furthest_px = furthest_px_;
    for (const Run& run : runs_) {
      double& cost = fit.table[run.row].cost = 0;
      for (const double c : run.costs) {
        cost += is_finite(c) ? c : 0;
      }
    }
    for (const double c : runs_.front().costs) {
      fit.steps += is_finite(c) ? 1 : 0;
    }
    const Run& best = best_run(fit);
    bool chosen = false;
    for (const Run& run : runs_) {
      Row& row = fit.table[run.row];
      compare(run.costs, best.costs, row);
      row.chosen = !chosen && row.updates >= min_updates && !(row.behind > 2 * row.behind_error);
      fit.test = row.chosen ? row.test : fit.test;
      chosen = chosen || row.chosen;
    }
    const bool at_start = &best == &runs_.front() && best.row == 0;  // not limited by noise
    const bool at_end = runs_.size() > 1 && (&best == &runs_.back() || at_start);
    fit.cause = at_end ? cause::at_end_of_search : nullptr;
    return fit;
  }

 private:
  struct Run {
    Estimator estimator;
    typename Estimator::State state;
    std::size_t row;                         ///< of the table
    std::vector<double> costs = {};          ///< of the steps; NaN: no contact
    double before = not_a_number<double>();  ///< the ratio of the last step
    Index sticking = 0;                      ///< answers above 0.5
    Index slipping = 0;                      ///< answers below 0.5
  };

  void add_step(double ratio, bool updated, Run& run) {
    run.costs.push_back((updated ? ratio : 1) + (run.before < ratio ? ratio - run.before : 0));
    run.before = ratio;
    table_[run.row].updates += updated ? 1 : 0;
    run.sticking += updated && ratio > 0.5 ? 1 : 0;
    run.slipping += updated && ratio < 0.5 ? 1 : 0;
  }

  /// The run with the lowest cost among those with enough answers.
  const Run& best_run(const StickTestFit& fit) const {
    expects(fit.steps >= min_steps, owner, "frames with contact and motion",
            static_cast<long long>(fit.steps), ">= 20");
    const Run* best = nullptr;
    Index max_updates = 0;
    for (const Run& run : runs_) {
      const Row& row = fit.table[run.row];
      max_updates = (std::max)(max_updates, row.updates);
      if (row.updates >= min_updates) {
        best = best == nullptr || row.cost < fit.table[best->row].cost ? &run : best;
      }
    }
    const double smallest_px = fit.table[runs_.front().row].test.reference;
    expects(fit.furthest_px > smallest_px, owner, "largest displacement in px", fit.furthest_px,
            "> the smallest U that noise allows: the dots did not move");
    expects(best != nullptr, owner, "updated answers", static_cast<long long>(max_updates),
            ">= 10: the dots moved too little in one direction");
    expects(best->sticking >= 3, owner, "answers that stick",
            static_cast<long long>(best->sticking),
            ">= 3 above 0.5: the recording must begin with sticking");
    expects(best->slipping >= 3, owner, "answers that slip", static_cast<long long>(best->slipping),
            ">= 3 below 0.5: the recording must end with slip");
    return *best;
  }

  /// Compares costs step by step, since both runs have the same frames.
  static void compare(const std::vector<double>& costs, const std::vector<double>& best, Row& row) {
    double count = 0, sum = 0, squares = 0;
    for (std::size_t k = 0; k < costs.size(); ++k) {
      const double more = costs[k] - best[k];
      count += is_finite(more) ? 1 : 0;
      sum += is_finite(more) ? more : 0;
      squares += is_finite(more) ? more * more : 0;
    }
    const double deviations = squares - sum * sum / count;
    row.behind = sum;
    row.behind_error = std::sqrt((std::max)(deviations, 0.0) * count / (count - 1));
  }

  std::vector<Row> table_;
  std::vector<Run> runs_;  ///< one for each U that noise allows, smallest first
  std::vector<DotState> states_;
  double furthest_px_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
