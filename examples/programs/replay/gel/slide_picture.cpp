// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/gel/slide_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/sheet.hpp"

namespace replay {
namespace {

const Ink held_ink(84, 140, 20);
const Ink doubt_ink(0, 150, 230);
const Ink free_ink(150, 146, 142);

double evidence_of(const GelFrame& seen) {
  return seen.slide.evidence;
}

using Outline = std::vector<std::vector<cv::Point>>;

Outline outline_of(const cv::Mat_<uchar>& mask) {
  Outline outline;
  cv::findContours(mask.clone(), outline, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  return outline;
}

/// Solid lines get a white border, so that they are visible on any background.
void paint_outline(Canvas& canvas,
                   const Place& place,
                   const Outline& outline,
                   Spot shift_px,
                   double width,
                   const Ink& colour,
                   bool dashed) {
  for (const auto& ring : outline) {
    std::vector<Spot> spots;
    for (const cv::Point& at : ring) {
      spots.push_back(place.of(at.x + shift_px.x, at.y + shift_px.y));
    }
    spots.push_back(spots.front());
    if (dashed) {
      canvas.dashed_curve(spots, width, colour);
    } else {
      canvas.curve(spots, width + 2, ink::white);
      canvas.curve(spots, width, colour);
    }
  }
}

void paint_arrow(Canvas& canvas, Spot from, Spot to, double width, const Ink& colour) {
  const Spot way = to - from;
  const double length = std::hypot(way.x, way.y);
  const double head = 4 * width;
  if (length < head) {
    return;
  }
  const Spot along = way / length;
  const Spot across(-along.y, along.x);
  const Spot neck = to - head * along;
  for (const auto& [more, ink] : {std::pair(2.0, ink::white), std::pair(0.0, colour)}) {
    canvas.line(from, neck, width + more, ink);
    canvas.polygon({to + more * along, neck - more / 2 * along + (head / 2 + more) * across,
                    neck - more / 2 * along - (head / 2 + more) * across},
                   ink);
  }
}

Spot middle_of(const GelScene& scene) {
  return {scene.seen.contact.center_px.x, scene.seen.contact.center_px.y};
}

/// Paints the frame, the contact's outline, and its slide past the dots.
void paint_scene(Canvas& canvas, const Place& place, const GelScene& scene, double line) {
  paint_image(canvas, place.box, scene.image, 245);
  const Outline outline = outline_of(scene.contact_mask);
  if (outline.empty()) {
    return;
  }
  const Ink colour = slip_ink(scene.seen);
  const Spot slide(scene.seen.slide.slide_px.x, scene.seen.slide.slide_px.y);
  paint_outline(canvas, place, outline, -slide, 0.7 * line, ink::white, true);
  paint_outline(canvas, place, outline, {0, 0}, line, colour, false);
  const Spot middle = middle_of(scene);
  paint_arrow(canvas, place.of(middle.x - slide.x, middle.y - slide.y),
              place.of(middle.x, middle.y), line, colour);
}

std::string words_of(const GelFrame& seen) {
  using fingerpad::SlideStatus;
  if (!seen.contact.in_contact()) {
    return seen.slide.lost > 0 ? "no more contact" : "no contact";
  }
  const std::string known =
      format("slid %.2f pitches past the dots, %.0f %% of the contact area lost", seen.slide.slide,
             100 * seen.slide.lost);
  return seen.slide.ok() ? known : known + " (" + name_of(seen.slide.status) + ")";
}

}  // namespace

Ink slip_ink(const GelFrame& seen) {
  return !seen.contact.in_contact() ? free_ink
         : seen.slide.alarm         ? ink::accent
         : evidence_of(seen) > 0.5  ? doubt_ink
                                    : held_ink;
}

std::size_t first_slip(const std::vector<GelRow>& rows) {
  const auto is_alarm = [](const GelRow& row) { return row.seen.slide.alarm; };
  return static_cast<std::size_t>(std::find_if(rows.begin(), rows.end(), is_alarm) - rows.begin());
}

cv::Mat slide_picture(const GelScene& scene) {
  Sheet sheet("Contact and slide", caption(scene.frame, scene.time_s), scene.image.size(), 76);
  Canvas& canvas = sheet.canvas;
  const Place& place = sheet.place;
  paint_scene(canvas, place, scene, 2.6);
  for (const cv::Vec2d& dot : scene.dots_px) {
    if (is_present(dot)) {
      canvas.disc(place.of(dot[0], dot[1]), 3.2, ink::white);
      canvas.disc(place.of(dot[0], dot[1]), 2, ink::black);
    }
  }
  const char* verdict = !scene.seen.contact.in_contact() ? "free"
                        : scene.seen.slide.alarm         ? "SLIPS"
                        : evidence_of(scene.seen) > 0.5  ? "may slip"
                                                         : "held";
  const Ink colour = slip_ink(scene.seen);
  const double y = place.below() + 24;
  canvas.disc({44, y}, 8, colour);
  canvas.text({60, y + letter / 2}, verdict, letter, colour, Align::left, true);
  canvas.text({place.right(), y + letter / 2}, "dashed: contact if it moved with the dots", letter,
              ink::grey, Align::right);
  sheet.write(54, words_of(scene.seen));
  return canvas.finished();
}

namespace {

constexpr double chart_left = 84;
constexpr double chart_width = 680;

/// A panel with the frames along x, over the width of the chart.
struct Axis {
  double y;
  double height;
  double top;   ///< value at its upper edge; 0 at the lower
  double last;  ///< number of frames - 1

