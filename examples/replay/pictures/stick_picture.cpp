// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/stick_picture.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

const Ink stick_ink(178, 114, 0);
const Ink slip_ink(0, 94, 235);
constexpr double radius = 6;

void cross(Canvas& canvas, Spot at, double half, double width, const Ink& colour) {
  canvas.line(at - Spot(half, half), at + Spot(half, half), width, colour);
  canvas.line(at - Spot(half, -half), at + Spot(half, -half), width, colour);
}

/// White around every mark, so that it shows on any ground.
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

std::string words_of(const fingerpad::StickRatioResult<float>& result) {
  const double ratio = static_cast<double>(result.stick_ratio);
  if (result.updated()) {
    return format("stick ratio %.2f: %td of %td dots stick", ratio, result.stick,
                  result.stick + result.slip);
  }
  const std::string why = name_of(result.status);
  return std::isfinite(ratio) ? format("stick ratio still %.2f: ", ratio) + why
                              : "no stick ratio: " + why;
}

}  // namespace

cv::Mat stick_picture(const Scene& scene, double brightest) {
  const double shrink = 560.0 / (std::max)(scene.image.cols, scene.image.rows);
  const cv::Rect2d picture(36, 56, scene.image.cols * shrink, scene.image.rows * shrink);
  const double right = picture.x + picture.width;
  const double below = picture.y + picture.height;
  Canvas canvas(right + 36, below + 76);
  canvas.text({picture.x, 34}, "Stick and slip", 1.3 * letter, ink::black, Align::left, true);
  canvas.text({right, 34}, caption(scene.frame, scene.time_s), letter, ink::black, Align::right);
  cv::Mat paper = canvas.area(picture);
  displayed(scene.image, (std::max)(brightest, 1.0), paper.size()).copyTo(paper);
  const DotGrid& dots = scene.dots.dots_px;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      if (is_present(dots(i, j))) {
        const Spot at(picture.x + shrink * (dots(i, j)[0] + 0.5),
                      picture.y + shrink * (dots(i, j)[1] + 0.5));
        paint_dot(canvas, at, scene.dots.stick.state(i, j));
      }
    }
  }
  double x = picture.x + radius;
  for (const auto& [state, word] :
       {std::pair(DotState::stick, "sticks"), std::pair(DotState::slip, "slips"),
        std::pair(DotState::unknown, "unknown")}) {
    paint_dot(canvas, {x, below + 22}, state);
    canvas.text({x + 14, below + 22 + letter / 2}, word, letter, ink::black);
    x += 42 + canvas.text_width(word, letter);
  }
  canvas.text({picture.x, below + 54}, words_of(scene.dots.stick.result), letter, ink::black);
  return canvas.finished();
}

}  // namespace replay
