// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/dots.hpp"

#include <cmath>

#include "replay/check/parts.hpp"
#include "replay/dots/file.hpp"

namespace replay {
namespace {

/// Steps between neighbours along rows and columns, and the distance of a dot from the midpoint of
/// its two neighbours in the row, px.
struct Steps {
  std::vector<double> right_x, right_y, down_x, down_y, bend, length;

  explicit Steps(const DotGrid& dots) {
    for (int i = 0; i < dots.rows; ++i) {
      for (int j = 0; j + 1 < dots.cols; ++j) {
        add(dots(i, j + 1) - dots(i, j), right_x, right_y);
        if (j > 0) {
          add_bend(dots(i, j - 1) / 2 + dots(i, j + 1) / 2 - dots(i, j));
        }
      }
    }
    for (int i = 0; i + 1 < dots.rows; ++i) {
      for (int j = 0; j < dots.cols; ++j) {
        add(dots(i + 1, j) - dots(i, j), down_x, down_y);
      }
    }
  }

 private:
  void add(const cv::Vec2d& step, std::vector<double>& x, std::vector<double>& y) {
    if (is_present(step)) {
      x.push_back(step[0]);
      y.push_back(step[1]);
      length.push_back(cv::norm(step));
    }
  }
  void add_bend(const cv::Vec2d& off) {
    if (is_present(off)) {
      bend.push_back(cv::norm(off));
    }
  }
};

/// Checks the order of rows and columns.
void check_order(const std::string& place, const DotGrid& dots, Findings& findings) {
  const Steps steps(dots);
  if (steps.bend.empty() || steps.down_x.empty()) {
    return;
  }
  const cv::Vec2d right(median_of(steps.right_x), median_of(steps.right_y));
  const cv::Vec2d down(median_of(steps.down_x), median_of(steps.down_y));
  if (median_of(steps.bend) > 0.25 * median_of(steps.length)) {
    findings.push_back({place, "the dots of a row are not in the order of their col",
                        "Number the rows and columns in the order in which the dots are printed."});
  } else if (std::abs(right[1]) > std::abs(right[0]) && std::abs(down[0]) > std::abs(down[1])) {
    findings.push_back({place, "the rows of dots run down the frame and the columns run across it",
                        "Check whether row and col, or x_px and y_px, are exchanged."});
  } else if (right[0] * down[1] - right[1] * down[0] < 0) {
    findings.push_back(
        {place, "the dot pattern is mirrored",
         "Number the columns from left to right if the rows are numbered downward."});
  }
}

/// Checks for coordinates that are not pixels of the frame.
bool check_pixels(const std::string& place,
                  const DotGrid& dots,
                  cv::Size frame,
                  Findings& findings) {
  int count = 0, outside = 0, at_zero = 0;
  cv::Vec2d least(1e300, 1e300), most(-1e300, -1e300);
  for (const cv::Vec2d& dot : dots) {
    if (is_present(dot)) {
      ++count;
      outside +=
          dot[0] < -0.5 || dot[1] < -0.5 || dot[0] > frame.width || dot[1] > frame.height ? 1 : 0;
      const bool zero = !(dot[0] < 0 || dot[0] > 0 || dot[1] < 0 || dot[1] > 0);
      at_zero += zero ? 1 : 0;
      least = {std::fmin(least[0], dot[0]), std::fmin(least[1], dot[1])};
      most = {std::fmax(most[0], dot[0]), std::fmax(most[1], dot[1])};
    }
  }
  const double span = std::fmax(most[0] - least[0], most[1] - least[1]);
  const bool tiny = count > 1 && span < 0.1 * (std::min)(frame.width, frame.height);
  if (at_zero > 1) {
    findings.push_back({place, std::to_string(at_zero) + " dots lie at (0, 0)",
                        "Leave out the lines of lost dots."});
    return false;
  }
  if (tiny || 4 * outside > count) {
    findings.push_back({place,
                        "x_px ranges from " + short_number(least[0]) + " to " +
                            short_number(most[0]) + ", but the frames are " +
                            std::to_string(frame.width) + " px wide",
                        most[0] <= 1.5 ? "Give pixels, not fractions of the frame and not m."
                                       : "Give pixels, not mm."});
    return false;
  }
  return true;
}

/// Checks that a dot keeps its row and column from frame to frame.
void check_names(const std::string& place, const std::map<int, DotGrid>& dots, Findings& findings) {
  int moves = 0, leaps = 0;
  const DotGrid* before = nullptr;
  for (const auto& [frame, now] : dots) {
    const double pitch_px = median_of(Steps(now).length);
    for (int k = 0; before != nullptr && k < static_cast<int>(now.total()); ++k) {
      const double move =
          cv::norm(now(k / now.cols, k % now.cols) - (*before)(k / now.cols, k % now.cols));
      moves += std::isfinite(move) ? 1 : 0;
      leaps += move > 0.7 * pitch_px ? 1 : 0;
    }
    before = &now;
  }
  if (10 * leaps > moves) {
    findings.push_back({place,
                        std::to_string(leaps) + " of " + std::to_string(moves) +
                            " displacements between two frames exceed 0.7 dot pitches",
                        "Give a dot the same row and col in all frames."});
  }
}

void check_print(const Recording& recording, Findings& findings) {
  const Dots& print = *recording.sensor.dots;
  const auto side = side_dots_of(recording.sensor, recording.reference);
  if (side && !side->ok()) {
    findings.push_back(
        {"sensor.json, rim.side_dots", side->refusal(),
         "Give count, arc_mm, diameter_mm and first_angle_rad as they are printed."});
  }
  fingerpad::DotFinderOptions options = print_of(recording.sensor, recording.reference_depth, side);
  const double expected_px = options.pattern.pitch_px;
  const int wanted = print.rows * print.cols;
  options.pattern = {};
  const fingerpad::DotFinder finder(recording.reference, options);
  if (!finder.ok()) {
    findings.push_back({recording.sensor.reference_frame, "the image shows " + finder.refusal(),
                        "Use a sharp image of the free pad, or remove \"dots\" from sensor.json."});
    return;
  }
  const double ratio = finder.pattern().pitch_px / expected_px;
  const auto found = static_cast<int>(count_present(finder.free_px()));
  if (!(ratio > 0.85 && ratio < 1.15)) {
    findings.push_back({"sensor.json, dots.pitch_mm",
                        "the dots are " + short_number(finder.pattern().pitch_px) +
                            " px apart in the reference, but sensor.json predicts " +
                            short_number(expected_px) + " px",
                        "Give the pitch in mm on the pad, and check camera.pitch_mm."});
  } else if (finder.rows() > print.rows || finder.cols() > print.cols || 10 * found < 6 * wanted) {
    findings.push_back({"sensor.json, dots.rows and cols",
                        "the pattern is " + std::to_string(print.rows) + " x " +
                            std::to_string(print.cols) + ", but the reference shows " +
                            std::to_string(found) + " dots in " + std::to_string(finder.rows()) +
                            " rows and " + std::to_string(finder.cols()) + " columns",
                        "Give the number of printed rows and columns."});
  }
}

}  // namespace

void check_dots(const std::filesystem::path& folder,
                const Recording& recording,
                Findings& findings) {
  const Sensor& sensor = recording.sensor;
  if (std::filesystem::exists(folder / "dots.csv")) {
    const std::string place = "dots.csv";
    const auto dots = read_dots(folder / "dots.csv", recording.frames.size(), std::nullopt);
    if (check_pixels(place, dots.begin()->second, recording.reference.size(), findings)) {
      check_order(place, dots.begin()->second, findings);
      check_names(place, dots, findings);
    }
  } else if (sensor.dots) {
    check_print(recording, findings);
  } else if (sensor.dots_only) {
    fingerpad::DotFinderOptions options;
    options.pattern.bright = sensor.pattern.bright;
    if (!fingerpad::DotFinder(recording.reference, options).ok()) {
      findings.push_back({"frames", "the image of the free pad shows no grid of 9 or more dots",
                          "Name a sharp image of the free pad as reference.frame in sensor.json."});
    }
  }
}

}  // namespace replay
