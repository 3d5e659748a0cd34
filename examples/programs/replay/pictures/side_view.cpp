// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/side_view.hpp"

#include <cmath>
#include <string>
namespace replay {

Profile profile_of(const fingerpad::Camera<double>& camera,
                   const cv::Mat_<float>& depth_mm,
                   int row) {
  Profile profile;
  bool open = false;
  for (int col = 0; col < depth_mm.cols; ++col) {
    const double depth = static_cast<double>(depth_mm(row, col));
    if (!std::isfinite(depth)) {
      open = false;
      continue;
    }
    if (!open) {
      profile.emplace_back();
      open = true;
    }
    const auto point =
        fingerpad::point_at(camera, static_cast<double>(row), static_cast<double>(col), depth);
    profile.back().emplace_back(point.x, point.z);
  }
  return profile;
}

void paint_profile(Canvas& canvas,
                   const Frame2d& frame,
                   const Profile& profile,
                   const Profile& free_profile,
                   const ColourScale& scale,
                   double line_width) {
  const auto on_canvas = [&](const std::vector<Spot>& piece) {
    std::vector<Spot> spots;
    for (const Spot& mm : piece) {
      spots.push_back(frame.at(mm));
    }
    return spots;
  };
  const cv::Mat colours = colour_column(scale, canvas.area(frame.rectangle).size());
  for (const auto& piece : profile) {
    std::vector<Spot> outline = on_canvas(piece);
    outline.push_back(frame.at({piece.back().x, 0}));
    outline.push_back(frame.at({piece.front().x, 0}));
    canvas.blend(frame.rectangle, colours, canvas.mask_of(frame.rectangle, outline));
  }
  for (const auto& piece : free_profile) {
    canvas.dashed_curve(on_canvas(piece), line_width * 0.8, ink::grey);
  }
  for (const auto& piece : profile) {
    canvas.curve(on_canvas(piece), line_width, ink::black);
  }
}

void paint_axes(Canvas& canvas, const Frame2d& frame, double text_height, Labels labels) {
  const Spot origin = frame.at({-frame.half_width_mm, 0});
  const Spot end = frame.at({frame.half_width_mm, 0});
  const double tick = text_height * 0.5;
  canvas.line(origin, end, 0.9, ink::black);
  canvas.line(origin, frame.at({-frame.half_width_mm, frame.top_mm}), 0.9, ink::black);
  // Numbers at the ends would overlap those of a neighbouring view.
  const double reach = labels == Labels::full ? frame.half_width_mm : 0.9 * frame.half_width_mm;
  for (int mm = -10 * static_cast<int>(reach / 10); mm <= reach; mm += 10) {
    const Spot at = frame.at({static_cast<double>(mm), 0});
    canvas.line(at, {at.x, at.y + tick}, 0.9, ink::black);
    canvas.text({at.x, at.y + tick + 1.6 * text_height}, std::to_string(mm), text_height,
                ink::black, Align::center);
  }
  for (int mm = 0; mm <= frame.top_mm; mm += 5) {
    const Spot at = frame.at({-frame.half_width_mm, static_cast<double>(mm)});
    canvas.line(at, {at.x - tick, at.y}, 0.9, ink::black);
    if (labels != Labels::x_numbers) {
      canvas.text({at.x - tick - 4, at.y + text_height / 2}, std::to_string(mm), text_height,
                  ink::black, Align::right);
    }
  }
  if (labels == Labels::full) {
    const Spot middle = frame.at({0, 0});
    canvas.text({middle.x, middle.y + tick + 3.6 * text_height}, "x, mm", text_height, ink::black,
                Align::center);
    const Spot top = frame.at({-frame.half_width_mm, frame.top_mm});
    canvas.text({top.x, top.y - 1.2 * text_height}, "depth, mm", text_height, ink::black,
                Align::center);
  }
}

}  // namespace replay
