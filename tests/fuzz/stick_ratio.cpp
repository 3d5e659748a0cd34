// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratios of any dots, in the image and in space: a ratio is in [0, 1], a copied state gives
// the same bits, and whatever came before, a reset or lost contact is a start.
#include "fingerpad/slip/stick_ratio.hpp"

#include <cstdint>

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

/// Some frames; each again from a copy.
template <class Point>
void follow_stick(Input& in, Index rows, Index cols, double largest_noise) {
  StickRatio<> stick(rows, cols, {.noise = in.number(0, largest_noise)});
  for (Index frames = in.whole(1, 6); frames > 0; --frames) {
    const Grid<Point> dots = any_dots<Point>(in, rows, cols);
    const Grid<std::uint8_t> contact = any_contact(in, rows, cols);
    StickRatio<> copy = stick;
    const auto seen = fuzz::frame([&] { return stick(dots.view(), contact.view()); });
    const auto same = fuzz::frame([&] { return copy(dots.view(), contact.view()); });
    require_ratio(seen.stick_ratio);
    require(seen.status == same.status, "the same status");
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        require(stick.states()(i, j) == copy.states()(i, j), "a copy gives the same bits");
      }
    }
  }
}

void try_all(Input& in) {
  const Index rows = in.whole(0, 12), cols = in.whole(0, 12);
  if (in.whole(0, 1) == 0) {
    follow_stick<Point2<float>>(in, rows, cols, 0.3);
  } else {
    follow_stick<Point3<double>>(in, rows, cols, 0.1);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, try_all);
}
