// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/motion_chart.hpp"

#include <limits>

#include "replay/pictures/line_chart.hpp"

namespace replay {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

}  // namespace

cv::Mat motion_chart(const std::string& title, const std::vector<FrameRow>& rows) {
  const auto moved = [](double fingerpad::Point3<double>::*axis) {
    return [axis](const FrameRow& row) {
      return row.touch.motion.has_pose() ? row.touch.motion.displacement_mm.*axis : none;
    };
  };
  const auto rotated = [](double fingerpad::Angles<double>::*axis) {
    return [axis](const FrameRow& row) {
      return row.touch.motion.has_pose() ? row.touch.motion.angles.*axis / degree : none;
    };
  };
  using Point = fingerpad::Point3<double>;
  using Angles = fingerpad::Angles<double>;
  const std::vector<LinePanel> panels = {
      {"contact area, mm^2",
       {line_series("area", rows, [](const FrameRow& row) { return row.touch.contact.area_mm2; })}},
      {"contact depth, mm",
       {line_series("depth", rows,
                    [](const FrameRow& row) { return row.touch.contact.depth_mm; })}},
      {"displacement of the object, mm",
       {line_series("x", rows, moved(&Point::x)), line_series("y", rows, moved(&Point::y)),
        line_series("z", rows, moved(&Point::z))}},
      {"rotation of the object, degrees",
       {line_series("about x", rows, rotated(&Angles::x_rad)),
        line_series("about y", rows, rotated(&Angles::y_rad)),
        line_series("about z", rows, rotated(&Angles::z_rad))}}};
  return line_chart(title, panels, rows.front().frame);
}

}  // namespace replay
