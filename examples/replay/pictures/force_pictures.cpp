// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Painter's pictures of forces: the membrane's tension at the rim, and the load on each dot.
#include <algorithm>
#include <cmath>
#include <string>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/contact_picture.hpp"
#include "replay/pictures/depth_colours.hpp"
#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/pictures.hpp"

namespace replay {
namespace {

const Ink pull_ink(150, 80, 0);
const Ink force_ink(255, 255, 255);

/// Paints an arrow, or nothing if it is too short to be visible.
void paint_arrow(Canvas& canvas, Spot from, Spot to, double width, const Ink& colour) {
  const Spot along = to - from;
  const double length = std::hypot(along.x, along.y);
  if (!(length > 0.5)) {
    return;
  }
  const Spot unit = along / length;
  const Spot across(-unit.y, unit.x);
  const double head = (std::min)(length, 2.5 + 2.2 * width);
  const Spot neck = to - head * unit;
  canvas.line(from, neck, width, colour);
  canvas.polygon({to, neck + 0.42 * head * across, neck - 0.42 * head * across}, colour);
}

/// Rounds a value for printing; never gives "-0.00".
double rounded(double value) {
  return std::round(value * 100) / 100 + 0.0;
}

/// The largest round number not above `most`.
double round_below(double most) {
  double best = 1e-6;
  for (double decade = 1e-6; decade < 1e6; decade *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      best = digit * decade <= most ? digit * decade : best;
    }
  }
  return best;
}

/// The camera's image on a canvas, with a title and space for text below.
struct Sheet {
  cv::Rect2d picture;
  double shrink;
  Canvas canvas;

  Sheet(const Scene& scene, const char* title, double brightest, double margin)
      : picture(picture_of(scene)),
        shrink(picture.width / scene.image.cols),
        canvas(picture.x + picture.width + 36 + margin, picture.y + picture.height + 92) {
    const double right = picture.x + picture.width + margin;
    canvas.text({picture.x, 34}, title, 1.3 * letter, ink::black, Align::left, true);
    canvas.text({right, 34}, caption(scene.frame, scene.time_s), letter, ink::black, Align::right);
    cv::Mat paper = canvas.area(picture);
    displayed(scene.image, brightest, paper.size()).copyTo(paper);
  }

  static cv::Rect2d picture_of(const Scene& scene) {
    const double shrink = 560.0 / (std::max)(scene.image.cols, scene.image.rows);
    return {36, 56, scene.image.cols * shrink, scene.image.rows * shrink};
  }

  Spot at(double x_px, double y_px) const {
    return {picture.x + shrink * (x_px + 0.5), picture.y + shrink * (y_px + 0.5)};
  }
  double below() const { return picture.y + picture.height; }

  void scale_bar(const fingerpad::Camera<double>& camera) {
    const double bar_mm = scale_bar_mm(picture.width / shrink * camera.pitch_mm);
    paint_scale_bar(canvas, {picture.x, below() + 20}, bar_mm / camera.pitch_mm * shrink, bar_mm,
                    letter);
  }
  /// Paints an arrow of `length` px with its label at the right, below the picture.
  void arrow_legend(double length, const std::string& words, const Ink& colour) {
    const double right = picture.x + picture.width;
    const double y = below() + 20;
    const double words_begin = right - canvas.text_width(words, letter);
    canvas.text({words_begin, y + letter / 2}, words, letter, ink::black);
    paint_arrow(canvas, {words_begin - 10 - length, y}, {words_begin - 10, y}, 2, colour);
  }
};

std::string words_of_wrench(const WrenchFrame& wrench) {
  const auto& result = wrench.result;
  if (result.status == fingerpad::WrenchStatus::no_contact) {
    return "no contact: no force";
  }
  if (!result.ok()) {
    return std::string("no force: ") + name_of(result.status);
  }
  const auto& f = result.force_n;
  return format("force (%.2f, %.2f, %.2f) N", rounded(f.x), rounded(f.y), rounded(f.z)) +
         (result.by_modulus ? ", from the given modulus" : "");
}

}  // namespace

