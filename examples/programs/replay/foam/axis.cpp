// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/axis.hpp"

#include <algorithm>
#include <cmath>

#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

constexpr double max_ticks = 10;
constexpr double long_ago_s = 1e5;  // from here on times count as calendar times

}  // namespace

double round_up(double x) {
  const double decade = std::pow(10, std::floor(std::log10(x)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * decade >= x * (1 - 1e-9)) {
      return digit * decade;
    }
  }
  return 10 * decade;
}

std::optional<std::size_t> first_alarm(const std::vector<FoamRow>& rows) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [](const FoamRow& row) { return row.alarm.any(); });
  return found == rows.end() ? std::nullopt
                             : std::optional<std::size_t>(std::size_t(found - rows.begin()));
}

const Ink& finger_ink(std::size_t finger) {
  static const Ink inks[max_fingers] = {
      {180, 110, 30}, {60, 140, 40}, {30, 140, 230}, {150, 60, 140}, {110, 110, 20}};
  return inks[finger % max_fingers];
}

SampleAxis::SampleAxis(const FoamRecording& recording,
                       const std::vector<FoamRow>& rows,
                       double left,
                       double width)
    : left_(left), width_(width), rows_(static_cast<double>(rows.size())) {
  std::vector<double> k;
  std::vector<double> time_s;
  bool only_grows = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].was_taken()) {
      const double now_s = recording.table.times_s[static_cast<std::size_t>(rows[i].sample)];
      only_grows = only_grows && (time_s.empty() || now_s > time_s.back());
      k.push_back(static_cast<double>(i));
      time_s.push_back(now_s);
    }
  }
  if (only_grows && time_s.size() > 1) {
    add_times(k, time_s);
  } else {
    add_frames(rows);
  }
}

void SampleAxis::add_times(const std::vector<double>& k, const std::vector<double>& time_s) {
  const bool is_calendar = std::abs(time_s.front()) >= long_ago_s;
  const double zero_s = is_calendar ? time_s.front() : 0;
  name_ = is_calendar ? "time since the first sample, s" : "time, s";
  const double step_s = round_up((time_s.back() - time_s.front()) / max_ticks);
  std::size_t i = 1;
  double number = std::ceil((time_s.front() - zero_s) / step_s - 1e-9);
  for (; zero_s + number * step_s <= time_s.back(); ++number) {
    const double at_s = zero_s + number * step_s;
    while (i + 1 < time_s.size() && time_s[i] < at_s) {
      ++i;
    }
    const double share = (at_s - time_s[i - 1]) / (time_s[i] - time_s[i - 1]);
    ticks_.push_back({k[i - 1] + share * (k[i] - k[i - 1]), format("%.6g", number * step_s + 0.0)});
  }
}

void SampleAxis::add_frames(const std::vector<FoamRow>& rows) {
  name_ = "frame";
  const double step = (std::max)(1.0, round_up(rows_ / max_ticks));
  for (double k = 0; k < rows_; k += step) {
    ticks_.push_back({k, std::to_string(rows[static_cast<std::size_t>(k)].frame)});
  }
}

void SampleAxis::paint(Canvas& canvas, double bottom) const {
  for (const Tick& tick : ticks_) {
    canvas.line({x(tick.k), bottom}, {x(tick.k), bottom + 4}, 0.8, ink::grey);
    canvas.text({x(tick.k), bottom + 18}, tick.label, letter, ink::grey, Align::center);
  }
  canvas.text({(left() + right()) / 2, bottom + 40}, name_, letter, ink::grey, Align::center);
}

}  // namespace replay
