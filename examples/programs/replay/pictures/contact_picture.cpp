// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/contact_picture.hpp"

#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/pictures.hpp"
#include "replay/pictures/sheet.hpp"

namespace replay {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;
const Ink edge(255, 255, 255);
const Ink held(90, 230, 255);
const Ink loose(200, 190, 180);

std::string words_of_contact(const ContactResult& contact) {
  if (!contact.ok()) {
    return std::string("contact: ") + name_of(contact.status);
  }
  if (!contact.in_contact()) {
    return "no contact";
  }
  return format("contact %.1f mm^2,  %.2f mm deep,  center (%.2f, %.2f) mm", contact.area_mm2,
                contact.depth_mm, rounded(contact.center_mm.x), rounded(contact.center_mm.y));
}

std::string words_of_motion(const FrameRow& row) {
  if (!row.has_dots) {
    return "no dots";
  }
  const auto& motion = row.touch.motion;
  if (!motion.has_pose()) {
    return std::string("object: ") + name_of(motion.status);
  }
  const auto& moved = motion.displacement_mm;
  const auto degrees = [](double rad) { return rounded(rad / degree, 10); };
  return format("object moved (%.2f, %.2f, %.2f) mm,  rotated (%.1f, %.1f, %.1f) degrees",
                rounded(moved.x), rounded(moved.y), rounded(moved.z), degrees(motion.angles.x_rad),
                degrees(motion.angles.y_rad), degrees(motion.angles.z_rad));
}

}  // namespace

void paint_outline(Canvas& canvas, const Place& place, const cv::Mat_<uchar>& mask, double width) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  for (const std::vector<cv::Point>& contour : contours) {
    std::vector<Spot> spots;
    for (const cv::Point& px : contour) {
      spots.push_back(place.of(px.x, px.y));
    }
    spots.push_back(spots.front());
    canvas.curve(spots, width, edge);
  }
}

void paint_dots(Canvas& canvas,
                const Place& place,
                const FrameDots& dots,
                const DotGrid& initial_px) {
  for (int i = 0; i < dots.dots_px.rows; ++i) {
    for (int j = 0; j < dots.dots_px.cols; ++j) {
      const cv::Vec2d& px = dots.dots_px(i, j);
      if (!is_present(px)) {
        continue;
      }
      const Spot at = place.of(px[0], px[1]);
      const bool in_contact = dots.in_contact(i, j) != 0;
      if (is_present(initial_px(i, j))) {
        canvas.line(place.of(initial_px(i, j)[0], initial_px(i, j)[1]), at, 0.8,
                    in_contact ? held : loose);
      }
      canvas.circle(at, 2.4, in_contact ? 2.4 : 0.8, in_contact ? held : loose);
    }
  }
}

cv::Mat Painter::contact(const Scene& scene, const DotGrid& initial_px) const {
  Sheet sheet("Where the object touches, and dots", caption(scene.frame, scene.time_s),
              scene.image.size(), 116);
  paint_image(sheet.canvas, sheet.place.box, scene.image, brightest_);
  paint_dots(sheet.canvas, sheet.place, scene.dots, initial_px);
  paint_outline(sheet.canvas, sheet.place, scene.contact_mask, 2);
  paint_scale_bar(sheet.canvas, sheet.place, scene.image.cols, camera_.pitch_mm);
  sheet.write(50, words_of_contact(scene.touch.contact));
  sheet.write(74, words_of_motion(scene));
  sheet.canvas.text({sheet.place.box.x, sheet.place.below() + 98},
                    "yellow: dots that touch; lines: their way since the free pad", letter,
                    ink::grey);
  return sheet.canvas.finished();
}

}  // namespace replay
