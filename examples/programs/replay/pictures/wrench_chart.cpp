// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/wrench_chart.hpp"

#include <limits>

#include "replay/pictures/line_chart.hpp"

namespace replay {

cv::Mat wrench_chart(const std::string& title, const std::vector<FrameRow>& rows) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  using Point = fingerpad::Point3<double>;
  const auto force = [](double Point::*axis) {
    return [axis](const FrameRow& row) {
      return row.touch.wrench.ok() ? row.touch.wrench.force_n.*axis : none;
    };
  };
  const auto moment = [](double Point::*axis) {
    return [axis](const FrameRow& row) {
      return row.touch.wrench.ok() ? row.touch.wrench.moment_n_mm.*axis : none;
    };
  };
  const auto pressure_kpa = [](const FrameRow& row) { return 1000 * row.pressure_mpa; };
  return line_chart(
      title,
      {{"force along the plate, N",
        {line_series("x", rows, force(&Point::x)), line_series("y", rows, force(&Point::y))}},
       {"force into the pad (negative), N", {line_series("z", rows, force(&Point::z))}},
       {"moment about the middle of the base, N mm",
        {line_series("about x", rows, moment(&Point::x)),
         line_series("about y", rows, moment(&Point::y)),
         line_series("about z", rows, moment(&Point::z))}},
       {"pressure of the fluid, kPa", {line_series("pressure", rows, pressure_kpa)}}},
      rows.front().frame);
}

}  // namespace replay
