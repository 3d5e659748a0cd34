// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The light of a fingertip's frames.
#include <algorithm>
#include <cmath>
#include <memory>

#include "fingerpad/depth/free_light.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// The light of the frames, measured where nothing touches and held in between.
struct FingertipLight {
  static constexpr int mean_of = 8;  // free frames in which it is the same

  std::shared_ptr<const FreeLight<float>> free;  // constant, shared by copies
  LightGains gains = {};
  bool is_known = false;
  int averaged = 0;     // free frames; 0: the light is that of the reference
  double brighter = 0;  // the membrane of the last free frame, in this light

  /// Takes a frame that touches nothing. The light stays what it was until it is seen to have
  /// changed; then it is the mean of the frames since. Returns how far the frame's depth is off, in
  /// mm, because its light is not what was expected.
  template <class Red, class Green, class Depth>
  double learn(const Red& red, const Green& green, const Depth& depth_mm) {
    const auto now = (*free)(red, green);
    if (!now) {
      return 0;
    }
    const double by_green = std::log(now->gains.green / gains.green);
    const double by_balance = std::log(now->gains.red / gains.red) - by_green;
    // A membrane does not rise in proportion to its height: over pads of rubber 9 to 14.5 mm high
    // on a base of 18.7 mm, 1 % of height seems at most 0.3 % of light.
    const double rise = 0.3 * std::abs(now->height - 1);
    const bool is_same = std::abs(by_balance) < 4 * std::hypot(now->balance_sd, rise) &&
                         std::abs(by_green) < 4 * std::hypot(now->green_sd, rise);
    brighter = is_same ? free->brightness(green, depth_mm, gains).share : 0.0;
    averaged = !is_same ? 1 : averaged > 0 ? (std::min)(averaged + 1, mean_of) : 0;
    if (averaged > 0) {
      gains.green += (now->gains.green - gains.green) / averaged;
      gains.red += (now->gains.red - gains.red) / averaged;
    }
    is_known = true;
    return is_same ? 0.0
                   : std::hypot(now->mm_per_green * by_green, now->mm_per_balance * by_balance);
  }

  /// Takes a frame that touches something. Returns how far its depth may be off, in mm, because the
  /// light has changed since the last free frame or, without one, since the reference.
  template <class Green, class Depth>
  double hold(const Green& green, const Depth& depth_mm) const {
    const Brightness now = free->brightness(green, depth_mm, gains);
    return std::abs(now.share - brighter) * now.mm_per_share;
  }
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
