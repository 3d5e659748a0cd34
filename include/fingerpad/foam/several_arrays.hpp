// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A finger that consists of several arrays, as those of "Pre-Slip Sensing Using Tactile Sensor"
// (2007): 16 x 4 twice, 16 x 2 twice and 6 x 2, 204 elements on five sides. The samples of the
// arrays are joined to one sample of the finger, which the rules use like any other.
#include <algorithm>
#include <array>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/finger_sample.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Adds the sample of one array to that of its finger.
template <scalar S>
void add_array(const FingerSample<S>& array,
               const Point2<S>& place_mm,
               Index first_location,
               FingerSample<S>& finger) {
  if (array.is_pressed()) {
    const S sum = finger.is_pressed() ? finger.sum : S(0);
    const S share = array.sum / S(sum + array.sum);
    const S x = array.center_x_mm + place_mm.x, y = array.center_y_mm + place_mm.y;
    const bool is_first = !finger.is_pressed();
    finger.center_x_mm =
        is_first ? x : S(finger.center_x_mm + S(share * S(x - finger.center_x_mm)));
    finger.center_y_mm =
        is_first ? y : S(finger.center_y_mm + S(share * S(y - finger.center_y_mm)));
    finger.sum = sum + array.sum;
  }
  if (array.location >= 0 && value(array.deviation) > value(finger.deviation)) {
    finger.location = first_location + array.location;
    finger.waves = array.waves;
    finger.frequency_hz = array.frequency_hz;
    finger.deviation = array.deviation;
  }
  for (Index k = 0; k < array.vibration_count; ++k) {
    auto one = array.vibrations[static_cast<std::size_t>(k)];
    one.location += first_location;
    finger.add_vibration(one);
  }
  finger.left_out += array.left_out;
  finger.frozen += array.frozen;
  finger.gaps = (std::max)(finger.gaps, array.gaps);
}

}  // namespace detail

/// Joins the samples of a finger's arrays at one time to one sample of the finger. `places_mm` is
/// the position of the first taxel of each array in the unrolled plan of the finger's sides.
/// `taxels` is the number of taxels of each array; locations are numbered consecutively over the
/// arrays. The finger can be judged if one of its arrays can, so a side that touches nothing does
/// not matter. It is refused if an array is, and cannot be judged if an array vibrates that has
/// never rested.
template <std::size_t Arrays, scalar S>
FingerSample<S> finger_of(const std::array<FingerSample<S>, Arrays>& arrays,
                          const std::array<Point2<S>, Arrays>& places_mm,
                          const std::array<Index, Arrays>& taxels) {
  FingerSample<S> finger;
  const auto is_refused = [](const FingerSample<S>& a) {
    return a.status == TaxelStatus::other_size || a.status == TaxelStatus::time_not_later;
  };
  const auto refused = std::find_if(arrays.begin(), arrays.end(), is_refused);
  if (refused != arrays.end()) {
    finger.status = refused->status;
    return finger;
  }
  Index first_location = 0;
  finger.status = arrays[0].status;
  for (std::size_t k = 0; k < Arrays; ++k) {
    detail::add_array(arrays[k], places_mm[k], first_location, finger);
    first_location += taxels[k];
    // the statuses that can be judged come first
    finger.status = (std::min)(finger.status, arrays[k].status);
    finger.has_rested =
        finger.has_rested && (arrays[k].has_rested || arrays[k].status != TaxelStatus::vibrating);
  }
  return finger;
}

}  // namespace v0
}  // namespace fingerpad