cv::Mat Painter::rim(const Scene& scene) const {
  Sheet sheet(scene, "Pull of the membrane on the rim", brightest_, 0);
  Canvas& canvas = sheet.canvas;
  paint_outline(canvas, sheet.picture, scene.contact_mask, 1.2);
  double largest = 0;
  for (const RimTension& rim : scene.wrench.tension) {
    const double pull = std::hypot(rim.n_per_mm.x, rim.n_per_mm.y);
    largest = std::isfinite(pull) ? (std::max)(largest, pull) : largest;
  }
  const double unit = round_below(largest > 0 ? largest : 1.0);
  const double px_per_unit = 36;
  for (const RimTension& rim : scene.wrench.tension) {
    const auto px = fingerpad::pixel_of(camera_, rim.border_mm);
    const Spot from = sheet.at(px.x, px.y);
    canvas.disc(from, 2.2, pull_ink);
    if (std::isfinite(rim.n_per_mm.x + rim.n_per_mm.y)) {
      const Spot to = from + px_per_unit / unit * Spot(rim.n_per_mm.x, rim.n_per_mm.y);
      paint_arrow(canvas, from, to, 1.8, pull_ink);
    }
  }
  const auto& result = scene.wrench.result;
  if (result.status == fingerpad::WrenchStatus::ok) {
    const Spot middle = sheet.at(camera_.center_x_px, camera_.center_y_px);
    const Spot push(result.force_n.x, result.force_n.y);
    paint_arrow(canvas, middle, middle + 40 * push, 4, force_ink);
  }
  sheet.scale_bar(camera_);
  if (largest > 0) {
    sheet.arrow_legend(px_per_unit, format("%g N/mm along the plate", unit), pull_ink);
  }
  canvas.text({sheet.picture.x, sheet.below() + 50}, words_of_wrench(scene.wrench), letter,
              ink::black);
  if (result.status == fingerpad::WrenchStatus::ok) {
    const auto& m = result.moment_n_mm;
    canvas.text({sheet.picture.x, sheet.below() + 74},
                format("moment (%.1f, %.1f, %.1f) N mm", rounded(m.x), rounded(m.y), rounded(m.z)),
                letter, ink::black);
    canvas.text({sheet.picture.x + sheet.picture.width, sheet.below() + 50},
                "white: force along the plate, 40 px per N", letter, ink::grey, Align::right);
  }
  return canvas.finished();
}

cv::Mat Painter::traction(const Scene& scene) const {
  constexpr double margin = 76;
  Sheet sheet(scene, "Contact pressure and shear at the dots", brightest_, margin);
  Canvas& canvas = sheet.canvas;
  const TractionFrame& loads = scene.traction;
  const double fluid_kpa = 1000 * scene.pressure_mpa;
  // inside a flat contact the load equals the fluid's pressure; the scale exceeds it by a quarter
  const double step_kpa = fluid_kpa > 0 ? round_below(fluid_kpa / 4) : 1.0;
  const double reach_kpa =
      fluid_kpa > 0 ? step_kpa * std::ceil(1.25 * fluid_kpa / step_kpa) : step_kpa;
  ColourScale scale = change_scale(reach_kpa);
  const double px_per_kpa = 36 / reach_kpa;
  const cv::Mat_<cv::Vec2d>& dots = scene.dots.dots_px;
  const double radius = 0.42 * sheet.shrink * dot_pitch_px_;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const double kpa = 1000 * loads.pressure_mpa(i, j);
      if (is_present(dots(i, j)) && std::isfinite(kpa)) {
        const double share = std::clamp((kpa + reach_kpa) / (2 * reach_kpa), 0.0, 1.0);
        const cv::Vec3b& colour = scale.colours(0, static_cast<int>(std::lround(255 * share)));
        canvas.disc(sheet.at(dots(i, j)[0], dots(i, j)[1]), radius,
                    Ink(colour[0], colour[1], colour[2]));
      }
    }
  }
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const cv::Vec3d& shear = loads.shear_mpa(i, j);
      if (is_present(dots(i, j)) && std::isfinite(shear[0])) {
        const Spot from = sheet.at(dots(i, j)[0], dots(i, j)[1]);
        paint_arrow(canvas, from, from + 1000 * px_per_kpa * Spot(shear[0], shear[1]), 1.6,
                    ink::black);
      }
    }
  }
  paint_outline(canvas, sheet.picture, scene.contact_mask, 2);
  const double right = sheet.picture.x + sheet.picture.width;
  paint_legend(canvas, {right + 26, sheet.picture.y + 60, 18, sheet.picture.height - 120}, scale,
               letter, "kPa");
  sheet.scale_bar(camera_);
  sheet.arrow_legend(36, format("%g kPa along the membrane", reach_kpa), ink::black);
  const auto& result = loads.result;
  std::string words = std::string("no total force: ") + name_of(result.status);
  if (result.has_force()) {
    const auto& f = result.force_n;
    words =
        format("sum of all loads (%.2f, %.2f, %.2f) N", rounded(f.x), rounded(f.y), rounded(f.z));
    words += result.ok() ? "" : std::string(", ") + name_of(result.status);
  }
  canvas.text({sheet.picture.x, sheet.below() + 50}, words, letter, ink::black);
  if (std::isfinite(result.free_load_rms_mpa)) {
    canvas.text({sheet.picture.x, sheet.below() + 74},
                format("error per dot %.1f kPa rms, fluid pressure %.1f kPa",
                       1000 * result.free_load_rms_mpa, fluid_kpa),
                letter, ink::black);
  }
  return canvas.finished();
}

}  // namespace replay
