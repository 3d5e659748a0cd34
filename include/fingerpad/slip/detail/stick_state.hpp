// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// State of a stick ratio from frame to frame, and its working memory.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "fingerpad/slip/detail/dot_doubts.hpp"
#include "fingerpad/slip/detail/dot_frames.hpp"
#include "fingerpad/slip/detail/free_dots.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// U, U_min and delta_0, in the unit of the dots.
struct StickLengths {
  double reference, store, slip;
};

template <class S>
class StickState {
 public:
  StickState(const DotLayout& layout_of_dots, Index capacity)
      : layout(layout_of_dots),
        free_dots(layout),
        given(layout),
        now(given.found),
        free(given.found),
        room{given.found, DotDoubts<S>(layout)},
        marks(given.found.size(), DotState::none),
        repository(layout, capacity) {}

  /// Returns to the state before the first frame.
  void reset() {
    forget();
    free_dots.reset();
    std::fill(free.begin(), free.end(), no_dot<Point2<S>>());
    noise_px = not_a_number<double>();
    clock = Clock();
    frame = 0;
  }
  Index stored_frames() const { return repository.size(); }

  /// Call at the end of a contact: its frames cannot be compared with those of the next one.
  void forget() {
    repository.clear();
    std::fill(marks.begin(), marks.end(), DotState::none);
    result = StickRatioResult<S>{.status = StickStatus::no_dots};
  }

  DotLayout layout;
  FreeDots<Point2<S>> free_dots;
  double noise_px = not_a_number<double>();  // of the free frames
  GivenDots<Point2<S>> given;                // this frame
  Dots<Point2<S>> now;                       // of it, the dots in contact and in place
  Dots<Point2<S>> free;                      // their positions without contact
  MarkingRoom<S> room;
  std::vector<DotState> marks;            // of each dot in the last answer
  Point2<S> stick_center = {S(0), S(0)};  // of the last answer
  S pitch_sq = S(0);                      // of the first frame of this contact
  Repository<Point2<S>> repository;
  StickRatioResult<S> result;
  std::int64_t frame = 0;
  Clock clock;
};

/// The centroid of the dots in contact that are marked at least as `least`; NaN if there is none.
template <class S>
Point2<S> centroid(const FramePair<S>& pair, const std::vector<DotState>& marks, DotState least) {
  Point2<S> sum = {S(0), S(0)};
  int count = 0;
  for (const Index k : pair.touching) {
    if (marks[static_cast<std::size_t>(k)] >= least && is_finite(pair.now[k])) {
      sum += pair.now[k];
      ++count;
    }
  }
  return sum / S(count);
}

/// The dot nearest to `center` among those found in both frames and marked at least as `least`; -1
/// if there is none.
template <class S>
Index nearest_dot(const FramePair<S>& pair,
                  const Point2<S>& center,
                  const std::vector<DotState>& marks,
                  DotState least) {
  Index nearest = -1;
  S nearest_sq = no_distance_sq<S>();
  for (const Index k : pair.touching) {
    const bool asked = marks[static_cast<std::size_t>(k)] >= least && is_finite(pair.then[k]);
    const S sq = squared_norm(pair.now[k] - center);
    if (asked && sq < nearest_sq) {
      nearest = k;
      nearest_sq = sq;
    }
  }
  return nearest;
}

/// The dot at which the search for sticking dots begins: the one nearest to the centroid of the
/// last stick region or, if none of its dots is left, to that of the contact.
template <class S>
Index first_dot(const FramePair<S>& pair, const StickState<S>& state) {
  const Index tracked = nearest_dot(pair, state.stick_center, state.marks, DotState::stick);
  const DotState any = DotState::none;
  return tracked >= 0 ? tracked
                      : nearest_dot(pair, centroid(pair, state.marks, any), state.marks, any);
}

/// Number of dots found in both frames.
template <class S>
Index count_pairs(const FramePair<S>& pair) {
  Index count = 0;
  for (const Index k : pair.touching) {
    count += is_distance_sq(squared_norm(pair.now[k] - pair.then[k])) ? 1 : 0;
  }
  return count;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
