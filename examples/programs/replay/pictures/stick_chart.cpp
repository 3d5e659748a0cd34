// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/stick_chart.hpp"

#include <algorithm>
#include <cmath>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

const Ink ratio_ink(178, 114, 0);
const Ink kept_ink(226, 204, 168);

/// A panel with the frames along x.
struct Panel {
  cv::Rect2d box;
  double top;   ///< value at its upper edge; 0 at the lower
  double last;  ///< number of frames - 1

  double x(double k) const { return box.x + box.width * k / (std::max)(last, 1.0); }
  double y(double value) const { return box.y + box.height * (1 - value / top); }
};

void paint_frame(Canvas& canvas, const Panel& panel, const char* title, double tick) {
  canvas.text({panel.box.x, panel.box.y - 14}, title, letter, ink::black, Align::left, true);
  for (double value = 0; value < panel.top + tick / 2; value += tick) {
    canvas.line({panel.box.x, panel.y(value)}, {panel.box.x + panel.box.width, panel.y(value)}, 0.6,
                ink::pale);
    canvas.text({panel.box.x - 8, panel.y(value) + letter / 2}, format("%g", value), letter,
                ink::grey, Align::right);
  }
}

void paint_frame_numbers(Canvas& canvas, const Panel& panel, int first_frame) {
  const double least = panel.last / 12;
  double step = 1;
  for (double decade = 1; step < least; decade *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      step = step < least ? digit * decade : step;
    }
  }
  for (double k = 0; k <= panel.last; k += step) {
    canvas.text({panel.x(k), panel.box.y + panel.box.height + 20},
                std::to_string(first_frame + static_cast<int>(k)), letter, ink::grey,
                Align::center);
  }
  canvas.text({panel.box.x + panel.box.width / 2, panel.box.y + panel.box.height + 44}, "frame",
              letter, ink::grey, Align::center);
}

/// Paints the last known ratio as a step line, with a mark at each new one.
void paint_ratio(Canvas& canvas, const Panel& panel, const std::vector<FrameRow>& rows) {
  std::vector<Spot> kept;
  std::vector<Spot> updated;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& slip = rows[k].touch.slip;
    const double ratio = slip.stick_ratio;
    if (!std::isfinite(ratio)) {
      canvas.curve(kept, 1.6, kept_ink);
      kept.clear();
      continue;
    }
    const double x = panel.x(static_cast<double>(k));
    if (!kept.empty()) {
      kept.emplace_back(x, kept.back().y);
    }
    kept.emplace_back(x, panel.y(ratio));
    if (slip.updated()) {
      updated.push_back(kept.back());
    }
  }
  canvas.curve(kept, 1.6, kept_ink);
  for (const Spot& at : updated) {
    canvas.disc(at, rows.size() > 200 ? 2.2 : 3.4, ratio_ink);
  }
}

void paint_legend(Canvas& canvas, double right, double y) {
  const auto words = [&](const char* text) {
    right -= canvas.text_width(text, letter);
    canvas.text({right, y}, text, letter, ink::black);
    right -= 12;
  };
  words("previous value");
  canvas.line({right - 24, y - letter / 2}, {right, y - letter / 2}, 1.6, kept_ink);
  right -= 24 + 24;
  words("new value");
  canvas.disc({right - 4, y - letter / 2}, 3.4, ratio_ink);
}

void paint_dots_in_contact(Canvas& canvas, const Panel& panel, const std::vector<FrameRow>& rows) {
  std::vector<Spot> spots;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    spots.emplace_back(panel.x(static_cast<double>(k)),
                       panel.y(static_cast<double>(rows[k].touch.stick.dots_in_contact())));
  }
  canvas.curve(spots, 1.6, ink::grey);
}

}  // namespace

cv::Mat stick_chart(const std::string& title, const std::vector<FrameRow>& rows) {
  constexpr double width = 640;
  const double last = static_cast<double>(rows.size()) - 1;
  const Panel ratio{{72, 88, width, 240}, 1.0, last};
  double most = 1;
  for (const FrameRow& row : rows) {
    most = (std::max)(most, static_cast<double>(row.touch.stick.dots_in_contact()));
  }
  const double decade = std::pow(10, std::floor(std::log10(most)));
  const double tick = decade * (most < 2 * decade ? 0.5 : most < 5 * decade ? 1 : 2);
  const double whole_tick = (std::max)(tick, 1.0);
  const Panel dots{{72, 388, width, 80}, whole_tick * std::ceil(most / whole_tick), last};
  Canvas canvas(72 + width + 36, 532);
  canvas.text({28, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  paint_frame(canvas, ratio, "stick ratio", 0.2);
  paint_legend(canvas, 72 + width, 74);
  paint_ratio(canvas, ratio, rows);
  paint_frame(canvas, dots, "dots in contact", whole_tick);
  paint_dots_in_contact(canvas, dots, rows);
  paint_frame_numbers(canvas, dots, rows.front().frame);
  return canvas.finished();
}

}  // namespace replay
