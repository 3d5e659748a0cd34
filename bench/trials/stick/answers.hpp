// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The answers of stick ratio and friction limit on a recording, against the truth.
#include <cstdint>

#include "recording.hpp"

namespace stick_table {

struct Conditions {
  double noise_px = 0;          ///< added to the dots that were found; five times it to their depth
  bool noise_is_given = false;  ///< to the stick ratio
  int every = 1;                ///< frame is seen
  std::uint64_t seed = 1;
  bool prints_each = false;
};

struct Answers {
  int asked = 0, told = 0, kept = 0, far_apart = 0;
  int missed = 0;   ///< slides: told above 0.5, true below 0.2
  int falsely = 0;  ///< told below 0.5, true above 0.8
  int within_2_sd = 0, within_5_sd = 0;
  double error = 0, sd = 0;  ///< sums

  double mean_error() const { return told > 0 ? error / told : 0; }
  double mean_sd() const { return told > 0 ? sd / told : 0; }
  Answers& operator+=(const Answers& o);
};

/// Runs the dots through StickRatio and FrictionLimit.
Answers answers(const Recording& recording, const Conditions& conditions);

}  // namespace stick_table
