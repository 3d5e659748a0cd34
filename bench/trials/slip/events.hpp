// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Evaluates how well a measure per frame separates trials with slip from trials without: over all
// frames, and as a warning before contact is lost.
#include <string>
#include <vector>

namespace slip_trials {

/// The measure of one trial; large values indicate slip.
struct Event {
  std::string object;
  bool slips = false;
  std::vector<double> measure;
  std::size_t end = 0;  ///< the first frame without contact

  double largest() const;
};

/// Area under the ROC curve: the share of pairs of a slipping and a holding trial that their
/// largest values order correctly. A tie counts half. NaN without a pair.
double roc_area(const std::vector<Event>& events);

/// Prints one line for each object, and one for all. The threshold of an object comes from the
/// holds of the other objects. If `own` is a number, the results with this threshold are printed,
/// too.
void print_events(const std::string& name, const std::vector<Event>& events, double own);

}  // namespace slip_trials
