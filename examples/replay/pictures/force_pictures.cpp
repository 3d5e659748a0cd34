// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Painter's pictures of forces: the membrane's tension at the rim, and the load on each dot.
#include <algorithm>
#include <cmath>
#include <string>

#include "replay/pictures/contact_picture.hpp"
#include "replay/pictures/depth_colours.hpp"
#include "replay/pictures/picture_parts.hpp"
#include "replay/pictures/pictures.hpp"
#include "replay/pictures/sheet.hpp"

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

/// Paints an arrow of `length` px with its label at the right, below the picture.
void paint_arrow_legend(Sheet& sheet, double length, const std::string& words, const Ink& colour) {
  const double y = sheet.place.below() + 20;
  const double words_begin = sheet.place.right() - sheet.canvas.text_width(words, letter);
  sheet.canvas.text({words_begin, y + letter / 2}, words, letter, ink::black);
  paint_arrow(sheet.canvas, {words_begin - 10 - length, y}, {words_begin - 10, y}, 2, colour);
}

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
  Sheet sheet("Pull of the membrane on the rim", caption(scene.frame, scene.time_s),
              scene.image.size(), 92);
  Canvas& canvas = sheet.canvas;
  const Place& place = sheet.place;
  paint_image(canvas, place.box, scene.image, brightest_);
  paint_outline(canvas, place, scene.contact_mask, 1.2);
  double largest = 0;
  for (const RimTension& rim : scene.wrench.tension) {
    const double pull = std::hypot(rim.n_per_mm.x, rim.n_per_mm.y);
    largest = std::isfinite(pull) ? (std::max)(largest, pull) : largest;
  }
  const double unit = round_below(largest > 0 ? largest : 1.0);
  const double px_per_unit = 36;
  for (const RimTension& rim : scene.wrench.tension) {
    const auto px = fingerpad::pixel_of(camera_, rim.border_mm);
    const Spot from = place.of(px.x, px.y);
    canvas.disc(from, 2.2, pull_ink);
    if (std::isfinite(rim.n_per_mm.x + rim.n_per_mm.y)) {
      const Spot to = from + px_per_unit / unit * Spot(rim.n_per_mm.x, rim.n_per_mm.y);
      paint_arrow(canvas, from, to, 1.8, pull_ink);
    }
  }
  const auto& result = scene.wrench.result;
  if (result.status == fingerpad::WrenchStatus::ok) {
    const Spot middle = place.of(camera_.center_x_px, camera_.center_y_px);
    const Spot push(result.force_n.x, result.force_n.y);
    paint_arrow(canvas, middle, middle + 40 * push, 4, force_ink);
  }
  paint_scale_bar(canvas, place, scene.image.cols, camera_.pitch_mm);
  if (largest > 0) {
    paint_arrow_legend(sheet, px_per_unit, format("%g N/mm along the plate", unit), pull_ink);
  }
  sheet.write(50, words_of_wrench(scene.wrench));
  if (result.status == fingerpad::WrenchStatus::ok) {
    const auto& m = result.moment_n_mm;
    sheet.write(74,
                format("moment (%.1f, %.1f, %.1f) N mm", rounded(m.x), rounded(m.y), rounded(m.z)));
    canvas.text({place.right(), place.below() + 50}, "white: force along the plate, 40 px per N",
                letter, ink::grey, Align::right);
  }
  return canvas.finished();
}

cv::Mat Painter::traction(const Scene& scene) const {
  constexpr double margin = 76;
  Sheet sheet("Contact pressure and shear at the dots", caption(scene.frame, scene.time_s),
              scene.image.size(), 92, margin);
  Canvas& canvas = sheet.canvas;
  const Place& place = sheet.place;
  paint_image(canvas, place.box, scene.image, brightest_);
  const TractionFrame& loads = scene.traction;
  const double fluid_kpa = 1000 * scene.pressure_mpa;
  // inside a flat contact the load equals the fluid's pressure; the scale exceeds it by a quarter
  const double step_kpa = fluid_kpa > 0 ? round_below(fluid_kpa / 4) : 1.0;
  const double reach_kpa =
      fluid_kpa > 0 ? step_kpa * std::ceil(1.25 * fluid_kpa / step_kpa) : step_kpa;
  ColourScale scale = change_scale(reach_kpa);
  const double px_per_kpa = 36 / reach_kpa;
  const cv::Mat_<cv::Vec2d>& dots = scene.dots.dots_px;
  const double radius = 0.42 * place.shrink * dot_pitch_px_;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const double kpa = 1000 * loads.pressure_mpa(i, j);
      if (is_present(dots(i, j)) && std::isfinite(kpa)) {
        const double share = std::clamp((kpa + reach_kpa) / (2 * reach_kpa), 0.0, 1.0);
        const cv::Vec3b& colour = scale.colours(0, static_cast<int>(std::lround(255 * share)));
        canvas.disc(place.of(dots(i, j)[0], dots(i, j)[1]), radius,
                    Ink(colour[0], colour[1], colour[2]));
      }
    }
  }
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const cv::Vec3d& shear = loads.shear_mpa(i, j);
      if (is_present(dots(i, j)) && std::isfinite(shear[0])) {
        const Spot from = place.of(dots(i, j)[0], dots(i, j)[1]);
        paint_arrow(canvas, from, from + 1000 * px_per_kpa * Spot(shear[0], shear[1]), 1.6,
                    ink::black);
      }
    }
  }
  paint_outline(canvas, place, scene.contact_mask, 2);
  paint_legend(canvas, {place.right() + 26, place.box.y + 60, 18, place.box.height - 120}, scale,
               letter, "kPa");
  paint_scale_bar(canvas, place, scene.image.cols, camera_.pitch_mm);
  paint_arrow_legend(sheet, 36, format("%g kPa along the membrane", reach_kpa), ink::black);
  const auto& result = loads.result;
  std::string words = std::string("no total force: ") + name_of(result.status);
  if (result.has_force()) {
    const auto& f = result.force_n;
    words =
        format("sum of all loads (%.2f, %.2f, %.2f) N", rounded(f.x), rounded(f.y), rounded(f.z));
    words += result.ok() ? "" : std::string(", ") + name_of(result.status);
  }
  sheet.write(50, words);
  if (std::isfinite(result.free_load_rms_mpa)) {
    sheet.write(74, format("error per dot %.1f kPa rms, fluid pressure %.1f kPa",
                           1000 * result.free_load_rms_mpa, fluid_kpa));
  }
  return canvas.finished();
}

}  // namespace replay
