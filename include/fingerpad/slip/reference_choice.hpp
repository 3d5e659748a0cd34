// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Policies: with which frame the present one is compared.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/slip/detail/dot_planes.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::stick {

// Stored frames, of which one is the reference. Source: slides "First point: required size of
// displacement" and "Second point: change of moving direction" of 003.

/// d_max^2: the largest displacement of a dot that both frames have; -1 if there is none.
template <class S>
S furthest_sq(const PlanesView<S>& now, const PlanesView<S>& before, const Run& run) {
  using V = run_vector<S>;
  V furthest = V{} + S(-1);
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const V dx = load_cells<V, S>(now.x + k) - load_cells<V, S>(before.x + k);
    const V dy = load_cells<V, S>(now.y + k) - load_cells<V, S>(before.y + k);
    const V sq = dx * dx + dy * dy;
    furthest = choose(furthest < sq, sq, furthest);
  }
  return largest_lane<S>(furthest);
}

/// The latest frames, at most `capacity`; a new one takes the place of the oldest.
template <class S>
class Repository {
 public:
  Repository() = default;
  Repository(const DotLayout& layout, Index capacity)
      : cells_(static_cast<Index>(layout.cells<S>())),
        x_(static_cast<std::size_t>(cells_ * capacity), not_a_number<S>()),
        y_(x_),
        frames_(static_cast<std::size_t>(capacity)) {}

  Index size() const { return size_; }
  Index capacity() const { return static_cast<Index>(frames_.size()); }

  /// `age` 0: the newest.
  PlanesView<S> dots(Index age) const {
    const Index from = slot(age) * cells_;
    return {x_.data() + from, y_.data() + from};
  }
  std::int64_t frame(Index age) const { return frames_[static_cast<std::size_t>(slot(age))]; }

  void store(const DotPlanes<S>& dots, std::int64_t frame) {
    newest_ = newest_ + 1 < capacity() ? newest_ + 1 : 0;
    size_ = size_ < capacity() ? size_ + 1 : size_;
    frames_[static_cast<std::size_t>(newest_)] = frame;
    std::copy(dots.x.begin(), dots.x.end(), x_.begin() + newest_ * cells_);
    std::copy(dots.y.begin(), dots.y.end(), y_.begin() + newest_ * cells_);
  }
  void clear() { size_ = 0; }

 private:
  Index slot(Index age) const {
    return newest_ >= age ? newest_ - age : newest_ - age + capacity();
  }

  Index cells_ = 0;
  aligned_vector<S> x_, y_;
  std::vector<std::int64_t> frames_;
  Index newest_ = -1;
  Index size_ = 0;
};

}  // namespace detail::stick

/// Of which dots d_max is the largest displacement.
struct InContact {};      ///< of all in contact
struct InStickRegion {};  ///< of those that stuck in the last answer; of all before the first

/// Published: of the stored frames, the newest from which the dots have moved further than U, as
/// long as the distance grows from frame to frame further back. Where it begins to shrink the
/// object has rotated round, and no frame from there on is looked at; equal distances go on.
template <class Over = InContact>
struct UpdatedReference {
  Index capacity = 64;  ///< 1 to 4096 frames; when it is full the oldest one is forgotten
};

/// The conventional way: the first frame with contact, for good. It tells stick from slip until the
/// object first slips as a whole, turns round, or is pressed harder.
struct FirstReference {};

template <class Over>
void expects_valid(const UpdatedReference<Over>& reference) {
  expects(reference.capacity >= 1 && reference.capacity <= 4096, "UpdatedReference", "capacity",
          static_cast<long long>(reference.capacity), "in [1, 4096]");
}
inline void expects_valid(const FirstReference&) {}

namespace detail::stick {

template <class Over>
Index capacity_of(const UpdatedReference<Over>& reference) {
  return reference.capacity;
}
inline Index capacity_of(const FirstReference&) {
  return 1;
}

template <class S>
struct Choice {
  Index age = -1;         ///< in the repository; -1: no frame will do
  S furthest_sq = S(-1);  ///< d_max^2 from it; else from the newest stored frame
  S newest_sq = S(-1);    ///< d_max^2 from the newest stored frame; -1: no dot to compare
  bool standing = false;
};

template <class Over, class S>
Choice<S> choose_reference(const UpdatedReference<Over>&,
                           const PlanesView<S>& now,
                           const Repository<S>& stored,
                           const Run& run,
                           const S& reference_sq,
                           const S& store_sq) {
  Choice<S> choice;
  S before = S(-1);
  for (Index age = 0; age < stored.size(); ++age) {
    const S sq = furthest_sq(now, stored.dots(age), run);
    if (age == 0) {
      choice.newest_sq = choice.furthest_sq = sq;
      choice.standing = !(sq < S(0)) && !(store_sq < sq);
    }
    if (choice.standing || sq < before) {
      break;
    }
    if (reference_sq < sq) {
      choice.age = age;
      choice.furthest_sq = sq;
      break;
    }
    before = sq;
  }
  return choice;
}

template <class S>
Choice<S> choose_reference(const FirstReference&,
                           const PlanesView<S>& now,
                           const Repository<S>& stored,
                           const Run& run,
                           const S& reference_sq,
                           const S&) {
  Choice<S> choice;
  if (stored.size() > 0) {
    choice.newest_sq = choice.furthest_sq = furthest_sq(now, stored.dots(0), run);
    choice.age = reference_sq < choice.newest_sq ? 0 : -1;
  }
  return choice;
}

/// Whether a frame is kept for later, that has moved as `choice` says and is not standing.
template <class Over, class S>
bool is_stored(const UpdatedReference<Over>&, const Repository<S>&) {
  return true;
}
template <class S>
bool is_stored(const FirstReference&, const Repository<S>& stored) {
  return stored.size() == 0;
}

/// Whether the newest stored frame is of a moment ago, so that a leap from it is a leap of names.
template <class Over>
constexpr bool stores_all_along(const UpdatedReference<Over>&) {
  return true;
}
constexpr bool stores_all_along(const FirstReference&) {
  return false;
}

}  // namespace detail::stick

}  // namespace v0
}  // namespace fingerpad