  double x_of(double k) const { return chart_left + chart_width * k / (std::max)(last, 1.0); }
  double y_of(double value) const { return y + height * (1 - (std::min)(value, top) / top); }
};

void paint_band(Canvas& canvas, const Axis& axis, double from, double to, const Ink& colour) {
  canvas.polygon({{chart_left, axis.y_of(from)},
                  {chart_left + chart_width, axis.y_of(from)},
                  {chart_left + chart_width, axis.y_of(to)},
                  {chart_left, axis.y_of(to)}},
                 colour);
}

/// Paints the evidence on a background that is green where the contact holds and red where it
/// slips.
void paint_evidence(Canvas& canvas, const Axis& axis, const std::vector<GelRow>& rows) {
  paint_band(canvas, axis, 0, 0.5, Ink(226, 242, 222));
  paint_band(canvas, axis, 0.5, 1, Ink(210, 240, 252));
  paint_band(canvas, axis, 1, axis.top, Ink(222, 220, 250));
  const double right = chart_left - 10;
  canvas.text({right, axis.y_of(0.25) + letter / 2}, "held", letter, held_ink, Align::right, true);
  canvas.text({right, axis.y_of(0.75) + letter / 2}, "may slip", letter, doubt_ink, Align::right,
              true);
  canvas.text({right, axis.y_of((1 + axis.top) / 2) + letter / 2}, "SLIPS", letter, ink::accent,
              Align::right, true);
  std::vector<Spot> curve;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].seen.contact.in_contact()) {
      curve.emplace_back(axis.x_of(static_cast<double>(k)), axis.y_of(evidence_of(rows[k].seen)));
    }
    if (!rows[k].seen.contact.in_contact() || k + 1 == rows.size()) {
      canvas.curve(curve, 2, ink::black);
      curve.clear();
    }
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].seen.contact.in_contact()) {
      const Spot at(axis.x_of(static_cast<double>(k)), axis.y_of(evidence_of(rows[k].seen)));
      canvas.disc(at, rows.size() > 100 ? 2 : 5, slip_ink(rows[k].seen));
    }
  }
}

