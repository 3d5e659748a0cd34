// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Repeats calibrations ten thousand times, in units of five hundred:
//   DIR/resamples/NAME/KIND/FIRST-LAST.csv  one line per resample; the unit is done if this exists
//   DIR/covariance.csv                      of all parameters, beside that reported by the fits
#include <string>
#include <vector>

#include "durable.hpp"
#include "engine.hpp"

namespace replay_many {

class Resampling {
 public:
  /// `names` from trial_names(), or empty for all. Throws replay::Failure for other names.
  Resampling(Path out, std::vector<std::string> names, int resamples);

  std::vector<Unit> left() const;
  Job job() const;
  /// Throws replay::Failure if a unit is not done.
  void write_covariance() const;

 private:
  std::vector<Path> files(const std::string& name, const std::string& kind) const;

  Path out_;
  std::vector<std::string> names_;
  int resamples_;
};

/// Runs a unit: "resamples" NAME OUT KIND FIRST LAST FILE. Throws replay::Failure.
void do_resamples(const std::vector<std::string>& arguments);

}  // namespace replay_many
