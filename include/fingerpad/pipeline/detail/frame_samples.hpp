// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The samples of a fingertip's frame, and the interpolation of their results to all pixels.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/pad.hpp"
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

/// Depth of every pixel from the depth of samples: the difference from the free pad is interpolated
/// bilinearly and added to the free pad. Beside missing samples it is extrapolated from the other
/// side. A pixel has no depth if its own sample has none, except at the pad's rim, where a sample
/// may hold only some pixels. `free` and `free_samples` are the reference and sampled() of it; the
/// other grids have their sizes; false, and nothing written, where they have not. O(rows cols).
template <class Reference, class S>
[[nodiscard]] bool depth_between_samples(const Reference& free,
                                         const Reference& free_samples,
                                         int step,
                                         const StridedView<const S>& samples_mm,
                                         const StridedView<const PixelStatus>& sample_status,
                                         const StridedView<S>& depth_mm,
                                         const StridedView<PixelStatus>& status) {
  if (!same_size(samples_mm, sample_status) || !same_size(depth_mm, status) ||
      samples_mm.rows() != free_samples.rows || samples_mm.cols() != free_samples.cols ||
      depth_mm.rows() != free.rows || depth_mm.cols() != free.cols || step < 1 ||
      free.rows / step != free_samples.rows || free.cols / step != free_samples.cols) {
    return false;
  }
  const auto own = [step](Index px, Index count) { return (std::min)(px / step, count - 1); };
  const auto place = [step](Index px, Index count) {  // the sample before, and how far behind it
    const double at = sampled_px(static_cast<double>(px), step);
    const double last = static_cast<double>(count - 2);
    const double before = (std::max)(0.0, (std::min)(std::floor(at), last));
    return std::pair(static_cast<Index>(before), S(at - before));
  };
  const auto moved = [&](Index i, Index j) {
    return S(samples_mm(i, j) - S(free_samples.depth(i, j)));
  };
  const Index below = samples_mm.rows() > 1 ? 1 : 0;  // a single sample is everywhere
  const Index beyond = samples_mm.cols() > 1 ? 1 : 0;
  const auto between = [&](Index i, Index j, const S& down, const S& right) {
    const S up = moved(i, j) + right * (moved(i, j + beyond) - moved(i, j));
    const S low =
        moved(i + below, j) + right * (moved(i + below, j + beyond) - moved(i + below, j));
    return S(up + down * (low - up));
  };
  const auto beside = [&](Index i, Index j, const S& down, const S& right) {
    for (const Index di : {0, -1, 1}) {
      for (const Index dj : {0, -1, 1}) {
        const Index r = i + di, c = j + dj;
        if (r >= 0 && c >= 0 && r + below < samples_mm.rows() && c + beyond < samples_mm.cols()) {
          const S found = between(r, c, S(down - S(static_cast<double>(di))),
                                  S(right - S(static_cast<double>(dj))));
          if (found == found) {
            return found;
          }
        }
      }
    }
    return not_a_number<S>();
  };
  for (Index i = 0; i < depth_mm.rows(); ++i) {
    const auto [row, down] = place(i, samples_mm.rows());
    for (Index j = 0; j < depth_mm.cols(); ++j) {
      const auto [col, right] = place(j, samples_mm.cols());
      PixelStatus of = sample_status(own(i, samples_mm.rows()), own(j, samples_mm.cols()));
      S depth = not_a_number<S>();
      if (!free.in_pad(i, j)) {
        of = PixelStatus::outside_pad;
      } else if (of == PixelStatus::ok || of == PixelStatus::outside_pad) {
        const S known = between(row, col, down, right);
        depth = S(free.depth(i, j)) + (known == known ? known : beside(row, col, down, right));
        of = depth == depth ? PixelStatus::ok : PixelStatus::not_a_number;
      }
      depth_mm(i, j) = depth;
      status(i, j) = of;
    }
  }
  return true;
}

/// Samples of Step x Step pixels. Maps over all pixels are computed on the first request per frame.
template <class Pixel, int Step, int Threads>
class FrameSamples {
  using Sampler = FrameSampler<Pixel, Step>;

 public:
  using Cell = typename Sampler::Sample;

  explicit FrameSamples(const DepthReference<float>& reference)
      : free_(reference),
        free_samples_(sampled(reference, Step)),
        red_(free_samples_.rows, free_samples_.cols),
        green_(red_),
        depth_(reference.rows, reference.cols),
        status_(reference.rows, reference.cols),
        touch_(reference.rows, reference.cols),
        samplers_(static_cast<std::size_t>(Threads), Sampler(reference.cols)) {
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
        (void)samplers_[static_cast<std::size_t>(thread)].band(
            0, 1, crop(frame.red, from), crop(frame.green, from), crop(red_.view(), to),
            crop(green_.view(), to));
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
      has_depth_ = depth_between_samples(free_, free_samples_, Step, mm.view(), status.view(),
                                         depth_.view(), status_.view());
    }
  }

  DepthReference<float> free_, free_samples_;
  std::vector<PadArea> rows_;  // in each row, from the first sample of the pad to the last
  OwnedGrid<Cell> red_, green_;
  OwnedGrid<float> depth_;
  OwnedGrid<PixelStatus> status_;
  OwnedGrid<std::uint8_t> touch_;
  std::vector<Sampler> samplers_;  // one per thread
  bool has_depth_ = false;
  bool has_touch_ = false;
};

/// Each pixel is a sample.
template <class Pixel, int Threads>
class FrameSamples<Pixel, 1, Threads> {
 public:
  using Cell = Pixel;

  explicit FrameSamples(const DepthReference<float>&) {}

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
