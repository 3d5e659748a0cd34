// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The pixels around one spot, and by which share each is darker than the background.
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

class DotPatch {
 public:
  /// Selects the pixels of a frame within `half_px` of a place, along rows and columns. The caller
  /// then writes their darkness.
  void move_to(const Place& place, double half_px, cv::Size frame) {
    box_ = square(place, half_px) & cv::Rect({0, 0}, frame);
    dark_.resize(static_cast<std::size_t>(box_.area()));
  }
  const cv::Rect& box() const { return box_; }
  float* row(int i) { return dark_.data() + (i - box_.y) * box_.width; }

  /// Calls visit(x, y, darkness) for the pixels within `radius_px` of a place; x and y are relative
  /// to it.
  template <class Visit>
  void for_each(const Place& place, double radius_px, const Visit& visit) const {
    const cv::Rect box = square(place, radius_px) & box_;
    for (int i = box.y; i < box.y + box.height; ++i) {
      const float* row = dark_.data() + (i - box_.y) * box_.width - box_.x;
      const double y = i - place.y;
      const double half_px = std::sqrt((std::max)(radius_px * radius_px - y * y, 0.0));
      const int first = (std::max)(cvCeil(place.x - half_px), box.x);
      const int last = (std::min)(cvFloor(place.x + half_px), box.x + box.width - 1);
      for (int j = first; j <= last; ++j) {
        visit(j - place.x, y, static_cast<double>(row[j]));
      }
    }
  }

  /// Mean darkness over the pixels farther than `inner_px` and not farther than `outer_px`; NaN if
  /// there are none.
  double mean_within(const Place& place, double inner_px, double outer_px) const {
    double sum = 0;
    int count = 0;
    for_each(place, outer_px, [&](double x, double y, double dark) {
      if (inner_px <= 0 || x * x + y * y > inner_px * inner_px) {
        sum += dark;
        ++count;
      }
    });
    return count > 0 ? sum / count : not_a_number<double>();
  }

  /// Center of gravity of the darkness within a disc that follows it; NaN if there is none. The
  /// background does not bias it, as its mean darkness is 0.
  Place center_of_gravity(Place center, double reach_px) const {
    constexpr int max_rounds = 6;
    constexpr double small_px = 0.01;
    const Place start = center;
    for (int round = 0; round < max_rounds; ++round) {
      Place sum{0, 0};
      double weight = 0;
      for_each(center, reach_px, [&](double x, double y, double dark) {
        sum += dark * Place{x, y};
        weight += dark;
      });
      const Place step = sum / weight;
      center += step;
      if (!(weight > 0) || !(norm(center - start) <= reach_px)) {
        return no_place();
      }
      if (norm(step) < small_px) {
        break;
      }
    }
    return center;
  }

 private:
  /// Pixels within `half_px` of a place, along rows and columns.
  static cv::Rect square(const Place& place, double half_px) {
    const cv::Point first(static_cast<int>(std::ceil(place.x - half_px)),
                          static_cast<int>(std::ceil(place.y - half_px)));
    const cv::Point last(static_cast<int>(std::floor(place.x + half_px)),
                         static_cast<int>(std::floor(place.y + half_px)));
    return {first, last + cv::Point(1, 1)};
  }

  cv::Rect box_;
  std::vector<float> dark_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
