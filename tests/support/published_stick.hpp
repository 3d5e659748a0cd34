// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The printed stick ratio under the calls of StickRatio, for what measures both.
#include "fingerpad/published/stick_ratio.hpp"
#include "slipping_dots.hpp"

namespace test {

struct PublishedStick {
  using State = fingerpad::published::StickRatio<float>;
  State ratio = {21, 21};  ///< before any frame

  struct Result {
    fingerpad::published::StickRatioResult<float> printed;
    float stick_ratio = printed.stick_ratio, furthest_px = printed.furthest_px;
    Index reference_age = printed.reference_age;
    bool updated() const { return printed.ok(); }
    bool ok() const { return printed.ok(); }
  };

  Index rows() const { return ratio.rows(); }
  Index cols() const { return ratio.cols(); }
  State start() const { return ratio; }
  Result operator()(const PointsPx& dots,
                    const ContactFlags& contact,
                    const DotStates&,
                    State& state) const {
    return {.printed = state(dots, contact)};
  }
};

}  // namespace test
