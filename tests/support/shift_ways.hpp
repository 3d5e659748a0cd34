// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Choices of the shift of a contact, as types for templates of tests.
#include "fingerpad/motion/contact_shift.hpp"

namespace test {

struct EdgeDots {
  static constexpr bool edge = true;
};
struct ContactDots {
  static constexpr bool edge = false;
};
struct PlainMean {
  static constexpr bool is_robust = false;
  double threshold = 1.5;
  int passes = 0;
};
struct HuberMean {
  static constexpr bool is_robust = true;
  double threshold = 1.5;
  int passes = 10;
};

template <class Dots, class Mean = PlainMean>
fingerpad::ShiftOptions shift_by(const Mean& mean = {}) {
  return {.edge_dots = Dots::edge, .robust_passes = mean.passes, .threshold = mean.threshold};
}

}  // namespace test
