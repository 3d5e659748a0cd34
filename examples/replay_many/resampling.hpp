// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibrations done ten thousand times, in units of five hundred:
//   DIR/resamples/NAME/KIND/FIRST-LAST.csv  a line a resample; done when it is there
//   DIR/covariance.csv                      of all parameters, beside what the fits say themselves
#include <string>
#include <vector>

#include "durable.hpp"
#include "engine.hpp"

namespace replay_many {

class Resampling {
 public:
  /// `names` as in trial_names(); none: all. Throws replay::Failure for others.
  Resampling(Path out, std::vector<std::string> names, int resamples);

  std::vector<Unit> left() const;
  Job job() const;
  /// Throws replay::Failure where something is not done.
  void write_covariance() const;

 private:
  std::vector<Path> files(const std::string& name, const std::string& kind) const;

  Path out_;
  std::vector<std::string> names_;
  int resamples_;
};

/// The work of one process: "resamples" NAME OUT KIND FIRST LAST FILE. Throws replay::Failure.
void do_resamples(const std::vector<std::string>& arguments);

}  // namespace replay_many
