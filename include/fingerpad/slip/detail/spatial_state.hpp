// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a stick ratio in space remembers from frame to frame, and the memory in which it works.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "fingerpad/core/detail/reserved_vector.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/slip/detail/dot_doubts.hpp"
#include "fingerpad/slip/detail/free_dots.hpp"
#include "fingerpad/slip/detail/rigid_consensus.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

struct DotNoiseMm {
  double lateral_mm, depth_mm;
};

template <class S>
class SpatialState {
 public:
  /// As before the first frame.
  void reset() {
    forget();
    free_dots.reset();
    std::fill(free.begin(), free.end(), no_dot<Point3<S>>());
    noise = given_noise;
    clock = Clock();
    frame = 0;
  }
  Index stored_frames() const { return repository.size(); }
  /// Slip of each dot since the reference of the last answer; NaN where it is not known.
  StridedView<const DotSlip<S>> slips() const {
    return {dot_slips.data(), layout.rows, layout.cols, layout.cols};
  }

  /// Noise of the dots along x and y, of the free frames or as it was given.
  double lateral_mm() const { return noise.lateral_mm; }

  SpatialState(const DotLayout& layout_of_dots, Index capacity, const DotNoiseMm& noise_mm)
      : layout(layout_of_dots),
        given_noise(noise_mm),
        noise(noise_mm),
        free_dots(layout),
        given(layout),
        now(given.found),
        free(given.found),
        pairs(given.found.size()),
        small_slips(static_cast<std::size_t>((layout.rows + 5) * (layout.cols + 2))),
        doubts(layout),
        sorted(given.found.size()),
        dot_slips(given.found.size()),
        marks(given.found.size(), DotState::none),
        repository(layout, capacity) {}

  /// The contact is over: nothing of it is comparable with the next.
  void forget() {
    repository.clear();
    has_center = false;
    clear_answer();
    std::fill(marks.begin(), marks.end(), DotState::none);
    result = SpatialStickResult<S>{.status = StickStatus::no_dots};
  }
  void clear_answer() { std::fill(dot_slips.begin(), dot_slips.end(), DotSlip<S>{}); }

  /// Where a dot is in a grid with a border of one cell.
  std::size_t padded(const DotIndex& d) const {
    return static_cast<std::size_t>((d.row + 1) * (layout.cols + 2) + d.col + 1);
  }

  /// A place behind that grid, with a border of its own.
  std::size_t spare() const { return padded({layout.rows + 2, 0}); }

  DotLayout layout;
  DotNoiseMm given_noise, noise;
  FreeDots<Point3<S>> free_dots;
  GivenDots<Point3<S>> given;  // this frame
  Dots<Point3<S>> now;         // of it, the dots in contact, in their places
  Dots<Point3<S>> free;        // where they were when nothing touched
  SpatialPairs<S> pairs;
  std::vector<SmallSlip<S>>
      small_slips;  // of a grid with a border of one cell, and three rows more
  DotDoubts<S> doubts;
  std::vector<S> sorted;
  std::vector<DotSlip<S>> dot_slips;
  std::vector<DotState> marks;
  Point3<S> stick_center = {S(0), S(0), S(0)};
  bool has_center = false;
  S pitch_sq = S(0);
  Repository<Point3<S>> repository;
  SpatialStickResult<S> result;
  std::int64_t frame = 0;
  Clock clock;
};

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
