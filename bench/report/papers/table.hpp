// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rows of docs/papers.md: the printed figure of a paper, compared with the results of the published
// method and of the default in the nearest experiment here.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

namespace bench::papers {

struct Row {
  std::string experiment;  ///< the paper's
  std::string figure;      ///< the measured quantity and its unit
  std::string printed;     ///< by the paper
  std::string published;   ///< by the published method, here
  std::string ours;        ///< by the default, here
  std::string nearest;     ///< the experiment here
};

/// A section with its table.
struct Section {
  std::string title;
  std::vector<Row> rows;
};

inline void print(std::ostream& out, const Section& section) {
  out << "### " << section.title
      << "\n\n| Their experiment | Figure | Printed | Published method here | Default here | The "
         "experiment here |\n|---|---|--:|--:|--:|---|\n";
  for (const Row& r : section.rows) {
    out << "| " << r.experiment << " | " << r.figure << " | " << r.printed << " | " << r.published
        << " | " << r.ours << " | " << r.nearest << " |\n";
  }
  out << '\n';
}

/// Two significant digits, and at least one decimal below 10.
inline std::string number(double x) {
  char text[32];
  const double size = std::abs(x);
  const int after = size >= 9.95 ? 0 : size >= 0.995 ? 1 : size >= 0.0995 ? 2 : 3;
  std::snprintf(text, sizeof text, "%.*f", after, x);
  return text;
}
inline std::string percent(double share) {
  return number(100 * share) + " %";
}

/// Statistics of absolute values.
struct Spread {
  double mean = 0, sd = 0, worst = 0;

  explicit Spread(const std::vector<double>& errors) {
    double squares = 0;
    for (const double e : errors) {
      mean += std::abs(e);
      squares += e * e;
      worst = (std::max)(worst, std::abs(e));
    }
    const double count = static_cast<double>(errors.size());
    mean /= count;
    sd = std::sqrt((std::max)(squares / count - mean * mean, 0.0));
  }
  std::string mean_and_sd() const { return number(mean) + " / " + number(sd); }
  std::string mean_and_worst() const { return number(mean) + " / " + number(worst); }
  /// Mean and worst value relative to a full scale.
  std::string shares(double full_scale) const {
    return percent(mean / full_scale) + " / " + percent(worst / full_scale);
  }
};

}  // namespace bench::papers
