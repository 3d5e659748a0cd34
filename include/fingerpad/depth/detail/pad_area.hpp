// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rectangle of pixels that holds the pad. All work per frame is limited to it; pixels outside
// are only marked.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// `rows` x `cols` pixels from (row, col) on.
struct PadArea {
  Index row = 0;
  Index col = 0;
  Index rows = 0;
  Index cols = 0;
  bool operator==(const PadArea&) const = default;
};

/// A reference and its camera in the coordinates of the pad's rectangle, and the place of this
/// rectangle in frames of rows x cols pixels.
template <class S, class Scattering, class Heights>
struct PadReference {
  Index rows;
  Index cols;
  PadArea area;
  Camera<double> camera;
  DepthReference<S, Scattering, Heights> reference;
};

template <class S, class Scattering, class Heights>
PadReference<S, Scattering, Heights> crop_to_pad(
    const Camera<double>& camera, const DepthReference<S, Scattering, Heights>& reference) {
  Index first_row = reference.rows;
  Index last_row = 0;
  Index first_col = reference.cols;
  Index last_col = 0;
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      if (reference.in_pad(i, j)) {
        first_row = (std::min)(first_row, i);
        last_row = i + 1;
        first_col = (std::min)(first_col, j);
        last_col = (std::max)(last_col, j + 1);
      }
    }
  }
  const PadArea area{first_row, first_col, last_row - first_row, last_col - first_col};
  PadReference<S, Scattering, Heights> pad{reference.rows, reference.cols, area, camera, {}};
  pad.camera.center_x_px -= static_cast<double>(area.col);
  pad.camera.center_y_px -= static_cast<double>(area.row);
  pad.reference.rows = area.rows;
  pad.reference.cols = area.cols;
  pad.reference.rim_green = reference.rim_green;
  pad.reference.scattering = reference.scattering.cropped(area.row, area.col, area.rows, area.cols);
  for (Index i = 0; i < area.rows; ++i) {
    for (Index j = 0; j < area.cols; ++j) {
      pad.reference.depth_mm.push_back(reference.depth(area.row + i, area.col + j));
    }
  }
  return pad;
}

/// 1 for each pixel that has a depth in the reference and a g > 0, else 0. Other pixels would spoil
/// the windows that contain them.
template <class S, class Scattering, class Heights>
std::vector<std::uint8_t> usable_pixels(const Camera<double>& camera,
                                        const DepthReference<S, Scattering, Heights>& reference) {
  std::vector<std::uint8_t> usable;
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
      const S g = reference.scattering(i, j, S(square(ray.plate_rho_mm)));
      usable.push_back(reference.in_pad(i, j) && is_finite(g) && value(g) > 0 ? 1 : 0);
    }
  }
  return usable;
}

/// A view of the pad's rectangle in a frame.
template <class T>
StridedView<T> crop(const StridedView<T>& frame, const PadArea& area) {
  return region(frame, area.row, area.col, area.rows, area.cols);
}
template <class View>
auto crop(const View& frame, const PadArea& area) {
  return LazyView(area.rows, area.cols, [frame, area](Index i, Index j) -> decltype(auto) {
    return frame(area.row + i, area.col + j);
  });
}

/// Writes `cell` to all cells of rows [first, last) that lie outside the pad's rectangle.
template <class View, class Cell>
void fill_outside(
    const PadArea& area, Index first, Index last, const View& view, const Cell& cell) {
  for (Index i = first; i < last; ++i) {
    const bool crosses = i >= area.row && i < area.row + area.rows;
    const Index left = crosses ? area.col : view.cols();
    for (Index j = 0; j < left; ++j) {
      view(i, j) = cell;
    }
    for (Index j = crosses ? area.col + area.cols : view.cols(); j < view.cols(); ++j) {
      view(i, j) = cell;
    }
  }
}

/// How many of the first `count` bytes are zero, up to the first that is not.
inline Index count_zeros(const std::uint8_t* bytes, Index count) {
  Index n = 0;
  std::uint64_t eight = 0;
  for (; n + 8 <= count; n += 8) {
    std::memcpy(&eight, bytes + n, sizeof eight);
    if (eight != 0) {
      break;
    }
  }
  while (n < count && bytes[n] == 0) {
    ++n;
  }
  return n;
}

/// How many of the first `count` pixels are inside the pad (1) with status ok (0), up to the first
/// that is not.
inline Index count_well(const std::uint8_t* inside, const PixelStatus* status, Index count) {
  Index n = 0;
  std::uint64_t in = 0;
  std::uint64_t is = 0;
  for (; n + 8 <= count; n += 8) {
    std::memcpy(&in, inside + n, sizeof in);
    std::memcpy(&is, status + n, sizeof is);
    if (in != 0x0101010101010101u || is != 0) {
      break;
    }
  }
  while (n < count && inside[n] != 0 && status[n] == PixelStatus::ok) {
    ++n;
  }
  return n;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
