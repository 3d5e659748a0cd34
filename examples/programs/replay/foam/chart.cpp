// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/chart.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fingerpad/foam/preslip.hpp"
#include "replay/foam/axis.hpp"
#include "replay/pictures/canvas.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

constexpr double left = 84;
constexpr double width = 660;

/// Vertical range of a panel.
struct Panel {
  double top_px;
  double height_px;
  double highest;  ///< value at the upper edge; 0 at the lower
  double tick;

  Panel(double y, double height, double largest, double min_tick)
      : top_px(y),
        height_px(height),
        tick((std::max)(min_tick, round_up((std::max)(largest, 1e-12) / 4))) {
    highest = tick * (std::max)(1.0, std::ceil(largest / tick - 1e-9));
  }
  double bottom_px() const { return top_px + height_px; }
  double y(double value) const { return bottom_px() - height_px * value / highest; }
};

/// A value of one finger in a row. NaN if unknown, which makes a gap in the curve.
using Value = double (*)(const fingerpad::FingerSample<double>& finger);

double sum_of(const fingerpad::FingerSample<double>& finger) {
  return finger.status == fingerpad::TaxelStatus::refused ? std::nan("") : finger.sum;
}

double waves_of(const fingerpad::FingerSample<double>& finger) {
  const bool is_known = finger.status == fingerpad::TaxelStatus::vibrating ||
                        finger.status == fingerpad::TaxelStatus::quiet;
  return is_known ? static_cast<double>(finger.waves) : std::nan("");
}

double largest_of(const std::vector<FoamRow>& rows, Value value) {
  double largest = 0;
  for (const FoamRow& row : rows) {
    for (const auto& finger : row.fingers) {
      const double now = value(finger);
      largest = std::isfinite(now) ? (std::max)(largest, now) : largest;
    }
  }
  return largest;
}

void paint_curves(Canvas& canvas,
                  const SampleAxis& axis,
                  const Panel& panel,
                  const char* title,
                  const std::vector<FoamRow>& rows,
                  Value value) {
  canvas.text({left, panel.top_px - 12}, title, letter, ink::black, Align::left, true);
  for (double at = 0; at < panel.highest + panel.tick / 2; at += panel.tick) {
    canvas.line({axis.left(), panel.y(at)}, {axis.right(), panel.y(at)}, 0.6, ink::pale);
    canvas.text({axis.left() - 8, panel.y(at) + letter / 2}, format("%g", at), letter, ink::grey,
                Align::right);
  }
  for (std::size_t f = 0; f < rows.front().fingers.size(); ++f) {
    std::vector<Spot> spots;
    for (std::size_t k = 0; k <= rows.size(); ++k) {
      const double now = k < rows.size() ? value(rows[k].fingers[f]) : std::nan("");
      if (std::isfinite(now)) {
        spots.emplace_back(axis.x(static_cast<double>(k)), panel.y(now));
      } else {
        canvas.curve(spots, 1.6, finger_ink(f));
        spots.clear();
      }
    }
  }
}

void paint_legend(Canvas& canvas, std::size_t fingers, double y) {
  for (std::size_t f = 0; fingers > 1 && f < fingers; ++f) {
    const double x = left + width + 16;
    const double at = y + 8 + 20 * static_cast<double>(f);
    canvas.line({x, at}, {x + 20, at}, 1.6, finger_ink(f));
    canvas.text({x + 28, at + letter / 2}, "finger " + std::to_string(f), letter, ink::black);
  }
}

/// Paints a bar at each sample that completes a pair of the rule.
void paint_rule(Canvas& canvas,
                const SampleAxis& axis,
                double y,
                const char* name,
                const std::vector<FoamRow>& rows,
                bool FoamAlarm::*rule) {
  constexpr double half_px = 9;
  const double half_width = (std::max)(0.6, (axis.x(1) - axis.x(0)) / 2);
  canvas.line({axis.left(), y + half_px}, {axis.right(), y + half_px}, 0.6, ink::pale);
  long long alarms = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].alarm.*rule) {
      const double x = axis.x(static_cast<double>(k));
      canvas.polygon({{x - half_width, y - half_px},
                      {x + half_width, y - half_px},
                      {x + half_width, y + half_px},
                      {x - half_width, y + half_px}},
                     ink::accent);
      ++alarms;
    }
  }
  canvas.text({axis.left(), y - half_px - 6}, name, letter, ink::black);
  canvas.text({axis.right() + 16, y + letter / 2}, format("%lld samples", alarms), letter,
              ink::grey);
}

}  // namespace

cv::Mat foam_chart(const std::string& title,
                   const FoamRecording& recording,
                   const std::vector<FoamRow>& rows) {
  const FoamSensor& sensor = recording.sensor;
  const SampleAxis axis(recording, rows, left, width);
  const Panel sums(98, 190, largest_of(rows, sum_of), 0);
  const Panel waves(sums.bottom_px() + 54, 130, largest_of(rows, waves_of), 1);
  const double first_rule = waves.bottom_px() + 88;
  const double rules = (sensor.grasp_lift ? 1 : 0) + (sensor.grasp_optimise ? 1 : 0);
  const double bottom = first_rule + 50 * (rules - 1) + 16;
  Canvas canvas(left + width + 136, bottom + 56);
  canvas.text({28, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  const auto alarm = first_alarm(rows);
  if (alarm) {
    const double x = axis.x(static_cast<double>(*alarm));
    for (const auto& [from, to] :
         {std::pair(sums.top_px - 26, sums.bottom_px()), std::pair(waves.top_px, waves.bottom_px()),
          std::pair(first_rule - 9, bottom)}) {
      canvas.line({x, from}, {x, to}, 1.0, ink::accent);
    }
    const bool is_right = x > left + width / 2;
    canvas.text({x + (is_right ? -6 : 6), sums.top_px - 28 + letter},
                "first alarm" + (rows[*alarm].time_s.empty()
                                     ? ""
                                     : format(", %.10g s", std::stod(rows[*alarm].time_s))),
                letter, ink::accent, is_right ? Align::right : Align::left);
  }
  paint_curves(canvas, axis, sums,
               recording.sensor.newton_per_unit.empty() ? "sum of the readings" : "force [N]", rows,
               sum_of);
  paint_legend(canvas, rows.front().fingers.size(), sums.top_px);
  paint_curves(canvas, axis, waves, "waves in the window of the strongest vibrating taxel", rows,
               waves_of);
  canvas.text({left, first_rule - 40}, "samples with an alarm of a rule", letter, ink::black,
              Align::left, true);
  double y = first_rule;
  if (sensor.grasp_lift) {
    paint_rule(canvas, axis, y, name_of(fingerpad::PreslipRule::grasp_lift), rows,
               &FoamAlarm::grasp_lift);
    y += 50;
  }
  if (sensor.grasp_optimise) {
    paint_rule(canvas, axis, y, name_of(fingerpad::PreslipRule::grasp_optimise), rows,
               &FoamAlarm::grasp_optimise);
  }
  axis.paint(canvas, bottom);
  return canvas.finished();
}

}  // namespace replay
