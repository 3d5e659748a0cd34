// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Scene of the benchmarks: the published pad in 640 x 480 pixels from two cameras, with the rays,
// dots and noise of tests/support/pad.hpp.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "support/pad.hpp"

namespace bench {

using fingerpad::Index;
using test::Frame;
using test::Image;
using test::Pad;

/// A spherical cap 13 mm high on a base of 18.735 mm, free and under a flat plate 3.5 mm below its
/// top.
struct Scene {
  std::string name;
  Pad pad;
  Image<double> free_mm;
  Image<double> pressed_mm;

  Scene(const std::string& label, double pitch_mm, double max_depth_mm) : name(label) {
    pad.fluid.max_depth_mm = max_depth_mm;
    pad.rows = 480;
    pad.cols = 640;
    pad.camera.pitch_mm = pitch_mm;
    pad.camera.center_x_px = 319.5;
    pad.camera.center_y_px = 239.5;
    free_mm = pad.free_depths();
    pressed_mm = pad.pressed_depths(3.5);
  }

  std::size_t pixels() const { return free_mm.cells.size(); }
  double noise = 1;  ///< grey levels

  template <class Pixel>
  Frame<Pixel> pressed_frame() const {
    return pad.frame<Pixel>(pressed_mm, noise);
  }
};

/// Every pixel sees the pad; the corners see its rim, at depths near 0.
inline Scene full_pad(double max_depth_mm = 14) {
  return {"full pad", 0.0468, max_depth_mm};
}
/// The published scale: 488 pixels wide, with four rows beyond either edge of the image.
inline Scene round_pad() {
  return {"round pad", 0.0768, 14};
}

/// Both channels interleaved as BGR BGR ...
template <class Pixel>
struct Interleaved {
  Image<Pixel> cells;

  explicit Interleaved(const Frame<Pixel>& frame) : cells(frame.red.rows(), 3 * frame.red.cols()) {
    for (Index i = 0; i < frame.red.rows(); ++i) {
      for (Index j = 0; j < frame.red.cols(); ++j) {
        cells(i, 3 * j + 1) = frame.green(i, j);
        cells(i, 3 * j + 2) = frame.red(i, j);
      }
    }
  }
  fingerpad::StridedView<const Pixel> channel(Index c) const {
    return fingerpad::interleaved_channel(cells.cells.data(), cells.rows(), cells.cols() / 3, 3, c,
                                          cells.cols());
  }
  auto green() const { return channel(1); }
  auto red() const { return channel(2); }
};

/// |found - truth| of every pixel that has a truth; NaN where no depth was found.
template <class S, class T>
std::vector<double> errors_of(const Image<S>& found, const Image<T>& truth) {
  std::vector<double> errors;
  for (std::size_t k = 0; k < truth.cells.size(); ++k) {
    if (!(truth.cells[k] != truth.cells[k])) {
      using Wide = std::common_type_t<S, T>;
      errors.push_back(static_cast<double>(std::abs(Wide(found.cells[k]) - Wide(truth.cells[k]))));
    }
  }
  return errors;
}

/// The value of `make`, made at the first call and then shared by all copies, because truths take
/// longer to compute than the rows that are compared with them.
template <class Make>
auto kept(Make make) {
  using Value = decltype(make());
  return [make, value = std::make_shared<std::optional<Value>>()]() -> const Value& {
    if (!*value) {
      *value = make();
    }
    return **value;
  };
}

}  // namespace bench
