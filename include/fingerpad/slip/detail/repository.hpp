// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Stored frames, of which one is the reference. Source: slides "First point: required size of
// displacement" and "Second point: change of moving direction" of 003.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/slip/detail/dot_planes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

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
}  // namespace v0
}  // namespace fingerpad
