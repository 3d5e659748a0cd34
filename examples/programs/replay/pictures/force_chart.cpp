// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/force_chart.hpp"

#include <algorithm>

#include "replay/pictures/line_chart.hpp"

namespace replay {

cv::Mat force_chart(const std::string& title, const std::vector<FrameRow>& rows) {
  LinePanel normal{
      "normal force (positive: press), N",
      {line_series("look-up", rows, [](const FrameRow& row) { return row.touch.normal.force_n; })}};
  LinePanel tangential{
      "force along the plate, N",
      {line_series("x", rows,
                   [](const FrameRow& row) { return row.touch.shear.tangential_force_n.x; }),
       line_series("y", rows,
                   [](const FrameRow& row) { return row.touch.shear.tangential_force_n.y; })}};
  LinePanel moment{"moment about the normal through the middle of the contact, N mm",
                   {line_series("look-up", rows,
                                [](const FrameRow& row) { return row.touch.shear.moment_n_mm; })}};
  const auto add_truth = [&](LinePanel& panel, int beside, const char* name, const auto& of) {
    panel.series.push_back(line_series(
        name, rows, [&](const FrameRow& row) { return row.truth ? of(*row.truth) : not_known; }));
    panel.series.back().beside = beside;
  };
  if (std::any_of(rows.begin(), rows.end(),
                  [](const FrameRow& row) { return row.truth.has_value(); })) {
    add_truth(normal, 0, "truth", [](const TrueForce& truth) { return -truth.force_n.z; });
    add_truth(tangential, 0, "true x", [](const TrueForce& truth) { return truth.force_n.x; });
    add_truth(tangential, 1, "true y", [](const TrueForce& truth) { return truth.force_n.y; });
    add_truth(moment, 0, "truth", [](const TrueForce& truth) { return truth.moment_n_mm; });
  }
  return line_chart(title, {normal, tangential, moment}, rows.front().frame);
}

}  // namespace replay
