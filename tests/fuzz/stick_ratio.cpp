// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratios of any dots, in the image and in space, and the object's motion: a ratio is in [0,
// 1], a copied state gives the same bits, and whatever came before, a reset or lost contact is a
// start.
#include "fingerpad/slip/stick_ratio.hpp"

#include <cstdint>

#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/slip/spatial_stick_ratio.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

template <class Ratio>
void require_ratio(const Ratio& ratio) {
  require(!is_finite(ratio) || (ratio >= 0 && ratio <= 1), "a ratio is in [0, 1]");
}

/// Dots near a lattice, so that they can be those of a pad, and strange ones among them.
template <class Point>
Grid<Point> any_dots(Input& in, Index rows, Index cols) {
  Grid<Point> dots(rows, cols, in.whole(0, 2));
  dots.fill(in, [&] {
    Point dot;
    dot.x = static_cast<decltype(dot.x)>(in.number(-1, 1));
    dot.y = static_cast<decltype(dot.x)>(in.number(-1, 1));
    if constexpr (requires { dot.z; }) {
      dot.z = static_cast<decltype(dot.x)>(in.number(5, 12));
    }
    return dot;
  });
  const double pitch = in.number(0.5, 25);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      Point& dot = dots.view()(i, j);
      dot.x += static_cast<decltype(dot.x)>(pitch * static_cast<double>(j));
      dot.y += static_cast<decltype(dot.x)>(pitch * static_cast<double>(i));
    }
  }
  return dots;
}

Grid<std::uint8_t> any_contact(Input& in, Index rows, Index cols) {
  Grid<std::uint8_t> contact(rows, cols);
  const bool all = in.flag();
  contact.fill(in, [&] { return static_cast<std::uint8_t>(all ? 1 : in.byte() & 1); });
  return contact;
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
      if constexpr (requires { estimate(dots.view(), contact.view(), memory); }) {
        return estimate(dots.view(), contact.view(), memory);
      } else {
        return estimate(dots.view(), contact.view(), to.view(), memory);
      }
    };
    const auto seen = fuzz::frame([&] { return look(states, state); });
    const auto same = fuzz::frame([&] { return look(again, copy); });
    check(seen, same);
    require(states == again, "a copied state gives the same bits");
  }
}

void try_all(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  switch (in.whole(0, 2)) {
    case 0: {
      StickTest test;
      test.reference_px = in.number(0.1, 5);
      test.store_px = in.number(0, 2);
      test.slip_px = in.number(0.01, 1);
      follow<Point2<float>>(in, StickRatio<>(rows, cols, test), rows, cols,
                            [](const auto& seen, const auto& same) {
                              require_ratio(seen.stick_ratio);
                              require(seen.status == same.status, "the same status");
                            });
      break;
    }
    case 1: {
      SpatialStickTest test;
      test.lateral_mm = in.number(0.001, 0.1);
      test.depth_mm = in.number(0.001, 0.2);
      follow<Point3<double>>(in, SpatialStickRatio<>(rows, cols, test), rows, cols,
                             [](const auto& seen, const auto& same) {
                               require_ratio(seen.stick_ratio);
                               require(seen.status == same.status, "the same status");
                             });
      break;
    }
    default: {
      const Grid<Point3<double>> free = any_dots<Point3<double>>(in, rows, cols);
      follow<Point3<double>>(in, ObjectMotion<>(free.view()), rows, cols,
                             [](const auto& seen, const auto& same) {
                               require(seen.status == same.status, "the same status");
                             });
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(data, size);
  try {
    try_all(in);
  } catch (const parameter_error&) {
    // refused, as it should be
  }
  return 0;
}
