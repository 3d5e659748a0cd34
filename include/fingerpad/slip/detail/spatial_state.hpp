// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a stick ratio in space remembers from frame to frame, and the memory in which it works.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "fingerpad/core/detail/reserved_vector.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/slip/detail/rigid_consensus.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

template <class S>
class SpatialState {
 public:
  /// As before the first frame.
  void reset() {
    forget();
    clock = Clock();
    frame = 0;
  }
  Index stored_frames() const { return repository.size(); }
  /// Slip of each dot since the reference of the last answer; NaN where it is not known.
  StridedView<const DotSlip<S>> slips() const {
    return {dot_slips.data(), layout.rows, layout.cols, layout.cols};
  }

  SpatialState(const DotLayout& layout_of_dots, Index capacity)
      : layout(layout_of_dots),
        given(layout),
        now(given.found),
        pairs(given.found.size()),
        pair_at(given.found.size(), -1),
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

  DotLayout layout;
  GivenDots<Point3<S>> given;  // this frame
  Dots<Point3<S>> now;         // of it, the dots in contact, in their places
  ReservedVector<SpatialPair<S>> pairs;
  std::vector<Index> pair_at;
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
