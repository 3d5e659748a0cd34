// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calls the loops over pixels that must work on vectors; count_vectors finds them by their names.
#include <cstdint>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/image/curvature.hpp"

using namespace fingerpad;

struct Frame {
  void operator()(Index row, std::uint16_t* red, std::uint16_t* green, std::uint8_t* counts) const;
};
void means_of(detail::WindowMeans<std::uint16_t, 2>& means,
              const Frame& frame,
              float* red,
              float* green) {
  means.start(0, frame);
  means.advance(frame, {{red, green}, {red, nullptr}});
}

bool curvature_of(CurvatureMap<>& map,
                  const StridedView<const float>& depth_mm,
                  const StridedView<float>& clamped,
                  const StridedView<float>& plain) {
  return map(depth_mm, clamped).ok() && map.mean(0, map.rows(), 0, map.cols(), plain);
}
