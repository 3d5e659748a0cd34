// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Loss due to the published direction of the pull at the rim, as a function of the stretch of the
// membrane there: 1 / lambda^4 of the load that the rim carries by shear (docs/errata.md, E043).
// The stretch of the scenes' pad is that of the side dots at four pressures; that of the paper's
// pad is computed from the printed figures.
#include <cmath>
#include <cstdio>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "support/finite_elements.hpp"
#include "support/wrench_frames.hpp"
#include "table.hpp"

namespace bench::papers {

/// Stretch along the meridian at the rim of the free pad.
struct RimStretch {
  double pressure_mpa, stretch;
};
inline std::vector<RimStretch> rim_stretches() {
  auto file = test::open_data("rim_free.csv", "");
  std::string line;
  std::getline(file, line);
  std::vector<std::string> names;
  std::istringstream head(line);
  for (std::string name; std::getline(head, name, ',');) {
    names.push_back(name);
  }
  const auto column = [&](const std::string& name) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k].find(name) == 0) {
        return k;
      }
    }
    test::require_data(false, "rim_free.csv has no " + name);
    return names.size();
  };
  const std::size_t at_pressure = column("pressure"), border = column("border_x"),
                    dot = column("dot_x");
  std::vector<RimStretch> all;
  double count = 0;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> numbers;
    for (std::string cell; std::getline(cells, cell, ',');) {
      numbers.push_back(std::stod(cell));
    }
    const double length =
        std::hypot(numbers[dot] - numbers[border], numbers[dot + 1] - numbers[border + 1],
                   numbers[dot + 2] - numbers[border + 2]);
    if (all.empty() || all.back().pressure_mpa != numbers[at_pressure]) {
      all.push_back({numbers[at_pressure], 0});
      count = 0;
    }
    count += 1;
    all.back().stretch += (length / 0.79995 - all.back().stretch) / count;
  }
  return all;
}

/// lambda of a clamped rim under the tension T: T = mu t (lambda - 1 / lambda^3).
inline double stretch_under(double tension_n_per_mm, double modulus_n_per_mm) {
  double low = 1, high = 20;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    const double tension = modulus_n_per_mm * (middle - std::pow(middle, -3));
    (tension < tension_n_per_mm ? low : high) = middle;
  }
  return low;
}

/// Stretch of the length from the rim to the first side dots, averaged over the rim.
inline double mean_stretch(const test::WrenchFrame& frame) {
  const auto rim = test::rim_border();
  double sum = 0;
  for (fingerpad::Index k = 0; k < test::side_dots; ++k) {
    sum += norm(frame.dots(0, k) - rim(0, k)) / 0.79995 / test::side_dots;
  }
  return sum;
}

inline void print_rim(std::ostream& out) {
  out << "### The rim: what the published direction loses, over the stretch\n\n| Pad | Stretch at "
         "the rim | Lost of what shear carries: 1 / lambda^4 |\n|---|--:|--:|\n";
  const auto row = [&](const std::string& pad, double stretch) {
    char three[16];
    std::snprintf(three, sizeof three, "%.3f", stretch);
    out << "| " << pad << " | " << three << " | " << percent(std::pow(stretch, -4)) << " |\n";
  };
  for (const RimStretch& r : rim_stretches()) {
    row("scenes, free, " + number(1000 * r.pressure_mpa) + " kPa", r.stretch);
  }
  for (const auto& f : test::wrench_frames()) {
    if (f.name == "press" || f.name == "drag_b" || f.name == "twist_b") {
      row("scenes, " + f.name, mean_stretch(f));
    }
  }
  // Eq. 18 rises by 0.0191 N per mm^2 of a small contact, F = p S: p = 19 kPa. T = p R / 2. The
  // rubber's 10 Shore A are E = 0.41 MPa by Gent's relation: mu t = 0.14 N/mm of 1 mm.
  const double tension = 0.0191 * 20 / 2;
  row("the papers', 19 kPa (eq. 18), 10 Shore A, 1 mm", stretch_under(tension, 0.138));
  row("the same, were the rubber twice as stiff", stretch_under(tension, 0.276));
  out << '\n';
}

}  // namespace bench::papers