/// Paints the contact area as a filled curve in the colour of slip_ink().
void paint_area(Canvas& canvas, const Axis& axis, const std::vector<GelRow>& rows) {
  const auto area = [&](std::size_t k) {
    return axis.y_of(static_cast<double>(rows[k].seen.contact.contact_px));
  };
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    const double from = axis.x_of(static_cast<double>(k));
    const double to = axis.x_of(static_cast<double>(k) + 1);
    canvas.polygon({{from, axis.y_of(0)}, {from, area(k)}, {to, area(k + 1)}, {to, axis.y_of(0)}},
                   slip_ink(rows[k].seen));
  }
  canvas.line({chart_left, axis.y_of(0)}, {chart_left + chart_width, axis.y_of(0)}, 1, ink::grey);
  const double middle = axis.y + axis.height / 2;
  canvas.text({chart_left - 10, middle - letter / 2}, "area in", letter, ink::black, Align::right,
              true);
  canvas.text({chart_left - 10, middle + 1.5 * letter}, "contact", letter, ink::black, Align::right,
              true);
}

void paint_frame_numbers(Canvas& canvas, const Axis& axis, const std::vector<GelRow>& rows) {
  const auto stride = (std::max)(std::size_t{1}, (rows.size() + 11) / 12);
  for (std::size_t k = 0; k < rows.size(); k += stride) {
    canvas.text({axis.x_of(static_cast<double>(k)), axis.y + axis.height + 20},
                std::to_string(rows[k].frame), letter, ink::grey, Align::center);
  }
  canvas.text({chart_left + chart_width / 2, axis.y + axis.height + 42}, "frame", letter, ink::grey,
              Align::center);
}

/// Paints frames side by side, each with a line down to its position on the axis.
double paint_frames(Canvas& canvas,
                    const Axis& axis,
                    const std::vector<GelRow>& rows,
                    const std::vector<GelScene>& shown,
                    double y) {
  const double gap = 8;
  const double count = static_cast<double>(shown.size());
  const double width = (chart_width - gap * (count - 1)) / count;
  double height = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const double shrink = width / shown[k].image.cols;
    height = shown[k].image.rows * shrink;
    const double x = chart_left + static_cast<double>(k) * (width + gap);
    const Ink colour = slip_ink(shown[k].seen);
    canvas.polygon({{x - 3, y - 3},
                    {x + width + 3, y - 3},
                    {x + width + 3, y + height + 3},
                    {x - 3, y + height + 3}},
                   colour);
    paint_scene(canvas, {{x, y, width, height}, shrink}, shown[k], 1.6);
    const double at = static_cast<double>(shown[k].frame - rows.front().frame);
    canvas.line({x + width / 2, y + height + 3}, {axis.x_of(at), axis.y}, 1, colour);
    canvas.text({x + width / 2, y - 10}, std::to_string(shown[k].frame), letter, ink::grey,
                Align::center);
  }
  return height;
}

}  // namespace

cv::Mat slide_chart(const std::string& title,
                    const std::vector<GelRow>& rows,
                    const std::vector<GelScene>& shown) {
  const double last = static_cast<double>(rows.size()) - 1;
  const double count = static_cast<double>((std::max)(shown.size(), std::size_t{1}));
  const cv::Mat& image = shown.front().image;
  const double thumb = (chart_width - 8 * (count - 1)) / count * image.rows / image.cols;
  const double thumbs_y = 78;  // below the title and the frame numbers
  const double top = thumbs_y + thumb + 34;
  double most = 1.5;
  double largest = 1;
  for (const GelRow& row : rows) {
    most = (std::max)(most, (std::min)(evidence_of(row.seen), 3.0));
    largest = (std::max)(largest, static_cast<double>(row.seen.contact.contact_px));
  }
  const Axis evidence{top, 220, most, last};
  const Axis area{top + 240, 70, largest, last};
  Canvas canvas(chart_left + chart_width + 36, area.y + area.height + 60);
  canvas.text({28, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  paint_evidence(canvas, evidence, rows);
  paint_area(canvas, area, rows);
  paint_frames(canvas, evidence, rows, shown, thumbs_y);
  const std::size_t slip = first_slip(rows);
  if (slip < rows.size()) {
    const double x = evidence.x_of(static_cast<double>(slip));
    canvas.dashed_curve({{x, evidence.y}, {x, area.y + area.height}}, 1.6, ink::accent);
  }
  paint_frame_numbers(canvas, area, rows);
  return canvas.finished();
}

}  // namespace replay
