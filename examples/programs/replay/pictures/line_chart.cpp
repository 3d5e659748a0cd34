// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/line_chart.hpp"

#include <algorithm>
#include <cmath>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

const Ink line_colours[] = {{180, 110, 30}, {60, 140, 40}, {48, 40, 214}};

/// A scale between round numbers with ticks at round numbers.
struct Scale {
  double bottom;
  double top;
  double tick;

  explicit Scale(const LinePanel& panel) {
    double low = 0;
    double high = 0;
    for (const LineSeries& s : panel.series) {
      for (const double value : s.values) {
        low = std::isfinite(value) ? (std::min)(low, value) : low;
        high = std::isfinite(value) ? (std::max)(high, value) : high;
      }
    }
    const double span = (std::max)(high - low, 0.1);
    const double decade = std::pow(10, std::floor(std::log10(span / 2)));
    const double digit = span / 2 / decade;
    tick = decade * (digit < 2 ? 1 : digit < 5 ? 2 : 5);
    // a value just beyond a tick does not extend the scale to the next one
    bottom = tick * std::floor(low / tick + 0.02);
    top = (std::max)(tick * std::ceil(high / tick - 0.02), bottom + tick);
  }
};

void paint_panel(Canvas& canvas, const cv::Rect2d& box, const LinePanel& panel, int first_frame) {
  const Scale scale(panel);
  const double last = static_cast<double>(panel.series.front().values.size()) - 1;
  const auto x_of = [&](double k) { return box.x + box.width * k / (std::max)(last, 1.0); };
  const auto y_of = [&](double value) {
    return box.y + box.height * (scale.top - value) / (scale.top - scale.bottom);
  };
  canvas.text({box.x, box.y - 12}, panel.title, letter, ink::black, Align::left, true);
  for (double step = 0; scale.bottom + step * scale.tick < scale.top + scale.tick / 2; ++step) {
    const double value = scale.tick * (std::round(scale.bottom / scale.tick) + step);
    const double y = y_of(value);
    canvas.line({box.x, y}, {box.x + box.width, y}, 0.6, ink::pale);
    canvas.text({box.x - 8, y + letter / 2}, format("%g", value + 0.0), letter, ink::grey,
                Align::right);
  }
  const double stride = (std::max)(1.0, std::ceil(last / 12));
  for (double k = 0; k <= last; k += stride) {
    canvas.text({x_of(k), box.y + box.height + 18}, std::to_string(first_frame + int(k)), letter,
                ink::grey, Align::center);
  }
  for (std::size_t s = 0; s < panel.series.size(); ++s) {
    const LineSeries& line = panel.series[s];
    const Ink& colour = line_colours[line.beside < 0 ? static_cast<int>(s) : line.beside];
    const auto paint = [&](const std::vector<Spot>& curve) {
      if (line.beside < 0) {
        canvas.curve(curve, 1.6, colour);
      } else {
        canvas.dashed_curve(curve, 1.6, colour);
      }
    };
    std::vector<Spot> spots;
    for (std::size_t k = 0; k <= line.values.size(); ++k) {
      if (k < line.values.size() && std::isfinite(line.values[k])) {
        spots.emplace_back(x_of(static_cast<double>(k)), y_of(line.values[k]));
        canvas.circle(spots.back(), 1.8, 1.8, colour);
      } else {
        paint(spots);
        spots.clear();
      }
    }
    const double y = box.y + 8 + 20 * static_cast<double>(s);
    paint({{box.x + box.width + 14, y}, {box.x + box.width + 34, y}});
    canvas.text({box.x + box.width + 42, y + letter / 2}, line.name, letter, ink::black);
  }
}

}  // namespace

cv::Mat line_chart(const std::string& title,
                   const std::vector<LinePanel>& panels,
                   int first_frame) {
  constexpr double width = 620;
  constexpr double height = 150;
  constexpr double gap = 62;
  const double bottom = 84 + static_cast<double>(panels.size()) * (height + gap);
  Canvas canvas(72 + width + 120, bottom + 6);
  canvas.text({28, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const double y = 84 + static_cast<double>(k) * (height + gap);
    paint_panel(canvas, {72, y, width, height}, panels[k], first_frame);
  }
  canvas.text({72 + width / 2, bottom - 14}, "frame", letter, ink::grey, Align::center);
  return canvas.finished();
}

}  // namespace replay
