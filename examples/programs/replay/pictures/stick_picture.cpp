// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/stick_picture.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/sheet.hpp"

namespace replay {
namespace {

const Ink stick_ink(178, 114, 0);
const Ink slip_ink(0, 94, 235);
constexpr double radius = 6;
constexpr double enlarged = 10;  // magnification of slips, which are small

void cross(Canvas& canvas, Spot at, double half, double width, const Ink& colour) {
  canvas.line(at - Spot(half, half), at + Spot(half, half), width, colour);
  canvas.line(at - Spot(half, -half), at + Spot(half, -half), width, colour);
}

/// Paints a dot's mark with a white border, so that it is visible on any background.
void paint_dot(Canvas& canvas, Spot at, DotState state) {
  switch (state) {
    case DotState::stick:
      canvas.disc(at, radius + 1.5, ink::white);
      canvas.disc(at, radius, stick_ink);
      break;
    case DotState::slip:
      cross(canvas, at, radius, 5.5, ink::white);
      cross(canvas, at, radius, 3.2, slip_ink);
      break;
    case DotState::unknown:
      canvas.circle(at, radius - 1, 3.5, ink::white);
      canvas.circle(at, radius - 1, 1.5, ink::grey);
      break;
    case DotState::none:
      canvas.disc(at, 2, ink::white);
      break;
  }
}

/// Camera pixels per mm, from distances of neighbouring dots; 0 without dots.
double px_per_mm(const FrameDots& dots) {
  double px = 0, mm = 0;
  for (int i = 0; i < dots.dots_mm.rows; ++i) {
    for (int j = 1; j < dots.dots_mm.cols; ++j) {
      const cv::Vec3d apart = dots.dots_mm(i, j) - dots.dots_mm(i, j - 1);
      if (is_present(dots.dots_px(i, j)) && is_present(dots.dots_px(i, j - 1)) &&
          std::isfinite(apart[0] + apart[1])) {
        px += cv::norm(dots.dots_px(i, j) - dots.dots_px(i, j - 1));
        mm += std::hypot(apart[0], apart[1]);
      }
    }
  }
  return mm > 0 ? px / mm : 0;
}

/// Paints the slip of a dot on the object as an arrow from the dot.
void paint_slip(Canvas& canvas, Spot from, Spot slip) {
  const double length = std::hypot(slip.x, slip.y);
  if (!(length > 2)) {
    return;
  }
  const Spot along = slip / length, across(-along.y, along.x), tip = from + slip;
  const Spot head = tip - 5 * along;
  canvas.line(from, tip, 3.5, ink::white);
  canvas.line(from, head, 1.7, ink::black);
  canvas.polygon({tip, head + 2.5 * across, head - 2.5 * across}, ink::black);
}

std::string words_of(const fingerpad::FingertipResult& touch) {
  using fingerpad::SlipEvidence;
  const auto& result = touch.stick;
  const double ratio = touch.slip.stick_ratio;
  if (touch.slip.updated()) {
    const bool by_friction =
        touch.slip.evidence == SlipEvidence::friction || touch.slip.evidence == SlipEvidence::both;
    const auto counted = result.stick + result.slip;
    if (by_friction && ratio > 0) {
      return format("stick ratio %.2f: the object carries dots back", ratio);
    }
    return by_friction
               ? format("stick ratio %.2f, a slide by friction; %td of %td dots seem to stick",
                        ratio, result.stick, counted)
               : format("stick ratio %.2f: %td of %td dots stick", ratio, result.stick, counted);
  }
  const std::string why = name_of(result.status);
  return std::isfinite(ratio) ? format("stick ratio still %.2f: ", ratio) + why
                              : "no stick ratio: " + why;
}

}  // namespace

cv::Mat stick_picture(const Scene& scene, double brightest) {
  Sheet sheet("Dots that stick, and dots that slip", caption(scene.frame, scene.time_s),
              scene.image.size(), 76);
  Canvas& canvas = sheet.canvas;
  const Place& place = sheet.place;
  paint_image(canvas, place.box, scene.image, (std::max)(brightest, 1.0));
  const DotGrid& dots = scene.dots.dots_px;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      if (is_present(dots(i, j))) {
        paint_dot(canvas, place.of(dots(i, j)[0], dots(i, j)[1]), scene.dots.state(i, j));
      }
    }
  }
  const cv::Mat_<cv::Vec2d>& slips = scene.dots.slips_mm;
  const double length = enlarged * place.shrink * px_per_mm(scene.dots);
  for (int i = 0; i < slips.rows; ++i) {
    for (int j = 0; j < slips.cols; ++j) {
      if (is_present(dots(i, j)) && scene.dots.state(i, j) == DotState::slip) {
        paint_slip(canvas, place.of(dots(i, j)[0], dots(i, j)[1]),
                   length * Spot(slips(i, j)[0], slips(i, j)[1]));
      }
    }
  }
  const double y = place.below() + 22;
  double x = place.box.x + radius;
  for (const auto& [state, word] :
       {std::pair(DotState::stick, "sticks"), std::pair(DotState::slip, "slips"),
        std::pair(DotState::unknown, "unknown")}) {
    paint_dot(canvas, {x, y}, state);
    canvas.text({x + 14, y + letter / 2}, word, letter, ink::black);
    x += 42 + canvas.text_width(word, letter);
  }
  if (!slips.empty()) {
    paint_slip(canvas, {x - 4, y}, {18, 0});
    canvas.text({x + 22, y + letter / 2}, format("slip, drawn %.0f times as long", enlarged),
                letter, ink::black);
  }
  sheet.write(54, words_of(scene.touch));
  return canvas.finished();
}

}  // namespace replay
