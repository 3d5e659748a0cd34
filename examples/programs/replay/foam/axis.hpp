// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The horizontal axis of pictures of a foam recording: one position per sample, with ticks.
#include <optional>
#include <string>
#include <vector>

#include "replay/foam/step.hpp"
#include "replay/pictures/canvas.hpp"

namespace replay {

/// A round number at or above x > 0: 1, 2 or 5 times a power of ten.
double round_up(double x);

/// Index of the first row with an alarm; empty without alarm.
std::optional<std::size_t> first_alarm(const std::vector<FoamRow>& rows);

/// Colour of a finger's curves.
const Ink& finger_ink(std::size_t finger);

class SampleAxis {
 public:
  /// Ticks are at round times if the times increase monotonically, else at round frame numbers.
  SampleAxis(const FoamRecording& recording,
             const std::vector<FoamRow>& rows,
             double left,
             double width);

  /// Middle of the k-th row, counted from 0.
  double x(double k) const { return left_ + width_ * (k + 0.5) / rows_; }
  double left() const { return left_; }
  double right() const { return left_ + width_; }

  /// Paints tick labels and the axis title below `bottom`.
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
