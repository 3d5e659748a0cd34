// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The samples of a fingertip's frame, and the interpolation of their results to all pixels.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/detail/pad_area.hpp"
#include "fingerpad/depth/sampling.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A grid that owns its cells.
template <class T>
struct OwnedGrid {
  Index rows, cols;
  std::vector<T> cells;
  OwnedGrid(Index height, Index width)
      : rows(height), cols(width), cells(static_cast<std::size_t>(height * width)) {}
  StridedView<T> view() { return {cells.data(), rows, cols, cols}; }
  StridedView<const T> view() const { return {cells.data(), rows, cols, cols}; }
};

/// Red and green, or another pair.
template <class First, class Second>
struct Channels {
  First red;
  Second green;
};

/// Samples of Step x Step pixels. Maps over all pixels are computed on the first request per frame.
template <class Reference, class Pixel, int Step, int Threads>
class FrameSamples {
  using Sampler = FrameSampler<Pixel, Step>;

 public:
  using Cell = typename Sampler::Sample;

  explicit FrameSamples(const Reference& reference)
      : free_(reference),
        free_samples_(sampled(reference, Step)),
        red_(free_samples_.rows, free_samples_.cols),
        green_(red_),
        depth_(reference.rows, reference.cols),
        status_(reference.rows, reference.cols),
        touch_(reference.rows, reference.cols) {
    work_.fill(Sampler::workspace(reference.cols));
    for (Index i = 0; i < red_.rows; ++i) {
      PadArea row{i, 0, 1, 0};
      for (Index j = 0; j < red_.cols; ++j) {
        if (free_samples_.in_pad(i, j)) {
          row.col = row.cols == 0 ? j : row.col;
          row.cols = j + 1 - row.col;
        }
      }
      rows_.push_back(row);
    }
  }

  /// Samples a new frame, which must have the right size. Samples beside the pad stay 0.
  template <class Frame, class Executor>
  auto operator()(const Frame& frame, Executor& executor) {
    has_depth_ = has_touch_ = false;
    executor.bands(red_.rows, [&](int thread, Index first, Index last) {
      for (Index i = first; i < last; ++i) {
        const PadArea& to = rows_[static_cast<std::size_t>(i)];
        const PadArea from = {i * Step, to.col * Step, Step, to.cols * Step};
        (void)Sampler::band(0, 1, crop(frame.red, from), crop(frame.green, from),
                            crop(red_.view(), to), crop(green_.view(), to),
                            work_[static_cast<std::size_t>(thread)]);
      }
    });
    return Channels<StridedView<Cell>, StridedView<Cell>>{red_.view(), green_.view()};
  }

  StridedView<const float> depth(const OwnedGrid<float>& mm, const OwnedGrid<PixelStatus>& status) {
    spread(mm, status);
    return depth_.view();
  }
  StridedView<const PixelStatus> status(const OwnedGrid<float>& mm,
                                        const OwnedGrid<PixelStatus>& status) {
    spread(mm, status);
    return status_.view();
  }
  StridedView<const std::uint8_t> mask(const OwnedGrid<std::uint8_t>& touch) {
    for (Index i = 0; !has_touch_ && i < touch_.rows; ++i) {
      const auto from = touch.view();
      const Index row = (std::min)(i / Step, touch.rows - 1);
      for (Index j = 0; j < touch_.cols; ++j) {
        touch_.view()(i, j) = from(row, (std::min)(j / Step, touch.cols - 1));
      }
    }
    has_touch_ = true;
    return touch_.view();
  }

 private:
  void spread(const OwnedGrid<float>& mm, const OwnedGrid<PixelStatus>& status) {
    if (!has_depth_) {
      depth_between_samples(free_, free_samples_, Step, mm.view(), status.view(), depth_.view(),
                            status_.view());
      has_depth_ = true;
    }
  }

  Reference free_, free_samples_;
  std::vector<PadArea> rows_;  // in each row, from the first sample of the pad to the last
  OwnedGrid<Cell> red_, green_;
  OwnedGrid<float> depth_;
  OwnedGrid<PixelStatus> status_;
  OwnedGrid<std::uint8_t> touch_;
  std::array<typename Sampler::Workspace, static_cast<std::size_t>(Threads)> work_;
  bool has_depth_ = false;
  bool has_touch_ = false;
};

/// Each pixel is a sample.
template <class Reference, class Pixel, int Threads>
class FrameSamples<Reference, Pixel, 1, Threads> {
 public:
  using Cell = Pixel;

  explicit FrameSamples(const Reference&) {}

  template <class Frame, class Executor>
  const Frame& operator()(const Frame& frame, Executor&) {
    return frame;
  }
  StridedView<const float> depth(const OwnedGrid<float>& mm, const OwnedGrid<PixelStatus>&) {
    return mm.view();
  }
  StridedView<const PixelStatus> status(const OwnedGrid<float>&,
                                        const OwnedGrid<PixelStatus>& status) {
    return status.view();
  }
  StridedView<const std::uint8_t> mask(const OwnedGrid<std::uint8_t>& touch) {
    return touch.view();
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
