// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a stick ratio remembers from frame to frame, and the memory in which it works.
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

  /// As before the first frame.
  void reset() {
    forget();
    free_dots.reset();
    std::fill(free.begin(), free.end(), no_dot<Point2<S>>());
    noise_px = not_a_number<double>();
    clock = Clock();
    frame = 0;
  }
  Index stored_frames() const { return repository.size(); }

  /// The contact is over: nothing of it is comparable with the next.
  void forget() {
    repository.clear();
    std::fill(marks.begin(), marks.end(), DotState::none);
    result = StickRatioResult<S>{.status = StickStatus::no_dots};
  }

  DotLayout layout;
  FreeDots<Point2<S>> free_dots;
  double noise_px = not_a_number<double>();  // of the free frames
  GivenDots<Point2<S>> given;                // this frame
  Dots<Point2<S>> now;                       // of it, the dots in contact, in their places
  Dots<Point2<S>> free;                      // where they were when nothing touched
  MarkingRoom<S> room;
  std::vector<DotState> marks;            // what each dot did in the last answer
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

/// Of the dots that both frames have and that are marked at least as `least`, the one nearest to
/// `center`; -1 if there is none.
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

/// Where the search for sticking dots begins: the dot nearest to the centroid of the last stick
/// region; where none of it is left, the one nearest to that of the contact.
template <class S>
Index first_dot(const FramePair<S>& pair, const StickState<S>& state) {
  const Index tracked = nearest_dot(pair, state.stick_center, state.marks, DotState::stick);
  const DotState any = DotState::none;
  return tracked >= 0 ? tracked
                      : nearest_dot(pair, centroid(pair, state.marks, any), state.marks, any);
}

/// How many dots both frames have.
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
