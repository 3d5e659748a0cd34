// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames of synthetic contacts, and the difference between two columns of results.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "fingerpad/core/grid.hpp"

namespace bench {

/// Columns: measure in [1, largest], displacement in x and y in mm, angle in rad.
template <class S>
struct Contacts {
  static constexpr fingerpad::Index frames = 4096;
  std::vector<S> cells = std::vector<S>(static_cast<std::size_t>(4 * frames));

  explicit Contacts(double largest) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(0, 1);
    for (fingerpad::Index k = 0; k < frames; ++k) {
      at(k, 0) = S(1 + (largest - 1) * share(random));
      at(k, 1) = S(2 * share(random) - 1);
      at(k, 2) = S(2 * share(random) - 1);
      at(k, 3) = S(0.2 * share(random) - 0.1);
    }
  }
  S& at(fingerpad::Index frame, fingerpad::Index column) {
    return cells[static_cast<std::size_t>(column * frames + frame)];
  }
};

/// Differences relative to the largest value of `truth`.
template <class S>
std::vector<double> share_errors(const std::vector<S>& found,
                                 const std::vector<long double>& truth) {
  long double largest = 0;
  for (const long double& value : truth) {
    largest = (std::max)(largest, std::abs(value));
  }
  std::vector<double> errors;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const long double difference = static_cast<long double>(found[k]) - truth[k];
    errors.push_back(static_cast<double>(std::abs(difference) / largest));
  }
  return errors;
}

}  // namespace bench
