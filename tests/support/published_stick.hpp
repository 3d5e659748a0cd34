// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The printed stick ratio under the calls of StickRatio, for what measures both.
#include "fingerpad/published/stick_ratio.hpp"
#include "slipping_dots.hpp"

namespace test {

struct PublishedStick {
  fingerpad::published::StickRatio<float> ratio = {21, 21};

  struct Result {
    fingerpad::published::StickRatioResult<float> printed;
    float stick_ratio = printed.stick_ratio, furthest = printed.furthest_px;
    Index reference_age = printed.reference_age;
    bool updated() const { return printed.ok(); }
    bool ok() const { return printed.ok(); }
  };

  Index rows() const { return ratio.rows(); }
  Index cols() const { return ratio.cols(); }
  Result operator()(const PointsPx& dots, const ContactFlags& contact) {
    return {.printed = ratio(dots, contact)};
  }
  /// The printed method only counts.
  auto states() const {
    return fingerpad::LazyView(rows(), cols(),
                               [](Index, Index) { return fingerpad::DotState::none; });
  }
};

}  // namespace test
