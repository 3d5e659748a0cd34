// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Painter's picture of forces: the load on each dot.
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

}  // namespace

cv::Mat Painter::traction(const Scene& scene) const {
  constexpr double margin = 76;
  Sheet sheet("Load on each touched dot: red presses, blue pulls",
              caption(scene.frame, scene.time_s), scene.image.size(), 92, margin);
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
  // elsewhere the loads are noise
  const auto is_touched = [&](int i, int j) {
    return is_present(dots(i, j)) && scene.dots.in_contact(i, j) != 0;
  };
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const double kpa = 1000 * loads.pressure_mpa(i, j);
      if (is_touched(i, j) && std::isfinite(kpa)) {
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
      if (is_touched(i, j) && std::isfinite(shear[0])) {
        const Spot from = place.of(dots(i, j)[0], dots(i, j)[1]);
        const Spot to = from + 1000 * px_per_kpa * Spot(shear[0], shear[1]);
        paint_arrow(canvas, from, to, 3.4, ink::white);
        paint_arrow(canvas, from, to, 1.6, ink::black);
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
