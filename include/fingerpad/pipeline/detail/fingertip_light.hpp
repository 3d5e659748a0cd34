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

  /// Of both colours, and of red over green, as logarithms.
  struct Change {
    double green = 0, balance = 0;
    explicit Change(const LightGains& g)
        : green(std::log(g.green)), balance(std::log(g.red / g.green)) {}
  };

  std::shared_ptr<const FreeLight<float>> free;  // constant, shared by copies
  LightGains gains = {};
  FreeLightResult last = {};     // of the last free frame
  LightGains first = {};         // of the first one
  int averaged = 0;              // free frames; 0: the light is that of the reference
  double frames = 0, since = 0;  // since the first free frame, and since the last

  bool is_known() const { return frames > 0; }
  /// What a change of light moves the depth by, mm.
  double moves_mm(double green, double balance) const {
    return std::hypot(last.mm_per_green * green, last.mm_per_balance * balance);
  }

  /// Takes a frame that touches nothing. The light stays what it was until it is seen to have
  /// changed; then it is the mean of the frames since. Returns how far the frame's depth is off, in
  /// mm, because its light is not what was expected.
  template <class Red, class Green>
  double learn(const Red& red, const Green& green) {
    const auto now = (*free)(red, green);
    if (!now) {
      return 0;
    }
    last = *now;
    const Change is(now->gains), was(gains);
    // A membrane does not rise in proportion to its height: over pads of rubber 9 to 14.5 mm high
    // on a base of 18.7 mm, 1 % of height seems at most 0.3 % of light.
    const double rise = 0.3 * std::abs(now->height - 1);
    const bool is_same =
        std::abs(is.balance - was.balance) < 4 * std::hypot(now->balance_sd, rise) &&
        std::abs(is.green - was.green) < 4 * std::hypot(now->green_sd, rise);
    averaged = !is_same ? 1 : averaged > 0 ? (std::min)(averaged + 1, mean_of) : 0;
    if (averaged > 0) {
      gains.green += (now->gains.green - gains.green) / averaged;
      gains.red += (now->gains.red - gains.red) / averaged;
    }
    first = is_known() ? first : gains;
    frames += since + 1;
    since = 0;
    return is_same ? 0.0 : moves_mm(is.green - was.green, is.balance - was.balance);
  }

  /// Takes note of a frame that touches something. Returns what the light may move its depth by, if
  /// it goes on as it did from the first free frame to the last, in mm.
  double hold() {
    if (!is_known()) {
      return 0;
    }
    since += 1;
    const Change is(gains), was(first);
    const double drifts = frames > 1 ? since / frames : 0.0, n = (std::max)(averaged, 1);
    return std::hypot(moves_mm(last.green_sd, last.balance_sd) / std::sqrt(n),
                      drifts * moves_mm(is.green - was.green, is.balance - was.balance));
  }
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
