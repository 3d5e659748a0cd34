// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How well a measure, frame by frame, tells trials with slip from trials without: over all frames,
// and as a warning before the contact is gone.
#include <string>
#include <vector>

namespace slip_trials {

/// One trial's measure; large speaks for slip.
struct Event {
  std::string object;
  bool slips = false;
  std::vector<double> measure;
  std::size_t end = 0;  ///< the first frame without contact

  double largest() const;
};

/// Share of the pairs of a slipping and a holding trial that the largest values put in order; a tie
/// is half a pair. NaN where there is no pair.
double roc_area(const std::vector<Event>& events);

/// Prints one line for each object, and one for all of them: each object with the threshold from
/// the others' holds, and with `own` as the threshold where that is a number.
void print_events(const std::string& name, const std::vector<Event>& events, double own);

}  // namespace slip_trials
