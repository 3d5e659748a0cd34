// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A chart of two runs over time: load, grip force, stick ratio and slip.
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace grip {

/// One frame of a run.
struct Moment {
  double time_s;
  double load_n;
  double friction_n;  ///< the largest load that friction can bear
  double force_n;     ///< grip force
  double stick_ratio;
  double slip_mm;
};
using Run = std::vector<Moment>;

namespace chart {

using replay::Align;
using replay::Canvas;
using replay::Ink;
using replay::Spot;
namespace ink = replay::ink;
constexpr double letter = replay::letter;
inline const Ink controlled(180, 110, 30);
inline const Ink constant(48, 40, 214);

struct Curve {
  const Run* run;
  double Moment::*value;
  Ink colour;
  bool dashed;
};

struct Panel {
  std::string title;
  double tick;
  std::vector<Curve> curves;

  /// The first tick that no curve exceeds.
  double top() const {
    double highest = 0;
    for (const Curve& curve : curves) {
      for (const Moment& m : *curve.run) {
        highest = m.*curve.value > highest ? m.*curve.value : highest;
      }
    }
    return tick * std::ceil(highest / tick);
  }
};

inline void paint(Canvas& canvas, const cv::Rect2d& box, const Panel& panel, double last_s) {
  const double top = panel.top();
  const auto x_of = [&](double time_s) { return box.x + box.width * time_s / last_s; };
  const auto y_of = [&](double v) { return box.y + box.height * (1 - v / top); };
  canvas.text({box.x, box.y - 13}, panel.title, letter, ink::black, Align::left, true);
  for (double v = 0; v < top + panel.tick / 2; v += panel.tick) {
    canvas.line({box.x, y_of(v)}, {box.x + box.width, y_of(v)}, 0.6, ink::pale);
    canvas.text({box.x - 8, y_of(v) + letter / 2}, replay::format("%g", v), letter, ink::grey,
                Align::right);
  }
  for (double t = 0; t <= last_s; t += 2) {
    canvas.line({x_of(t), box.y}, {x_of(t), box.y + box.height}, 0.6, ink::pale);
    canvas.text({x_of(t), box.y + box.height + 18}, replay::format("%g", t), letter, ink::grey,
                Align::center);
  }
  for (const Curve& curve : panel.curves) {
    std::vector<Spot> spots;
    for (const Moment& m : *curve.run) {
      if (const double v = m.*curve.value; std::isfinite(v)) {
        spots.emplace_back(x_of(m.time_s), y_of(v));
      }
    }
    curve.dashed ? canvas.dashed_curve(spots, 1.6, curve.colour)
                 : canvas.curve(spots, 1.9, curve.colour);
  }
}

/// A label beside a sample of its curve.
inline void legend(
    Canvas& canvas, Spot at, const Ink& colour, bool dashed, const std::string& word) {
  const std::vector<Spot> sample = {at, {at.x + 30, at.y}};
  dashed ? canvas.dashed_curve(sample, 1.6, colour) : canvas.curve(sample, 1.9, colour);
  canvas.text({at.x + 38, at.y + letter / 2}, word, letter, ink::black);
}

}  // namespace chart

inline cv::Mat grip_chart(const Run& with, const Run& without, double set_point) {
  using namespace chart;
  const double last_s = std::ceil(with.back().time_s);
  const Run goal = {{0, 0, 0, 0, set_point, 0}, {last_s, 0, 0, 0, set_point, 0}};
  const auto both = [&](double Moment::*value) {
    return std::vector<Curve>{{&without, value, constant, false},
                              {&with, value, controlled, false}};
  };
  std::vector<Panel> panels = {{"load, and what friction can bear, N", 1, {}},
                               {"grip force, N", 2, both(&Moment::force_n)},
                               {"stick ratio", 0.5, both(&Moment::stick_ratio)},
                               {"slip of the object, mm", 5, both(&Moment::slip_mm)}};
  panels[0].curves = {{&without, &Moment::friction_n, constant, true},
                      {&with, &Moment::friction_n, controlled, true},
                      {&with, &Moment::load_n, ink::black, false}};
  panels[2].curves.insert(panels[2].curves.begin(), {&goal, &Moment::stick_ratio, ink::grey, true});

  constexpr double left = 64, width = 620, height = 118, gap = 60, top = 128;
  Canvas canvas(left + width + 32, top + 4 * (height + gap) + 2);
  canvas.text({28, 34}, "A cup is filled while a fingertip holds it by friction", 1.3 * letter,
              ink::black, Align::left, true);
  legend(canvas, {left, 58}, controlled, false, "grip force from the stick ratio: held");
  legend(canvas, {left + 330, 58}, constant, false, "constant grip force: dropped");
  legend(canvas, {left, 80}, ink::black, false, "load");
  legend(canvas, {left + 110, 80}, controlled, true, "friction limit (each run)");
  legend(canvas, {left + 330, 80}, ink::grey, true, "set point");
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const double y = top + static_cast<double>(k) * (height + gap);
    paint(canvas, {left, y, width, height}, panels[k], last_s);
  }
  canvas.text({left + width / 2, top + 4 * (height + gap) - 16}, "time, s", letter, ink::grey,
              Align::center);
  return canvas.finished();
}

}  // namespace grip
