// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/contact_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/pictures.hpp"

namespace replay {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;
const Ink edge(255, 255, 255);
const Ink held(90, 230, 255);
const Ink loose(200, 190, 180);

/// Maps pixel centers of the camera's image to the canvas.
class Placement {
 public:
  Placement(const cv::Rect2d& rectangle, cv::Size size)
      : corner_(rectangle.x, rectangle.y), shrink_(rectangle.width / size.width) {}
  Spot at(double x_px, double y_px) const {
    return corner_ + shrink_ * Spot(x_px + 0.5, y_px + 0.5);
  }

 private:
  Spot corner_;
  double shrink_;
};

/// Rounds a value for printing; never gives "-0.0".
double rounded(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit + 0.0;
}

std::string words_of_contact(const ContactResult& contact) {
  if (!contact.in_contact()) {
    return "no contact";
  }
  return format("contact %.1f mm^2,  %.2f mm deep,  center (%.2f, %.2f) mm", contact.area_mm2,
                contact.depth_mm, rounded(contact.center_mm.x, 100),
                rounded(contact.center_mm.y, 100));
}

std::string words_of_motion(const FrameDots& dots) {
  if (dots.dots_px.empty()) {
    return "no dots";
  }
  const auto& motion = dots.motion;
  if (!motion.ok()) {
    return std::string("object: ") + name_of(motion.status);
  }
  const auto& moved = motion.displacement_mm;
  const auto degrees = [](double rad) { return rounded(rad / degree, 10); };
  return format("object moved (%.2f, %.2f, %.2f) mm,  rotated (%.1f, %.1f, %.1f) degrees",
                rounded(moved.x, 100), rounded(moved.y, 100), rounded(moved.z, 100),
                degrees(motion.angles.x_rad), degrees(motion.angles.y_rad),
                degrees(motion.angles.z_rad));
}

}  // namespace

void paint_outline(Canvas& canvas,
                   const cv::Rect2d& rectangle,
                   const cv::Mat_<uchar>& mask,
                   double width) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  const Placement place(rectangle, mask.size());
  for (const std::vector<cv::Point>& contour : contours) {
    std::vector<Spot> spots;
    for (const cv::Point& px : contour) {
      spots.push_back(place.at(px.x, px.y));
    }
    spots.push_back(spots.front());
    canvas.curve(spots, width, edge);
  }
}

void paint_dots(Canvas& canvas,
                const cv::Rect2d& rectangle,
                cv::Size size,
                const FrameDots& dots,
                const DotGrid& initial_px) {
  const Placement place(rectangle, size);
  for (int i = 0; i < dots.dots_px.rows; ++i) {
    for (int j = 0; j < dots.dots_px.cols; ++j) {
      const cv::Vec2d& px = dots.dots_px(i, j);
      if (!is_present(px)) {
        continue;
      }
      const Spot at = place.at(px[0], px[1]);
      const bool in_contact = dots.in_contact(i, j) != 0;
      if (is_present(initial_px(i, j))) {
        canvas.line(place.at(initial_px(i, j)[0], initial_px(i, j)[1]), at, 0.8,
                    in_contact ? held : loose);
      }
      canvas.circle(at, 2.4, in_contact ? 2.4 : 0.8, in_contact ? held : loose);
      if (dots.motion.reference == fingerpad::DotIndex{i, j}) {
        canvas.circle(at, 7, 1.8, ink::accent);
      }
    }
  }
}

cv::Mat Painter::contact(const Scene& scene, const DotGrid& initial_px) const {
  const double shrink = 560.0 / (std::max)(scene.image.cols, scene.image.rows);
  const cv::Rect2d picture(36, 56, scene.image.cols * shrink, scene.image.rows * shrink);
  const double right = picture.x + picture.width;
  const double below = picture.y + picture.height;
  Canvas canvas(right + 36, below + 92);
  canvas.text({picture.x, 34}, "Contact and dots", 1.3 * letter, ink::black, Align::left, true);
  canvas.text({right, 34}, caption(scene.frame, scene.time_s), letter, ink::black, Align::right);
  cv::Mat paper = canvas.area(picture);
  displayed(scene.image, brightest_, paper.size()).copyTo(paper);
  paint_dots(canvas, picture, scene.image.size(), scene.dots, initial_px);
  paint_outline(canvas, picture, scene.contact_mask, 2);
  const double bar_mm = scale_bar_mm(scene.image.cols * camera_.pitch_mm);
  paint_scale_bar(canvas, {picture.x, below + 20}, bar_mm / camera_.pitch_mm * shrink, bar_mm,
                  letter);
  canvas.text({picture.x, below + 50}, words_of_contact(scene.contact), letter, ink::black);
  canvas.text({picture.x, below + 74}, words_of_motion(scene.dots), letter, ink::black);
  return canvas.finished();
}

}  // namespace replay
