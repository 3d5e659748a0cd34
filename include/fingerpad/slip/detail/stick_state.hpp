// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a stick ratio remembers from frame to frame, and the memory in which it works.
#include <algorithm>
#include <cstdint>
#include <limits>

#include "fingerpad/slip/denoising.hpp"
#include "fingerpad/slip/reference_choice.hpp"
#include "fingerpad/slip/stick_result.hpp"

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
    result = StickRatioResult<S>{.status = StickStatus::no_dots};
  }

  /// No dot of this frame but those of `run`, still to be written.
  void keep_of_now(const Run& run) {
    std::fill(now.x.begin(), now.x.begin() + run.begin, not_a_number<S>());
    std::fill(now.x.begin() + run.end, now.x.end(), not_a_number<S>());
  }

  DotLayout layout;
  GivenDots<S> given;  // this frame
  DotPlanes<S> now;    // of it, the dots in contact, in their places
  DotPlanes<S> scratch;
  Residuals<S> residuals;
  aligned_vector<S> marks;                // what each dot did in the last answer
  Point2<S> stick_center = {S(0), S(0)};  // of the last answer
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
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const auto sticks = least < load_cells<V, S>(state.marks.data() + k);
    const V x = load_cells<V, S>(state.now.x.data() + k);
    store_cells<S>(state.scratch.x.data() + k, V(choose(sticks, x, nothing)));
  }
  return {state.scratch.x.data(), state.now.y.data()};
}
template <class Reference, class S>
PlanesView<S> followed_dots(const Reference&, StickState<S>& state, const Run&) {
  return view(state.now);
}

/// The centroid of the dots that are marked at least as `least`; NaN if there is none.
template <class S>
Point2<S> centroid(const PlanesView<S>& now,
                   const Run& run,
                   const aligned_vector<S>& marks,
                   const S& least) {
  using V = run_vector<S>;
  const V zero = V{} + S(0), one = V{} + S(1), lowest = V{} + least;
  V count = zero, sum_x = zero, sum_y = zero;
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const V x = load_cells<V, S>(now.x + k), y = load_cells<V, S>(now.y + k);
    const V held =
        choose(load_cells<V, S>(marks.data() + k) < lowest, V(zero + no_distance_sq<S>()), zero);
    const auto counts = V(x * x + y * y + held) < no_distance_sq<S>();
    count += only_where(counts, one);
    sum_x += only_where(counts, x);
    sum_y += only_where(counts, y);
  }
  const S dots = sum_of_lanes<S>(count);
  return {S(sum_of_lanes<S>(sum_x) / dots), S(sum_of_lanes<S>(sum_y) / dots)};
}

/// Of the dots that both frames have: their number, and of those that are marked at least as
/// `least` the one nearest to `center`, -1 if there is none.
struct NearestDot {
  Index pairs = 0;
  Index cell = -1;
};
template <class S>
NearestDot nearest_dot(const FramePair<S>& pair,
                       const Point2<S>& center,
                       const aligned_vector<S>& marks,
                       const S& least,
                       aligned_vector<S>& minus_distance_sq) {
  using V = run_vector<S>;
  const V zero = V{} + S(0), one = V{} + S(1), lowest = V{} + least;
  const V far = zero - no_distance_sq<S>();
  V count = zero, nearest = far;
  for (Index k = pair.run.begin; k < pair.run.end; k += run_step<S>) {
    const V x = load_cells<V, S>(pair.now.x + k), y = load_cells<V, S>(pair.now.y + k);
    const V moved_x = x - load_cells<V, S>(pair.then.x + k);
    const V moved_y = y - load_cells<V, S>(pair.then.y + k);
    const auto known = V(moved_x * moved_x + moved_y * moved_y) < no_distance_sq<S>();
    count += only_where(known, one);
    const V dx = x - center.x, dy = y - center.y;
    const V marked =
        choose(load_cells<V, S>(marks.data() + k) < lowest, far, V(zero - dx * dx - dy * dy));
    const V minus_sq = choose(known, marked, far);
    nearest = choose(nearest < minus_sq, minus_sq, nearest);
    store_cells<S>(minus_distance_sq.data() + k, minus_sq);
  }
  NearestDot found{static_cast<Index>(value(sum_of_lanes<S>(count))), -1};
  const S best = largest_lane<S>(nearest);
  if (-no_distance_sq<S>() < best) {
    found.cell = pair.run.begin;
    while (minus_distance_sq[static_cast<std::size_t>(found.cell)] < best) {
      ++found.cell;
    }
  }
  return found;
}

template <class S>
NearestDot first_dot(const CentralDot&, const FramePair<S>& pair, StickState<S>& state) {
  const S any = S(0);
  const Point2<S> center = centroid(pair.now, pair.run, state.marks, any);
  return nearest_dot(pair, center, state.marks, any, state.scratch.y);
}
template <class S>
NearestDot first_dot(const TrackedDot&, const FramePair<S>& pair, StickState<S>& state) {
  const NearestDot tracked =
      nearest_dot(pair, state.stick_center, state.marks, DotMarks<S>::stick(), state.scratch.y);
  return tracked.cell >= 0 ? tracked : first_dot(CentralDot(), pair, state);
}

/// Settles what each dot does: marks of dots that do not touch any more are dropped, dots that
/// newly touch are unknown. Counts them.
template <class S>
void settle_marks(StickState<S>& state) {
  using V = run_vector<S>;
  const V none = V{} + S(0), one = V{} + S(1);
  const V unknown = V{} + DotMarks<S>::unknown(), slip = V{} + DotMarks<S>::slip(),
          stick = V{} + DotMarks<S>::stick();
  V slipping = none, sticking = none, touching = none;
  const Run run = state.layout.run(0, state.layout.rows - 1);
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const V touch = load_cells<V, S>(state.given.touch.data() + k);
    const V last = load_cells<V, S>(state.marks.data() + k);
    const auto touches = touch < one;  // 0, not NaN
    const V mark = only_where(touches, V(choose(last < unknown, unknown, last)));
    touching += only_where(touches, one);
    slipping += choose(mark < slip, none, one);
    sticking += choose(mark < stick, none, one);
    store_cells<S>(state.marks.data() + k, mark);
  }
  const auto count = [](const V& v) { return static_cast<Index>(value(sum_of_lanes<S>(v))); };
  state.result.stick = count(sticking);
  state.result.slip = count(slipping) - count(sticking);
  state.result.unknown = count(touching) - count(slipping);
}

template <class S, class States>
void write_states(const StickState<S>& state, const States& to) {
  using Cell = cell_t<States>;
  for (Index i = 0; i < state.layout.rows; ++i) {
    const S* const marks = state.marks.data() + state.layout.at(i, 0);
    with_row(to, i, [&](const auto& cell) {
      for (Index j = 0; j < state.layout.cols; ++j) {
        cell(j) = static_cast<Cell>(static_cast<DotState>(static_cast<int>(value(marks[j]))));
      }
    });
  }
}

/// 0 for dots that have eight neighbours in the grid, else NaN.
template <class S>
aligned_vector<S> inner_dots(const DotLayout& layout) {
  aligned_vector<S> inner(layout.cells<S>(), not_a_number<S>());
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
