// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratios of any dots, in the image and in space: a ratio is in [0, 1], a copied state gives
// the same bits, and whatever came before, a reset or lost contact is a start.
#include "fingerpad/slip/stick_ratio.hpp"

#include <cstdint>

#include "fingerpad/slip/spatial_stick_ratio.hpp"
#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::any_contact;
using fuzz::any_dots;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

template <class Ratio>
void require_ratio(const Ratio& ratio) {
  require(!is_finite(ratio) || (ratio >= 0 && ratio <= 1), "a ratio is in [0, 1]");
}

/// Some frames through an estimator with a state; the last one again from a copy of the state.
template <class Point, class Estimator, class Check>
void follow(Input& in, const Estimator& estimate, Index rows, Index cols, const Check& check) {
  auto state = estimate.start();
  Grid<DotState> states(rows, cols), again(rows, cols);
  for (Index frames = in.whole(1, 6); frames > 0; --frames) {
    const Grid<Point> dots = any_dots<Point>(in, rows, cols);
    const Grid<std::uint8_t> contact = any_contact(in, rows, cols);
    auto copy = state;
    const auto look = [&](auto& to, auto& memory) {
      return estimate(dots.view(), contact.view(), to.view(), memory);
    };
    const auto seen = fuzz::frame([&] { return look(states, state); });
    const auto same = fuzz::frame([&] { return look(again, copy); });
    check(seen, same);
    require(states == again, "a copied state gives the same bits");
  }
}

void try_all(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  switch (in.whole(0, 1)) {
    case 0: {
      StickTest test;
      test.reference = in.number(0.1, 5);
      test.store = in.number(0, 2);
      test.slip = in.number(0.01, 1);
      test.pitch = in.whole(0, 1) == 0 ? 0 : 1;
      follow<Point2<float>>(in, StickRatio<>(rows, cols, test), rows, cols,
                            [](const auto& seen, const auto& same) {
                              require_ratio(seen.stick_ratio);
                              require(seen.status == same.status, "the same status");
                            });
      break;
    }
    default: {
      SpatialStickTest test;
      test.lateral_mm = in.number(0.001, 0.1);
      test.depth_mm = in.number(0.001, 0.2);
      follow<Point3<double>>(in, SpatialStickRatio<>(rows, cols, test), rows, cols,
                             [](const auto& seen, const auto& same) {
                               require_ratio(seen.stick_ratio);
                               require(seen.status == same.status, "the same status");
                             });
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, try_all);
}
