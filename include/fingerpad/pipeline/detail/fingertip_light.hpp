// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The light of a fingertip's frames.
#include <algorithm>
#include <cmath>
#include <memory>

#include "fingerpad/depth/free_light.hpp"

namespace fingerpad {
inline namespace v0 {
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
  int averaged = 0;              // free frames
  double frames = 0, since = 0;  // since the first free frame, and since the last

  bool is_known() const { return averaged > 0; }

  /// What a change of light moves the depth by, mm.
  double moves_mm(double green, double balance) const {
    return std::hypot(last.mm_per_green * green, last.mm_per_balance * balance);
  }

  /// Takes a frame that touches nothing. Returns how far its depth is off because its light is not
  /// what was expected, in mm.
  template <class Red, class Green>
  double learn(const Red& red, const Green& green) {
    const auto now = (*free)(red, green);
    if (!now) {
      return 0;
    }
    const Change is(now->gains), was(gains);
    const bool is_same = is_known() &&
                         std::abs(is.balance - was.balance) < 4 * std::sqrt(2) * now->balance_sd &&
                         std::abs(is.green - was.green) < 4 * std::sqrt(2) * now->green_sd;
    first = is_known() ? first : now->gains;
    averaged = is_same ? (std::min)(averaged + 1, mean_of) : 1;
    gains.green += (now->gains.green - gains.green) / averaged;
    gains.red += (now->gains.red - gains.red) / averaged;
    last = *now;
    frames += since + 1;
    since = 0;
    return moves_mm(is.green - was.green, is.balance - was.balance);
  }

  /// Takes note of a frame that touches something. Returns what the light may move its depth by, if
  /// it goes on as it did from the first free frame to the last, in mm.
  double hold() {
    if (!is_known()) {
      return 0;
    }
    since += 1;
    const Change is(gains), was(first);
    const double drifts = frames > 1 ? since / frames : 0.0, n = averaged;
    return std::hypot(moves_mm(last.green_sd, last.balance_sd) / std::sqrt(n),
                      drifts * moves_mm(is.green - was.green, is.balance - was.balance));
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
