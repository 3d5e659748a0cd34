// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/contact_picture.hpp"
#include "replay/pictures/depth_colours.hpp"
#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/sheet.hpp"
#include "replay/pictures/side_view.hpp"

namespace replay {
namespace {

constexpr double dent_worth_showing_mm = 0.3;

/// Paints small triangles on both sides of `rectangle` that mark the row at `y`.
void paint_row_markers(Canvas& canvas, const cv::Rect2d& rectangle, double y, double size) {
  const double left = rectangle.x;
  const double right = rectangle.x + rectangle.width;
  canvas.polygon({{left - size, y - size / 2}, {left - size, y + size / 2}, {left, y}},
                 ink::accent);
  canvas.polygon({{right + size, y - size / 2}, {right + size, y + size / 2}, {right, y}},
                 ink::accent);
}

double largest(const cv::Mat_<float>& depth_mm) {
  double top = 0;
  for (const float depth : depth_mm) {
    top = std::isfinite(depth) ? (std::max)(top, static_cast<double>(depth)) : top;
  }
  return top;
}

}  // namespace

Painter::Painter(const Sensor& sensor, const cv::Mat_<float>& free_depth_mm, double brightest)
    : camera_(sensor.camera),
      free_depth_mm_(free_depth_mm),
      in_pad_(free_depth_mm == free_depth_mm),  // NaN equals nothing
      half_width_mm_(std::ceil(sensor.pad.base_radius_mm + 1)),
      dot_pitch_px_(sensor.dots ? sensor.dots->pitch_mm / sensor.camera.pitch_mm : 0.0),
      top_mm_(2 * std::ceil((std::max)(sensor.pad.apex_height_mm, largest(free_depth_mm)) / 2)),
      scale_(depth_scale(top_mm_)),
      brightest_((std::max)(brightest, 1.0)) {}

Section Painter::find_section(const cv::Mat_<float>& depth_mm) const {
  // Averages over a small window, so that the noise of a single pixel does not count as a dent.
  cv::Mat_<float> fall(depth_mm.size(), 0.0F);
  cv::Mat_<float> depth(depth_mm.size(), 0.0F);
  cv::Mat_<float> count(depth_mm.size(), 0.0F);
  for (int i = 0; i < depth_mm.rows; ++i) {
    for (int j = 0; j < depth_mm.cols; ++j) {
      if (std::isfinite(depth_mm(i, j)) && std::isfinite(free_depth_mm_(i, j))) {
        fall(i, j) = free_depth_mm_(i, j) - depth_mm(i, j);
        depth(i, j) = depth_mm(i, j);
        count(i, j) = 1;
      }
    }
  }
  const cv::Size window(15, 15);
  cv::blur(fall, fall, window);
  cv::blur(depth, depth, window);
  cv::blur(count, count, window);
  const cv::Mat whole = count > 0.999;
  double dent = 0;
  cv::Point where(depth_mm.cols / 2, depth_mm.rows / 2);
  cv::minMaxLoc(fall, nullptr, &dent, nullptr, &where, whole);
  if (dent < dent_worth_showing_mm) {
    dent = 0;
    cv::minMaxLoc(depth, nullptr, nullptr, nullptr, &where, whole);
  }
  if (where.x < 0) {  // no window has only valid pixels
    where = {depth_mm.cols / 2, depth_mm.rows / 2};
  }
  return {where.y, where.x, dent};
}

cv::Mat Painter::depth(const Scene& scene) const {
  const Place place = large_place(scene.depth_mm.size());
  const cv::Rect2d& map = place.box;
  const double right = place.right();
  const double below = place.below();
  Canvas canvas(right + 116, below + 90);
  canvas.text({map.x, 34}, "Depth of the membrane", 1.3 * letter, ink::black, Align::left, true);
  canvas.text({right + 96, 34}, caption(scene.frame, scene.time_s), letter, ink::black,
              Align::right);
  paint_map(canvas, map, scene.depth_mm, in_pad_, scale_, 1);
  paint_legend(canvas, {right + 30, map.y + 50, 18, map.height - 100}, scale_, letter);
  const Spot at = place.of(scene.section.col, scene.section.row);
  paint_row_markers(canvas, map, at.y, 11);
  if (scene.section.dent_mm > 0) {
    canvas.circle(at, 5, 1.6, ink::white);
  }
  paint_scale_bar(canvas, place, scene.depth_mm.cols, camera_.pitch_mm);
  canvas.text({right + 96, below + 20 + letter / 2}, "lines every 1 mm", letter, ink::grey,
              Align::right);
  std::string numbers = format("%.1f %% of the pad has a depth", 100 * scene.valid_share);
  if (std::isfinite(scene.depth_max_mm)) {
    numbers = format("mean %.2f mm,  largest %.2f mm,  ", scene.depth_mean_mm, scene.depth_max_mm) +
              numbers;
  }
  canvas.text({map.x, below + 50}, numbers, letter, ink::black);
  canvas.text({map.x, below + 74},
              scene.section.dent_mm > 0
                  ? "ring: the deepest dent; red marks: the row of the side view"
                  : "red marks: the row of the side view",
              letter, ink::grey);
  return canvas.finished();
}

cv::Mat Painter::side(const Scene& scene) const {
  constexpr double width = 620;
  const Frame2d frame{
      {64, 84, width, width * top_mm_ / (2 * half_width_mm_)}, half_width_mm_, top_mm_};
  const double below = frame.rectangle.y + frame.rectangle.height;
  Canvas canvas(frame.rectangle.x + width + 28, below + 92);
  const bool dented = scene.section.dent_mm > 0;
  canvas.text({28, 34},
              dented ? "Side view through the deepest dent" : "Side view through the deepest point",
              1.3 * letter, ink::black, Align::left, true);
  canvas.text({frame.rectangle.x + width, 34}, caption(scene.frame, scene.time_s), letter,
              ink::black, Align::right);
  const Profile profile = profile_of(camera_, scene.depth_mm, scene.section.row);
  const Profile free_profile = profile_of(camera_, free_depth_mm_, scene.section.row);
  paint_profile(canvas, frame, profile, free_profile, scale_, 1.8);
  paint_axes(canvas, frame, letter, Labels::full);
  const double y_mm = (scene.section.row - camera_.center_y_px) * camera_.pitch_mm + 0.0;
  const double line = below + 74;
  canvas.text({frame.rectangle.x, line},
              format("camera row %d, y = %.2f mm at the plate", scene.section.row, y_mm), letter,
              ink::black);
  const std::string legend = "free pad";
  const double right = frame.rectangle.x + width;
  canvas.text({right, line}, legend, letter, ink::grey, Align::right);
  const double dash = right - canvas.text_width(legend, letter) - 10;
  canvas.dashed_curve({{dash - 34, line - letter / 2}, {dash, line - letter / 2}}, 1.5, ink::grey);
  if (dented) {
    const int row = scene.section.row;
    const int col = scene.section.col;
    const auto at = [&](const cv::Mat_<float>& depth) {
      const auto point =
          fingerpad::point_at(camera_, static_cast<double>(row), static_cast<double>(col),
                              static_cast<double>(depth(row, col)));
      return frame.at({point.x, point.z});
    };
    const Spot bottom = at(scene.depth_mm);
    const Spot top = at(free_depth_mm_);
    canvas.line(top, bottom, 1.2, ink::accent);
    canvas.text({top.x, top.y - letter}, format("%.2f mm", scene.section.dent_mm), letter,
                ink::accent, Align::center);
  }
  return canvas.finished();
}

cv::Mat Painter::montage(const std::string& title,
                         const std::vector<Scene>& scenes,
                         int scale) const {
  constexpr double cell = 216;
  constexpr double gap = 28;
  constexpr double left = 44;
  constexpr double small = 7.5;
  const double height = cell * scenes.front().depth_mm.rows / scenes.front().depth_mm.cols;
  const double side_height = cell * top_mm_ / (2 * half_width_mm_);
  const double camera_y = 104;
  const double depth_y = camera_y + height + 34;
  const double change_y = depth_y + height + 34;
  const double side_y = change_y + height + 44;
  const auto count = static_cast<double>(scenes.size());
  const double right = left + count * cell + (count - 1) * gap;
  double dent_mm = 1;
  for (const Scene& scene : scenes) {
    dent_mm = (std::max)(dent_mm, scene.section.dent_mm);
  }
  const ColourScale change = change_scale(std::ceil(dent_mm));
  Canvas canvas((std::max)(right, 480.0) + 72, side_y + side_height + 36, scale);
  canvas.text({left, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const Scene& scene = scenes[k];
    const double x = left + static_cast<double>(k) * (cell + gap);
    canvas.text({x + cell / 2, 66}, caption(scene.frame, scene.time_s), letter, ink::black,
                Align::center);
    const Place place{{x, camera_y, cell, height}, cell / scene.image.cols};
    paint_image(canvas, place.box, scene.image, brightest_);
    paint_outline(canvas, place, scene.contact_mask, 1.6);
    paint_map(canvas, {x, depth_y, cell, height}, scene.depth_mm, in_pad_, scale_, 1);
    const cv::Rect2d change_map(x, change_y, cell, height);
    cv::Mat_<float> pressed_in_mm;
    cv::subtract(free_depth_mm_, scene.depth_mm, pressed_in_mm);
    paint_map(canvas, change_map, pressed_in_mm, in_pad_, change, 0);
    paint_row_markers(canvas, change_map,
                      change_y + height * (scene.section.row + 0.5) / scene.depth_mm.rows, 8);
    const Frame2d frame{{x, side_y, cell, side_height}, half_width_mm_, top_mm_};
    paint_profile(canvas, frame, profile_of(camera_, scene.depth_mm, scene.section.row),
                  profile_of(camera_, free_depth_mm_, scene.section.row), scale_, 1.2);
    paint_axes(canvas, frame, small, k == 0 ? Labels::numbers : Labels::x_numbers);
  }
  canvas.text({left, camera_y - 10}, "camera image, brightened; contact outlined", small,
              ink::grey);
  canvas.text({left, depth_y - 10}, "depth, a line every 1 mm", small, ink::grey);
  canvas.text({left, change_y - 10},
              "change from the free pad: pressed in (red), bulging out (blue)", small, ink::grey);
  canvas.text({left, side_y - 14}, "side view at the red marks, mm; dashed: the free pad", small,
              ink::grey);
  paint_legend(canvas, {right + 24, depth_y + 20, 13, height - 28}, scale_, small);
  paint_legend(canvas, {right + 24, change_y + 20, 13, height - 28}, change, small);
  return canvas.finished();
}

}  // namespace replay
