// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The samples of a foam recording from left to right, and what stands below and across them.
#include <optional>
#include <string>
#include <vector>

#include "replay/foam/step.hpp"
#include "replay/pictures/canvas.hpp"

namespace replay {

/// A round number at or above x > 0: 1, 2 or 5 times a power of ten.
double round_up(double x);

/// The first row with an alarm; none: no row has one.
std::optional<std::size_t> first_alarm(const std::vector<FoamRow>& rows);

/// Colour of a finger's curves.
const Ink& finger_ink(std::size_t finger);

class SampleAxis {
 public:
  /// Ticks are at round times where times only grow, else at round frame numbers.
  SampleAxis(const FoamRecording& recording,
             const std::vector<FoamRow>& rows,
             double left,
             double width);

  /// Middle of the k-th row, counted from 0.
  double x(double k) const { return left_ + width_ * (k + 0.5) / rows_; }
  double left() const { return left_; }
  double right() const { return left_ + width_; }

  /// Numbers and name below `bottom`.
  void paint(Canvas& canvas, double bottom) const;

 private:
  struct Tick {
    double k;
    std::string label;
  };
  void add_times(const std::vector<double>& k, const std::vector<double>& time_s);
  void add_frames(const std::vector<FoamRow>& rows);

  double left_;
  double width_;
  double rows_;
  std::vector<Tick> ticks_;
  std::string name_;
};

}  // namespace replay
