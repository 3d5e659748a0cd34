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

Spot middle_of(const Scene& scene) {
  return {scene.gel->contact.center_px.x, scene.gel->contact.center_px.y};
}

/// Paints the frame, the contact's outline, and its slide past the dots.
void paint_scene(Canvas& canvas, const Place& place, const Scene& scene, double line) {
  paint_image(canvas, place.box, scene.image, 245);
  const Outline outline = outline_of(scene.contact_mask);
  if (outline.empty()) {
    return;
  }
  const Ink colour = slip_ink(*scene.gel);
  const Spot slide(scene.gel->slide.slide_px.x, scene.gel->slide.slide_px.y);
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

cv::Mat slide_picture(const Scene& scene) {
  Sheet sheet("Contact and slide", caption(scene.frame, scene.time_s), scene.image.size(), 76);
  Canvas& canvas = sheet.canvas;
  const Place& place = sheet.place;
  paint_scene(canvas, place, scene, 2.6);
  for (const cv::Vec2d& dot : scene.dots.dots_px) {
    if (is_present(dot)) {
      canvas.disc(place.of(dot[0], dot[1]), 3.2, ink::white);
      canvas.disc(place.of(dot[0], dot[1]), 2, ink::black);
    }
  }
  const char* verdict = !scene.gel->contact.in_contact() ? "free"
                        : scene.gel->slide.alarm         ? "SLIPS"
                        : evidence_of(*scene.gel) > 0.5  ? "may slip"
                                                         : "held";
  const Ink colour = slip_ink(*scene.gel);
  const double y = place.below() + 24;
  canvas.disc({44, y}, 8, colour);
  canvas.text({60, y + letter / 2}, verdict, letter, colour, Align::left, true);
  canvas.text({place.right(), y + letter / 2}, "dashed: contact if it moved with the dots", letter,
              ink::grey, Align::right);
  sheet.write(54, words_of(*scene.gel));
  return canvas.finished();
}

}  // namespace replay
