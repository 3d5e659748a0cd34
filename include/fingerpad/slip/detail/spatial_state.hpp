// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// State of a stick ratio in space from frame to frame, and its working memory.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
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
  /// Returns to the state before the first frame.
  void reset() {
    forget();
    free_dots.reset();
    std::fill(free.begin(), free.end(), no_dot<Point3<S>>());
    noise = given_noise;
    clock = Clock();
    frame = 0;
  }
  Index stored_frames() const { return repository.size(); }
  /// Slip of each dot since the reference of the last answer; NaN if unknown.
  StridedView<const DotSlip<S>> slips() const {
    return {dot_slips.data(), layout.rows, layout.cols, layout.cols};
  }

  /// Noise of the dots along x and y, measured in free frames or as given.
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

  /// Call at the end of a contact: its frames cannot be compared with those of the next one.
  void forget() {
    repository.clear();
    has_center = false;
    clear_answer();
    std::fill(marks.begin(), marks.end(), DotState::none);
    result = SpatialStickResult<S>{.status = StickStatus::no_dots};
  }
  void clear_answer() { std::fill(dot_slips.begin(), dot_slips.end(), DotSlip<S>{}); }

  /// Index of a dot in a grid with a border of one cell.
  std::size_t padded(const DotIndex& d) const {
    return static_cast<std::size_t>((d.row + 1) * (layout.cols + 2) + d.col + 1);
  }

  /// An index behind that grid, with its own border.
  std::size_t spare() const { return padded({layout.rows + 2, 0}); }

  DotLayout layout;
  DotNoiseMm given_noise, noise;
  FreeDots<Point3<S>> free_dots;
  GivenDots<Point3<S>> given;  // this frame
  Dots<Point3<S>> now;         // of it, the dots in contact and in place
  Dots<Point3<S>> free;        // their positions without contact
  SpatialPairs<S> pairs;
  // a grid with a border of one cell, and three more rows
  std::vector<SmallSlip<S>> small_slips;
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
