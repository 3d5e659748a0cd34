// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a stick ratio remembers from frame to frame, and the memory in which it works.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "fingerpad/detail/stick/denoising.hpp"
#include "fingerpad/detail/stick/reference_choice.hpp"
#include "fingerpad/detail/stick/stick_result.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

template <class S>
class StickState {
 public:
  StickState(const DotLayout& layout_of_dots, Index capacity)
      : layout(layout_of_dots),
        given(layout),
        now(layout),
        scratch(layout),
        residuals(layout),
        marks(layout.cells<S>(), S(0)),
        repository(layout, capacity) {}

  /// As before the first frame.
  void reset() {
    forget();
    time_s = -std::numeric_limits<double>::infinity();
    frame = 0;
  }
  Index stored_frames() const { return repository.size(); }

  /// The contact is over: nothing of it is comparable with the next.
  void forget() {
    repository.clear();
    std::fill(marks.begin(), marks.end(), S(0));
    result = StickRatioResult<S>{.accepted = true};
  }

  void clear_now() { std::fill(now.x.begin(), now.x.end(), not_a_number<S>()); }

  DotLayout layout;
  GivenDots<S> given;  // this frame
  DotPlanes<S> now;    // of it, the dots in contact, in their places
  DotPlanes<S> scratch;
  Residuals<S> residuals;
  line_vector<S> marks;  // what each dot did in the last answer
  Repository<S> repository;
  StickRatioResult<S> result;
  std::int64_t frame = 0;
  double time_s = -std::numeric_limits<double>::infinity();
};

/// Dots whose displacement is looked at for the reference.
template <class S>
PlanesView<S> followed_dots(const UpdatedReference<InStickRegion>&,
                            StickState<S>& state,
                            const Run& run) {
  using V = run_vector<S>;
  if (state.result.stick == 0) {
    return view(state.now);
  }
  const V nothing = V{} + not_a_number<S>(), least = V{} + DotMarks<S>::slip();
  for_each_vector<S>(run.begin, run.end, [&](Index k) {
    const auto sticks = least < load_cells<V, S>(state.marks.data() + k);
    const V x = load_cells<V, S>(state.now.x.data() + k);
    store_cells<S>(state.scratch.x.data() + k, V(choose(sticks, x, nothing)));
  });
  return {state.scratch.x.data(), state.now.y.data()};
}
template <class Reference, class S>
PlanesView<S> followed_dots(const Reference&, StickState<S>& state, const Run&) {
  return view(state.now);
}

/// The dot of both frames nearest to the centroid of those that are marked at least as `least`; -1
/// if there is none.
template <class S>
Index nearest_to_centroid(const FramePair<S>& pair,
                          const line_vector<S>& marks,
                          const S& least,
                          line_vector<S>& distance_sq) {
  using V = run_vector<S>;
  const V zero = V{} + S(0), one = V{} + S(1), lowest = V{} + least;
  V count = zero, sum_x = zero, sum_y = zero;
  const auto counts = [&](Index k, const V& x, const V& y) {
    const V dx = x - load_cells<V, S>(pair.then.x + k), dy = y - load_cells<V, S>(pair.then.y + k);
    const V unmarked =
        choose(load_cells<V, S>(marks.data() + k) < lowest, V(zero + no_distance_sq<S>()), zero);
    return V(dx * dx + dy * dy + unmarked) < no_distance_sq<S>();
  };
  for_each_vector<S>(pair.run.begin, pair.run.end, [&](Index k) {
    const V x = load_cells<V, S>(pair.now.x + k), y = load_cells<V, S>(pair.now.y + k);
    const auto is_in = counts(k, x, y);
    count += choose(is_in, one, zero);
    sum_x += choose(is_in, x, zero);
    sum_y += choose(is_in, y, zero);
  });
  const S dots = sum_of_lanes<S>(count);
  if (!(S(0) < dots)) {
    return -1;
  }
  const S center_x = sum_of_lanes<S>(sum_x) / dots, center_y = sum_of_lanes<S>(sum_y) / dots;
  V nearest = zero - no_distance_sq<S>();  // of negative squares, the largest
  for_each_vector<S>(pair.run.begin, pair.run.end, [&](Index k) {
    const V x = load_cells<V, S>(pair.now.x + k), y = load_cells<V, S>(pair.now.y + k);
    const V dx = x - center_x, dy = y - center_y;
    const V minus_sq =
        choose(counts(k, x, y), V(zero - dx * dx - dy * dy), V(zero - no_distance_sq<S>()));
    nearest = choose(nearest < minus_sq, minus_sq, nearest);
    store_cells<S>(distance_sq.data() + k, minus_sq);
  });
  const S best = largest_lane<S>(nearest);
  Index k = pair.run.begin;
  while (k + 1 < pair.run.end && distance_sq[static_cast<std::size_t>(k)] < best) {
    ++k;
  }
  return k;
}

template <class S>
Index first_dot(const CentralDot&, const FramePair<S>& pair, StickState<S>& state) {
  return nearest_to_centroid(pair, state.marks, S(0), state.scratch.y);
}
template <class S>
Index first_dot(const TrackedDot&, const FramePair<S>& pair, StickState<S>& state) {
  const Index tracked =
      nearest_to_centroid(pair, state.marks, DotMarks<S>::stick(), state.scratch.y);
  return tracked >= 0 ? tracked : first_dot(CentralDot(), pair, state);
}

/// Dots that both frames have.
template <class S>
Index count_pairs(const FramePair<S>& pair) {
  using V = run_vector<S>;
  const V one = V{} + S(1), zero = V{} + S(0);
  V count = zero;
  for_each_vector<S>(pair.run.begin, pair.run.end, [&](Index k) {
    const V dx = load_cells<V, S>(pair.now.x + k) - load_cells<V, S>(pair.then.x + k);
    const V dy = load_cells<V, S>(pair.now.y + k) - load_cells<V, S>(pair.then.y + k);
    count += choose(V(dx * dx + dy * dy) < no_distance_sq<S>(), one, zero);
  });
  return static_cast<Index>(value(sum_of_lanes<S>(count)));
}

/// Writes what each dot does, and counts it. Marks of dots that do not touch any more are dropped.
template <class S, class States>
void write_states(StickState<S>& state, const States& to) {
  using Cell = cell_t<States>;
  std::array<Index, 4> counts = {};
  for (Index i = 0; i < state.layout.rows; ++i) {
    const std::size_t row = static_cast<std::size_t>(state.layout.at(i, 0));
    const S* const touch = state.given.touch.data() + row;
    S* const marks = state.marks.data() + row;
    for (Index j = 0; j < state.layout.cols; ++j) {
      const bool touches = touch[j] < S(1);  // 0, not NaN
      marks[j] =
          touches ? (marks[j] < DotMarks<S>::unknown() ? DotMarks<S>::unknown() : marks[j]) : S(0);
      const auto mark = static_cast<std::size_t>(value(marks[j]));
      ++counts[mark];
      to(i, j) = static_cast<Cell>(static_cast<DotState>(mark));
    }
  }
  state.result.unknown = counts[1];
  state.result.slip = counts[2];
  state.result.stick = counts[3];
}

/// 0 for dots that have eight neighbours in the grid, else NaN.
template <class S>
line_vector<S> inner_dots(const DotLayout& layout) {
  line_vector<S> inner(layout.cells<S>(), not_a_number<S>());
  for (Index i = 1; i + 1 < layout.rows; ++i) {
    for (Index j = 1; j + 1 < layout.cols; ++j) {
      inner[static_cast<std::size_t>(layout.at(i, j))] = S(0);
    }
  }
  return inner;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
